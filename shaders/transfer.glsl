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

// Digital values of light: sRGB; the inverse of (gain d + offset)^gamma + flare (Berns 1996) with
// curve = (gain, offset, gamma, flare), where light is relative to white; or a profile's.
vec3 encode(int transfer, vec3 rgb, vec4 curve) {
    if (transfer == TRANSFER_SRGB) return vec3(srgb_encode(rgb.r), srgb_encode(rgb.g), srgb_encode(rgb.b));
    if (transfer == TRANSFER_CURVES) return curves_encode(rgb);
    float white = pow(curve.x + curve.y, curve.z) + curve.w;
    vec3 light = max(rgb * white - curve.w, 0.0);
    return clamp((pow(light, vec3(1.0 / curve.z)) - curve.y) / curve.x, 0.0, 1.0);
}
