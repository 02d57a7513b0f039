"""The screen that pictures are drawn for: this monitor, by the system's profile, or the scene's.

A state holds the display that its scene declares. What the window draws is the state `for_screen`;
files, copied commands and the session keep the scene's.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.display.display import USUAL_CD_M2, Display
from relgloss_view.display.icc_writing import is_srgb
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.read import monitor_of
from relgloss_view.display.system.answer import NONE_NAMED
from relgloss_view.viewer.state.state import SIDES, THIS_MONITOR, State

LONGEST_NAME = 60  #: characters


@dataclass(frozen=True, eq=False)
class Screen:
    """What the system has for the monitor that the window lies on.

    file: the profile as the window keeps it; "" where there is none, for the reason. fault: there
    is one, and it can't be used. source: where it is from. calibration: (3, n) of 0 to 1, the
    curves that the profile asks the graphics card to apply; None where it asks for none.
    """

    file: str = ""
    name: str = ""
    source: str = ""
    luminance_cd_m2: float | None = None
    reason: str = NONE_NAMED
    fault: bool = False
    notes: tuple[str, ...] = ()
    calibration: Array | None = None


def unreadable_files(state: State) -> dict[str, str]:
    """The files of a state's displays that can't be read now, with the reasons."""
    presentation = state.presentation
    files = state.setup.display.profile, *(presentation.seen_on(side) for side in SIDES)
    faults = {}
    for file in files:
        try:
            _ = monitor_of(file) if file else None
        except RelglossError as error:
            faults[file] = str(error)
    return faults


def for_screen(state: State, screen: Screen, without: Collection[str] = ()) -> State:
    """The state as the window draws it.

    without: files that can't be read, which count as none. Where pictures are for this monitor and
    it has a profile, that takes the place of what the scene declares. White luminance, black and
    reflected light stay: who sets them sees them here.
    """
    if without:
        lost = {f"{s}_seen_on": "" for s in SIDES if state.presentation.seen_on(s) in without}
        state = state.with_part("presentation", **lost)
        if state.setup.display.profile in without:
            state = state.with_part("display", profile="")
    if not takes(state, screen):
        return state
    return state.with_part("display", profile=screen.file)


def takes(state: State, screen: Screen) -> bool:
    """Whether pictures are drawn for the system's profile."""
    return bool(screen.file) and state.presentation.screen == THIS_MONITOR


def monitor_for(display: Display) -> Monitor | None:
    """The monitor of a display's profile; None without one, or where its file can't be read."""
    try:
        return monitor_of(display.profile) if display.profile else None
    except RelglossError:
        return None


def name_of(display: Display) -> str:
    """A display's name for people: its profile's, sRGB, or what it declares."""
    monitor = monitor_for(display)
    if monitor is not None:
        return printable(monitor.name, LONGEST_NAME)
    if display.profile:
        return "a profile that can't be read"
    if is_srgb(display):
        return "sRGB"
    if display.transfer == "srgb":
        return "sRGB curves, other primaries"
    return f"gamma {display.gamma:g} ({display.transfer})"


def name_of_other(file: str) -> str:
    """The name of a display that another one shows, by its file."""
    try:
        return printable(monitor_of(file).name, LONGEST_NAME)
    except RelglossError:
        return "a display that can't be read"


def luminance_of(display: Display) -> tuple[float, str]:
    """Luminance of a display's white in cd/m2 by itself, and who gives it."""
    monitor = monitor_for(display)
    if monitor is not None and monitor.luminance_cd_m2 is not None:
        return monitor.luminance_cd_m2, "by its profile"
    return USUAL_CD_M2, "assumed"


def black_of(display: Display, white_cd_m2: float) -> tuple[float, str]:
    """Luminance of a display's black in cd/m2 by itself, and who gives it."""
    bare = dataclasses.replace(
        display, luminance_cd_m2=None, black_cd_m2=None, reflected_cd_m2=0.0, seen_on=""
    )
    try:
        model = DisplayModel.of(bare)
    except RelglossError:
        return 0.0, "assumed"
    share = float(model.xyz_from_rgb[1] @ model.darkest)
    by = ("by its profile" if display.profile else "declared") if model.black_known else "assumed"
    return share * white_cd_m2, by


def screen_words(state: State, screen: Screen) -> tuple[str, str]:
    """The display that pictures are drawn for, in a line and in a few words."""
    display = for_screen(state, screen).setup.display
    name = name_of(display)
    luminance, known = display.luminance_cd_m2, True
    if luminance is None:
        luminance, by = luminance_of(display)
        known = by != "assumed"
    text = f"{name}, {luminance:.0f} cd/m2" if known else name
    if takes(state, screen):
        return text, name
    if state.presentation.screen != THIS_MONITOR:
        return f"{text}, as the scene declares", name
    return f"{text} assumed: {screen.reason}", f"{name} assumed"


def calibration_is_loaded(wanted: Array, ramp: Array, tolerance: float = 0.02) -> bool:
    """Whether a graphics card's curves (3, m) are those of a profile (3, n), all from 0 to 1.

    tolerance: of the largest difference. Cards round to 8 to 16 bits, and a program may resample
    a table of 256 entries for one of 1024; a curve that matters differs by more.
    """
    at = np.linspace(0.0, 1.0, ramp.shape[1])
    nodes = np.linspace(0.0, 1.0, wanted.shape[1])
    asked = np.stack([np.interp(at, nodes, channel) for channel in wanted])
    return bool(np.abs(asked - ramp).max() <= tolerance)
