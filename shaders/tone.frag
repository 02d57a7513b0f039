#version 330 core

// Pass 3: scale the specular part of L* by c, recombine (Ishii et al., eqs. 2-3), map the gamut, encode
// for the display. Outside the object stands a neutral surround.
//   display = digital values over the surround
//   flags   = 1/255 * (L~* above 100) + 2/255 * (out of gamut)
// Constants: GAMUT, TRANSFER, SAMPLED.

#include "tone.glsl"

uniform sampler2D diffuse_image;  // for the object's share of a pixel, where there may be one
uniform sampler2D split_image;
uniform float c;
uniform vec3 display_white;    // Y = 1
uniform mat3 rgb_from_xyz;     // display XYZ, white at Y = 1, to linear RGB
uniform vec4 display_curve;    // gain, offset, gamma, flare
uniform float background_light;

layout(location = 0) out vec4 display;
layout(location = 1) out vec4 flags;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 split = texelFetch(split_image, at, 0);
    float share = SAMPLED == 1 ? texelFetch(diffuse_image, at, 0).a : on_object(split) ? 1.0 : 0.0;
    bool inside;
    vec3 lab = scaled_lab(split, c);
    vec3 shown = display_rgb(GAMUT, lab, display_white, rgb_from_xyz, inside);
    vec3 rgb = share > 0.0 ? mix(vec3(background_light), shown, share) : vec3(background_light);
    display = vec4(encode(TRANSFER, rgb, display_curve), 1.0);
    flags = vec4(share > 0.0 ? (lab.x > 100.0 + CLIP_TOLERANCE ? 1.0 : 0.0) + (inside ? 0.0 : 2.0) : 0.0)
          / 255.0;
}
