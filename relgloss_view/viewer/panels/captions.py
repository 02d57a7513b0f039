"""Captions of the pictures: sample, quality of the fit, setting, drawing; and the legends."""

from __future__ import annotations

import numpy as np
from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.pack.pack import Pack
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.view import View
from relgloss_view.picture.pair import ratio_words
from relgloss_view.viewer.drawing.arrangement import Arrangement
from relgloss_view.viewer.panels import overlay_legend
from relgloss_view.viewer.panels.drawing_words import drawing_words
from relgloss_view.viewer.panels.list_rows import fitting
from relgloss_view.viewer.shell.theme import coloured, em, gray
from relgloss_view.viewer.state.matching import share_of_match
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.screens import name_of_other
from relgloss_view.viewer.state.state import DIFFERENCE, WIPE

#: A line in one wording or several, the longest first.
Line = tuple[str, ...]

LONGEST_NAME = 120  #: characters
LEAST_NAME_EM = 5.0  #: of a name, before the quality of the fit gives way
#: Heights of pictures that hold the numbers alone, and title and numbers.
NUMBERS_EM, TITLE_EM = 4.0, 7.0
LONGEST_FAULT = 300  #: characters
LEGEND_EM = (14.0, 0.8)
LEGEND_STEPS = 50
DARK_INK, LIGHT_INK = 0.0072, 0.5225  #: light relative to white; sRGB 0.08 and 0.75


def show(
    model: Model,
    painter: imgui.ImDrawList,
    origin: ImVec2,
    arrangement: Arrangement,
    faults: dict[str, str],
) -> None:
    """Write over the surround of each picture; what would not fit is left out."""
    presentation = model.state.presentation
    for side, rect in arrangement.rects.items():
        ink, paper = ink_on(model.display_of(side)), paper_on(model.display_of(side))
        left, top, width, height = rect
        right = presentation.compare == WIPE and (side == "test") != presentation.mirror
        if height < em(NUMBERS_EM):
            continue
        room = width * (0.5 if presentation.compare == WIPE else 1.0) - em(1)
        texts = _texts(model, side, faults, room, _room_above(model, side, height))
        for k, text in enumerate(texts[0 if height >= em(TITLE_EM) else 1 :]):
            x = origin.x + left + em(0.6)
            if right:
                x = origin.x + left + width - em(0.6) - imgui.calc_text_size(text).x
            place = ImVec2(x, origin.y + top + em(0.4) + k * imgui.get_text_line_height())
            size = imgui.calc_text_size(text)
            painter.add_rect_filled(place, ImVec2(place.x + size.x, place.y + size.y), paper)
            painter.add_text(place, ink, text)
    corner = ImVec2(origin.x + em(0.6), origin.y + max(r[3] for r in arrangement.rects.values()))
    ink = ink_on(model.on_screen.setup.display)
    if presentation.compare == DIFFERENCE:
        _legend(painter, corner, ink, ("0", f"{presentation.difference_max:g} dE2000"))
    elif presentation.overlay != "none":
        _name_overlay(model, painter, origin, arrangement)


def _name_overlay(
    model: Model,
    painter: imgui.ImDrawList,
    origin: ImVec2,
    arrangement: Arrangement,
) -> None:
    """The overlay's legend in the lower left corner of each picture; once where they overlap."""
    overlay = model.state.presentation.overlay
    places = {rect: side for side, rect in arrangement.rects.items()}
    apart = len(places) == len(arrangement.rects)
    for (left, top, width, height), side in places.items():
        corner = ImVec2(origin.x + left + em(0.6), origin.y + top + height)
        frame = model.frames.get(side) if apart and side not in model.operator_pictures else None
        display = model.display_of(side)
        colours = ink_on(display), paper_on(display)
        overlay_legend.show(painter, corner, width - em(1.2), colours, display, overlay, frame)


