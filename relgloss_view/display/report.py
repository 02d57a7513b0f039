"""The report of a display: tone curves, gamut and errors as plots, in a page or a picture."""

from __future__ import annotations

import io
import os
from collections.abc import Callable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from relgloss_view.base import figures, pages
from relgloss_view.base.arrays import Array
from relgloss_view.base.reading import printable
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import whole_file
from relgloss_view.display.coverage import STANDARDS, uv_of_xy
from relgloss_view.display.describe import facts
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.overview import Overview, overview_of
from relgloss_view.display.readings import Readings
from relgloss_view.material.cielab import lightness
from relgloss_view.material.spectra import observer

if TYPE_CHECKING:
    from relgloss_view.display.fit import DisplayFit

CHANNELS = (("red", "#c22f2b"), ("green", "#2c8a3d"), ("blue", "#2f5fc2"))
ON_ONE_AXIS = 1e-6  #: digital values of the other channels, of a patch on one channel's axis
GOOD_DE2000 = 1.0  #: a line in the plot: hardly anyone sees less side by side
STYLE = """
img { display: block; max-width: 100%; margin: 1rem 0; }
td.text, td { padding: .15rem 1rem .15rem 0; }
"""


def write_report(
    path: str | os.PathLike[str],
    monitor: Monitor,
    fit: DisplayFit | None = None,
    readings: Readings | None = None,
    command: str = "",
) -> None:
    """Write the report as .html or .png, whole or not at all.

    fit, readings: what the monitor comes from, or what it is compared with; its patches are drawn.
    command: the command line that makes the report again.
    """
    overview = overview_of(monitor)
    with figures.drawing():
        picture = io.BytesIO()
        figures.save_figure(_figure(monitor, overview, fit, readings), picture)  # type: ignore[arg-type]
    with whole_file(path) as temporary:
        if Path(path).suffix.lower() == ".png":
            temporary.write_bytes(picture.getvalue())
        else:
            page = _page(overview, fit, picture.getvalue(), command)
            temporary.write_text(page, encoding="utf-8")


def _page(overview: Overview, fit: DisplayFit | None, picture: bytes, command: str) -> str:
    name = printable(overview.name, 80)
    rows = [(label, words) for label, words in facts(overview)]
    rows += [("missing", f"{one.what}: {one.step}") for one in overview.missing]
    warnings = () if fit is None else fit.warnings
    notes = dict.fromkeys((*overview.notes, *(() if fit is None else fit.notes)))
    parts = [
        f"<h1>{escape(name)}</h1>",
        *(f"<p><b>{escape(text)}</b></p>" for text in warnings),
        f'<img src="{pages.embedded_png(picture)}" alt="Tone curves, gamut and errors">',
        pages.table(("", ""), rows, texts=(1,)),
        "" if fit is None else _candidates(fit),
        *(f'<p class="muted">{escape(printable(note, 600))}</p>' for note in notes),
        f'<p class="muted">relgloss {escape(__version__)}</p>',
        f"<p><code>{escape(command)}</code></p>" if command else "",
    ]
    return pages.page(name, parts, STYLE)


def _candidates(fit: DisplayFit) -> str:
    rows = [
        (
            c.name + (" (chosen)" if c.chosen else ""),
            str(c.parameters),
            f"{c.mean_de2000:.2f}",
            f"{c.excess:.3g} +- {c.excess_se:.2g}",
        )
        for c in fit.candidates
    ]
    return pages.table(("candidate", "parameters", "dE2000 of unseen patches", "excess"), rows)


def _figure(
    monitor: Monitor, overview: Overview, fit: DisplayFit | None, readings: Readings | None
) -> Any:
    plots: list[Callable[[Any], None]] = [
        lambda axes: _tone(axes, monitor, readings),
        lambda axes: _gamut(axes, overview),
    ]
    if readings is not None:
        shown = readings
        plots.append(lambda axes: _errors(axes, _differences(monitor, fit, shown)))
        plots.append(lambda axes: _sums(axes, monitor, shown))
    rows = len(plots) // 2
    figure = figures.new_figure(9.0, 3.9 * rows, 110, layout="constrained")
    for k, plot in enumerate(plots):
        plot(figure.add_subplot(rows, 2, k + 1))
    return figure


