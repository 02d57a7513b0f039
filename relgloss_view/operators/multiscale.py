"""Pattanaik, Ferwerda, Fairchild and Greenberg 1998: adaptation and spatial vision, band by band.

What follows their paper is what this project's notes recall of it; the paper's tables of transducer
functions are not at hand. With rods off the transducers cancel exactly, forward then backward, and
nothing here depends on them.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.parameters import choice, parameter, switch
from relgloss_view.operators.operator import (
    Displayed,
    LightOperator,
    SceneLight,
    rows_at_a_time,
    show_xyz,
)
from relgloss_view.operators.pyramid import low_passes

#: XYZ to cones, equal-energy white at 1 (Hunt, Pointer and Estevez; Hunt 1995).
CONES = np.array([[0.38971, 0.68898, -0.07868], [-0.22981, 1.18340, 0.04641], [0.0, 0.0, 1.0]])
#: XYZ to the rods' signal (Pattanaik et al. 1998).
RODS = np.array([-0.702, 1.039, 0.433])
#: Cones to the achromatic, red-green and yellow-blue channels (Hunt's, as they take them).
OPPONENT = np.array([[2.0, 1.0, 0.05], [1.0, -1.09, 0.09], [0.11, 0.11, -0.22]])
ROD_SHARE = 1.0 / 7.0  #: of the rods in the achromatic channel
#: Approximated: the achromatic response below which the transducers are taken as linear. A
#: contrast of 1 % at 100 cd/m2 gives 0.11.
THRESHOLD = 0.1


def cone_gain(signal: Array) -> Array:
    """Response per cd/m2 of cones adapted to a signal of 0 cd/m2 and above."""
    return np.asarray(np.exp(-0.85 * np.log1p(np.maximum(signal, 0.0))) / 0.555)


def rod_gain(signal: Array) -> Array:
    """Response per scotopic cd/m2 of rods; they saturate in daylight."""
    bounded = np.maximum(signal, 0.0)
    saturation = 10.0 / (bounded * bounded + 10.0)
    return np.asarray(saturation * np.exp(-0.85 * np.log(bounded + 0.001)) / 0.908)


def transducer(response: Array) -> Array:
    """Approximated: linear near threshold, square root above, odd."""
    size = np.abs(response)
    return np.sign(response) * 2.0 * THRESHOLD * (np.sqrt(1.0 + size / THRESHOLD) - 1.0)


def transducer_inverse(response: Array) -> Array:
    """Inverse of transducer."""
    size = np.abs(response)
    return np.sign(response) * size * (1.0 + size / (4.0 * THRESHOLD))


def responses(
    planes: Array, pixels_per_degree: float, local: float, *, rods: bool, in_place: bool = False
) -> Array:
    """Adapted responses of the cones (3, H, W) to planes (C, H, W) in cd/m2.

    C is 3, or 4 with rods last. Each band is multiplied by the gain of the low-pass picture below
    it, the lowest one by the gain of a mean of itself: `local` (their A) is 0 for the whole
    picture's, 1 for each pixel's own. Rods add to the achromatic channel of each band.
    """
    total = np.zeros((min(len(planes), 3), *planes.shape[1:]))
    above = planes
    for below in low_passes(planes, pixels_per_degree):
        _add(total, above - below, below, rods=rods)
        above = below
    mean = np.mean(above, axis=(1, 2), keepdims=True)
    # The lowest picture is not a contrast: it has no threshold, and no transducer.
    _add(total, above, (1.0 - local) * mean + local * above, rods=rods, contrast=False)
    return total


def _add(
    total: Array, band: Array, adaptation: Array, *, rods: bool, contrast: bool = True
) -> None:
    if not rods:
        for rows in rows_at_a_time(band.shape[1:]):
            total[:, rows] += band[:, rows] * cone_gain(adaptation[:, rows])
        return
    cones = band[:3] * cone_gain(adaptation[:3])
    total += cones
    rod = band[3] * rod_gain(adaptation[3])
    if contrast:
        achromatic = np.tensordot(OPPONENT[0], cones, axes=1)
        seen = transducer_inverse(transducer(achromatic) + ROD_SHARE * transducer(rod))
        gained = seen - achromatic
    else:
        gained = ROD_SHARE * rod
    total += np.linalg.inv(OPPONENT)[:, 0, None, None] * gained


@dataclass(frozen=True)
class Multiscale(LightOperator):
    """Cones (and rods) adapted in octave bands, shown to an eye adapted to the display's mean.

    The bands follow the scene's own angles, as if the observer looked at the picture from the
    scene's eye, unless `pixels_per_degree` is set. Around the object is the display's surround,
    lit as the object is. On the dark side of steep edges the bands add up to negative light,
    which is cut and counted in a warning.
    """

    name: ClassVar[str] = "multiscale"
    title: ClassVar[str] = "Multiscale model of vision"
    meaning: ClassVar[str] = "adapts cones and rods in bands of spatial frequency"
    source: ClassVar[str] = "Pattanaik, Ferwerda, Fairchild and Greenberg 1998, SIGGRAPH"

    local: float = parameter(
        0.5, 0.0, 1.0, "", "A: 0 adapts to the picture's mean, 1 to each place"
    )
    display_cd_m2: float | None = parameter(
        None, 1.0, 1e5, "cd/m2", "luminance of the display's white; none takes the display's own"
    )
    display_mean_cd_m2: float | None = parameter(
        None,
        0.01,
        1e5,
        "cd/m2",
        "luminance that the display's observer is adapted to; none takes half of the display's own "
        "white",
    )
    white: str = choice(
        "display",
        ("display", "scene"),
        "carry the lamp's white to the display's first, or not",
    )
    rods: bool = switch(False, "add the rods, by approximated transducers")
    pixels_per_degree: float | None = parameter(
        None, 0.01, 1e7, "1/deg", "pixels per degree of the picture; none takes the scene's"
    )

    def apply(self, light: SceneLight) -> Displayed:
        """See LightOperator."""
        carried = self.white == "display"
        surround = (light.display.white if carried else light.white_xyz) * (
            light.display.background_light * light.y_n_cd_m2
        )
        matrix = np.vstack([CONES, RODS]) if self.rods else CONES
        planes = np.empty((len(matrix), *light.shape))
        for rows in rows_at_a_time(light.shape):
            part = light.part(rows)
            xyz = part.display_xyz if carried else part.xyz_cd_m2
            field = np.where(part.on_object[..., None], xyz, surround)
            planes[:, rows] = np.tensordot(matrix, field, axes=(1, 2))
        planes[3:] = np.maximum(planes[3:], 0.0)
        frequency = self.pixels_per_degree or light.pixels_per_degree
        adapted = responses(planes, frequency, self.local, rods=self.rods, in_place=True)
        del planes
        white_cd_m2 = self.display_cd_m2 or light.display_white_cd_m2
        mean_cd_m2 = self.display_mean_cd_m2 or 0.5 * light.display_white_cd_m2
        back = cone_gain(CONES @ light.display.white * mean_cd_m2)
        below = 0

        def xyz_of(part: SceneLight) -> Array:
            nonlocal below
            cones = adapted[:, part.rows] / (back * white_cd_m2)[:, None, None]
            xyz = np.moveaxis(np.tensordot(np.linalg.inv(CONES), cones, axes=1), 0, -1)
            xyz = xyz[part.on_object]
            below += int(np.sum(np.any(xyz < -1e-9, axis=-1)))
            return np.asarray(np.maximum(xyz, 0.0))

        picture = show_xyz(self.name, light, xyz_of)
        return dataclasses.replace(picture, warnings=self._warnings(below))

    def _warnings(self, below: int) -> tuple[str, ...]:
        warnings = []
        if below:
            warnings.append(f"{below} pixels of the object have negative light, which is cut")
        if self.rods:
            warnings.append(
                "rods rely on approximated transducers: the paper's tables are not at hand"
            )
        return tuple(warnings)
