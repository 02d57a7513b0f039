"""Tone-mapping operators that the split is compared with, and measures of what they show."""
