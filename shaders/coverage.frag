#version 330 core

// The share of each pixel that the object covers, for smooth silhouettes; drawn in the tiles that the
// silhouette passes through. All objects are convex, so a pixel whose corners, sides and middle meet the
// object lies inside it; only a pixel of which some do and some don't casts the other rays.
// Twin: relgloss_view/picture/model/silhouette.py. Constants: SHAPE, CAPS, AFAR.

#include "view.glsl"
#include "shape.glsl"
#include "silhouette.glsl"

uniform vec3 half_extent_m;

layout(location = 0) out float coverage;

bool met(ivec2 here, vec2 place) {
    return meet(SHAPE, start_m(here, place), ray_through(here, place), half_extent_m).found;
}

void main() {
    ivec2 here = pixel();
    int tried = 0;
    for (int k = 0; k < TRIED; ++k) tried += met(here, 0.5 * vec2(float(k % 3), float(k / 3))) ? 1 : 0;
    int count = tried == TRIED ? EDGE_RAYS : 0;
    int rays = tried > 0 && tried < TRIED ? EDGE_RAYS : 0;
    for (int k = 0; k < rays; ++k) count += met(here, edge_place(k)) ? 1 : 0;
    coverage = float(count) / float(EDGE_RAYS);
}
