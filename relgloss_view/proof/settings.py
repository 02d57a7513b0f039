"""Settings: what one who looks at a proof can change, and what a reply hands on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, parameter
from relgloss_view.base.reading import refuse
from relgloss_view.base.toml import build_part, entries
from relgloss_view.picture.scene.match import MOST_C
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SIDES = ("reference", "test")
MOST_NAME = 200  #: characters of a lamp's


@dataclass(frozen=True)
class PictureSetting(Checked):
    """Graininess and contrast gloss of one picture.

    sigma_n_deg: degrees, 0 to 10. c: factor of L_s* itself, 0 to 10,000, before the pair's common
    factor (picture.pair). Raises InputError where a value is out of its range.
    """

    TABLE = "setting"

    sigma_n_deg: float = parameter(0.0, 0.0, 10.0, "deg", "graininess")
    c: float = parameter(1.0, 0.0, MOST_C, "", "contrast gloss")


@dataclass(frozen=True)
class LampPlace(Checked):
    """Where the main lamp is, as scene.Lamp has it, and its spectrum.

    illuminant: a name of the proof's own lamps. Raises InputError where a value is out of range.
    """

    TABLE = "lamp"

    azimuth_deg: float = parameter(50.0, -180.0, 180.0, "deg", "direction of the lamp")
    elevation_deg: float = parameter(0.0, -90.0, 90.0, "deg", "height of the lamp")
    distance_m: float = parameter(1.0, 1e-3, 1e3, "m", "distance of the lamp")
    illuminant: str = "HP5"

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.illuminant, str) or len(self.illuminant) > MOST_NAME:
            refuse("lamp.illuminant", f"a name of at most {MOST_NAME} characters", self.illuminant)

    @classmethod
    def of(cls, lamp: Lamp) -> LampPlace:
        """The place of a scene's main lamp."""
        return cls(lamp.azimuth_deg, lamp.elevation_deg, lamp.distance_m, lamp.illuminant)


@dataclass(frozen=True)
class Settings:
    """The two pictures' settings, and the eye and the lamp that they share."""

    reference: PictureSetting
    test: PictureSetting
    eye: Eye
    lamp: LampPlace

    def side(self, name: str) -> PictureSetting:
        """The setting of a side, one of SIDES."""
        setting: PictureSetting = getattr(self, name)
        return setting

    def in_setup(self, setup: Setup) -> Setup:
        """A proof's setup with this eye and this lamp."""
        return setup.placed(eye=self.eye).with_entries("lamp", **entries(self.lamp))

    def as_json(self) -> dict[str, Any]:
        """As a proof's JSON holds them."""
        return {name: entries(getattr(self, name)) for name in PARTS}

    @classmethod
    def from_json(cls, content: object) -> Settings:
        """Of a proof's JSON; InputError names what is wrong."""
        if not isinstance(content, Mapping) or set(content) != set(PARTS):
            raise InputError(f"settings: expected {', '.join(PARTS)}")
        return cls(**{name: build_part(kind, name, content[name]) for name, kind in PARTS.items()})


PARTS: dict[str, type[Any]] = {
    "reference": PictureSetting,
    "test": PictureSetting,
    "eye": Eye,
    "lamp": LampPlace,
}
