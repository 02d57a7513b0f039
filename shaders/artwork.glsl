// What is printed at a place of the label, averaged over the pixel: probes along the longer axis of its
// footprint, each in two mip levels. Twins: relgloss_view/picture/model/texture.py and surface.py.
// Constants: FINISHES, CHANNELS.

const int MOST_LEVELS = 16;
const float MOST_PROBES = 8.0;
const float GRAZING = 1e-4;  // the least cosine between a ray and the surface that is reckoned with

uniform sampler2D paint_image;  // all mip levels side by side, each at level_box
#if CHANNELS > 0
uniform sampler2D channels_0;
#endif
#if CHANNELS > 1
uniform sampler2D channels_1;
#endif
#if CHANNELS > 2
uniform sampler2D channels_2;
#endif
uniform vec2 per_atlas;          // one over its width and height
uniform vec4 level_box[MOST_LEVELS];  // left, top, width, height of each level, texels
uniform int last_level;
uniform vec4 artwork_from_label;  // shares of the artwork's width and height a metre of the label: two rows
uniform vec2 label_offset_m;      // of the artwork's centre
uniform float girth_m;            // after which the label repeats; 0 where it ends
uniform int wraps;                // 1 where the artwork is as wide as the girth
uniform sampler2D part_table;     // by part: 1 where it is printed; finish that covers it, of lobes and diffuse part
// Rows of the shares, 4 vectors each: factors of up to 12 channels; value on and beside the artwork.
uniform vec4 share_rows[8 * FINISHES];

struct Print {
    vec4 paint;
    vec4 shares[4];
};

// What is filtered: colours, channels of the shares, and how much of the pixel the artwork covers.
struct Texels {
    vec4 paint;
    vec4 channels[3];
    float inner;
};

// How a step of the ray moves the point along the surface (Igehy 1999).
vec3 moved(vec3 turn, vec3 facet, vec3 ray, float travel) {
    float along = dot(facet, ray);
    float least = GRAZING * length(facet) * length(ray);
    along = abs(along) < least ? (along < 0.0 ? -least : least) : along;
    return travel * (turn - ray * (dot(facet, turn) / along));
}

// Its edge goes on beside the artwork.
void add_tap(vec2 at, vec4 box, float weight, inout Texels sum) {
    float x = wraps == 1 ? at.x - box.z * floor((at.x + 0.5) / box.z) : at.x;
    vec2 texel = (box.xy + clamp(vec2(x, at.y), vec2(0.0), box.zw - 1.0) + 0.5) * per_atlas;
    sum.paint += weight * textureLod(paint_image, texel, 0.0);
#if CHANNELS > 0
    sum.channels[0] += weight * textureLod(channels_0, texel, 0.0);
#endif
#if CHANNELS > 1
    sum.channels[1] += weight * textureLod(channels_1, texel, 0.0);
#endif
#if CHANNELS > 2
    sum.channels[2] += weight * textureLod(channels_2, texel, 0.0);
#endif
}

// Bilinear in one level. share: place on the artwork, 0 to 1, from its upper left.
void add_level(vec2 share, int level, float weight, inout Texels sum) {
    vec4 box = level_box[level];
    vec2 place = share * box.zw - 0.5;
    vec2 first = floor(place);
    vec2 part = place - first;
    for (int k = 0; k < 4; ++k) {
        vec2 corner = vec2(float(k & 1), float(k >> 1));
        vec2 near = mix(1.0 - part, part, corner);
        add_tap(first + corner, box, weight * near.x * near.y, sum);
    }
}

