// The shares of the finishes at a place, as surface.frag wrote them, with what they make of sigma_N and k.
// Constants: FINISHES, INK_SECOND.

uniform sampler2D paint_image;
#if INK_SECOND >= 0
uniform sampler2D second_image;
#endif
uniform sampler2D shares_0;
#if FINISHES > 2
uniform sampler2D shares_1;
#endif
#if FINISHES > 4
uniform sampler2D shares_2;
#endif
#if FINISHES > 6
uniform sampler2D shares_3;
#endif

uniform vec2 finish_look[FINISHES];  // sigma_N (radians) and k

struct Finishes {
    vec4 paint;
    vec3 second;  // of the paint: second_paint.glsl
    vec4 shares[4];
    float sigma_n;
    float k;
};

float finish_share(Finishes finishes, int number) {
    return finishes.shares[number / 4][number % 4];
}

Finishes finishes_at(vec2 at) {
    Finishes found;
    found.paint = textureLod(paint_image, at, 0.0);
    found.second = vec3(0.0);
#if INK_SECOND >= 0
    found.second = textureLod(second_image, at, 0.0).xyz;
#endif
    found.shares[0] = textureLod(shares_0, at, 0.0);
    found.shares[1] = vec4(0.0);
    found.shares[2] = vec4(0.0);
    found.shares[3] = vec4(0.0);
#if FINISHES > 2
    found.shares[1] = textureLod(shares_1, at, 0.0);
#endif
#if FINISHES > 4
    found.shares[2] = textureLod(shares_2, at, 0.0);
#endif
#if FINISHES > 6
    found.shares[3] = textureLod(shares_3, at, 0.0);
#endif
    vec2 look = vec2(0.0);
    for (int f = 0; f < FINISHES; ++f) look += finish_share(found, f) * finish_look[f];
    found.sigma_n = look.x;
    found.k = look.y;
    return found;
}
