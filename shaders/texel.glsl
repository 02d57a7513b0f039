// What earlier passes wrote, read by coordinates: a software driver checks each texelFetch against the
// image's bounds, which costs more. The images are as large as the picture, without filtering or mipmaps,
// so that a texel's centre gives that texel.

uniform vec2 per_size;  // one over the picture's width and height, pixels

vec4 texel(sampler2D image, ivec2 at) {
    return textureLod(image, (vec2(at) + 0.5) * per_size, 0.0);
}
