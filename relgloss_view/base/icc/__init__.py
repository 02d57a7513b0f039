"""ICC profiles, read within bounds and evaluated in floating point."""
