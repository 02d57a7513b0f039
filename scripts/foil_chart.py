"""The chart of docs/light.md: a metal's lobe by Schlick's form against the exact conductor.

    python scripts/foil_chart.py docs/images/foil.png

Prints the table of the page, and draws dE2000 over the angle between the light and the facet.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import drawing, new_figure, save_figure
from relgloss_view.material.brdf import schlick_weight
from relgloss_view.material.conductor import (
    FOIL_BANDS,
    INDICES,
    fresnel_conductor,
    index,
    normal_reflectance,
)
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.tone import lab_from_xyz

LAMPS = ("HP5", "D65", "A")
ANGLES_DEG = np.arange(0.0, 90.0, 1.0)


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


def main() -> int:
    """Print the table and draw the chart."""
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
