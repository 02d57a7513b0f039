"""Patches of a display to measure: which digital values, their pictures and their tables.

The first ones decide most: white, black and grays (luminance, contrast, tone), the full channels
(gamut), and their sums (whether channels add). Then come steps of each channel, and colours that
fill the cube evenly, by the sequence of Roberts (2018) for three dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from relgloss_view.material.cielab import srgb_decoded
from relgloss_view.material.spectra import D65_XY, SRGB_PRIMARIES_XY, rgb_to_xyz_matrix

LEAST, MOST, USUAL = 9, 1000, 31
HEADINGS = (
    "patch", "picture", "R (0-255)", "G (0-255)", "B (0-255)",
    "X (cd/m2)", "Y (cd/m2)", "Z (cd/m2)",
)  # fmt: skip
GRAYS = (128, 64, 192, 32, 96, 160, 224, 16)
STEPS = (128, 64, 192, 32)
#: The real root of x^4 = x + 1, from which the sequence of three dimensions follows.
_ROOT = 1.2207440846057596
_WHITE, _BLACK = (255, 255, 255), (0, 0, 0)


def patch_values(count: int) -> list[tuple[int, int, int]]:
    """Digital values of 8 bits of `count` patches, no two alike.

    >>> patch_values(9)[:3]
    [(255, 255, 255), (0, 0, 0), (255, 0, 0)]
    """
    values: list[tuple[int, int, int]] = [_WHITE, _BLACK, (255, 0, 0), (0, 255, 0), (0, 0, 255)]
    values += [(gray, gray, gray) for gray in GRAYS[:3]]
    values += [(0, 255, 255), (255, 0, 255), (255, 255, 0)]
    values += [(gray, gray, gray) for gray in GRAYS[3:]]
    for step in STEPS:
        values += [(step, 0, 0), (0, step, 0), (0, 0, step)]
    seen, k = set(values), 0
    while len(values) < count:
        k += 1
        place = (0.5 + k * np.array([_ROOT**-1, _ROOT**-2, _ROOT**-3])) % 1.0
        red, green, blue = np.floor(255.0 * place + 0.5).astype(int).tolist()
        if (red, green, blue) not in seen:
            seen.add((red, green, blue))
            values.append((red, green, blue))
    return values[:count]


def chart_text(values: Sequence[tuple[int, int, int]]) -> str:
    """The patches as a chart of Argyll's (.ti1), which `dispread` shows and reads.

    The XYZ that it asks for are what sRGB would show; dispread does not use them. Source: Argyll
    CMS 2.3 documentation, "File formats, .ti1".
    """
    digital = np.array(values, dtype=np.float64) / 255.0
    xyz = 100.0 * srgb_decoded(digital) @ rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY).T
    lines = [
        "CTI1",
        "",
        'DESCRIPTOR "Argyll Calibration Target chart information 1"',
        'ORIGINATOR "relgloss display patches"',
        'KEYWORD "APPROX_WHITE_POINT"',
        'APPROX_WHITE_POINT "95.04 100.00 108.88"',
        'KEYWORD "COLOR_REP"',
        'COLOR_REP "RGB"',
        "",
        "NUMBER_OF_FIELDS 7",
        "BEGIN_DATA_FORMAT",
        "SAMPLE_ID RGB_R RGB_G RGB_B XYZ_X XYZ_Y XYZ_Z",
        "END_DATA_FORMAT",
        "",
        f"NUMBER_OF_SETS {len(values)}",
        "BEGIN_DATA",
    ]
    for k, (rgb, wanted) in enumerate(zip(100.0 * digital, xyz, strict=True)):
        numbers = " ".join(f"{number:.5f}" for number in (*rgb, *wanted))
        lines.append(f"{k + 1} {numbers}")
    return "\n".join([*lines, "END_DATA", ""])
