"""Grays of words and marks on the surround: neutral, each as strong as it has to be.

All of a session stays on the surround's gray, so that the eyes stay adapted to it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Rgb
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.model import tone

#: Contrasts to the surround (WCAG 2, which asks for 4.5 for text and 3 for large text). A surround
#: of L* = 50 admits 4.7 at most.
TEXT, QUIET, FAINT = 7.0, 3.2, 1.9
FIELD, HOVERED, PRESSED = 1.25, 1.45, 1.7
FLARE = 0.05  #: of a screen in a room, relative to white; part of the definition


@dataclass(frozen=True)
class Ink:
    """Neutral grays in the display's digital values, each 0 to 1."""

    text: Rgb
    quiet: Rgb  #: of what explains
    faint: Rgb  #: of what must not draw the eye
    field: Rgb  #: of what can be clicked
    hovered: Rgb
    pressed: Rgb

    @classmethod
    def on(cls, display: Display) -> Ink:
        """What is written with on a display's surround."""
        contrasts = (TEXT, QUIET, FAINT, FIELD, HOVERED, PRESSED)
        return cls(*(contrasting(display, contrast) for contrast in contrasts))


def contrasting(display: Display, contrast: float) -> Rgb:
    """The gray of a contrast to the surround; black or white where that is too much.

    It is darker than a light surround and lighter than a dark one: what reaches further.
    """
    model = DisplayModel.of(display)
    surround = max(model.background_light, float(np.max(model.lowest))) + FLARE
    darker = surround / FLARE >= (1.0 + FLARE) / surround
    light = (surround / contrast if darker else surround * contrast) - FLARE
    return tone.neutral_digital(light, model)
