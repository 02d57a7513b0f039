"""Profiles of displays, read back by LittleCMS and held against known values."""

from __future__ import annotations

import io
import struct

import numpy as np
import pytest
from PIL import Image, ImageCms

from relgloss_view import Look, Scene, load_sample, open_renderer
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import (
    adaptation_to_d50,
    matrix_profile,
    profile_of,
    srgb_profile,
)
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.spectra import white_from_xy
from relgloss_view.picture.model import tone
from relgloss_view.picture.output.png import save_png

P3 = ((0.68, 0.32), (0.265, 0.69), (0.15, 0.06))
DISPLAYS = {
    "srgb curve, P3 primaries": Display(primaries_xy=P3),
    "gamma": Display(transfer="gain-offset-gamma", gamma=2.2),
    "gain and offset": Display(transfer="gain-offset-gamma", gain=0.8, offset=0.2, gamma=2.4),
    "below zero": Display(transfer="gain-offset-gamma", gain=1.1, offset=-0.1, gamma=2.0),
    "sRGB curve over a black": Display(luminance_cd_m2=120.0, black_cd_m2=9.6),
    "flare": Display(transfer="gain-offset-gamma", gamma=1.8, flare=0.02),
    "another white": Display(white_xy=(0.3457, 0.3585)),
    "D50, wide": Display(primaries_xy=P3, white_xy=(0.3457, 0.3585), transfer="gain-offset-gamma"),
}


def opened(data):
    return ImageCms.ImageCmsProfile(io.BytesIO(data))


def lab_of(data, rgb):
    """CIELAB (D50) of 8-bit RGB (N, 3), as LittleCMS reads the profile."""
    pixels = Image.fromarray(rgb[None].astype(np.uint8))
    transform = ImageCms.buildTransform(
        opened(data),
        ImageCms.createProfile("LAB"),
        "RGB",
        "LAB",
        ImageCms.Intent.RELATIVE_COLORIMETRIC,
    )
    raw = np.asarray(ImageCms.applyTransform(pixels, transform))[0].astype(float)
    signed = np.where(raw[:, 1:] > 127, raw[:, 1:] - 256, raw[:, 1:])
    return np.concatenate([raw[:, :1] / 2.55, signed], axis=1)


def light_of(display, rgb):
    """Linear light of digital values by bisection of the program's own encoding."""
    model = DisplayModel.of(display)
    low, high = np.zeros(rgb.shape), np.ones(rgb.shape)
    for _ in range(50):
        middle = 0.5 * (low + high)
        above = tone.encode(middle, model) > rgb / 255.0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    return 0.5 * (low + high)


def expected_lab(display, rgb):
    model = DisplayModel.of(display)
    xyz = light_of(display, rgb) @ model.xyz_from_rgb.T
    adapted = xyz @ adaptation_to_d50(white_from_xy(display.white_xy)).T
    return tone.lab_from_xyz(adapted, np.array([0.9642, 1.0, 0.8249]))


def colours():
    steps = np.array([0, 40, 128, 200, 255])
    return np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)


@pytest.mark.parametrize("name", list(DISPLAYS))
def test_another_program_reads_the_colours_that_the_display_shows(name):
    display = DISPLAYS[name]
    ours, theirs = expected_lab(display, colours()), lab_of(profile_of(display), colours())
    inside = np.all(np.abs(ours[:, 1:]) < 127, axis=1)
    # Their Lab has 8 bits: half a step of L*, and of a* and b*.
    # Light below black is cut, and bisection finds its upper end.
    dark = bool(np.any(DisplayModel.of(display).darkest > 0.0))
    inside &= (np.min(colours(), axis=1) > 60) | (not dark)
    assert np.max(np.abs(ours - theirs)[inside]) < 1.1
    # The control: taken for sRGB, some of them are far off.
    assert np.max(np.abs(ours - lab_of(srgb_profile(), colours()))[inside]) > 3.0


def test_bradfords_matrix_is_the_published_one():
    """D65 to D50, Lindbloom's page and ICC.1:2010 annex E."""
    published = [
        [1.0478112, 0.0228866, -0.0501270],
        [0.0295424, 0.9904844, -0.0170491],
        [-0.0092345, 0.0150436, 0.7521316],
    ]
    found = adaptation_to_d50(white_from_xy((0.3127, 0.3290)))
    # Theirs takes D50 as 0.96422, 1, 0.82521.
    np.testing.assert_allclose(found, published, atol=6e-4)


def test_the_colorants_of_srgb_are_the_published_ones():
    """IEC 61966-2-1's own profile: rXYZ, gXYZ and bXYZ."""
    published = [
        (0.43607, 0.22249, 0.01392),
        (0.38515, 0.71687, 0.09708),
        (0.14307, 0.06061, 0.7141),
    ]
    data = matrix_profile(Display())
    for name, xyz in zip((b"rXYZ", b"gXYZ", b"bXYZ"), published, strict=True):
        place = struct.unpack(">I", data[data.index(name) + 4 : data.index(name) + 8])[0]
        found = np.array(struct.unpack(">3i", data[place + 8 : place + 20])) / 65536.0
        np.testing.assert_allclose(found, xyz, atol=4e-4)


def test_srgb_by_the_formula_is_srgb():
    """The writer beside LittleCMS's own profile."""
    ours, theirs = (lab_of(data, colours()) for data in (matrix_profile(Display()), srgb_profile()))
    assert np.max(np.abs(ours - theirs)) <= 1.0


def test_the_file_follows_the_format():
    data = matrix_profile(DISPLAYS["flare"])
    assert struct.unpack(">I", data[:4])[0] == len(data)
    assert (data[12:24], data[36:40]) == (b"mntrRGB XYZ ", b"acsp")
    count = struct.unpack(">I", data[128:132])[0]
    for k in range(count):
        _, place, size = struct.unpack(">4sII", data[132 + 12 * k : 144 + 12 * k])
        assert place % 4 == 0
        assert 132 + 12 * count <= place <= place + size <= len(data)
    profile = opened(data)
    assert ImageCms.getProfileDescription(profile).strip() == "relgloss display, gamma 1.8"
    assert (
        ImageCms.isIntentSupported(
            profile, ImageCms.Intent.RELATIVE_COLORIMETRIC, ImageCms.Direction.OUTPUT
        )
        == 1
    )
    assert matrix_profile(DISPLAYS["flare"]) == data


def test_the_primaries_come_back():
    """Red, green, blue and white as LittleCMS adapts them back, by their chromaticities."""
    profile = opened(matrix_profile(Display(primaries_xy=P3))).profile
    for name, (x, y) in zip(("red", "green", "blue"), P3, strict=True):
        adapted = np.array(getattr(profile, f"{name}_colorant")[0])
        xyz = np.linalg.solve(np.array(profile.chromatic_adaptation[0]), adapted)
        np.testing.assert_allclose(xyz[:2] / xyz.sum(), (x, y), atol=1e-3)


def test_a_picture_carries_its_displays_profile(tmp_path):
    display = DISPLAYS["gamma"]
    with open_renderer("reference") as renderer:
        for one, data in ((display, matrix_profile(display)), (Display(), srgb_profile())):
            scene = Scene(load_sample("uncoated"), display=one)
            for bits in (8, 16):
                save_png(renderer.render(scene, Look(), (16, 12)), tmp_path / "a.png", "", bits)
                with Image.open(tmp_path / "a.png") as picture:
                    assert picture.info["icc_profile"] == data
