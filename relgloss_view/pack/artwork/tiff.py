def read_tiff(*a): return None
