#version 330 core

// One place of a pixel more is covered: added to the target.

#include "silhouette.glsl"

flat in float place_depth;  // as it is: interpolated, it would differ between two triangles

layout(location = 0) out float coverage;

void main() {
    coverage = 1.0 / float(EDGE_RAYS);
    gl_FragDepth = place_depth;
}
