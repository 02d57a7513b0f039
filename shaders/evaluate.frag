#version 330 core

// Calls the functions of a library over arrays, one pixel a row: for tests and for the maps of where
// methods fail. relgloss_view/picture/gpu/evaluate.py writes in what is to be called.
// Constants: WIDTH, of the target; INTEGERS, where the result is a uvec4.

#ifndef WIDTH
#define WIDTH 1024
#endif

//@include

//@declare

#ifdef INTEGERS
out uvec4 result;
#else
out vec4 result;
#endif

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    int index = at.y * WIDTH + at.x;
    //@read
    //@body
}
