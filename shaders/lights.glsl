// The lamps of a scene: what arrives at a point from each. Twin: relgloss_view/picture/model/lights.py `lit`.
// Constants: LAMPS, 1 to 4; LAMP_SIZE, whether a lamp is a disc.

#ifndef LAMPS
#define LAMPS 1
#endif
#ifndef LAMP_SIZE
#define LAMP_SIZE 0
#endif

#include "lamp.glsl"

#if LAMPS > 1
uniform vec4 further_lamps[3];  // place, metres; intensity over the main lamp's
#endif
#if LAMP_SIZE == 1
uniform float lamp_radius2[4];  // squared, of each lamp
#endif

// The light of one lamp at a point.
struct Arriving {
    vec3 i;              // unit vector to the lamp
    float per_distance2; // share / (d^2 + R^2): irradiance of a surface that faces the lamp
    float sin2_r;        // squared sine of the lamp's angular radius
};

Arriving light_of(int lamp, vec3 point_m) {
    float per_distance2;
    vec3 i = to_lamp(point_m, per_distance2);
    float share = 1.0;
#if LAMPS > 1
    if (lamp > 0) {
        vec4 further = further_lamps[lamp - 1];
        vec3 way = LAMP == LAMP_DISTANT ? further.xyz : further.xyz - point_m;
        float per_distance = inversesqrt(max(dot(way, way), 1e-30));
        per_distance2 = per_distance * per_distance;
        i = way * per_distance;
        share = further.w;
    }
#endif
    float sin2_r = 0.0;
#if LAMP_SIZE == 1
    float tan2_r = lamp_radius2[lamp] * per_distance2;
    sin2_r = tan2_r / (1.0 + tan2_r);
    per_distance2 /= 1.0 + tan2_r;
#endif
#if LAMPS > 1
    per_distance2 *= share;
#endif
    return Arriving(i, per_distance2, sin2_r);
}
