"""Samples whose gloss is compared: a material, how it is drawn, and its computed gloss."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.gloss.meter.meter import BARE_DECIMALS, DECIMALS, gloss_readings
from relgloss_view.material.material import Material
from relgloss_view.picture.scene.look import Look

#: Readings that may order materials or give their ratio: Reading.key of gloss/meter.
GLOSSES = ("gloss-20", "gloss-60", "gloss-75", "gloss-85", "contrast-gloss")
DEFAULT_GLOSS = "gloss-75"  #: the paper's own: "75/75 for papers"


@dataclass(frozen=True)
class SampleLook:
    """A material and how it is drawn; the label is unique among the samples of a command."""

    label: str
    material: Material
    look: Look


def computed_gloss(material: Material) -> dict[str, float | None]:
    """The readings of a material by key, GLOSSES; None where a meter reads nothing."""
    return {r.key: r.value for r in gloss_readings(material) if r.key in GLOSSES}


def gloss_number(gloss: str, value: float) -> str:
    """A value of one of GLOSSES with the digits that a meter shows.

    >>> gloss_number("gloss-75", 30.0642), gloss_number("contrast-gloss", 0.0464)
    ('30.1', '0.046')
    """
    decimals = DECIMALS if gloss.startswith("gloss-") else BARE_DECIMALS
    return f"{value:.{decimals}f}"


def gloss_words(gloss: str) -> str:
    """One of GLOSSES as people read it: by its angle, or "contrast gloss c"."""
    angle = gloss.removeprefix("gloss-")
    return f"gloss at {angle} deg" if angle != gloss else "contrast gloss c"
