// Which places of a target a triangle covers. Drivers round its corners differently (OpenGL asks for 1/16 of a
// pixel, most take 1/256), so each would show another side at a silhouette. Here corners lie on a grid of 1/256
// and whole numbers decide, so that every driver decides alike; the triangle that the driver draws is larger by
// BESIDE_PX and hands on its places. Its vertices: mesh_corner.glsl.

const int GRID = 256;             // steps a pixel
const float BESIDE_PX = 0.0625;   // more than a driver moves a side: sqrt(1/2) of 1/16
const float LARGE = 268435456.0;  // below it the whole number is exact: float32 errs by less than 2^30
const float MOST_PX = 16384.0;    // places beyond it are left to the driver

// Twice the area of the place of origin, p and q: above 0 where p to q turns left about it.
float side_of(ivec2 p, ivec2 q) {
    float rough = float(p.x) * float(q.y) - float(p.y) * float(q.x);
    int whole = p.x * q.y - p.y * q.x;  // of what does not fit, the low bits
    return abs(rough) < LARGE ? float(whole) : rough;
}

// Whether the side of a triangle that runs so, counter-clockwise, has a place: of two triangles beside a side one.
bool has(float side, vec2 along) {
    return side > 0.0 || (side == 0.0 && (along.y < 0.0 || (along.y == 0.0 && along.x > 0.0)));
}

// Whether corners, relative to a place, have it. sides: of the corners opposite, counter-clockwise. turn: -1 where
// the corners turn clockwise, else 1.
bool covers(ivec2 a, ivec2 b, ivec2 c, float turn, out vec3 sides) {
    sides = turn * vec3(side_of(b, c), side_of(c, a), side_of(a, b));
    return has(sides.x, turn * vec2(c - b)) && has(sides.y, turn * vec2(a - c)) && has(sides.z, turn * vec2(b - a));
}
