"""CIEDE2000 colour difference, by the name under which pictures use it: material/difference.py."""

from relgloss_view.material.difference import chroma_weight, delta_e_2000, hue

__all__ = ["chroma_weight", "delta_e_2000", "hue"]
