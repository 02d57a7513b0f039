"""Random valid scenes over the whole declared ranges, and the comparison of their pictures.

Each value lies at an end of its range, at its default, or anywhere in it: log-uniform where the
range spans decades. Equal seeds give equal scenes.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.material import (
    ALBEDO_MAX,
    DIFFUSE_MODELS,
    INDEX_RANGE,
    S_DEG_MAX,
    SIGMA_DEG_MAX,
    STRENGTH_MAX,
    Diffuse,
    Lobe,
    Material,
)
from relgloss_view.material.spectra import SHIPPED_ILLUMINANTS
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.pack.shape import ANALYTIC, Shape
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

SIZE = (24, 24)
DECADE = 10.0
SMALLEST_WIDTH_DEG = 5e-324  #: above 0, as Lobe allows


def _number(rng, low, high, usual=None):
    """A number of a range: an end of it, the usual one, or anywhere."""
    kind = rng.uniform()
    if kind < 0.12:
        return float(rng.choice([low, high]))
    if kind < 0.3 and usual is not None:
        return float(usual)
    positive = low if low > 0.0 else 1e-6 * high
    if low >= 0.0 and high / positive > DECADE and rng.uniform() < 0.8:
        return float(np.clip(math.exp(rng.uniform(math.log(positive), math.log(high))), low, high))
    return float(rng.uniform(low, high))


def _field(rng, f):
    meta = f.metadata
    if "options" in meta:
        return str(rng.choice(meta["options"]))
    if f.name == "illuminant":
        return str(rng.choice((*SHIPPED_ILLUMINANTS, "FL11")))
    if "range" not in meta or (meta.get("optional") and rng.uniform() < 0.5):
        return f.default
    low, high = meta["range"].low, meta["range"].high
    value = _number(rng, low, high, f.default)
    return round(value) if meta.get("whole") else value


def _part(rng, part, **fixed):
    """A frozen dataclass; combinations that it refuses are drawn again."""
    while True:
        entries = {f.name: _field(rng, f) for f in dataclasses.fields(part)} | fixed
        try:
            made = part(**entries)
            # A black may contradict a white that only a setup assumes.
            return Setup(display=made).display if part is Display else made
        except InputError:
            continue


def bands_of(rng):
    """Linear sRGB, a regular table, or bands at any places."""
    kind = rng.uniform()
    if kind < 0.3:
        return RGB
    if kind < 0.6:
        step = float(rng.choice([5.0, 10.0, 20.0, 50.0]))
        return Bands(tuple(np.arange(380.0 + step * rng.integers(0, 3), 731.0, step)))
    count = int(rng.integers(2, 12))
    while True:
        low, high = ((380.0, 780.0), (100.0, 3000.0))[int(rng.uniform() < 0.15)]
        places = np.sort(np.round(rng.uniform(low, high, count), 1))
        if rng.uniform() < 0.3:  # two bands that almost touch
            places[1:2] = places[0] + 1.0
            places = np.sort(places)
        try:
            return Bands(tuple(float(v) for v in places))
        except InputError:
            continue


def material_of(rng):
    bands = bands_of(rng)

    def spectrum(low, high, usual):
        if rng.uniform() < 0.3:
            return (_number(rng, low, high, usual),) * bands.count
        return tuple(_number(rng, low, high, usual) for _ in range(bands.count))

    top = ALBEDO_MAX if rng.uniform() < 0.2 else 1.0
    diffuse = Diffuse(
        str(rng.choice(DIFFUSE_MODELS)),
        spectrum(0.0, top, 0.3),
        _number(rng, 0.0, SIGMA_DEG_MAX, 6.0),
    )
    lobes = []
    for _ in range(int(rng.integers(0, 3))):
        low = SMALLEST_WIDTH_DEG if rng.uniform() < 0.2 else 0.05
        strength = (
            spectrum(0.0, STRENGTH_MAX, 1.0)
            if rng.uniform() < 0.3
            else (_number(rng, 0.0, STRENGTH_MAX, 1.0),)
        )
        lobes.append(
            Lobe(strength, _number(rng, low, S_DEG_MAX, 5.0), _number(rng, *INDEX_RANGE, 1.5))
        )
    return Material("any", "synthetic", bands, diffuse, tuple(lobes), synthetic=True)


def _eye(rng):
    """An eye; most look at the object's centre, since a shift leaves few pixels of the object."""
    if rng.uniform() < 0.85:
        return _part(rng, Eye, shift_right=0.0, shift_up=0.0)
    reach = 10.0 ** rng.uniform(-3.0, 2.0)
    return _part(
        rng,
        Eye,
        shift_right=float(rng.uniform(-reach, reach)),
        shift_up=float(rng.uniform(-reach, reach)),
    )


