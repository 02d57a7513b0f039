// What the size of a lamp does to a lobe; after brdf.glsl. Twin: relgloss_view/picture/model/lights.py.

// Share of the squared facet angle that lies across the plane of incidence, 0 to 1.
float across(vec3 n, vec3 i, vec3 o, Facing f) {
    vec3 beside = cross(i, o);
    float along = dot(n, beside);
    float sine2 = max(f.e2 * (1.0 - 0.25 * f.e2), 1e-12);
    return min(along * along / (max(dot(beside, beside), 1e-12) * sine2), 1.0);
}

// What a lamp's size makes of a Gaussian lobe: its squared angle (x), and a factor of its peak (y).
vec2 spread_by_lamp(Facing f, float sharpness, float share_across, float sin2_r) {
    float q = 0.125 * sharpness * sin2_r;
    float within = 1.0 + q;
    float beside = 1.0 + q / max(f.cos_d * f.cos_d, COSINE_EPSILON);
    return vec2(f.delta2 * ((1.0 - share_across) / within + share_across / beside),
                inversesqrt(within * beside));
}

// A lobe of another kind, as wide all round as the lamp makes it.
Lobe widened(Lobe lobe, float cos_d, float sin2_r) {
    float total = 0.5 / lobe.sharpness;
    float s2 = total / (1.0 + 2.0 * lobe.spread / lobe.sharpness);
    float add = 0.0625 * sin2_r;
    float wider2 = sqrt((s2 + add) * (s2 + add / max(cos_d * cos_d, COSINE_EPSILON)));
    float tilt2 = total - s2;
    float wide = wider2 + tilt2;
    return Lobe(0.5 / wide, lobe.amplitude * sqrt(total * s2 / (wide * wider2)), lobe.refractive_index,
                tilt2 / (4.0 * wider2 * wide));
}

// The lobe under a lamp of some size, and the orientation at which it is to be evaluated. Constant: FACETS.
void sized(inout Facing f, inout Lobe lobe, float share_across, float sin2_r) {
    if (FACETS == FACETS_GAUSSIAN) {
        vec2 spread = spread_by_lamp(f, lobe.sharpness, share_across, sin2_r);
        f.delta2 = spread.x;
        lobe.amplitude *= spread.y;
    } else {
        lobe = widened(lobe, f.cos_d, sin2_r);
    }
}
