#version 330 core

// The triangles of a mesh as the eye sees them.

#include "mesh_corner.glsl"

flat out float triangle_number;

void main() {
    triangle_number = which.x;
    draw_corner(ivec2(0));
}
