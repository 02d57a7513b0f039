"""Tidying: the targets that do not show and can be drawn again are freed."""

from __future__ import annotations

from relgloss_view.picture.gpu.passes import Passes
from relgloss_view.picture.gpu.targets import COVERAGE, GRAIN_FIELD, OVERLAY, SPLIT, TONE, XYZ

#: Targets that are kept as long as their pass holds, and what it holds as.
HELD_AS = {**dict.fromkeys(OVERLAY, "overlay"), **dict.fromkeys(GRAIN_FIELD, "grain")}
#: What is drawn on request, and drawn again when it is asked for the next time.
ON_REQUEST = ("xyz", "light", "geometry")


def tidy(passes: Passes) -> int:
    """Free what shows nothing and is drawn again where somebody asks; returns its bytes.

    What shows stays, and what a change of c or of the display starts from. A change of the scene
    draws into new targets, which takes a software driver some milliseconds more, once.
    """
    kept = {*SPLIT, *TONE, *COVERAGE}
    # Several samples a pixel: shares and colours are read from what pass 1 wrote.
    kept |= {name for name in passes.written if name in XYZ}
    kept |= {name for name, held in HELD_AS.items() if passes.held.holds(held)}
    dropped = [name for name in passes.targets.held() if name not in kept]
    for name in dropped:
        passes.around.pop(name, None)
    for name in ON_REQUEST:
        passes.held.drop(name)
    freed = passes.strip.bytes() + passes.targets.drop(dropped)
    passes.strip.release()
    return freed
