#version 330 core

// The number of the nearest triangle, counted from 1.

layout(location = 0) out float triangle;

void main() {
    triangle = float(gl_PrimitiveID) + 1.0;
}
