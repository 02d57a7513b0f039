"""The kinds of trouble by name, with the words by which a warning would name each."""

from __future__ import annotations

import re
from dataclasses import dataclass

from relgloss_view.bench.verdicts import instrument, troubles
from relgloss_view.bench.verdicts.instrument import GRIDS
from relgloss_view.bench.verdicts.samples import S_RANGE_DEG, GridMaker
from relgloss_view.bench.verdicts.troubles import Apply

#: Those with half-vectors in more than one azimuth around the normal at one incidence.
OPEN_GRIDS = (
    instrument.paper_grid, instrument.mirror_scan_grid, instrument.hemisphere_grid,
    instrument.half_vector_grid,
)  # fmt: skip


@dataclass(frozen=True)
class Fault:
    """One kind of trouble."""

    name: str
    apply: Apply
    words: str  #: regular expression, ignoring case, of warnings that name the fault
    grids: tuple[GridMaker, ...] = GRIDS
    s_range_deg: tuple[float, float] = S_RANGE_DEG
    strict: bool = True  #: whether the grid resolves the highlight before the fault

    def named_in(self, texts: tuple[str, ...]) -> bool:
        """Whether a warning or message names the fault."""
        return any(re.search(self.words, text, re.IGNORECASE) for text in texts)


FAULTS = (
    Fault(
        "undeclared saturation",
        troubles.saturation,
        r"saturat|plateau|clipp|largest value|same (largest )?value",
    ),
    Fault(
        "stray light",
        troubles.stray_light,
        r"stray|offset|constant (light|part)|zero of the (detector|reading)",
    ),
    Fault("dark floor", troubles.dark_floor, r"floor|smallest value|clipp|plateau"),
    Fault("one plane scaled", troubles.lamp_drift, r"plane|incidence|alpha|drift"),
    Fault("lamp fades", troubles.slow_drift, r"drift|plane|incidence|order of the rows"),
    Fault("spikes", troubles.spikes, r"spike|outlier|single (rows|samples)|tail|explain"),
    Fault("bad bands", troubles.bad_bands, r"band|channel|\bnm\b"),
    Fault(
        "wrong unit",
        troubles.wrong_unit,
        r"percent|quantity|unit|albedo|reflects more|pi times",
    ),
    Fault("cosine missed", troubles.cosine_missed, r"cosine|reciproc|quantity|brdf-cos"),
    Fault("radians", troubles.radians, r"radian"),
    Fault("aperture declared wrong", troubles.aperture_wrong, r"aperture", s_range_deg=(0.4, 4.0)),
    Fault(
        "full angle as deviation",
        troubles.full_angle,
        r"aperture|diameter|full angle",
        s_range_deg=(0.4, 5.0),
    ),
    Fault(
        "receiver wider than the lobe",
        troubles.wide_receiver,
        r"aperture|wider|receiver",
        s_range_deg=(0.4, 2.0),
    ),
    Fault(
        "mirror at the other side",
        troubles.mirror_other_side,
        r"mirror|other side|same.side|sign|azimuth",
    ),
    Fault(
        "mirror plane elsewhere",
        troubles.mirror_other_plane,
        r"mirror|gamma|ridge|azimuth|peak",
    ),
    Fault("plane's zero off", troubles.plane_zero, r"gamma|azimuth|zero|peak|ridge"),
    Fault(
        "lamp's zero off",
        troubles.lamp_zero,
        r"zero|alpha|theta|lamp.{0,30}off|angle",
        s_range_deg=(0.4, 6.0),
    ),
    Fault(
        "receiver's zero off",
        troubles.receiver_zero,
        r"zero|beta|theta|receiver.{0,30}off|angle",
        s_range_deg=(0.4, 6.0),
    ),
    Fault("sample tilted", troubles.tilt, r"tilt|normal|zero|mirror"),
    Fault(
        "highlight missing",
        troubles.highlight_missed,
        r"mirror|width|identif|resolve|narrow|missing",
    ),
    Fault(
        "highlight between samples",
        troubles.highlight_in_few,
        r"width|identif|resolve|narrow|step|few",
        grids=(instrument.coarse_grid,),
        s_range_deg=(0.4, 4.0),
        strict=False,
    ),
    Fault(
        "rows of two samples",
        troubles.mixed_rows,
        r"outlier|mixed|two samples|tail|explain|do not describe|describes",
    ),
    Fault(
        "anisotropic",
        troubles.anisotropy,
        r"anisotrop|direction of|azimuth|grain direction|brushed",
        grids=OPEN_GRIDS,
    ),
    Fault("metal", troubles.metal, r"metal|colou?r|index"),
    Fault("interference colour", troubles.interference, r"colou?r|film|interference|band"),
    Fault(
        "retroreflection",
        troubles.retroreflection,
        r"retro|towards the lamp|back to the lamp|lamp's direction",
    ),
    Fault("other constants", troubles.other_constants, r"index|strength|constant|reflects more"),
    Fault("long tails", troubles.long_tails, r"tail|lobe|shape|describe"),
    Fault(
        "other shadowing",
        troubles.other_shadowing,
        r"grazing|incidence|describe|plane|shadow",
        s_range_deg=(6.0, 20.0),
    ),
    Fault("coat and body", troubles.clear_coat, r"lobe|describe|grazing|incidence|plane"),
)
BY_NAME = {fault.name: fault for fault in FAULTS}
