"""RGL material database (Dupuy and Jakob 2018): isotropic measured BRDFs, rgb variant.

The grid of the stored values follows the material. The half-vector's polar angle theta = u^2 pi/2
and its azimuth phi = (2v - 1) pi from the lamp make a unit square; the density of visible facet
normals at each incidence warps that square into the one that is tabulated.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.base.errors import InputError
from relgloss_view.measure import screening as screen
from relgloss_view.measure import table
from relgloss_view.measure.bands import RGB, WIDE_RGB
from relgloss_view.measure.readers import tensor_file
from relgloss_view.measure.readers.assemble import (
    evaluate_above,
    require_samples,
    tabulated_directions,
)
from relgloss_view.measure.readers.unit_square import Warp, bilinear, find_slices
from relgloss_view.measure.table import Measurement, source_is_synthetic

#: Fields that are read; files hold spectra and what the acquisition needs beside them.
FIELDS = ("description", "phi_i", "theta_i", "ndf", "sigma", "vndf", "rgb", "jacobian")
#: Rec. 709 luminance of linear sRGB.
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
#: Linear sRGB to linear Rec. 2020 (ITU-R BT.2087-0), for column vectors.
REC2020_FROM_SRGB = np.array(
    [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
)


def read(path: Path) -> Measurement:
    """Read an isotropic rgb .bsdf at gonio.tabulated_grid(). Raises InputError.

    A saturated colour has a negative channel in linear sRGB; that is its gamut, not a fault of the
    instrument. Such a material is kept in linear Rec. 2020, with a note among the warnings.
    """
    brdf = load(path)
    to_lamp, to_receiver, group = tabulated_directions()
    factor = np.pi * brdf.evaluate(to_lamp, to_receiver)

    luminance = factor @ LUMINANCE
    # The acquisition stores zeros where the instrument could not see.
    unseen = (factor == 0.0).all(axis=1)
    readings = np.where(unseen, np.nan, luminance)[:, None]
    reasons = screen.reasons(to_lamp, to_receiver, readings)

    bands, warnings = RGB, []
    outside = _negative(factor, reasons)
    if np.any(outside):
        bands, factor = WIDE_RGB, factor @ REC2020_FROM_SRGB.T
        warnings.append(
            f"the colour lies outside sRGB in {np.max(outside)} samples (channel "
            f"{RGB.labels[int(np.argmax(outside))]} is negative): kept in {bands.words}"
        )
        warnings += [
            f"channel {label} is negative in {count} samples in {bands.words} too; it is taken as "
            "0 there"
            for label, count in zip(bands.labels, _negative(factor, reasons), strict=True)
            if count
        ]
    return require_samples(
        Measurement(
            name=brdf.description or path.stem,
            source=f"{path.name}, RGL material database format (Dupuy and Jakob 2018)",
            to_lamp=to_lamp,
            to_receiver=to_receiver,
            bands=bands,
            radiance_factor=np.where(unseen[:, None], np.nan, np.maximum(factor, 0.0)),
            reasons=reasons,
            group=group,
            warnings=tuple(warnings),
            synthetic=source_is_synthetic(path.name),
            tabulated=True,
        ),
        path,
    )


def _negative(factor: Array, reasons: AnyArray) -> Array:
    """How many kept samples are negative, in each channel."""
    return np.asarray(((factor < 0.0) & (reasons == table.KEPT)[:, None]).sum(axis=0))


def load(path: Path) -> RglBrdf:
    """Load a .bsdf file. Raises InputError where it is damaged, anisotropic or without rgb."""
    fields, names = tensor_file.read(path, FIELDS)
    if "rgb" not in fields and {"spectra", "wavelengths"} & names:
        raise InputError(
            f"{path}: the file holds spectra only; download the variant whose name ends in _rgb"
        )
    phi_i = _floats(path, fields, "phi_i", (None,))
    if len(phi_i) != 1:
        raise InputError(
            f"{path}: field 'phi_i' has {len(phi_i)} values: the material is anisotropic; "
            "only isotropic ones can be read"
        )
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
    rgb = _floats(path, fields, "rgb", (1, count, 3, None, None))[0]
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
        rgb=rgb,
        has_jacobian=bool(jacobian.any()),
    )


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
            "only isotropic rgb files of the RGL database can be read"
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
    rgb: Array  #: (T, 3, N, N)
    has_jacobian: bool  #: whether the values still lack ndf / (4 sigma)

    def evaluate(self, i: ArrayLike, o: ArrayLike) -> Array:
        """BRDF in 1/sr, linear sRGB, shape (..., 3); zero where a direction is not above z = 0.

        i (to the lamp) and o (to the eye) are unit vectors, (..., 3). Beyond the tabulated
        incidences the nearest slice holds.
        """
        return evaluate_above(i, o, self._above)

    def _above(self, i: Array, o: Array) -> Array:
        half = i + o
        half /= np.linalg.norm(half, axis=1)[:, None]
        theta_i, phi_i = _spherical(i)
        theta_h, phi_h = _spherical(half)
        lamp = np.stack([_theta_to_unit(theta_i), _phi_to_unit(phi_i)], axis=1)
        middle = np.stack([_theta_to_unit(theta_h), _phi_to_unit(phi_h - phi_i)], axis=1)

        slices = find_slices(self.theta_i, theta_i)
        values = bilinear(self.rgb, self.warp.invert(middle, slices), slices)
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