def _texts(model: Model, side: str, faults: dict[str, str], room: float, free: int) -> list[str]:
    """Lines no wider than `room` pixels: a title, the numbers, and what else `free` lines hold.

    Of the title the name is shortened first. Numbers are broken into lines and never left out.
    """
    state = model.state
    if model.awaited(side):
        text = f"{side.capitalize()}: {printable(model.awaited(side), LONGEST_NAME)} is being read"
        return [fitting(text, room)]
    if side in faults:
        return [f"{side.capitalize()}: not drawn", *_broken(faults[side], room)]
    if state.presentation.compare == DIFFERENCE:
        text = "Colour difference of the displayed pictures, test against reference"
        return _broken(f"{text}; tone mapping: split" if model.operator_pictures else text, room)
    texts = [_title(model, side, room)]
    frame = model.frames.get(side)
    if frame is None:
        return texts
    numbers = _setting(model, side, frame)
    one_line = _fitting(numbers, room)
    texts += [one_line] if one_line else _broken(numbers[-1], room)
    more: list[Line] = []
    if seen_on := state.presentation.seen_on(side):
        name = name_of_other(seen_on)
        more.append((f"As {name} shows it", f"As {name[:24]} shows it", "As another shows it"))
    words = ratio_words(frame.scaling.factor)
    if words:
        more.append((words, words.partition(":")[0]))
    words = drawing_words(frame.method)
    brief = words.partition(":")[0]
    more.append(tuple(f"{text} ({frame.look.quality})" for text in (words, brief)))
    fitting_lines = [text for line in more if (text := _fitting(line, room))]
    return [*texts, *fitting_lines[: max(free - len(texts), 0)]]


def _title(model: Model, side: str, room: float) -> str:
    """Side, what the material rests on, and name: the name shortened, then the quality left out."""
    pack = model.pack(side)
    if pack is not None:
        return _pack_title(side, pack, room)
    material = model.state.side(side).sample.material
    quality = material.evidence_words
    if material.synthetic:
        quality = f"synthetic, {quality}"
    if material.hypothetical:
        quality = f"hypothetical, {quality}"
    name = printable(material.name, LONGEST_NAME)
    for head in (f"{side.capitalize()} ({quality}): ", f"{side.capitalize()}: "):
        left = room - imgui.calc_text_size(head).x
        if left >= min(em(LEAST_NAME_EM), imgui.calc_text_size(name).x):
            return head + fitting(name, left)
    return side.capitalize()


def _pack_title(side: str, pack: Pack, room: float) -> str:
    """Side, which finishes were not measured, and the pack's name."""
    synthetic = [one.name for one in pack.finishes if one.material.synthetic]
    heads = [f"{side.capitalize()} (pack): ", f"{side.capitalize()}: "]
    if len(synthetic) == len(pack.finishes):
        heads.insert(0, f"{side.capitalize()} (pack, synthetic finishes): ")
    elif synthetic:
        names = printable(", ".join(synthetic), LONGEST_NAME)
        heads.insert(0, f"{side.capitalize()} (pack, synthetic: {names}): ")
        heads.insert(1, f"{side.capitalize()} (pack, in part synthetic): ")
    name = printable(pack.name, LONGEST_NAME)
    for head in heads:
        left = room - imgui.calc_text_size(head).x
        if left >= min(em(LEAST_NAME_EM), imgui.calc_text_size(name).x):
            return head + fitting(name, left)
    return side.capitalize()


