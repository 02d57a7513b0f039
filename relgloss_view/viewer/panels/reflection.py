"""A material's BRDF in the plane of incidence, with measured points, and its albedo."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from imgui_bundle import imgui, implot

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import RelglossError
from relgloss_view.measure.table import Measurement
from relgloss_view.viewer.panels import plot_widgets, polar
from relgloss_view.viewer.plots import reflection
from relgloss_view.viewer.plots.reflection import Albedo, Points, Slice
from relgloss_view.viewer.shell import sliders, widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model

NARROW_EM = 28.0  #: below this width the plots lie in tabs
#: 1/sr, the foot of a logarithmic plot: a black of 0.3 %.
FAINTEST = 1e-3
SNAP_DEG = 1.5  #: an incidence this near to a measured one becomes it
MOST_LISTED = 16  #: angles of a table, in the explanation of the slider


@dataclass
class _Memory:
    incidence_deg: float = 45.0
    polar: bool = False
    logarithmic: bool = True
    top: dict[tuple[bool, bool], float] = field(default_factory=dict)
    held: bool = False  #: whether the incidence is being dragged
    albedo: dict[str, Albedo] = field(default_factory=dict)  #: of each side, the last
    measurement: Measurement | None = None  #: whose points were curves last


@dataclass(frozen=True)
class _Curves:
    cut: Slice
    albedo: Albedo | None
    points: Points | None = None
    blurred: Points | None = None


_memory = plot_widgets.Kept(_Memory)


def show(model: Model) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("reflection")
    try:
        _show(model)
    finally:
        imgui.pop_id()


def _show(model: Model) -> None:
    memory = _memory.of(model)
    side = plot_widgets.side_switch(model)
    measurement = _measurement(model, side)
    _controls(memory, measurement)
    try:
        curves = _curves(model, side, memory.incidence_deg)
        beside = _curves(model, plot_widgets.other(side), memory.incidence_deg)
    except RelglossError as error:
        widgets.wrapped(str(error), dim=True)
        return
    _legend(side, curves)
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):
        _in_tabs(memory, curves, beside, room.x)
        return
    left = 0.62 * room.x
    _slice_plot(memory, curves, beside, left, room.y)
    imgui.same_line(0.0, 0.0)
    _albedo_plot(memory, curves, beside, room.x - left, room.y)


def _in_tabs(memory: _Memory, curves: _Curves, beside: _Curves, width: float) -> None:
    if not imgui.begin_tab_bar("plots"):
        return
    if imgui.begin_tab_item("Reflection (BRDF)")[0]:
        _slice_plot(memory, curves, beside, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    if imgui.begin_tab_item("Reflectance (albedo)")[0]:
        _albedo_plot(memory, curves, beside, width, imgui.get_content_region_avail().y)
        imgui.end_tab_item()
    imgui.end_tab_bar()


def _measurement(model: Model, side: str) -> Measurement | None:
    table = model.state.side(side).sample.table
    return None if table is None else model.measurements.get(table)


def _curves(model: Model, side: str, incidence_deg: float) -> _Curves:
    scene = model.state.scene(side)
    material, lamp = model.sample(side).material, scene.lamp.illuminant
    cut = reflection.brdf_slice(material, lamp, incidence_deg)
    memory = _memory.of(model)
    albedo = reflection.albedo_curve(material, lamp, wait=not model.dragging)
    if albedo is None:  # a hand is changing the material: show its last albedo
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
    plot_widgets.beside(em(9))
    imgui.set_next_item_width(em(9))
    changed, angle = sliders.float_slider(
        "##incidence", memory.incidence_deg, 0.0, reflection.STEEPEST_DEG, "incidence %.0f deg"
    )
    memory.held = imgui.is_item_active()
    if changed:
        angle = round(min(max(angle, 0.0), reflection.STEEPEST_DEG))
        if measured is not None and len(measured):
            nearest = _nearest(measured, angle)
            angle = nearest if abs(nearest - angle) <= SNAP_DEG else angle
        memory.incidence_deg = float(angle)
    if sliders.resetting():
        memory.incidence_deg = 45.0
    meaning = f"Angle between the lamp and the normal. {sliders.HOW}"
    if measured is not None and len(measured):
        angles = ", ".join(f"{a:g}" for a in measured)
        if len(measured) > MOST_LISTED:
            angles = f"{len(measured)} angles from {measured[0]:g} to {measured[-1]:g}"
        meaning += f" Measured at {angles} deg; the slider snaps to these."
    widgets.tooltip(meaning)
    plot_widgets.beside(plot_widgets.checkbox_width("Polar"), 0.5)
    _, memory.polar = imgui.checkbox("Polar", memory.polar)
    widgets.tooltip("Plots the BRDF around the point of incidence instead of against the angle.")
    plot_widgets.beside(plot_widgets.checkbox_width("Log"), 0.5)
    _, memory.logarithmic = imgui.checkbox("Log", memory.logarithmic)
    widgets.tooltip("A logarithmic scale shows the diffuse part beside a narrow lobe.")


def _nearest(measured: Array, angle: float) -> float:
    return float(measured[np.argmin(np.abs(measured - angle))])


def _legend(side: str, curves: _Curves) -> None:
    entries = [
        ("total", plot_widgets.TOTAL),
        ("diffuse", plot_widgets.DIFFUSE),
        ("specular", plot_widgets.SPECULAR),
    ]
    if curves.blurred is not None:
        entries.append(("through the instrument's apertures", plot_widgets.PLAIN))
    if curves.points is not None:
        entries.append(("measured", plot_widgets.POINTS))
    entries.append((plot_widgets.other(side), plot_widgets.OTHER))
    plot_widgets.legend(entries)


def _top(memory: _Memory, curves: _Curves, beside: _Curves) -> float:
    """The end of the scale; while the hand drags the incidence it only grows.

    A linear scale is this side's: a glossier other side would leave nothing of it to see.
    """
    parts = [curves.cut.total, *([beside.cut.total] if memory.logarithmic else [])]
    if curves.points is not None:
        parts.append(curves.points.value)
    peak = max(float(np.max(p)) for p in parts)
    if memory.logarithmic:
        top = max(10.0 ** np.ceil(np.log10(max(1.05 * peak, 1e-12))), 1.0)
    else:
        top = plot_widgets.nice_ceiling(peak)
    key = (memory.polar, memory.logarithmic)
    if memory.held:
        top = max(top, memory.top.get(key, top))
    memory.top[key] = float(top)
    return float(top)


def _slice_plot(
    memory: _Memory, curves: _Curves, beside: _Curves, width: float, height: float
) -> None:
    top = _top(memory, curves, beside)
    if memory.polar:
        scale = polar.RadialScale(top, FAINTEST if memory.logarithmic else None)
        polar.draw(
            _parts(curves, beside), curves.points, memory.incidence_deg, scale, width, height
        )
        return
    if plot_widgets.begin("brdf", width, height):
        foot = FAINTEST if memory.logarithmic else 0.0
        low = plot_widgets.axes(
            ("receiver angle (deg), mirror side positive", -90.0, 90.0),
            ("reflection (BRDF, 1/sr)", foot, top),
            follow=True,
        )
        if memory.logarithmic:
            implot.setup_axis_scale(implot.ImAxis_.y1, implot.Scale_.log10)
        implot.setup_axis_ticks(implot.ImAxis_.x1, [-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0])
        plot_widgets.level("perfect diffuser", 1.0 / np.pi)
        for curve in _parts(curves, beside):
            curve.draw()
        if curves.points is not None:
            plot_widgets.points("measured", curves.points.receiver_deg, curves.points.value)
        if low:
            plot_widgets.label_inside("1/sr by angle")
        plot_widgets.end()


def _parts(curves: _Curves, beside: _Curves) -> list[plot_widgets.Curve]:
    """The curves of a slice, the one that matters most last."""
    cut, far = curves.cut, beside.cut
    parts = [
        plot_widgets.Curve(
            "other side", far.receiver_deg, far.total, plot_widgets.OTHER, faint=True
        )
    ]
    if np.any(cut.specular):
        for title, y, colour in (
            ("specular", cut.specular, plot_widgets.SPECULAR),
            ("diffuse", cut.diffuse, plot_widgets.DIFFUSE),
        ):
            parts.append(plot_widgets.Curve(title, cut.receiver_deg, y, colour, 1.2))
    if curves.blurred is not None:
        blurred = curves.blurred
        parts.append(
            plot_widgets.Curve("apertures", blurred.receiver_deg, blurred.value, plot_widgets.PLAIN)
        )
    return [*parts, plot_widgets.Curve("total", cut.receiver_deg, cut.total, plot_widgets.TOTAL)]


def _albedo_plot(
    memory: _Memory, curves: _Curves, beside: _Curves, width: float, height: float
) -> None:
    if plot_widgets.begin("albedo", width, height):
        albedos = [c.albedo for c in (curves, beside) if c.albedo is not None]
        peak = max([float(np.max(albedo.total)) for albedo in albedos], default=0.0)
        top = 1.05 if peak <= 1.05 else plot_widgets.nice_ceiling(peak)
        low = plot_widgets.axes(
            ("incidence (deg)", 0.0, 90.0), ("reflectance (albedo)", 0.0, top), follow=True
        )
        implot.setup_axis_ticks(implot.ImAxis_.x1, [0.0, 30.0, 60.0, 90.0])
        plot_widgets.level("incidence", memory.incidence_deg, across=False)
        if beside.albedo is not None:
            far = beside.albedo
            plot_widgets.line(
                "other side", far.incidence_deg, far.total, plot_widgets.OTHER, faint=True
            )
        if curves.albedo is not None:
            _draw_albedo(curves.albedo)
        if low:
            plot_widgets.label_inside("albedo by angle")
        plot_widgets.end()


def _draw_albedo(albedo: Albedo) -> None:
    angle = albedo.incidence_deg
    if np.any(albedo.specular):
        plot_widgets.line("specular", angle, albedo.specular, plot_widgets.SPECULAR, weight=1.2)
        plot_widgets.line("diffuse", angle, albedo.diffuse, plot_widgets.DIFFUSE, weight=1.2)
    plot_widgets.line("total", angle, albedo.total, plot_widgets.TOTAL)
