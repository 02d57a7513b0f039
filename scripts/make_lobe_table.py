"""Write assets/gloss/lobe_table.csv: what a lobe of unit strength sends into each instrument.

python scripts/make_lobe_table.py [FILE]
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np

from relgloss_view.gloss.meter.lobe_table import ANGLES_DEG, INDICES, WIDTHS_DEG, exact_share
from relgloss_view.material import brdf

PLACE = Path(__file__).resolve().parent.parent / "assets" / "gloss" / "lobe_table.csv"
HEAD = (
    "# Share of the light that a Torrance-Sparrow lobe of unit strength sends into an instrument,",
    "# over Fresnel's reflectance at the instrument's angle. Made by scripts/make_lobe_table.py",
    "# from relgloss_view/gloss/meter/geometry.py; synthetic, nothing was measured.",
)


def main(place: Path) -> None:
    """Compute every entry and write the table."""
    with place.open("w", encoding="utf-8", newline="") as file:
        file.write("\n".join(HEAD) + "\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["instrument", "s_deg", "refractive_index", "quotient"])
        for column, angle in ANGLES_DEG.items():
            cos = np.cos(np.radians(angle))
            for s_deg in WIDTHS_DEG:
                for index in INDICES:
                    quotient = exact_share(column, s_deg, index)
                    quotient /= float(brdf.fresnel_dielectric(cos, index))
                    writer.writerow([column, f"{s_deg:.6g}", f"{index:g}", f"{quotient:.9g}"])


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else PLACE)
