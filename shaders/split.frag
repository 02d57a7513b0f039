#version 330 core

// Pass 2: CIELAB of what pass 1 drew, with L* split into its diffuse and its specular part (Ishii et
// al., eq. 1). It does not know c, so a slider of c leaves it alone.
//   split = (L_d*, L_s*, a*, b*); off the object L_d* is OFF_OBJECT

#include "tone.glsl"

uniform sampler2D diffuse_image;
uniform sampler2D specular_image;
uniform vec3 white;  // of the scene's lamp, Y = 1

layout(location = 0) out vec4 split;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 diffuse = texelFetch(diffuse_image, at, 0);
    vec3 specular = texelFetch(specular_image, at, 0).rgb;
    vec3 lab = lab_from_xyz(diffuse.rgb + specular, white);
    split = diffuse.a > 0.0 ? vec4(split_lightness(diffuse.y, specular.y), lab.yz)
                            : vec4(OFF_OBJECT, 0.0, 0.0, 0.0);
}
