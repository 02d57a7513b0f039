"""The program of the window in which people answer: one Flow, its phases, its two pictures."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

from imgui_bundle import imgui

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.study import GRAIN, QUESTIONS
from relgloss_view.experiment.session.flow import Flow, Phase
from relgloss_view.experiment.session.records import Observer
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.drawing.arrangement import Arrangement
from relgloss_view.viewer.drawing.canvas import Canvas, surround_gray
from relgloss_view.viewer.shell.window import Window
from relgloss_view.viewer.trials import keys, letters, pages, placement
from relgloss_view.viewer.trials.category_strip import CategoryStrip
from relgloss_view.viewer.trials.device import Profile, screen_of, stay_open
from relgloss_view.viewer.trials.experimenter_line import ExperimenterLine, Tell, continues
from relgloss_view.viewer.trials.ink import Ink
from relgloss_view.viewer.trials.pair import Pair
from relgloss_view.viewer.trials.sitting_here import SittingHere, sitting_here, system_display

#: Phases after which pictures come: they are drawn while these show.
_BEFORE_TRIALS = (Phase.INSTRUCTIONS, Phase.OBJECT, Phase.ADAPTATION, Phase.PAUSE, Phase.GAP)
_NO_POINTER = (Phase.ADAPTATION, Phase.GAP, Phase.TRIAL)

ANSWER_LOST = "This answer was NOT stored"
UNDO_LOST = "The last answer could NOT be taken back"
NEXT_UNKNOWN = "The last step is kept, but the next one can't be found"
NOT_KEPT = "The session can't be kept"
NO_PICTURE = "The next pictures can't be shown"


class Trials:
    """One observer before the screen. See window.Program for what is called when."""

    def __init__(
        self,
        store: Store,
        observer: Observer,
        profile: Profile | None = None,
        tell: Tell = lambda share, text: None,
        display: str | None = None,
        announce: Callable[[str], object] = lambda line: None,
    ) -> None:
        """tell: takes the experimenter's progress, as base.terminal's Progress does.

        profile: the monitor's, kept and not drawn for. display: a file of the display that pictures
        are drawn for. announce: takes lines about the display, for the terminal.
        """
        self.store, self.observer = store, observer
        self.flow: Flow | None = None  #: from the start on
        self.fault: pages.Page | None = None  #: what could not be done, until somebody goes back
        self._failed: dict[str, str] = {}  #: what could not be done and was not since, and why
        self._profile, self._tell = profile, tell
        self._display, self._announce = display, announce
        self._later: list[pages.Page] = []  #: for the experimenter, after the present fault
        self._here: SittingHere | None = None  #: from the start on
        study = store.study
        self._ink = Ink.on(study.setup.display)
        self._strip = CategoryStrip(study.screen.scale, time.perf_counter)
        self._digits: list[tuple[int, ...]] = []
        self._window: Window | None = None
        self._pair: Pair | None = None
        self._line: ExperimenterLine | None = None
        self._lost = False
        self._standing = False  #: whether the present frame shows the pictures
        self._keyed = False  #: whether the present frame's keys are for the page that shows
        self._note = ""  #: for the experimenter, on the first page
        self._halted = False  #: whether a page waits until somebody does something

    # --- the life of the window ---------------------------------------------------------------

    def start(self, ctx: Any, window: Window) -> None:
        """The context is there: the run begins. Raises InputError where it can't be kept."""
        io = imgui.get_io()
        io.config_flags &= ~int(imgui.ConfigFlags_.nav_enable_keyboard)  # keys are answers here
        stay_open(window)
        self._window = window
        of_system = (None, "") if self._profile is not None else system_display(window)
        here = sitting_here(self.store, self.observer, self._display, *of_system)
        self._here = here
        study = self.store.study.shown_on(here.sitting.display)
        window.surround = surround_gray(study.setup.display)
        self._ink = Ink.on(study.setup.display)
        run = self.store.begin_run(
            self.observer,
            str(ctx.info["GL_RENDERER"]),
            screen_of(window, self._profile),
            None if self._profile is None else self._profile.data,
            here.sitting,
        )
        self._pair = Pair(ctx, self.store, run, study)
        self._note = continues(self.store, self.observer)
        unreadable = letters.warnings(self.store.study)
        if here.remarks:
            self._later.append(pages.display_page(here.remarks))
        if unreadable:
            self._later.append(pages.letters_page(unreadable))
        self._next_page()
        self.flow = Flow(self.store, self.observer, run, time.perf_counter)
        self._digits = keys.digit_chords(len(self.store.study.categories))

    def frame(self) -> None:
        """Take what the hand did, then show the present phase."""
        flow, window, pair = self._there()
        if self._line is None:  # not before: while a window opens, the terminal is held back
            self._line = ExperimenterLine(flow, time.perf_counter, self._tell)
            self._announce_display()
        pair.restore(window.is_texture, lost=self._lost)
        self._lost = False
        size = window.size_now()
        arrangement = placement.arranged(self.store.study, size)
        if keys.pressed(keys.QUIT):
            window.close()
        meant = flow.phase, self.fault  # what showed as keys were pressed
        if self.fault is None and arrangement is not None:
            self._take_keys(flow)
            self._attempt(flow.tick, NOT_KEPT)
            if self.fault is None:
                self._attempt(self._line.follow, NOT_KEPT)
        # A page that comes in this frame leaves its keys: one press acts once.
        self._keyed = (flow.phase, self.fault) == meant
        window.canvas = Canvas([(0, 0, *size)])
        self._standing = False
        if self.fault is not None:
            self._act(pages.show(self.fault, self._ink, size, keyed=self._keyed))
        elif arrangement is None:
            flow.hidden()
            least = placement.needed(self.store.study, size)
            pages.show(pages.small_page(size, least), self._ink, size)
        else:
            self._show_phase(flow, size, arrangement)
        self._halted = self.fault is not None or arrangement is None
        if imgui.is_key_down(keys.EXPERIMENTER) and flow.phase is not Phase.CONSENT:
            self._show_line(size)
        window.to_screen()  # pictures may have been drawn

    def after_frame(self, frame_s: float) -> bool:
        """The frame is on the screen: times count from here; draw what comes next."""
        flow, window, pair = self._there()
        self._lost = not pair.finish_frame()
        if self._standing:
            flow.shown()
        if self.fault is not None or flow.phase not in _BEFORE_TRIALS or flow.trial is None:
            return self._lost
        self._prepare(flow, pair)
        window.to_screen()
        return self._lost or self.fault is not None

    def wait_s(self) -> float | None:
        """How long nothing changes by itself."""
        flow = self.flow
        if flow is None or self._halted:
            return None
        if flow.phase is Phase.GAP:
            return flow.left_s()
        if flow.phase is Phase.ADAPTATION:  # the countdown shows whole seconds
            left = flow.left_s()
            return left - math.ceil(left) + 1.0
        return self._strip.wait_s() if flow.phase is Phase.TRIAL else None

    def dropped(self, paths: list[str]) -> None:
        """Nothing is opened here."""

    def finish(self) -> None:
        """The context is about to go; what was answered is kept."""
        if self.flow is not None:
            self._attempt(self.flow.end, NOT_KEPT)
        if self._pair is not None:
            self._pair.release()

    @property
    def failed(self) -> str:
        """What could not be done last, with its reason; empty where all was done in the end."""
        return next(reversed(self._failed.values()), "")

    @property
    def progress(self) -> tuple[int, int]:
        """How many trials the observer has answered, and of how many."""
        line = self._line
        return (0, 0) if line is None else (line.answered, line.total)

    def _there(self) -> tuple[Flow, Window, Pair]:
        assert self.flow is not None
        assert self._window is not None
        assert self._pair is not None
        return self.flow, self._window, self._pair

    # --- what is done -------------------------------------------------------------------------

    def _take_keys(self, flow: Flow) -> None:
        """Keys of the phases without words; pages take theirs as they are shown."""
        if flow.phase in (Phase.GAP, Phase.TRIAL):
            if keys.pressed(keys.BACKSPACE):
                self._act(pages.UNDO)
            elif keys.pressed(keys.PAUSE):
                self._attempt(flow.pause, NOT_KEPT)
            elif flow.phase is Phase.TRIAL:
                self._answer(flow, self._digit())
        elif flow.phase is Phase.ADAPTATION and keys.pressed(keys.SKIP):
            self._attempt(flow.skip_adaptation, NOT_KEPT)

    def _digit(self) -> int | None:
        return next((k for k, chords in enumerate(self._digits) if keys.pressed(chords)), None)

    def _answer(self, flow: Flow, category: int | None) -> None:
        if category is None or not self._attempt(lambda: flow.answer(category), ANSWER_LOST):
            return
        self._failed.clear()
        self._standing = False  # what shows until the next frame belongs to this answer
        self._strip.hide()
        assert self._line is not None
        self._attempt(self._line.note_answer, NOT_KEPT)

    def _act(self, action: str | None) -> None:
        """Do what a page offers."""
        flow, window, _ = self._there()
        if action == pages.CONFIRM:
            self._attempt(flow.confirm, NOT_KEPT)
        elif action == pages.DECLINE:
            self._attempt(flow.decline, NOT_KEPT)
        elif action == pages.UNDO:
            self._attempt(flow.undo, UNDO_LOST)
        elif action == pages.CLOSE:
            window.close()
        elif action == pages.RETRY:
            self._next_page()
        if action is not None and action != pages.RETRY and self.fault is None:
            assert self._line is not None
            self._line.note_break()
            self._note = ""
            self._attempt(self._line.refresh, NOT_KEPT)

    def _next_page(self) -> None:
        """Show the next page for the experimenter; none where all were read."""
        self.fault = self._later.pop(0) if self._later else None

    def _announce_display(self) -> None:
        if self._here is not None:
            for line in (self._here.words, *self._here.remarks):
                self._announce(line)

    def _attempt(self, action: Callable[[], object], heading: str) -> bool:
        """Do something that has to be kept; returns whether it was done.

        Where it can't be kept, a page says so at once and the phase stays what it was.
        """
        assert self.flow is not None
        try:
            done = bool(action())
        except InputError as error:
            heading = NEXT_UNKNOWN if self.flow.behind else heading
            self.fault = pages.fault_page(heading, str(error))
            self._failed.pop(heading, None)
            self._failed[heading] = f"{heading}: {error}"
            self.flow.hidden()
            return False
        self._failed.pop(heading, None)
        if not self.flow.behind:
            self._failed.pop(NEXT_UNKNOWN, None)
        return done

    def _prepare(self, flow: Flow, pair: Pair) -> bool:
        """Have the pictures of the present trial ready; returns whether they are."""
        trial = flow.trial
        if trial is None:
            return False
        if not pair.ready(trial):
            self._attempt(lambda: pair.prepare(trial), NO_PICTURE)
        return pair.ready(trial)

    # --- what shows ---------------------------------------------------------------------------

    def _show_phase(self, flow: Flow, size: Size, arrangement: Arrangement) -> None:
        _, window, pair = self._there()
        if flow.phase in _NO_POINTER and self._strip.alpha == 0.0:
            imgui.set_mouse_cursor(imgui.MouseCursor_.none)
        if flow.phase is Phase.TRIAL:
            if self._prepare(flow, pair):
                window.canvas = pair.canvas(size, arrangement)
                self._standing = True
                self._show_below(flow, size, arrangement)
        elif flow.phase is Phase.ADAPTATION:
            left = math.ceil(flow.left_s())
            text_px = pages.text_px(size)
            below = placement.below_pictures(size, arrangement, question=True)
            top = size[1] - 3.0 * text_px if below.question is None else below.question
            pages.line(f"{left // 60}:{left % 60:02d}", self._ink.faint, text_px, size, top)
        elif flow.phase is Phase.INSTRUCTIONS and not (flow.study.guide.strip() or self._note):
            self._act(pages.CONFIRM)
        else:
            assert self._line is not None
            page = pages.page_of(flow, answered=self._line.answered > 0, note=self._note)
            if page is not None:
                self._act(pages.show(page, self._ink, size, keyed=self._keyed))

    def _show_below(self, flow: Flow, size: Size, arrangement: Arrangement) -> None:
        """The second question, and the categories for the mouse."""
        text_px = pages.text_px(size)
        # The strip does not move between the questions.
        below = placement.below_pictures(size, arrangement, question=GRAIN in flow.study.questions)
        if flow.question == GRAIN and below.question is not None:
            pages.line(QUESTIONS[GRAIN], self._ink.quiet, text_px, size, below.question)
        self._strip.look()
        if below.strip is not None:
            categories = flow.study.categories
            clicked = self._strip.show(categories, self._ink, size, below.strip, text_px)
            self._answer(flow, clicked)

    def _show_line(self, size: Size) -> None:
        assert self._line is not None
        text_px = 0.8 * pages.text_px(size)
        pages.line(self._line.text, self._ink.quiet, text_px, size, size[1] - 1.1 * text_px)
