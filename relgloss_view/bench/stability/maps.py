"""Maps of where methods fail: each subject is an error over two numbers that a scene may have.

The errors are those of model_errors.py and grain_errors.py; the domains of quality/domains.py are
read off these maps, and tests hold them against each other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.bench.stability import grain_errors, model_errors
from relgloss_view.quality.domains import DOMAINS, FOOT_SD, Domain

Error = Callable[[moderngl.Context, Array, Array], Array]
Numbers = Mapping[str, Array]


@dataclass(frozen=True)
class Axis:
    """One number that a scene may have."""

    label: str
    values: tuple[float, ...]  #: of the full map
    log: bool = False

    def coarse(self, count: int) -> tuple[float, ...]:
        """So many of the values, both ends among them."""
        places = np.linspace(0, len(self.values) - 1, count).round().astype(int)
        return tuple(self.values[k] for k in places)


@dataclass(frozen=True)
class Subject:
    """What a map shows: `key` names the domain that is read off it, if one is."""

    name: str
    page: str
    title: str
    x: Axis
    y: Axis
    error: Error  #: of cells x, y
    numbers: Callable[[Array, Array], Numbers]  #: the domains' quantities in the cells
    key: tuple[str, str] | None = None
    unit: str = "share of the peak"
    is_error: bool = True

    @property
    def domain(self) -> Domain | None:
        """Where the choice is declared to hold."""
        return DOMAINS[self.key] if self.key else None

    def inside(self, x: Array, y: Array) -> Mask:
        """Which cells lie in the domain."""
        x, y = np.broadcast_arrays(x, y)
        numbers = {name: np.broadcast_to(v, x.shape) for name, v in self.numbers(x, y).items()}
        inside = np.zeros(x.shape, dtype=bool)
        if self.domain is None:
            return ~inside
        for cell in np.ndindex(x.shape):
            inside[cell] = self.domain.holds(
                _Given({name: (float(v[cell]), float(v[cell])) for name, v in numbers.items()})
            )
        return inside


class _Given(dict[str, tuple[float, float]]):
    """Quantities of a cell; those that its map says nothing about are inside any box."""

    def __missing__(self, name: str) -> tuple[float, float]:
        return np.inf, -np.inf


@dataclass(frozen=True)
class Map:
    """A subject, computed: rows are y, columns x; what is not finite failed."""

    subject: Subject
    x: Array
    y: Array
    error: Array
    inside: Mask


def computed(ctx: moderngl.Context, subject: Subject, count: int | None = None) -> Map:
    """The map of a subject, at all its values or at `count` along each side."""
    x, y = (
        np.array(axis.values if count is None else axis.coarse(count))
        for axis in (subject.x, subject.y)
    )
    across, down = np.meshgrid(x, y)
    with np.errstate(all="ignore"):
        error = subject.error(ctx, across, down)
    return Map(subject, x, y, np.asarray(error, dtype=np.float64), subject.inside(across, down))


def _steps(low: float, high: float, count: int) -> tuple[float, ...]:
    return tuple(np.geomspace(low, high, count).tolist())


GRAZING = (86.0, 87.0, 88.0, 88.5, 89.0, 89.5, 89.9)
WIDTHS = Axis("lobe width s, degrees", _steps(0.01, 40.0, 49), log=True)
INCIDENCES = Axis(
    "half the angle between lamp and eye, degrees", (*np.arange(0.0, 85.1, 2.5).tolist(), *GRAZING)
)
ROUGHNESSES = Axis("roughness sigma, degrees", (0.0, *_steps(0.5, 57.0, 40)))
DRAWN_WIDTHS = Axis("lobe width s, degrees", _steps(0.05, 40.0, 14), log=True)
RATIOS = Axis("grain sigma_N over lobe width s", _steps(0.01, 5.0, 14), log=True)
ANGLES = Axis(
    "lamp's direction turns over the object by, degrees", _steps(0.001, 20.0, 41), log=True
)
SPECULAR_Y = Axis("Y of the specular part", _steps(1e-9, 1e6, 46), log=True)
DIFFUSE_Y = Axis("Y of the diffuse part", _steps(1e-9, 1.0, 28), log=True)


def _lobe_numbers(s: Array, incidence: Array) -> Numbers:
    foot = incidence + FOOT_SD * s
    return {"s_deg": s, "incidence_deg": incidence, "foot_deg": foot}


def _lobe(name: str, title: str, key: tuple[str, str], **parts: str) -> Subject:
    def error(ctx: moderngl.Context, s: Array, incidence: Array) -> Array:
        return model_errors.lobe_error(ctx, s, incidence, **parts)

    return Subject(
        name=name,
        page="lobe",
        title=title,
        x=WIDTHS,
        y=INCIDENCES,
        error=error,
        numbers=_lobe_numbers,
        key=key,
    )


def _diffuse(model: str, title: str, key: tuple[str, str] | None) -> Subject:
    def error(ctx: moderngl.Context, sigma: Array, incidence: Array) -> Array:
        return model_errors.diffuse_error(ctx, sigma, incidence, model)

    def numbers(sigma: Array, incidence: Array) -> Numbers:
        return {"sigma_deg": sigma, "incidence_deg": incidence}

    unit = "share of the largest"
    return Subject(
        name=f"diffuse-{model}",
        page="diffuse",
        title=title,
        x=ROUGHNESSES,
        y=INCIDENCES,
        error=error,
        numbers=numbers,
        key=key,
        unit=unit,
    )


def grain(kind: str, incidence: float) -> Subject:
    """The map of grain drawn as its "mean", or of "none" drawn, at one angle."""

    def error(ctx: moderngl.Context, s: Array, ratio: Array) -> Array:
        mean, single = grain_errors.grain_errors(ctx, s, ratio, incidence)
        return mean if kind == "mean" else single

    def numbers(s: Array, ratio: Array) -> Numbers:
        angle = np.full(s.shape, incidence)
        return {**_lobe_numbers(s, angle), "grain_ratio": ratio, "sigma_n_deg": s * ratio}

    said = {"mean": "Grain as the mean of its lobe", "none": "Grain left out (rms)"}[kind]
    name, title = f"grain-{kind}-{incidence:.0f}", f"{said}, {incidence:.0f} degrees"
    return Subject(
        name=name,
        page="grain",
        title=title,
        x=DRAWN_WIDTHS,
        y=RATIOS,
        error=error,
        numbers=numbers,
        key=("noise", kind),
        unit=GRAIN_UNIT,
    )


GRAIN_UNIT = "share of the mean's peak"


def _distant(ctx: moderngl.Context, s: Array, angle: Array) -> Array:
    return grain_errors.distant_error(s, angle)


def _distant_numbers(s: Array, angle: Array) -> Numbers:
    return {"lamp_angle_deg": angle, "lamp_turn": 0.5 * angle / s}


def _tone(root: str, targets: str, title: str) -> Subject:
    def numbers(specular: Array, diffuse: Array) -> Numbers:
        return {"peak_y": specular}

    def error(ctx: moderngl.Context, specular: Array, diffuse: Array) -> Array:
        return model_errors.tone_error(ctx, specular, diffuse, cube_root=root, targets=targets)

    name, key = f"tone-{root}-{targets}", ("targets", targets)
    return Subject(
        name=name,
        page="tone",
        title=title,
        x=SPECULAR_Y,
        y=DIFFUSE_Y,
        error=error,
        numbers=numbers,
        key=key,
        unit="L*, a* or b*",
    )


def _eq4(ctx: moderngl.Context, s: Array, incidence: Array) -> Array:
    return grain_errors.c_max_error(s, incidence)


def _peak(ctx: moderngl.Context, s: Array, incidence: Array) -> Array:
    return model_errors.peak_y(s, incidence)


#: Everything that is mapped, page by page.
SUBJECTS: tuple[Subject, ...] = (
    _lobe("float32", "As it is drawn (float32)", ("facets", "gaussian")),
    _lobe("schlick", "Fresnel by Schlick", ("fresnel", "schlick"), fresnel="schlick"),
    _lobe("constant", "Fresnel constant", ("fresnel", "constant"), fresnel="constant"),
    _lobe("unshadowed", "No shadowing (G = 1)", ("shadowing", "none"), shadowing="none"),
    _lobe("beckmann", "Facets by Beckmann", ("facets", "beckmann"), facets="beckmann"),
    _lobe("ggx", "Facets by GGX", ("facets", "ggx"), facets="ggx"),
    _diffuse("oren-nayar", "Full Oren-Nayar (float32)", None),
    _diffuse("eon", "EON, r = sigma", ("diffuse", "eon")),
    _diffuse("qualitative", "Qualitative Oren-Nayar", ("diffuse", "qualitative")),
    _diffuse("lambert", "Lambert", ("diffuse", "lambert")),
    grain("mean", 0.0),
    grain("mean", 45.0),
    grain("mean", 70.0),
    grain("none", 0.0),
    grain("none", 70.0),
    Subject(
        name="distant",
        page="grain",
        title="Lamp far off, 30 degrees",
        x=DRAWN_WIDTHS,
        y=ANGLES,
        error=_distant,
        numbers=_distant_numbers,
        key=("lamp", "distant"),
    ),
    _tone("householder", "float32", "Cube root by two steps, float32"),
    _tone("power", "float32", "Cube root by pow, float32"),
    _tone("table", "float32", "Cube root by table, float32"),
    _tone("householder", "float16", "Targets of 16 bits"),
    Subject(
        name="eq4",
        page="tone",
        title="c_max at the brightest pixel, eq. 4",
        x=WIDTHS,
        y=INCIDENCES,
        error=_eq4,
        numbers=_lobe_numbers,
        key=("c_max", "eq4"),
        unit="share of c_max",
    ),
    Subject(
        name="peak",
        page="tone",
        title="How bright a lobe of strength 1 is",
        x=WIDTHS,
        y=INCIDENCES,
        error=_peak,
        numbers=_lobe_numbers,
        key=None,
        unit="Y relative to the white; thick: what 16 bits hold",
        is_error=False,
    ),
)


def all_maps(
    ctx: moderngl.Context,
    progress: ProgressReport = no_progress,
    count: int | None = None,
) -> list[Map]:
    """Every map; `progress(share, text)` is called between them."""
    found = []
    for k, subject in enumerate(SUBJECTS):
        progress(k / len(SUBJECTS), subject.title)
        found.append(computed(ctx, subject, count))
    return found


def as_json(maps: list[Map]) -> list[dict[str, Any]]:
    """The maps as plain numbers; None where the error is not finite."""
    return [
        {
            "name": m.subject.name,
            "title": m.subject.title,
            "unit": m.subject.unit,
            "domain": " ".join(m.subject.key) if m.subject.key else None,
            "bound": m.subject.domain.bound if m.subject.domain else None,
            "x": {"label": m.subject.x.label, "values": m.x.tolist()},
            "y": {"label": m.subject.y.label, "values": m.y.tolist()},
            "error": [[_plain(v) for v in row] for row in m.error],
            "inside": m.inside.tolist(),
        }
        for m in maps
    ]


def _plain(value: float) -> float | None:
    return float(f"{value:.4g}") if np.isfinite(value) else None
