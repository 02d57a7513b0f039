"""Many colours through a monitor: digital values, XYZ and CIELAB into each other.

Intents as ICC.1:2022 has them, annex D. 'relative': white is what the monitor's white is. XYZ are
those that it emits, white at Y = 1, and CIELAB are relative to that white. 'absolute': XYZ are the
same, and CIELAB are relative to D50, so that a bluish white is bluish.

The connection space of profiles (pcs) is the third form: XYZ adapted to D50, and their CIELAB.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.icc.profile import D50, read_profile
from relgloss_view.display.few_readings import with_own_black
from relgloss_view.display.monitor import Monitor
from relgloss_view.material import cielab

RGB, XYZ, LAB = SPACES = ("rgb", "xyz", "lab")
RELATIVE, ABSOLUTE = INTENTS = ("relative", "absolute")
#: A colour is shown where what its digital values show is no farther from it, in CIELAB.
SAME_LAB = 0.05


def converted(
    monitor: Monitor, values: Array, given: str, wanted: str, intent: str, *, pcs: bool = False
) -> Array:
    """Values (N, 3) of SPACES in another one; digital values are 0 to 1.

    Colours that the monitor can't show get the digital values of what it shows nearest to them, by
    `outside`.
    """
    white, turn = _space(monitor, intent, pcs)
    monitor = with_own_black(monitor)
    if given == RGB:
        xyz = monitor.xyz(values) @ turn.T
    else:
        xyz = values if given == XYZ else cielab.xyz_from_lab(values, white)
    if wanted == XYZ:
        return xyz
    if wanted == LAB:
        return cielab.lab_from_xyz(xyz, white)
    return values if given == RGB else monitor.digital(xyz @ np.linalg.inv(turn).T)


def outside(monitor: Monitor, values: Array, given: str, intent: str, *, pcs: bool) -> Mask:
    """Which of N colours the monitor can't show: its nearest differs by more than SAME_LAB."""
    rgb = converted(monitor, values, given, RGB, intent, pcs=pcs)
    back = converted(monitor, rgb, RGB, LAB, intent, pcs=pcs)
    wanted = converted(monitor, values, given, LAB, intent, pcs=pcs)
    return np.asarray(np.linalg.norm(back - wanted, axis=1) > SAME_LAB)


def _space(monitor: Monitor, intent: str, pcs: bool) -> tuple[Array, Array]:
    """The white of CIELAB, and the matrix from emitted XYZ to the XYZ that are meant."""
    if intent == ABSOLUTE:
        return D50, np.eye(3)
    if not pcs:
        return monitor.white, np.eye(3)
    if monitor.icc is None:
        return D50, cielab.bradford(monitor.white, D50)
    # The profile's own adaptation, whichever it is: that of three colours.
    profile = read_profile(monitor.icc)
    adapted = profile.xyz(np.eye(3), "relative").T
    return D50, adapted @ np.linalg.inv(monitor.xyz(np.eye(3)).T)
