"""Numbers that people take from a fit, with what its errors do to them: the peak, and c_max.

The peak is the radiance factor at the mirror direction, and c_max that of the default cylinder
under its default lamp (docs/method.md). The delta method over the covariance that the fit keeps,
of the samples' noise and of what they leave open (gloss.meter.uncertainty).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from relgloss_view.gloss.meter.meter import luminous_weights
from relgloss_view.gloss.meter.uncertainty import fitted_steps, standard_error
from relgloss_view.gloss.pose import LEAST_LSTAR, pose_of
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.measure.gonio import direction
from relgloss_view.picture.scene.setup import Setup

PEAK_INCIDENCE_DEG = 45.0


def with_derived(material: Material) -> Material:
    """The material with its peak, its c_max and their standard errors in the fit's record."""
    if material.fit is None or not material.specular:
        return material
    steps = fitted_steps(material)
    derived: dict[str, Any] = {}
    numbers: dict[str, Callable[[Material], float | None]] = {"peak": peak, "c_max": c_max}
    for name, number_of in numbers.items():
        value = number_of(material)
        if value is None:
            continue
        error = standard_error(number_of, steps)
        derived[name] = {"value": float(f"{value:.4g}")}
        if error is not None and np.isfinite(error):
            derived[name]["standard_error"] = float(f"{error:.2g}")
    return replace(material, fit=replace(material.fit, derived=derived))


def peak(material: Material) -> float:
    """Luminous radiance factor at the mirror direction of 45 degrees; 1 is the perfect diffuser."""
    lamp, receiver = direction(-PEAK_INCIDENCE_DEG)[None], direction(PEAK_INCIDENCE_DEG)[None]
    normal = np.array([[0.0, 0.0, 1.0]])
    diffuse, specular = material.evaluate_facing(brdf.facing(normal, lamp, receiver))
    return float(np.pi * ((diffuse + specular)[0] @ luminous_weights(material.bands)))


def c_max(material: Material) -> float | None:
    """The exact c_max of the default cylinder and lamp; None where its highlight is not seen."""
    extremes = pose_of(Setup()).extremes(material)
    return extremes.smallest_ratio if extremes.l_s_max >= LEAST_LSTAR else None
