// Reflection models. Twin: relgloss_view/material/brdf.py, which tells more of each formula.

const float PI = 3.14159265358979;
const float AZIMUTH_EPSILON = 1e-7;  // below it cos(phi) is undefined, and its terms vanish
const float EON_EPSILON = 1e-7;
const float COSINE_EPSILON = 1e-4;  // only guards divisions whose product is already zero

struct Facing {
    float mu_i;    // cosine of incidence
    float mu_o;    // cosine of viewing
    float t;       // sin_i sin_o cos(phi)
    float sin_i;
    float sin_o;
    float cos_d;   // cosine between i and the half-vector
    float e2;      // squared distance between normal and half-vector: 2 - 2 cos(delta)
    float delta2;  // squared angle between them
};

// Squared angle between two nearly parallel unit vectors from e2 = |n - h|^2 = 4 sin^2(delta/2): the
// series of arcsin^2. acos(n.h) loses half the digits in float32; this keeps them, without trig. Six
// terms are within 1e-6 of delta^2 up to 45 degrees and 0.1 % at 90.
float squared_angle(float e2) {
    return e2 * (1.0 + e2 * (1.0 / 12.0 + e2 * (1.0 / 90.0 + e2 * (1.0 / 560.0
         + e2 * (1.0 / 3150.0 + e2 * (1.0 / 16632.0))))));
}

Facing facing(vec3 n, vec3 i, vec3 o) {
    float mu_i = dot(n, i);
    float mu_o = dot(n, o);
    vec3 tangent_i = i - n * mu_i;
    vec3 tangent_o = o - n * mu_o;
    vec3 h = i + o;
    float size = length(h);
    bool defined = size > AZIMUTH_EPSILON;
    vec3 e = n - h / (defined ? size : 1.0);
    float e2 = defined ? dot(e, e) : 2.0;
    float delta2 = defined ? squared_angle(e2) : 0.25 * PI * PI;
    return Facing(mu_i, mu_o, dot(tangent_i, tangent_o), length(tangent_i), length(tangent_o),
                  defined ? 0.5 * size : 0.0, e2, delta2);
}

bool above(Facing f) {
    return f.mu_i > 0.0 && f.mu_o > 0.0 && f.cos_d > 0.0;
}

// --- specular: Torrance, Sparrow 1967 -------------------------------------------------------------

// Unpolarised dielectric reflectance (Cook, Torrance 1982), over one common denominator.
float fresnel_dielectric(float cos_d, float n) {
    float c = abs(cos_d);
    float q = sqrt(max(n * n - 1.0 + c * c, 0.0));
    float low = q - c;
    float high = max(q + c, 1e-12);
    float s = c * high - 1.0;
    float p = c * low + 1.0;
    float under = high * p;
    return 0.5 * low * low * (p * p + s * s) / (under * under);
}

// w = (1 - cos)^5 (Schlick 1994): the share of the way from normal incidence to grazing.
float schlick_weight(float cos_d) {
    float m = 1.0 - abs(cos_d);
    float m2 = m * m;
    return m2 * m2 * m;
}

// Gaussian in the facet's angle (Torrance, Sparrow 1967). sharpness = 1 / (2 s^2); `amplitude` makes
// D cos(delta) integrate to one and comes from brdf.facet_amplitude.
float facet_density(float delta2, float sharpness, float amplitude) {
    return amplitude * exp(-delta2 * sharpness);
}

// G / (cos_i cos_o), V-groove G (Torrance, Sparrow 1967; Cook, Torrance 1982), divided through: the
// smaller of 1 / open and sum / groove.
float shadowing(Facing f) {
    float mu_i = max(f.mu_i, 0.0);
    float mu_o = max(f.mu_o, 0.0);
    float open = max(mu_i * mu_o, COSINE_EPSILON * COSINE_EPSILON);
    float groove = max(f.cos_d * f.cos_d, COSINE_EPSILON * COSINE_EPSILON)
                 * max(max(mu_i, mu_o), COSINE_EPSILON);
    float sum = mu_i + mu_o;
    bool lit = groove < open * sum;
    return (lit ? 1.0 : sum) / (lit ? open : groove);
}

#include "approximations.glsl"

// Constants: FRESNEL, SHADOWING, FACETS.
float torrance_sparrow(Facing f, Lobe lobe) {
    float open = SHADOWING == SHADOWING_V_GROOVE ? shadowing(f) : unshadowed(f);
    float reflected = 0.25 * facets(FACETS, f, lobe) * fresnel(FRESNEL, f.cos_d, lobe.refractive_index)
                    * open;
    return above(f) ? reflected : 0.0;
}

// A metal's lobe in two parts (Schlick 1994): 1 - w (x), which carries the colour of F0, and w (y), white.
vec2 metal_torrance_sparrow(Facing f, Lobe lobe) {
    float open = SHADOWING == SHADOWING_V_GROOVE ? shadowing(f) : unshadowed(f);
    float density = 0.25 * facets(FACETS, f, lobe) * open;
    float weight = schlick_weight(f.cos_d);
    return above(f) ? density * vec2(1.0 - weight, weight) : vec2(0.0);
}

