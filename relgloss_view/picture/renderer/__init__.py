"""A scene and a look become a Frame on the GPU, for window, files and tests alike.

With picture/context.py the only place that knows moderngl.
"""

from relgloss_view.picture.renderer.overlays import draw_difference, draw_overlay
from relgloss_view.picture.renderer.passes import Renderer
from relgloss_view.picture.renderer.programs import Programs
from relgloss_view.picture.renderer.request import Request
from relgloss_view.picture.renderer.targets import OVERLAY, TONE

__all__ = [
    "OVERLAY",
    "TONE",
    "Programs",
    "Renderer",
    "Request",
    "draw_difference",
    "draw_overlay",
]
