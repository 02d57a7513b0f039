"""Polarised BRDFs (.pbsdf) of Baek et al. 2020: their reflection of unpolarised light.

The file is the container of the RGL database. It holds a Mueller matrix for each node of phi_d,
theta_d, theta_h and the wavelength; element (0, 0) is the BRDF that a lamp without polarisation
and an eye without a filter have. A node without a measurement is NaN.

Sources: Baek, Zeltner, Ku, Hwang, Tong, Jakob, Kim 2020, "Image-Based Acquisition and Modeling of
Polarimetric Reflectance"; the fields and their interpolation as mitsuba's `measured_polarized`
plug-in has them; Rusinkiewicz 1998 (the angles).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import AnyArray, Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import tabulated_grid
from relgloss_view.measure.quantity import BRDF
from relgloss_view.measure.readers import half_difference, tensor_file
from relgloss_view.measure.readers.assemble import assemble, evaluate_above, tabulated_directions
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.table import Measurement, source_is_synthetic

AXES = ("phi_d", "theta_d", "theta_h")  #: in the order of the field M, radians
FIELDS = frozenset((*AXES, "M"))
WAVELENGTHS = "wvls"  #: nm
SIZE = 4  #: rows and columns of a Mueller matrix
MOST_NUMBERS = 40_000_000  #: of M without its matrices; the database's have 15
MOST_NODES = 100_000  #: of an axis
LARGEST = 1e9  #: 1/sr
#: Angles in degrees would lie beyond; phi_d may be counted over a whole turn.
LIMITS = {"phi_d": 2.0 * np.pi, "theta_d": 0.5 * np.pi, "theta_h": 0.5 * np.pi}
ROUNDED = 1e-3


def is_polarised(path: Path) -> bool:
    """Whether a file in the container of the RGL database holds Mueller matrices."""
    return tensor_file.read(path, ())[1] >= FIELDS


def read(path: Path) -> Measurement:
    """Read a .pbsdf file at gonio.tabulated_grid(), by its wavelengths. Raises InputError."""
    brdf = load(path)
    to_lamp, to_receiver, group = tabulated_directions()
    values = brdf.evaluate(to_lamp, to_receiver)
    facts = Declared(
        path.stem,
        f"{path.name}, polarised BRDF format (Baek et al. 2020)",
        BRDF,
        quantity_insisted=True,
        warnings=("of the polarised BRDF the reflection of unpolarised light is read, M[0, 0]",),
    )
    bands = Bands(tuple(brdf.wavelengths_nm.tolist()))
    directions = (to_lamp, to_receiver)
    groups = np.asarray(group, np.float64)
    measured = assemble(path, facts, tabulated_grid(), bands, values, directions, groups)
    return replace(
        measured, gamma_s_deg=None, synthetic=source_is_synthetic(path.name), tabulated=True
    )


def load(path: Path) -> PolarisedBrdf:
    """The unpolarised part of a .pbsdf file. Raises InputError where it is damaged."""
    fields, _ = tensor_file.read(path, (*AXES, WAVELENGTHS), MOST_NODES)
    axes = tuple(_axis(path, fields, name) for name in AXES)
    for name, axis in zip(AXES, axes, strict=True):
        low = -LIMITS[name] if name == "phi_d" else 0.0
        if axis[0] < low - ROUNDED or axis[-1] > LIMITS[name] + ROUNDED:
            raise InputError(
                f"{path}: field '{name}' reaches from {axis[0]:.4g} to {axis[-1]:.4g}; expected "
                f"radians from {low:.4g} to {LIMITS[name]:.4g}"
            )
    nm = _axis(path, fields, WAVELENGTHS)
    if len(nm) < 2 or nm[0] < 300.0 or nm[-1] > 2500.0:
        raise InputError(
            f"{path}: field '{WAVELENGTHS}' has {len(nm)} values from {nm[0]:g} to {nm[-1]:g}; "
            "expected 2 or more wavelengths in nm"
        )
    stored = tensor_file.read_element(path, "M", (0, 0), MOST_NUMBERS)
    wanted = (*map(len, axes), len(nm))
    if stored is None or stored.shape != wanted or stored.dtype.kind != "f":
        raise InputError(
            f"{path}: field 'M' does not have the shape of its axes, "
            f"{'x'.join(map(str, wanted))}x{SIZE}x{SIZE}, in floating point; the file is damaged, "
            "download it again"
        )
    with np.errstate(invalid="ignore"):  # a signalling NaN is a node without a measurement
        if np.any(np.abs(stored) > LARGEST):
            raise InputError(
                f"{path}: field 'M' holds a number above {LARGEST:g}, which no BRDF reaches; "
                "the file is damaged, download it again"
            )
    return PolarisedBrdf(axes, nm, stored)


def _axis(path: Path, fields: dict[str, AnyArray], name: str) -> Array:
    """A field's values as float64, (N,), increasing; the database stores axes as rows."""
    if name not in fields:
        raise InputError(f"{path}: field '{name}' is missing; is this a .pbsdf of Baek et al.?")
    stored = fields[name]
    if stored.size == 0 or stored.shape[-1] != stored.size:
        raise InputError(
            f"{path}: field '{name}' has shape {'x'.join(map(str, stored.shape))}, expected 1xN"
        )
    with np.errstate(invalid="ignore"):  # a signalling NaN, reported below
        values = stored.reshape(-1).astype(np.float64)
    if not (np.isfinite(values).all() and (np.diff(values) > 0.0).all()):
        raise InputError(
            f"{path}: field '{name}' does not increase; the file is damaged, download it again"
        )
    return values


@dataclass(frozen=True)
class PolarisedBrdf:
    """An isotropic measured BRDF for unpolarised light; call evaluate."""

    axes: tuple[Array, ...]  #: phi_d, theta_d, theta_h, radians
    wavelengths_nm: Array  #: (W,)
    values: AnyArray  #: (P, D, H, W), 1/sr; NaN where nothing was measured

    def evaluate(self, i: ArrayLike, o: ArrayLike) -> Array:
        """BRDF in 1/sr at the wavelengths, (..., W); NaN where unmeasured, zero below z = 0.

        i (to the lamp) and o (to the eye) are unit vectors, (..., 3). Interpolates linearly
        between nodes; beyond the outer nodes these hold.
        """
        return evaluate_above(i, o, self._above, len(self.wavelengths_nm))

    def _above(self, i: Array, o: Array) -> Array:
        theta_h, theta_d, phi_d = half_difference.angles_of(i, o)
        low, high, upper = zip(
            *(
                _between(axis, x)
                for axis, x in zip(self.axes, (phi_d, theta_d, theta_h), strict=True)
            ),
            strict=True,
        )
        total = np.zeros((len(i), len(self.wavelengths_nm)))
        for corner in product((False, True), repeat=len(AXES)):
            node = np.where(corner, np.transpose(high), np.transpose(low))
            share = np.prod(np.where(corner, np.transpose(upper), 1.0 - np.transpose(upper)), 1)
            used = share > 0.0  # NaN times zero is NaN
            total[used] += share[used, None] * self.values[tuple(node[used].T)]
        return total


def _between(axis: Array, x: Array) -> tuple[Ints, Ints, Array]:
    """The nodes below and above (N,) of values (N,), and the share of the upper one."""
    low = np.clip(np.searchsorted(axis, x, side="right") - 1, 0, max(len(axis) - 2, 0))
    high = np.minimum(low + 1, len(axis) - 1)
    width = np.where(high > low, axis[high] - axis[low], 1.0)
    return low, high, np.clip((x - axis[low]) / width, 0.0, 1.0)
