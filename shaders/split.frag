#version 330 core

// Pass 2, first half: the CIELAB of diffuse plus specular, its lightness split into L_d* and L_s*
// (Ishii et al., eq. 1). It is drawn when pass 1 has changed; the second half, tone.frag, when c has.
//   split = (L_d*, L_s*, a*, b*); off the object L_d* is OFF_OBJECT
// Constants: WRITES (of pass 1: WRITES_WEIGHTS or WRITES_XYZ), LOBES, METALS, BANDS, CUBE_ROOT, FINISHES.

#include "texel.glsl"
#include "tone.glsl"

#ifndef FINISHES
#define FINISHES 0
#endif

uniform sampler2D diffuse_image;
uniform sampler2D specular_image;
uniform vec3 per_white;  // one over the white of the scene's lamp, whose Y is one

layout(location = 0) out vec4 split;

#if WRITES == WRITES_WEIGHTS
#include "colours.glsl"
#if METALS == 0
#define LOBE_WEIGHTS specular.xy
#else
#define LOBE_WEIGHTS specular
#endif
#endif

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 diffuse = texel(diffuse_image, at);
    vec4 specular = texel(specular_image, at);
#if WRITES == WRITES_WEIGHTS
    bool seen = on_object(diffuse);
    vec4 lab = split_lab(diffuse_xyz(diffuse.xy), specular_xyz(LOBE_WEIGHTS), per_white);
#else
    bool seen = diffuse.a > 0.0;
    vec4 lab = split_lab(diffuse.rgb, specular.rgb, per_white);
#endif
#if FINISHES > 0
    lab.y *= specular.a;
#endif
    split = seen ? lab : vec4(OFF_OBJECT, 0.0, 0.0, 0.0);
}
