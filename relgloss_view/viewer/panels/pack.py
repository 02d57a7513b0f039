"""The pack of a side: its form, its artwork and where that lies; below them its finishes."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.shape import SHAPES, SIZES, Shape
from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, Sample
from relgloss_view.viewer.files import pack_files
from relgloss_view.viewer.panels import finishes, plot_widgets
from relgloss_view.viewer.panels.look import side_tabs
from relgloss_view.viewer.shell import sliders, widgets
from relgloss_view.viewer.shell.widgets import Reach
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.packs import lit as lit_pack
from relgloss_view.viewer.state.packs import on_form, with_pack

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.file_actions import FileActions

LONGEST = 60  #: characters of a name
LONGEST_NOTE = 240
MM = 1000.0
SIZE_REACH_MM = (5.0, 500.0)  #: of the sliders of sizes
RADIUS_REACH_MM = (0.0, 10.0)
#: Sliders of the artwork's place, by entry.
PLACE = {
    "offset_x_mm": Reach(-200.0, 200.0, digits="%.1f"),
    "offset_y_mm": Reach(-200.0, 200.0, digits="%.1f"),
    "turn_deg": Reach(-180.0, 180.0, digits="%.1f"),
    "scale": Reach(0.1, 10.0, digits="%.3f", logarithmic=True),
}
MOVE = "Move artwork"
MOVE_HELP = (
    "while it is on, a drag on the pack carries the artwork, the wheel turns it (with Ctrl: scales "
    "it) and arrows move it by 0.1 mm; Alt+drag carries it at any time"
)


def show(model: Model, files: FileActions) -> None:
    """Form, artwork and finishes of the active side's pack; `files` asks for files."""
    side_tabs(model)
    side = model.active_side
    pack = model.pack(side)
    if pack is None:
        _invite(model, side, files)
        return
    imgui.separator_text("Form")
    _form(model, side, pack, files)
    imgui.separator_text("Artwork")
    _artwork(model, side, pack, files)
    imgui.separator_text("Finishes")
    finishes.show(model, side, pack, files)
    imgui.spacing()
    if widgets.button("Remove pack", "shows a paper in its place, on the form of the panel Scene"):
        model.set_sample(side, Sample.built_in(DEFAULT_SAMPLE))
        model.moving_artwork = False


def _invite(model: Model, side: str, files: FileActions) -> None:
    """How to come to a pack, where the side shows a sample."""
    text = f"The {side} picture shows a sample of one material."
    if side == "test":
        text += " Drop an artwork (PDF, PNG, JPEG, TIFF, PSD), a pack file or a mesh on the window."
    widgets.wrapped(text, dim=True)
    if widgets.button("Open artwork...", "asks for an artwork, which goes on a can"):
        files.ask_artwork(side)
    text = "Plain pack"
    plot_widgets.beside(plot_widgets.button_width(text), gap_em=0.5)
    if widgets.button(text, "makes a can of the present sample, without artwork"):
        files.make_pack(side)


def _folded(title: str) -> bool:
    """A part of the panel behind a fold; whether it is open, so that tree_pop goes with it."""
    return bool(imgui.tree_node_ex(title, imgui.TreeNodeFlags_.framed))


# --- form -----------------------------------------------------------------------------------------


def _form(model: Model, side: str, pack: Pack, files: FileActions) -> None:
    shape = pack.shape
    text = widgets.label_of(Shape, "kind")
    words = {"mesh": "mesh file..."}
    changed, kind = widgets.combo(
        text, SHAPES, shape.kind, "The pack's form. The reference keeps its own.", words=words
    )
    if changed and kind == "mesh":
        files.ask_mesh(side)
    elif changed:
        model.attempt(lambda: _set_shape(model, side, pack, shape.with_kind(kind), "", lit=True))
    if SIZES[shape.kind] and _folded("Sizes"):
        for name in SIZES[shape.kind]:
            _size(model, side, pack, name)
        if shape.profile_mm:
            count = len(shape.profile_mm)
            widgets.wrapped(f"Its profile of {count} points decides its sizes.", dim=True)
        imgui.tree_pop()
    if shape.kind == "mesh":
        _mesh(model, side, pack, files)


def _set_shape(
    model: Model, side: str, pack: Pack, shape: Shape, gesture: str, *, lit: bool = False
) -> None:
    state = with_pack(model.state, side, on_form(pack, shape))
    model.change(lit_pack(state) if lit and side == "test" else state, gesture or None)


