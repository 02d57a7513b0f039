// Pixels to rays. Constant: AFAR. The pixel's column and row count from the top left, as in the picture file.

#include "rows.glsl"

// 1 where a ray that begins at the eye would lose the digits of the object (view.from_afar). There each ray
// begins where it passes the object's centre, and the vectors below are so long that one step back is the eye.
#ifndef AFAR
#define AFAR 0
#endif

uniform vec3 eye_m;  // with AFAR the start of the ray through the picture's centre
uniform vec3 view_right;    // unit
uniform vec3 view_up;       // unit
uniform vec3 view_forward;  // unit
uniform float pixel_step;   // tangent of a pixel's angle at the centre
uniform vec2 view_shift;    // of the picture's centre to the right and up, tangents
uniform ivec2 size_px;

ivec2 pixel() {
    ivec2 from_below = picture_pixel();
    return ivec2(from_below.x, size_px.y - 1 - from_below.y);
}

// Ray through a place inside a pixel, (0.5, 0.5) its centre; not of unit length.
vec3 ray_through(ivec2 pixel, vec2 place) {
    vec2 offset = (vec2(pixel) + place - 0.5 * vec2(size_px)) * pixel_step;
    return view_forward + (offset.x + view_shift.x) * view_right - (offset.y - view_shift.y) * view_up;
}

// Where that ray begins.
vec3 start_m(ivec2 pixel, vec2 place) {
#if AFAR == 1
    vec2 offset = (vec2(pixel) + place - 0.5 * vec2(size_px)) * pixel_step;
    return eye_m + ((offset.x + view_shift.x) * view_right - (offset.y - view_shift.y) * view_up);
#else
    return eye_m;
#endif
}
