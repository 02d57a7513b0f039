// Which pixel of the picture is drawn, counted from the lower left. Constant: SOME_ROWS, 1 where the target
// holds only some rows of the picture, because all of them would take too much memory.

#ifndef SOME_ROWS
#define SOME_ROWS 0
#endif
#if SOME_ROWS == 1
uniform int lowest_row;  // of the picture, in the target

ivec2 picture_pixel() {
    return ivec2(gl_FragCoord.xy) + ivec2(0, lowest_row);
}
#else
ivec2 picture_pixel() {
    return ivec2(gl_FragCoord.xy);
}
#endif
