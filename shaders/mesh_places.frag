#version 330 core

// One place of a pixel more is covered: added to the target.

#include "raster.glsl"
#include "silhouette.glsl"

flat in float place_depth;  // as it is: interpolated, it would differ between two triangles
flat in ivec4 corners;
flat in ivec2 last_corner;
flat in float turn;

layout(location = 0) out float coverage;

void main() {
    ivec2 place = GRID * ivec2(gl_FragCoord.xy);
    vec3 sides;
    bool covered = covers(corners.xy - place, corners.zw - place, last_corner - place, turn, sides);
    if (!(covered || turn == 0.0)) discard;
    coverage = 1.0 / float(EDGE_RAYS);
    gl_FragDepth = place_depth;
}
