"""A monitor from an ICC profile.

Source: ICC.1:2022, 9.2.15 (chromaticAdaptationTag), 9.2.36 (mediaWhitePointTag), 9.2 (matrix and
curves); ICC.1:2001, 6.4.32 (luminanceTag).
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.icc.profile import Profile, read_profile
from relgloss_view.display.icc_white import emitted_from_connection
from relgloss_view.display.monitor import Curves, Monitor, with_black
from relgloss_view.display.tone_curve import ToneCurve


def monitor_of_profile(data: bytes, name: str) -> Monitor:
    """The monitor of a profile's bytes. Raises ValueError with the reason where it is of none."""
    profile = read_profile(data)
    if profile.space != "RGB":
        raise ValueError(f"an ICC profile of {profile.space}; a monitor's has RGB")
    if profile.grid is not None:
        raise ValueError("an ICC profile with look-up tables, which is not read yet")
    ends = profile.xyz(np.vstack([np.zeros(3), np.eye(3), np.ones(3)]), "relative")
    to_emitted, notes = emitted_from_connection(profile)
    black, white = to_emitted @ ends[0], to_emitted @ ends[4]
    matrix = to_emitted @ (ends[1:4] - ends[0]).T
    xyz_from_rgb, floor = with_black(matrix / white[1], black / white[1])
    curves = tuple(_curve(profile, k) for k in range(3))
    return Monitor(
        profile.description or name,
        "profile",
        white / white[1],
        xyz_from_rgb,
        floor,
        Curves((curves[0], curves[1], curves[2])),
        notes=notes,
        icc=data,
    )


def _curve(profile: Profile, channel: int) -> ToneCurve:
    own = profile.curves[channel]
    low, high = (float(own(np.array([end]))[0]) for end in (0.0, 1.0))

    def forward(digital: Array) -> Array:
        return np.asarray((own(digital) - low) / (high - low))

    return ToneCurve(forward)
