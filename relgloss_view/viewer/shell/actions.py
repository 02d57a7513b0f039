"""Actions by menu or key: one table, from which menus, keys and the overview come."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.base.words import sentence_case
from relgloss_view.picture.scene.look import QUALITIES
from relgloss_view.viewer.drawing import camera
from relgloss_view.viewer.shell import navigation
from relgloss_view.viewer.state import matching
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

#: The windows of the menu Help.
FIRST_STEPS, KEYS, MANUAL = "First steps", "Keys and mouse", "Manual"
_KEY_NAMES = {"Esc": "escape"}
TURN_LAMP = "Turn the lamp to the highlight"


@dataclass(frozen=True)
class Action:
    """One thing to do: its menu, text and key, its work, and whether it is on or possible."""

    menu: str
    text: str
    key: str  #: as people read it, such as Ctrl+Shift+S; empty for none
    run: Callable[[App], object]
    help: str
    _: KW_ONLY
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

    @property
    def is_letter(self) -> bool:
        """Whether its key is a single letter or digit."""
        return len(self.key) == 1


def take_keys(app: App) -> None:
    """Do the actions of the keys that are pressed, unless a text is being typed."""
    app.flip_held = False
    io = imgui.get_io()
    app.menu_wanted = app.alt_key.tapped()
    if io.want_text_input:
        return
    alone = app.model.state.presentation.haploscopic
    if app.model.state.presentation.compare == FLIP and (alone or not io.nav_visible):
        # While the focus shows, Space presses the control that has it.
        imgui.internal.set_key_owner(imgui.Key.space, imgui.get_id("flip by Space"))
        app.flip_held = imgui.is_key_down(imgui.Key.space)
    editing = navigation.typing()
    for action in ACTIONS:
        if alone and action.menu not in ("File", "Edit", "") and action.text not in _WHILE_ALONE:
            continue  # its effect would be invisible until the panels are back
        if editing and action.is_letter:
            continue  # it belongs to what is edited
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
    state, presentation = app.model.state, app.model.state.presentation
    state = state.with_part(
        "presentation",
        reference_operator=presentation.test_operator,
        test_operator=presentation.reference_operator,
    )
    app.model.change(matching.swapped(state))


def _at_c_max(app: App) -> None:
    side = app.model.active_side
    frame = app.model.frames.get(side)
    if frame is None or frame.c_max is None:
        app.model.report("no highlight is seen, so c_max has no value", fault=True)
        return
    app.model.set_c(side, frame.c_max)


def _other_quality(app: App) -> None:
    side = app.model.active_side
    present = app.model.state.side(side).look.quality
    app.model.set_look(side, quality=next(name for name in QUALITIES if name != present))


def _is_exact(app: App) -> bool:
    return app.model.state.side(app.model.active_side).look.quality == "exact"


def _reset_view(app: App) -> None:
    state = app.model.state.with_part("presentation", life_size=False)
    app.model.change(state.placed(eye=camera.framed(state.setup.eye)))


def _reset_all(app: App) -> None:
    app.model.change(State.initial())
    app.files.scene_path = None  # the scene that was open keeps what it holds


def _other_side(app: App) -> None:
    app.model.active_side = next(side for side in SIDES if side != app.model.active_side)


def _has_artwork(app: App) -> bool:
    pack = app.model.pack(app.model.active_side)
    return pack is not None and pack.artwork is not None


def _move_artwork(app: App) -> None:
    app.model.moving_artwork = not app.model.moving_artwork


def _hide(app: App) -> None:
    app.layout.hidden = not app.layout.hidden


def _leave(app: App) -> None:
    app.help_window = ""
    app.model.set_part("presentation", haploscopic=False)


def _menu(app: App) -> None:
    app.menu_wanted = True


def _help(title: str) -> Callable[[App], object]:
    def run(app: App) -> None:
        app.help_window = "" if app.help_window == title else title

    return run


#: Actions of the menu View whose effect shows where there are only the two pictures.
_WHILE_ALONE = ("Haploscopic", "Mirror", "Reset camera", "Life size", TURN_LAMP)
_MODE_HELP = {
    SIDE_BY_SIDE: "shows the reference on the left and the test on the right",
    WIPE: "shows one picture over the other; drag the edge between them",
    FLIP: "shows one picture at a time; hold Space to see the other",
    DIFFERENCE: "maps the colour difference between the two pictures",
}

ACTIONS: tuple[Action, ...] = (
    Action(
        "File", "Open...", "Ctrl+O", lambda app: app.files.open(),
        "opens a proof, a scene, a pack, artwork, a mesh, or a measurement or material as the test",
    ),
    Action(
        "File", "Open catalogue...", "Ctrl+Shift+O", lambda app: app.files.open_catalogue(),
        "opens many samples with their pictures, to search them and drag them onto a picture",
    ),
    Action(
        "File", "New material...", "Ctrl+N", lambda app: app.files.make_material(),
        "makes a material from gloss readings and a colour, where there is no measured table",
    ),
    Action(
        "File", "Replace reference...", "Ctrl+R", lambda app: app.files.replace_reference(),
        "opens a measurement or a material as the reference, which nothing else replaces",
    ),
    Action(
        "File", "Save scene", "Ctrl+S", lambda app: app.files.save(),
        "saves all settings of the window as a scene file (TOML)",
    ),
    Action(
        "File", "Save scene as...", "Ctrl+Shift+S", lambda app: app.files.save_as(),
        "saves the scene under another name",
    ),
    Action(
        "File", "Save as proof...", "Ctrl+P", lambda app: app.files.save_proof(),
        "saves the pair as one file, which the other side opens in a browser or in relgloss",
    ),
    Action(
        "File", "Reply...", "Ctrl+Shift+P", lambda app: app.files.reply(),
        "answers the open proof with your settings and a note",
        possible=lambda app: app.model.proof is not None,
    ),
    Action(
        "File", "Export...", "Ctrl+E", lambda app: app.files.export(),
        "saves pictures as PNG or OpenEXR",
    ),
    Action(
        "File", "Export view...", "Ctrl+Shift+E", lambda app: app.files.export_view(),
        "saves both pictures as they show, with wipe, overlay or map",
    ),
    Action(
        "File", "Copy as command", "Ctrl+C", lambda app: app.files.copy_command(),
        "copies the command that draws the active picture",
    ),
    Action(
        "File", "Quit", "Ctrl+Q", lambda app: app.quit(), "closes the window; the session is kept"
    ),
    Action(
        "Edit", "Undo", "Ctrl+Z", lambda app: app.model.history.undo(),
        "takes back the last change, except of presets and panels",
        possible=lambda app: app.model.history.can_undo,
    ),
    Action(
        "Edit", "Redo", "Ctrl+Y", lambda app: app.model.history.redo(),
        "makes the change again", possible=lambda app: app.model.history.can_redo,
    ),
    Action("Edit", "Swap sides", "X", _swap, "exchanges the reference and the test"),
    Action(
        "Edit", "Highest contrast gloss", "L", _at_c_max, "sets c to c_max on the active side"
    ),
    Action(
        "Edit", "Move artwork", "A", _move_artwork,
        "lets drags, wheel and arrows in the picture move the artwork of the active side's pack",
        on=lambda app: app.model.moving_artwork, possible=_has_artwork,
    ),
    Action(
        "Edit", "Start afresh", "", _reset_all, "brings back the built-in papers and all defaults"
    ),
    *(
        Action(
            "View", sentence_case(mode), str(k + 1),
            _present(compare=mode), _MODE_HELP[mode], on=_comparing(mode),
        )
        for k, mode in enumerate(COMPARE_MODES)
    ),
    Action(
        "View", "Show the other picture", "B", _toggle("flipped"),
        "in flip mode, until it is chosen again", on=_is_on("flipped"), possible=_comparing(FLIP),
    ),
    Action(
        "View", "Next overlay", "O", _next_overlay,
        "marks clipped or out-of-gamut pixels, or shows L*, parts, normals",
    ),
    Action(
        "View", "Other side active", "S", _other_side,
        "chooses the side that panels show and keys change",
    ),
    Action(
        "View", "Exact drawing", "Q", _other_quality,
        "draws the active side with the whole model, or by quality auto again", on=_is_exact,
    ),
    Action(
        "View", "Reset camera", "F", _reset_view,
        "shows the whole object from the front, as a double click does",
    ),
    Action(
        "View", TURN_LAMP, "G", lambda app: app.model.turn_lamp(),
        "turns the lamp, and the eye of a flat form seen straight on, so that gloss is visible",
    ),
    Action(
        "View", "Life size", "0", _toggle("life_size"),
        "shows the object as large as it is, by the monitor's own data", on=_is_on("life_size"),
        possible=lambda app: app.model.pixel_pitch_m is not None,
    ),
    Action(
        "View", "Mirror", "M", _toggle("mirror"),
        "swaps left and right, for a mirror before the monitor", on=_is_on("mirror"),
    ),
    Action(
        "View", "Haploscopic", "P", _toggle("haploscopic"),
        "shows only the two pictures; Esc or a right click leaves", on=_is_on("haploscopic"),
    ),
    Action(
        "View", "Hide panels", "F9", _hide, "hides all panels, or brings them back",
        on=lambda app: app.layout.hidden,
    ),
    Action(
        "View", "Next panel", "F6", lambda app: navigation.next_panel(app, 1),
        "gives the keyboard to the next panel",
    ),
    Action(
        "View", "Previous panel", "Shift+F6", lambda app: navigation.next_panel(app, -1),
        "gives the keyboard to the previous panel",
    ),
    Action(
        "View", "Reset panels", "", lambda app: app.layout.reset(),
        "arranges the panels as at the first start",
    ),
    Action(
        "Help", FIRST_STEPS, "", _help(FIRST_STEPS),
        "leads through a first pair: sample, gloss, light",
    ),
    Action("Help", KEYS, "H", _help(KEYS), "shows or hides the overview of all keys"),
    Action("Help", MANUAL, "", _help(MANUAL), "shows where the manual is, and opens it"),
    Action("", "Leave haploscopic mode", "Esc", _leave, "goes back to the panels"),
    Action("", "Open the menu", "F10", _menu, "gives the keyboard to the menu, as Alt does"),
)  # fmt: skip

#: The mouse in the pictures and the panels, for the overview.
MOUSE = (
    ("Drag", "turn the object"),
    ("Shift+drag, right drag", "move the picture"),
    ("Wheel", "zoom towards the pointer"),
    ("Double click", "reset the camera"),
    ("Ctrl+drag", "move the lamp"),
    ("Hold Space", "show the other picture (flip)"),
    ("Ctrl+click a slider", "type a value"),
    ("Double-click a slider", "reset it"),
    ("Alt+click, Alt+drag", "pin a pixel; move artwork"),
    ("Drop a file", "open it; a sample becomes the test"),
)
