"""A table of a sample with a known truth, and at most one thing wrong with it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.bench.verdicts import instrument
from relgloss_view.bench.verdicts.instrument import GCMS
from relgloss_view.bench.verdicts.reflection import TrueSample
from relgloss_view.bench.verdicts.samples import Setting
from relgloss_view.measure.gonio import GAMMA_S_DEG, gcms_directions, spherical

Spoil = Callable[[Array, "Plan"], Array]
Record = Callable[[Array], Array]


@dataclass(frozen=True)
class Plan:
    """All that decides a table: the sample, the instrument as it is, and what its file declares."""

    setting: Setting
    noise_seed: tuple[int, ...]
    declared_sd_deg: tuple[float, float]
    gamma_s_deg: float = GAMMA_S_DEG  #: where a GCMS really sees the mirror
    declared_gamma_s_deg: float | None = GAMMA_S_DEG  #: None: the file does not declare it
    zero_deg: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)  #: true minus recorded, for each angle
    tilt_deg: tuple[float, float] = (0.0, 0.0)  #: of the sample's normal along x and y
    quantity: str = "radiance-factor"  #: as declared
    record: Record | None = None  #: recorded angles from the instrument's
    drift: Spoil | None = None  #: changes clean readings
    spoil: Spoil | None = None  #: changes noisy readings
    keep: Callable[[Plan], Mask] | None = None  #: (N,) rows that are kept
    other: TrueSample | None = None  #: a second sample, some of whose rows are mixed in
    other_share: float = 0.0
    soft: bool = False  #: Gaussian apertures instead of discs
    visible: bool = True  #: whether the numbers can show the fault at all
    azimuths_deg: tuple[float, ...] = (0.0,)  #: orientations in which a picture shows the sample
    note: str = ""  #: size of the fault, for people

    @property
    def angles_deg(self) -> Array:
        """The instrument's settings, (N, 3) or (N, 4)."""
        return self.setting.grid.angles_deg

    def true_directions(self) -> tuple[Array, Array]:
        """Unit vectors to lamp and receiver as they really are, in the sample's frame."""
        angles = self.angles_deg + np.asarray(self.zero_deg)[: self.angles_deg.shape[1]]
        i, o = directions(self.setting.grid.convention, angles, self.gamma_s_deg)
        return tilted(i, self.tilt_deg), tilted(o, self.tilt_deg)


def directions(convention: str, angles_deg: Array, gamma_s_deg: float) -> tuple[Array, Array]:
    """Unit vectors (N, 3) to lamp and receiver."""
    if convention == GCMS:
        alpha, beta, gamma = angles_deg.T
        return gcms_directions(alpha, beta, gamma, gamma_s_deg)
    theta_i, phi_i, theta_r, phi_r = angles_deg.T
    return spherical(theta_i, phi_i), spherical(theta_r, phi_r)


def tilted(v: Array, tilt_deg: tuple[float, float]) -> Array:
    """Directions (N, 3) in the frame of a sample whose normal leans towards x and y."""
    if tilt_deg == (0.0, 0.0):
        return v
    lean = float(np.hypot(*tilt_deg))
    towards = np.array([*tilt_deg, 0.0]) / lean
    normal = np.sin(np.radians(lean)) * towards + np.array([0, 0, np.cos(np.radians(lean))])
    first = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    first /= np.linalg.norm(first)
    return np.asarray(v @ np.stack([first, np.cross(normal, first), normal], axis=1))


@dataclass(frozen=True)
class Table:
    """A CSV table and what is true about its sample."""

    text: str
    sample: TrueSample
    plan: Plan = field(repr=False)

    def write(self, path: str | Path) -> None:
        """Write the file that an instrument would leave."""
        Path(path).write_text(self.text, encoding="utf-8", newline="\n")


def make(plan: Plan, name: str = "sample") -> Table:
    """The table of a plan. The same plan gives the same text."""
    sample, grid = plan.setting.sample, plan.setting.grid
    i, o = plan.true_directions()
    clean = instrument.read(sample, i, o, plan.setting.aperture_sd_deg, soft=plan.soft)
    rng = np.random.default_rng(plan.noise_seed)
    mixed = rng.uniform(size=len(clean)) < plan.other_share
    if plan.other is not None and mixed.any():
        rows = np.flatnonzero(mixed)
        clean[rows] = instrument.read(plan.other, i[rows], o[rows], plan.setting.aperture_sd_deg)
    if plan.drift is not None:
        clean = plan.drift(clean, plan)
    values = instrument.noisy(clean, grid.plane, rng)
    if plan.spoil is not None:
        values = plan.spoil(values, plan)
    angles = plan.angles_deg if plan.record is None else plan.record(plan.angles_deg)
    above = (i[:, 2] > 0.03) & (o[:, 2] > 0.03)
    keep = above if plan.keep is None else above & plan.keep(plan)
    facts = {
        "name": name,
        "source": "synthetic, with a known truth",
        "quantity": plan.quantity,
        "aperture_sd_deg": " ".join(f"{sd:.4g}" for sd in plan.declared_sd_deg),
    }
    if grid.convention == GCMS and plan.declared_gamma_s_deg is not None:
        facts["gamma_s_deg"] = f"{plan.declared_gamma_s_deg:g}"
    text = instrument.as_csv(
        grid.convention, angles[keep], sample.wavelengths_nm, values[keep], facts
    )
    return Table(text, sample, plan)


def sound_plan(setting: Setting, noise_seed: tuple[int, ...]) -> Plan:
    """The plan of a table that has nothing wrong with it."""
    return Plan(setting, noise_seed, tuple(round(sd, 4) for sd in setting.aperture_sd_deg))  # type: ignore[arg-type]


def with_sample(plan: Plan, **changes: object) -> Plan:
    """The plan with parts of its sample replaced."""
    sample = replace(plan.setting.sample, **changes)  # type: ignore[arg-type]
    return replace(plan, setting=replace(plan.setting, sample=sample))
