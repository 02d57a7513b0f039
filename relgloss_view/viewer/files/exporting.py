"""Writing the pictures of the window to files, with the commands that draw them again. No ImGui."""

from __future__ import annotations

import os
from dataclasses import dataclass

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.writing import check_writable
from relgloss_view.operators.registry import DEFAULT_OPERATOR, make_operator
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.png import save_pair
from relgloss_view.viewer.drawing.arrangement import as_shown
from relgloss_view.viewer.state.command_line import snapshot_command
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

BOTH = "both"
PICTURES = (*SIDES, BOTH)
PNG8, PNG16, EXR = "PNG, 8 bits", "PNG, 16 bits", "OpenEXR"
FORMATS = (PNG8, PNG16, EXR)


@dataclass(frozen=True)
class Order:
    """What to write: one of PICTURES in one of FORMATS, and where to.

    size: in pixels of one picture; None as on the screen.
    """

    picture: str
    format: str
    path: str
    size: Size | None = None

    @property
    def sides(self) -> tuple[str, ...]:
        """The sides whose pictures are written."""
        return SIDES if self.picture == BOTH else (self.picture,)

    @property
    def files(self) -> tuple[str, ...]:
        """The files that are written: OpenEXR takes one for each picture."""
        if self.picture == BOTH and self.format == EXR:
            return tuple(_named(self.path, side) for side in SIDES)
        return (self.path,)

    @property
    def bits(self) -> int:
        """Of a channel of a PNG."""
        return 16 if self.format == PNG16 else 8


def suffix_of(format_: str) -> str:
    """The ending of a format's files."""
    return ".exr" if format_ == EXR else ".png"


def obstacle(model: Model, order: Order) -> str:
    """Why the pictures on the screen can't be written for now; empty where they can.

    It passes by itself: a smaller picture is drawn while something is dragged, or a change has not
    been drawn yet.
    """
    if order.size is not None:
        return ""
    if model.draft or model.dragging:
        return "waiting for the full picture"
    for side in order.sides:
        frame = model.frames.get(side)
        if frame is not None and not _is_current(model, side, frame):
            return "waiting for the picture to be drawn"
    return ""


def write(model: Model, order: Order) -> str:
    """Write the files; returns what there is to say. RelglossError where one can't be written.

    Each file appears whole or not at all.
    """
    for file in order.files:
        check_writable(file)
    frames = {side: _frame(model, side, order.size) for side in order.sides}
    shown = {side: _displayed(model, side, frame, order.size) for side, frame in frames.items()}
    commands, missing = _commands(model, order, frames)
    if order.picture == BOTH and order.format != EXR:
        presentation = model.state.presentation
        save_pair(
            (frames["reference"], frames["test"]),
            order.path,
            (commands["reference"], commands["test"]),
            gap_px=model.gap_px,
            mirrored=presentation.mirror,
            bits=order.bits,
            displayed=(shown["reference"], shown["test"]),
        )
    else:
        for side, file in zip(order.sides, order.files, strict=True):
            save_frame(frames[side], file, commands[side], bits=order.bits, displayed=shown[side])
    told = f"exported {' and '.join(order.files)}"
    return f"{told}; without a command: {missing}" if missing else told


def _frame(model: Model, side: str, size: Size | None) -> Frame:
    """The picture on the screen, or one that is drawn for this."""
    frame = model.frames.get(side) if size is None else None
    if frame is not None:
        return frame
    if model.render_at is None:
        raise InputError(f"the {side} picture is not on the screen; show both, side by side")
    return model.render_at(side, size or model.picture_size)


def _displayed(model: Model, side: str, frame: Frame, size: Size | None) -> Displayed | None:
    """What the side's operator shows of a frame; None for the split."""
    name = model.state.presentation.operator(side)
    if name == DEFAULT_OPERATOR:
        return None
    there = model.displayed(side) if size is None else None
    if there is not None and there.operator == name:
        return there
    return make_operator(name).draw(frame)


def _is_current(model: Model, side: str, frame: Frame) -> bool:
    """Whether a picture is what the state asks for, at the size that the screen has."""
    state = as_shown(model.state, model.picture_size, model.pixel_pitch_m)
    look = state.side(side).look
    return (
        frame.size == model.picture_size
        and frame.look == look
        and frame.scene == as_drawn(state.scene(side), look)
    )


def _commands(model: Model, order: Order, frames: dict[str, Frame]) -> tuple[dict[str, str], str]:
    """The command of each side's picture, and why there is none, where there is none."""
    commands, missing = {}, ""
    for side, frame in frames.items():
        # The eye as it was drawn with: life size and another size change it.
        state = model.state.placed(eye=frame.scene.eye)
        name = os.path.basename(order.path)
        name = _named(name, side) if order.picture == BOTH else name
        try:
            commands[side] = snapshot_command(state, side, frame.size, name)
        except RelglossError as error:
            commands[side], missing = "", str(error)
            continue
        if order.bits == 16:
            commands[side] += " --bits 16"
    return commands, missing


def _named(path: str, side: str) -> str:
    stem, suffix = os.path.splitext(path)
    return f"{stem}-{side}{suffix}"
