// The artwork's colour for the second albedo of a diffuse model, channel by channel of linear sRGB. Twin:
// relgloss_view/pack/paint.py.

uniform mat3 rgb_from_paint;  // XYZ of the artwork under D50 -> linear sRGB, whose white is D50's
uniform mat3 paint_from_rgb;

// paint: XYZ times alpha, and alpha. mean: factor of EON's.
vec3 second_paint(int model, vec4 paint, float mean) {
    float per_alpha = paint.w > 0.0 ? 1.0 / max(paint.w, 1e-6) : 0.0;
    vec3 rho = clamp(rgb_from_paint * paint.xyz * per_alpha, 0.0, 1.0);
    vec3 second = rho * rho;
    if (model == DIFFUSE_EON) second *= mean / (1.0 - rho * (1.0 - mean));
    return paint.w * (paint_from_rgb * second);
}
