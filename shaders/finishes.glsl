// The light of the finishes that share a place: each has lobes and a diffuse part of its own.
// Constants: FINISHES, LOBES (of a finish, at most), FINISH_METALS (2 bits a finish), FINISH_DIFFUSES (4 bits a
// finish: 0 without a diffuse part, or one more than the model's number), FINISH_INKS (a bit a finish: its
// diffuse part is the artwork's), INK_SECOND (the model of the second albedo of all inks, or -1 where they
// differ), FRESNEL, SHADOWING, FACETS.
// Its numpy twin is the loop over finishes in relgloss_view/picture/reference.py.

#include "finish_look.glsl"

// Of each finish, written in by Python: see relgloss_view/picture/gpu/finishes.py.
const vec4 finish_lobe[2 * FINISHES] = FINISH_LOBE;          // struct Lobe
const vec4 finish_strength[2 * FINISHES] = FINISH_STRENGTH;  // XYZ of the lobe; of a metal's white part
const vec4 finish_terms[FINISHES] = FINISH_TERMS;            // of the roughness: brdf.diffuse_terms
const vec4 finish_albedo[FINISHES] = FINISH_ALBEDO;          // XYZ; of an ink, where nothing is printed
const vec4 finish_second[FINISHES] = FINISH_SECOND;          // XYZ of the second albedo; factor of EON's

uniform mat3 paint_matrix;                   // XYZ of the artwork under D50 -> under the lamp
uniform vec3 lamp_xyz;                       // white of the lamp, whose Y is one

#if INK_SECOND < 0
#include "second_paint.glsl"
#endif

// Diffuse XYZ of a finish under light that its shapes weigh.
vec3 finish_diffuse(int f, Finishes finishes, vec2 weights) {
    int model = ((FINISH_DIFFUSES >> (4 * f)) & 15) - 1;
    bool ink = ((FINISH_INKS >> f) & 1) == 1;
    bool second = model == DIFFUSE_OREN_NAYAR || model == DIFFUSE_EON;
    vec3 bare = weights.x * finish_albedo[f].xyz + (second ? weights.y * finish_second[f].xyz : vec3(0.0));
    if (!ink) return bare;
    vec3 paint = finishes.paint.xyz;
    float alpha = finishes.paint.w;
    vec3 light = weights.x * paint;
    if (second) {
#if INK_SECOND < 0
        light += weights.y * second_paint(model, finishes.paint, finish_second[f].w);
#else
        light += weights.y * finishes.second;
#endif
    }
    return paint_matrix * light + (1.0 - alpha) * bare;
}

// What a lamp's size does to lobes: see lamp_size.glsl.
struct LampSize {
    float share_across;
    float sin2_r;
};

// Specular XYZ of a finish at unit arriving light.
vec3 finish_specular(int f, Facing facing_lamp, LampSize size) {
    vec3 light = vec3(0.0);
    for (int k = 0; k < LOBES; ++k) {
        vec4 shape = finish_lobe[2 * f + k];
        vec4 strength = finish_strength[2 * f + k];
        Lobe lobe = Lobe(shape.x, shape.y, shape.z, shape.w);
        Facing grain = facing_lamp;
#if LAMP_SIZE == 1
        sized(grain, lobe, size.share_across, size.sin2_r);
#endif
        if (((FINISH_METALS >> (2 * f + k)) & 1) == 1) {
            vec2 parts = metal_torrance_sparrow(grain, lobe);
            light += parts.x * strength.xyz + parts.y * strength.w * lamp_xyz;
        } else {
            light += torrance_sparrow(grain, lobe) * strength.xyz;
        }
    }
    return light;
}

// Adds a finish's light to a place. A software driver runs a loop only where some pixel of a block needs it.
void add_finish(int f, Finishes finishes, Facing grain, Facing smooth_surface, float arriving,
                LampSize size, inout vec3 diffuse, inout vec3 specular) {
    float lobes_share = finish_share(finishes, f);
    for (int turn = 0; turn < (lobes_share > 0.0 ? 1 : 0); ++turn) {
        specular += lobes_share * arriving * max(grain.mu_i, 0.0) * finish_specular(f, grain, size);
    }
    if (((FINISH_DIFFUSES >> (4 * f)) & 15) > 0) {
        float share = finish_share(finishes, FINISHES + f);
        int model = ((FINISH_DIFFUSES >> (4 * f)) & 15) - 1;
        for (int turn = 0; turn < (share > 0.0 ? 1 : 0); ++turn) {
            vec2 shapes = diffuse_shapes(model, smooth_surface, finish_terms[f]);
            float lit = share * arriving * max(smooth_surface.mu_i, 0.0);
            diffuse += finish_diffuse(f, finishes, lit * shapes);
        }
    }
}

void finishes_light(Finishes finishes, Facing grain, Facing smooth_surface, float arriving,
                    LampSize size, out vec3 diffuse, out vec3 specular) {
    diffuse = vec3(0.0);
    specular = vec3(0.0);
    add_finish(0, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#if FINISHES > 1
    add_finish(1, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
#if FINISHES > 2
    add_finish(2, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
#if FINISHES > 3
    add_finish(3, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
#if FINISHES > 4
    add_finish(4, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
#if FINISHES > 5
    add_finish(5, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
#if FINISHES > 6
    add_finish(6, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
#if FINISHES > 7
    add_finish(7, finishes, grain, smooth_surface, arriving, size, diffuse, specular);
#endif
}

#if AMBIENT == 1
// What the finishes show of a uniform surround: each has two rows of the table.
vec3 finishes_ambient(Finishes finishes, float mu_o, float smooth_mu_o) {
    vec3 diffuse_albedo = vec3(0.0);
    vec3 lobe_albedo = vec3(0.0);
    for (int f = 0; f < FINISHES; ++f) {
        vec4 lobes = finish_share(finishes, f) * looked_up(2 * f + 1, mu_o);
        for (int k = 0; k < LOBES; ++k) {
            vec4 strength = finish_strength[2 * f + k];
            lobe_albedo += lobes[k] * strength.xyz + lobes[k + 2] * strength.w * lamp_xyz;
        }
        if (((FINISH_DIFFUSES >> (4 * f)) & 15) > 0) {
            float share = finish_share(finishes, FINISHES + f);
            diffuse_albedo += finish_diffuse(f, finishes, share * looked_up(2 * f, smooth_mu_o).xy);
        }
    }
    return surround(diffuse_albedo, lobe_albedo);
}
#endif
