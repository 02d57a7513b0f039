"""What gloss meters would read on both samples, and what another reading would look like."""

from __future__ import annotations

from dataclasses import dataclass, field

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.gloss.meter.meter import Reading, hypothetical, main_lobe
from relgloss_view.material.material import Material
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files.background import Outcome
from relgloss_view.viewer.files.own_materials import keep_material
from relgloss_view.viewer.panels import plots
from relgloss_view.viewer.plots.gloss_readings import Glosses, Readings
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.places import data_folder
from relgloss_view.viewer.state.state import SIDES

NARROW_EM = 34.0  #: below this width the slider lies under the readings
TABLE_SHARE = 0.6
ANGLES_DEG = ("60", "20", "75", "85")
IN_WORDS = {"60": "60°", "20": "20°", "75": "75°, paper", "85": "85°"}
TOP_UNITS = 110.0  #: that the slider reaches; typing reaches further
REMEMBERED = 64  #: materials made by the slider


@dataclass(frozen=True)
class _Made:
    """A material that the slider made, and what it was made from."""

    material: Material
    base: Sample
    angle: str
    reading: float


@dataclass(frozen=True)
class _Refused:
    """A reading that can't be reached from what stands on a side, and why; the slider stays."""

    material: Material
    angle: str
    reading: float
    fault: str


@dataclass
class _Memory:
    angle: str = ANGLES_DEG[0]
    made: list[_Made] = field(default_factory=list)
    refused: _Refused | None = None
    last: dict[str, Readings] = field(default_factory=dict)  #: shown until new ones are there


_memory = plots.Kept(_Memory)


def show(model: Model, glosses: Glosses) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("gloss")
    try:
        found = {side: glosses.of(model.state.side(side).sample.material) for side in SIDES}
        room = imgui.get_content_region_avail()
        if room.x < em(NARROW_EM):
            _table(model, found)
            _hypothetical(model, found)
            return
        if imgui.begin_child("readings", ImVec2(TABLE_SHARE * room.x, room.y)):
            _table(model, found)
        imgui.end_child()
        imgui.same_line(0.0, em(1.1))
        if imgui.begin_child("hypothetical", ImVec2(0.0, room.y)):
            _hypothetical(model, found)
        imgui.end_child()
    finally:
        imgui.pop_id()


def _table(model: Model, found: dict[str, Outcome[Material, Readings] | None]) -> None:
    """Both sides' readings, one a row; those of a sample just changed are faint."""
    memory = _memory.of(model)
    rows: dict[str, dict[str, Reading]] = {}
    for side, outcome in found.items():
        if outcome is not None and outcome.value is not None:
            memory.last[side] = outcome.value
        elif outcome is not None:
            memory.last.pop(side, None)
            widgets.wrapped(f"{side}: {printable(outcome.fault, 200)}", dim=True)
        for reading in memory.last.get(side, ()):
            rows.setdefault(reading.key, {})[side] = reading
    if not rows:
        widgets.wrapped("being worked out" if None in found.values() else "no readings", dim=True)
        return
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop
    if not imgui.begin_table("readings", 1 + len(SIDES), flags):
        return
    for name, weight in (("meter", 2.0), *((side, 1.0) for side in SIDES)):
        imgui.table_setup_column(name, imgui.TableColumnFlags_.none, weight)
    imgui.table_headers_row()
    for of_side in rows.values():
        imgui.table_next_row()
        imgui.table_next_column()
        first = next(iter(of_side.values()))
        imgui.text_unformatted(first.name)
        widgets.tooltip(first.standard)
        for side in SIDES:
            imgui.table_next_column()
            if side in of_side:
                _cell(of_side[side], faint=found[side] is None)
    imgui.end_table()


