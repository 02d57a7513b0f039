"""The report of an estimate: the dullest, the likeliest and the glossiest material, side by side.

All three are drawn with one c, so that the ratio of their gloss on the sheet is that of the
materials: the largest c, up to 1, with which none of them clips.
"""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.reading import printable
from relgloss_view.base.version import __version__
from relgloss_view.display.display import Display
from relgloss_view.fitting.derived import peak
from relgloss_view.fitting.estimate.estimate import TAILS, Estimate
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.material.estimated import EstimateRecord
from relgloss_view.material.material import Material
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.output.contact_sheet import (
    INK_GRAY,
    PAPER_GRAY,
    plate,
)
from relgloss_view.picture.output.lettering import Lettering
from relgloss_view.picture.output.png import save_rgb
from relgloss_view.picture.pair import common_factor
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.backends import open_renderer

SIZE = (400, 400)  #: pixels of a picture
SAMPLES = 2  #: along each side of a pixel: the edge of a highlight is smooth
GAP, TEXT_PX, TITLE_PX, LINE = 24, 15, 21, 1.5
MUTED_GRAY = 208
MOST_LINES = 3  #: of warnings


def write_estimate_report(
    found: Estimate, path: str | os.PathLike[str], command: str, *, backend: str = "auto"
) -> tuple[str, ...]:
    """Draw the three materials into a PNG; returns lines that describe what is on it.

    command: the command line that draws it again. Raises InputError where it can't be written.
    """
    materials = (found.dullest, found.material, found.glossiest)
    with open_renderer(backend) as renderer:
        scene = [Scene(material) for material in materials]
        full = [renderer.render(one, Look(c=1.0, samples=SAMPLES), SIZE).c_max for one in scene]
        c = common_factor([(1.0, c_max) for c_max in full])
        frames, pictures = [], []
        for one in scene:
            frame = renderer.render(one, Look(c=c, samples=SAMPLES), SIZE)
            pictures.append(np.array(frame.display))
            frames.append(frame)
        captions = [_caption(*parts) for parts in zip(HEADS, materials, frames, strict=True)]
    record = found.material.estimate
    assert record is not None
    sheet = _sheet(pictures, captions, _title(found.material), _notes(record, c))
    text = {"Software": f"relgloss {__version__}", "Title": _title(found.material)}
    save_rgb(sheet, path, {**text, "Command": command}, display=Display())
    return (f"the pictures have one contrast gloss, c = {c:.3g}, so their gloss can be compared",)


HEADS = (
    f"dullest ({100.0 * TAILS[0]:g} % are duller)",
    "likeliest",
    f"glossiest ({100.0 * (1.0 - TAILS[1]):g} % are glossier)",
)


def _title(material: Material) -> str:
    assert material.estimate is not None
    record = material.estimate
    return f"{printable(material.name, 40)} [{record.words}] from gloss {record.reading_words}"


def _caption(head: str, material: Material, frame: Frame) -> list[str]:
    main = material.specular[0]
    second = material.specular[1:]
    gloss = ", ".join(
        f"{angle}: {specular_gloss(material, angle):.1f}" for angle in (20, 60, 75, 85)
    )
    return [
        head,
        f"s {main.s_deg:.3g} deg, strength {main.strength[0]:.2f}, n {main.refractive_index:.3f}",
        *(f"second lobe: {lobe.s_deg:.3g} deg, strength {lobe.strength[0]:.3f}" for lobe in second),
        f"gloss units at {gloss}",
        f"peak at 45 deg: {_digits(peak(material))} x white",
        f"c_max {frame.c_max:.3g}" if frame.c_max is not None else "no highlight is seen",
    ]


def _digits(value: float) -> str:
    """A number with three digits, never as a power of ten."""
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


def _notes(record: EstimateRecord, c: float) -> list[str]:
    notes = [
        f"All three are drawn with one c = {c:.3g}: their gloss can be compared. "
        f"{100.0 * record.level:.0f} % of the materials that agree with the readings lie between "
        "the outer two, in order of their peak."
    ]
    return notes + [f"Warning: {text}." for text in record.warnings[:MOST_LINES]]


def _sheet(
    pictures: Sequence[Bytes], captions: Sequence[Sequence[str]], title: str, notes: list[str]
) -> Bytes:
    from PIL import Image, ImageDraw

    text, heading = Lettering(TEXT_PX), Lettering(TITLE_PX)
    height, width = pictures[0].shape[:2]
    line = round(LINE * TEXT_PX)
    total = len(pictures) * (width + GAP) + GAP
    folded = [part for note in notes for part in _folded(note, text, total - 2 * GAP)]
    rows = max(len(lines) for lines in captions)
    top = GAP + 2 * TITLE_PX
    below = top + height + GAP // 2 + rows * line + GAP // 2
    image = Image.new("RGB", (total, below + len(folded) * line + GAP), (PAPER_GRAY,) * 3)
    pen = ImageDraw.Draw(image)
    title = _folded(title, heading, total - 2 * GAP)[0]
    plate(pen, (0, 0, total, top - GAP // 2))
    heading.draw(pen, (GAP, GAP // 2), title, (INK_GRAY,) * 3)
    for k, (picture, lines) in enumerate(zip(pictures, captions, strict=True)):
        x = GAP + k * (width + GAP)
        image.paste(Image.fromarray(np.ascontiguousarray(picture)), (x, top))
        under = top + height
        plate(pen, (x, under + GAP // 4, x + width, under + GAP // 2 + rows * line))
        for j, words in enumerate(lines):
            place = (x + GAP // 4, under + GAP // 2 + j * line)
            text.draw(pen, place, words, (INK_GRAY if j == 0 else MUTED_GRAY,) * 3)
    plate(pen, (0, below - GAP // 4, total, image.height))
    for j, words in enumerate(folded):
        text.draw(pen, (GAP, below + j * line), words, (INK_GRAY,) * 3)
    return np.asarray(image)


def _folded(text: str, font: Lettering, room: float) -> list[str]:
    """A text in lines that fit."""
    lines: list[str] = []
    for word in text.split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and font.length(longer) <= room:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines or [""]
