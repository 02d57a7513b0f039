"""Klems's matrix of a material: the BRDF between 145 x 145 patches, averaged over both.

A patch is 10 degrees wide, so a highlight becomes as wide as its patch: WINDOW has no finer basis.
Lobes are integrated over their half-vectors, where they are smooth however narrow, and their light
is counted in the patch that it falls into; so the energy is right (Klems 1994).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.exchange.channels import TableSurface
from relgloss_view.exchange.loss import LAMP
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers.klems import Basis, Ring, known_bases
from relgloss_view.measure.readers.tristimulus import SRGB_FROM_XYZ

BASIS_NAME = "LBNL/Klems Full"
SUB = 4  #: places of a patch along each axis, of the incidence and of the diffuse part
LOBE_NODES = 20  #: of the lobe's facet angle, and twice as many of its azimuth
REACH_SD = 6.0
#: The order of the blocks of a WINDOW file, and the row of XYZ.
WAVELENGTHS = {"CIE-X": 0, "Visible": 1, "CIE-Z": 2}


@dataclass(frozen=True)
class Patches:
    """matrices: (3, 145, 145), XYZ of the mean BRDF, 1/sr: outgoing patch, then incident."""

    basis: Basis
    matrices: Array

    @classmethod
    def of(cls, material: Material) -> Patches:
        """The mean BRDFs of a material, symmetric as reciprocity asks."""
        basis = known_bases()[BASIS_NAME.lower()]
        weights = material.xyz_weights(illuminant(LAMP))
        size = basis.count
        total = np.zeros((3, size, size))
        out = _places(basis)
        projected = _projected(basis)
        first = 0
        for ring in basis.rings:
            for theta in _polar(ring):
                light = _lobes(material, theta, weights)
                for k in range(ring.count):
                    azimuth = 360.0 / ring.count * k
                    diffuse = _diffuse(material, theta, azimuth, out, weights)
                    shine = np.zeros_like(diffuse)
                    for part in (np.arange(SUB) + 0.5) / SUB - 0.5:
                        turned = light.phi_deg + azimuth + 360.0 / ring.count * part
                        patch = _patch_at(basis, light.theta_deg, turned)
                        for flux, xyz in light.parts:
                            shine += np.outer(xyz, np.bincount(patch, flux, size))
                    total[:, :, first + k] += (diffuse + shine / SUB / projected) / SUB
            first += ring.count
        return cls(basis, 0.5 * (total + np.swapaxes(total, 1, 2)))

    def blocks(self) -> list[str]:
        """The WavelengthData of both sides, which are alike."""
        return [
            _block(wavelength, side, self.matrices[row])
            for wavelength, row in WAVELENGTHS.items()
            for side in ("Front", "Back")
        ]

    def definition(self) -> str:
        """The AngleBasis of a file."""
        rings = [
            f"<AngleBasisBlock>\n<Theta>{ring.centre:g}</Theta>\n<nPhis>{ring.count}</nPhis>\n"
            f"<ThetaBounds>\n<LowerTheta>{ring.lower:g}</LowerTheta>\n"
            f"<UpperTheta>{ring.upper:g}</UpperTheta>\n</ThetaBounds>\n</AngleBasisBlock>\n"
            for ring in self.basis.rings
        ]
        name = f"<AngleBasisName>{self.basis.name}</AngleBasisName>\n"
        return f"<AngleBasis>\n{name}{''.join(rings)}</AngleBasis>\n"

    def surface(self) -> TableSurface:
        """The matrix as a surface: the value of the patches that hold the directions."""

        def values(i: Array, o: Array) -> Array:
            to, off = _patch_of(self.basis, -i[:, :2], i[:, 2]), _patch_of(self.basis, o, o[:, 2])
            return np.asarray(self.matrices[:, off, to].T @ SRGB_FROM_XYZ.T)

        return TableSurface(values)

    def lines(self) -> tuple[str, ...]:
        """What a file carries and loses."""
        return (
            f"carried: the mean BRDF between {self.basis.count} x {self.basis.count} patches "
            f"({self.basis.name}), X, Y and Z under {LAMP}, alike for front and back",
            f"lost: every highlight narrower than its patch of about "
            f"{2.0 * self.basis.spread_deg():.0f} deg, and so the gloss; "
            "Radiance reads --basis tensor-tree, which keeps it",
        )


def _polar(ring: Ring) -> Array:
    """Polar angles of a ring, (SUB,) degrees, evenly spread in projected solid angle."""
    low, high = (np.sin(np.radians(angle)) ** 2 for angle in (ring.lower, ring.upper))
    part = (np.arange(SUB) + 0.5) / SUB
    return np.asarray(np.degrees(np.arcsin(np.sqrt(low + (high - low) * part))))


def _places(basis: Basis) -> Array:
    """Unit vectors (P, SUB^2, 3) of each patch, evenly spread in projected solid angle."""
    part = (np.arange(SUB) + 0.5) / SUB
    return np.array(
        [
            spherical(
                np.repeat(_polar(ring), SUB), np.tile(360.0 / ring.count * (k + part - 0.5), SUB)
            )
            for ring in basis.rings
            for k in range(ring.count)
        ]
    )


def _projected(basis: Basis) -> Array:
    """Projected solid angle of each patch, (P,)."""
    return np.concatenate(
        [
            np.full(
                ring.count,
                np.pi
                / ring.count
                * (np.sin(np.radians(ring.upper)) ** 2 - np.sin(np.radians(ring.lower)) ** 2),
            )
            for ring in basis.rings
        ]
    )


def _diffuse(
    material: Material, theta_deg: float, azimuth_deg: float, out: Array, weights: Array
) -> Array:
    """XYZ (3, P) of the diffuse part's mean over each outgoing patch.

    azimuth_deg: of where the light goes.
    """
    i = spherical(theta_deg, azimuth_deg + 180.0)
    t = out[..., 0] * i[0] + out[..., 1] * i[1]
    unread = np.zeros(())
    f = brdf.Facing(np.full(t.shape, i[2]), out[..., 2], t, unread, unread)
    body = material.diffuse
    first, second = (
        np.mean(shape, axis=1) for shape in brdf.diffuse_shapes(body.model, f, body.sigma)
    )
    return np.outer(np.asarray(body.albedo) @ weights, first) + np.outer(
        material.second_albedo() @ weights, second
    )


class _Light(NamedTuple):
    """Light of the lobes in N directions, for incidence at azimuth 180 (towards azimuth 0)."""

    theta_deg: Array  #: (N,)
    phi_deg: Array
    parts: tuple[tuple[Array, Array], ...]  #: of each lobe: flux (N,) and its XYZ (3,)


def _lobes(material: Material, theta_deg: float, weights: Array) -> _Light:
    """The light that the lobes send, at nodes over their half-vectors: dw_o = 4 (i.h) dw_h."""
    i = spherical(theta_deg, 180.0)
    node, node_weight = np.polynomial.legendre.leggauss(LOBE_NODES)
    phi = (np.arange(2 * LOBE_NODES) + 0.5) * np.pi / LOBE_NODES
    directions, parts = [], []
    lobes = material.visible_lobes()
    for lobe in lobes:
        reach = min(REACH_SD * lobe.s, 0.5 * np.pi)
        delta = np.repeat(0.5 * reach * (node + 1.0), len(phi))
        turn = np.tile(phi, LOBE_NODES)
        h = np.stack(
            [np.sin(delta) * np.cos(turn), np.sin(delta) * np.sin(turn), np.cos(delta)], axis=-1
        )
        area = 0.5 * reach * np.repeat(node_weight, len(phi)) * np.sin(delta) * np.pi / LOBE_NODES
        ih = np.maximum(h @ i, 0.0)
        o = 2.0 * ih[:, None] * h - i
        f = brdf.Facing(np.full(len(o), i[2]), o[:, 2], np.zeros(len(o)), ih, delta * delta)
        cos = np.maximum(o[:, 2], 0.0)
        directions.append(o)
        parts.append(
            [
                (brdf.torrance_sparrow(f, lobe.s, p.fresnel) * cos * 4.0 * ih * area, p.spectrum)
                for p in lobe.parts(material.bands.count)
            ]
        )
    if not lobes:
        return _Light(np.zeros(0), np.zeros(0), ())
    o = np.concatenate(directions)
    sizes = np.cumsum([0, *(len(each) for each in directions)])
    fluxes = []
    for k, each in enumerate(parts):
        for flux, spectrum in each:
            padded = np.zeros(len(o))
            padded[sizes[k] : sizes[k + 1]] = flux
            fluxes.append((padded, spectrum @ weights))
    theta = np.degrees(np.arccos(np.clip(o[:, 2], 0.0, 1.0)))
    return _Light(theta, np.degrees(np.arctan2(o[:, 1], o[:, 0])), tuple(fluxes))


def _patch_of(basis: Basis, across: Array, cos: Array) -> Ints:
    """The patch (M,) of directions: their components across the normal, and their cosine."""
    theta = np.degrees(np.arccos(np.clip(cos, 0.0, 1.0)))
    return _patch_at(basis, theta, np.degrees(np.arctan2(across[:, 1], across[:, 0])))


def _patch_at(basis: Basis, theta_deg: Array, phi_deg: Array) -> Ints:
    """The patch (M,) at polar angles and azimuths, degrees."""
    uppers = np.array([ring.upper for ring in basis.rings])
    counts = np.array([ring.count for ring in basis.rings])
    ring = np.clip(np.searchsorted(uppers, theta_deg, side="right"), 0, len(uppers) - 1)
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    step = np.floor(phi_deg / 360.0 * counts[ring] + 0.5).astype(np.intp) % counts[ring]
    return np.asarray(first[ring] + step)


def _block(wavelength: str, side: str, matrix: Array) -> str:
    rows = ",\n".join(",".join(f"{value:.6g}" for value in row) for row in matrix.tolist())
    detector = {"CIE-X": "X", "Visible": "Y", "CIE-Z": "Z"}[wavelength]
    return (
        "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n"
        f'<Wavelength unit="Integral">{wavelength}</Wavelength>\n'
        "<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n"
        f"<DetectorSpectrum>ASTM E308 1931 {detector}.dsp</DetectorSpectrum>\n"
        "<WavelengthDataBlock>\n"
        f"<WavelengthDataDirection>Reflection {side}</WavelengthDataDirection>\n"
        f"<ColumnAngleBasis>{BASIS_NAME}</ColumnAngleBasis>\n"
        f"<RowAngleBasis>{BASIS_NAME}</RowAngleBasis>\n"
        "<ScatteringDataType>BRDF</ScatteringDataType>\n"
        f"<ScatteringData>\n{rows}\n</ScatteringData>\n"
        "</WavelengthDataBlock>\n</WavelengthData>\n"
    )
