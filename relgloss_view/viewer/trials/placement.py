"""Where pictures and the words below them stand in a window, and how large it has to be."""

from __future__ import annotations

import math
from dataclasses import dataclass

from relgloss_view.experiment.design.study import ALWAYS, GRAIN, Study
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.drawing.arrangement import Arrangement, centred
from relgloss_view.viewer.state.state import Presentation
from relgloss_view.viewer.trials.category_strip import FIELD_HEIGHT
from relgloss_view.viewer.trials.pages import text_px

MARGIN = 1.0  #: between pictures, question and strip, in sizes of the text
SHARE = 0.5  #: of the room below the pictures that is left: how much of it is above the strip


def presentation_of(study: Study) -> Presentation:
    """How the two pictures of a study are shown: alone on the surround."""
    screen = study.screen
    return Presentation(haploscopic=True, mirror=screen.mirror, gap_px=screen.gap_px)


def needed(study: Study, window: Size) -> Size:
    """The least window: the pictures, and as much above as what must show takes below them.

    window: decides the size of the text.
    """
    screen = study.screen
    below = needed_below(
        text_px(window), question=GRAIN in study.questions, strip=screen.scale == ALWAYS
    )
    width = 2 * screen.width_px + int(screen.gap_px)
    return width, screen.height_px + 2 * math.ceil(below)


def arranged(study: Study, window: Size) -> Arrangement | None:
    """Where the pictures stand, pixel upon pixel; None where the window is too small."""
    least = needed(study, window)
    if window[0] < least[0] or window[1] < least[1]:
        return None
    return centred(window, study.screen.size, presentation_of(study))


@dataclass(frozen=True)
class Below:
    """Where words stand below the pictures, pixels from the upper edge; None: there is no room."""

    question: float | None
    strip: float | None

    @classmethod
    def of(cls, top: float, bottom: float, text_px: float, *, question: bool) -> Below:
        """Share out the room from the pictures' lower edge to the window's."""
        room, margin, strip = bottom - top, MARGIN * text_px, FIELD_HEIGHT * text_px
        asked = text_px + margin if question else 0.0
        strip_at = None
        if margin + asked + strip + 0.5 * margin <= room:
            strip_at = top + max(margin + asked, SHARE * (room - strip))
        if not question or margin + text_px > room:
            return cls(None, strip_at)
        end = bottom if strip_at is None else strip_at
        return cls(top + max(margin, 0.5 * (end - top - text_px)), strip_at)


def needed_below(text_px: float, *, question: bool, strip: bool) -> float:
    """Room below the pictures without which something would not show that must, pixels."""
    parts = [text_px] * question + [FIELD_HEIGHT * text_px] * strip
    return sum(parts) + MARGIN * text_px * (len(parts) + 0.5) if parts else 0.0


def below_pictures(window: Size, arrangement: Arrangement, *, question: bool) -> Below:
    """Where words stand below pictures."""
    lower = max(top + height for _, top, _, height in arrangement.rects.values())
    return Below.of(lower, window[1], text_px(window), question=question)
