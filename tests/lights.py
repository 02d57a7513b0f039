"""Light that operators are tried on, without a renderer."""

from __future__ import annotations

import numpy as np

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.operators.operator import SceneLight

#: Equal energy: X = Y = Z and L = M = S, so that formulas for one number hold for each.
EQUAL_ENERGY = Display(white_xy=(1 / 3, 1 / 3))
HP5_WHITE = np.array([1.0168, 1.0, 0.6761])
Y_N = 110.0


def scene_light(
    xyz_cd_m2, display=None, coverage=None, white=HP5_WHITE, y_n=Y_N, pixels_per_degree=32.0
):
    xyz = np.asarray(xyz_cd_m2, dtype=np.float64)
    return SceneLight(
        (xyz,),
        1.0,
        np.ones(xyz.shape[:2]) if coverage is None else coverage,
        white,
        y_n,
        pixels_per_degree,
        DisplayModel.of(display or Display()),
    )


def gray(luminance, **options):
    """Neutral light of luminances (H, W) in cd/m2."""
    white = options.get("white", HP5_WHITE)
    return scene_light(np.asarray(luminance, dtype=np.float64)[..., None] * white, **options)


def shown_luminance(picture):
    """(H, W), Y of what is shown, 1 the display's white."""
    return picture.light @ picture.display.xyz_from_rgb[1]
