"""The overlay's name on the picture, what it means, and the pattern or colours that it marks with.

"Clipped" is striped, "out of gamut" dotted and "cut by this display" lined, so that none needs a
colour, which would be a stranger beside the pictures. shaders/overlay.frag draws the same patterns.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from imgui_bundle import ImVec2, ImVec4, imgui

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.viewer.shell.theme import em, gray

#: What each overlay shows: whole words, and shorter ones for narrow pictures.
MEANINGS: dict[str, tuple[str, ...]] = {
    "clipped": (
        "Clipped: brighter than the display's white, and cut there",
        "Clipped: brighter than white",
        "Clipped",
    ),
    "out of gamut": (
        "Out of gamut: colours that the display can't show",
        "Out of gamut",
    ),
    "cut by this display": (
        "Cut by this display: light of the one that it is seen on, which this one can't show",
        "Cut: this display can't show it",
        "Cut here",
    ),
    "lightness": ("Lightness (L*) of the picture", "Lightness (L*)", "L*"),
    "diffuse only": ("Diffuse reflection alone", "Diffuse only"),
    "specular only": ("Specular reflection alone, scaled by c", "Specular only"),
    "normals": (
        "Normals of the surface: red to the right, green up, blue to the front",
        "Normals: red right, green up, blue front",
        "Normals",
    ),
}
PATCH_EM = (2.4, 0.9)
BAR_EM = (9.0, 0.8)
BAR_STEPS = 50
STRIPE_PX, DOT_STEP_PX, DOT_PX, LINE_STEP_PX, LINE_PX = 4, 6, 3, 5, 2  #: as in the shader
#: Directions whose colours the legend of the normals shows: right, up, to the front.
NORMALS = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])

Painter = imgui.ImDrawList


def words(overlay: str, frame: Frame | None) -> tuple[str, ...]:
    """The legend's words, the longest first; with the number of marked pixels of a picture."""
    texts = MEANINGS[overlay]
    if frame is None or overlay not in ("clipped", "out of gamut"):
        return texts
    count = frame.clip_count if overlay == "clipped" else frame.out_of_gamut_count
    number = "no pixel" if count == 0 else f"{count} pixel{'s' if count > 1 else ''}"
    return (*(f"{text}; {number}" for text in texts), texts[-1])


def show(
    painter: Painter,
    corner: ImVec2,
    width: float,
    colours: tuple[int, int],
    display: Display,
    overlay: str,
    frame: Frame | None,
) -> None:
    """Draw the legend upwards from a lower left corner; width is a picture's, in pixels.

    colours: of the ink and of the paper below it. frame: the picture whose marked pixels are
    counted; None for none.
    """
    ink, paper = colours
    patch = ImVec2(*(em(v) for v in (BAR_EM if overlay == "lightness" else PATCH_EM)))
    if overlay == "lightness":  # with its ends beside it, within the picture
        ends = imgui.calc_text_size("0").x + imgui.calc_text_size("100").x + em(0.7)
        patch.x = max(min(patch.x, width - ends), em(1.0))
    gap, line = em(0.5), imgui.get_text_line_height()
    sample = patch.x + gap if overlay in _PATTERNS else 0.0
    fitting = (t for t in words(overlay, frame) if imgui.calc_text_size(t).x + sample <= width)
    text = next(fitting, "")
    size = imgui.calc_text_size(text)
    low = ImVec2(corner.x, corner.y - line - em(0.7))
    if overlay == "lightness":
        _lightness(painter, ImVec2(low.x, low.y - patch.y - em(0.3)), patch, colours, display)
    elif sample:
        _patch(painter, ImVec2(low.x, low.y + 0.5 * (line - patch.y)), patch, overlay)
    place = ImVec2(low.x + sample, low.y)
    painter.add_rect_filled(place, ImVec2(place.x + size.x, place.y + size.y), paper)
    painter.add_text(place, ink, text)


