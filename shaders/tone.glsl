// CIELAB split, scaling, gamut (Ishii et al., eqs. 1-4). Twin: relgloss_view/picture/model/tone.py.

#include "cube_root.glsl"
#include "transfer.glsl"

// CIE 15:2004 with the exact constants, so that value and slope are continuous. Multiplied by, not
// divided by: software drivers divide even by constants.
const float LAB_EPSILON = 216.0 / 24389.0;
const float LAB_KAPPA = 24389.0 / 27.0;
const float LAB_SLOPE = 841.0 / 108.0;    // of f near black: LAB_KAPPA / 116
const float LAB_OFFSET = 4.0 / 29.0;      // of f at black: 16 / 116

float lab_f(float t) {
    return t > LAB_EPSILON ? cube_root(t) : LAB_SLOPE * t + LAB_OFFSET;
}

float lab_f_inverse(float f) {
    return f > 6.0 / 29.0 ? f * f * f : (108.0 / 841.0) * (f - LAB_OFFSET);
}

float lightness(float y) {
    return y > LAB_EPSILON ? 116.0 * cube_root(y) - 16.0 : LAB_KAPPA * y;
}

vec3 lab_from_xyz(vec3 xyz, vec3 white) {
    vec3 t = xyz / white;
    vec3 f = vec3(lab_f(t.x), lab_f(t.y), lab_f(t.z));
    return vec3(lightness(t.y), 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
}

vec3 xyz_from_lab(vec3 lab, vec3 white) {
    float f = (1.0 / 116.0) * lab.x + LAB_OFFSET;
    return white * vec3(lab_f_inverse(f + (1.0 / 500.0) * lab.y), lab_f_inverse(f),
                        lab_f_inverse(f - (1.0 / 200.0) * lab.z));
}

// (L_d*, L_s*, a*, b*) of a pixel: CIELAB of the sum, its lightness split. The white's Y is one, so that
// one cube root serves both.
vec4 split_lab(vec3 diffuse, vec3 specular, vec3 per_white) {
    vec3 t = (diffuse + specular) * per_white;
    vec3 f = vec3(lab_f(t.x), lab_f(t.y), lab_f(t.z));
    float total = t.y > LAB_EPSILON ? 116.0 * f.y - 16.0 : LAB_KAPPA * t.y;
    float lightness_d = lightness(diffuse.y);
    return vec4(lightness_d, total - lightness_d, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
}

// The largest c that this pixel can show; huge where nothing is specular.
float largest_c(vec2 split) {
    return split.y > 1e-6 ? (100.0 - split.x) / split.y : 1e30;
}

// L_d*, or the first weight, of a pixel that shows nothing of the object: neither comes near it.
const float OFF_OBJECT = -60000.0;  // a number of 16 bits can be as small

bool on_object(vec4 split_or_weights) {
    return split_or_weights.x > 0.5 * OFF_OBJECT;
}

const float CLIP_TOLERANCE = 1e-3;  // L*: far below what an eye can tell

// L~*, a*, b* of a pixel's (L_d*, L_s*, a*, b*), its specular part scaled by c (eqs. 2-3).
vec3 scaled_lab(vec4 split, float c) {
    return vec3(split.x + c * split.y, split.zw);
}

// A Lab colour that shows a lightness at its own lightness, its hue turning from violet (0) by blue and
// green to yellow (100): equal steps look equal, and the order shows without the hue too.
vec3 false_colour(float lightness) {
    float share = clamp(lightness / 100.0, 0.0, 1.0);
    float angle = 5.4 - 3.8 * share;
    return vec3(100.0 * share, 45.0 * cos(angle), 45.0 * sin(angle));
}

const float GAMUT_TOLERANCE = 1e-4;  // far below one step of 8 bits

bool in_gamut(vec3 rgb) {
    return all(greaterThanEqual(rgb, vec3(-GAMUT_TOLERANCE)))
        && all(lessThanEqual(rgb, vec3(1.0 + GAMUT_TOLERANCE)));
}

const float SMALLEST_STEP = 1.0 / 65536.0;  // of the bisection

// Linear display RGB of a Lab colour whose white is the display's. Out of gamut, GAMUT_CHROMA holds L* and
// hue and reduces chroma by bisection to the gamut's edge; GAMUT_CLIP cuts each channel.
vec3 display_rgb(int gamut, vec3 lab, vec3 display_white, mat3 rgb_from_xyz, out bool inside) {
    lab.x = clamp(lab.x, 0.0, 100.0);
    vec3 rgb;
    float kept = 0.0;   // the share of the chroma that is known to fit
    float tried = 1.0;  // the share that this turn tries; in the last turn, what is kept
    float step = 1.0;
    // A software driver runs a loop's first turn in any case, and further ones only where some pixel
    // needs them.
    do {
        rgb = rgb_from_xyz * xyz_from_lab(vec3(lab.x, tried * lab.yz), display_white);
        kept = in_gamut(rgb) ? tried : kept;
        step *= 0.5;
        tried = step < SMALLEST_STEP ? kept : kept + step;
    } while (gamut == GAMUT_CHROMA && kept < 1.0 && step >= 0.5 * SMALLEST_STEP);
    inside = kept == 1.0;
    return clamp(rgb, 0.0, 1.0);
}

// Light that covers a share of a pixel, over another light. Not by mix(): a driver chooses between two
// ways of rounding it, by what else it can share.
vec3 over(vec3 light, float share, vec3 below) {
    return (1.0 - share) * below + share * light;
}

// What is added to a digital value before it is rounded, in steps: above -0.5 and below 0.5, evenly spread,
// with as little of coarse pattern as points in the plane can have (Roberts 2018, "The unreasonable
// effectiveness of quasirandom sequences": R2, in 32 bits). Integers: identical everywhere.
float dither_step(ivec2 at) {
    uint turned = uint(at.x) * 3242174889u + uint(at.y) * 2447445413u;
    return (float(turned >> 9u) + 0.5) * 1.1920928955078125e-7 - 0.5;  // 2^-23
}
