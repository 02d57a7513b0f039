// From a point of the object to the lamp. Constant: LAMP.

#ifndef LAMP
#define LAMP LAMP_POINT
#endif

uniform vec3 lamp_m;

// Unit vector; `per_distance2` is one over the squared distance.
vec3 to_lamp(vec3 point_m, out float per_distance2) {
    vec3 way = LAMP == LAMP_DISTANT ? lamp_m : lamp_m - point_m;
    float per_distance = inversesqrt(max(dot(way, way), 1e-30));  // a point may be the lamp's own
    per_distance2 = per_distance * per_distance;
    return way * per_distance;
}
