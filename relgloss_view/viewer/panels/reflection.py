"""A material's BRDF in the plane of incidence, with what was measured, and its albedo."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from imgui_bundle import imgui, implot

from relgloss_view.base.errors import RelglossError
from relgloss_view.measure.table import Measurement
from relgloss_view.viewer.panels import plots, polar
from relgloss_view.viewer.plots import reflection
from relgloss_view.viewer.plots.reflection import Albedo, Points, Slice
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model

NARROW_EM = 28.0  #: below this width the plots lie in tabs
#: 1/sr, the foot of a logarithmic plot: a black of 0.3 %.
FAINTEST = 1e-3
SNAP_DEG = 1.5  #: an incidence this near to a measured one becomes it


@dataclass
class _Memory:
    incidence_deg: float = 45.0
    polar: bool = False
    logarithmic: bool = True
    top: dict[tuple[bool, bool], float] = field(default_factory=dict)
    held: bool = False  #: whether the incidence is being dragged
    albedo: dict[str, Albedo] = field(default_factory=dict)  #: of each side, the last
    measurement: Measurement | None = None  #: whose points were shown last


@dataclass(frozen=True)
class _Curves:
    cut: Slice
    albedo: Albedo | None
    points: Points | None = None
    blurred: Points | None = None


_memory = plots.Kept(_Memory)


def show(model: Model) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("reflection")
    try:
        _show(model)
    finally:
        imgui.pop_id()


def _show(model: Model) -> None:
    memory = _memory.of(model)
    side = plots.side_switch(model)
    measurement = _measurement(model, side)
    _controls(memory, measurement)
    try:
        shown = _curves(model, side, memory.incidence_deg)
        beside = _curves(model, plots.other(side), memory.incidence_deg)
    except RelglossError as error:
        widgets.wrapped(str(error), dim=True)
        return
    _legend(side, shown)
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):
        _in_tabs(memory, shown, beside, room.x)
        return
    left = 0.62 * room.x
    _slice_plot(memory, shown, beside, left, room.y)
    imgui.same_line(0.0, 0.0)
    _albedo_plot(memory, shown, beside, room.x - left, room.y)


def _in_tabs(memory: _Memory, shown: _Curves, beside: _Curves, width: float) -> None:
    if not imgui.begin_tab_bar("plots"):
        return
    if imgui.begin_tab_item("BRDF")[0]:
        _slice_plot(memory, shown, beside, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    if imgui.begin_tab_item("albedo")[0]:
        _albedo_plot(memory, shown, beside, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    imgui.end_tab_bar()


def _measurement(model: Model, side: str) -> Measurement | None:
    table = model.state.side(side).sample.table
    return None if table is None else model.measurements.get(table)


def _curves(model: Model, side: str, incidence_deg: float) -> _Curves:
    scene = model.state.scene(side)
    material, lamp = scene.material, scene.lamp.illuminant
    cut = reflection.brdf_slice(material, lamp, incidence_deg)
    memory = _memory.of(model)
    albedo = reflection.albedo_curve(material, lamp, wait=not model.dragging)
    if albedo is None:  # a material that a hand is changing: its last albedo stands for it
        albedo = memory.albedo.get(side)
    else:
        memory.albedo[side] = albedo
    measurement = _measurement(model, side)
    if measurement is None:
        return _Curves(cut, albedo)
    points = reflection.measured_points(measurement, lamp, incidence_deg)
    if points is None:
        return _Curves(cut, albedo)
    aperture = measurement.aperture_sd_deg
    blurred = reflection.seen_through_apertures(material, lamp, incidence_deg, aperture)
    return _Curves(cut, albedo, points, blurred)


def _controls(memory: _Memory, measurement: Measurement | None) -> None:
    measured = None if measurement is None else reflection.measured_incidences(measurement)
    if measurement is not memory.measurement:
        memory.measurement = measurement
        if measured is not None and len(measured):
            memory.incidence_deg = _nearest(measured, memory.incidence_deg)
    plots.beside(em(9))
    imgui.set_next_item_width(em(9))
    changed, angle = imgui.slider_float(
        "##incidence", memory.incidence_deg, 0.0, reflection.STEEPEST_DEG, "incidence %.0f deg"
    )
    memory.held = imgui.is_item_active()
    if changed:
        angle = round(min(max(angle, 0.0), reflection.STEEPEST_DEG))
        if measured is not None and len(measured):
            nearest = _nearest(measured, angle)
            angle = nearest if abs(nearest - angle) <= SNAP_DEG else angle
        memory.incidence_deg = float(angle)
    if widgets.reset_by_double_click():
        memory.incidence_deg = 45.0
    told = "Angle between the lamp and the normal. Ctrl-click types it, a double click resets it."
    if measured is not None and len(measured):
        angles = ", ".join(f"{a:g}" for a in measured)
        told += f" Measured at {angles} deg, where it holds on."
    widgets.tooltip(told)
    plots.beside(plots.checkbox_width("polar"), 0.5)
    _, memory.polar = imgui.checkbox("polar", memory.polar)
    widgets.tooltip("Draw the BRDF around the point of incidence instead of against the angle.")
    plots.beside(plots.checkbox_width("log"), 0.5)
    _, memory.logarithmic = imgui.checkbox("log", memory.logarithmic)
    widgets.tooltip("A logarithmic scale, which shows the diffuse part beside a narrow lobe.")


def _nearest(measured: plots.Array, angle: float) -> float:
    return float(measured[np.argmin(np.abs(measured - angle))])


def _legend(side: str, shown: _Curves) -> None:
    entries = [
        ("total", plots.TOTAL),
        ("diffuse", plots.DIFFUSE),
        ("specular", plots.SPECULAR),
    ]
    if shown.blurred is not None:
        entries.append(("through its apertures", plots.PLAIN))
    if shown.points is not None:
        entries.append(("measured", plots.POINTS))
    entries.append((plots.other(side), plots.OTHER))
    plots.legend(entries)


def _top(memory: _Memory, shown: _Curves, beside: _Curves) -> float:
    """The end of the scale; while the hand drags the incidence it only grows.

    A linear scale is this side's: a glossier other side would leave nothing of it to see.
    """
    parts = [shown.cut.total, *([beside.cut.total] if memory.logarithmic else [])]
    if shown.points is not None:
        parts.append(shown.points.value)
    peak = max(float(np.max(p)) for p in parts)
    if memory.logarithmic:
        top = max(10.0 ** np.ceil(np.log10(max(1.05 * peak, 1e-12))), 1.0)
    else:
        top = plots.nice_ceiling(peak)
    key = (memory.polar, memory.logarithmic)
    if memory.held:
        top = max(top, memory.top.get(key, top))
    memory.top[key] = float(top)
    return float(top)


def _slice_plot(
    memory: _Memory, shown: _Curves, beside: _Curves, width: float, height: float
) -> None:
    top = _top(memory, shown, beside)
    if memory.polar:
        scale = polar.Scale(top, FAINTEST if memory.logarithmic else None)
        polar.draw(_parts(shown, beside), shown.points, memory.incidence_deg, scale, width, height)
        return
    if plots.begin("brdf", width, height):
        foot = FAINTEST if memory.logarithmic else 0.0
        low = plots.axes(
            ("receiver (deg), mirror side positive", -90.0, 90.0),
            ("BRDF (1/sr)", foot, top),
            follow=True,
        )
        if memory.logarithmic:
            implot.setup_axis_scale(implot.ImAxis_.y1, implot.Scale_.log10)
        implot.setup_axis_ticks(implot.ImAxis_.x1, [-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0])
        plots.level("perfect diffuser", 1.0 / np.pi)
        for curve in _parts(shown, beside):
            curve.draw()
        if shown.points is not None:
            plots.points("measured", shown.points.receiver_deg, shown.points.value)
        if low:
            plots.label_inside("1/sr, deg")
        plots.end()


def _parts(shown: _Curves, beside: _Curves) -> list[plots.Curve]:
    """The curves of a slice, the one that matters most last."""
    cut, far = shown.cut, beside.cut
    parts = [plots.Curve("other side", far.receiver_deg, far.total, plots.OTHER, faint=True)]
    if np.any(cut.specular):
        for title, y, colour in (
            ("specular", cut.specular, plots.SPECULAR),
            ("diffuse", cut.diffuse, plots.DIFFUSE),
        ):
            parts.append(plots.Curve(title, cut.receiver_deg, y, colour, 1.2))
    if shown.blurred is not None:
        seen = shown.blurred
        parts.append(plots.Curve("apertures", seen.receiver_deg, seen.value, plots.PLAIN))
    return [*parts, plots.Curve("total", cut.receiver_deg, cut.total, plots.TOTAL)]


def _albedo_plot(
    memory: _Memory, shown: _Curves, beside: _Curves, width: float, height: float
) -> None:
    if plots.begin("albedo", width, height):
        known = [c.albedo for c in (shown, beside) if c.albedo is not None]
        peak = max([float(np.max(albedo.total)) for albedo in known], default=0.0)
        top = 1.05 if peak <= 1.05 else plots.nice_ceiling(peak)
        low = plots.axes(("incidence (deg)", 0.0, 90.0), ("albedo", 0.0, top), follow=True)
        implot.setup_axis_ticks(implot.ImAxis_.x1, [0.0, 30.0, 60.0, 90.0])
        plots.level("incidence", memory.incidence_deg, across=False)
        if beside.albedo is not None:
            far = beside.albedo
            plots.line("other side", far.incidence_deg, far.total, plots.OTHER, faint=True)
        if shown.albedo is not None:
            _draw_albedo(shown.albedo)
        if low:
            plots.label_inside("albedo, deg")
        plots.end()


def _draw_albedo(albedo: Albedo) -> None:
    angle = albedo.incidence_deg
    if np.any(albedo.specular):
        plots.line("specular", angle, albedo.specular, plots.SPECULAR, weight=1.2)
        plots.line("diffuse", angle, albedo.diffuse, plots.DIFFUSE, weight=1.2)
    plots.line("total", angle, albedo.total, plots.TOTAL)