def _size(model: Model, side: str, pack: Pack, name: str) -> None:
    """A slider for a size, in millimetres, as packaging is measured."""
    field = widgets.declared(Shape, name)
    text = widgets.label_of(Shape, name)
    limits = field.metadata["range"]
    low, high = RADIUS_REACH_MM if name == "edge_radius_m" else SIZE_REACH_MM
    present = MM * getattr(pack.shape, name)
    usual = MM * getattr(Shape(pack.shape.kind), name)
    widgets.label(text)
    changed, value = sliders.float_slider(f"##{text}", present, low, high, "%.1f mm")
    resetting = sliders.resetting()
    widgets.tooltip(f"{widgets.sentence(limits.meaning)}\nDefault: {usual:g} mm. {sliders.HOW}")
    if resetting:
        changed, value = present != usual, usual
    if changed:
        metres = min(max(value / MM, limits.low), limits.high)
        shape = dataclasses.replace(pack.shape, **{name: metres})
        model.attempt(lambda: _set_shape(model, side, pack, shape, f"{side} {name}"))


def _mesh(model: Model, side: str, pack: Pack, files: FileActions) -> None:
    widgets.wrapped(printable(Path(pack.shape.file).name, LONGEST), dim=True)
    widgets.tooltip(printable(pack.shape.file, 400))
    changed, unit = widgets.choice(Shape, "unit", pack.shape.unit)
    if changed:
        shape = dataclasses.replace(pack.shape, unit=unit)
        model.attempt(lambda: _set_shape(model, side, pack, shape, ""))
    if widgets.button("Open mesh...", "asks for another mesh (.glb, .gltf, .obj, .ply)"):
        files.ask_mesh(side)
    try:
        notes = pack_files.mesh_notes(pack.shape)
    except InputError:  # the picture's own line reports it
        notes = ()
    for note in notes:
        widgets.wrapped(printable(note, LONGEST_NOTE), dim=True)


# --- artwork --------------------------------------------------------------------------------------


def _artwork(model: Model, side: str, pack: Pack, files: FileActions) -> None:
    artwork = pack.artwork
    if artwork is None:
        widgets.wrapped("None. The base finish shows its own colour.", dim=True)
        if widgets.button("Open artwork...", "asks for a PDF or a picture"):
            files.ask_artwork(side)
        return
    name = Path(artwork.file).name if artwork.file else pack.artwork_file or "artwork"
    imgui.text_unformatted(printable(name, LONGEST))
    widgets.tooltip(printable(artwork.file or name, 400))
    width, height = artwork.size_px
    density = width / artwork.width_mm
    widgets.wrapped(
        f"{artwork.width_mm:.4g} x {artwork.height_mm:.4g} mm, {width} x {height} px "
        f"({density:.3g} px/mm)",
        dim=True,
    )
    for note in artwork.notes:
        widgets.wrapped(printable(note, LONGEST_NOTE), dim=True)
    if widgets.button("Replace...", "asks for another artwork; finishes and placement stay"):
        files.ask_artwork(side)
    plot_widgets.beside(plot_widgets.button_width("Take off"), gap_em=0.5)
    if widgets.button("Take off", "removes the artwork from the pack; its file stays"):
        bare = dataclasses.replace(pack, artwork=None, artwork_file="", finishes=_bare(pack))
        model.set_pack(side, bare)
        return
    _hand(model, side, pack)
    if not _folded("Placement and colours"):
        return
    _place(model, side, pack)
    changed, rule = widgets.choice(Pack, "colour", pack.colour)
    if changed:
        model.set_pack(side, dataclasses.replace(pack, colour=rule))
    imgui.tree_pop()


def _bare(pack: Pack) -> tuple[Finish, ...]:
    """The finishes of a pack without its artwork: a mask of it lies everywhere instead."""
    of_artwork = ("plate:", "channel:", "artwork")
    return tuple(
        dataclasses.replace(one, mask="everywhere") if one.mask.startswith(of_artwork) else one
        for one in pack.finishes
    )


def _place(model: Model, side: str, pack: Pack) -> None:
    """Where the artwork lies, as numbers."""
    placement = pack.placement
    for name, reach in PLACE.items():
        changed, value = widgets.slider(Placement, name, getattr(placement, name), reach)
        if changed:
            moved = dataclasses.replace(placement, **{name: value})
            model.place_artwork(side, moved, gesture=f"{side} {name}")


def _hand(model: Model, side: str, pack: Pack) -> None:
    """The switch for the hand in the picture, and the way back."""
    half = 0.5 * (imgui.get_content_region_avail().x - imgui.get_style().item_spacing.x)
    if widgets.toggle(MOVE, on=model.moving_artwork, width=half):
        model.moving_artwork = not model.moving_artwork
    widgets.tooltip(widgets.sentence(MOVE_HELP))
    imgui.same_line()
    if widgets.button(
        "Centre", "lays the artwork in the middle, upright, at its own size", width=half,
        enabled=pack.placement != Placement(),
    ):  # fmt: skip
        model.place_artwork(side, Placement())
