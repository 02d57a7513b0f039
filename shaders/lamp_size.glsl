// What the size of a lamp does to a lobe; after brdf.glsl. Twin: relgloss_view/picture/model/lights.py.

// Share of the squared facet angle that lies across the plane of incidence, 0 to 1.
float across(vec3 n, vec3 i, vec3 o, Facing f) {
    vec3 beside = cross(i, o);
    float along = dot(n, beside);
    float sine2 = max(f.e2 * (1.0 - 0.25 * f.e2), 1e-12);
    return min(along * along / (max(dot(beside, beside), 1e-12) * sine2), 1.0);
}

// Peak of a Gaussian averaged over a disc, over its own; t2: the disc's squared radius over the variance.
float disc_peak(float t2) {
    float u = 0.5 * t2;
    float small = 1.0 - u * (0.5 - u * ((1.0 / 6.0) - u * (1.0 / 24.0)));
    float wide = max(u, 0.05);
    return u < 0.05 ? small : (1.0 - exp(-wide)) / wide;
}

// Exponent of exp(-u^exponent), 1 for a Gaussian: it grows as the disc outgrows the lobe.
float disc_exponent(float t2) {
    float t = sqrt(t2);
    return 1.0 + 0.61656425 * t2 * t2 / (((t + 3.33675464) * t - 6.02685123) * t + 51.47644039);
}

// What a lamp's size makes of a Gaussian lobe: its squared angle (x), and a factor of its peak (y).
vec2 spread_by_lamp(Facing f, float sharpness, float share_across, float sin2_r) {
    float cos2 = max(f.cos_d * f.cos_d, COSINE_EPSILON);
    float q = 0.125 * sharpness * sin2_r;
    float within = 1.0 + q;
    float beside = 1.0 + q / cos2;
    float along = (1.0 - share_across) / within;
    float aside = share_across / beside;
    float shape = sqrt(within) * sqrt(beside) * (along + aside);
    float peak = sqrt(disc_peak(4.0 * q) * disc_peak(4.0 * q / cos2));
    float stretched = inversesqrt(cos2 * sqrt(cos2));
    float exponent = disc_exponent(4.0 * q * (along + aside * stretched) / (along + aside));
    float x = 1.0 / exponent;  // Gamma(1 + x), within 5e-5 (Abramowitz, Stegun 1964, 6.1.35)
    float gamma = 1.0 + x * (-0.5748646 + x * (0.9512363 + x * (-0.6998588 + x * (0.4245549
                + x * -0.1010678))));
    float u = f.delta2 * sharpness * shape * peak * gamma;
    return vec2(exp(min(exponent * log(max(u, 1e-30)), 5.0)) / sharpness, peak);
}

// A lobe of another kind, or the mean one of grain, as wide all round as the lamp makes it.
Lobe widened(Lobe lobe, float cos_d, float sin2_r) {
    float total = 0.5 / lobe.sharpness;
    float s2 = total / (1.0 + 2.0 * lobe.spread / lobe.sharpness);
    float cosine = sqrt(max(cos_d * cos_d, COSINE_EPSILON));
    float wider2 = s2 / disc_peak(sin2_r / (4.0 * s2 * cosine));
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
