"""Samples whose gloss is compared: a material, how it is drawn, and its computed gloss."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.gloss.meter.meter import BARE_DECIMALS, DECIMALS, gloss_readings, specular_gloss
from relgloss_view.material.material import Material
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.plain_finish import plain_finishes
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup

#: Readings that may order materials or give their ratio: Reading.key of gloss/meter.
GLOSSES = ("gloss-20", "gloss-60", "gloss-75", "gloss-85", "contrast-gloss")
DEFAULT_ANGLE_DEG = 75.0
DEFAULT_LAMP = Setup().lamp.illuminant
DEFAULT_GLOSS = "gloss-75"  #: the paper's own: "75/75 for papers"


@dataclass(frozen=True)
class SampleLook:
    """A material and how it is drawn; the label is unique among the samples of a command."""

    label: str
    material: Material
    look: Look
    pack: Pack | None = None  #: whose base finish has the material

    def scene(self, setup: Setup) -> Scene:
        """The sample in a setup; a pack brings its own form."""
        return Scene(self.material, setup, pack=self.pack)

    @property
    def judged_material(self) -> Material:
        """The material whose gloss the sample is ranked by: of a pack, its glossiest finish.

        A picture is judged by the brightest place of its highlight, which belongs to that finish
        wherever the highlight crosses it. A finish that lies nowhere does not count.
        """
        if self.pack is None:
            return self.material
        plain = plain_finishes(self.pack, DEFAULT_LAMP)
        seen = [one.finish.material for one in plain if one.lies_somewhere]
        return max(seen, key=lambda material: specular_gloss(material, DEFAULT_ANGLE_DEG))

    def parts(self, setup: Setup) -> list[tuple[Material, float]]:
        """The materials that a picture can show, with the sigma_N of each, degrees."""
        if self.pack is None:
            return [(self.material, self.look.sigma_n_deg)]
        own = self.look.sigma_n_deg
        return [
            (one.material, own if (sigma := one.finish.sigma_n_deg) is None else sigma)
            for one in plain_finishes(self.pack, setup.lamp.illuminant)
            if one.lies_somewhere
        ]


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
