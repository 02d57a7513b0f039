"""Kinds of trouble, each of a size from one that hardly matters to a severe one.

Each function changes a sound plan in one place. Its size comes from a share, 0 to 1, mostly on a
logarithmic scale; what else it needs is drawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.bench.verdicts import instrument
from relgloss_view.bench.verdicts.instrument import GCMS
from relgloss_view.bench.verdicts.reflection import Highlight, Retro, Surface, metal_index
from relgloss_view.bench.verdicts.samples import INKS, dielectric, draw, spectrum
from relgloss_view.bench.verdicts.tables import Plan, with_sample

Apply = Callable[[Plan, np.random.Generator, float], Plan]


def between(low: float, high: float, share: float) -> float:
    """A size on a logarithmic scale."""
    return float(np.exp(np.log(low) + share * (np.log(high) - np.log(low))))


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _delta_deg(plan: Plan) -> Array:
    """(N,), angles between the sample's normal and the half-vector."""
    i, o = plan.true_directions()
    h = i + o
    length = np.maximum(np.linalg.norm(h, axis=1), 1e-12)
    return np.asarray(np.degrees(np.arccos(np.clip(h[:, 2] / length, -1.0, 1.0))))


# --- the detector ---------------------------------------------------------------------------------


def saturation(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The detector ends at a level below the peak, and the file does not declare it."""
    part = between(0.95, 0.05, share)

    def clip(values: Array, plan: Plan) -> Array:
        level = float(f"{max(part * values.max(), 1.05 * np.median(values)):.4g}")
        return np.minimum(values, level)

    return replace(plan, spoil=clip, note=f"ends at {part:.2f} of the peak")


def stray_light(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """A constant in every reading."""
    offset = between(0.002, 0.03, share)
    return replace(plan, drift=lambda v, _: v + offset, note=f"+{offset:.4f}")


def dark_floor(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Readings below a floor are written as the floor."""
    floor = between(0.005, 0.08, share)
    return replace(plan, spoil=lambda v, _: np.maximum(v, floor), note=f"floor {floor:.4f}")


def lamp_drift(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """One plane of incidence is scaled."""
    factor = 1.0 + _sign(rng) * between(0.05, 0.4, share)
    plane = plan.setting.grid.plane
    chosen = int(rng.choice(np.unique(plane)))
    scale = np.where(plane == chosen, factor, 1.0)[:, None]
    return replace(plan, drift=lambda v, _: v * scale, note=f"one plane x {factor:.2f}")


def slow_drift(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The lamp fades from the first row to the last."""
    lost = between(0.05, 0.5, share)
    fade = np.linspace(1.0, 1.0 - lost, len(plan.angles_deg))[:, None]
    return replace(plan, drift=lambda v, _: v * fade, note=f"last row x {1 - lost:.2f}")


def spikes(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Single rows are several times too high, as with dust and glints."""
    part, factor = between(0.005, 0.15, share), float(rng.uniform(2.0, 8.0))
    hit = rng.uniform(size=len(plan.angles_deg)) < part
    scale = np.where(hit, factor, 1.0)[:, None]
    return replace(plan, drift=lambda v, _: v * scale, note=f"{hit.sum()} rows x {factor:.1f}")


def bad_bands(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """One band is dead, or two are swapped."""
    count = len(plan.setting.sample.wavelengths_nm)
    a, b = (int(x) for x in rng.choice(count, 2, replace=False))

    def dead(values: Array, _: Plan) -> Array:
        return np.where(np.arange(count) == a, 1e-4, values)

    def swapped(values: Array, _: Plan) -> Array:
        order = np.arange(count)
        order[[a, b]] = b, a
        return values[:, order]

    if share > 0.5:
        return replace(plan, spoil=dead, note=f"band {a} dead")
    # Two bands of a smooth spectrum of few bands can't be seen to be swapped.
    return replace(plan, spoil=swapped, note=f"bands {a} and {b} swapped", visible=count > 10)


# --- what the file declares -----------------------------------------------------------------------


def wrong_unit(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Percent, or one quantity declared as another."""
    brightest = float(plan.setting.sample.body.albedo.max())
    kind = int(3 * share)
    if kind == 0:  # a factor that leaves a plausible paper can't be seen
        note, factor = "BRDF declared as radiance factor", 1.0 / np.pi
    elif kind == 1:
        note, factor = "radiance factor declared as BRDF", 1.0
        return replace(plan, quantity="brdf", note=note, visible=brightest * np.pi > 1.3)
    else:
        note, factor = "percent", 100.0
    return replace(plan, spoil=lambda v, _: v * factor, note=note, visible=factor > 1.0)


def cosine_missed(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Readings hold the receiver's cosine, or a part of it; the file declares radiance factors."""
    _, o = plan.true_directions()
    power = 0.3 + 0.7 * min(2.0 * share, 1.0)
    cosine = np.maximum(o[:, 2:], 1e-6) ** power
    return replace(plan, drift=lambda v, _: v * cosine, note=f"cos^{power:.2f}")


def radians(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Angles in radians under headings of degrees."""
    gamma = None if share < 0.5 else plan.declared_gamma_s_deg
    return replace(plan, record=np.radians, declared_gamma_s_deg=gamma, note="radians")


def aperture_wrong(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The declared deviations are those of another aperture."""
    factor = between(1.1, 2.5, share) ** _sign(rng)
    a, b = (round(factor * sd, 4) for sd in plan.setting.aperture_sd_deg)
    return replace(plan, declared_sd_deg=(a, b), note=f"declared x {factor:.2f}")


def full_angle(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The full angle of the receiver, or of both, is declared as the deviation of a disc."""
    a, b = plan.setting.aperture_sd_deg
    a = 4.0 * a if share > 0.5 else a
    return replace(plan, declared_sd_deg=(round(a, 4), round(4.0 * b, 4)), note="diameter as sd")


def wide_receiver(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """A receiver wider than the lobe, declared as what it is."""
    wide = (plan.setting.aperture_sd_deg[0], round(between(0.8, 4.0, share), 4))
    setting = replace(plan.setting, aperture_sd_deg=wide)
    return replace(plan, setting=setting, declared_sd_deg=wide, note=f"sd {wide[1]:.2f} deg")


# --- angles ---------------------------------------------------------------------------------------


def mirror_other_side(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The receiver is counted to the other side: the peak is at the lamp's azimuth."""

    def record(angles: Array) -> Array:
        turned = angles.copy()
        if plan.setting.grid.convention == GCMS:
            turned[:, 1] *= -1.0
        else:
            turned[:, 3] = (turned[:, 3] + 180.0) % 360.0
        return turned

    return replace(plan, record=record, note="other side")


def mirror_other_plane(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The mirror plane is at another tilt, or at another azimuth."""
    if plan.setting.grid.convention == GCMS:
        true = float(rng.choice([0.0, 5.0, 10.0, 30.0]))
        declared = None if share < 0.5 else plan.declared_gamma_s_deg
        return replace(
            plan, gamma_s_deg=true, declared_gamma_s_deg=declared, note=f"gamma_s {true:g}"
        )
    turn = _sign(rng) * between(10.0, 90.0, share)
    return replace(plan, zero_deg=(0.0, 0.0, 0.0, turn), note=f"azimuth off by {turn:.0f}")


def plane_zero(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """gamma_s, or the azimuth of the receiver, is off by 0.2 to 2 degrees."""
    off = _sign(rng) * between(0.2, 2.0, share)
    if plan.setting.grid.convention == GCMS:
        return replace(plan, gamma_s_deg=plan.gamma_s_deg + off, note=f"gamma_s off by {off:.2f}")
    return replace(plan, zero_deg=(0.0, 0.0, 0.0, 2.0 * off), note=f"azimuth off by {2 * off:.2f}")


def lamp_zero(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The lamp's angle has a zero error."""
    off = _sign(rng) * between(0.1, 0.5, share)
    return replace(plan, zero_deg=(off, 0.0, 0.0, 0.0), note=f"lamp off by {off:.2f}")


def receiver_zero(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The receiver's angle has a zero error."""
    off = _sign(rng) * between(0.1, 0.5, share)
    where = 1 if plan.setting.grid.convention == GCMS else 2
    zero = tuple(off if k == where else 0.0 for k in range(4))
    return replace(plan, zero_deg=zero, note=f"receiver off by {off:.2f}")


def tilt(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The sample does not lie flat."""
    lean, towards = between(0.3, 3.0, share), float(rng.uniform(0.0, 2.0 * np.pi))
    leans = (lean * float(np.cos(towards)), lean * float(np.sin(towards)))
    return replace(plan, tilt_deg=leans, note=f"tilted by {lean:.2f}")


# --- which rows there are -------------------------------------------------------------------------


def highlight_missed(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """The neighbourhood of the mirror direction is missing."""
    width = between(0.5, 6.0, share) * max(plan.setting.sample.narrowest_deg, 0.3)

    def keep(plan: Plan) -> Mask:
        return np.asarray(_delta_deg(plan) > width)

    return replace(plan, keep=keep, note=f"nothing within {width:.2f} deg")


def highlight_in_few(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """A narrow highlight on a coarse grid: drawn so, with nothing to change."""
    return replace(plan, note=f"s {plan.setting.sample.narrowest_deg:.2f} on 10-degree steps")


def mixed_rows(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Rows of a second sample are among those of the first."""
    bands = plan.setting.sample.wavelengths_nm
    other = draw(rng, (instrument.paper_grid,)).sample
    ink = INKS[str(rng.choice(list(INKS)))]
    first = other.highlights[0]
    lobe = replace(
        first, strength=np.full(len(bands), first.strength[0]), surface=dielectric(1.5, bands)
    )
    body = replace(other.body, albedo=spectrum(ink, bands))
    second = replace(other, wavelengths_nm=bands, body=body, highlights=(lobe,))
    part = between(0.03, 0.5, share)
    return replace(plan, other=second, other_share=part, note=f"{100 * part:.0f} % of rows")


# --- the sample -----------------------------------------------------------------------------------


def _main(plan: Plan, **changes: object) -> Plan:
    first, *rest = plan.setting.sample.highlights
    changed: Highlight = replace(first, **changes)  # type: ignore[arg-type]
    return with_sample(plan, highlights=(changed, *rest))


def anisotropy(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Facets lean more along one direction: brushed, or printed in lines."""
    ratio, azimuth = between(1.3, 4.0, share), float(rng.uniform(0.0, 180.0))
    s_deg = plan.setting.sample.highlights[0].s_deg * (1.0 if ratio < 2 else np.sqrt(ratio / 2))
    changed = _main(plan, shape="anisotropic", ratio=ratio, azimuth_deg=azimuth, s_deg=s_deg)
    ends = (-azimuth, 90.0 - azimuth)
    return replace(changed, azimuths_deg=ends, note=f"ratio {ratio:.2f}")


def metal(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Gold or copper: a coloured highlight that turns white at grazing incidence."""
    bands = plan.setting.sample.wavelengths_nm
    kind = str(rng.choice(["gold", "copper"]))
    strength = np.full(len(bands), between(0.1, 1.0, share))
    surface = Surface(metal_index(kind, bands))
    return replace(
        _main(plan, surface=surface, strength=strength), note=f"{kind} {strength[0]:.2f}"
    )


def interference(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """A thin film whose colour turns with the angle (index 2.3, as titania on mica)."""
    bands = plan.setting.sample.wavelengths_nm
    nm = float(rng.uniform(120.0, 420.0))
    film = Surface(np.full(len(bands), 1.5), 1.6 + 0.8 * share, nm, bands)
    return replace(
        _main(plan, surface=film), note=f"film of {nm:.0f} nm, n {1.6 + 0.8 * share:.2f}"
    )


def retroreflection(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """A peak around the lamp's direction."""
    height, sd = between(0.05, 8.0, share), float(rng.uniform(2.0, 12.0))
    return replace(
        with_sample(plan, retro=Retro(height, sd)), note=f"{height:.2f}, sd {sd:.1f} deg"
    )


def other_constants(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """An index of 1.25 to 2.5, or a strength above one."""
    bands = plan.setting.sample.wavelengths_nm
    index = float(rng.choice([rng.uniform(1.25, 1.4), rng.uniform(1.6, 1.6 + 0.9 * share)]))
    strength = np.full(len(bands), between(1.0, 3.0, float(rng.uniform()) * share))
    changed = _main(plan, surface=dielectric(index, bands), strength=strength)
    return replace(changed, note=f"n {index:.2f}, strength {strength[0]:.2f}")


def long_tails(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Facets after Walter et al. 2007 (GGX), in part or whole."""
    first, *rest = plan.setting.sample.highlights
    tail = replace(first, shape="ggx", strength=share * first.strength, smith=True)
    core = replace(first, strength=(1.0 - share) * first.strength)
    changed = with_sample(plan, highlights=(core, tail, *rest))
    return replace(changed, note=f"{100 * share:.0f} % GGX")


def other_shadowing(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """Smith's shadowing in place of V-grooves (Beckmann facets)."""
    return replace(_main(plan, shape="beckmann", smith=True), note="Smith's shadowing")


def clear_coat(plan: Plan, rng: np.random.Generator, share: float) -> Plan:
    """A coat over the body: the body darkens at grazing angles; a third, sharp lobe on top."""
    sample = plan.setting.sample
    first = sample.highlights[0]
    sharp = replace(
        first,
        s_deg=max(first.s_deg / between(1.5, 5.0, share), 0.35),
        strength=0.5 * first.strength,
    )
    changed = with_sample(
        plan, body=replace(sample.body, through_index=1.5), highlights=(*sample.highlights, sharp)
    )
    return replace(changed, note=f"coat of s {sharp.s_deg:.2f}")
