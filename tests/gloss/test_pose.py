"""Peaks of highlights against closed forms, and against pictures of the float64 renderer."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from materials import paper

from relgloss_view.gloss.pose import Pose
from relgloss_view.material.material import Lobe
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup


def cie_lightness(y):
    """CIE 15:2004, written out for the bright branch alone."""
    assert y > 216 / 24389
    return 116.0 * y ** (1 / 3) - 16.0


def facing_lamp(kind="sphere"):
    """A lamp behind the eye, far away: the highlight's place has i = o = n and shows Y_n."""
    return Setup(Shape(kind), Lamp(azimuth_deg=0.0, distance_m=500.0), Eye(distance_m=500.0))


def gray(s_deg, strength=1.0, albedo=0.2):
    """A neutral material of one lobe over a Lambertian body."""
    base = paper("cast")
    count = base.bands.count
    diffuse = dataclasses.replace(
        base.diffuse, model="lambert", albedo=(albedo,) * count, sigma_deg=0.0
    )
    lobe = Lobe(strength=(strength,), refractive_index=1.5, s_deg=s_deg)
    return dataclasses.replace(base, diffuse=diffuse, specular=(lobe,))


@pytest.mark.parametrize("s_deg", [0.5, 2.0, 8.0])
@pytest.mark.parametrize("sigma_n_deg", [0.0, 1.5])
def test_retroreflecting_peak_is_the_closed_form(s_deg, sigma_n_deg):
    """Y_s = pi D F0 / 4, D = (1 + 4 s^2 / 3) / (2 pi s^2) to 1 % at 8 degrees, F0 = 0.04.

    Under grain the mean of the lobe is smaller by (1 + (sigma_N / s)^2)^-1/2.
    """
    s = math.radians(s_deg)
    density = (1.0 + 4.0 * s * s / 3.0) / (2.0 * math.pi * s * s)
    y_s = math.pi * density * 0.04 / 4.0 / math.sqrt(1.0 + (sigma_n_deg / s_deg) ** 2)
    expected = cie_lightness(0.2 + y_s) - cie_lightness(0.2)
    found = Pose(facing_lamp()).peak(gray(s_deg), sigma_n_deg)
    assert found == pytest.approx(expected, rel=0.01)


def test_c_max_is_the_limit_of_the_pictures():
    """A picture's pixels are a subset of the object, so its c_max is never below the limit."""
    material, setup = paper("matte"), Setup()
    limit = Pose(setup).extremes(material).smallest_ratio
    sizes = (24, 96, 240)
    with_size = [
        ReferenceRenderer().render(Scene(material, setup), Look(), (n, n)).c_max for n in sizes
    ]
    assert all(c_max >= limit * (1.0 - 1e-6) for c_max in with_size)
    assert with_size[-1] == pytest.approx(limit, rel=1e-3)
    assert with_size[0] > limit * (1.0 + 1e-4)  # the control: small pictures miss the peak


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane"])
def test_peak_is_that_of_a_fine_picture(kind):
    eye = Eye(azimuth_deg=-30.0) if kind == "plane" else Eye()
    setup, material = Setup(Shape(kind), Lamp(azimuth_deg=30.0), eye), paper("matte")
    frame = ReferenceRenderer().render(Scene(material, setup), Look(), (200, 200))
    # The nearest pixel's centre is up to 0.35 px beside the place: 0.3 degrees of a sphere's turn,
    # of a lobe of 6 degrees: exp(-0.5 (0.3 / 6)^2 / 3) = 0.9996 of L* + 16, 0.9 % of L_s*.
    assert Pose(setup).peak(material) == pytest.approx(np.max(frame.split[1]), rel=9e-3)


def test_a_highlight_beside_the_object_is_no_highlight():
    beside = Setup(Shape("plane"), Lamp(azimuth_deg=50.0))
    assert Pose(beside).peak(paper("cast")) is None
    mirrored = Setup(Shape("plane"), Lamp(azimuth_deg=50.0), Eye(azimuth_deg=-50.0))
    assert Pose(mirrored).peak(paper("cast")) > 100.0
    assert Pose(Setup(lamp=Lamp(azimuth_deg=180.0))).peak(paper("cast")) is None
    assert Pose(mirrored).peak(dataclasses.replace(paper("cast"), specular=())) is None
