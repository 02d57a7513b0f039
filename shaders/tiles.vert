#version 330 core

// Square tiles of a picture, two triangles each. shader.py writes in what the fragment stage has declared as
// uniforms: the numbers of the whole picture, handed on as flat inputs.
//   tile_list = (left, lower edge, side) of each tile, pixels from the lower left

uniform sampler2D tile_list;
uniform vec2 per_size;  // one over the picture's width and height, pixels

//@declare

void main() {
    int wide = textureSize(tile_list, 0).x;
    int tile = gl_VertexID / 6;
    int corner = gl_VertexID % 6;
    vec3 place = texelFetch(tile_list, ivec2(tile % wide, tile / wide), 0).xyz;
    vec2 side = vec2(corner == 1 || corner == 2 || corner == 4 ? 1.0 : 0.0, corner == 2 || corner > 3 ? 1.0 : 0.0);
    //@hand-on
    gl_Position = vec4(2.0 * (place.xy + place.z * side) * per_size - 1.0, 0.0, 1.0);
}
