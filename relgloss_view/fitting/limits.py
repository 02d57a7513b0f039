"""Unknowns that end at a limit of their search: the samples want more than the model can be."""

from __future__ import annotations

import numpy as np

from relgloss_view.fitting.model import (
    FAINT,
    INDEX_RANGE,
    LOG_S_RANGE,
    T_MAX,
    Rung,
    State,
    brightness,
)
from relgloss_view.fitting.unknowns import shared_unknowns

#: Indices of dielectrics, from a fluoropolymer to a titania-filled lacquer (Shackelford 2015 lists
#: 1.35 to 1.75 for polymers and glasses). Outside them a fitted index only describes a shape.
OPTICAL_INDEX = (1.3, 1.8)
#: Those that a fit may find by itself and be believed: a narrow highlight whose apertures are wider
#: than declared looks as if it had an index beyond these. Coatings, inks and varnishes have 1.4 to
#: 1.6; an index that is known can be held.
USUAL_INDEX = (1.36, 1.65)
_NEAR = 1e-3
#: Of a width, an index or an error, beside its limit: the samples hold it no better than this.
_BESIDE = 0.05


def at_limits(rung: Rung, state: State, *, names: tuple[str, ...] = ()) -> tuple[str, ...]:
    """What of a state lies at an end of its search, in words; empty where nothing does.

    names: of the instrument's errors, where the rung frees them. A roughness of zero, a lobe of no
    strength and the narrowest width are no limits: Lambert, no lobe, and a lobe narrower than the
    samples can show, which the verdict reports as unidentifiable.
    """
    found = []
    if rung.rough and state.t >= T_MAX * (1.0 - _NEAR):
        found.append(f"the roughness sigma at {np.degrees(np.sqrt(T_MAX)):.0f} deg")
    strengths = brightness(state) if rung.lobes else np.zeros(0)
    for j, strength in enumerate(strengths.tolist()):
        if strength <= FAINT * float(np.max(strengths)):
            continue
        if state.log_s[j] >= LOG_S_RANGE[1] - _BESIDE:
            found.append(f"the width of a lobe at {np.degrees(np.exp(LOG_S_RANGE[1])):.0f} deg")
        if rung.free_index:
            ends = [end for end in INDEX_RANGE if abs(state.n[j] - end) <= _NEAR * end]
            found += [f"a refractive index at {end:g}" for end in ends]
    if rung.errors and state.errors.size:
        unknowns = shared_unknowns(rung)
        low, high = unknowns.low[unknowns.errors], unknowns.high[unknowns.errors]
        at_end = (state.errors <= low * (1.0 - _NEAR)) | (state.errors >= high * (1.0 - _NEAR))
        found += [name for name, ends in zip(names, at_end, strict=True) if ends]
    return tuple(found)
