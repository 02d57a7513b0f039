"""Where each choice of a Method holds: the one table, taken from the bench's stability maps.

A domain bounds the error that a choice alone makes, as a share of the largest exact value: 5 % of a
highlight as bright as the white are two L*. tests/stability/test_domains.py holds the table against
the maps from both sides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.material import Lobe, Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.method import Method
from relgloss_view.picture.model.drawn import as_drawn, drawn_diffuse, drawn_lobes
from relgloss_view.picture.model.sight import meet_view
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp

Span = tuple[float, float]

TWO_LSTAR = 0.05  #: share of Y by which L* = 100 changes by two: 116/3 of it
#: Y that shows as one L* on black: a lobe below it counts as little as if it were left out.
UNSEEN_Y = 27.0 / 24389.0
FOOT_SD = 4.0  #: where a lobe ends, for what it does at the horizon
NO_LOBE_DEG = 40.0  #: taken as the width where no lobe shows: nothing is narrow against it
ROUNDING = 1e-9  #: of degrees that were radians
#: Rays across and down the object that a scene is surveyed with: of a lamp behind the object little
#: more than a hundredth of its width is lit and seen.
SURVEY = (128, 16)
SURVEY_PX = 1024  #: sides of the picture that they belong to

#: What a scene is measured by. `incidence_deg` is half the angle between lamp and eye.
QUANTITIES = {
    "s_deg": "width of the lobes, degrees",
    "refractive_index": "of the lobes",
    "sigma_deg": "roughness of the diffuse part, degrees",
    "sigma_n_deg": "grain, degrees",
    "grain_ratio": "sigma_N over the width of a lobe",
    "incidence_deg": "half the angle between lamp and eye where both reach, degrees",
    "foot_deg": "incidence plus four widths of the widest lobe, degrees",
    "lamp_angle_deg": "by which the lamp's direction changes over the object, degrees",
    "lamp_turn": "half of that, in widths of the narrowest lobe",
    "peak_y": "of the highlight, relative to the white",
    "left_out_y": "of the lobes that are not drawn, relative to the white",
}


@dataclass(frozen=True)
class Domain:
    """Where a choice is good enough: the quantities inside any one of the boxes.

    What a box does not name may be anything; no box at all means nowhere.
    """

    bound: float  #: of the error inside
    error: str  #: what the error is
    boxes: tuple[Mapping[str, Span], ...] = ({},)

    def holds(self, quantities: Mapping[str, Span]) -> bool:
        """Whether ranges of quantities lie inside."""
        return any(
            all(
                low <= quantities[q][0] and quantities[q][1] <= high for q, (low, high) in b.items()
            )
            for b in self.boxes
        )


LOBE = "of the lobe, share of its peak"
DIFFUSE = "of the diffuse part, share of its largest"
_FRESNEL = ({"incidence_deg": (0.0, 29.0), "refractive_index": (1.3, 2.5)},)

#: (axis of Method, its value) -> where it may be drawn. What is not named holds everywhere.
DOMAINS: dict[tuple[str, str], Domain] = {
    ("fresnel", "schlick"): Domain(TWO_LSTAR, LOBE, _FRESNEL),
    ("fresnel", "constant"): Domain(TWO_LSTAR, LOBE, _FRESNEL),
    ("shadowing", "none"): Domain(TWO_LSTAR, LOBE, ({"foot_deg": (0.0, 90.0)},)),
    ("facets", "gaussian"): Domain(
        TWO_LSTAR, LOBE, ({"s_deg": (0.05, 40.0), "incidence_deg": (0.0, 89.9)},)
    ),
    ("facets", "beckmann"): Domain(TWO_LSTAR, LOBE, ({"s_deg": (0.05, 11.2)},)),
    ("facets", "ggx"): Domain(TWO_LSTAR, LOBE, ()),
    ("diffuse", "eon"): Domain(
        TWO_LSTAR,
        DIFFUSE,
        ({"sigma_deg": (0.0, 3.4)}, {"sigma_deg": (0.0, 14.0), "incidence_deg": (10.5, 46.0)}),
    ),
    ("diffuse", "qualitative"): Domain(
        TWO_LSTAR,
        DIFFUSE,
        (
            {"sigma_deg": (0.0, 4.3)},
            {"sigma_deg": (0.0, 6.2), "incidence_deg": (0.0, 70.0)},
            {"sigma_deg": (0.0, 13.0), "incidence_deg": (0.0, 40.0)},
        ),
    ),
    ("diffuse", "lambert"): Domain(
        TWO_LSTAR,
        DIFFUSE,
        (
            {"sigma_deg": (0.0, 3.9)},
            {"sigma_deg": (0.0, 5.2), "incidence_deg": (0.0, 70.0)},
            {"sigma_deg": (0.0, 6.0), "incidence_deg": (0.0, 60.0)},
        ),
    ),
    ("noise", "mean"): Domain(
        TWO_LSTAR,
        "of the mean over the grains, share of its peak",
        (
            {"sigma_n_deg": (0.0, 3.5), "incidence_deg": (0.0, 70.0)},
            {"sigma_n_deg": (0.0, 9.0), "incidence_deg": (0.0, 45.0)},
        ),
    ),
    ("noise", "specular"): Domain(
        TWO_LSTAR, "of single grains (rms) of the diffuse part", ({"sigma_n_deg": (0.0, 4.1)},)
    ),
    ("noise", "none"): Domain(
        TWO_LSTAR,
        "of single grains (rms), share of the peak of their mean",
        (
            {"grain_ratio": (0.0, 0.115), "sigma_n_deg": (0.0, 4.1), "foot_deg": (0.0, 90.0)},
            {"grain_ratio": (0.0, 0.03), "sigma_n_deg": (0.0, 4.1), "incidence_deg": (0.0, 70.0)},
        ),
    ),
    ("lamp", "distant"): Domain(
        TWO_LSTAR, LOBE, ({"lamp_turn": (0.0, 0.155), "lamp_angle_deg": (0.0, 1.8)},)
    ),
    ("targets", "float32"): Domain(0.05, "L*, a* and b*", ({"peak_y": (0.0, 1e6)},)),
    ("targets", "float16"): Domain(0.1, "L*, a* and b*", ({"peak_y": (0.0, 43000.0)},)),
    ("c_max", "eq4"): Domain(
        0.02, "of c_max", ({"s_deg": (0.05, 6.5), "incidence_deg": (0.0, 70.0)},)
    ),
    ("c_max", "once"): Domain(0.02, "of c_max", ({"grain_ratio": (0.0, 0.002)},)),
    ("lobes", "1"): Domain(1.0, "L*, on black", ({"left_out_y": (0.0, UNSEEN_Y)},)),
    ("lobes", "0"): Domain(1.0, "L*, on black", ({"left_out_y": (0.0, UNSEEN_Y)},)),
}


def outside(scene: Scene, look: Look, method: Method) -> tuple[str, ...]:
    """The choices whose domain a scene leaves, each as "axis value"; none where all hold.

    A choice about what a scene does not have can't be wrong: it is not named.
    """
    scene = as_drawn(scene, look)
    quantities = survey(scene, look, method)
    return tuple(
        f"{axis} {value}"
        for (axis, value), domain in DOMAINS.items()
        if str(getattr(method, axis)) == value
        and _matters(axis, scene.material, look, method)
        and not domain.holds(quantities)
    )


def survey(scene: Scene, look: Look, method: Method) -> dict[str, Span]:
    """The ranges of QUANTITIES in a scene, by a coarse grid of rays.

    Where none finds a lit point any incidence is possible. Lobes that show nowhere do not count;
    where none does, there is nothing narrow and no foot.
    """
    lobes = drawn_lobes(scene.material, method)
    left_out = tuple(lobe for lobe in scene.material.visible_lobes() if lobe not in lobes)
    facing, irradiance, angle = _facings(scene.shape, scene.lamp, scene.eye)
    light = (scene, facing, irradiance)
    seen = tuple(lobe for lobe in lobes if _largest_y((lobe,), *light) > UNSEEN_Y)
    widths = [math.degrees(lobe.s) for lobe in seen] or [NO_LOBE_DEG]
    theta = np.degrees(np.arccos(np.clip(facing.cos_d, 0.0, 1.0)))
    incidence = _span(theta) if len(theta) else (0.0, 89.0)
    return {
        "s_deg": _span(widths if seen else [1.0]),
        "refractive_index": _span(
            [lobe.refractive_index for lobe in seen if not lobe.is_metal] or [1.5]
        ),
        "sigma_deg": (scene.material.diffuse.sigma_deg,) * 2,
        "sigma_n_deg": (look.sigma_n_deg,) * 2,
        "grain_ratio": _span([look.sigma_n_deg / width for width in widths]),
        "incidence_deg": incidence,
        "foot_deg": (0.0, incidence[1] + (FOOT_SD * max(widths) if seen else 0.0)),
        "lamp_angle_deg": (0.0, angle),
        "lamp_turn": (0.0, 0.5 * angle / min(widths)),
        "peak_y": (0.0, _largest_y(lobes, *light)),
        "left_out_y": (0.0, _largest_y(left_out, *light)),
    }


def _matters(axis: str, material: Material, look: Look, method: Method) -> bool:
    """Whether a choice changes anything that the scene has."""
    has_lobes = bool(drawn_lobes(material, method))
    if axis == "fresnel":  # a metal has its own
        return any(not lobe.is_metal for lobe in drawn_lobes(material, method))
    if axis in ("shadowing", "facets"):
        return has_lobes
    if axis == "diffuse":
        return drawn_diffuse(material, method) != drawn_diffuse(material, Method())
    if axis == "noise":
        return look.sigma_n_deg > 0.0
    if axis == "c_max":
        return has_lobes and look.c is None
    return True


def _span(values: ArrayLike) -> Span:
    return float(np.min(values)), float(np.max(values))


@lru_cache(maxsize=8)
def _facings(shape: Shape, lamp: Lamp, eye: Eye) -> tuple[brdf.Facing, Array, float]:
    """Points that are lit and seen (N,), their irradiance relative to the largest, and the angle by
    which the lamp's direction differs at most from that to the object's centre, degrees.
    """
    view = view_of(shape, eye, (SURVEY_PX, SURVEY_PX))
    left, bottom, right, top = view.bounds
    columns = np.linspace(left, right - 1, SURVEY[0])
    rows = np.linspace(SURVEY_PX - top, SURVEY_PX - bottom - 1, SURVEY[1])
    hit = meet_view(shape, view, *np.broadcast_arrays(columns[None, :], rows[:, None]))
    point, n = hit.point_m[hit.found], hit.normal[hit.found]
    to_lamp, to_eye = lamp.position_m - point, view.eye_m - point
    distance = _lengths(to_lamp)
    facing = brdf.facing(n, to_lamp / distance, to_eye / _lengths(to_eye))
    lit = (facing.mu_i > 0.0) & (facing.mu_o > 0.0)
    irradiance = facing.mu_i[lit] / distance[lit, 0] ** 2
    centre = lamp.position_m / np.linalg.norm(lamp.position_m)
    cosine = np.clip((to_lamp / distance)[lit] @ centre, -1.0, 1.0)
    angle = float(np.degrees(np.arccos(np.min(cosine, initial=1.0))))
    relative = irradiance / np.max(irradiance, initial=1e-300)
    return brdf.Facing(*(v[lit] for v in facing)), relative, angle


def _lengths(vectors: Array) -> Array:
    """(N, 1), never zero."""
    return np.asarray(np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def _largest_y(
    lobes: tuple[Lobe, ...], scene: Scene, facing: brdf.Facing, irradiance: Array
) -> float:
    """The highlight of some lobes, Y relative to the white, from above: it may stand at any of the
    points, whatever their normals, since the rays are few and a highlight is narrow.
    """
    if not lobes or not len(irradiance):
        return 0.0
    material = scene.material
    weights = material.xyz_weights(illuminant(scene.lamp.illuminant))[:, 1]
    total = np.zeros(len(irradiance))
    cosine = np.maximum(facing.cos_d, brdf.COSINE_EPSILON)
    for lobe in lobes:
        for part in lobe.parts(material.bands.count):
            seen = brdf.torrance_sparrow(facing, lobe.s, part.fresnel) * irradiance
            # At the mirror point both cosines are that of the half angle, and G is 1.
            reflectance = brdf.reflectance(cosine, part.fresnel)
            mirror = 0.25 * brdf.facet_amplitude(lobe.s) * reflectance / cosine**2
            strength = float(part.spectrum @ weights)
            total += np.pi * strength * np.maximum(seen, mirror * np.max(irradiance))
    return float(np.max(total))
