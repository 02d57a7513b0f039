"""relgloss: pictures of printed packaging that keep the ratio of gloss between samples."""

__version__ = "0.1.0"
