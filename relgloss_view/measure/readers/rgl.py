"""RGL material database (Dupuy and Jakob 2018): isotropic measured BRDFs, rgb and spectral.

The grid of the stored values follows the material. The half-vector's polar angle theta = u^2 pi/2
and its azimuth phi = (2v - 1) pi from the lamp make a unit square; the density of visible facet
normals at each incidence warps that square into the one that is tabulated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.base.errors import InputError
from relgloss_view.measure import screening as screen
from relgloss_view.measure import table
from relgloss_view.measure.bands import Bands
from relgloss_view.measure.gonio import tabulated_grid
from relgloss_view.measure.quantity import BRDF
from relgloss_view.measure.readers import tensor_file
from relgloss_view.measure.readers.assemble import (
    assemble,
    evaluate_above,
    require_samples,
    tabulated_directions,
)
from relgloss_view.measure.readers.declared import Declared
from relgloss_view.measure.readers.tristimulus import LUMINANCE, within_gamut
from relgloss_view.measure.readers.unit_square import Warp, bilinear, find_slices
from relgloss_view.measure.table import Measurement, source_is_synthetic

#: Fields that are read; files hold what the acquisition needs beside them.
FIELDS = ("description", "phi_i", "theta_i", "ndf", "sigma", "vndf", "jacobian")
MOST_NUMBERS = 10_000_000  #: of a density; the database's have 0.2 million
MOST_SPECTRAL = 20_000_000  #: of an isotropic file's spectra, float32; the database's have 2
#: Bands of a spectral file that are kept: those that an eye sees, this far apart at least.
SEEN_NM, STEP_NM = (380.0, 780.0), 5.0


def read(path: Path) -> Measurement:
    """Read an isotropic .bsdf at gonio.tabulated_grid(), rgb or spectral. Raises InputError.

    A saturated colour has a negative channel in linear sRGB; that is its gamut, not a fault of the
    instrument. Such a material is kept in linear Rec. 2020, with a note among the warnings.
    """
    brdf = load(path)
    to_lamp, to_receiver, group = tabulated_directions()
    values = brdf.evaluate(to_lamp, to_receiver)
    source = f"{path.name}, RGL material database format (Dupuy and Jakob 2018)"
    # The acquisition stores zeros where the instrument could not see.
    unseen = (values == 0.0).all(axis=1)
    if brdf.wavelengths_nm is not None:
        name = brdf.description or path.stem
        facts = Declared(name, source, BRDF, quantity_insisted=True, warnings=brdf.notes)
        readings = np.where(unseen[:, None], np.nan, values)
        bands = Bands(tuple(brdf.wavelengths_nm.tolist()))
        directions = (to_lamp, to_receiver)
        angles = tabulated_grid()
        measured = assemble(
            path, facts, angles, bands, readings, directions, np.asarray(group, np.float64)
        )
        return replace(
            measured,
            gamma_s_deg=None,
            synthetic=source_is_synthetic(path.name),
            tabulated=True,
        )

    factor = np.pi * values
    luminance = factor @ LUMINANCE
    readings = np.where(unseen, np.nan, luminance)[:, None]
    reasons = screen.reasons(to_lamp, to_receiver, readings)
    bands, factor, warnings = within_gamut(factor, reasons == table.KEPT)
    return require_samples(
        Measurement(
            name=brdf.description or path.stem,
            source=source,
            to_lamp=to_lamp,
            to_receiver=to_receiver,
            bands=bands,
            radiance_factor=np.where(unseen[:, None], np.nan, factor),
            reasons=reasons,
            group=group,
            warnings=warnings,
            synthetic=source_is_synthetic(path.name),
            tabulated=True,
        ),
        path,
    )


def load(path: Path) -> RglBrdf:
    """Load a .bsdf file. Raises InputError where it is damaged, anisotropic or of another kind.

    Of a file with both rgb and spectra the rgb is taken.
    """
    fields, names = tensor_file.read(path, ("phi_i",), MOST_NUMBERS)
    phi_i = _floats(path, fields, "phi_i", (None,))
    if len(phi_i) != 1:
        raise InputError(
            f"{path}: field 'phi_i' has {len(phi_i)} values: the material is anisotropic; "
            "only isotropic ones can be read"
        )
    fields |= tensor_file.read(path, FIELDS, MOST_NUMBERS)[0]
    theta_i = _floats(path, fields, "theta_i", (None,))
    increasing = (np.diff(theta_i) > 0.0).all()
    # float32 rounds pi/2 up.
    if not increasing or theta_i[0] < 0.0 or theta_i[-1] > 0.5 * np.pi + 1e-6:
        raise InputError(
            f"{path}: field 'theta_i' does not increase from 0 to pi/2; "
            "the file is damaged, download it again"
        )
    count = len(theta_i)
    vndf = _floats(path, fields, "vndf", (1, count, None, None))[0]
    sigma = _floats(path, fields, "sigma", (None, None))
    ndf = _floats(path, fields, "ndf", (None, None))
    if "rgb" not in names and {"spectra", "wavelengths"} & names:
        wavelengths, tabulated, notes = _spectra(path, count)
    else:
        fields |= tensor_file.read(path, ("rgb",), MOST_NUMBERS)[0]
        wavelengths, notes = None, ()
        tabulated = _floats(path, fields, "rgb", (1, count, 3, None, None))[0]
    for name, values in (("vndf", vndf), ("sigma", sigma), ("ndf", ndf)):
        if values.min() < 0.0 or values.reshape(-1, values.shape[-1]).max() <= 0.0:
            raise InputError(
                f"{path}: field '{name}' is not a density: it is negative or zero throughout; "
                "the file is damaged, download it again"
            )
    description = fields.get("description", np.zeros(0, np.uint8)).tobytes()
    jacobian = fields.get("jacobian", np.ones(1, np.uint8))
    return RglBrdf(
        description=" ".join(description.decode("utf-8", "replace").split())[:200],
        theta_i=theta_i,
        warp=Warp.of(vndf),
        sigma=sigma,
        ndf=ndf,
        values=tabulated,
        has_jacobian=bool(jacobian.any()),
        wavelengths_nm=wavelengths,
        notes=notes,
    )


def _spectra(path: Path, count: int) -> tuple[Array, Array, tuple[str, ...]]:
    """Wavelengths (W,), their values (T, W, N, N), and a note on those that are left out."""
    fields = tensor_file.read(path, ("wavelengths", "spectra"), MOST_SPECTRAL)[0]
    nm = _floats(path, fields, "wavelengths", (None,))
    if (np.diff(nm) <= 0.0).any():
        raise InputError(
            f"{path}: field 'wavelengths' does not increase; the file is damaged, download it again"
        )
    kept: list[int] = []
    for k in np.flatnonzero((nm >= SEEN_NM[0]) & (nm <= SEEN_NM[1])).tolist():
        if not kept or nm[k] - nm[kept[-1]] >= STEP_NM:
            kept.append(k)
    if len(kept) < 2:
        raise InputError(
            f"{path}: field 'wavelengths' has {len(kept)} from {SEEN_NM[0]:g} to {SEEN_NM[1]:g} "
            "nm; expected 2 or more"
        )
    stored, taken = fields.get("spectra"), len(nm)
    if stored is not None and stored.ndim == 5 and stored.shape[2] == len(nm):
        fields["spectra"], taken = stored[:, :, kept], len(kept)
    shape = (1, count, taken, None, None)
    values = _floats(path, fields, "spectra", shape)[0]
    notes: tuple[str, ...] = ()
    if len(kept) < len(nm):
        notes = (
            f"{len(kept)} of {len(nm)} wavelengths are read: those from {nm[kept[0]]:.1f} to "
            f"{nm[kept[-1]]:.1f} nm, at least {STEP_NM:g} nm apart",
        )
    return nm[kept], values, notes


def _floats(
    path: Path, fields: dict[str, AnyArray], name: str, shape: tuple[int | None, ...]
) -> Array:
    """A field as float64, its shape and values checked; None is any length that can hold a grid."""
    if name not in fields:
        raise InputError(f"{path}: field '{name}' is missing; is this a .bsdf of the RGL database?")
    values = fields[name]
    least = 1 if len(shape) == 1 else 2
    fits = len(values.shape) == len(shape) and all(
        have == want if want is not None else have >= least
        for have, want in zip(values.shape, shape, strict=True)
    )
    if not fits:
        actual = "x".join(map(str, values.shape))
        wanted = "x".join("N" if n is None else str(n) for n in shape)
        raise InputError(
            f"{path}: field '{name}' has shape {actual}, expected {wanted}; "
            "only isotropic rgb and spectral files of the RGL database can be read"
        )
    with np.errstate(invalid="ignore"):  # a signalling NaN, reported below
        values = values.astype(np.float64)
    # The database stores float32; larger numbers, from a damaged file, would overflow in sums.
    sound = np.abs(values) <= np.finfo(np.float32).max
    if not sound.all():
        place = ", ".join(str(k) for k in np.argwhere(~sound)[0])
        raise InputError(
            f"{path}: field '{name}' holds a NaN or an infinity at [{place}]; "
            "the file is damaged, download it again"
        )
    return values


@dataclass(frozen=True)
class RglBrdf:
    """An isotropic measured BRDF; call evaluate."""

    description: str
    theta_i: Array  #: (T,), incidence angles of the slices, radians
    warp: Warp  #: visible-normal density of each slice
    sigma: Array  #: projected facet area over the direction to the lamp
    ndf: Array  #: facet density over the half-vector
    values: Array  #: (T, C, N, N), of rgb or of the wavelengths
    has_jacobian: bool  #: whether the values still lack ndf / (4 sigma)
    wavelengths_nm: Array | None = None  #: (C,); None for rgb
    notes: tuple[str, ...] = ()

    def evaluate(self, i: ArrayLike, o: ArrayLike) -> Array:
        """BRDF in 1/sr, (..., C), linear sRGB or at the wavelengths; zero below z = 0.

        i (to the lamp) and o (to the eye) are unit vectors, (..., 3). Beyond the tabulated
        incidences the nearest slice holds.
        """
        return evaluate_above(i, o, self._above, self.values.shape[1])

    def _above(self, i: Array, o: Array) -> Array:
        half = i + o
        half /= np.linalg.norm(half, axis=1)[:, None]
        theta_i, phi_i = _spherical(i)
        theta_h, phi_h = _spherical(half)
        lamp = np.stack([_theta_to_unit(theta_i), _phi_to_unit(phi_i)], axis=1)
        middle = np.stack([_theta_to_unit(theta_h), _phi_to_unit(phi_h - phi_i)], axis=1)

        slices = find_slices(self.theta_i, theta_i)
        values = bilinear(self.values, self.warp.invert(middle, slices), slices)
        if self.has_jacobian:
            values *= (bilinear(self.ndf, middle) / (4.0 * self._area(lamp)))[:, None]
        return np.asarray(values / o[:, 2:])

    def _area(self, lamp: Array) -> Array:
        # The smallest positive float32 guards a damaged file: measured areas are about 0.05 to 1.
        return np.maximum(bilinear(self.sigma, lamp), 1.4e-45)


def _spherical(w: Array) -> tuple[Array, Array]:
    """Polar angle from the chord to +z (exact near the pole) and azimuth of (N, 3) unit vectors."""
    chord = np.linalg.norm(w - np.array([0.0, 0.0, 1.0]), axis=1)
    return 2.0 * np.arcsin(np.minimum(0.5 * chord, 1.0)), np.arctan2(w[:, 1], w[:, 0])


def _theta_to_unit(theta: Array) -> Array:
    return np.sqrt(np.minimum(theta * (2.0 / np.pi), 1.0))


def _phi_to_unit(phi: Array) -> Array:
    return np.asarray((phi + np.pi) / (2.0 * np.pi) % 1.0)
