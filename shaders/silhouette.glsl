// Places of the rays in a pixel at the silhouette. Twin: relgloss_view/picture/model/silhouette.py.

const int TRIED = 9;       // corners, sides and middle of a pixel
const int EDGE_RAYS = 64;  // of a pixel at the silhouette

// Hammersley's points (Hammersley 1960): 64 different columns and rows, so that edges that are nearly
// upright or level have 64 steps too.
vec2 edge_place(int k) {
    uint bits = uint(k);
    uint turned = 0u;
    for (int n = 0; n < 6; ++n) turned |= ((bits >> uint(n)) & 1u) << uint(5 - n);
    return (vec2(float(k), float(turned)) + 0.5) / float(EDGE_RAYS);
}
