#version 330 core

// What is shown over a picture, or instead of it, to look into it. Constants: OVERLAY, GAMUT, TRANSFER, SEEN_ON.
// Only OVERLAY_LIGHTNESS and OVERLAY_NORMALS use colour: the others stay neutral beside the pictures.

#include "tone.glsl"
#include "screen.glsl"

uniform sampler2D diffuse_image;
uniform sampler2D split_image;
uniform sampler2D display_image;
uniform sampler2D tilted_normal_image;
uniform vec3 white;
uniform float c;
uniform vec3 display_white;
uniform mat3 rgb_from_xyz;
uniform vec3 display_lowest;  // linear RGB, below which nothing is shown
uniform vec3 background_rgb;

layout(location = 0) out vec4 overlay;

const int STRIPE_PX = 4;
const int DOT_STEP_PX = 6;
const int DOT_PX = 3;
const int LINE_STEP_PX = 5;
const int LINE_PX = 2;

vec3 shown(vec3 lab, float share) {
    bool inside;
    vec3 rgb = max(display_rgb(GAMUT, lab, display_white, rgb_from_xyz, inside), display_lowest);
    rgb = share > 0.0 ? over(rgb, share, background_rgb) : background_rgb;
    return digital_of(rgb);
}

// A pattern of black and white: stripes, white lines or white dots on black.
bool stripes(ivec2 at) {
    return ((at.x + at.y) / STRIPE_PX) % 2 == 0;
}

bool lines(ivec2 at) {
    return at.y % LINE_STEP_PX < LINE_PX;
}

bool dots(ivec2 at) {
    return at.x % DOT_STEP_PX < DOT_PX && at.y % DOT_STEP_PX < DOT_PX;
}

// The pattern where a flag is set, over a gray and pale copy of the picture.
vec3 marked(ivec2 at, int flag, bool light) {
    vec4 shown = texelFetch(display_image, at, 0);
    int flags = 255 - int(floor(255.0 * shown.a + 0.5));
    float gray = dot(shown.rgb, vec3(0.299, 0.587, 0.114));
    return (flags & flag) != 0 ? vec3(light ? 1.0 : 0.0) : vec3(0.2 + 0.4 * gray);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 diffuse = texelFetch(diffuse_image, at, 0);
    vec4 split = texelFetch(split_image, at, 0);
    vec3 colour = vec3(0.0);
    bool off_object = diffuse.a <= 0.0;
    vec3 plain = texelFetch(display_image, at, 0).rgb;
    if (OVERLAY == OVERLAY_CLIPPED) colour = off_object ? plain : marked(at, 1, stripes(at));
    if (OVERLAY == OVERLAY_OUT_OF_GAMUT) colour = off_object ? plain : marked(at, 2, dots(at));
    if (OVERLAY == OVERLAY_CUT_BY_THIS_DISPLAY) colour = off_object ? plain : marked(at, 4, lines(at));
    if (OVERLAY == OVERLAY_LIGHTNESS) colour = shown(false_colour(scaled_lab(split, c).x), diffuse.a);
    if (OVERLAY == OVERLAY_DIFFUSE_ONLY) colour = shown(lab_from_xyz(diffuse.rgb, white), diffuse.a);
    if (OVERLAY == OVERLAY_SPECULAR_ONLY) colour = shown(vec3(c * split.y, 0.0, 0.0), diffuse.a);
    if (OVERLAY == OVERLAY_NORMALS) {
        vec4 normal = texelFetch(tilted_normal_image, at, 0);
        colour = normal.a > 0.0 ? 0.5 + 0.5 * normal.xyz
                                : digital_of(background_rgb);
    }
    overlay = vec4(colour, 1.0);
}
