// What stands in for Torrance-Sparrow's exact parts where a scene needs no more, and on the chart of speed
// against accuracy. Twin: relgloss_view/material/approximations.py. Constants: FRESNEL, SHADOWING, FACETS.

#ifndef FRESNEL
#define FRESNEL FRESNEL_EXACT
#endif
#ifndef SHADOWING
#define SHADOWING SHADOWING_V_GROOVE
#endif
#ifndef FACETS
#define FACETS FACETS_GAUSSIAN
#endif

// A lobe as drawn: its facets and its reflectance at normal incidence. A Gaussian in the angle has
// sharpness 1 / (2 s^2); `spread` is 0 but for FACETS_MEAN_GAUSSIAN.
struct Lobe {
    float sharpness;
    float amplitude;
    float refractive_index;
    float spread;
};

// Reflectance of Schlick 1994, which leans on normal incidence.
float fresnel_schlick(float cos_d, float n) {
    float f0 = (n - 1.0) * (n - 1.0) / ((n + 1.0) * (n + 1.0));
    float m = 1.0 - abs(cos_d);
    float m2 = m * m;
    return f0 + (1.0 - f0) * m2 * m2 * m;
}

float fresnel(int model, float cos_d, float n) {
    if (model == FRESNEL_EXACT) return fresnel_dielectric(cos_d, n);
    if (model == FRESNEL_SCHLICK) return fresnel_schlick(cos_d, n);
    return (n - 1.0) * (n - 1.0) / ((n + 1.0) * (n + 1.0));
}

// Beckmann, Spizzichino 1963 with the slope m = sqrt(2) s: Gaussian in tan(delta).
float beckmann_density(float e2, float sharpness) {
    float s2 = e2 * (1.0 - 0.25 * e2);  // sin^2(delta) without losing digits
    float c2 = max(1.0 - s2, COSINE_EPSILON * COSINE_EPSILON);
    return sharpness / (PI * c2 * c2) * exp(-sharpness * s2 / c2);
}

// Trowbridge, Reitz 1975 (GGX: Walter et al. 2007) with alpha = sqrt(2) s.
float ggx_density(float e2, float sharpness) {
    float s2 = e2 * (1.0 - 0.25 * e2);
    float a2 = 1.0 / sharpness;
    float under = a2 + s2 * (1.0 - a2);
    return a2 / (PI * under * under);
}

// exp(-z) I0(z), z >= 0, within 3e-7 (Abramowitz, Stegun 1964, 9.8.1 and 9.8.2).
float bessel_i0e(float z) {
    float t = z * z / 14.0625;
    float small = exp(-z) * (1.0 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492 + t * (0.2659732
                + t * (0.0360768 + t * 0.0045813))))));
    float far = max(z, 3.75);
    float u = 3.75 / far;
    float large = inversesqrt(far) * (0.39894228 + u * (0.01328592 + u * (0.00225319 + u * (-0.00157565
                + u * (0.00916281 + u * (-0.02057706 + u * (0.02635537 + u * (-0.01647633
                + u * 0.00392377))))))));
    return z < 3.75 ? small : large;
}

// FACETS_MEAN_GAUSSIAN is the mean of the lobe over the tilt of the normals (noise.mean_lobe), with the width,
// the amplitude and the spread that come with it.
float facets(int model, Facing f, Lobe lobe) {
    if (model == FACETS_BECKMANN) return beckmann_density(f.e2, lobe.sharpness);
    if (model == FACETS_GGX) return ggx_density(f.e2, lobe.sharpness);
    float density = facet_density(f.delta2, lobe.sharpness, lobe.amplitude);
    if (model == FACETS_MEAN_GAUSSIAN) density *= bessel_i0e(lobe.spread * f.delta2);
    return density;
}

// 1 / (cos_i cos_o), as if no facet stood in another's light.
float unshadowed(Facing f) {
    return 1.0 / max(max(f.mu_i, 0.0) * max(f.mu_o, 0.0), COSINE_EPSILON * COSINE_EPSILON);
}
