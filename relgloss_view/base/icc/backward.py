"""From XYZ under D50 to device values by a profile's own backward tables (B2A).

They map colours that the device can't show, and are coarse: a screen's picture takes the inverse
of the forward table instead.

Source: ICC.1:2022, 8.2 (which table serves an intent), 10.10 to 10.13 (mft1, mft2, mBA).
"""

from __future__ import annotations

import struct

import numpy as np

from relgloss_view.base.arrays import Array, Floats
from relgloss_view.base.icc.profile import D50, XYZ_ONE, Profile
from relgloss_view.base.icc.tables import Steps, each, table_steps
from relgloss_view.base.icc.tetrahedral import tetrahedral

#: Tables that serve an intent, best first.
SERVING = {
    "perceptual": (b"B2A0",),
    "relative": (b"B2A1", b"B2A0"),
    "saturation": (b"B2A2", b"B2A0"),
}


def device_by_table(profile: Profile, xyz: Array, intent: str) -> Array | None:
    """Device values (N, 3) of media-relative XYZ (N, 3) under D50; None without such a table.

    intent: a key of SERVING. Nodes are interpolated by tetrahedra. Raises ValueError where a table
    is damaged or the device has other than three channels.
    """
    name = next((tag for tag in SERVING[intent] if tag in profile.tags), None)
    if name is None:
        return None
    try:
        steps = table_steps(profile.tags[name], 3, backward=True)
    except (struct.error, IndexError) as error:
        raise ValueError(f"a damaged ICC profile ({error})") from None
    values: Floats = _encoded(steps, xyz, profile.lab)
    if steps.turn_of_xyz is not None:
        if not profile.lab:
            values = np.clip(values @ steps.turn_of_xyz.T, 0.0, 1.0)
        values = each(steps.first, values)
    else:
        values = each(steps.last, values)
        if steps.turn is not None:
            values = np.clip(values @ steps.turn.T + steps.shift, 0.0, 1.0)
        values = each(steps.middle, values)
    if steps.grid is not None:
        values = tetrahedral(steps.grid, values)
    ending = steps.last if steps.turn_of_xyz is not None else steps.first
    return np.asarray(np.clip(each(ending, values), 0.0, 1.0), np.float64)


def _encoded(steps: Steps, xyz: Array, lab: bool) -> Array:
    """The connection space's values, 0 to 1, as a table takes them."""
    if not lab:
        return np.clip(xyz / XYZ_ONE, 0.0, 1.0)
    t = xyz / D50
    f = np.where(t > (6.0 / 29.0) ** 3, np.cbrt(t), t * (841.0 / 108.0) + 4.0 / 29.0)  # CIE 15
    values = np.stack(
        [
            1.16 * f[:, 1] - 0.16,
            (500.0 * (f[:, 0] - f[:, 1]) + 128.0) / 255.0,
            (200.0 * (f[:, 1] - f[:, 2]) + 128.0) / 255.0,
        ],
        axis=1,
    )
    if steps.old_lab:
        values = values * (65280.0 / 65535.0)
    return np.asarray(np.clip(values, 0.0, 1.0))
