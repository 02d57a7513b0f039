"""What a gloss meter would read on both materials, as a proof's page shows it."""

from __future__ import annotations

from typing import Any

from relgloss_view.gloss.meter.meter import Reading, gloss_readings
from relgloss_view.material.material import Material
from relgloss_view.pack.plain_finish import plain_finishes
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.proof.pair import Pair

DIGITS = 6  #: decimals of a kept value; a meter shows one
#: Of `gloss_readings`: what people see and no meter reads. Its names are those of the sliders.
SEEN = ("contrast-gloss", "distinctness")


def meter_of(pair: Pair) -> dict[str, dict[str, Any]]:
    """Readings by key, with the value of each side; None where an instrument reads nothing.

    decimals: how many of them an instrument shows. Of a pack the test is its glossiest finish.
    """
    sides = {
        "reference": _by_key(pair.scenes["reference"].material),
        "test": _by_key(_judged(pair.scenes["test"])),
    }
    return {
        key: {
            "name": reading.name,
            "standard": reading.standard,
            "decimals": reading.decimals,
            **{side: _kept(readings[key].value) for side, readings in sides.items()},
        }
        for key, reading in sides["reference"].items()
    }


def finishes_of(pair: Pair) -> list[dict[str, Any]]:
    """The readings of each finish of a pack, in their order; none of a sample.

    lies_somewhere: whether any place of the pack shows it.
    """
    scene = pair.scenes["test"]
    if scene.pack is None:
        return []
    plain = plain_finishes(scene.pack, scene.lamp.illuminant)
    return [
        {
            "finish": one.finish.name,
            "kind": one.finish.kind,
            "material": one.finish.material.name,
            "lies_somewhere": one.lies_somewhere,
            "readings": {
                key: _kept(reading.value) for key, reading in _by_key(one.finish.material).items()
            },
        }
        for one in plain
    ]


def are_close(kept: float | None, own: float | None, decimals: int) -> bool:
    """Whether two readings are the same on an instrument that shows so many decimals.

    >>> are_close(1.01, 1.0, 1), are_close(1.2, 1.0, 1), are_close(None, 1.0, 1)
    (True, False, False)
    """
    if kept is None or own is None:
        return kept is own
    return abs(kept - own) <= 10.0**-decimals


def are_same_finishes(
    kept: Any, own: list[dict[str, Any]], meter: dict[str, dict[str, Any]]
) -> bool:
    """Whether the finishes of a proof are named as its pack's own and read the same.

    kept: `meter_finishes` of a content, within the bounds of entries.py. own: of finishes_of.
    """
    entries = kept or []
    if len(entries) != len(own):
        return False
    for one, other in zip(entries, own, strict=True):
        if any(one.get(name) != other[name] for name in other if name != "readings"):
            return False
        if set(one["readings"]) != set(other["readings"]):
            return False
        for key, value in other["readings"].items():
            if not are_close(one["readings"][key], value, meter[key]["decimals"]):
                return False
    return True


def _judged(scene: Scene) -> Material:
    from relgloss_view.gloss.samples import SampleLook
    from relgloss_view.picture.scene.look import Look

    return SampleLook("", scene.material, Look(), scene.pack).judged_material


def _by_key(material: Material) -> dict[str, Reading]:
    """An instrument's readings, by key."""
    return {one.key: one for one in gloss_readings(material) if one.key not in SEEN}


def _kept(value: float | None) -> float | None:
    return None if value is None else round(float(value), DIGITS)
