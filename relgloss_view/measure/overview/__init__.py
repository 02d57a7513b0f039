"""A table as it was read, before any fit: what is in it, what was left out, how good it is."""

from relgloss_view.measure.overview.overview import LeftOut, Overview, look_over

__all__ = ["LeftOut", "Overview", "look_over"]
