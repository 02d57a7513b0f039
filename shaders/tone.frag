#version 330 core

// Pass 2: scale the specular part of L* by c, recombine (Ishii et al., eqs. 2-3), map the gamut, encode
// for the display. Outside the object is a neutral surround.
//   display = digital values over the surround; alpha = 1 - 1/255 * (L~* above 100) - 2/255 * (out of
//             gamut) - 4/255 * (the screen can't show it), so that a pixel says what was done to it at no cost
// Constants: GAMUT, TRANSFER, SAMPLED, DITHER, SEEN_ON.

#include "texel.glsl"
#include "tone.glsl"
#include "screen.glsl"

uniform sampler2D diffuse_image;  // for the object's share of a pixel, where there may be one
uniform sampler2D split_image;
uniform float c;
uniform vec3 display_white;    // Y = 1
uniform mat3 rgb_from_xyz;     // display XYZ, white at Y = 1, to linear RGB
uniform vec3 display_lowest;  // linear RGB, below which nothing is shown
uniform vec3 background_rgb;

layout(location = 0) out vec4 display;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 split = texel(split_image, at);
    float share = SAMPLED == 1 ? texel(diffuse_image, at).a : on_object(split) ? 1.0 : 0.0;
    bool inside;
    vec3 lab = scaled_lab(split, c);
    vec3 shown = max(display_rgb(GAMUT, lab, display_white, rgb_from_xyz, inside), display_lowest);
    vec3 rgb = share > 0.0 ? over(shown, share, background_rgb) : background_rgb;
    float flags = (lab.x > 100.0 + CLIP_TOLERANCE ? 1.0 : 0.0) + (inside ? 0.0 : 2.0) + (cut_by_screen(shown) ? 4.0 : 0.0);
    float dither = DITHER == DITHER_ORDERED && share > 0.0 ? dither_step(at) : 0.0;
    display = vec4(digital_of(rgb) + (1.0 / 255.0) * dither,
                   1.0 - (1.0 / 255.0) * (share > 0.0 ? flags : 0.0));
}
