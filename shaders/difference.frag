#version 330 core

// CIEDE2000 between what two pictures show, from black (0) to white (`top` and more, striped above it).
// Colours are relative to the display's white.

#include "tone.glsl"
#include "difference.glsl"

uniform sampler2D first_image;   // linear display RGB over the surround
uniform sampler2D second_image;
uniform mat3 xyz_from_rgb;
uniform vec3 display_white;
uniform float top;

layout(location = 0) out vec4 overlay;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 first = lab_from_xyz(xyz_from_rgb * texelFetch(first_image, at, 0).rgb, display_white);
    vec3 second = lab_from_xyz(xyz_from_rgb * texelFetch(second_image, at, 0).rgb, display_white);
    float share = delta_e_2000(first, second) / top;
    bool stripe = share > 1.0 && ((at.x + at.y) / 4) % 2 == 0;
    // L* of the map is proportional to the difference, so that equal steps look equal.
    float light = lab_f_inverse((100.0 * clamp(share, 0.0, 1.0) + 16.0) / 116.0);
    overlay = vec4(vec3(stripe ? 0.6 : srgb_encode(light)), 1.0);
}