def _lightness(
    painter: Painter, low: ImVec2, size: ImVec2, colours: tuple[int, int], display: Display
) -> None:
    """The bar of false colours from L* 0 to 100, with its ends."""
    ink, paper = colours
    model = DisplayModel.of(display)
    steps = np.linspace(0.0, 100.0, BAR_STEPS)
    rgb = tone.encode(tone.display_rgb(tone.false_colour(steps), model)[0], model)
    zero, top = imgui.calc_text_size("0"), imgui.calc_text_size("100")
    line = imgui.get_text_line_height()
    y = low.y + 0.5 * (size.y - line)
    left = low.x + zero.x + em(0.3)
    right = left + size.x + em(0.3)
    for x, text, extent in ((low.x, "0", zero), (right, "100", top)):
        painter.add_rect_filled(ImVec2(x, y), ImVec2(x + extent.x, y + extent.y), paper)
        painter.add_text(ImVec2(x, y), ink, text)
    for k, (red, green, blue) in enumerate(rgb.tolist()):
        x = left + size.x * k / BAR_STEPS
        high = ImVec2(x + size.x / BAR_STEPS + 1.0, low.y + size.y)
        painter.add_rect_filled(ImVec2(x, low.y), high, _colour(ImVec4(red, green, blue, 1.0)))


def _patch(painter: Painter, low: ImVec2, size: ImVec2, overlay: str) -> None:
    """A sample of what marks the pixels, with a thin frame."""
    high = ImVec2(low.x + size.x, low.y + size.y)
    painter.push_clip_rect(low, high, True)
    _PATTERNS[overlay](painter, low, high)
    painter.pop_clip_rect()
    painter.add_rect(low, high, _colour(gray(0.5)), thickness=1.0)


def _stripes(painter: Painter, low: ImVec2, high: ImVec2) -> None:
    painter.add_rect_filled(low, high, _colour(gray(0.0)))
    tall, white = high.y - low.y, _colour(gray(1.0))
    x = low.x - tall
    while x < high.x:
        painter.add_quad_filled(
            ImVec2(x, low.y),
            ImVec2(x + STRIPE_PX, low.y),
            ImVec2(x + STRIPE_PX + tall, high.y),
            ImVec2(x + tall, high.y),
            white,
        )
        x += 2.0 * STRIPE_PX


def _dots(painter: Painter, low: ImVec2, high: ImVec2) -> None:
    painter.add_rect_filled(low, high, _colour(gray(0.0)))
    white = _colour(gray(1.0))
    y = low.y + 1.0
    while y < high.y:
        x = low.x + 1.0
        while x < high.x:
            painter.add_rect_filled(ImVec2(x, y), ImVec2(x + DOT_PX, y + DOT_PX), white)
            x += DOT_STEP_PX
        y += DOT_STEP_PX


def _lines(painter: Painter, low: ImVec2, high: ImVec2) -> None:
    painter.add_rect_filled(low, high, _colour(gray(0.0)))
    white = _colour(gray(1.0))
    y = low.y + 1.0
    while y < high.y:
        painter.add_rect_filled(ImVec2(low.x, y), ImVec2(high.x, y + LINE_PX), white)
        y += LINE_STEP_PX


def _directions(painter: Painter, low: ImVec2, high: ImVec2) -> None:
    wide = (high.x - low.x) / len(NORMALS)
    for k, (red, green, blue) in enumerate((0.5 + 0.5 * NORMALS).tolist()):
        left = low.x + k * wide
        colour = _colour(ImVec4(red, green, blue, 1.0))
        painter.add_rect_filled(ImVec2(left, low.y), ImVec2(left + wide, high.y), colour)


_PATTERNS: dict[str, Callable[[Painter, ImVec2, ImVec2], None]] = {
    "clipped": _stripes,
    "out of gamut": _dots,
    "cut by this display": _lines,
    "normals": _directions,
}


def _colour(colour: ImVec4) -> int:
    return int(imgui.color_convert_float4_to_u32(colour))
