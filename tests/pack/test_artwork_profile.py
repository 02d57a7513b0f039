"""ICC profiles against Argyll's xicclu, which nobody here wrote."""

import shutil
import subprocess
from pathlib import Path

import colour
import numpy as np
import pytest

from relgloss_view.base.icc.profile import D50, lab_space, read_profile, xyz_from_lab
from relgloss_view.pack.artwork.raster import Conversion
from relgloss_view.pack.artwork.spaces import srgb

ICC = Path("/usr/share/color/icc")
RGB = [ICC / "sRGB.icc", ICC / "ghostscript/a98.icc", ICC / "LStar-RGB.icc", ICC / "Gray-CIE_L.icc"]
CMYK = ICC / "ghostscript/default_cmyk.icc"


def lab_of(xyz):
    white = D50[:2] / D50.sum()
    return colour.XYZ_to_Lab(xyz * 1.0, white)


def xicclu(profile, device, intent):
    """Lab of Argyll's program for device values, 0 to 1."""
    if shutil.which("xicclu") is None or not Path(profile).is_file():
        pytest.skip("xicclu (argyll) or the profile is absent")
    rows = "\n".join(" ".join(f"{v:.6f}" for v in row) for row in device)
    words = ["xicclu", "-ff", f"-i{intent}", "-pl", "-s1", str(profile)]
    out = subprocess.run(words, input=rows + "\n", capture_output=True, text=True, check=True)
    lines = [line for line in out.stdout.splitlines() if "[Lab]" in line]
    return np.array([line.split("->")[-1].split()[:3] for line in lines], float)


def difference(profile, path, count, intent, rng):
    device = np.round(rng.random((count, profile.channels)) * 255) / 255
    name = {"a": "absolute", "r": "relative"}[intent]
    got = lab_of(profile.xyz(device, name))
    return colour.delta_E(xicclu(path, device, intent), got, method="CIE 2000")


def of(path):
    if not path.is_file():
        pytest.skip(f"{path} is absent (icc-profiles-free, ghostscript)")
    return read_profile(path.read_bytes())


@pytest.mark.parametrize("path", RGB, ids=lambda p: p.stem)
def test_rgb_and_gray_profiles(path):
    apart = difference(of(path), path, 300, "r", np.random.default_rng(0))
    assert apart.max() < 0.01


@pytest.mark.parametrize("intent", ["a", "r"])
def test_a_cmyk_table(intent):
    apart = difference(of(CMYK), CMYK, 1000, intent, np.random.default_rng(0))
    assert apart.mean() <= 0.5
    assert apart.max() <= 1.0
    # Negative control: the intents differ by more than the bound.
    device = np.zeros((1, 4))
    paper = lab_of(of(CMYK).xyz(device, "absolute")), lab_of(of(CMYK).xyz(device, "relative"))
    assert colour.delta_E(*paper, method="CIE 2000")[0] > 1.0


@pytest.mark.slow
@pytest.mark.parametrize("intent", ["a", "r"])
def test_fogra39(tmp_path_factory, intent):
    """The profile that colprof makes of the characterization data of FOGRA39."""
    data = ICC / "FOGRA39L.ti3"
    if shutil.which("colprof") is None or not data.is_file():
        pytest.skip("colprof (argyll) or FOGRA39L.ti3 (icc-profiles-free) is absent")
    folder = tmp_path_factory.getbasetemp() / "fogra39"
    path = folder / "F39.icc"
    if not path.is_file():
        folder.mkdir(exist_ok=True)
        shutil.copy(data, folder / "F39.ti3")
        subprocess.run(
            ["colprof", "-qm", "-bn", "F39"], cwd=folder, check=True, capture_output=True
        )
    apart = difference(of(path), path, 5000, intent, np.random.default_rng(0))
    assert apart.mean() <= 0.5
    assert apart.max() <= 1.0


def test_a_picture_is_converted_as_its_values_are():
    """Runs of equal colours, 8 and 16 bits, and float32 change nothing."""
    profile = of(CMYK)
    rng = np.random.default_rng(1)
    for dtype in (np.uint8, np.uint16):
        top = np.iinfo(dtype).max
        samples = rng.integers(0, top + 1, (200, 4)).astype(dtype)
        expected = profile.xyz(samples / top)
        converted = Conversion(profile, "auto", samples[:0].ravel())
        assert np.abs(converted(samples) - expected).max() < 1e-5
        assert np.abs(converted(np.repeat(samples, 5, 0)) - np.repeat(expected, 5, 0)).max() < 1e-5


def test_srgb_is_that_of_colour_science():
    values = np.random.default_rng(2).random((50, 3))
    xyz = colour.sRGB_to_XYZ(values, np.array([0.3457, 0.3585]), "Bradford")
    assert np.abs(srgb().xyz(values) - xyz).max() < 5e-4
    lab = np.array([[50.0, 20.0, -30.0], [4.0, 1.0, 2.0], [100.0, 0.0, 0.0]])
    assert np.abs(lab_of(xyz_from_lab(lab)) - lab).max() < 1e-6
    assert np.abs(lab_space().xyz(np.array([[1.0, 128 / 255, 128 / 255]])) - D50).max() < 1e-12


def test_damaged_profiles_are_refused_and_take_no_memory():
    data = bytearray(of(CMYK) and CMYK.read_bytes()[:300_000])
    rng = np.random.default_rng(0)
    refused = 0
    for _ in range(150):
        damaged = bytearray(data)
        for at in rng.integers(0, 700, 3):
            damaged[at] = rng.integers(256)
        try:
            profile = read_profile(bytes(damaged))
            assert np.isfinite(profile.xyz(np.full((2, profile.channels), 0.5))).all()
        except ValueError:
            refused += 1
    assert 0 < refused < 150
