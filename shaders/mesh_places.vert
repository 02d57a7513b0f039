#version 330 core

// The triangles of a mesh at the silhouette, once for each of the places in a pixel (silhouette.glsl). Depth
// tells the places apart: each is deeper than those before it, so that a place of a pixel is counted once,
// however many triangles cover it, where the deeper one passes the test.

#include "mesh_corner.glsl"
#include "silhouette.glsl"

flat out float place_depth;

void main() {
    vec2 place = edge_place(gl_InstanceID) - 0.5;  // whole steps of the grid
    place_depth = (float(gl_InstanceID) + 1.0) / float(EDGE_RAYS + 1);
    draw_corner(ivec2(float(GRID) * vec2(-place.x, place.y)));
}
