"""Y_n: luminance of the perfect diffuser in the object's place under lamps of power pi."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.pack import forms
from relgloss_view.pack.concavity import concavity_note
from relgloss_view.pack.shape import PROFILED, Shape
from relgloss_view.picture.model.lights import lamps_of, share_of
from relgloss_view.picture.model.sight import meet_ray
from relgloss_view.picture.model.view import View
from relgloss_view.picture.scene.setup import FurtherLamp, Lamp, Setup

#: Where every cosine of incidence is below this, the lamp only grazes the object, and rounding of
#: its position would be drawn as light.
GRAZING_COSINE = 1e-6


#: Radius over distance above which the lobe of a lamp's size departs from the disc's by more than
#: docs/light.md's tolerance.
LARGE_LAMP = 0.15
AMBIENT_ONLY = (
    "the lamps light nothing that the eye sees: only the ambient light shows the object; turn the "
    "lamp to the highlight (--lamp auto)"
)


def light_warnings(setup: Setup, *, lit: bool) -> list[str]:
    """What is doubtful about the light of a picture; lit: a lamp lights some of what is seen."""
    warnings = [] if lit else [AMBIENT_ONLY]
    reach = float(np.linalg.norm(setup.shape.half_extent_m()))
    for lamp in lamps_of(setup):
        ratio = lamp.radius_m / max(lamp.distance_m - reach, 1e-9)
        if ratio > LARGE_LAMP:
            warnings.append(
                f"a lamp of radius {lamp.radius_m:g} m is too large for its distance of "
                f"{lamp.distance_m:g} m: its highlight is approximate; make radius_m smaller or "
                "distance_m larger"
            )
            break
    return [*warnings, *_form_notes(setup.shape)]


def _form_notes(shape: Shape) -> tuple[str, ...]:
    """The warning of a form that sees itself; forms of the program's own are hardly concave."""
    if shape.kind != "mesh" and not (shape.kind in PROFILED and shape.profile_mm):
        return ()
    mesh = forms.mesh_of(shape)
    note = None if mesh is None else concavity_note(mesh)
    return () if note is None else (note,)


def front_white(setup: Setup, view: View) -> float:
    """What the perfect diffuser shows at the point that faces the eye; 0 if there is none.

    The sum of cos_i / (d^2 + R^2) over the lamps, each times its share.
    """
    hit = meet_ray(setup.shape, view.eye_m, view.forward[None, :])
    if not hit.found[0]:
        return 0.0
    return float(sum(_front(lamp, hit.point_m[0], hit.normal[0]) for lamp in lamps_of(setup)))


def _front(lamp: Lamp | FurtherLamp, point_m: Array, normal: Array) -> float:
    """The same at one point, from one lamp."""
    to_lamp = lamp.position_m - point_m
    distance2 = float(to_lamp @ to_lamp)
    if distance2 <= 0.0:
        return 0.0
    seen = share_of(lamp) * max(float(normal @ to_lamp) / distance2**1.5, 0.0)
    if lamp.radius_m > 0.0:
        seen *= distance2 / (distance2 + lamp.radius_m**2)
    return float(seen)


def lamps_irradiance(white: float, setup: Setup) -> float:
    """pi over the white: what the lamps' power is, so that they give their share of Y_n; 0 unlit.

    The perfect diffuser shows 1 at most under all light together: the ambient share of it
    everywhere, the lamps the rest.
    """
    return np.pi * (1.0 - setup.lamp.ambient) / white if white > 0.0 else 0.0


def lit_white(white: float, setup: Setup) -> float:
    """The white, or 0 where the lamps light nothing or only graze the object."""
    limit = sum(
        share_of(lamp) * GRAZING_COSINE / float(np.sum(lamp.position_m**2) + lamp.radius_m**2)
        for lamp in lamps_of(setup)
    )
    return white if np.isfinite(white) and white > limit else 0.0
