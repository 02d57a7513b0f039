// CIEDE2000 (Sharma, Wu, Dalal 2005, "The CIEDE2000 color-difference formula"), all weights one.
// Twin: relgloss_view/picture/model/difference.py.

const float TURN = 6.28318530717959;

// sqrt(C^7 / (C^7 + 25^7)), with C in units of 25, so that no power passes float32.
float chroma_weight(float chroma) {
    float c = chroma / 25.0;
    float c7 = c * c * c * c * c * c * c;
    return sqrt(c7 / (c7 + 1.0));
}

float hue(float a, float b) {
    float angle = a == 0.0 && b == 0.0 ? 0.0 : atan(b, a);
    return angle < 0.0 ? angle + TURN : angle;
}

float delta_e_2000(vec3 first, vec3 second) {
    float mean_chroma = 0.5 * (length(first.yz) + length(second.yz));
    float stretch = 1.5 - 0.5 * chroma_weight(mean_chroma);
    vec2 p = vec2(first.y * stretch, first.z);
    vec2 q = vec2(second.y * stretch, second.z);
    float c1 = length(p);
    float c2 = length(q);
    float h1 = hue(p.x, p.y);
    float h2 = hue(q.x, q.y);
    bool gray = c1 * c2 == 0.0;
    float turn = h2 - h1;
    if (abs(turn) > 0.5 * TURN) turn += turn > 0.0 ? -TURN : TURN;
    if (gray) turn = 0.0;
    float hue_difference = 2.0 * sqrt(c1 * c2) * sin(0.5 * turn);
    float hue_sum = h1 + h2;
    float mean_hue = abs(h1 - h2) > 0.5 * TURN
        ? 0.5 * (hue_sum < TURN ? hue_sum + TURN : hue_sum - TURN) : 0.5 * hue_sum;
    if (gray) mean_hue = hue_sum;
    float lightness_offset = 0.5 * (first.x + second.x) - 50.0;
    float l2 = lightness_offset * lightness_offset;
    float c_mean = 0.5 * (c1 + c2);
    float t = 1.0 - 0.17 * cos(mean_hue - radians(30.0)) + 0.24 * cos(2.0 * mean_hue)
        + 0.32 * cos(3.0 * mean_hue + radians(6.0)) - 0.20 * cos(4.0 * mean_hue - radians(63.0));
    float bump = (degrees(mean_hue) - 275.0) / 25.0;
    float rotation = -sin(2.0 * radians(30.0 * exp(-bump * bump))) * 2.0 * chroma_weight(c_mean);
    float l = (second.x - first.x) / (1.0 + 0.015 * l2 / sqrt(20.0 + l2));
    float c = (c2 - c1) / (1.0 + 0.045 * c_mean);
    float h = hue_difference / (1.0 + 0.015 * c_mean * t);
    return sqrt(max(l * l + c * c + h * h + rotation * c * h, 0.0));
}
