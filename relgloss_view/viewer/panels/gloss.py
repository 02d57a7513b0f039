"""Gloss meters' readings of both samples, and the look of another reading."""

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
from relgloss_view.viewer.panels import plot_widgets
from relgloss_view.viewer.plots.gloss_readings import GlossReadings, Readings
from relgloss_view.viewer.shell import sliders, widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.places import data_folder
from relgloss_view.viewer.state.state import SIDES

WANTED = "Wanted reading"
NARROW_EM = 34.0  #: below this width the slider lies under the readings
TABLE_SHARE = 0.66
ANGLES_DEG = ("60", "20", "75", "85")
IN_WORDS = {"60": "60°", "20": "20°", "75": "75°, paper", "85": "85°"}
TOP_UNITS = 110.0  #: that the slider reaches; typing reaches further
REMEMBERED = 64  #: materials made by the slider


@dataclass(frozen=True)
class _Made:
    """A material that the slider made, and its base."""

    material: Material
    base: Sample
    angle: str
    reading: float


@dataclass(frozen=True)
class _Refused:
    """A reading that can't be reached from a side's material, and why; the slider stays."""

    material: Material
    angle: str
    reading: float
    fault: str


@dataclass
class _Memory:
    angle: str = ANGLES_DEG[0]
    made: list[_Made] = field(default_factory=list)
    refused: _Refused | None = None
    last: dict[str, Readings] = field(default_factory=dict)  #: on display until new ones are there


_memory = plot_widgets.Kept(_Memory)


def show(model: Model, gloss_readings: GlossReadings) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("gloss")
    try:
        outcomes = {side: gloss_readings.of(model.sample(side).material) for side in SIDES}
        room = imgui.get_content_region_avail()
        if room.x < em(NARROW_EM):
            _table(model, outcomes)
            _hypothetical(model, outcomes)
            return
        if imgui.begin_child(
            "readings", ImVec2(TABLE_SHARE * room.x, room.y), imgui.ChildFlags_.nav_flattened
        ):
            _table(model, outcomes)
        imgui.end_child()
        imgui.same_line(0.0, em(1.1))
        if imgui.begin_child("hypothetical", ImVec2(0.0, room.y), imgui.ChildFlags_.nav_flattened):
            _hypothetical(model, outcomes)
        imgui.end_child()
    finally:
        imgui.pop_id()


def _table(model: Model, outcomes: dict[str, Outcome[Material, Readings] | None]) -> None:
    """Both sides' readings, one a row; those of a sample just changed are faint."""
    memory = _memory.of(model)
    rows: dict[str, dict[str, Reading]] = {}
    for side, outcome in outcomes.items():
        if outcome is not None and outcome.value is not None:
            memory.last[side] = outcome.value
        elif outcome is not None:
            memory.last.pop(side, None)
            widgets.wrapped(f"{side}: {printable(outcome.fault, 200)}", dim=True)
        for reading in memory.last.get(side, ()):
            rows.setdefault(reading.key, {})[side] = reading
    if not rows:
        widgets.wrapped("Being computed" if None in outcomes.values() else "No readings", dim=True)
        return
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop
    if not imgui.begin_table("readings", 1 + len(SIDES), flags):
        return
    for name, weight in (("Meter", 1.5), ("Reference", 1.3), ("Test", 1.0)):
        imgui.table_setup_column(name, imgui.TableColumnFlags_.none, weight)
    plot_widgets.table_headings()
    for of_side in rows.values():
        imgui.table_next_row()
        imgui.table_next_column()
        first = next(iter(of_side.values()))
        widgets.wrapped(first.name)
        widgets.tooltip(f"{widgets.sentence(first.name)}\n{first.standard}")
        for side in SIDES:
            imgui.table_next_column()
            if side in of_side:
                _cell(of_side[side], faint=outcomes[side] is None)
    imgui.end_table()


