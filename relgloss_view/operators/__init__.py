"""Tone-mapping operators: the split, and those that it is compared with."""
