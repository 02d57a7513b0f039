// What a place of a pixel sees of the object: met by its ray, or read from what surface.frag wrote.
// Constants: SURFACE, FINISHES, SAMPLED.

#ifndef SURFACE
#define SURFACE SURFACE_MET
#endif
#ifndef FINISHES
#define FINISHES 0
#endif

#if SURFACE == SURFACE_READ
uniform sampler2D surface_point;   // point (m) and face
uniform sampler2D surface_normal;  // unit normal, 1 where the object is seen
uniform ivec2 surface_from;        // lower left of the texels that it holds, in texels of the picture
uniform vec2 per_surface;          // one over its width and height, texels

// Coordinates of the texel of a place: there are `samples` of them along each side of a pixel.
vec2 surface_at(ivec2 here, vec2 place) {
    ivec2 texel = ivec2(here.x, size_px.y - 1 - here.y);
    if (SAMPLED == 1) {
        ivec2 inner = ivec2(floor(place * float(samples)));
        texel = samples * texel + ivec2(inner.x, samples - 1 - inner.y);
    }
    return (vec2(texel - surface_from) + 0.5) * per_surface;
}

// Coordinates along the surface of a point of an analytic shape, as `meet` has them.
vec2 along_surface(vec3 point_m, vec3 n, int face) {
    if (SHAPE == SHAPE_CYLINDER && face == 0)
        return vec2(arc_tangent(n.x, n.z) * half_extent_m.x, point_m.y);
    if (SHAPE == SHAPE_CYLINDER) return point_m.xz;
    if (SHAPE == SHAPE_SPHERE)
        return half_extent_m.x * vec2(arc_tangent(n.x, n.z), arc_tangent(n.y, length(n.xz)));
    if (SHAPE == SHAPE_BOX && face < 2) return point_m.zy;
    return SHAPE == SHAPE_BOX && face < 4 ? point_m.xz : point_m.xy;
}

Hit seen(ivec2 here, vec2 place, vec3 ray) {
    vec2 at = surface_at(here, place);
    vec4 point = textureLod(surface_point, at, 0.0);
    vec4 normal = textureLod(surface_normal, at, 0.0);
    int face = int(point.w);
    vec2 surface_m = SHAPE == SHAPE_TRIANGLES ? vec2(0.0) : along_surface(point.xyz, normal.xyz, face);
    return Hit(normal.w > 0.5, point.xyz, normal.xyz, surface_m, face);
}
#else
Hit seen(ivec2 here, vec2 place, vec3 ray) {
    return meet(SHAPE, start_m(here, place), ray, half_extent_m);
}
#endif
