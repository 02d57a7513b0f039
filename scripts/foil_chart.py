"""The chart of docs/light.md: a metal's lobe by Schlick's form against the exact conductor.

    python scripts/foil_chart.py docs/images/foil.png

Prints the tables of the page, and draws dE2000 over the angle between the light and the facet.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import drawing, new_figure, save_figure
from relgloss_view.gloss.match import match_setups
from relgloss_view.material import brdf
from relgloss_view.material.brdf import MetalPart, schlick_weight
from relgloss_view.material.conductor import (
    FOIL_BANDS,
    FOIL_S_DEG,
    INDICES,
    fresnel_conductor,
    index,
    normal_reflectance,
)
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.picture.model import lights
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.tone import lab_from_xyz
from relgloss_view.picture.model.view import view_of
from relgloss_view.picture.scene.setup import Setup

LAMPS = ("HP5", "D65", "A")
ANGLES_DEG = np.arange(0.0, 90.0, 1.0)
SIDE_PX = 256  #: of the pictures
AMBIENTS = (0.0, 0.3)  #: share of the surround
SEEN = 0.002  #: of a highlight's peak, above which it is seen


def differences(metal: str, lamp: str) -> Array:
    """dE2000 of the two reflectances as colours under a lamp, at ANGLES_DEG."""
    nm = np.asarray(FOIL_BANDS.centres_nm())
    weights = xyz_weights(FOIL_BANDS, illuminant(lamp))
    cosine = np.cos(np.radians(ANGLES_DEG))[:, None]
    exact = fresnel_conductor(cosine, *index(metal, nm))
    f0, weight = normal_reflectance(metal, nm), schlick_weight(cosine)
    lobe = (1.0 - weight) * f0 + weight
    white = np.sum(weights, axis=0)
    return delta_e_2000(lab_from_xyz(exact @ weights, white), lab_from_xyz(lobe @ weights, white))


def in_a_picture(metal: str, lamp: str, setup: Setup, ambient: float) -> Array:
    """dE2000 of the object's pixels, the highlight's peak at the lamp's share of the white.

    Without ambient light, of the pixels where the highlight is seen. Its width is a cold foil's.
    """
    nm = np.asarray(FOIL_BANDS.centres_nm())
    weights = xyz_weights(FOIL_BANDS, illuminant(lamp))
    columns, rows = np.meshgrid(*[np.arange(SIDE_PX, dtype=np.float64)] * 2)
    view = view_of(setup.shape, setup.eye, (SIDE_PX, SIDE_PX))
    hit, ray, _ = sight(setup.shape, view, columns, rows)
    ray, points, normals = ray[hit.found], hit.point_m[hit.found], hit.normal[hit.found]
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    (light,) = lights.lit(setup, points)
    facing = brdf.facing(normals, light.i, o)
    lobe = sum(brdf.torrance_sparrow(facing, np.radians(FOIL_S_DEG), part) for part in MetalPart)
    lobe = lobe * np.maximum(facing.mu_i, 0.0) / light.distance2
    lobe = lobe / np.max(lobe)
    f0, indices = normal_reflectance(metal, nm), index(metal, nm)

    def colours(exact: bool) -> Array:
        parts = []
        for cosine in (facing.cos_d[:, None], np.sum(normals * o, axis=-1)[:, None]):
            w = schlick_weight(cosine)
            fresnel = fresnel_conductor(cosine, *indices) if exact else (1.0 - w) * f0 + w
            parts.append(fresnel @ weights)
        xyz = (1.0 - ambient) * lobe[:, None] * parts[0] + ambient * parts[1]
        return lab_from_xyz(xyz, np.sum(weights, axis=0))

    error = delta_e_2000(colours(exact=True), colours(exact=False))
    return error if ambient else error[lobe > SEEN]


def picture_table() -> None:
    """Print what the chart's error is in pictures of a cylinder."""
    print("| metal | light | p95 of a picture, worst of lamps | largest |")
    print("| --- | --- | --- | --- |")
    for metal in INDICES:
        for ambient in AMBIENTS:
            errors = [
                in_a_picture(metal, lamp, setup, ambient)
                for lamp in LAMPS
                for setup in match_setups()
            ]
            p95 = max(float(np.percentile(error, 95)) for error in errors)
            largest = max(float(np.max(error)) for error in errors)
            print(f"| {metal} | ambient {ambient:g} | {p95:.1f} | {largest:.1f} |")


def main() -> int:
    """Print the tables and draw the chart."""
    picture_table()
    near = ANGLES_DEG <= 75.0
    print("| metal | lamp | p95, 0 to 75 degrees | p95, 0 to 89 | largest, at |")
    print("| --- | --- | --- | --- | --- |")
    with drawing():
        figure = new_figure(9.0, 3.2, dpi=110, layout="constrained")
        panels = figure.subplots(1, len(INDICES), sharey=True)
        for panel, metal in zip(panels, INDICES, strict=True):
            for lamp in LAMPS:
                error = differences(metal, lamp)
                worst = int(np.argmax(error))
                cells = (
                    f"{np.percentile(error[near], 95):.1f}",
                    f"{np.percentile(error, 95):.1f}",
                    f"{error[worst]:.1f}, {ANGLES_DEG[worst]:.0f} degrees",
                )
                print(f"| {metal} | {lamp} | {' | '.join(cells)} |")
                panel.plot(ANGLES_DEG, error, label=lamp)
            panel.axhline(2.0, color="0.6", linewidth=0.8, linestyle="--")
            panel.set_title(metal)
            panel.set_xlabel("angle at the facet (degrees)")
        panels[0].set_ylabel("dE2000, Schlick against exact")
        panels[0].legend(frameon=False)
        save_figure(figure, Path(sys.argv[1]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
