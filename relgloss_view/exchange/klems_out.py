"""Klems's matrix of a material: the BRDF between 145 x 145 patches, averaged over both.

A patch is 10 degrees wide, so a highlight becomes as wide as its patch: WINDOW has no finer basis.
Lobes are integrated over their half-vectors, where they are smooth however narrow, and their light
is counted in the patch that it falls into; so the energy is right (Klems 1994).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.exchange.channels import LAMP, TableSurface
from relgloss_view.material import brdf
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers.klems import Basis, known_bases
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
        theta, phi, share = _places(basis)  # (P, K) each
        out = spherical(theta, phi)  # (P, K, 3)
        projected = _projected(basis)
        for patch in range(size):
            # Azimuths of incidence are those of where the light goes.
            for k in range(theta.shape[1]):
                i = spherical(theta[patch, k], phi[patch, k] + 180.0)
                own = share[patch, k]
                total[:, :, patch] += own * _diffuse(material, i, out, share, weights)
                total[:, :, patch] += own * _lobes(material, i, basis, weights) / projected
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
        parts = [f"<AngleBasis>\n<AngleBasisName>{self.basis.name}</AngleBasisName>\n"]
        for ring in self.basis.rings:
            parts.append(
                f"<AngleBasisBlock>\n<Theta>{ring.centre:g}</Theta>\n<nPhis>{ring.count}</nPhis>\n"
                f"<ThetaBounds>\n<LowerTheta>{ring.lower:g}</LowerTheta>\n"
                f"<UpperTheta>{ring.upper:g}</UpperTheta>\n</ThetaBounds>\n</AngleBasisBlock>\n"
            )
        return "".join(parts) + "</AngleBasis>\n"

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


def _places(basis: Basis) -> tuple[Array, Array, Array]:
    """Places of each patch, evenly spread in projected solid angle: theta, phi (degrees) and the
    share of the patch, (P, K) each.
    """
    part = (np.arange(SUB) + 0.5) / SUB
    theta, phi = [], []
    for ring in basis.rings:
        low, high = (np.sin(np.radians(angle)) ** 2 for angle in (ring.lower, ring.upper))
        polar = np.degrees(np.arcsin(np.sqrt(low + (high - low) * part)))
        for k in range(ring.count):
            azimuth = 360.0 / ring.count * (k + part - 0.5)
            theta.append(np.repeat(polar, SUB))
            phi.append(np.tile(azimuth, SUB))
    theta_all, phi_all = np.array(theta), np.array(phi)
    return theta_all, phi_all, np.full_like(theta_all, 1.0 / SUB**2)


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


def _diffuse(material: Material, i: Array, out: Array, share: Array, weights: Array) -> Array:
    """XYZ (3, P) of the diffuse part's mean over each outgoing patch."""
    normal = np.broadcast_to(np.array([0.0, 0.0, 1.0]), out.shape)
    f = brdf.facing(normal, np.broadcast_to(i, out.shape), out)
    body = material.diffuse
    first, second = (
        np.sum(share * shape, axis=1) for shape in brdf.diffuse_shapes(body.model, f, body.sigma)
    )
    return np.outer(np.asarray(body.albedo) @ weights, first) + np.outer(
        material.second_albedo() @ weights, second
    )


def _lobes(material: Material, i: Array, basis: Basis, weights: Array) -> Array:
    """XYZ (3, P) of the light that the lobes send into each patch."""
    total = np.zeros((3, basis.count))
    node, node_weight = np.polynomial.legendre.leggauss(LOBE_NODES)
    phi = (np.arange(2 * LOBE_NODES) + 0.5) * np.pi / LOBE_NODES
    for lobe in material.visible_lobes():
        reach = min(REACH_SD * lobe.s, 0.5 * np.pi)
        delta = 0.5 * reach * (node + 1.0)
        sin = np.sin(delta)[:, None]
        h = np.stack(
            [sin * np.cos(phi), sin * np.sin(phi), np.cos(delta)[:, None] + 0.0 * phi], axis=-1
        ).reshape(-1, 3)
        area = np.repeat(0.5 * reach * node_weight * np.sin(delta) * np.pi / LOBE_NODES, len(phi))
        ih = h @ i
        o = 2.0 * ih[:, None] * h - i
        kept = (ih > 0.0) & (o[:, 2] > 0.0)
        o, h, ih, area = o[kept], h[kept], ih[kept], area[kept]
        delta2 = np.arccos(np.clip(h[:, 2], -1.0, 1.0)) ** 2
        f = brdf.Facing(np.full(len(o), i[2]), o[:, 2], np.zeros(len(o)), ih, delta2)
        patch = _patch_of(basis, o, o[:, 2])
        for part in lobe.parts(material.bands.count):
            flux = brdf.torrance_sparrow(f, lobe.s, part.fresnel) * o[:, 2] * 4.0 * ih * area
            total += np.outer(part.spectrum @ weights, np.bincount(patch, flux, basis.count))
    return total


def _patch_of(basis: Basis, across: Array, cos: Array) -> Ints:
    """The patch (M,) of directions: their components across the normal, and their cosine."""
    theta = np.degrees(np.arccos(np.clip(cos, 0.0, 1.0)))
    phi = np.degrees(np.arctan2(across[:, 1], across[:, 0])) % 360.0
    uppers = np.array([ring.upper for ring in basis.rings])
    counts = np.array([ring.count for ring in basis.rings])
    ring = np.clip(np.searchsorted(uppers, theta, side="right"), 0, len(uppers) - 1)
    first = np.concatenate([[0], np.cumsum(counts)[:-1]])
    step = np.floor(phi / 360.0 * counts[ring] + 0.5).astype(np.intp) % counts[ring]
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
