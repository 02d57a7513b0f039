"""The program of the window: state, panels and pictures brought together, frame by frame."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from imgui_bundle import imgui

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.writing import make_folder
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.drawing.arrangement import arranged, as_shown
from relgloss_view.viewer.drawing.canvas import surround_gray
from relgloss_view.viewer.drawing.draft_scale import DraftScale
from relgloss_view.viewer.drawing.ghost_pictures import GhostPictures
from relgloss_view.viewer.drawing.mask_tints import MaskTints
from relgloss_view.viewer.drawing.operator_pictures import OperatorPictures
from relgloss_view.viewer.drawing.pair_renderer import DrawnPair, PairRenderer, passes_since
from relgloss_view.viewer.drawing.plate_pictures import PlatePictures
from relgloss_view.viewer.files.measurement_tables import MeasurementTables
from relgloss_view.viewer.files.monitor_profile import MonitorProfile, watched_monitor
from relgloss_view.viewer.panels import (
    catalogue,
    fit,
    gloss,
    help,
    lightness,
    look,
    menu,
    pack,
    pixel,
    proof,
    reflection,
    sample,
    scene,
    stage,
    status,
)
from relgloss_view.viewer.plots.gloss_readings import GlossReadings
from relgloss_view.viewer.shell import actions, navigation
from relgloss_view.viewer.shell.file_actions import FileActions
from relgloss_view.viewer.shell.hold import Hold
from relgloss_view.viewer.shell.layout import (
    BELOW,
    BELOW_RIGHT,
    GLOSS,
    LIGHT,
    SAMPLE,
    Layout,
    Panel,
)
from relgloss_view.viewer.shell.letters import Letters
from relgloss_view.viewer.shell.navigation import AltKey
from relgloss_view.viewer.shell.window import Window
from relgloss_view.viewer.state import matching
from relgloss_view.viewer.state.layout_file import WindowLayout, save_layout
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES, State

#: Time of the interface after the pictures, on a software driver and a large window.
INTERFACE_S = 0.008
LAYOUT_S = 1.0  #: between checks for changes of the layout


class App:
    """One window with its model. See window.Program for what is called when."""

    def __init__(self, state: State) -> None:
        self.model: Model = Model(state)
        self.files: FileActions = FileActions(self.model, self.wake)
        self._tables = MeasurementTables(self.model, self.wake)
        self._operator_pictures = OperatorPictures(self.wake)
        self._gloss_readings = GlossReadings(self.wake)
        self._ghost_pictures = GhostPictures()
        self._mask_tints = MaskTints(self.wake)
        self._plate_pictures = PlatePictures()
        self.draft_scale = DraftScale()
        self.layout: Layout = Layout(
            [
                Panel("Sample", SAMPLE, lambda: sample.show(self.model, self.files)),
                Panel("Pack", SAMPLE, lambda: pack.show(self.model, self.files), at_first=False),
                Panel("Proof", SAMPLE, lambda: proof.show(self.files.proofs), at_first=False),
                Panel("Look", GLOSS, lambda: look.show(self.model)),
                Panel("Gloss", GLOSS, lambda: gloss.show(self.model, self._gloss_readings)),
                Panel("Scene", LIGHT, lambda: scene.show(self.model, self.files)),
                Panel("Catalogue", BELOW, lambda: catalogue.show(self.files), at_first=False),
                Panel("Lightness", BELOW, lambda: lightness.show(self.model), at_first=False),
                Panel("Reflection", BELOW, lambda: reflection.show(self.model), at_first=False),
                Panel("Fit", BELOW, lambda: fit.show(self.model), at_first=False),
                Panel("Pixel", BELOW_RIGHT, lambda: pixel.show(self.model), at_first=False),
            ]
        )
        self.pair_renderer: PairRenderer | None = None
        self.flip_held = False  #: a key or a button shows the other picture
        self.drawn_pane: stage.DrawnPane | None = None  #: the pictures of the present frame
        self.stage_origin = (0.0, 0.0)  #: upper left corner of their pane, pixels of the screen
        self.kept_layout = WindowLayout()
        self._layout_path: Path | None = None
        self.alt_key = AltKey()
        self.menu_wanted = False  #: whether the keyboard opens the menu in this frame
        self.help_window = ""  #: title of the window of the menu Help that shows
        self._window: Window | None = None
        self._monitor: MonitorProfile | None = None  #: none without a display
        self._frame_began_s = 0.0
        self._lost = False
        self._letters = Letters(self.model)
        self._layout_kept_s = 0.0
        self.hold = Hold(self.model, self.draft_scale)

    # --- the life of the window ---------------------------------------------------------------

    def start(self, ctx: Any, window: Window) -> None:
        """The context is there."""
        self.pair_renderer = PairRenderer(ctx)
        self._window = window
        self.model.render_at = self._render_at
        self.model.renderer = self.pair_renderer
        self._monitor = watched_monitor(self.model, window, self.wake)
        navigation.enable()
        if self.kept_layout.docking:
            imgui.load_ini_settings_from_memory(self.kept_layout.docking)

    def frame(self) -> None:
        """Build the interface and draw the pictures."""
        assert self.pair_renderer is not None
        assert self._window is not None
        self._frame_began_s = time.perf_counter()
        if self.pair_renderer.lost(self._window.is_texture) or self._lost:
            self._lost = False
            self.rebuild()
        self._letters.report()
        actions.take_keys(self)
        self.files.each_frame()
        if self._monitor is not None:
            self._monitor.each_frame()
        self.model.check_displays()
        self._tables.each_frame()
        self._note_hand()
        presentation = self.model.state.presentation
        if presentation.haploscopic:
            imgui.set_nav_cursor_visible(False)
            self.layout.show_alone(self._show_stage)
        else:
            top = menu.show(self)
            bottom = status.height()
            self.layout.show(self._show_stage, top, bottom)
            status.show(self)
            self.files.show()
            help.show(self)
            self.layout.keep_focus(navigation.focused_window())
        if self.model.wanted_panel:  # after the first arrangement, which has its own in front
            self.layout.focus(self.model.wanted_panel)
            self.model.wanted_panel = ""
        self.files.catalogue.upload(self.pair_renderer.ctx)
        self._window.to_screen()  # pictures were drawn, and panels fetched numbers

    def after_frame(self, frame_s: float) -> bool:
        """Learn from the frame; whether another is needed at once."""
        assert self.pair_renderer is not None
        self.model.frame_s = frame_s
        io = imgui.get_io()
        now_s = time.monotonic()
        if io.want_save_ini_settings or now_s - self._layout_kept_s > LAYOUT_S:
            io.want_save_ini_settings = False
            self._layout_kept_s = now_s
            self.model.attempt(self.save_layout)
        if self.pair_renderer.ctx.error != "GL_NO_ERROR":
            self._lost = True  # the next frame reports it and makes everything again
            return True
        if self.model.dragging:
            return True
        if not self.hold.rested():  # a pause for the compiler would part its clicks
            return False
        warmed = self.pair_renderer.warm(
            self.model.on_screen, self.files.new_material.about_to_show
        )
        if not warmed:
            self.pair_renderer.tidy()
        assert self._window is not None
        self._window.to_screen()
        return warmed

    def wait_s(self) -> float | None:
        """How long nothing needs to be drawn."""
        typing = imgui.get_io().want_text_input  # its cursor blinks
        soon = self.model.held or self.hold.rest_awaited or typing
        return 0.05 if soon else self.files.due_s()

    def dropped(self, paths: list[str]) -> None:
        """Files were dropped on the window."""
        for path in paths:
            self.files.dropped(path)

    def finish(self) -> None:
        """The context is about to go."""
        self.files.close()
        if self._monitor is not None:
            self._monitor.close()
        self.model.attempt(self.save_layout)
        if self.pair_renderer is not None:
            self.pair_renderer.release()

    def wake(self) -> None:
        """Have a frame drawn soon; from any thread."""
        if self._window is not None:
            self._window.wake()

    def quit(self) -> None:
        """Leave after this frame."""
        if self._window is not None:
            self._window.close()

    def keep_layout(self, path: Path, kept: WindowLayout) -> None:
        """Take over the layout of the last run, and write this one's to a file when it changes."""
        self._layout_path, self.kept_layout = path, kept
        self.layout.hidden = kept.hidden
        self.files.catalogue.remember(kept.catalogue)
        if kept.closed is not None:
            for panel in self.layout.panels:
                # A panel that is newer than the kept layout is as at the first start.
                new = bool(kept.docking) and f"[Window][{panel.title}]" not in kept.docking
                panel.visible = panel.at_first if new else panel.title not in kept.closed

    def save_layout(self) -> None:
        """Write the layout, if it is kept and has changed. Raises InputError."""
        if self._layout_path is None or self._window is None:
            return
        layout = WindowLayout(
            size=self._window.size_now(),
            font_scale=self._window.font_scale,
            closed=tuple(p.title for p in self.layout.panels if not p.visible),
            hidden=self.layout.hidden,
            docking=imgui.save_ini_settings_to_memory(),
            catalogue=self.files.catalogue.folder,
        )
        if layout != self.kept_layout:
            make_folder(self._layout_path.parent)
            save_layout(self._layout_path, layout)
            self.kept_layout = layout

    def set_font_scale(self, scale: float) -> None:
        """Show the interface's text at another size."""
        if self._window is not None:
            self._window.set_font_scale(scale)

    @property
    def font_scale(self) -> float:
        """Size of the interface's text, times its normal size."""
        return 1.0 if self._window is None else self._window.font_scale

    def rebuild(self) -> None:
        """The device lost what was on it: make everything again; the next frame is the same."""
        assert self.pair_renderer is not None
        ctx = self.pair_renderer.ctx
        self.pair_renderer.abandon()
        self.model.frames, self.model.ghosts, self.model.tints = {}, {}, {}
        self.model.plate_pictures = {}
        self._ghost_pictures = GhostPictures()
        self.files.catalogue.thumbnails.abandon()
        self.model.renderer = self.pair_renderer = PairRenderer(ctx)
        self.model.report("the graphics device lost its objects; everything was made again")

    # --- one frame ----------------------------------------------------------------------------

    def _note_hand(self) -> None:
        typing = self.files.new_material.active and imgui.get_io().want_text_input
        self.hold.each_frame(typing=typing)

    def _show_stage(self) -> None:
        canvas = stage.show(self.model, self._draw_pictures, self.files.catalogue.drop)
        assert self._window is not None
        self._window.surround = surround_gray(self.model.on_screen.setup.display)
        self._window.canvas = canvas
        wanted = self.model.take_view is not None and not self.model.draft
        self._window.below = self._give_view if wanted and self.drawn_pane is not None else None

    def _draw_pictures(self, pane: Size) -> stage.DrawnPane | None:
        assert self.pair_renderer is not None
        assert self._window is not None
        model = self.model
        state = model.on_screen
        if self.flip_held:
            state = state.with_part("presentation", flipped=not state.presentation.flipped)
        arrangement = arranged(pane, state.presentation, largest=self.pair_renderer.largest)
        if arrangement is None:
            self.drawn_pane = None
            return None
        at = imgui.get_cursor_screen_pos()
        self.stage_origin = (at.x, at.y)
        model.picture_size = arrangement.size
        wanted = int(state.presentation.gap_px)
        model.gap_px = wanted if arrangement.gap_px is None else arrangement.gap_px
        pitch = self._window.pixel_pitch_m()
        model.pixel_pitch_m = pitch
        before = self.pair_renderer.drawn
        new = self.files.new_material
        self.pair_renderer.whole_side = new.side if new.active else ""
        awaited = {side: name for side in SIDES if (name := model.awaited(side))}
        self.pair_renderer.awaited = awaited
        pair = self.pair_renderer.draw(
            state, arrangement, self.draft_scale.scale, pitch, moving=model.dragging
        )
        model.redrawn = passes_since(before, self.pair_renderer.drawn) or model.redrawn
        if model.dragging:
            # What c_max is read from has been waited for; the wait for a monitor is not counted.
            taken_s = time.perf_counter() - self._frame_began_s
            self.draft_scale.measured(taken_s + INTERFACE_S)
        model.draft = self.draft_scale.scale < 1.0
        model.frames = {side: picture.frame for side, picture in pair.pictures.items()}
        model.factor = pair.factor
        if not (model.dragging or model.draft):
            self._pin(pair)
        at_rest = not (model.dragging or model.draft)
        operated = self._operator_pictures.of_pair(state, pair.pictures, at_rest=at_rest)
        model.operator_pictures = operated
        displayed = {side: made for side, one in operated.items() if (made := one.displayed)}
        for side, fault in pair.faults.items():
            if side not in awaited:
                model.report_once(fault, fault=True)
        self._draw_ghosts(state)
        of_pack, uploads = model.pack(model.active_side), self.pair_renderer.uploads
        model.plate_pictures = self._plate_pictures.textures(of_pack, uploads)
        shown, size = as_shown(state, model.picture_size, pitch), model.picture_size
        model.tints = self._mask_tints.textures(shown, size, model.masked, uploads, at_rest=at_rest)
        pictures = self.pair_renderer.with_uploads(pair.pictures, displayed)
        self.drawn_pane = stage.DrawnPane(
            arrangement, DrawnPair(pictures, pair.faults, pair.factor)
        )
        return self.drawn_pane

    def _draw_ghosts(self, state: State) -> None:
        """Draw the ends of the interval of a material that is being estimated, small."""
        assert self.pair_renderer is not None
        model, new = self.model, self.files.new_material
        if new.waiting and new.ghosts and model.ghosts and model.ghost_side == new.side:
            return  # the next ones are soon there
        shown = as_shown(state, model.picture_size, model.pixel_pitch_m)
        ghosts = {}
        try:
            ghosts = self._ghost_pictures.of(
                self.pair_renderer, shown, new.side, new.ghosts, model.picture_size, model.factor
            )
        except RelglossError as error:
            model.report_once(str(error), fault=True)
        model.ghosts, model.ghost_side = ghosts, new.side

    def _pin(self, pair: DrawnPair) -> None:
        """Keep c as a number from now on, where a file gave it as a share of a picture's c_max."""
        model = self.model
        looks = (model.state.side(side).look for side in SIDES)
        if model.state.match is None or any(look.c is None for look in looks):
            frames = {side: picture.frame for side, picture in pair.pictures.items()}
            model.history.amend(matching.pinned(model.state, frames))
            note = matching.far_from_match(model.state)
            if note:
                model.report(note)

    def _give_view(self) -> None:
        """Hand over the pane's pixels, without the interface."""
        take, self.model.take_view = self.model.take_view, None
        if take is None or self.drawn_pane is None:
            return
        assert self._window is not None
        rects = self.drawn_pane.arrangement.rects.values()
        wide, tall = max(x + w for x, _, w, _ in rects), max(y + h for _, y, _, h in rects)
        left, top = (int(v) for v in self.stage_origin)
        take(self._window.pixels(left, top, wide, tall))

    def _render_at(self, side: str, size: Size) -> Frame:
        """A side's picture at another size than the screen's. Raises RelglossError."""
        assert self.pair_renderer is not None
        model = self.model
        state = as_shown(model.state, model.picture_size, model.pixel_pitch_m)
        return self.pair_renderer.render_at(state, side, size)
