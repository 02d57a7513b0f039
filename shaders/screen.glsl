// The last steps to the screen: light of the picture's display, carried to the screen that shows it where
// that is another one (SEEN_ON), and its digital values. Twin: relgloss_view/picture/model/tone.py.
// Constants: TRANSFER, SEEN_ON.

#include "transfer.glsl"

uniform vec4 display_curve;     // gain, offset, gamma, flare
uniform vec3 screen_floor;      // linear RGB under what the transfer gives
uniform vec3 screen_per_range;  // 1 / (1 - screen_floor)
uniform vec3 screen_darkest;    // linear RGB at digital 0
uniform mat3 screen_from_rgb;   // of the display that is seen on the screen

const float SCREEN_TOLERANCE = 1e-3;  // of linear RGB

vec3 on_screen(vec3 rgb) {
    return SEEN_ON == 1 ? screen_from_rgb * rgb : rgb;
}

// Whether the screen can't show the light of another display as it is.
bool cut_by_screen(vec3 rgb) {
    vec3 shown = on_screen(rgb);
    return SEEN_ON == 1 && (any(greaterThan(shown, vec3(1.0 + SCREEN_TOLERANCE)))
                            || any(lessThan(shown, screen_darkest - SCREEN_TOLERANCE)));
}

// Digital values of linear display RGB.
vec3 digital_of(vec3 rgb) {
    vec3 shown = on_screen(rgb);
    shown = SEEN_ON == 1 ? clamp(shown, 0.0, 1.0) : shown;
    return encode(TRANSFER, max(shown - screen_floor, 0.0) * screen_per_range, display_curve);
}
