"""A BRDF around the point of incidence: receiver angle as direction, value as distance."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from imgui_bundle import ImVec2, implot

from relgloss_view.base.arrays import Array
from relgloss_view.viewer.panels import plot_widgets
from relgloss_view.viewer.plots.reflection import Points, to_polar
from relgloss_view.viewer.shell.theme import QUIET, em, gray

GRID = gray(1.0, 0.13)
SMALL_EM = 6.0  #: a smaller radius has room for few labels
RAYS_DEG = (-60.0, -30.0, 0.0, 30.0, 60.0)


@dataclass(frozen=True)
class RadialScale:
    """Distance from the centre: BRDF in 1/sr, `top` at distance 1, `foot` at 0 if logarithmic."""

    top: float
    foot: float | None = None

    def radius(self, value: Array) -> Array:
        """Distance from the centre."""
        if self.foot is None:
            return np.asarray(value / self.top)
        decades = math.log10(self.top / self.foot)
        return np.asarray(np.log10(np.maximum(value, self.foot) / self.foot) / decades)

    def rings(self) -> list[float]:
        """Values that get a circle."""
        if self.foot is None:
            return [0.5 * self.top, self.top]
        decades = round(math.log10(self.top / self.foot))
        return [self.top / 10.0**k for k in range(0, decades, 1 if decades <= 4 else 2)]


def draw(
    curves: list[plot_widgets.Curve],
    points: Points | None,
    incidence_deg: float,
    scale: RadialScale,
    width: float,
    height: float,
) -> None:
    """Draw curves, x receiver angles in degrees and y BRDF in 1/sr, into a plot of its own."""
    if not plot_widgets.begin("polar", width, height, decorated=False):
        return
    font = em(1.0)
    # The picture of a circle is round: both axes have the same units a pixel.
    inner = max(width - 0.8 * font, 1.0), max(height - 0.6 * font, 1.0)
    below, above = 1.4 * font, 1.3 * font
    unit = 1.0 / max(min(0.5 * inner[0] - 2.5 * font, inner[1] - below - above), 1.0)
    half = 0.5 * inner[0] * unit
    ends = -below * unit, (inner[1] - below) * unit
    plot_widgets.axes(("", -half, half), ("", *ends), follow=True, decorated=False)
    _grid(scale, unit)
    lamp = to_polar(np.full(2, -incidence_deg), np.array([0.0, 1.0]))
    plot_widgets.line("lamp", lamp[1], lamp[0], plot_widgets.LIMIT, weight=1.4)
    for curve in curves:
        along, across = to_polar(curve.x, scale.radius(curve.y))
        replace(curve, x=across, y=along).draw()
    if points is not None:
        along, across = to_polar(points.receiver_deg, scale.radius(points.value))
        plot_widgets.points("measured", across, along)
    plot_widgets.end()


def _grid(scale: RadialScale, unit: float) -> None:
    font = em(1.0)
    turn = np.linspace(-90.0, 90.0, 91)
    implot.push_style_color(implot.Col_.inlay_text, gray(QUIET))
    small = unit * SMALL_EM * font > 1.0
    for value in scale.rings():
        radius = float(scale.radius(np.array([value]))[0])
        along, across = to_polar(turn, np.full(len(turn), radius))
        plot_widgets.line(f"ring {value:g}", across, along, GRID, weight=1.0)
        if not small:
            implot.plot_text(f"{value:g}", radius, 0.0, ImVec2(0.0, 0.75 * font))
    if small:
        implot.plot_text(f"{scale.top:g} / sr", 1.0, 0.0, ImVec2(0.0, 0.75 * font))
    else:
        implot.plot_text("1/sr", 0.0, 0.0, ImVec2(0.0, 0.75 * font))
    for angle in RAYS_DEG:
        along, across = to_polar(np.full(2, angle), np.array([0.0, 1.0]))
        plot_widgets.line(f"ray {angle:g}", across, along, GRID, weight=1.0)
        if small and angle in (-30.0, 30.0):
            continue
        x, y = float(across[1]), float(along[1])
        away = ImVec2(1.3 * font * x, -0.7 * font * max(y, 0.5))
        implot.plot_text(f"{angle:g}°", x, y, away)
    implot.pop_style_color()
