// Where a ray meets the object. Twin: relgloss_view/picture/model/shape.py.
//
// All objects are convex and centred at the origin, so the first meeting is the only visible one and
// a surface that faces the lamp is lit. Closest-approach forms keep the digits of the normal near the
// silhouette (Haines et al. 2019, "Precision improvements for ray/sphere intersection").

// 0 where the eye is between a cylinder's caps, so that it sees neither.
#ifndef CAPS
#define CAPS 1
#endif

// With AFAR a ray begins beside the object and the eye lies one step back (view.glsl): digits of the object that
// are lost between it and a distant eye are kept. Which side of the object is seen follows from the ray.
#ifndef AFAR
#define AFAR 0
#endif
const float BEHIND = AFAR == 1 ? -1.0 : 0.0;  // of travel: up to here a point is behind the eye

// Where nothing is found the rest is finite or not, and means nothing: choose by `found`, never multiply.
struct Hit {
    bool found;
    vec3 point_m;
    vec3 normal;
    vec2 surface_m;  // coordinates along the surface, for the grain
    int face;
};

const float TINY = 1e-30;  // only guards a division whose result is not used

// Angle of the point (x, y), -pi to pi, to 3e-7: the range reduction and polynomial of Moshier's Cephes
// library (atanf). The language leaves the precision of its own atan open, and a grain's cell must not
// depend on the driver.
float arc_tangent(float y, float x) {
    float ax = abs(x);
    float ay = abs(y);
    float large = max(ax, ay);
    float t = large > 0.0 ? min(ax, ay) / large : 0.0;
    bool upper = t > 0.4142135623730950;
    float u = upper ? (t - 1.0) / (t + 1.0) : t;
    float z = u * u;
    float angle = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z
                   - 3.33329491539e-1) * z * u + u;
    if (upper) angle += 0.785398163397448;
    if (ay > ax) angle = 1.57079632679490 - angle;
    if (x < 0.0) angle = 3.14159265358979 - angle;
    return y < 0.0 ? -angle : angle;
}

// Round cylinder about y, closed by two caps. half_extent_m = (radius, half height, radius).
Hit meet_cylinder(vec3 start_m, vec3 ray, vec3 half_extent_m) {
    float radius = half_extent_m.x;
    vec2 along = ray.xz;
    float length2 = dot(along, along);
    float moment = start_m.x * along.y - start_m.z * along.x;  // distance to the axis, times |along|
    float reach = radius * sqrt(length2);
    float discriminant = (reach - abs(moment)) * (reach + abs(moment));
    float root = sqrt(max(discriminant, 0.0));
    float scale = 1.0 / (max(length2, TINY) * radius);
    float travel = (-dot(start_m.xz, along) - root) * radius * scale;
    float y = start_m.y + travel * ray.y;
    bool side = length2 > 0.0 && discriminant >= 0.0 && travel > BEHIND && abs(y) <= half_extent_m.y;
    vec2 around = (moment * vec2(along.y, -along.x) - root * along) * scale;
    vec3 n = vec3(around.x, 0.0, around.y);
    vec3 p = vec3(n.x * radius, y, n.z * radius);
    vec2 surface = vec2(arc_tangent(n.x, n.z) * radius, y);
    if (CAPS == 0) return Hit(side, p, n, surface, 0);
    float up = (AFAR == 1 ? -ray.y : start_m.y) > 0.0 ? 1.0 : -1.0;
    float cap = up * half_extent_m.y;
    float to_cap = abs(ray.y) > 0.0 ? (cap - start_m.y) / ray.y : BEHIND - 1.0;
    vec2 q = start_m.xz + to_cap * ray.xz;
    bool on_cap = !side && to_cap > BEHIND && dot(q, q) <= radius * radius;
    return Hit(side || on_cap, on_cap ? vec3(q.x, cap, q.y) : p, on_cap ? vec3(0.0, up, 0.0) : n,
               on_cap ? q : surface, on_cap ? (up > 0.0 ? 1 : 2) : 0);
}

Hit meet_sphere(vec3 start_m, vec3 ray, vec3 half_extent_m) {
    float radius = half_extent_m.x;
    float length2 = dot(ray, ray);
    vec3 moment = cross(start_m, ray);
    float reach = radius * sqrt(length2);
    float distance_scaled = length(moment);
    float discriminant = (reach - distance_scaled) * (reach + distance_scaled);
    float root = sqrt(max(discriminant, 0.0));
    bool found = discriminant >= 0.0 && -dot(start_m, ray) - root > BEHIND * length2;
    vec3 n = normalize((cross(ray, moment) - root * ray) / (length2 * radius));
    vec2 surface = radius * vec2(arc_tangent(n.x, n.z), arc_tangent(n.y, length(n.xz)));
    return Hit(found, n * radius, n, surface, 0);
}

