#version 330 core

// First step of the reduction: the extremes of one BLOCK x BLOCK tile of pass 1.
//   extremes  = (smallest (100 - L_d) / L_s, largest L_d, largest L_s, largest Y of the diffuse part)
//   brightest = (L*, L_d, L_s of the brightest pixel, number of pixels that are not finite)

#include "tone.glsl"

uniform sampler2D diffuse_image;
uniform sampler2D specular_image;

layout(location = 0) out vec4 extremes;
layout(location = 1) out vec4 brightest;

void main() {
    ivec2 size = textureSize(diffuse_image, 0);
    ivec2 first = BLOCK * ivec2(gl_FragCoord.xy);
    ivec2 last = min(first + BLOCK, size);  // a fetch beyond the image is undefined
    extremes = vec4(1e30, -1e30, -1e30, 0.0);
    brightest = vec4(-1e30, 0.0, 0.0, 0.0);
    for (int y = first.y; y < last.y; ++y) {
        for (int x = first.x; x < last.x; ++x) {
            vec4 diffuse = texelFetch(diffuse_image, ivec2(x, y), 0);
            if (diffuse.a <= 0.0) continue;
            vec4 specular = texelFetch(specular_image, ivec2(x, y), 0);
            float sum = dot(diffuse.rgb, vec3(1.0)) + dot(specular.rgb, vec3(1.0));
            if (!(abs(sum) < 1e30)) {  // NaN too; some compilers fold isnan away
                brightest.w += 1.0;
                continue;
            }
            vec2 split = split_lightness(diffuse.y, specular.y);
            extremes.x = min(extremes.x, largest_c(split));
            extremes.yzw = max(extremes.yzw, vec3(split, diffuse.y));
            if (split.x + split.y > brightest.x) brightest.xyz = vec3(split.x + split.y, split);
        }
    }
}
