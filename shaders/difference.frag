#version 330 core

// CIEDE2000 between what two pictures show, from black (0) to white (`top` and more, striped above it).
// Colours are relative to the display's white. Where neither shows the object, the surround is drawn.

#include "tone.glsl"
#include "difference.glsl"

uniform sampler2D first_image;   // linear display RGB over the surround
uniform sampler2D second_image;
uniform mat3 xyz_from_rgb;
uniform vec3 display_white;
uniform float top;
uniform vec3 surround;  // digital values

layout(location = 0) out vec4 overlay;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 p = texelFetch(first_image, at, 0);
    vec4 q = texelFetch(second_image, at, 0);
    float share = delta_e_2000(lab_from_xyz(xyz_from_rgb * p.rgb, display_white),
                               lab_from_xyz(xyz_from_rgb * q.rgb, display_white)) / top;
    bool stripe = share > 1.0 && ((at.x + at.y) / 4) % 2 == 0;
    // L* of the map is proportional to the difference, so that equal steps look equal.
    float light = lab_f_inverse((100.0 * clamp(share, 0.0, 1.0) + 16.0) / 116.0);
    float shade = stripe ? 0.6 : srgb_encode(light);
    overlay = vec4(max(p.a, q.a) > 0.0 ? vec3(shade) : surround, 1.0);
}
