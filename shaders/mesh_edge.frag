#version 330 core

// Which pixels the silhouette of a mesh passes through: of the corners, sides and middle of a pixel some show
// the mesh and some don't. They are marked by EDGE_MARK and open to mesh_places.frag by their depth.

#include "silhouette.glsl"

uniform sampler2D mask_image;  // the mesh at every half pixel, first at the lower left corner of `from`
uniform ivec2 from;            // pixel

layout(location = 0) out float coverage;

const float EDGE_MARK = 1.0 / 255.0;

void main() {
    ivec2 first = 2 * (ivec2(gl_FragCoord.xy) - from);
    int tried = 0;
    for (int k = 0; k < TRIED; ++k)
        tried += texelFetch(mask_image, first + ivec2(k % 3, k / 3), 0).x > 0.5 ? 1 : 0;
    bool edge = tried > 0 && tried < TRIED;
    coverage = tried == TRIED ? 1.0 : edge ? EDGE_MARK : 0.0;
    gl_FragDepth = edge ? 0.0 : 1.0;
}
