"""Model: what the panels read and change. No OpenGL, no window library."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from relgloss_view.base.arrays import Array, Bytes
from relgloss_view.base.decoration import fault_line
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.measure.table import Measurement
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.quality.backends import FrameRenderer
from relgloss_view.viewer.plots.lightness import Lightness
from relgloss_view.viewer.state import matching, packs
from relgloss_view.viewer.state.history import History
from relgloss_view.viewer.state.proofs import OpenProof
from relgloss_view.viewer.state.screens import Screen, for_screen, unreadable_files
from relgloss_view.viewer.state.state import State

LONGEST_NOTE = 400  #: characters
NOTES_KEPT = 50
HOLD_S = 0.4  #: between turns of the wheel that belong together


@dataclass(frozen=True)
class OperatorPicture:
    """A side's picture by an operator, or the reason why the split's shows in its place."""

    displayed: Displayed | None
    reason: str = ""


@dataclass(frozen=True)
class GhostPicture:
    """A small picture of a material that the readings of a new one allow, beside the likeliest.

    texture: its name on the device. object_box: the part of it (left, bottom, right, top) that can
    show the object, in shares of its size from the lower left. lightness: to plot it.
    edge: of its highlight (plots.outline).
    """

    texture: int
    size: Size
    object_box: tuple[float, float, float, float]
    lightness: Lightness
    edge: Array


class DrawnPass(NamedTuple):
    """A pass of the renderer that was drawn for a side."""

    side: str
    name: str


class Pixel(NamedTuple):
    """A pixel of a side's picture: column from the left, row from the top."""

    side: str
    column: int
    row: int


@dataclass(frozen=True)
class Note:
    """A message of the status line."""

    text: str
    fault: bool = False
    at_s: float = field(default_factory=time.monotonic)


