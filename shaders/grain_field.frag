#version 330 core

// The tilts of grain that has one size at the eye, in units of sigma_N: one texel for each place of the
// screen at which a grain is drawn. It depends on neither scene nor sigma_N. Constant: NOISE.

#include "grain_field.glsl"

uniform float field_step;  // steps of the lattice from one texel to the next
uniform uint seed;

layout(location = 0) out vec2 unit_tilt;

void main() {
    unit_tilt = smooth_tilt(NOISE, gl_FragCoord.xy * field_step, seed);
}
