"""Y_n: luminance of the perfect diffuser in the object's place under a lamp of power one."""

from __future__ import annotations

import numpy as np

from relgloss_view.picture.model.sight import meet_ray
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.setup import Setup

#: Where every cosine of incidence is below this, the lamp only grazes the object, and rounding of
#: its position would be drawn as light.
GRAZING_COSINE = 1e-6


def front_white(setup: Setup, view: View) -> float:
    """cos_i / r^2 of the perfect diffuser at the point that faces the eye; 0 if there is none."""
    hit = meet_ray(setup.shape, view.eye_m, view.forward[None, :])
    if not hit.found[0]:
        return 0.0
    to_lamp = setup.lamp.position_m - hit.point_m[0]
    distance2 = float(to_lamp @ to_lamp)
    return max(float(hit.normal[0] @ to_lamp) / distance2**1.5, 0.0) if distance2 > 0.0 else 0.0


def lit_white(white: float, setup: Setup) -> float:
    """The white, or 0 where the lamp lights nothing or only grazes the object."""
    limit = GRAZING_COSINE / float(np.sum(setup.lamp.position_m**2))
    return white if np.isfinite(white) and white > limit else 0.0
