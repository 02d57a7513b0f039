// What a material shows of a uniform surround. Twin: relgloss_view/material/albedo_table.py.

// Two rows a material: the albedos of the diffuse model's two shapes; those of the lobes, weighted as
// the lobes are in shade.frag. Columns are even in the square root of the cosine to the eye.
uniform sampler2D albedo_table;
uniform float ambient;  // radiance of the surround over that of Y_n

const float ALBEDO_STEPS = 256.0;  // as STEPS of the twin

vec4 looked_up(int row, float mu_o) {
    float place = sqrt(clamp(mu_o, 0.0, 1.0)) * ALBEDO_STEPS;
    float entry = min(floor(place), ALBEDO_STEPS - 1.0);
    vec4 low = texelFetch(albedo_table, ivec2(int(entry), row), 0);
    vec4 high = texelFetch(albedo_table, ivec2(int(entry) + 1, row), 0);
    return mix(low, high, place - entry);
}

// XYZ that the surround shows, of the albedos of the diffuse part and of the lobes. Both belong to the
// diffuse picture: contrast gloss scales images of lamps, and the surround has no contrast. No surface
// shows more of a surround than the perfect diffuser: where the model's parts would, the lobes give way.
vec3 surround(vec3 diffuse_albedo, vec3 lobe_albedo) {
    float room = clamp((1.0 - diffuse_albedo.y) / max(lobe_albedo.y, 1e-9), 0.0, 1.0);
    return ambient * (diffuse_albedo + room * lobe_albedo);
}
