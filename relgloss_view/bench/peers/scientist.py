"""The straightforward pipeline: numpy a pixel and a wavelength at a time, then colour-science.

Written as plainly as somebody would who has the paper, a fitted material and an afternoon: float64,
angles by arccos, every band, no folding. Drawn are the same cylinder and lamp.
"""

from __future__ import annotations

import warnings

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.scene import Scene


def draw(scene: Scene, size: Size, sigma_n_deg: float, c_fraction: float, seed: int) -> Array:
    """(H, W, 3), sRGB 0..1 of one stimulus; the surround is black."""
    width, height = size
    view = View.of(scene, size)
    rays = view.rays(slice(0, height))
    rays = rays / np.linalg.norm(rays, axis=-1, keepdims=True)
    found, points, normals = _cylinder(scene, view.eye_m, rays)
    to_eye = -rays[found]
    to_lamp = scene.lamp.position_m - points
    distance = np.linalg.norm(to_lamp, axis=-1, keepdims=True)
    to_lamp = to_lamp / distance
    irradiance = 1.0 / distance[:, 0] ** 2
    white = np.max(np.maximum(_dot(normals, to_lamp), 0.0) * irradiance)
    noisy = _tilt(normals, np.radians(sigma_n_deg), np.random.default_rng(seed))
    diffuse, specular = _brdf(scene, noisy, to_lamp, to_eye)
    light = np.pi * np.maximum(_dot(noisy, to_lamp), 0.0) * irradiance / white
    checkpoint()
    picture = np.zeros((height, width, 3))
    picture[found] = _shown(scene, diffuse * light[:, None], specular * light[:, None], c_fraction)
    return picture


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.sum(a * b, axis=-1))


def _cylinder(scene: Scene, eye: Array, rays: Array) -> tuple[Mask, Array, Array]:
    """Which rays meet the side of the cylinder; where; the normals there."""
    radius = 0.5 * scene.shape.diameter_m
    a = rays[..., 0] ** 2 + rays[..., 2] ** 2
    b = rays[..., 0] * eye[0] + rays[..., 2] * eye[2]
    c = eye[0] ** 2 + eye[2] ** 2 - radius**2
    discriminant = b**2 - a * c
    travel = (-b - np.sqrt(np.maximum(discriminant, 0.0))) / a
    points = eye + travel[..., None] * rays
    found = (discriminant > 0.0) & (np.abs(points[..., 1]) <= 0.5 * scene.shape.height_m)
    points = points[found]
    return found, points, points * (1.0, 0.0, 1.0) / radius


def _tilt(normals: Array, sigma_n: float, random: np.random.Generator) -> Array:
    """Normals tilted by Gaussian angles to uniform azimuths."""
    theta = sigma_n * random.standard_normal(len(normals))[:, None]
    phi = 2.0 * np.pi * random.random(len(normals))[:, None]
    tangent = np.cross(normals, (0.0, 1.0, 0.0))
    bitangent = np.cross(normals, tangent)
    aside = np.cos(phi) * tangent + np.sin(phi) * bitangent
    return np.asarray(np.cos(theta) * normals + np.sin(theta) * aside)


