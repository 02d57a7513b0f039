"""What a monitor shows, in the numbers that people know: white, black, contrast, gamut, gamma."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.display.coverage import STANDARDS, Coverage, coverage
from relgloss_view.display.display import USUAL_CD_M2
from relgloss_view.display.icc_monitor import NO_BLACK
from relgloss_view.display.icc_tags import CALIBRATED, NO_LUMINANCE
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.temperature import correlated_temperature
from relgloss_view.material.spectra import xy_of

XY = tuple[float, float]
#: Notes of profiles that are shown as something missing, or as the calibration.
SHOWN_OTHERWISE = (NO_LUMINANCE, NO_BLACK, CALIBRATED)
LEAST_BLACK = 1e-7  #: share of white; below it black has no light
HALF = 0.5  #: digital value at which a channel's gamma is found
LUMINANCE, BLACK, CALIBRATION = "white luminance", "black", "calibration"
#: What mends a missing number, with the words for each.
STEPS = {
    LUMINANCE: f"pictures assume {USUAL_CD_M2:g} cd/m2; measure white and give --set "
    "display.luminance_cd_m2=VALUE, or give a few readings after the profile",
    BLACK: "pictures assume that black shows no light; measure black and give --set "
    "display.black_cd_m2=VALUE, or give a few readings after the profile",
}
LOAD_CALIBRATION = (
    "the profile holds a calibration (vcgt), and is right only while the system has it loaded; "
    "Argyll's `dispwin FILE` loads it"
)


@dataclass(frozen=True)
class Missing:
    """Something that the source does not hold, and what mends it."""

    what: str
    step: str


@dataclass(frozen=True)
class Overview:
    """The numbers of a monitor, for people. Luminances are in cd/m2; None is unknown.

    white_xy: CIE 1931. temperature: correlated, K, with its distance from the Planckian locus in uv
    of 1960; None for a white that has none. black: share of white's luminance; None where the
    source does not hold it. reflected_cd_m2: of the room. primaries_xy: of R, G, B without the
    light of black. gamma: of each channel, at half of the digital range. calibrated: whether an ICC
    profile holds tone curves for the graphics card; None for readings.
    """

    name: str
    source: str
    kind: str  #: of the model: 'curves', 'table', ...
    white_xy: XY
    temperature: tuple[float, float] | None
    luminance_cd_m2: float | None
    black: float | None
    reflected_cd_m2: float
    primaries_xy: tuple[XY, XY, XY]
    gamut: Mapping[str, Coverage]
    gamma: tuple[float, float, float]
    calibrated: bool | None
    missing: tuple[Missing, ...]
    notes: tuple[str, ...]

    @property
    def black_cd_m2(self) -> float | None:
        """Luminance of black; None where it or white's is unknown."""
        if self.black is None or self.luminance_cd_m2 is None:
            return None
        return self.black * self.luminance_cd_m2

    @property
    def contrast(self) -> float | None:
        """White's luminance over black's; None where black is unknown or without light."""
        return 1.0 / self.black if self.black and self.black > LEAST_BLACK else None

    def as_json(self) -> dict[str, Any]:
        """The overview as JSON holds it."""
        temperature = self.temperature
        return {
            "name": self.name,
            "source": self.source,
            "model": self.kind,
            "white": {
                "luminance_cd_m2": self.luminance_cd_m2,
                "xy": list(self.white_xy),
                "cct_k": None if temperature is None else temperature[0],
                "duv": None if temperature is None else temperature[1],
            },
            "black": {"share": self.black, "luminance_cd_m2": self.black_cd_m2},
            "reflected_cd_m2": self.reflected_cd_m2,
            "contrast": self.contrast,
            "primaries_xy": [list(xy) for xy in self.primaries_xy],
            "gamut": {
                name: {"covered": c.covered, "size": c.size} for name, c in self.gamut.items()
            },
            "gamma": list(self.gamma),
            "calibration": self.calibrated,
            "missing": [{"what": one.what, "step": one.step} for one in self.missing],
            "notes": list(self.notes),
        }


def overview_of(monitor: Monitor) -> Overview:
    """The numbers of a monitor."""
    dark = monitor.xyz(np.zeros((1, 3)))[0]
    ends = monitor.xyz(np.vstack([np.eye(3), np.ones(3)]))
    primaries = tuple(xy_of(xyz - dark) for xyz in ends[:3])
    own = primaries[0], primaries[1], primaries[2]
    luminance, reflected = monitor.luminance_cd_m2, monitor.reflected_cd_m2
    black = float(dark[1] / ends[3][1]) if monitor.black_known else None
    if monitor.black_cd_m2 is not None:
        black = monitor.black_cd_m2 / (luminance or USUAL_CD_M2)
    missing = [
        Missing(what, STEPS[what])
        for what, there in (
            (LUMINANCE, monitor.luminance_cd_m2 is not None),
            (BLACK, monitor.black_known),
        )
        if not there
    ]
    return Overview(
        monitor.name,
        monitor.source,
        monitor.emission.kind,
        xy_of(ends[3]),
        correlated_temperature(xy_of(ends[3])),
        luminance,
        None if black is None else max(black, 0.0),
        reflected,
        own,
        {name: coverage(own, name) for name in STANDARDS},
        _gamma(monitor),
        None if monitor.icc is None else monitor.calibration is not None,
        tuple(missing),
        tuple(note for note in monitor.notes if note not in SHOWN_OTHERWISE),
    )


def _gamma(monitor: Monitor) -> tuple[float, float, float]:
    """The exponent of each channel that gives its light at half of the digital range."""
    light = np.diag(monitor.emission.light(HALF * np.eye(3)))
    red, green, blue = (np.log(np.clip(light, 1e-9, 1.0)) / np.log(HALF)).tolist()
    return red, green, blue
