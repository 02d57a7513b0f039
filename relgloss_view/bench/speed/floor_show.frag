#version 330 core

// The fill floor's second pass: both targets read, an 8-bit one written.
uniform sampler2D first_image;
uniform sampler2D second_image;

layout(location = 0) out vec4 display;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    display = texelFetch(first_image, at, 0) + texelFetch(second_image, at, 0);
}
