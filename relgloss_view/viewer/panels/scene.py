"""What both pictures share: lamp, object, eye and display."""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from relgloss_view.material.spectra import SHIPPED_ILLUMINANTS
from relgloss_view.pack.shape import SHAPES, SIZES, Shape
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.viewer.drawing import camera
from relgloss_view.viewer.panels import display, lamps
from relgloss_view.viewer.shell import sliders, widgets
from relgloss_view.viewer.shell.file_actions import FileActions
from relgloss_view.viewer.shell.theme import em, gray
from relgloss_view.viewer.shell.widgets import Reach
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

DIAL_EM = 7.0
HIGHLIGHT_HELP = (
    "turn the lamp so that a highlight lies on the object; where a flat form is seen straight on, "
    "turn the eye too"
)
ARROW_DEG = 2.0  #: that a press of an arrow moves the lamp

#: Sliders of a part, by entry, in their order.
Sliders = dict[str, Reach]
_ANGLE = Reach(digits="%.1f")
_DISTANCE = Reach(0.1, 10.0, logarithmic=True)
_SIZE = Reach(0.01, 1.0, logarithmic=True)
_LAMP: Sliders = {
    "azimuth_deg": _ANGLE,
    "elevation_deg": _ANGLE,
    "distance_m": _DISTANCE,
    "luminance_cd_m2": Reach(1.0, 1000.0, logarithmic=True),
    "radius_m": lamps.RADIUS,
    "ambient": Reach(digits="%.2f"),
}
_EYE: Sliders = {"azimuth_deg": _ANGLE, "elevation_deg": _ANGLE, "distance_m": _DISTANCE}


def show(model: Model, files: FileActions) -> None:
    """Controls of lamp, object, eye and display."""
    imgui.separator_text("Lamp")
    _dial(model)
    _sliders(model, "lamp", Lamp, _LAMP)
    if widgets.button("Turn to the highlight", HIGHLIGHT_HELP):
        model.turn_lamp()
    _illuminant(model)
    _choice(model, "lamp", Lamp, "y_n")
    lamps.show(model)
    _object(model)
    imgui.separator_text("Eye")
    _sliders(model, "eye", Eye, _EYE)
    if widgets.button("Reset camera", "frame the object from the front"):
        model.change(model.state.placed(eye=camera.framed(model.state.setup.eye)))
    imgui.separator_text("Display and surround")
    display.show(model, files)


def _sliders(model: Model, part: str, owner: type, sliders: Sliders) -> None:
    for name, reach in sliders.items():
        value = getattr(model.state.part(part), name)
        changed, number = widgets.slider(owner, name, value, reach)
        if changed:
            model.attempt(
                lambda name=name, number=number: model.set_part(  # type: ignore[misc]
                    part, gesture=f"{part} {name}", **{name: number}
                )
            )


def _choice(model: Model, part: str, owner: type, name: str) -> None:
    changed, chosen = widgets.choice(owner, name, getattr(model.state.part(part), name))
    if changed:
        model.set_part(part, **{name: chosen})


def _object(model: Model) -> None:
    """The form of samples, which are no packs: a pack brings its own."""
    packed = [side for side in SIDES if model.pack(side) is not None]
    of = {0: "Object", 1: f"Object of the {'test' if packed == ['reference'] else 'reference'}"}
    if len(packed) == len(SIDES):
        return
    imgui.separator_text(of[len(packed)])
    _form(model)
    _sliders(model, "shape", Shape, dict.fromkeys(SIZES[model.state.setup.shape.kind], _SIZE))


def _form(model: Model) -> None:
    """The object's form; another one is lit so that its highlight is seen, in one step of undo."""
    shape = model.state.setup.shape
    kinds = tuple(kind for kind in SHAPES if kind != "mesh" or shape.kind == "mesh")
    meaning = "The object's form. Drop a mesh (.glb, .gltf, .obj, .ply) on the window for its form."
    changed, kind = widgets.combo(widgets.label_of(Shape, "kind"), kinds, shape.kind, meaning)
    if changed:
        model.change(model.state.placed(shape=shape.with_kind(kind)).lit_for_gloss())


def _illuminant(model: Model) -> None:
    present = model.state.setup.lamp.illuminant
    options = (*SHIPPED_ILLUMINANTS, *(() if present in SHIPPED_ILLUMINANTS else (present,)))
    meaning = "Spectrum of the lamp: CIE illuminants; a scene file may name a two-column table."
    text = widgets.label_of(Lamp, "illuminant")
    changed, name = widgets.combo(text, options, present, meaning)
    if changed:
        model.attempt(lambda: model.set_part("lamp", illuminant=name))