// --- diffuse: shapes for the albedo (x) and for a second albedo (y) -------------------------------

vec2 lambert(Facing f) {
    return vec2(f.mu_i > 0.0 && f.mu_o > 0.0 ? 1.0 / PI : 0.0, 0.0);
}

// Angle of a cosine from 0 to 1, within 2e-8 (Abramowitz, Stegun 1964, 4.4.46).
float polar_angle(float mu) {
    float p = -0.0012624911;
    p = p * mu + 0.0066700901;
    p = p * mu - 0.0170881256;
    p = p * mu + 0.0308918810;
    p = p * mu - 0.0501743046;
    p = p * mu + 0.0889789874;
    p = p * mu - 0.2145988016;
    p = p * mu + 1.5707963050;
    return sqrt(max(1.0 - mu, 0.0)) * p;
}

// Full model of Oren, Nayar 1995, for rho and rho^2. terms = (C1, the factors of C2 and C3, the
// interreflection's factor).
vec2 oren_nayar(Facing f, vec4 terms) {
    bool lit = f.mu_i > 0.0 && f.mu_o > 0.0;
    float product = f.sin_i * f.sin_o;
    float cos_phi = product > AZIMUTH_EPSILON ? clamp(f.t / product, -1.0, 1.0) : 0.0;
    float a = polar_angle(min(f.mu_i, f.mu_o));
    float b = polar_angle(max(f.mu_i, f.mu_o));
    float sin_a = max(f.sin_i, f.sin_o);
    float sin_b = min(f.sin_i, f.sin_o);
    float b_unit = (2.0 / PI) * b;
    float c2 = terms.y * (sin_a - (cos_phi >= 0.0 ? 0.0 : b_unit * b_unit * b_unit));
    float ab = (4.0 / (PI * PI)) * a * b;
    float c3 = terms.z * ab * ab;
    float tan_b = sin_b / max(max(f.mu_i, f.mu_o), COSINE_EPSILON);
    float tan_mean = (sin_a + sin_b) / max(f.mu_i + f.mu_o, COSINE_EPSILON);
    float first = terms.x + cos_phi * c2 * tan_b + (1.0 - abs(cos_phi)) * c3 * tan_mean;
    float second = terms.w * (1.0 - cos_phi * b_unit * b_unit);
    return lit ? vec2(max(first, 0.0), second) * (1.0 / PI) : vec2(0.0);
}

float fujii_albedo(float mu, float r, float normalisation) {
    float m = 1.0 - mu;
    float g = m * (0.0571085289 + m * (0.491881867 + m * (-0.332181442 + m * 0.0714429953)));
    return (1.0 + r * g) * normalisation;
}

// Energy-preserving Oren-Nayar (Portsmouth, Kutz, Hill 2025), for rho and rho_ms. terms = (r, A_F, one
// over what the mean albedo misses of 1, 0).
vec2 eon(Facing f, vec4 terms) {
    bool lit = f.mu_i > 0.0 && f.mu_o > 0.0;
    float mu_i = min(f.mu_i, 1.0);
    float mu_o = min(f.mu_o, 1.0);
    float s_over_t = f.t > 0.0 ? f.t / max(max(mu_i, mu_o), COSINE_EPSILON) : f.t;
    float first = terms.y * (1.0 + terms.x * s_over_t);
    float missing_i = max(EON_EPSILON, 1.0 - fujii_albedo(mu_i, terms.x, terms.y));
    float missing_o = max(EON_EPSILON, 1.0 - fujii_albedo(mu_o, terms.x, terms.y));
    float second = missing_i * missing_o * terms.z;
    return lit ? vec2(max(first, 0.0), second) * (1.0 / PI) : vec2(0.0);
}

// Qualitative model of Oren, Nayar 1995 (their eq. 32 without interreflection), for rho. terms as theirs.
vec2 qualitative_oren_nayar(Facing f, vec4 terms) {
    bool lit = f.mu_i > 0.0 && f.mu_o > 0.0;
    float s_over_t = max(f.t, 0.0) / max(max(f.mu_i, f.mu_o), COSINE_EPSILON);
    return vec2(lit ? (1.0 / PI) * (terms.x + terms.y * s_over_t) : 0.0, 0.0);
}

// `terms`: what a model needs of its roughness, worked out once a picture by brdf.diffuse_terms.
vec2 diffuse_shapes(int model, Facing f, vec4 terms) {
    if (model == DIFFUSE_LAMBERT) return lambert(f);
    if (model == DIFFUSE_OREN_NAYAR) return oren_nayar(f, terms);
    if (model == DIFFUSE_QUALITATIVE) return qualitative_oren_nayar(f, terms);
    return eon(f, terms);
}
