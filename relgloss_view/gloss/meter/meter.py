"""What a gloss meter would read on a material, and the lobe width that gives a wanted reading.

Readings are luminous: spectra are weighted with CIE illuminant C and V(lambda), as gloss meters
are. Definitions, apertures, sources and limits are in docs/gloss.md.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.gloss.meter.geometry import (
    DISTINCTNESS,
    HAZE,
    SPECULAR,
    Meter,
    Window,
)
from relgloss_view.gloss.meter.shares import Shares
from relgloss_view.gloss.meter.uncertainty import fitted_steps, standard_error
from relgloss_view.material import brdf, spectra
from relgloss_view.material.material import S_DEG_DRAWN, S_DEG_MAX, Lobe, Material
from relgloss_view.measure.bands import Bands

ILLUMINANT = "C"
METERS = (*SPECULAR.values(), HAZE, DISTINCTNESS)
FERWERDA = "Pellacini, Ferwerda, Greenberg 2000"
#: Decimals that an instrument shows: a tenth of a gloss unit, which is finer than meters repeat
#: (ISO 2813, ASTM D523); of numbers without a unit, as Pellacini et al. 2000 print them.
DECIMALS, BARE_DECIMALS = 1, 3
LONGEST_REASON = 200  #: characters of a file's text
#: Widths at which a reading is looked at before its root is refined.
WIDTHS_TRIED = 33


@dataclass(frozen=True)
class Reading:
    """One number that an instrument or a formula gives, or why it gives none."""

    key: str
    name: str
    standard: str
    value: float | None
    #: What the fit's standard errors imply for it; None where the fit gives none.
    standard_error: float | None = None
    #: The part of the value that the diffuse reflection gives; None where it is no sum of parts.
    diffuse: float | None = None
    reason: str = ""  #: why there is no value
    note: str = ""  #: what to know about the value

    @property
    def decimals(self) -> int:
        """How many decimals are shown of it; the value itself has all."""
        return BARE_DECIMALS if self.standard == FERWERDA else DECIMALS

    def words(self, number: float | None) -> str:
        """A number of this reading, its value or its part, with the digits that a meter shows.

        >>> Reading("gloss-60", "specular gloss, 60 deg", "ISO 2813", 30.0642).words(30.0642)
        '30.1'
        """
        return "" if number is None else f"{number:.{self.decimals}f}"

    @property
    def error_words(self) -> str:
        """The standard error in the same digits, rounded up so that it is never 0."""
        if self.standard_error is None:
            return ""
        step = 10.0**-self.decimals
        return self.words(step * max(float(np.ceil(self.standard_error / step - 1e-9)), 1.0))


def gloss_readings(material: Material) -> tuple[Reading, ...]:
    """Specular gloss at 20, 60, 85 and 75 degrees, haze, distinctness, Ferwerda's c and d.

    Returns one Reading for each: gloss and haze in gloss units (100: the standard's black glass),
    distinctness of image 0 to 100, c and d without unit. A reading without a value holds the
    reason. Raises InputError where the material's fit holds standard errors that are no numbers.

    Sources: ISO 2813 and ASTM D523 (20, 60, 85 degrees), TAPPI T 480 (75), Pellacini, Ferwerda and
    Greenberg 2000 (c, d); apertures and limits in docs/gloss.md.

    >>> from relgloss_view import load_sample
    >>> readings = {r.key: r.value for r in gloss_readings(load_sample("art-coated"))}
    >>> round(readings["gloss-60"], 1), round(readings["contrast-gloss"], 3)
    (30.3, 0.048)
    """
    steps, folds = fitted_steps(material), _Folds()

    def read(
        key: str, name: str, standard: str, number_of: Callable[[Material], float | None], why: str
    ) -> Reading:
        value = number_of(material)
        if value is None:
            return Reading(key, name, standard, None, reason=why)
        return Reading(key, name, standard, value, standard_error(number_of, steps))

    body = dataclasses.replace(material, specular=())

    def metered(meter: Meter) -> Reading:
        reading = read(
            meter.key,
            meter.name,
            meter.standard,
            lambda varied: _metered(varied, meter, folds),
            "nothing is reflected there",
        )
        if meter is DISTINCTNESS:
            return reading
        note = _unchecked(material, meter)
        return dataclasses.replace(reading, diffuse=_metered(body, meter, folds), note=note)

    no_lobe = "there is no specular lobe"
    return (
        *(metered(meter) for meter in METERS),
        read("contrast-gloss", "contrast gloss c", FERWERDA, lambda m: _contrast(m, folds), ""),
        read("distinctness", "distinctness d", FERWERDA, _sharpness, no_lobe),
    )


def _unchecked(material: Material, meter: Meter) -> str:
    """Why a fit's reading could not be held against its table; '' where it was, or has no table."""
    rows = material.fit.judgement.get("gloss") if material.fit else None
    for row in rows if isinstance(rows, list | tuple) else ():
        known = isinstance(row, dict) and row.get("angle_deg") == meter.angle_deg
        if known and row.get("fit") is None and isinstance(row.get("reason"), str):
            return f"not checked: {printable(row['reason'], LONGEST_REASON)}"
    return ""


def specular_gloss(material: Material, angle_deg: float) -> float:
    """Reading at 20, 60, 85 (ISO 2813, ASTM D523) or 75 degrees (TAPPI T 480), in gloss units."""
    value = _metered(material, meter_at(angle_deg), _Folds())
    assert value is not None  # only distinctness can be undefined
    return value


def meter_at(angle_deg: float) -> Meter:
    """The specular meter of an angle; InputError where no standard here has one."""
    for angle, meter in SPECULAR.items():
        if angle == angle_deg:
            return meter
    angles = ", ".join(f"{angle:g}" for angle in sorted(SPECULAR))
    raise InputError(f"gloss at {angle_deg:g} degrees: expected one of {angles} degrees")


def luminous_weights(bands: Bands) -> Array:
    """Weights (B,) of a luminous reflectance: illuminant C times V(lambda), summing to one."""
    return np.asarray(spectra.xyz_weights(bands, spectra.illuminant(ILLUMINANT))[:, 1])


def _luminous(material: Material) -> Array:
    """Those weights for a material's own spectra, none of which comes out negative."""
    return material.xyz_weights(spectra.illuminant(ILLUMINANT))[:, 1]


def from_fluxes(meter: Meter, fluxes: list[float]) -> float | None:
    """A meter's reading from the shares in its windows; None for the ratio of nothing.

    Gloss and haze are relative to the black glass in the specular window; distinctness is
    100 (1 - R(0.3) / R(0)), R(0.3) the mean of both sides.
    """
    if meter is DISTINCTNESS:
        middle, *sides = fluxes
        return 100.0 * max(0.0, 1.0 - float(np.mean(sides)) / middle) if middle > 0.0 else None
    return 100.0 * sum(fluxes) / meter.mirror_flux(meter.glass)


class _Folded(NamedTuple):
    """The luminous factors of a material's parts: all that its spectra do to a reading."""

    model: str
    sigma: float
    first: float  #: of the diffuse model's first shape
    second: float
    lobes: tuple[tuple[Lobe, tuple[tuple[brdf.Fresnel, float], ...]], ...]


class _Folds:
    """The folded parts of the materials that one reading looks at, each folded once.

    By the identity of materials that the reading itself keeps alive.
    """

    def __init__(self) -> None:
        self._known: dict[int, tuple[Material, _Folded]] = {}
        self.shares = Shares()

    def of(self, material: Material) -> _Folded:
        if id(material) not in self._known:
            self._known[id(material)] = material, _folded(material)
        return self._known[id(material)][1]


def _folded(material: Material) -> _Folded:
    weight, body = _luminous(material), material.diffuse
    return _Folded(
        body.model,
        body.sigma,
        float(weight @ np.asarray(body.albedo)),
        float(weight @ material.second_albedo()),
        tuple(
            (
                lobe,
                tuple(
                    (part.fresnel, float(weight @ part.spectrum))
                    for part in lobe.parts(material.bands.count)
                ),
            )
            for lobe in material.visible_lobes()
        ),
    )


def _metered(material: Material, meter: Meter, folds: _Folds) -> float | None:
    parts = folds.of(material)
    return from_fluxes(meter, [_flux(parts, meter, w, folds.shares) for w in meter.windows])


def _flux(parts: _Folded, meter: Meter, window: Window, shares: Shares) -> float:
    """Luminous share of the light that a material sends into a window."""
    first, second = shares.diffuse_flux(meter, window, parts.model, parts.sigma)
    total = first * parts.first + second * parts.second
    for lobe, spectra_of in parts.lobes:
        for fresnel, factor in spectra_of:
            total += factor * shares.lobe_flux(meter, window, lobe.s_deg, fresnel)
    return total


def _contrast(material: Material, folds: _Folds) -> float:
    """Contrast gloss c = cbrt(rho_s + rho_d / 2) - cbrt(rho_d / 2), Pellacini et al. 2000.

    rho_d and rho_s are the luminous diffuse and specular albedo at normal incidence.
    """
    parts = folds.of(material)
    first, second = folds.shares.diffuse_albedo(parts.model, parts.sigma)
    diffuse, specular = first * parts.first + second * parts.second, 0.0
    for lobe, spectra_of in parts.lobes:
        for fresnel, factor in spectra_of:
            specular += factor * folds.shares.lobe_albedo(lobe.s, fresnel)
    return float(np.cbrt(specular + 0.5 * diffuse) - np.cbrt(0.5 * diffuse))


def _sharpness(material: Material) -> float | None:
    """Distinctness d = 1 - alpha, Pellacini et al. 2000, alpha = sqrt(2) s of the main lobe."""
    main = main_lobe(material)
    if main is None:
        return None
    return 1.0 - float(np.sqrt(2.0) * np.radians(material.specular[main].s_deg))


def main_lobe(material: Material) -> int | None:
    """Index of the lobe with the highest peak; None where nothing shines."""

    weight = _luminous(material)

    def peak(lobe: Lobe) -> float:
        head_on = sum(
            float(weight @ part.spectrum) * float(brdf.reflectance(1.0, part.fresnel))
            for part in lobe.parts(material.bands.count)
        )
        return head_on / max(lobe.s_deg, S_DEG_DRAWN) ** 2

    peaks = [peak(lobe) for lobe in material.specular]
    return int(np.argmax(peaks)) if peaks and max(peaks) > 0.0 else None


# --- the other way round: a material that no one has measured ------------------------------------


def lobe_width_for(material: Material, angle_deg: float, reading: float) -> float:
    """Width s_deg of the main lobe with which a material reads `reading` at an angle.

    All else stays as it is, so the width is hypothetical. InputError where no width that can be
    drawn gives the reading; the message has the range of readings.
    """
    from scipy.optimize import brentq

    meter, main = meter_at(angle_deg), main_lobe(material)
    name = printable(material.name, 60)
    if not np.isfinite(reading):
        raise InputError(f"gloss of {reading:g}: expected a number of gloss units")
    if main is None:
        raise InputError(f"{name}: has no specular lobe whose width could be changed")

    def excess(log_s: float) -> float:
        return (
            specular_gloss(_with_width(material, main, float(np.exp(log_s))), angle_deg) - reading
        )

    widths = np.linspace(np.log(S_DEG_DRAWN), np.log(S_DEG_MAX), WIDTHS_TRIED)
    excesses = np.array([excess(log_s) for log_s in widths])
    crossing = np.flatnonzero((excesses[:-1] >= 0.0) != (excesses[1:] >= 0.0))
    if not len(crossing):
        low, high = (float(end) + reading for end in (excesses.min(), excesses.max()))
        raise InputError(
            f"{name}: no lobe width reads {reading:g} at {meter.angle_deg:g} degrees; from "
            f"{S_DEG_MAX:g} to {S_DEG_DRAWN:g} degrees it reads {low:.3g} to {high:.3g}"
        )
    k = crossing[0]
    return float(np.exp(brentq(excess, widths[k], widths[k + 1], xtol=1e-10)))


def hypothetical(material: Material, angle_deg: float, reading: float) -> Material:
    """The material with the lobe width that gives a reading.

    Its name and source mark it as hypothetical. It has no fit: another material was fitted.
    """
    s_deg = lobe_width_for(material, angle_deg, reading)
    main = main_lobe(material)
    assert main is not None
    wanted = f"{reading:g} gloss units at {angle_deg:g} degrees"
    kind = "synthetic, hypothetical" if material.synthetic else "hypothetical"
    changed = _with_width(material, main, s_deg)
    return dataclasses.replace(
        changed,
        name=f"{material.name}, hypothetical: {wanted}",
        source=f"{kind}: width of lobe {main + 1} set from {material.specular[main].s_deg:.4g} to "
        f"{s_deg:.4g} degrees to read {wanted}; made from {material.name} ({material.source})",
        fit=None,
        estimate=None,
        hypothetical=True,
    )


def _with_width(material: Material, k: int, s_deg: float) -> Material:
    lobe = dataclasses.replace(material.specular[k], s_deg=min(s_deg, S_DEG_MAX))
    lobes = (*material.specular[:k], lobe, *material.specular[k + 1 :])
    return dataclasses.replace(material, specular=lobes)
