#version 330 core

// The pixels at the silhouette, a point each, drawn over pass 2: the object's colour for the share of the
// pixel that it covers, the surround for the rest, mixed in linear light. A pixel whose sample misses the
// object takes the colour of the nearest pixel that shows it. Its flags in alpha are those of tone.frag.
// The vertex stage does all of it, since a software driver draws a point as a block of 16 pixels.
//   edge_list = (column, row from the bottom, share of the pixel that the object covers)
// Constants: GAMUT, TRANSFER, DITHER, SEEN_ON.

#include "texel.glsl"
#include "tone.glsl"
#include "screen.glsl"

uniform sampler2D edge_list;
uniform sampler2D split_image;
uniform float c;
uniform vec3 display_white;
uniform mat3 rgb_from_xyz;
uniform vec3 display_lowest;  // linear RGB, below which nothing is shown
uniform vec3 background_rgb;

flat out vec4 edge_display;

// Beside a pixel before across its corners.
const ivec2 NEIGHBOURS[8] = ivec2[8](ivec2(-1, 0), ivec2(1, 0), ivec2(0, 1), ivec2(0, -1),
                                     ivec2(-1, 1), ivec2(1, 1), ivec2(-1, -1), ivec2(1, -1));

void main() {
    int wide = textureSize(edge_list, 0).x;
    vec3 place = texelFetch(edge_list, ivec2(gl_VertexID % wide, gl_VertexID / wide), 0).xyz;
    ivec2 at = ivec2(place.xy);
    vec4 split = texel(split_image, at);
    bool own = on_object(split);
    ivec2 last = textureSize(split_image, 0) - 1;
    for (int k = 0; k < 8 && !on_object(split); ++k) {
        split = texel(split_image, clamp(at + NEIGHBOURS[k], ivec2(0), last));
    }
    float share = on_object(split) ? place.z : 0.0;
    bool inside;
    vec3 lab = scaled_lab(split, c);
    vec3 shown = max(display_rgb(GAMUT, lab, display_white, rgb_from_xyz, inside), display_lowest);
    vec3 rgb = share > 0.0 ? over(shown, share, background_rgb) : background_rgb;
    float flags = (lab.x > 100.0 + CLIP_TOLERANCE ? 1.0 : 0.0) + (inside ? 0.0 : 2.0) + (cut_by_screen(shown) ? 4.0 : 0.0);
    float dither = DITHER == DITHER_ORDERED && share > 0.0 ? dither_step(at) : 0.0;
    edge_display = vec4(digital_of(rgb) + (1.0 / 255.0) * dither,
                        1.0 - (1.0 / 255.0) * (own ? flags : 0.0));
    gl_Position = vec4(2.0 * (place.xy + 0.5) * per_size - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
}
