#version 330 core

// The number of the nearest triangle, counted from 1. Its depth is that of its corners, which a driver would
// interpolate with errors of its own.

#include "raster.glsl"

flat in float triangle_number;
flat in ivec4 corners;
flat in ivec2 last_corner;
flat in vec3 corner_depths;
flat in float turn;

layout(location = 0) out float triangle;

void main() {
    ivec2 place = GRID * ivec2(gl_FragCoord.xy);
    vec3 sides;
    bool covered = covers(corners.xy - place, corners.zw - place, last_corner - place, turn, sides);
    if (!(covered || turn == 0.0)) discard;
    triangle = triangle_number;
    gl_FragDepth = turn == 0.0 ? gl_FragCoord.z : dot(corner_depths, sides) / (sides.x + sides.y + sides.z);
}
