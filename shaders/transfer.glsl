// Light of a display's channels, 0 black and 1 white, to digital values, 0 to 1.
// Twins: relgloss_view/picture/model/tone.py, and relgloss_view/display/monitor.py for what is read
// from an image.

// IEC 61966-2-1:1999. The power is the minimax polynomial (Remez) of 1.055 t^(5/3) - 0.055 in t = v^(1/4),
// within 1.4e-6 of full scale: a tenth of one step of 16 bits, and a third of the time of pow.
float srgb_encode(float v) {
    float t = sqrt(sqrt(max(v, 0.0)));
    float power = -0.0595466087 + t * (0.1396041357 + t * (1.3659210503 + t * (-0.8529574526
                + t * (0.6571882900 + t * (-0.3184159918 + t * 0.0682079792)))));
    return v <= 0.0031308 ? 12.92 * v : power;
}

#ifdef TRANSFER
#if TRANSFER == TRANSFER_CURVES
// A row for each channel: (digital value, what it gains until the next texel) at light (k / last)^4.
uniform sampler2D transfer_curves;
#endif
#if TRANSFER == TRANSFER_TABLE
// Digital values at light (k / last)^(8/3) of each channel; beyond 0 and 1 where none shows that light.
uniform sampler3D transfer_table;
#endif
#endif
#ifdef REACH
#if REACH == 1
uniform sampler3D reach_table;  // as transfer_table, of the display whose gamut counts
#endif
#endif

#ifdef TABLE_NODES
// Where light lies in a table, whose nodes are even in the power of 3/8: closer where digital values are steep.
vec3 table_place(vec3 light) {
    vec3 fourth = sqrt(sqrt(clamp(light, 0.0, 1.0)));
    return (1.0 / TABLE_NODES) * ((TABLE_NODES - 1.0) * (fourth * sqrt(fourth)) + 0.5);
}
#endif

// Digital values by one curve a channel, straight between nodes that lie closer towards black, where
// curves are steep: the fourth root makes both a power of 1.8 and one of 5 smooth.
vec3 curves_encode(vec3 light) {
    vec3 digital = light;
#ifdef TRANSFER
#if TRANSFER == TRANSFER_CURVES
    vec3 at = CURVE_CELLS * min(sqrt(sqrt(light)), vec3(1.0));
    vec3 cell = min(floor(at), vec3(CURVE_CELLS - 1.0));
    vec3 part = at - cell;
    vec3 column = (1.0 / CURVE_CELLS) * (cell + 0.5);
    vec2 r = textureLod(transfer_curves, vec2(column.r, 1.0 / 6.0), 0.0).rg;
    vec2 g = textureLod(transfer_curves, vec2(column.g, 3.0 / 6.0), 0.0).rg;
    vec2 b = textureLod(transfer_curves, vec2(column.b, 5.0 / 6.0), 0.0).rg;
    digital = vec3(r.x, g.x, b.x) + part * vec3(r.y, g.y, b.y);
#endif
#endif
    return digital;
}

// Digital values by a look-up table.
vec3 table_encode(vec3 light) {
    vec3 digital = light;
#ifdef TRANSFER
#if TRANSFER == TRANSFER_TABLE
    digital = clamp(textureLod(transfer_table, table_place(light), 0.0).rgb, 0.0, 1.0);
#endif
#endif
    return digital;
}

// Of digital values, as SLACK of display/table.py.
const float TABLE_SLACK = 0.003;

// Whether a display's table shows light, and by which digital values, not cut to 0 to 1; of a display without one, true.
bool table_reach(vec3 light, out vec3 digital) {
    bool reached = true;
    digital = vec3(0.0);
#ifdef REACH
#if REACH == 1
    digital = textureLod(reach_table, table_place(light), 0.0).rgb;
    reached = all(greaterThan(digital, vec3(-TABLE_SLACK))) && all(lessThan(digital, vec3(1.0 + TABLE_SLACK)));
#endif
#endif
    return reached;
}

// Digital values of light: sRGB; the inverse of (gain d + offset)^gamma + flare (Berns 1996) with
// curve = (gain, offset, gamma, flare), where light is relative to white; or a profile's.
vec3 encode(int transfer, vec3 rgb, vec4 curve) {
    if (transfer == TRANSFER_SRGB) return vec3(srgb_encode(rgb.r), srgb_encode(rgb.g), srgb_encode(rgb.b));
    if (transfer == TRANSFER_CURVES) return curves_encode(rgb);
    if (transfer == TRANSFER_TABLE) return table_encode(rgb);
    float white = pow(curve.x + curve.y, curve.z) + curve.w;
    vec3 light = max(rgb * white - curve.w, 0.0);
    return clamp((pow(light, vec3(1.0 / curve.z)) - curve.y) / curve.x, 0.0, 1.0);
}
