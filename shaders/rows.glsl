// Which pixel of the picture is drawn, counted from the lower left. A target may hold only some rows of the
// picture, because all of them would take too much memory.

uniform int lowest_row;  // of the picture, in the target; 0 where it holds all of them

ivec2 picture_pixel() {
    return ivec2(gl_FragCoord.xy) + ivec2(0, lowest_row);
}
