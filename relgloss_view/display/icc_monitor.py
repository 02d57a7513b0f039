"""A monitor from an ICC profile.

Source: ICC.1:2022, 9.2 (tags), 8.3 (which tag counts: a table before matrix and curves);
ICC.1:2001, 6.4.16 (mediaBlackPointTag).
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc.profile import Profile, read_profile
from relgloss_view.base.icc.tetrahedral import tetrahedral
from relgloss_view.display.icc_tags import black_point, calibration, luminance_of_white
from relgloss_view.display.icc_white import emitted_from_connection
from relgloss_view.display.monitor import Curves, Monitor, with_black
from relgloss_view.display.primaries import check_primaries, swapped
from relgloss_view.display.table import Table
from relgloss_view.display.tone_curve import ToneCurve

CHANNELS = ("red", "green", "blue")
#: Classes of profiles that are not of a monitor, in words.
OTHERS = {
    b"nmcl": "named colours",
    b"prtr": "a printer",
    b"scnr": "a scanner or camera",
    b"link": "a link between two devices",
    b"abst": "an abstract effect",
}
EXPECTED = "expected the profile of a monitor"
LEAST_BLACK = 1e-6  #: of white: a contrast of a million; what is less counts as not known
LONGEST_PLATEAU = 0.02  #: of the range of digital values, at white

NO_BLACK = (
    "The profile does not hold what the screen shows at black; it is taken as 0. Set "
    "display.black_cd_m2 where you know it."
)
BLACK_POINT = (
    "What the screen shows at black is taken from the profile's black point (bkpt), because its "
    "curves show none."
)


def monitor_of_profile(data: bytes, name: str) -> Monitor:
    """The monitor of a profile's bytes. Raises ValueError with the reason where it is of none."""
    if data[36:40] == b"acsp" and data[12:16] in OTHERS:
        raise ValueError(f"an ICC profile of {OTHERS[data[12:16]]}; {EXPECTED}")
    profile = read_profile(data)
    if profile.space != "RGB":
        raise ValueError(f"an ICC profile of {profile.space}; {EXPECTED} (RGB)")
    to_emitted, white_notes = emitted_from_connection(profile)
    notes = [*white_notes]
    ends = _connection(profile, np.vstack([np.zeros(3), np.eye(3), np.ones(3)])) @ to_emitted.T
    check_primaries(ends)
    ends = ends / ends[4, 1]
    black, white = ends[0], ends[4]
    matrix = (ends[1:4] - black).T
    matrix = matrix * np.linalg.solve(matrix, white - black)  # channels need not add to white
    black_known = bool(black[1] > LEAST_BLACK)
    if not black_known:
        named = black_point(profile)
        black_known = named is not None and profile.matrix is not None
        if named is not None and profile.matrix is not None:
            matrix = matrix * np.linalg.solve(matrix, white - named)
            black = named
            notes.append(BLACK_POINT)
        else:
            notes.append(NO_BLACK)
    xyz_from_rgb, floor = with_black(matrix, black)
    if not (np.isfinite(floor).all() and floor.min() > -0.05 and floor.max() < 0.9):
        raise ValueError("an ICC profile whose black is as bright as white, or of no screen's hue")
    emission: Curves | Table
    if profile.matrix is not None:
        curves = [_curve(profile, k, notes) for k in range(3)]
        emission = Curves((curves[0], curves[1], curves[2]))
    else:
        scale = 1.0 / (to_emitted @ _connection(profile, np.ones((1, 3)))[0])[1]
        to_rgb = scale * np.linalg.solve(xyz_from_rgb, to_emitted)
        emission = Table(lambda digital: _connection(profile, digital), to_rgb, floor)
    luminance, luminance_notes = luminance_of_white(profile)
    curves_of_card, card_notes = calibration(profile)
    return Monitor(
        profile.description or name,
        "profile",
        white,
        xyz_from_rgb,
        floor,
        emission,
        luminance_cd_m2=luminance,
        black_known=black_known,
        notes=(*notes, *luminance_notes, *card_notes, *swapped(xyz_from_rgb, white)),
        icc=data,
        calibration=curves_of_card,
    )


def _connection(profile: Profile, digital: Array) -> Array:
    return np.asarray(profile.xyz(digital, "relative", tetrahedral))


def _curve(profile: Profile, channel: int, notes: list[str]) -> ToneCurve:
    own, name = profile.curves[channel], CHANNELS[channel]
    light = own(np.linspace(0.0, 1.0, 1025))
    low, high = float(light[0]), float(light[-1])
    if not (np.isfinite(light).all() and high - low > 1e-3):
        raise ValueError(f"an ICC profile whose curve of {name} shows no more light at white")
    if np.diff(light).min() < -1e-4 * (high - low):
        notes.append(
            f"The curve of {name} falls somewhere: there, several digital values show the same "
            "light. Measure the screen again."
        )
    if float(np.mean(light >= high)) > LONGEST_PLATEAU:
        share = 100.0 * float(np.argmax(light >= high)) / 1024.0
        notes.append(
            f"The curve of {name} is flat from {share:.0f} % on: brighter digital values show the "
            "same light. Lower the contrast of the screen, and measure it again."
        )

    def forward(digital: Array) -> Array:
        return np.asarray((own(digital) - low) / (high - low))

    return ToneCurve(forward)
