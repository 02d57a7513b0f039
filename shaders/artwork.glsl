// What is printed at a place of the label, averaged over the pixel: probes along the longer axis of its
// footprint, each in two mip levels. Twins: relgloss_view/picture/model/texture.py and surface.py.
// Constants: FINISHES, CHANNELS, and from the pack's layers LOBE_CHANNELS, BODY_CHANNELS (by finish: the channel
// of its share, SHARE_REST or SHARE_ZERO), OUTSIDE_LOBES, OUTSIDE_DIFFUSE (the finish where no artwork is).

const float MOST_LEVELS = 16.0;
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
uniform sampler2D level_table;   // left, top, width, height of each level, texels
uniform vec2 artwork_texels;      // width and height of its first level
uniform int last_level;
uniform vec4 artwork_from_label;  // shares of the artwork's width and height a metre of the label: two rows
uniform vec2 label_offset_m;      // of the artwork's centre
uniform float girth_m;            // after which the label repeats; 0 where it ends
uniform int wraps;                // 1 where the artwork is as wide as the girth
uniform sampler2D part_table;     // by part: 1 where it is printed; finish that covers it, of lobes and diffuse part

struct Print {
    vec4 paint;
    vec4 shares[4];
};

const int USED = CHANNELS > 0 ? CHANNELS : 1;
const int SHARE_REST = -1;
const int SHARE_ZERO = -2;
const int LOBE_CHANNEL[FINISHES] = int[FINISHES](LOBE_CHANNELS);
const int BODY_CHANNEL[FINISHES] = int[FINISHES](BODY_CHANNELS);

// What is filtered: colours, channels of the shares, and how much of the pixel the artwork covers.
struct Texels {
    vec4 paint;
    vec4 channels[USED];
    float inner;
};

// How a step of the ray moves the point along the surface (Igehy 1999).
vec3 moved(vec3 turn, vec3 facet, vec3 ray, float travel) {
    float along = dot(facet, ray);
    float least = GRAZING * length(facet) * length(ray);
    along = abs(along) < least ? (along < 0.0 ? -least : least) : along;
    return travel * (turn - ray * (dot(facet, turn) / along));
}

void add_tap(vec2 texel, float weight, inout Texels sum) {
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

// Bilinear in the level at a box of the texture. share: place on the artwork, 0 to 1, from its upper left.
// The artwork's edge goes on beside it, or it goes around.
void add_level(vec2 share, vec4 box, float weight, inout Texels sum) {
    vec2 place = share * box.zw - 0.5;
    vec2 first = floor(place);
    vec2 part = place - first;
    vec2 low = clamp(first, vec2(0.0), box.zw - 1.0);
    vec2 high = clamp(first + 1.0, vec2(0.0), box.zw - 1.0);
    float around = first.x - box.z * floor((first.x + 0.5) / box.z);
    low.x = wraps == 1 ? around : low.x;
    high.x = wraps == 1 ? (around + 1.5 > box.z ? 0.0 : around + 1.0) : high.x;
    low = (box.xy + low + 0.5) * per_atlas;
    high = (box.xy + high + 0.5) * per_atlas;
    vec2 beside = weight * vec2(1.0 - part.x, part.x);
    add_tap(low, beside.x * (1.0 - part.y), sum);
    add_tap(vec2(high.x, low.y), beside.y * (1.0 - part.y), sum);
    add_tap(vec2(low.x, high.y), beside.x * part.y, sum);
    add_tap(high, beside.y * part.y, sum);
}

vec4 box_of(float level) {
    return textureLod(level_table, vec2((level + 0.5) * (1.0 / MOST_LEVELS), 0.5), 0.0);
}

Texels filtered(vec2 share, vec4 turns) {
    Texels sum;
    sum.paint = vec4(0.0);
    for (int k = 0; k < USED; ++k) sum.channels[k] = vec4(0.0);
    vec2 size = artwork_texels;
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
    float lower = floor(level);
    float part = level - lower;
    vec4 box = box_of(lower);
    vec4 next_box = box_of(min(lower + 1.0, float(last_level)));
    float per_probe = 1.0 / probes;
    // A loop that runs once in any case costs a software driver less, and one inside it would cost more than
    // the second level that some pixels don't need.
    int left = int(probes);
    float at_probe = 0.5 * per_probe - 0.5;
    do {
        vec2 at = share + span * at_probe;
        add_level(at, box, (1.0 - part) * per_probe, sum);
        add_level(at, next_box, part * per_probe, sum);
        at_probe += per_probe;
        --left;
    } while (left > 0);
    // Beside the artwork it fades out within a pixel.
    vec2 reach = vec2(sqrt(sxx), sqrt(syy));
    vec2 on = clamp(1.0 + min(share, 1.0 - share) * size / max(reach, vec2(1e-6)), 0.0, 1.0);
    sum.inner = (wraps == 1 ? 1.0 : on.x) * on.y;
    sum.paint *= sum.inner;
    for (int k = 0; k < USED; ++k) sum.channels[k] *= sum.inner;
    return sum;
}

// What a finish has of its own channel.
float channel_of(int channel, Texels texels) {
    return channel < 0 ? 0.0 : texels.channels[max(channel, 0) / 4][max(channel, 0) % 4];
}

// The share of one finish; rest: that of the finish which takes what is left.
float share_of(int channel, float rest, bool outside, Texels texels) {
    float share = channel == SHARE_REST ? rest : channel_of(channel, texels);
    return clamp(share + (outside ? 1.0 - texels.inner : 0.0), 0.0, 1.0);
}

// label_m: on the label, from its centre. turns: its change to the next pixel on the right, and below.
Print print_at(vec2 label_m, vec4 turns, bool found, int part) {
    vec4 cover = textureLod(part_table, vec2((float(part) + 0.5) / float(textureSize(part_table, 0).x), 0.5), 0.0);
    vec2 offset = label_m - label_offset_m;
    if (girth_m > 0.0 && wraps == 0) offset.x -= girth_m * floor(offset.x / girth_m + 0.5);
    vec2 share = vec2(dot(artwork_from_label.xy, offset), dot(artwork_from_label.zw, offset)) + 0.5;
    bool printed = found && cover.x > 0.5;
    Texels texels = filtered(share, turns);
    float rest = texels.inner;
    float diffuse_rest = texels.inner;
    for (int k = 0; k < FINISHES; ++k) {
        rest -= channel_of(LOBE_CHANNEL[k], texels);
        diffuse_rest -= channel_of(BODY_CHANNEL[k], texels);
    }
    rest = max(rest, 0.0);
    diffuse_rest = max(diffuse_rest, 0.0);
    Print print;
    print.paint = printed ? texels.paint : vec4(0.0);
    for (int k = 0; k < 4; ++k) print.shares[k] = vec4(0.0);
    for (int k = 0; k < FINISHES; ++k) {
        float lobes = share_of(LOBE_CHANNEL[k], rest, k == OUTSIDE_LOBES, texels);
        float diffuse = share_of(BODY_CHANNEL[k], diffuse_rest, k == OUTSIDE_DIFFUSE, texels);
        lobes = cover.y < 0.0 ? lobes : float(k) == cover.y ? 1.0 : 0.0;
        diffuse = cover.z < 0.0 ? diffuse : float(k) == cover.z ? 1.0 : 0.0;
        print.shares[k / 4][k % 4] = lobes;
        print.shares[(FINISHES + k) / 4][(FINISHES + k) % 4] = diffuse;
    }
    return print;
}
