"""Writing the pictures of the window to files, with the commands that draw them again. No ImGui."""

from __future__ import annotations

import dataclasses
import json
import os
from dataclasses import dataclass

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.writing import check_writable, together
from relgloss_view.operators.registry import DEFAULT_OPERATOR, make_operator
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.png import SOFTWARE, save_pair, save_rgb
from relgloss_view.viewer.drawing.arrangement import as_shown
from relgloss_view.viewer.state.command_line import snapshot_command
from relgloss_view.viewer.state.matching import as_displayed
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

BOTH = "both"
PICTURES = (*SIDES, BOTH)
PNG8, PNG16, EXR = "PNG, 8 bits", "PNG, 16 bits", "OpenEXR"
FORMATS = (PNG8, PNG16, EXR)


@dataclass(frozen=True)
class ExportRequest:
    """An export: one of PICTURES in one of FORMATS, and its file.

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


def obstacle(model: Model, request: ExportRequest) -> str:
    """The reason why the pictures on the screen can't be written yet; empty where they can.

    It passes by itself: a smaller picture is drawn while something is dragged, or a change has not
    been drawn yet.
    """
    if request.size is not None or drawn_again(model):
        return ""
    if model.draft or model.dragging:
        return "waiting for the full picture"
    for side in request.sides:
        frame = model.frames.get(side)
        if frame is not None and not _is_current(model, side, frame):
            return "waiting for the picture to be drawn"
    return ""


def drawn_again(model: Model) -> bool:
    """Whether files need pictures of their own: they are for the scene's display, not a monitor."""
    return model.on_screen is not model.state


def write(model: Model, request: ExportRequest) -> str:
    """Write the files; returns a message. RelglossError where one can't be written.

    Each file appears whole or not at all.
    """
    for file in request.files:
        check_writable(file)
    if request.size is None and drawn_again(model):
        request = dataclasses.replace(request, size=model.picture_size)
    frames = {side: _frame(model, side, request.size) for side in request.sides}
    displayed = {side: _displayed(model, side, frame, request) for side, frame in frames.items()}
    commands, missing = _commands(model, request, frames)
    if request.picture == BOTH and request.format != EXR:
        presentation = model.state.presentation
        save_pair(
            (frames["reference"], frames["test"]),
            request.path,
            (commands["reference"], commands["test"]),
            gap_px=model.gap_px,
            mirrored=presentation.mirror,
            bits=request.bits,
            displayed=(displayed["reference"], displayed["test"]),
        )
    else:
        with together():
            for side, file in zip(request.sides, request.files, strict=True):
                save_frame(
                    frames[side], file, commands[side], bits=request.bits, displayed=displayed[side]
                )
    text = f"exported {' and '.join(request.files)}"
    return f"{text}; without a command: {missing}" if missing else text


def write_view(model: Model, path: str, pixels: Bytes) -> None:
    """Write what the pane shows, (H, W, 3), with the profile of the screen that it is drawn for."""
    text = {"Software": SOFTWARE, "Presentation": json.dumps(vars(model.state.presentation))}
    display = model.on_screen.setup.display
    if model.attempt(lambda: save_rgb(pixels, path, text, display=display)):
        height, width = pixels.shape[:2]
        folder, name = os.path.split(os.path.abspath(path))
        model.report(f"exported {name}, {width} x {height} px, to {folder}")


def _frame(model: Model, side: str, size: Size | None) -> Frame:
    """The picture on the screen, or one that is drawn for this."""
    frame = model.frames.get(side) if size is None else None
    if frame is not None:
        return frame
    if model.render_at is None:
        raise InputError(f"the {side} picture is not on the screen; show both, side by side")
    return model.render_at(side, size or model.picture_size)


def _displayed(model: Model, side: str, frame: Frame, request: ExportRequest) -> Displayed | None:
    """A frame's picture by the side's operator; None for the split.

    The one on the screen holds no light, which a PNG of 8 bits does without.
    """
    name = model.state.presentation.operator(side)
    if name == DEFAULT_OPERATOR:
        return None
    present = model.displayed(side) if request.size is None else None
    if present is not None and present.operator == name and request.format == PNG8:
        return present
    operator = make_operator(name)
    made = operator.draw_digital(frame) if request.format == PNG8 else operator.draw(frame)
    frame.forget()  # what it was made from; what a file needs is fetched again
    return made


def _is_current(model: Model, side: str, frame: Frame) -> bool:
    """Whether a picture is the state's, at the size of the screen."""
    state = as_shown(model.state, model.picture_size, model.pixel_pitch_m)
    look = state.side(side).look
    return (
        frame.size == model.picture_size
        and frame.look == look
        and frame.scene == as_drawn(state.scene(side), look)
    )


def _commands(
    model: Model, request: ExportRequest, frames: dict[str, Frame]
) -> tuple[dict[str, str], str]:
    """The command of each side's picture, and why there is none, where there is none."""
    commands, missing = {}, ""
    for side, frame in frames.items():
        # The eye as it was drawn with: life size and another size change it.
        state = model.state.placed(eye=frame.scene.eye)
        state = as_displayed(state, frame.scaling.factor)
        name = os.path.basename(request.path)
        name = _named(name, side) if request.picture == BOTH else name
        try:
            commands[side] = snapshot_command(state, side, frame.size, name)
        except RelglossError as error:
            commands[side], missing = "", str(error)
            continue
        if request.bits == 16:
            commands[side] += " --bits 16"
    return commands, missing


def _named(path: str, side: str) -> str:
    stem, suffix = os.path.splitext(path)
    return f"{stem}-{side}{suffix}"