def _cell(reading: Reading, *, faint: bool) -> None:
    if reading.value is None:
        widgets.quiet("-")
        widgets.tooltip(widgets.sentence(reading.reason))
        return
    error = reading.error_words
    text = reading.words(reading.value)
    with_error = f"{text} ± {error}" if error else text
    if imgui.calc_text_size(with_error).x <= imgui.get_content_region_avail().x:
        text = with_error
    (widgets.quiet if faint else imgui.text_unformatted)(text)
    lines = [reading.standard]
    if reading.diffuse is not None:
        lines.append(f"The diffuse reflection gives {reading.words(reading.diffuse)} of it.")
    if error:
        lines.append(f"The error, ± {error}, follows from the standard errors of the fit.")
    if reading.note:
        lines.append(widgets.sentence(reading.note))
    widgets.tooltip("\n".join(lines))


def _hypothetical(model: Model, outcomes: dict[str, Outcome[Material, Readings] | None]) -> None:
    """The slider the other way round, on the active side."""
    memory = _memory.of(model)
    side = plot_widgets.side_switch(model)
    sample = model.sample(side)
    made = next((m for m in memory.made if m.material is sample.material), None)
    changed, angle = widgets.combo(
        "Angle of the meter",
        ANGLES_DEG,
        memory.angle,
        "The angle of incidence; 75° is that of paper gloss.",
        words=IN_WORDS,
    )
    if changed:
        memory.angle = angle
    refused = memory.refused
    if refused is not None:
        same = refused.material is sample.material and refused.angle == memory.angle
        refused = memory.refused = refused if same else None
    present = _present(memory, made, outcomes[side])
    if present is None:
        widgets.label(WANTED)
        widgets.quiet("being computed")
        return
    widgets.label(WANTED)
    moved, value = sliders.float_slider(f"##{WANTED}", present, 0.0, TOP_UNITS, "%.1f units")
    widgets.tooltip(
        "Shows a sample of another reading: the width of the lobe with the highest peak changes, "
        "all else stays. Ctrl+click or Enter to type a value."
    )
    if moved:
        _make(model, side, made.base if made else sample, value)
    if refused is not None:
        widgets.wrapped(f"! {refused.fault}")
    if made is not None:
        _remarks(model, side, sample, made)


def _present(
    memory: _Memory, made: _Made | None, outcome: Outcome[Material, Readings] | None
) -> float | None:
    """The slider's value: the reading that was asked for, or the material's."""
    if memory.refused is not None:
        return memory.refused.reading
    if made is not None and made.angle == memory.angle:
        return made.reading
    if outcome is None:
        return None
    key = f"gloss-{memory.angle}"
    return next((r.value or 0.0 for r in outcome.value or () if r.key == key), 0.0)


def _make(model: Model, side: str, base: Sample, reading: float) -> None:
    """Put the material of a reading on a side; the panel shows why where there is none."""
    memory = _memory.of(model)
    try:
        material = hypothetical(base.material, float(memory.angle), reading)
    except InputError as error:
        present = model.sample(side).material
        memory.refused = _Refused(present, memory.angle, reading, printable(error, 300))
        return
    memory.refused = None
    memory.made.append(_Made(material, base, memory.angle, reading))
    del memory.made[:-REMEMBERED]
    state = model.with_sample(side, Sample(material))
    model.change(state, gesture=f"{side} hypothetical")


def _remarks(model: Model, side: str, sample: Sample, made: _Made) -> None:
    """How the material was made, and buttons to keep it or go back."""
    k = main_lobe(made.base.material)
    if k is not None:
        widths = (made.base.material.specular[k].s_deg, made.material.specular[k].s_deg)
        widgets.wrapped(f"Lobe width (s) {widths[0]:.3g}° changed to {widths[1]:.3g}°")
    text = "Hypothetical: not a measured sample"
    widgets.wrapped(text if sample.file else f"{text}, and in no file yet", dim=True)
    if widgets.button(
        "Keep in a file", "writes it to a file, which scenes and commands can name",
        enabled=sample.file is None,
    ):  # fmt: skip
        model.attempt(lambda: _keep(model, side, made))
    imgui.same_line()
    if widgets.button("Go back", "brings back the sample that it was made from"):
        model.change(model.with_sample(side, made.base))


def _keep(model: Model, side: str, made: _Made) -> None:
    file = keep_material(made.material, data_folder() / "materials")
    sample = Sample(made.material, file=str(file))
    model.change(model.with_sample(side, sample))
    model.report(f"written: {file}")