class Model:
    """The state with its history, the pictures last drawn, and the messages.

    Panels change the state with `change`; the next frame draws what that asks for.
    """

    def __init__(self, state: State) -> None:
        self.history = History(state)
        #: The pictures as last drawn, by side; empty before the first.
        self.frames: dict[str, Frame] = {}
        #: Those by operators other than the split, by side; none for a side of the split.
        self.operator_pictures: dict[str, OperatorPicture] = {}
        #: The dullest and the glossiest material of a side whose material is being estimated.
        self.ghosts: dict[str, GhostPicture] = {}
        self.ghost_side = "test"
        self.ghost_outlines = True  #: whether the large picture has their outlines
        self.notes: list[Note] = []
        #: Tables read in this window, by file, so that plots can show their points.
        self.measurements: dict[str, Measurement] = {}
        self.active_side = "test"  #: the one that panels show where they show one
        self.dragging = False  #: whether the hand holds something that changes pictures
        self.pointer: Pixel | None = None  #: under the mouse
        self.pinned: Pixel | None = None

        #: The finish of each side's pack that sliders change, by side; see active_finish.
        self.finish_names: dict[str, str] = {}
        self.moving_artwork = False  #: whether the hand in a picture moves the artwork of a pack
        self.masked: frozenset[str] = frozenset()  #: names of finishes whose masks show
        self.tints: dict[str, int] = {}  #: textures of the masks that show, by side
        #: Packs of the last session that are still read: name, sample in its place, by side.
        self.coming: dict[str, tuple[str, Sample]] = {}
        self.proof: OpenProof | None = None  #: the one that was opened last
        self.proof_message = -1  #: index of its message that was shown last
        #: Draws any scene on the window's device; None without a window.
        self.renderer: FrameRenderer | None = None
        #: Textures of plates without a finish, and width over height, by name.
        self.plate_pictures: dict[str, tuple[int, float]] = {}
        self.wanted_panel = ""  #: title of one that the next frame brings to the front

        #: Of the last frame.
        self.frame_s = 0.0
        self.redrawn: list[DrawnPass] = []  #: when there last were any
        self.draft = False  #: whether pictures are drawn smaller, while something is dragged
        self.picture_size: Size = (1, 1)
        #: Takes the pane's pixels, (H, W, 3), without what the interface writes on them; asked for
        #: once, answered by the next full frame.
        self.take_view: Callable[[Bytes], None] | None = None
        self.factor = 1.0  #: of both c in this view, so that neither picture clips
        self.gap_px = 0  #: between the pictures on the screen
        self.pixel_pitch_m: float | None = None  #: of the monitor; None where it reports none
        self.screen = Screen()  #: what the system has for the monitor
        self._on_screen: tuple[State, Screen, State] | None = None
        self._unreadable: dict[str, str] = {}  #: files of displays
        #: Draws a side's picture at another size, in pixels; may raise RelglossError.
        self.render_at: Callable[[str, Size], Frame] | None = None
        self._held_until_s = 0.0

    @property
    def state(self) -> State:
        """The present state."""
        return self.history.state

    @property
    def on_screen(self) -> State:
        """The present state as the window draws it: for its monitor, unless it is to be another.

        The same object as long as neither changes.
        """
        kept = self._on_screen
        if kept is None or kept[0] is not self.state or kept[1] is not self.screen:
            shown = for_screen(self.state, self.screen, self._unreadable)
            kept = self.state, self.screen, shown
            self._on_screen = kept
        return kept[2]

    def check_displays(self) -> None:
        """Look at the files of displays, once a frame: one that is damaged is drawn without."""
        faults = unreadable_files(self.state)
        for file in faults.keys() - self._unreadable.keys():
            self.report(f"{faults[file]} (pictures are drawn without it)", fault=True)
        if faults.keys() != self._unreadable.keys():
            self._on_screen = None
        self._unreadable = faults

    def display_of(self, side: str) -> Display:
        """The display that a side is drawn for, with the one that it is seen on."""
        display = self.on_screen.setup.display
        seen_on = self.on_screen.presentation.seen_on(side)
        return dataclasses.replace(display, seen_on=seen_on) if seen_on else display

    def hold(self) -> None:
        """Let a gesture without a held button, such as turns of the wheel, last for a moment."""
        self._held_until_s = time.monotonic() + HOLD_S

    def displayed(self, side: str) -> Displayed | None:
        """A side's picture by its operator as last drawn; None where the split's shows."""
        picture = self.operator_pictures.get(side)
        return None if picture is None else picture.displayed

    @property
    def held(self) -> bool:
        """Whether such a gesture lasts."""
        return time.monotonic() < self._held_until_s

    def change(self, state: State, gesture: object = None) -> None:
        """Make a state the present one; see History.change."""
        self.history.change(state, gesture)

    def set_part(self, part: str, gesture: object = None, **changes: Any) -> None:
        """Change entries of shape, lamp, eye, display or presentation."""
        self.change(self.state.with_part(part, **changes), gesture)

    def set_look(self, side: str, gesture: object = None, **changes: Any) -> None:
        """Change entries of a side's look."""
        self.change(self.state.with_look(side, **changes), gesture)

    def set_sigma_n(self, side: str, sigma_n_deg: float, gesture: object = None) -> None:
        """Change the graininess of a side; its share of the matched gloss stays."""
        self.change(matching.with_sigma_n(self.state, side, sigma_n_deg), gesture)

    def set_c(self, side: str, c: float, gesture: object = None) -> None:
        """Change c of a side alone."""
        sigma_n_deg = self.state.side(side).look.sigma_n_deg
        self.change(self.state.with_setting(side, Setting(sigma_n_deg, c=c)), gesture)

    def set_share(self, side: str, share: float, gesture: object = None) -> None:
        """Change the contrast gloss of a side in units of the match."""
        self.change(matching.with_share(self.state, side, share), gesture)

    def pack(self, side: str) -> Pack | None:
        """The pack of a side; None where it shows a sample."""
        return packs.pack_of(self.state, side)

    def awaited(self, side: str) -> str:
        """The name of a pack that is still read for a side; empty where none is."""
        name, stand_in = self.coming.get(side, ("", None))
        return name if self.state.side(side).sample is stand_in else ""

    def active_finish(self, side: str) -> Finish | None:
        """The finish of a side's pack that sliders change; None without a pack."""
        pack = self.pack(side)
        return None if pack is None else packs.active(pack, self.finish_names.get(side, ""))

    def sample(self, side: str) -> Sample:
        """The sample of a side; of a pack, that of the active finish."""
        finish = self.active_finish(side)
        return self.state.side(side).sample if finish is None else packs.sample_of(finish)

    def with_sample(self, side: str, sample: Sample) -> State:
        """The state with another sample on a side, its look kept, or as the active finish's."""
        finish = self.active_finish(side)
        if finish is None:
            return matching.with_sample(self.state, side, sample, keep=True)
        return matching.with_finish_sample(self.state, side, finish.name, sample)

    def choose_finish(self, side: str, name: str) -> None:
        """Make a finish the active one of its side."""
        self.finish_names[side] = name

    def set_pack(self, side: str, pack: Pack, gesture: object = None) -> None:
        """Put another value of a side's pack in its place; its look and the match stay."""
        self.change(packs.with_pack(self.state, side, pack), gesture)

    def set_finish(self, side: str, name: str, gesture: object = None, **entries: Any) -> None:
        """Change entries of a finish; a value that it can't have is reported."""

        def change() -> None:
            self.change(packs.with_finish(self.state, side, name, **entries), gesture)

        self.attempt(change)

    def place_artwork(self, side: str, placement: Placement, gesture: object = None) -> None:
        """Lay the artwork of a side's pack elsewhere."""
        pack = self.pack(side)
        if pack is not None:
            self.set_pack(side, dataclasses.replace(pack, placement=placement), gesture)

    def set_setting(self, side: str, setting: Setting) -> None:
        """Give a side a published setting; a share is of c_max at the paper's geometry."""
        self.change(self._of_finish(matching.with_setting(self.state, side, setting), side))

    def set_whole_look(self, side: str, look: Look) -> None:
        """Give a side all of another look; of a pack, its graininess goes to the active finish."""
        self.change(self._of_finish(self.state.with_look(side, **vars(look)), side))

    def _of_finish(self, state: State, side: str) -> State:
        """The state whose active finish has the graininess of its side's look."""
        finish = self.active_finish(side)
        if finish is None:
            return state
        sigma_n_deg = state.side(side).look.sigma_n_deg
        return packs.with_finish(state, side, finish.name, sigma_n_deg=sigma_n_deg)

    def set_sample(self, side: str, sample: Sample) -> None:
        """Put another sample on a side, matched to the reference."""
        self.change(matching.with_sample(self.state, side, sample))

    def show_message(self, index: int) -> None:
        """Show the settings of a message of the open proof, with its scene, as one step of undo."""
        if self.proof is not None:
            self.proof_message = index
            shown = dataclasses.replace(self.proof.at(index), presentation=self.state.presentation)
            self.change(shown)

    def turn_lamp(self) -> None:
        """Turn the lamp to the highlight, as one step of undo; report where none does."""
        turned = self.state.lit_for_gloss()
        if turned == self.state:
            text = "the highlight lies well on the object, or no lamp at this distance makes one"
            self.report(text)
        self.change(turned)

    def report(self, text: str, *, fault: bool = False) -> None:
        """Show a line in the status line and keep it in the list of messages."""
        self.notes.append(Note(printable(text, LONGEST_NOTE), fault))
        del self.notes[:-NOTES_KEPT]

    def report_once(self, text: str, *, fault: bool = False) -> None:
        """Report a line, unless it was the last one."""
        if not self.notes or self.notes[-1].text != printable(text, LONGEST_NOTE):
            self.report(text, fault=fault)

    def attempt(self, action: Callable[[], object]) -> bool:
        """Do something that may fail; reports a failure, a mistake of the program too."""
        try:
            action()
        except RelglossError as error:
            self.report(str(error), fault=True)
            return False
        except Exception as error:  # the work in the window is worth more than an end by traceback
            self.report(fault_line(error), fault=True)
            return False
        return True
