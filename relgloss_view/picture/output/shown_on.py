"""The display that a picture is made for: in numbers for its file, and where it falls short."""

from __future__ import annotations

import hashlib
from typing import Any

import numpy as np

from relgloss_view.base.reading import printable
from relgloss_view.display.display import USUAL_CD_M2, Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame

LEAST_SHARE = 0.01  #: of the object, from which a warning is worth its line
DECLARED = "declared"  #: source of a display that no file describes
ASKS_WHITE = "display_cd_m2"  #: the operators' parameter that takes the display's own where None


def display_numbers(display: Display) -> dict[str, Any]:
    """What is known of a display, as values for JSON.

    name, source: "declared", or of its file "profile" or "readings". luminance_cd_m2: of white,
    black_cd_m2: at digital 0; both with the light that the screen reflects, reflected_cd_m2.
    luminance_assumed: nobody states it, and it is the usual one. black_assumed: it is taken as
    dark. icc_sha256: of the file's own profile, None where there is none.

    >>> numbers = display_numbers(Display(luminance_cd_m2=160.0, reflected_cd_m2=2.0))
    >>> numbers["name"], numbers["luminance_cd_m2"], numbers["black_cd_m2"]
    ('sRGB', 162.0, 2.0)
    """
    model = _screen(DisplayModel.of(display))
    monitor = model.monitor
    icc = None if monitor is None else monitor.icc
    return {
        "name": _declared_name(display) if monitor is None else printable(monitor.name, 200),
        "source": DECLARED if monitor is None else monitor.source,
        "luminance_cd_m2": float(f"{model.luminance_cd_m2:.7g}"),
        "luminance_assumed": not model.luminance_known,
        "black_cd_m2": float(f"{max(model.black_cd_m2, 0.0):.7g}"),
        "black_assumed": not model.black_known,
        "reflected_cd_m2": model.reflected_cd_m2,
        "icc_sha256": None if icc is None else hashlib.sha256(icc).hexdigest(),
        "notes": [] if monitor is None else [printable(note, 300) for note in monitor.notes],
    }


def display_warnings(frame: Frame, displayed: Displayed | None = None) -> tuple[str, ...]:
    """What a display can't show of its picture, and what is assumed of it; a sentence each.

    displayed: the picture of another operator than the split. A display of which a file or the
    scene states nothing gets none about black and gamut: its numbers are in the picture's own.
    """
    display = frame.scene.display
    model = DisplayModel.of(display)
    return (
        *_too_dark(frame, displayed, model),
        *_out_of_gamut(frame, displayed, model),
        *_assumed(display, displayed, model),
    )


def _too_dark(frame: Frame, displayed: Displayed | None, model: DisplayModel) -> tuple[str, ...]:
    black = model.black_cd_m2
    if model.screen is not None or not np.any(model.lowest > 0.0) or black <= 0.0:
        return ()
    digital = frame.display if displayed is None else displayed.digital
    dark = np.all(digital == 0, axis=-1)
    if np.all(model.background_rgb <= model.lowest):  # the surround is as dark
        dark &= frame.on_object
    share = float(np.sum(dark)) / max(frame.object_pixels, 1)
    if share < LEAST_SHARE:
        return ()
    about = "" if model.luminance_known else "about "
    mend = (
        "Darken the room"
        if model.reflected_cd_m2 > 0.5 * black
        else ("Use a display with a darker black")
    )
    return (
        f"{100.0 * share:.0f} % of the object is darker than the display's black, {about}"
        f"{black:.3g} cd/m2, and appears as that black. {mend} to see it.",
    )


def _out_of_gamut(
    frame: Frame, displayed: Displayed | None, model: DisplayModel
) -> tuple[str, ...]:
    if model.monitor is None:
        return ()
    share = (displayed or frame).out_of_gamut_count / max(frame.object_pixels, 1)
    if share < LEAST_SHARE:
        return ()
    changed = "appear paler" if model.gamut == "chroma" else "are cut, and change their hue"
    whose = "the display's" if model.screen is None else "the other display's"
    return (
        f"{100.0 * share:.0f} % of the object has colours outside {whose} gamut; they "
        f"{changed}. A display with a wider gamut shows them.",
    )


def _assumed(display: Display, displayed: Displayed | None, model: DisplayModel) -> tuple[str, ...]:
    asks = displayed is not None and displayed.settings.get(ASKS_WHITE, 0.0) is None
    operator = f"the picture of {displayed.operator}" if displayed is not None and asks else ""
    if model.screen is not None and operator and not model.luminance_known:
        return (
            f"{operator} depends on the luminance of the other display's white, which is not "
            f"known; {USUAL_CD_M2:g} cd/m2 is assumed. Write a display file for it with its "
            "luminance_cd_m2.",
        )
    screen = _screen(model)
    depends = [operator] if operator and model.screen is None else []
    if display.black_cd_m2 is not None:
        depends.append("display.black_cd_m2")
    if screen.reflected_cd_m2 > 0.0:
        depends.append("display.reflected_cd_m2")
    if screen.luminance_known or not depends:
        return ()
    depend = "depends" if len(depends) == 1 else "depend"
    return (
        f"{' and '.join(depends)} {depend} on the luminance of the display's white, which is not "
        f"known; {USUAL_CD_M2:g} cd/m2 is assumed. Give it with --set "
        "display.luminance_cd_m2=VALUE.",
    )


def _screen(model: DisplayModel) -> DisplayModel:
    """The display before the observer, which may show what another one would."""
    return model if model.screen is None else model.screen


def _declared_name(display: Display) -> str:
    plain = Display()
    if display.transfer != "srgb":
        return f"declared, gamma {display.gamma:g}"
    same = (display.primaries_xy, display.white_xy) == (plain.primaries_xy, plain.white_xy)
    return "sRGB" if same else "sRGB curve with declared primaries"
