#version 330 core

// The triangles of a mesh as the eye sees them. shader.py writes in what the fragment stage has declared as
// uniforms. Lateral distances are taken from the object's centre, so that a distant eye costs no digits.

in vec3 place_m;
in float number;  // of its triangle, counted from 1; softpipe counts wrongly in gl_VertexID and gl_PrimitiveID

uniform mat3 eye_axes;      // columns: right, up, forward
uniform vec3 eye_along;     // of the eye's place: along these axes
uniform vec4 mesh_frame;    // scale across and up of tangents, and their shift
uniform vec2 mesh_depth;    // depth = x * (along forward) + y

flat out float triangle_number;

//@declare

void main() {
    vec3 along = place_m * eye_axes;
    vec3 from_eye = along - eye_along;
    //@hand-on
    triangle_number = number;
    gl_Position = vec4(mesh_frame.xy * from_eye.xy + mesh_frame.zw * from_eye.z,
                       mesh_depth.x * along.z + mesh_depth.y, from_eye.z);
}