def random_scene(seed, *, grain=None):
    """A scene and a look: without grain, or with grain of a kind."""
    rng = np.random.default_rng(seed)
    display = Display() if rng.uniform() < 0.5 else _part(rng, Display)
    eye, lamp = _eye(rng), _part(rng, Lamp)
    if rng.uniform() < 0.6:  # most lamps of the sphere light nothing that the eye sees
        turn = float(rng.uniform(-90.0, 90.0))
        azimuth_deg = (eye.azimuth_deg + turn + 180.0) % 360.0 - 180.0
        elevation_deg = float(np.clip(eye.elevation_deg + rng.uniform(-60.0, 60.0), -90.0, 90.0))
        lamp = dataclasses.replace(lamp, azimuth_deg=azimuth_deg, elevation_deg=elevation_deg)
    # A rasteriser moves the corners of triangles by 1/256 of a pixel. That shows where sizes of any
    # proportion leave triangles thinner than it, so triangles are drawn at the proportions of packs
    # instead (tests/picture/test_packs_against_reference.py).
    shape = _part(rng, Shape, kind=str(rng.choice(ANALYTIC)))
    scene = Scene(material_of(rng), shape=shape, lamp=lamp, eye=eye, display=display)
    samples = (1, 1, 1, 2, 3)[int(rng.integers(0, 5))]
    look = _part(rng, Look, sigma_n_deg=0.0, samples=samples, c_fraction=None)
    if grain is None:
        return scene, look
    sigma_n_deg = _number(rng, 1e-3, 10.0, 2.0)
    return scene, dataclasses.replace(look, grain=grain, sigma_n_deg=sigma_n_deg)


@dataclass(frozen=True)
class Difference:
    """How a picture differs from the reference's."""

    silhouette: int  #: pixels whose share of the object differs
    delta_e: float  #: largest dE2000 of displayed light, over pixels that both show
    off: float  #: share of those pixels with more than 0.5
    c: float  #: of c, relative
    darkest: float  #: smallest X, Y or Z of either picture
    seen: int  #: pixels that show the object

    @classmethod
    def of(cls, frame, truth):
        both = frame.on_object & truth.on_object
        delta_e = delta_e_2000(_displayed_lab(frame), _displayed_lab(truth))[both]
        stages = (frame.diffuse, frame.specular, truth.diffuse, truth.specular)
        return cls(
            silhouette=int(np.sum(np.abs(frame.coverage - truth.coverage) > 1e-6)),
            delta_e=float(np.max(delta_e, initial=0.0)),
            off=float(np.mean(delta_e > 0.5)) if delta_e.size else 0.0,
            c=abs(frame.c - truth.c) / max(abs(truth.c), 1e-12),
            darkest=float(min(np.min(stage) for stage in stages)),
            seen=int(np.sum(truth.on_object)),
        )


def _displayed_lab(frame):
    model = DisplayModel.of(frame.scene.display)
    xyz = frame.light.astype(np.float64) @ np.linalg.inv(model.rgb_from_xyz).T
    return tone.lab_from_xyz(np.maximum(xyz, 0.0), model.white)
