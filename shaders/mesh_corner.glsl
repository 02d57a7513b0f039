// A triangle of a mesh on the target, larger by BESIDE_PX, and what raster.glsl asks of it. Lateral distances are
// taken from the object's centre, so that a distant eye costs no digits.

#include "raster.glsl"

in vec3 first_m;  // the corners of the triangle
in vec3 second_m;
in vec3 third_m;
in vec2 which;    // number of the triangle, counted from 1; which of its corners is drawn, counted from 0
                  // (softpipe counts wrongly in gl_VertexID and gl_PrimitiveID)

uniform mat3 eye_axes;      // columns: right, up, forward
uniform vec3 eye_along;     // of the eye's place: along these axes
uniform vec4 mesh_frame;    // scale across and up of tangents, and their shift
uniform vec2 mesh_depth;    // depth = x * (along forward) + y
uniform vec2 target_px;     // width and height of the target

flat out ivec4 corners;        // of the first and of the second, steps of the grid
flat out ivec2 last_corner;
flat out vec3 corner_depths;
flat out float turn;           // 1 counter-clockwise, -1 clockwise, 0 where the driver decides

vec4 clip_place(vec3 place_m) {
    vec3 along = place_m * eye_axes;
    vec3 from_eye = along - eye_along;
    return vec4(mesh_frame.xy * from_eye.xy + mesh_frame.zw * from_eye.z,
                mesh_depth.x * along.z + mesh_depth.y, from_eye.z);
}

// On the target: column and row, pixels, and depth.
vec3 target_place(vec4 clip) {
    vec3 ratio = clip.xyz * (1.0 / clip.w);
    return vec3(ratio.xy * (0.5 * target_px) + 0.5 * target_px, 0.5 * ratio.z + 0.5);
}

ivec2 on_grid(vec2 place_px) {
    return ivec2(roundEven(float(GRID) * (place_px - 0.5)));
}

bool is_near(vec4 clip, vec2 place_px) {
    vec2 away = abs(place_px);
    return clip.w > 0.0 && abs(clip.z) <= clip.w && max(away.x, away.y) < MOST_PX;
}

// The corner of a triangle around the one of the places a, b, c (pixels), larger by BESIDE_PX.
vec2 enlarged(vec2 a, vec2 b, vec2 c, float area, int number) {
    float la = distance(b, c);
    float lb = distance(c, a);
    float lc = distance(a, b);
    float around = la + lb + lc;
    float radius = 2.0 * abs(area) / around;  // of the circle inside
    vec2 own = number == 0 ? a : number == 1 ? b : c;
    vec2 centre = (la * a + lb * b + lc * c) / around;
    // Of a sliver, whose enlarged corners would lie far away, a triangle around the rectangle that holds it.
    vec2 from = la >= max(lb, lc) ? b : lb >= lc ? c : a;
    vec2 to = la >= max(lb, lc) ? c : lb >= lc ? a : b;
    float longest = max(max(la, lb), lc);
    vec2 u = (to - from) / longest;
    vec2 v = (area < 0.0 ? -1.0 : 1.0) * vec2(-u.y, u.x);
    vec2 sides = vec2(number == 1 ? 2.0 : 0.0, number == 2 ? 2.0 : 0.0)
               * (vec2(longest, 2.0 * abs(area) / longest) + 2.0 * BESIDE_PX);
    vec2 around_it = from + (sides.x - BESIDE_PX) * u + (sides.y - BESIDE_PX) * v;
    return radius > BESIDE_PX ? own + (own - centre) * (BESIDE_PX / radius) : around_it;
}

// Draw the triangle with its corners moved by so many steps of the grid.
void draw_corner(ivec2 moved) {
    vec4 clip_a = clip_place(first_m);
    vec4 clip_b = clip_place(second_m);
    vec4 clip_c = clip_place(third_m);
    vec3 a = target_place(clip_a);
    vec3 b = target_place(clip_b);
    vec3 c = target_place(clip_c);
    int number = int(which.y);
    bool near = is_near(clip_a, a.xy) && is_near(clip_b, b.xy) && is_near(clip_c, c.xy);
    ivec2 grid_a = on_grid(near ? a.xy : vec2(0.0)) + moved;
    ivec2 grid_b = on_grid(near ? b.xy : vec2(0.0)) + moved;
    ivec2 grid_c = on_grid(near ? c.xy : vec2(0.0)) + moved;
    float twice = side_of(grid_b - grid_a, grid_c - grid_a);
    float step = 1.0 / float(GRID);
    vec2 place = enlarged(vec2(0.0), step * vec2(grid_b - grid_a), step * vec2(grid_c - grid_a),
                          0.5 * step * step * twice, number);
    vec2 whole = place + step * vec2(grid_a) + 0.5;
    corners = ivec4(grid_a, grid_b);
    last_corner = grid_c;
    corner_depths = vec3(a.z, b.z, c.z);
    turn = near ? sign(twice) : 0.0;
    vec4 own = number == 0 ? clip_a : number == 1 ? clip_b : clip_c;
    vec4 seen = twice == 0.0 ? vec4(2.0, 2.0, 0.0, 1.0) : vec4(2.0 * whole / target_px - 1.0, 0.0, 1.0);
    own.xy += 2.0 * step * vec2(moved) / target_px * own.w;
    gl_Position = near ? seen : own;
}