Texels filtered(vec2 share, vec4 turns) {
    Texels sum = Texels(vec4(0.0), vec4[3](vec4(0.0), vec4(0.0), vec4(0.0)), 0.0);
    vec2 size = level_box[0].zw;
    vec2 right = size * vec2(dot(artwork_from_label.xy, turns.xy), dot(artwork_from_label.zw, turns.xy));
    vec2 down = size * vec2(dot(artwork_from_label.xy, turns.zw), dot(artwork_from_label.zw, turns.zw));
    float sxx = right.x * right.x + down.x * down.x;
    float syy = right.y * right.y + down.y * down.y;
    float sxy = right.x * right.y + down.x * down.y;
    float mean = 0.5 * (sxx + syy);
    float half_difference = 0.5 * (sxx - syy);
    float root = sqrt(half_difference * half_difference + sxy * sxy);
    float longer = sqrt(mean + root);
    float radius = max(max(sqrt(max(mean - root, 0.0)), longer * (1.0 / MOST_PROBES)), 1.0);
    float probes = clamp(ceil(longer / radius - 0.05), 1.0, MOST_PROBES);
    float level = min(log2(radius), float(last_level));
    vec2 axis = half_difference >= 0.0 ? vec2(half_difference + root, sxy) : vec2(sxy, root - half_difference);
    float size2 = dot(axis, axis);
    axis = size2 > 0.0 ? axis * inversesqrt(size2) : vec2(1.0, 0.0);
    vec2 span = axis * longer / size;
    int lower = int(level);
    float part = level - float(lower);
    int levels = part > 0.0 ? 2 : 1;
    for (int k = 0; k < int(probes); ++k) {
        vec2 at = share + span * ((float(k) + 0.5) / probes - 0.5);
        add_level(at, lower, (1.0 - part) / probes, sum);
        for (int n = 1; n < levels; ++n) add_level(at, min(lower + 1, last_level), part / probes, sum);
    }
    // Beside the artwork it fades out within a pixel.
    vec2 reach = vec2(sqrt(sxx), sqrt(syy));
    vec2 on = clamp(1.0 + min(share, 1.0 - share) * size / max(reach, vec2(1e-6)), 0.0, 1.0);
    sum.inner = (wraps == 1 ? 1.0 : on.x) * on.y;
    sum.paint *= sum.inner;
    for (int k = 0; k < 3; ++k) sum.channels[k] *= sum.inner;
    return sum;
}

float share_of(int row, Texels texels) {
    vec4 ends = share_rows[4 * row + 3];
    float share = ends.x * texels.inner + ends.y * (1.0 - texels.inner);
    for (int k = 0; k < CHANNELS; ++k) share += dot(share_rows[4 * row + k], texels.channels[k]);
    return clamp(share, 0.0, 1.0);
}

// label_m: on the label, from its centre. turns: its change to the next pixel on the right, and below.
Print print_at(vec2 label_m, vec4 turns, bool found, int part) {
    vec4 cover = textureLod(part_table, vec2((float(part) + 0.5) / float(textureSize(part_table, 0).x), 0.5), 0.0);
    vec2 offset = label_m - label_offset_m;
    if (girth_m > 0.0 && wraps == 0) offset.x -= girth_m * floor(offset.x / girth_m + 0.5);
    vec2 share = vec2(dot(artwork_from_label.xy, offset), dot(artwork_from_label.zw, offset)) + 0.5;
    bool printed = found && cover.x > 0.5;
    Texels texels = Texels(vec4(0.0), vec4[3](vec4(0.0), vec4(0.0), vec4(0.0)), 0.0);
    for (int k = 0; k < (printed ? 1 : 0); ++k) texels = filtered(share, turns);
    Print print;
    print.paint = texels.paint;
    for (int k = 0; k < 4; ++k) print.shares[k] = vec4(0.0);
    for (int k = 0; k < FINISHES; ++k) {
        float lobes = cover.y < 0.0 ? share_of(k, texels) : float(k) == cover.y ? 1.0 : 0.0;
        float diffuse = cover.z < 0.0 ? share_of(FINISHES + k, texels) : float(k) == cover.z ? 1.0 : 0.0;
        print.shares[k / 4][k % 4] = lobes;
        print.shares[(FINISHES + k) / 4][(FINISHES + k) % 4] = diffuse;
    }
    return print;
}
