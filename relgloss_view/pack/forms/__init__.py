"""Forms: the triangles of cans, bottles, cartons, pouches and meshes."""