def _dial(model: Model) -> None:
    """The lamp from above: a drag moves it around, with Shift up and down."""
    size = em(DIAL_EM)
    indent = 0.5 * (imgui.get_content_region_avail().x - size)
    imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + max(indent, 0.0))
    origin = imgui.get_cursor_screen_pos()
    imgui.invisible_button("lamp dial", ImVec2(size, size), imgui.ButtonFlags_.enable_nav)
    resetting = sliders.resetting()
    active = imgui.is_item_active()
    around, up = sliders.arrows()
    widgets.tooltip(
        "The lamp seen from above, with the eye below. Drag to move the lamp around the object. "
        "Shift+drag up and down to change its height. Arrows move it, too. Double-click or Delete "
        "to reset it."
    )
    lamp = model.state.setup.lamp
    centre = ImVec2(origin.x + 0.5 * size, origin.y + 0.5 * size)
    if resetting:
        lamp = camera.placed(lamp, Lamp().azimuth_deg, Lamp().elevation_deg)
        model.change(model.state.placed(lamp=lamp), gesture="lamp dial")
    elif around or up:
        sliders.note_moved()
        lamp = camera.placed(
            lamp, lamp.azimuth_deg + ARROW_DEG * around, lamp.elevation_deg + ARROW_DEG * up
        )
        model.change(model.state.placed(lamp=lamp), gesture="lamp dial")
    elif active and not imgui.is_item_activated():
        io = imgui.get_io()
        mouse = imgui.get_mouse_pos()
        if io.key_shift:
            turned = lamp.elevation_deg - io.mouse_delta.y * 180.0 / size
            lamp = camera.placed(lamp, lamp.azimuth_deg, turned)
        elif math.hypot(mouse.x - centre.x, mouse.y - centre.y) > 0.1 * size:
            azimuth = math.degrees(math.atan2(mouse.x - centre.x, mouse.y - centre.y))
            lamp = camera.placed(lamp, azimuth, lamp.elevation_deg)
        model.change(model.state.placed(lamp=lamp), gesture="lamp dial")
    _draw_dial(model, centre, 0.5 * size)


def _draw_dial(model: Model, centre: ImVec2, radius: float) -> None:
    """Circles every 30 degrees of elevation, the object, the eye, the lamp."""
    painter = imgui.get_window_draw_list()

    def ink(value: float, alpha: float = 1.0) -> int:
        return int(imgui.color_convert_float4_to_u32(gray(value, alpha)))

    outer = 0.86 * radius
    for share in (1.0, 2.0 / 3.0, 1.0 / 3.0):
        painter.add_circle(centre, outer * share, ink(0.30), 48, 1.0)
    painter.add_circle_filled(centre, 0.10 * radius, ink(0.45), 24)

    def place(azimuth_deg: float, elevation_deg: float) -> ImVec2:
        away = outer * (1.0 - abs(elevation_deg) / 90.0)
        turn = math.radians(azimuth_deg)
        return ImVec2(centre.x + away * math.sin(turn), centre.y + away * math.cos(turn))

    eye, lamp = model.state.setup.eye, model.state.setup.lamp
    at = place(eye.azimuth_deg, eye.elevation_deg)
    painter.add_circle(at, 0.075 * radius, ink(0.62), 24, 1.5)
    painter.add_circle_filled(at, 0.03 * radius, ink(0.62), 12)
    for other in model.state.setup.further_lamps:
        at = place(other.azimuth_deg, other.elevation_deg)
        painter.add_line(centre, at, ink(0.62, 0.25), 1.0)
        if other.elevation_deg >= 0.0:
            painter.add_circle_filled(at, 0.05 * radius, ink(0.7), 24)
        else:
            painter.add_circle(at, 0.045 * radius, ink(0.7), 24, 1.5)
    at = place(lamp.azimuth_deg, lamp.elevation_deg)
    painter.add_line(centre, at, ink(0.62, 0.5), 1.0)
    if lamp.elevation_deg >= 0.0:
        painter.add_circle_filled(at, 0.085 * radius, ink(0.93), 24)
    else:  # from below: a ring
        painter.add_circle(at, 0.075 * radius, ink(0.93), 24, 2.0)
