#version 330 core

// The triangles of a mesh at the silhouette, once for each of the places in a pixel (silhouette.glsl). Depth
// tells the places apart: each is deeper than those before it, so that a place of a pixel is counted once,
// however many triangles cover it, where the deeper one passes the test.

#include "silhouette.glsl"

in vec3 place_m;

uniform mat3 eye_axes;      // columns: right, up, forward
uniform vec3 eye_along;     // of the eye's place: along these axes
uniform vec4 mesh_frame;    // scale across and up of tangents, and their shift
uniform vec2 per_target;    // one over the target's width and height

flat out float place_depth;

void main() {
    vec3 from_eye = place_m * eye_axes - eye_along;
    vec2 place = edge_place(gl_InstanceID) - 0.5;
    vec2 shift = 2.0 * vec2(-place.x, place.y) * per_target;
    place_depth = (float(gl_InstanceID) + 1.0) / float(EDGE_RAYS + 1);
    gl_Position = vec4(mesh_frame.xy * from_eye.xy + (mesh_frame.zw + shift) * from_eye.z, 0.0, from_eye.z);
}