def _brdf(scene: Scene, n: Array, i: Array, o: Array) -> tuple[Array, Array]:
    """Oren-Nayar and Torrance-Sparrow, (pixels, bands) each."""
    diffuse, bands = scene.material.diffuse, scene.material.bands.count
    cos_i, cos_o = np.clip(_dot(n, i), 1e-4, 1.0), np.clip(_dot(n, o), 1e-4, 1.0)
    theta_i, theta_o = np.arccos(cos_i), np.arccos(cos_o)
    alpha, beta = np.maximum(theta_i, theta_o), np.minimum(theta_i, theta_o)
    flat_i, flat_o = i - cos_i[:, None] * n, o - cos_o[:, None] * n
    across = np.linalg.norm(flat_i, axis=-1) * np.linalg.norm(flat_o, axis=-1)
    cos_phi = _dot(flat_i, flat_o) / np.maximum(across, 1e-7)
    s2 = diffuse.sigma**2
    c1 = 1.0 - 0.5 * s2 / (s2 + 0.33)
    bent = np.where(cos_phi >= 0.0, 0.0, (2.0 * beta / np.pi) ** 3)
    c2 = 0.45 * s2 / (s2 + 0.09) * (np.sin(alpha) - bent)
    c3 = 0.125 * s2 / (s2 + 0.09) * (4.0 * alpha * beta / np.pi**2) ** 2
    once = (
        c1 + cos_phi * c2 * np.tan(beta) + (1 - np.abs(cos_phi)) * c3 * np.tan((alpha + beta) / 2)
    )
    twice = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_phi * (2.0 * beta / np.pi) ** 2)
    albedo = np.asarray(diffuse.albedo)
    f_d = (once[:, None] * albedo + twice[:, None] * albedo**2) / np.pi

    h = (i + o) / np.linalg.norm(i + o, axis=-1, keepdims=True)
    cos_h, cos_d = np.clip(_dot(n, h), 0.0, 1.0), np.clip(_dot(i, h), 1e-4, 1.0)
    delta = np.arccos(cos_h)
    g = np.minimum(1.0, 2.0 * cos_h * np.minimum(cos_i, cos_o) / cos_d)
    f_s = np.zeros_like(f_d)
    for lobe in scene.material.specular:
        s = lobe.s
        d = (1.0 + 4.0 * s**2 / 3.0) / (2.0 * np.pi * s**2) * np.exp(-(delta**2) / (2.0 * s**2))
        q = np.sqrt(lobe.refractive_index**2 - 1.0 + cos_d**2)
        ratio = (cos_d * (q + cos_d) - 1.0) / (cos_d * (q - cos_d) + 1.0)
        fresnel = 0.5 * ((q - cos_d) / (q + cos_d)) ** 2 * (1.0 + ratio**2)
        colour = lobe.per_band(bands) * fresnel[:, None]
        if lobe.f0 is not None:  # Schlick 1994
            white = ((1.0 - cos_d) ** 5)[:, None]
            colour = lobe.per_band(bands) * ((1.0 - white) * np.asarray(lobe.f0) + white)
        f_s = f_s + (d * g / (4.0 * cos_i * cos_o))[:, None] * colour
    seen = ((_dot(n, i) > 0.0) & (_dot(n, o) > 0.0))[:, None]
    return np.where(seen, f_d, 0.0), np.where(seen, f_s, 0.0)


def load() -> None:
    """Import colour-science; whatever it or a library behind it raises goes on."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import colour  # noqa: F401


def _shown(scene: Scene, diffuse: Array, specular: Array, c_fraction: float) -> Array:
    """sRGB of spectral radiances: XYZ, L* split, specular part scaled, back again."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # colour-science on what else is installed
        import colour

        centres = scene.material.bands.centres_nm()
        checkpoint()  # the import has taken a while
        shape = colour.SpectralShape(centres[0], centres[-1], centres[1] - centres[0])
        cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
        lamp = colour.SDS_ILLUMINANTS[scene.lamp.illuminant].copy().align(shape)
        xyz_d = colour.msds_to_XYZ(diffuse, cmfs, lamp, method="Integration", shape=shape) / 100
        xyz_s = colour.msds_to_XYZ(specular, cmfs, lamp, method="Integration", shape=shape) / 100
        white_xyz = colour.sd_to_XYZ(colour.sd_ones(shape), cmfs, lamp) / 100
        white = colour.XYZ_to_xy(white_xyz)
        lab_d = colour.XYZ_to_Lab(xyz_d, white)
        lab = colour.XYZ_to_Lab(xyz_d + xyz_s, white)
        l_d, l_s = lab_d[..., 0], lab[..., 0] - lab_d[..., 0]
        c_max = np.min((100.0 - l_d[l_s > 1e-6]) / l_s[l_s > 1e-6], initial=1e30)
        lab[..., 0] = l_d + c_fraction * c_max * l_s
        d65 = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
        return np.clip(colour.XYZ_to_sRGB(colour.Lab_to_XYZ(lab, d65), d65), 0.0, 1.0)
