// The triangle of a mesh that is seen, and the exact point of it. Twin: relgloss_view/picture/model/sight.py.

uniform sampler2D triangle_image;   // number of the nearest triangle, counted from 1; as large as the target
uniform sampler2D mesh_triangles;   // numbers of its points, and its part
uniform sampler2D mesh_points;      // point (m), x on the label
uniform sampler2D mesh_normals;     // normal, y on the label
uniform vec2 per_surface;           // one over the target's width and height

const float BESIDE = 0.25;     // how far beside a triangle a ray may pass it, in its sides
const float FACES_EYE = 1e-4;  // the least cosine of a normal to the eye

ivec2 listed(int number) {
    return ivec2(number % MESH_WIDE, number / MESH_WIDE);
}

Sight sight_through(vec3 start, vec3 ray) {
    float number = textureLod(triangle_image, gl_FragCoord.xy * per_surface, 0.0).x;
    bool found = number > 0.5;
    vec4 corners = texelFetch(mesh_triangles, listed(max(int(number) - 1, 0)), 0);
    ivec2 c0 = listed(int(corners.x));
    ivec2 c1 = listed(int(corners.y));
    ivec2 c2 = listed(int(corners.z));
    vec4 p0 = texelFetch(mesh_points, c0, 0);
    vec4 p1 = texelFetch(mesh_points, c1, 0);
    vec4 p2 = texelFetch(mesh_points, c2, 0);
    vec4 n0 = texelFetch(mesh_normals, c0, 0);
    vec4 n1 = texelFetch(mesh_normals, c1, 0);
    vec4 n2 = texelFetch(mesh_normals, c2, 0);
    // Ray and triangle (Moeller, Trumbore 1997). The rasteriser rounds places to 1/256 of a pixel, so that the
    // ray may pass just beside the triangle.
    vec3 e1 = p1.xyz - p0.xyz;
    vec3 e2 = p2.xyz - p0.xyz;
    vec3 facet = cross(e1, e2);
    vec3 s = start - p0.xyz;
    float det = -dot(ray, facet);
    vec3 q = cross(s, ray);
    float per_det = abs(det) > 0.0 ? 1.0 / det : 0.0;
    float u = clamp(dot(q, e2) * per_det, -BESIDE, 1.0 + BESIDE);
    float v = clamp(-dot(q, e1) * per_det, -BESIDE, 1.0 + BESIDE);
    float w = 1.0 - u - v;
    vec3 point_m = p0.xyz + u * e1 + v * e2;
    vec3 n = w * n0.xyz + u * n1.xyz + v * n2.xyz;
    n = dot(n, n) > 0.0 ? normalize(n) : normalize(facet);
    n = det < 0.0 ? -n : n;  // seen from behind
    vec3 o = -normalize(ray);
    float along = dot(n, o);
    n = along < FACES_EYE ? normalize(n + (FACES_EYE - along) * o) : n;
    float per_area = 1.0 / max(dot(facet, facet), 1e-38);
    vec3 grad_u = cross(e2, facet) * per_area;
    vec3 grad_v = cross(facet, e1) * per_area;
    vec2 l0 = vec2(p0.w, n0.w);
    vec2 l1 = vec2(p1.w, n1.w) - l0;
    vec2 l2 = vec2(p2.w, n2.w) - l0;
    // The footprint follows the smooth surface: those of two triangles would differ at the edge between them.
    return Sight(Hit(found, point_m, n, vec2(0.0), int(corners.w)), n,
                 l1.x * grad_u + l2.x * grad_v, l1.y * grad_u + l2.y * grad_v, l0 + u * l1 + v * l2);
}
