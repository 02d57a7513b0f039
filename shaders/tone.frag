#version 330 core

// Pass 2: split L*, scale its specular part by c, recombine (Ishii et al., eqs. 1-3), map the gamut,
// encode for the display. Outside the object stands a neutral surround.
//   display = digital values; light = linear display RGB, both over the surround, alpha = coverage
//   lab     = L~*, a*, b* before gamut mapping, and 1 * (L~* above 100) + 2 * (out of gamut)

#include "tone.glsl"

uniform sampler2D diffuse_image;
uniform sampler2D specular_image;
uniform vec3 white;            // of the scene's lamp, Y = 1
uniform float c;
uniform vec3 display_white;    // Y = 1
uniform mat3 rgb_from_xyz;     // display XYZ, white at Y = 1, to linear RGB
uniform vec4 display_curve;    // gain, offset, gamma, flare
uniform float background_light;

layout(location = 0) out vec4 display;
layout(location = 1) out vec4 light;
layout(location = 2) out vec4 lab;

const float CLIP_TOLERANCE = 1e-3;  // L*: far below what an eye can tell

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 diffuse = texelFetch(diffuse_image, at, 0);
    vec4 specular = texelFetch(specular_image, at, 0);
    vec3 rgb = vec3(background_light);
    lab = vec4(0.0);
    if (diffuse.a > 0.0) {
        vec2 split = split_lightness(diffuse.y, specular.y);
        vec3 ordinary = lab_from_xyz(diffuse.rgb + specular.rgb, white);
        lab.xyz = vec3(split.x + c * split.y, ordinary.yz);
        bool inside;
        vec3 shown = display_rgb(GAMUT, lab.xyz, display_white, rgb_from_xyz, inside);
        lab.w = (lab.x > 100.0 + CLIP_TOLERANCE ? 1.0 : 0.0) + (inside ? 0.0 : 2.0);
        rgb = mix(rgb, shown, diffuse.a);
    }
    light = vec4(rgb, diffuse.a);
    display = vec4(encode(TRANSFER, rgb, display_curve), diffuse.a);
}
