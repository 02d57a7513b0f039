#version 330 core

// The number of the nearest triangle, counted from 1.

flat in float triangle_number;

layout(location = 0) out float triangle;

void main() {
    triangle = triangle_number;
}
