"""What can be done by menu or key: one table, from which menus, keys and the overview come."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.picture.scene.setting import Setting
from relgloss_view.viewer.drawing import camera
from relgloss_view.viewer.state.state import (
    COMPARE_MODES,
    DIFFERENCE,
    FLIP,
    OVERLAYS,
    SIDE_BY_SIDE,
    SIDES,
    WIPE,
    State,
)

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.app import App

_KEY_NAMES = {"Esc": "escape"}


@dataclass(frozen=True)
class Action:
    """One thing to do: its words, its key, what it does, and whether it is on or possible."""

    menu: str
    text: str
    key: str  #: as people read it, such as Ctrl+Shift+S; empty for none
    run: Callable[[App], object]
    help: str
    on: Callable[[App], bool] | None = None
    possible: Callable[[App], bool] = lambda app: True

    @cached_property
    def chord(self) -> int:
        """The key as ImGui counts it; 0 for none."""
        if not self.key:
            return 0
        *modifiers, key = self.key.split("+")
        names = [f"mod_{name.lower()}" for name in modifiers]
        names.append(_KEY_NAMES.get(key, f"_{key}" if key.isdigit() else key.lower()))
        return sum(int(getattr(imgui.Key, name)) for name in names)


def take_keys(app: App) -> None:
    """Do what the keys ask for, unless a text is being typed."""
    app.flip_held = False
    if imgui.get_io().want_text_input:
        return
    if app.model.state.presentation.compare == FLIP:
        app.flip_held = imgui.is_key_down(imgui.Key.space)
    alone = app.model.state.presentation.haploscopic
    for action in ACTIONS:
        if alone and action.menu not in ("File", "Edit", "") and action.text not in _SEEN_ALONE:
            continue  # what it does would not be seen before the panels are back
        if action.chord and imgui.is_key_chord_pressed(action.chord) and action.possible(app):
            action.run(app)


def _present(**changes: object) -> Callable[[App], object]:
    return lambda app: app.model.set_part("presentation", **changes)


def _toggle(name: str) -> Callable[[App], object]:
    def run(app: App) -> None:
        value = getattr(app.model.state.presentation, name)
        app.model.set_part("presentation", **{name: not value})

    return run


def _is_on(name: str) -> Callable[[App], bool]:
    return lambda app: bool(getattr(app.model.state.presentation, name))


def _comparing(mode: str) -> Callable[[App], bool]:
    return lambda app: app.model.state.presentation.compare == mode


def _next_overlay(app: App) -> None:
    present = app.model.state.presentation.overlay
    following = OVERLAYS[(OVERLAYS.index(present) + 1) % len(OVERLAYS)]
    app.model.set_part("presentation", overlay=following)


def _swap(app: App) -> None:
    state, shown = app.model.state, app.model.state.presentation
    state = state.with_part(
        "presentation",
        reference_operator=shown.test_operator,
        test_operator=shown.reference_operator,
    )
    app.model.change(dataclasses.replace(state, reference=state.test, test=state.reference))


def _at_c_max(app: App) -> None:
    side = app.model.active_side
    sigma_n_deg = app.model.state.side(side).look.sigma_n_deg
    app.model.set_setting(side, Setting(sigma_n_deg))


def _reset_view(app: App) -> None:
    state = app.model.state.with_part("presentation", life_size=False)
    app.model.change(state.placed(eye=camera.framed(state.setup.eye)))


def _reset_all(app: App) -> None:
    app.model.change(State.initial())
    app.files.scene_path = None  # the scene that was open keeps what it holds


def _other_side(app: App) -> None:
    app.model.active_side = next(side for side in SIDES if side != app.model.active_side)


def _hide(app: App) -> None:
    app.layout.hidden = not app.layout.hidden


def _leave(app: App) -> None:
    app.helping = False
    app.model.set_part("presentation", haploscopic=False)


def _help(app: App) -> None:
    app.helping = not app.helping


#: Of the menu View, what can be seen where only the two pictures show.
_SEEN_ALONE = ("Haploscopic", "Mirror", "Reset camera", "Life size")
_MODE_HELP = {
    SIDE_BY_SIDE: "reference left, test right",
    WIPE: "one over the other, with an edge to drag",
    FLIP: "one at a time; hold Space to see the other",
    DIFFERENCE: "map of the colour difference between both",
}

ACTIONS: tuple[Action, ...] = (
    Action(
        "File", "Open...", "Ctrl+O", lambda app: app.files.open(),
        "a measurement, a material or a scene",
    ),
    Action(
        "File", "Save scene", "Ctrl+S", lambda app: app.files.save(),
        "everything set in the window, as TOML",
    ),
    Action(
        "File", "Save scene as...", "Ctrl+Shift+S",
        lambda app: app.files.save_as(), "under another name",
    ),
    Action(
        "File", "Export...", "Ctrl+E", lambda app: app.files.export(),
        "pictures as PNG or OpenEXR",
    ),
    Action(
        "File", "Export view...", "Ctrl+Shift+E", lambda app: app.files.export_view(),
        "the pane as it is: both pictures, wipe, overlay or difference map, as PNG",
    ),
    Action(
        "File", "Copy as command", "Ctrl+C", lambda app: app.files.copy_command(),
        "the line that draws the active side's picture without a window",
    ),
    Action("File", "Quit", "Ctrl+Q", lambda app: app.quit(), "leave; all is kept"),
    Action(
        "Edit", "Undo", "Ctrl+Z", lambda app: app.model.history.undo(),
        "take back the last step; presets and the layout of panels are no steps", None,
        lambda app: app.model.history.can_undo,
    ),
    Action(
        "Edit", "Redo", "Ctrl+Y", lambda app: app.model.history.redo(),
        "do it again", None, lambda app: app.model.history.can_redo,
    ),
    Action("Edit", "Swap sides", "X", _swap, "reference becomes test, test reference"),
    Action("Edit", "c to c_max", "L", _at_c_max, "on the active side"),
    Action("Edit", "Start afresh", "", _reset_all, "the built-in papers, every default"),
    *(
        Action(
            "View", mode[:1].upper() + mode[1:], str(k + 1),
            _present(compare=mode), _MODE_HELP[mode], _comparing(mode),
        )
        for k, mode in enumerate(COMPARE_MODES)
    ),
    Action(
        "View", "Show the other picture", "B", _toggle("flipped"),
        "in flip mode: it stays until this is chosen again", _is_on("flipped"), _comparing(FLIP),
    ),
    Action("View", "Next overlay", "O", _next_overlay, "clipped, gamut, L*, parts, normals"),
    Action(
        "View", "Other side active", "S", _other_side,
        "the side that panels show and keys act on",
    ),
    Action(
        "View", "Reset camera", "F", _reset_view,
        "frame the object from the front; so does a double click in a picture",
    ),
    Action(
        "View", "Life size", "0", _toggle("life_size"),
        "as large as the object is, by what the monitor says of itself", _is_on("life_size"),
        lambda app: app.model.pixel_pitch_m is not None,
    ),
    Action(
        "View", "Mirror", "M", _toggle("mirror"),
        "swap left and right, for a mirror before the monitor", _is_on("mirror"),
    ),
    Action(
        "View", "Haploscopic", "P", _toggle("haploscopic"),
        "only the two pictures, no text; Esc or a right click leaves", _is_on("haploscopic"),
    ),
    Action(
        "View", "Hide panels", "Tab", _hide, "all of them; they come back as they were",
        lambda app: app.layout.hidden,
    ),
    Action(
        "View", "Reset panels", "", lambda app: app.layout.reset(), "as at the first start"
    ),
    Action("Help", "Keys", "H", _help, "this overview"),
    Action("", "Leave haploscopic mode", "Esc", _leave, "back to the panels"),
)  # fmt: skip

#: What the mouse does in the pictures, for the overview.
MOUSE = (
    ("drag", "turn the object"),
    ("Shift+drag, right drag", "move the picture"),
    ("wheel", "zoom towards the pointer"),
    ("double click", "reset the camera"),
    ("Ctrl+drag", "move the lamp"),
    ("Space (held), in flip mode", "show the other picture"),
    ("Ctrl+click on a slider", "type a value"),
    ("double click on a slider", "reset it"),
    ("Alt+click", "pin a pixel in the Pixel panel"),
    ("drop a file", "open it"),
)
