#version 330 core

// The float numbers of pass 2, drawn only when someone asks for them.
//   light = linear display RGB over the surround, alpha = the object's share of the pixel
//   lab   = L~*, a*, b* before gamut mapping; 0 off the object

#include "rows.glsl"
#include "texel.glsl"
#include "tone.glsl"

uniform sampler2D diffuse_image;
uniform sampler2D split_image;
uniform float c;
uniform vec3 display_white;
uniform mat3 rgb_from_xyz;
uniform vec3 display_lowest;  // linear RGB, below which nothing is shown
uniform vec3 background_rgb;

layout(location = 0) out vec4 light;
layout(location = 1) out vec4 lab;

void main() {
    ivec2 at = picture_pixel();
    vec4 split = texel(split_image, at);
    float share = SAMPLED == 1 ? texel(diffuse_image, at).a : on_object(split) ? 1.0 : 0.0;
    bool inside;
    vec3 scaled = scaled_lab(split, c);
    vec3 shown = max(display_rgb(GAMUT, scaled, display_white, rgb_from_xyz, inside), display_lowest);
    light = vec4(share > 0.0 ? over(shown, share, background_rgb) : background_rgb, share);
    lab = share > 0.0 ? vec4(scaled, 1.0) : vec4(0.0);
}