def _tone(axes: Any, monitor: Monitor, readings: Readings | None) -> None:
    """L* of each channel's light, 100 at its full light: the eye's steps, not the meter's."""
    digital = np.linspace(0.0, 1.0, 257)
    for k, (name, colour) in enumerate(CHANNELS):
        values = np.zeros((len(digital), 3))
        values[:, k] = digital
        light = np.clip(monitor.emission.light(values)[:, k], 0.0, None)
        axes.plot(digital, lightness(light), color=colour, linewidth=1.2, label=name)
        if readings is None:
            continue
        others = np.delete(readings.rgb, k, axis=1)
        on = (others <= ON_ONE_AXIS).all(axis=1) & (readings.rgb[:, k] > 0.0)
        read = _channel_light(monitor, readings)[on, k]
        axes.plot(readings.rgb[on, k], lightness(np.clip(read, 0.0, None)), ".", color=colour)
    axes.set(title="Tone curves", xlabel="digital value", ylabel="L* of the channel's light")
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 105.0))
    axes.legend()


def _channel_light(monitor: Monitor, readings: Readings) -> Array:
    """Light of the channels, 0 to 1, that readings show by the monitor's matrix."""
    rgb = _relative(monitor, readings) @ np.linalg.inv(monitor.xyz_from_rgb).T
    return np.asarray((rgb - monitor.floor) / (1.0 - monitor.floor))


def _relative(monitor: Monitor, readings: Readings) -> Array:
    """XYZ of readings relative to white, whose Y they or the monitor's luminance give."""
    if readings.absolute and monitor.luminance_cd_m2 is not None:
        return readings.xyz / monitor.luminance_cd_m2
    brightest = np.all(readings.rgb >= readings.rgb.max() - 1e-9, axis=1)
    white = float(np.median(readings.xyz[brightest, 1]))
    return readings.xyz / white if white > 0.0 else readings.xyz


def _gamut(axes: Any, overview: Overview) -> None:
    locus = observer()[:, 1:]
    locus = locus[locus.sum(axis=1) > 1e-3]
    xy = locus[:, :2] / locus.sum(axis=1, keepdims=True)
    around = uv_of_xy(np.vstack([xy, xy[:1]]))
    axes.plot(*around.T, color=figures.MUTED, linewidth=0.7)
    for (name, primaries), style in zip(STANDARDS.items(), ("--", ":", "-."), strict=True):
        corners = uv_of_xy([*primaries, primaries[0]])
        axes.plot(*corners.T, style, color=figures.MUTED, linewidth=0.9, label=name)
    own = uv_of_xy([*overview.primaries_xy, overview.primaries_xy[0]])
    axes.plot(*own.T, color=figures.ACCENT, linewidth=1.6, label="this monitor")
    axes.plot(*uv_of_xy([overview.white_xy])[0], "o", color=figures.INK, markersize=4)
    axes.annotate("white", uv_of_xy([overview.white_xy])[0], (4, 4), textcoords="offset points")
    axes.set(title="Gamut and white", xlabel="u'", ylabel="v'", aspect="equal")
    axes.set(xlim=(0.0, 0.65), ylim=(0.0, 0.62))
    axes.legend(loc="lower right")


def _differences(monitor: Monitor, fit: DisplayFit | None, readings: Readings) -> Array:
    from relgloss_view.display.few_readings import differences

    return fit.differences if fit is not None else differences(monitor, readings)


def _errors(axes: Any, differences: Array) -> None:
    order = np.sort(differences)[::-1]
    axes.bar(np.arange(1, len(order) + 1), order, width=0.9, color=figures.MUTED)
    axes.axhline(GOOD_DE2000, color=figures.ACCENT, linewidth=0.8)
    axes.set(title="Difference of each patch, largest first", xlabel="patch", ylabel="dE2000")
    axes.set(xlim=(0.4, len(order) + 0.6), ylim=(0.0, max(1.2 * GOOD_DE2000, 1.05 * order[0])))


def _sums(axes: Any, monitor: Monitor, readings: Readings) -> None:
    """Luminance that was read over what the sum of the channels gives: 1 where they add."""
    expected = monitor.xyz(readings.rgb)[:, 1]
    read = _relative(monitor, readings)[:, 1]
    bright = expected > 0.02
    mixed = (readings.rgb > ON_ONE_AXIS).sum(axis=1) > 1
    axes.axhline(1.0, color=figures.FAINT, linewidth=1.0)
    for chosen, colour, label in (
        (bright & mixed, figures.ACCENT, "two or three channels"),
        (bright & ~mixed, figures.MUTED, "one channel"),
    ):
        axes.plot(expected[chosen], (read / np.maximum(expected, 1e-9))[chosen], ".",
                  color=colour, label=label)  # fmt: skip
    axes.set(title="Whether channels add", xlabel="luminance by the model, white 1")
    axes.set(ylabel="read / model", xlim=(0.0, 1.05))
    axes.legend()