def _cell(reading: Reading, *, faint: bool) -> None:
    if reading.value is None:
        widgets.quiet("-")
        widgets.tooltip(widgets.sentence(reading.reason))
        return
    error = reading.standard_error
    text = f"{reading.value:.3g}" + ("" if error is None else f" ± {error:.1g}")
    (widgets.quiet if faint else imgui.text_unformatted)(text)
    told = reading.standard
    if reading.diffuse is not None:
        told += f"\n{reading.diffuse:.2g} of it is diffuse."
    if error is not None:
        told += "\nThe error is what the fit's standard errors imply."
    widgets.tooltip(told + (f"\n{widgets.sentence(reading.note)}" if reading.note else ""))


def _hypothetical(model: Model, found: dict[str, Outcome[Material, Readings] | None]) -> None:
    """The slider the other way round, on the active side."""
    memory = _memory.of(model)
    side = plots.side_switch(model)
    sample = model.state.side(side).sample
    made = next((m for m in memory.made if m.material is sample.material), None)
    changed, angle = widgets.combo(
        "reading at",
        ANGLES_DEG,
        memory.angle,
        "The angle of incidence; 75° is that of paper gloss.",
        shown=IN_WORDS,
    )
    if changed:
        memory.angle = angle
    refused = memory.refused
    if refused is not None:
        same = refused.material is sample.material and refused.angle == memory.angle
        refused = memory.refused = refused if same else None
    present = _present(memory, made, found[side])
    if present is None:
        widgets.label("would be")
        widgets.quiet("being worked out")
        return
    widgets.label("would be")
    moved, value = imgui.slider_float("##would be", present, 0.0, TOP_UNITS, "%.1f units")
    widgets.tooltip(
        "What would another reading look like? Changes the width of the lobe with the highest "
        "peak, all else held. Ctrl-click types a value."
    )
    if moved:
        _make(model, side, made.base if made else sample, value)
    if refused is not None:
        widgets.wrapped(f"! {refused.fault}")
    if made is not None:
        _told(model, side, sample, made)


def _present(
    memory: _Memory, made: _Made | None, outcome: Outcome[Material, Readings] | None
) -> float | None:
    """Where the slider stands: what was asked for, or what the material reads."""
    if memory.refused is not None:
        return memory.refused.reading
    if made is not None and made.angle == memory.angle:
        return made.reading
    if outcome is None:
        return None
    key = f"gloss-{memory.angle}"
    return next((r.value or 0.0 for r in outcome.value or () if r.key == key), 0.0)


def _make(model: Model, side: str, base: Sample, reading: float) -> None:
    """Put the material that would read so on a side; what can't be reached is said."""
    memory = _memory.of(model)
    try:
        material = hypothetical(base.material, float(memory.angle), reading)
    except InputError as error:
        present = model.state.side(side).sample.material
        memory.refused = _Refused(present, memory.angle, reading, printable(error, 300))
        return
    memory.refused = None
    memory.made.append(_Made(material, base, memory.angle, reading))
    del memory.made[:-REMEMBERED]
    state = model.state.with_sample(side, Sample(material))
    model.change(state, gesture=f"{side} hypothetical")


def _told(model: Model, side: str, sample: Sample, made: _Made) -> None:
    """What stands on the side, and the ways out of it."""
    k = main_lobe(made.base.material)
    if k is not None:
        widths = (made.base.material.specular[k].s_deg, made.material.specular[k].s_deg)
        widgets.wrapped(f"lobe of {widths[0]:.3g}° made {widths[1]:.3g}°")
    told = "hypothetical: no one has measured such a sample"
    widgets.wrapped(told if sample.file else f"{told}; it is in no file yet", dim=True)
    if widgets.button(
        "keep", "write it to a file, so that scenes and commands can name it",
        enabled=sample.file is None,
    ):  # fmt: skip
        model.attempt(lambda: _keep(model, side, made))
    imgui.same_line()
    if widgets.button("measured one", "put back the sample that it was made from"):
        model.set_sample(side, made.base)


def _keep(model: Model, side: str, made: _Made) -> None:
    file = keep_material(made.material, data_folder() / "materials")
    model.set_sample(side, Sample(made.material, file=str(file)))
    model.say(f"written: {file}")
