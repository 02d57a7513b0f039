"""Pack: objects that are more than one ink on one shape: forms, meshes, artwork and finishes."""
