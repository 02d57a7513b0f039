"""How a catalogue shows a material: metered, matched to the reference, drawn.

The geometry is the paper's, the display sRGB. c keeps the ratio of gloss to the reference; it is at
most the picture's c_max, so that nothing is clipped.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.catalogue.columns import LAB, READINGS
from relgloss_view.catalogue.one_thread import one_thread
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.gloss.match import Reference, full_c, gloss_of, matched_point
from relgloss_view.gloss.meter.meter import gloss_readings
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.material.files import material_from_dict
from relgloss_view.material.material import Material
from relgloss_view.material.recolour import colour_of
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.scene.look import Look, viewed_look
from relgloss_view.picture.scene.match import MOST_C
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.backends import FrameRenderer

LAB_LAMP = "D50"
#: A picture's own c_max is rounded in float32; c less than this share above it is not cut.
ROUNDING = 1e-5

_references: dict[str, Reference] = {}


@dataclass(frozen=True)
class Matched:
    """The setting of a material's picture.

    c: that keeps the ratio; None where no highlight is seen. spread: the largest c that a pose
    proposes over the smallest.
    """

    c: float | None
    spread: float | None
    shown_c: float  #: of the picture, where there is no grain
    c_max: float | None  #: without grain, for pictures of any size; None without a highlight


def reference_of(recipe: Recipe) -> Reference:
    """The reference that a recipe names; InputError where it has no gloss."""
    key = recipe.of_look
    if key not in _references:
        if isinstance(recipe.reference, str):
            label, material = recipe.reference, load_sample(recipe.reference)
        else:
            material = material_from_dict(recipe.reference)
            label = material.name
        setting: dict[str, Any] = {"sigma_n_deg": recipe.reference_sigma_n_deg}
        if recipe.reference_c is not None:
            setting["c"] = recipe.reference_c
        else:
            setting["c_fraction"] = 1.0
        _references.clear()  # one build has one
        sample = SampleLook(label, material, Look(**setting))
        with one_thread():  # its last digits are those of every process
            _references[key] = Reference.of(sample, recipe.gloss)
    return _references[key]


def match_of(material: Material, recipe: Recipe, sigma_n_deg: float = 0.0) -> Matched:
    """The setting that keeps a material's ratio of gloss to the recipe's reference.

    Raises InputError where its body is brighter than white.
    """
    reference = reference_of(recipe)
    point = matched_point(reference, material, sigma_n_deg)
    if point.c is None:
        return Matched(None, None, min(reference.c, MOST_C), None)
    c = min(point.c, MOST_C)
    c_max = full_c(material)
    if c_max < 0.0:  # no digit of a c that is so far from a highlight's says anything
        raise InputError(
            "its body is brighter than a white diffuser, so no picture shows its highlight; check "
            "what the table holds (--quantity) and its white"
        )
    return Matched(c, point.spread, min(c, c_max), c_max)


def draw(
    material: Material,
    recipe: Recipe,
    renderer: FrameRenderer,
    size: tuple[int, int] | None = None,
    sigma_n_deg: float = 0.0,
    matched: Matched | None = None,
) -> Frame:
    """The picture of a material as the recipe asks for it; its thumbnail's size by default.

    size: width and height in pixels. sigma_n_deg: graininess. matched: what match_of gives, where
    it is at hand. Raises InputError where the material can't be drawn.
    """
    size = size or (recipe.thumbnail_px, recipe.thumbnail_px)
    matched = matched or match_of(material, recipe, sigma_n_deg)
    scene = Scene(material)
    look = viewed_look(sigma_n_deg=sigma_n_deg, c=matched.shown_c)
    frame = renderer.render(scene, look, size)
    if sigma_n_deg > 0.0 and matched.c is not None and frame.c_max is not None:
        # Grain decides c_max with the picture's own pixels.
        look = look.with_entries(c=min(matched.c, frame.c_max))
        frame = renderer.render(scene, look, size)
    return frame


def numbers_of(material: Material, recipe: Recipe) -> dict[str, Any]:
    """The readings with their errors, the ratio and the colour, by column."""
    row: dict[str, Any] = {}
    for reading in gloss_readings(material):
        row[READINGS[reading.key]] = reading.value
        row[f"{READINGS[reading.key]}_se"] = reading.standard_error
    reference = reference_of(recipe)
    row["gloss_ratio"] = gloss_of(material, recipe.gloss) / reference.reading
    lab = colour_of(material, LAB_LAMP)
    row |= {name: float(value) for name, value in zip(LAB, lab, strict=True)}
    return row


def setting_of(matched: Matched, frame: Frame, sigma_n_deg: float) -> dict[str, Any]:
    """The setting of a picture, by column."""
    c_max = matched.c_max
    if sigma_n_deg > 0.0 and frame.c_max is not None:
        c_max = float(frame.c_max)
    kept = None
    if matched.c is not None and c_max is not None:
        kept = matched.c <= c_max * (1.0 + ROUNDING)
    return {
        "sigma_n_deg": sigma_n_deg,
        "c": matched.c,
        "c_spread": matched.spread,
        "c_max": c_max,
        "is_ratio_kept": kept,
    }
