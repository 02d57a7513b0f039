// An analytic shape with finishes: the label's place of a point, and its gradients along the surface.
// Twin: relgloss_view/picture/model/surface.py `_gradients`.

Sight sight_through(vec3 start, vec3 ray) {
    Hit hit = meet(SHAPE, start, ray, half_extent_m);
    vec3 n = hit.normal;
    vec3 across = vec3(1.0, 0.0, 0.0);
    vec3 upwards = vec3(0.0, 1.0, 0.0);
    if (SHAPE == SHAPE_CYLINDER) across = vec3(n.z, 0.0, -n.x);
    if (SHAPE == SHAPE_SPHERE) {
        float cos2 = max(n.x * n.x + n.z * n.z, 1e-12);
        across = vec3(n.z, 0.0, -n.x) / cos2;
        upwards = vec3(-n.y * n.x, cos2, -n.y * n.z) * inversesqrt(cos2);
    }
    return Sight(hit, n, across, upwards, hit.surface_m);
}
