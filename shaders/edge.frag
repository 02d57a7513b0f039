#version 330 core

// The pixels at the silhouette: edge.vert computes them.

flat in vec4 edge_display;

layout(location = 0) out vec4 display;

void main() {
    display = edge_display;
}
