// Cube root of t >= 0; 0 below. Constant: CUBE_ROOT.

#ifndef CUBE_ROOT
#define CUBE_ROOT CUBE_ROOT_HOUSEHOLDER
#endif

// An estimate of 1 / cbrt(t) from the exponent's bits (within 3.5 %), then two of Householder's steps of
// second order for y^-3 = t, each of which cubes the error: 4 units in the last place, no division, no pow.
float householder_cube_root(float t) {
    float y = intBitsToFloat(1419907116 - int(float(floatBitsToInt(t)) * (1.0 / 3.0)));
    for (int step = 0; step < 2; ++step) {
        float h = 1.0 - t * y * y * y;
        y += y * h * (1.0 / 3.0 + h * (2.0 / 9.0));
    }
    return t * y * y;
}

#if CUBE_ROOT == CUBE_ROOT_TABLE
const float TABLE_STEPS = 256.0;  // from 1 to 8
uniform sampler2D cube_root_table;

// The mantissa's root between two entries of a table, the exponent's by thirds: within 2e-6.
float table_cube_root(float t) {
    int bits = floatBitsToInt(t);
    int third = (((bits >> 23) - 127 + 300) * 21846 >> 16) - 100;  // of the exponent, rounded down
    float mantissa = intBitsToFloat(bits - (third * 3 << 23));     // 1 to 8
    float place = (mantissa - 1.0) * (TABLE_STEPS / 7.0);
    int entry = int(place);
    vec2 ends = texelFetch(cube_root_table, ivec2(entry, 0), 0).xy;
    return intBitsToFloat((third + 127) << 23) * mix(ends.x, ends.y, place - float(entry));
}
#endif

float cube_root(float t) {
#if CUBE_ROOT == CUBE_ROOT_TABLE
    return t > 0.0 ? table_cube_root(t) : 0.0;
#else
    if (CUBE_ROOT == CUBE_ROOT_POWER) return pow(max(t, 0.0), 1.0 / 3.0);
    return t > 0.0 ? householder_cube_root(t) : 0.0;
#endif
}