// Rectangle in x-y that faces +z; nothing is seen from behind.
Hit meet_plane(vec3 start_m, vec3 ray, vec3 half_extent_m) {
    bool facing = (AFAR == 1 || start_m.z > 0.0) && ray.z < 0.0;
    float back = facing ? start_m.z / ray.z : 0.0;
    vec2 p = start_m.xy - back * ray.xy;
    bool found = facing && (AFAR == 0 || -back > BEHIND) && all(lessThanEqual(abs(p), half_extent_m.xy));
    return Hit(found, vec3(p, 0.0), vec3(0.0, 0.0, 1.0), p, 0);
}

// One face of the box, square to `axis` (a unit vector), met only from outside (Kay, Kajiya 1986).
bool meet_face(vec3 start_m, vec3 ray, vec3 half_extent_m, vec3 axis, out vec3 point_m, out float side) {
    float from = dot(start_m, axis);
    float half_m = dot(half_extent_m, axis);
    float along = dot(ray, axis);
    side = (AFAR == 1 ? -along : from) > 0.0 ? 1.0 : -1.0;
    bool facing = (AFAR == 1 || abs(from) > half_m) && along * side < 0.0;
    float travel = facing ? (side * half_m - from) / along : BEHIND - 1.0;
    vec3 p = start_m + travel * ray;
    point_m = mix(p, vec3(side * half_m), axis);  // exactly on the face
    return travel > BEHIND && all(lessThanEqual(abs(point_m), half_extent_m));
}

Hit meet_box(vec3 start_m, vec3 ray, vec3 half_extent_m) {
    const vec3 X = vec3(1.0, 0.0, 0.0);
    const vec3 Y = vec3(0.0, 1.0, 0.0);
    const vec3 Z = vec3(0.0, 0.0, 1.0);
    vec3 x, y, z;
    vec3 side;
    bool on_x = meet_face(start_m, ray, half_extent_m, X, x, side.x);
    bool on_y = meet_face(start_m, ray, half_extent_m, Y, y, side.y);
    bool on_z = meet_face(start_m, ray, half_extent_m, Z, z, side.z);
    vec3 p = on_x ? x : on_y ? y : z;
    vec3 n = on_x ? side.x * X : on_y ? side.y * Y : side.z * Z;
    vec2 surface = on_x ? x.zy : on_y ? y.xz : z.xy;
    int face = on_x ? 0 : on_y ? 2 : 4;
    return Hit(on_x || on_y || on_z, p, n, surface, face + (n.x + n.y + n.z > 0.0 ? 0 : 1));
}

Hit meet(int shape, vec3 start_m, vec3 ray, vec3 half_extent_m) {
    if (shape == SHAPE_CYLINDER) return meet_cylinder(start_m, ray, half_extent_m);
    if (shape == SHAPE_SPHERE) return meet_sphere(start_m, ray, half_extent_m);
    if (shape == SHAPE_PLANE) return meet_plane(start_m, ray, half_extent_m);
    return meet_box(start_m, ray, half_extent_m);
}

// Grain cell of triangles: a cell of a lattice in space, whose mean section with a plane has the area of a
// cell. It is turned, so that no flat face of a form lies along it (a rotation of whole numbers by 7).
ivec3 solid_cell(vec3 point_m, float cell_m) {
    vec3 turned = (1.0 / 7.0) * vec3(dot(point_m, vec3(2.0, 3.0, 6.0)), dot(point_m, vec3(3.0, -6.0, 2.0)),
                                     dot(point_m, vec3(6.0, 2.0, -3.0)));
    return ivec3(floor(turned / (1.2247 * cell_m)));
}

// cos(x) for x from -pi/2 to pi/2, by the series of the sine to y^11, within 6e-8. The language leaves the
// precision of its own cos open, and how many cells stand around a sphere must not depend on the driver.
float cosine(float x) {
    float y = 1.57079632679490 - abs(x);
    float y2 = y * y;
    return y * (1.0 - y2 * (1.0 / 6.0 - y2 * (1.0 / 120.0 - y2 * (1.0 / 5040.0
             - y2 * (1.0 / 362880.0 - y2 * (1.0 / 39916800.0))))));
}

// Grain cell on the surface: column, row, face. Around a cylinder or a row of a sphere stands a whole
// number of cells, so that no seam shows; a sphere's rows hold fewer towards the poles.
ivec3 surface_cell(int shape, Hit hit, float cell_m, vec3 half_extent_m) {
    if (shape == SHAPE_TRIANGLES) return solid_cell(hit.point_m, cell_m);
    float row = floor(hit.surface_m.y / cell_m);
    bool around = shape == SHAPE_SPHERE || (shape == SHAPE_CYLINDER && hit.face == 0);
    if (!around) return ivec3(int(floor(hit.surface_m.x / cell_m)), int(row), hit.face);
    float turn = 6.28318530717959 * half_extent_m.x;
    float girth = shape == SHAPE_SPHERE ? turn * cosine((row + 0.5) * cell_m / half_extent_m.x) : turn;
    float columns = max(1.0, floor(girth / cell_m + 0.5));
    float column = min(floor((hit.surface_m.x / turn + 0.5) * columns), columns - 1.0);
    return ivec3(int(column), int(row), hit.face);
}
