"""Make the four synthetic sample papers: one green ink on four papers, on the paper's own grid.

The measurements of the 2000s paper were never published. These tables imitate them: angles and
bands are those of its goniophotometer, surfaces lie in the ranges of real papers, and nothing was
measured, which every file says in its source line.

Each table holds more than any fitted model can: a weak broad second lobe of another shape (GGX,
Walter et al. 2007), the blur of lamp and receiver apertures by quadrature over both directions,
and multiplicative noise. `truth.json` keeps what generated them.

    python scripts/make_sample_papers.py            # assets/papers/*.csv, truth.json
    python scripts/make_sample_papers.py --fit      # and assets/materials/*.json

The same seeds give the same files, byte for byte.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from relgloss_view.material import brdf
from relgloss_view.measure import gonio
from relgloss_view.measure.readers.gcms import write_gcms_csv

Array = NDArray[np.float64]

ASSETS = Path(__file__).resolve().parents[1] / "assets"
SOURCE = "synthetic (relgloss scripts/make_sample_papers.py), not the paper's data"
WAVELENGTHS_NM = np.arange(390.0, 731.0, 10.0)
QUADRATURE_NODES = 5  #: per axis: two axes of the lamp, two of the receiver


@dataclass(frozen=True)
class Paper:
    """What generates one table. Angles in degrees unless the name says otherwise."""

    name: str
    seed: int
    sigma_rad: float  #: Oren-Nayar slope sd
    s_deg: float  #: facet sd of the main lobe
    strength: float
    refractive_index: float
    ggx_alpha: float  #: of the broad second lobe
    ggx_strength: float
    ink_coverage: float  #: the rest is bare paper
    paper_white: float  #: reflectance of the bare paper in the long wavelengths
    ink_density: float  #: optical thickness of the ink film relative to the coated solid
    noise: float  #: relative standard deviation
    aperture_sd_deg: tuple[float, float] = (0.3, 0.4)


PAPERS = (
    Paper("cast-coated", 101, 0.05, 0.7, 1.00, 1.51, 0.22, 0.05, 0.985, 0.88, 1.00, 0.015),
    Paper("art-coated", 102, 0.05, 2.5, 1.00, 1.50, 0.35, 0.05, 0.980, 0.87, 0.97, 0.015),
    Paper("matte-coated", 103, 0.10, 6.0, 1.00, 1.50, 0.50, 0.06, 0.970, 0.87, 0.90, 0.020),
    Paper("uncoated", 104, 0.20, 15.0, 0.90, 1.47, 0.80, 0.08, 0.940, 0.84, 0.70, 0.025),
)


def sigmoid(x: Array) -> Array:
    """Logistic step from 0 to 1."""
    return np.asarray(1.0 / (1.0 + np.exp(-x)))


def green_reflectance(paper: Paper, wavelengths_nm: Array) -> Array:
    """Cyan printed over yellow, reflectance in each band.

    The films are Beer-Bouguer absorbers passed twice; the uncovered part of the paper joins by
    Yule and Nielsen 1951 with n = 2. The curves follow the usual shape of process inks (yellow
    absorbs below 490 nm; cyan from 570 nm, a little in the blue, less again beyond 720 nm); they
    are invented, like all else here.
    """
    w = wavelengths_nm
    yellow = 1.25 * sigmoid((492.0 - w) / 9.0) * (0.75 + 0.25 * np.exp(-(((w - 440) / 45) ** 2)))
    cyan = (
        0.88 * sigmoid((w - 571.0) / 15.0) * (1.0 - 0.35 * sigmoid((w - 722.0) / 9.0))
        + 0.16 * np.exp(-(((w - 385.0) / 40.0) ** 2))
        + 0.20
    )
    bare = paper.paper_white * (0.35 + 0.65 * sigmoid((w - 392.0) / 9.0))
    solid = bare * 10.0 ** (-paper.ink_density * (yellow + cyan))
    mixed = paper.ink_coverage * np.sqrt(solid) + (1.0 - paper.ink_coverage) * np.sqrt(bare)
    return np.asarray(mixed**2)


def ggx(f: brdf.Facing, alpha: float, n: float) -> Array:
    """Lobe of unit strength with the long-tailed facet density of Walter et al. 2007, in 1/sr."""
    cos2 = np.cos(np.sqrt(f.delta2)) ** 2
    density = alpha**2 / (np.pi * (cos2 * (alpha**2 - 1.0) + 1.0) ** 2)
    above = (f.mu_i > 0.0) & (f.mu_o > 0.0)
    value = 0.25 * density * brdf.fresnel_dielectric(f.cos_d, n) * brdf.shadowing(f)
    return np.where(above, value, 0.0)


def tangents(d: Array, toward: Array) -> tuple[Array, Array]:
    """Two unit vectors square to d, (N, 3): in the plane of d and `toward`, and across it."""
    across = np.cross(d, toward)
    length = np.linalg.norm(across, axis=-1, keepdims=True)
    fallback = np.cross(d, np.array([0.0, 1.0, 0.0]))
    fallback /= np.linalg.norm(fallback, axis=-1, keepdims=True)
    across = np.where(length > 1e-6, across / np.where(length > 1e-6, length, 1.0), fallback)
    return np.cross(across, d), across


def spread(d: Array, in_plane: Array, across: Array, x: float, y: float) -> Array:
    """Directions moved by the small angles x and y (radians) along the two tangents."""
    moved = d + np.tan(x) * in_plane + np.tan(y) * across
    return np.asarray(moved / np.linalg.norm(moved, axis=-1, keepdims=True))


def blurred_shapes(
    paper: Paper, to_lamp: Array, to_receiver: Array, nodes: int = QUADRATURE_NODES
) -> Array:
    """The four shapes (albedo, albedo^2, lobe, broad lobe) seen through both apertures, (4, N).

    Gauss-Hermite quadrature with `nodes` per axis over lamp and receiver directions: no
    half-vector approximation. What falls below the horizon counts as dark.
    """
    x, weight = np.polynomial.hermite_e.hermegauss(nodes)
    weight = weight / np.sum(weight)
    e_i, e_o = np.radians(paper.aperture_sd_deg)
    lamp_axes = tangents(to_lamp, to_receiver)
    receiver_axes = tangents(to_receiver, to_lamp)
    normal = np.array([0.0, 0.0, 1.0])
    total = np.zeros((4, len(to_lamp)))
    for a, b in np.ndindex(nodes, nodes):
        i = spread(to_lamp, *lamp_axes, e_i * x[a], e_i * x[b])
        for c, d in np.ndindex(nodes, nodes):
            o = spread(to_receiver, *receiver_axes, e_o * x[c], e_o * x[d])
            f = brdf.facing(np.broadcast_to(normal, i.shape), i, o)
            first, second = brdf.oren_nayar(f, paper.sigma_rad)
            lobe = brdf.torrance_sparrow(f, np.radians(paper.s_deg), paper.refractive_index)
            broad = ggx(f, paper.ggx_alpha, paper.refractive_index)
            w = weight[a] * weight[b] * weight[c] * weight[d]
            total += w * np.stack([first, second, lobe, broad])
    return total


def radiance_factor(paper: Paper, *, noise: bool = True) -> tuple[Array, Array]:
    """Angles (N, 3) in degrees and the radiance factors (N, B) of a paper."""
    angles = gonio.gcms4_grid()
    alpha, beta, gamma = angles.T
    to_lamp, to_receiver = gonio.gcms_directions(alpha, beta, gamma, gonio.GAMMA_S_DEG)
    first, second, lobe, broad = blurred_shapes(paper, to_lamp, to_receiver)
    rho = green_reflectance(paper, WAVELENGTHS_NM)
    specular = paper.strength * lobe + paper.ggx_strength * broad
    value = np.pi * (first[:, None] * rho + second[:, None] * rho**2 + specular[:, None])
    if noise:
        rng = np.random.default_rng(paper.seed)
        # The larger part of an instrument's error is common to all bands of one geometry.
        common = rng.standard_normal((len(value), 1))
        own = rng.standard_normal(value.shape)
        value *= np.exp(paper.noise * (np.sqrt(0.5) * common + np.sqrt(0.5) * own))
    return angles, value


def write_csv(paper: Paper, path: Path) -> None:
    """Write the GCMS-style table of one paper, four significant digits."""
    angles, value = radiance_factor(paper)
    write_gcms_csv(
        path,
        name=f"{paper.name}, green ink",
        source=SOURCE,
        quantity="radiance-factor",
        gamma_s_deg=gonio.GAMMA_S_DEG,
        angles_deg=angles,
        wavelengths_nm=[float(w) for w in WAVELENGTHS_NM],
        values=value,
        comments={"aperture_sd_deg": "{:g},{:g}".format(*paper.aperture_sd_deg)},
        digits=4,
    )


def write_truth(path: Path) -> None:
    """Write what generated the tables."""
    papers = {}
    for paper in PAPERS:
        albedo = green_reflectance(paper, WAVELENGTHS_NM)
        papers[paper.name] = asdict(paper) | {"albedo": [round(float(a), 6) for a in albedo]}
    truth = {"source": SOURCE, "wavelengths_nm": list(WAVELENGTHS_NM), "papers": papers}
    path.write_text(json.dumps(truth, indent=1) + "\n", encoding="utf-8")


def fit_papers(folder: Path, output: Path) -> None:
    """Fit the four tables in `folder` and write the materials to `output`."""
    from relgloss_view.fitting import describe_fit, fit_material
    from relgloss_view.material.files import save_material
    from relgloss_view.measure.readers import read_measurement

    output.mkdir(parents=True, exist_ok=True)
    for paper in PAPERS:
        material = fit_material(read_measurement(folder / f"{paper.name}.csv"))
        save_material(material, output / f"{paper.name}.json")
        print(describe_fit(material), end="\n\n")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--assets", type=Path, default=ASSETS, help="folder to write into")
    parser.add_argument("--fit", action="store_true", help="only fit the tables that are there")
    options = parser.parse_args()
    folder = options.assets / "papers"
    if options.fit:
        fit_papers(folder, options.assets / "materials")
        return
    folder.mkdir(parents=True, exist_ok=True)
    for paper in PAPERS:
        write_csv(paper, folder / f"{paper.name}.csv")
    write_truth(folder / "truth.json")


if __name__ == "__main__":
    main()