def _setting(model: Model, side: str, frame: Frame) -> Line:
    """Graininess, of a pack that of the active finish; contrast gloss, or the tone mapping."""
    finish = model.active_finish(side)
    own = None if finish is None else finish.sigma_n_deg
    sigma_n = f"{frame.look.sigma_n_deg if own is None else own:.2f}°"
    picture = model.operator_pictures.get(side)
    if picture is not None:
        name = model.state.presentation.operator(side)
        mapping = name if picture.displayed else f"split, as {name} {picture.reason}"
        return (
            f"Graininess (sigma_N) {sigma_n}, tone mapping: {mapping}",
            f"sigma_N {sigma_n}, tone mapping: {mapping}",
        )
    c = f"{frame.c:.3g}"
    share = share_of_match(model.state, side)
    if share is None:
        matched = ""
    else:
        matched = ", matched" if abs(share - 1.0) < 5e-4 else f", {share:.2f} of the match"
    seen = ", no highlight" if frame.c_max is None else ""
    if finish is not None:
        name, k = printable(finish.name, LONGEST_NAME), f"{finish.k:.3g}"
        return (
            f"{name}: graininess (sigma_N) {sigma_n}, gloss factor (k) {k}; contrast gloss (c) {c}"
            f"{matched}{seen}",
            f"{name}: sigma_N {sigma_n}, k {k}; c {c}{matched}{seen}",
            f"sigma_N {sigma_n}, k {k}, c {c}",
        )
    return (
        f"Graininess (sigma_N) {sigma_n}, contrast gloss (c) {c}{matched}{seen}",
        f"sigma_N {sigma_n}, c {c}{matched}{seen}",
        f"sigma_N {sigma_n}, c {c}",
    )


def _fitting(line: Line, width: float) -> str:
    """The longest wording that fits a width; empty where none does."""
    return next((text for text in line if imgui.calc_text_size(text).x <= width), "")


def _broken(text: str, width: float) -> list[str]:
    """A text in lines that fit a width; a word is never broken."""
    lines: list[str] = []
    for word in printable(text, LONGEST_FAULT).split():
        longer = f"{lines[-1]} {word}" if lines else word
        if lines and imgui.calc_text_size(longer).x <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def _room_above(model: Model, side: str, height: int) -> int:
    """How many lines there is room for above the object; one at least."""
    frame = model.frames.get(side)
    if frame is None:
        return 2
    top = View.of(frame.scene, frame.size).bounds[3]
    free = height * (1.0 - top / frame.size[1]) - em(0.4)
    return max(int(free / imgui.get_text_line_height()), 1)


def ink_on(display: Display) -> int:
    """A gray that can be read on the surround without catching the eye."""
    light = DARK_INK if display.background_lstar >= 45.0 else LIGHT_INK
    ink = tone.neutral_digital(light, DisplayModel.of(display))
    return int(imgui.color_convert_float4_to_u32(coloured(ink)))


def paper_on(display: Display) -> int:
    """The surround's gray, let through a little, so that words read over an object too."""
    model = DisplayModel.of(display)
    paper = tone.neutral_digital(model.background_light, model)
    return int(imgui.color_convert_float4_to_u32(coloured(paper, 0.85)))


def _legend(
    painter: imgui.ImDrawList,
    corner: ImVec2,
    ink: int,
    ends: tuple[str, str],
) -> None:
    """A bar from the lower left corner: its scale and the words at its ends."""
    width, height = (em(v) for v in LEGEND_EM)
    line = imgui.get_text_line_height()
    low = ImVec2(corner.x, corner.y - height - line - em(0.8))
    for k in range(LEGEND_STEPS):
        share = k / (LEGEND_STEPS - 1)
        colour = imgui.color_convert_float4_to_u32(_gray_of_lightness(100.0 * share))
        x = low.x + width * k / LEGEND_STEPS
        high = ImVec2(x + width / LEGEND_STEPS + 1.0, low.y + height)
        painter.add_rect_filled(ImVec2(x, low.y), high, colour)
    below = low.y + height + em(0.1)
    painter.add_text(ImVec2(low.x, below), ink, ends[0])
    right = low.x + width - imgui.calc_text_size(ends[1]).x
    painter.add_text(ImVec2(right, below), ink, ends[1])


def _gray_of_lightness(lightness: float) -> imgui.ImVec4:
    light = tone.lab_f_inverse(np.array((lightness + 16.0) / 116.0))
    return gray(float(tone.srgb_encode(light)))
