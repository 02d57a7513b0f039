#version 330 core

// The fill floor's first pass: constants into two float targets.
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;

void main() {
    first = vec4(0.25);
    second = vec4(0.5);
}
