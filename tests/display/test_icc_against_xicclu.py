"""Profiles of screens, both ways, against Argyll's xicclu and LittleCMS's transicc.

xicclu reads no version 4, and no parametric curves. So colord's profiles go to it as version 2 with
sampled curves, which are made here of the formulas of ICC.1:2022, 10.18; transicc reads them as
they are. Bounds are those that the project promises: mean and largest CIEDE2000 of 0.1 and 0.5 of
matrices, 0.15 and 0.7 of tables.
"""

from __future__ import annotations

import shutil
import struct
import subprocess
import sys
from pathlib import Path

import colour
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

import made_profiles

from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.backward import device_by_table
from relgloss_view.base.icc.profile import D50, read_profile, xyz_from_lab
from relgloss_view.base.icc.tetrahedral import tetrahedral
from relgloss_view.display.read import monitor_of

COLORD = Path("/usr/share/color/icc/colord")
FEW = ("sRGB", "Rec709", "ProPhotoRGB", "SwappedRedAndGreen")
NAMED = ("Crayons", "x11-colors")
ALL = (
    "AdobeRGB1998", "AppleRGB", "BestRGB", "BetaRGB", "Bluish", "BruceRGB", "CIE-RGB",
    "ColorMatchRGB", "DonRGB4", "ECI-RGBv1", "ECI-RGBv2", "EktaSpacePS5", "Gamma5000K",
    "Gamma5500K", "Gamma6500K", "NTSC-RGB", "PAL-RGB", "ProPhotoRGB", "Rec709", "SMPTE-C-RGB",
    "SwappedRedAndGreen", "WideGamutRGB", "sRGB",
)  # fmt: skip
OF_MATRIX, OF_TABLE = (0.1, 0.5), (0.15, 0.7)


def needed(program):
    if shutil.which(program) is None:
        pytest.skip(f"{program} is absent (argyll, liblcms2-utils)")


def colord(name):
    path = COLORD / f"{name}.icc"
    if not path.is_file():
        pytest.skip(f"{path} is absent (colord-data)")
    return path


def digital(count, seed=0):
    return np.random.default_rng(seed).random((count, 3))


def xicclu(path, rows, *words):
    """Three numbers a row, as Argyll's program prints them."""
    needed("xicclu")
    text = "\n".join(" ".join(f"{v:.8f}" for v in row) for row in rows) + "\n"
    command = ["xicclu", *words, str(path)]
    out = subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout
    lines = [line for line in out.splitlines() if "->" in line]
    assert len(lines) == len(rows)
    return np.array([line.split("->")[-1].split()[:3] for line in lines], float)


def transicc(rows, *words):
    """Three numbers a row, as LittleCMS's program prints them."""
    needed("transicc")
    text = "\n".join(" ".join(f"{v:.8f}" for v in row) for row in rows) + "\n"
    command = ["transicc", "-n", "-t1", "-c0", *words]
    out = subprocess.run(command, input=text, capture_output=True, text=True, check=True).stdout
    return np.array([line.split() for line in out.splitlines() if line.strip()], float)


def parametric(form, p, x):
    """ICC.1:2022, table 68, as it stands there."""
    g, a, b, c, d, e, f = [*p, *[0.0] * (7 - len(p))]
    if form == 0:
        return x**g
    if form == 3:
        return np.where(x >= d, (a * x + b) ** g, c * x)
    if form == 4:
        return np.where(x >= d, (a * x + b) ** g + e, c * x + f)
    raise AssertionError(form)


def as_version_2(path, folder):
    """A profile of version 4 with the curves sampled at 4096 values, for Argyll."""
    data = path.read_bytes()
    count = struct.unpack_from(">I", data, 128)[0]
    tags = {}
    for tag, at, length in struct.iter_unpack(">4sII", data[132 : 132 + 12 * count]):
        part = data[at : at + length]
        if part[:4] == b"para":
            form = struct.unpack_from(">H", part, 8)[0]
            p = np.frombuffer(part, ">i4", (1, 3, 4, 5, 7)[form], 12) / 65536.0
            y = parametric(form, p, np.linspace(0.0, 1.0, 4096))
            values = np.round(65535.0 * np.clip(y, 0.0, 1.0)).astype(">u2")
            part = b"curv" + bytes(4) + struct.pack(">I", 4096) + values.tobytes()
        if part[:4] in (b"XYZ ", b"sf32", b"curv"):
            tags[tag] = part
    made = folder / f"{path.stem}-2.icc"
    data = bytearray(made_profiles.assembled(tags, lab=False, version=2))
    data[8:10] = bytes((2, 0x40))
    made.write_bytes(data)
    return made


def apart(one, other, white=D50):
    """CIEDE2000 of XYZ (N, 3) under a white."""
    xy = white[:2] / white.sum()
    pair = (colour.XYZ_to_Lab(xyz / white[1], xy) for xyz in (one, other))
    return colour.delta_E(*pair, method="CIE 2000")


def assert_near(difference, bounds):
    assert difference.mean() <= bounds[0]
    assert difference.max() <= bounds[1]


def of_screen(path, argyll, count, bounds):
    """Both ways and both intents, against xicclu on the file `argyll`."""
    monitor, profile = monitor_of(str(path)), read_profile(path.read_bytes())
    rgb = digital(count)
    emitted = xicclu(argyll, rgb, "-ff", "-ia", "-px")
    assert_near(apart(monitor.xyz(rgb), emitted, monitor.white), bounds)
    relative = xicclu(argyll, rgb, "-ff", "-ir", "-px")
    assert_near(apart(profile.xyz(rgb, "relative", tetrahedral), relative), bounds)
    # A table's `-fb` is the profile's own backward table, which a screen's picture does not take.
    ways = ("-fif", "-fb") if monitor.emission.kind == "curves" else ("-fif",)
    ours = monitor.xyz(monitor.digital(emitted))
    for words, colours in ((("-ia", "-px"), emitted), (("-ir", "-px"), relative)):
        for way in ways:
            # Colours of digital values, so that what differs is seen as it is.
            theirs = monitor.xyz(xicclu(argyll, colours, way, *words))
            assert_near(apart(ours, theirs, monitor.white), bounds)
    # The negative control: another screen is far off.
    assert apart(monitor.xyz(rgb[:, [1, 0, 2]]), emitted, monitor.white).mean() > 10 * bounds[1]


@pytest.mark.parametrize("name", FEW)
def test_a_profile_of_colord(name, tmp_path):
    path = colord(name)
    of_screen(path, as_version_2(path, tmp_path), 200, OF_MATRIX)


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
def test_each_profile_of_colord(name, tmp_path):
    path = colord(name)
    of_screen(path, as_version_2(path, tmp_path), 1000, OF_MATRIX)


@pytest.mark.parametrize("name", FEW)
def test_a_profile_of_colord_as_it_is(name):
    path = colord(name)
    rgb = digital(200, 1)
    theirs = transicc(255.0 * rgb, f"-i{path}", "-o*XYZ") / 100.0
    assert_near(apart(read_profile(path.read_bytes()).xyz(rgb, "relative"), theirs), OF_MATRIX)
    monitor = monitor_of(str(path))
    back = transicc(100.0 * theirs, "-i*XYZ", f"-o{path}", "-s") / 255.0
    ours = monitor.digital(monitor.xyz(rgb))
    assert_near(apart(monitor.xyz(ours), monitor.xyz(back), monitor.white), OF_MATRIX)


@pytest.mark.parametrize("name", NAMED)
def test_named_colours_are_no_screen(name):
    with pytest.raises(InputError, match="named colours; expected the profile of a monitor"):
        monitor_of(str(colord(name)))


# Profiles of colprof


def readings(folder, name):
    """A .ti3 of a screen whose channels do not add, of three gammas, with a black."""
    axis = np.linspace(0.0, 1.0, 5)
    rgb = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    light = (0.97 * rgb + 0.03) ** np.array([2.3, 2.15, 2.4])
    light = light * (1.0 - 0.03 * np.maximum(light.sum(axis=1, keepdims=True) - 1.0, 0.0))
    matrix = np.array([[0.45, 0.32, 0.19], [0.23, 0.68, 0.09], [0.02, 0.11, 0.98]])
    xyz = light @ matrix.T + np.array([0.003, 0.003, 0.004])
    xyz = 100.0 * xyz / xyz[-1, 1]
    rows = [
        f"{k + 1} " + " ".join(f"{v:.5f}" for v in (*100.0 * r, *x))
        for k, (r, x) in enumerate(zip(rgb, xyz, strict=True))
    ]
    head = [
        "CTI3", "", 'DESCRIPTOR "made"', 'ORIGINATOR "made"', 'DEVICE_CLASS "DISPLAY"',
        'LUMINANCE_XYZ_CDM2 "152 160 174"', 'COLOR_REP "RGB_XYZ"', "NUMBER_OF_FIELDS 7",
        "BEGIN_DATA_FORMAT", "SAMPLE_ID RGB_R RGB_G RGB_B XYZ_X XYZ_Y XYZ_Z", "END_DATA_FORMAT",
        f"NUMBER_OF_SETS {len(rows)}", "BEGIN_DATA", *rows, "END_DATA", "",
    ]  # fmt: skip
    (folder / f"{name}.ti3").write_text("\n".join(head))


def colprof(folder, *words):
    needed("colprof")
    readings(folder, "screen")
    command = ["colprof", "-bl", *words, "screen"]
    subprocess.run(command, cwd=folder, capture_output=True, check=True)
    return folder / "screen.icc"


def of_backward_table(path):
    profile = read_profile(path.read_bytes())
    rgb = digital(300, 2)
    lab = xicclu(path, rgb, "-ff", "-ir", "-pl")
    xyz = xyz_from_lab(lab)
    for intent, word in (("relative", "-ir"), ("perceptual", "-ip")):
        theirs = xicclu(path, lab, "-fb", word, "-pl")
        ours = device_by_table(profile, xyz, intent)
        shown = (profile.xyz(d, "relative", tetrahedral) for d in (ours, theirs))
        assert_near(apart(*shown), OF_TABLE)


@pytest.mark.slow
def test_a_table_of_colprof(tmp_path):
    path = colprof(tmp_path, "-ql", "-al")
    of_screen(path, path, 200, OF_TABLE)
    of_backward_table(path)
    monitor = monitor_of(str(path))
    assert monitor.emission.kind == "table"
    # The luminance that the readings name, which colprof scales to the white that it fits.
    assert monitor.luminance_cd_m2 == pytest.approx(160.0, rel=0.02)
    assert monitor.black_known
    # The negative control: between nodes, multilinear interpolation is not what xicclu does.
    profile, rgb = read_profile(path.read_bytes()), digital(200)
    relative = xicclu(path, rgb, "-ff", "-ir", "-px")
    near = apart(profile.xyz(rgb, "relative", tetrahedral), relative).mean()
    assert apart(profile.xyz(rgb, "relative"), relative).mean() > 10.0 * near


@pytest.mark.parametrize("kind", ["g", "s", "m", "G", "S"])
def test_curves_of_colprof(kind, tmp_path):
    path = colprof(tmp_path, "-ql", f"-a{kind}")
    monitor = monitor_of(str(path))
    assert monitor.emission.kind == "curves"
    of_screen(path, path, 200, OF_MATRIX)


@pytest.mark.slow
@pytest.mark.parametrize("words", ["-qm -al", "-ql -ax", "-ql -aX", "-ql -aY"])
def test_each_table_of_colprof(words, tmp_path):
    path = colprof(tmp_path, *words.split())
    of_screen(path, path, 1000, OF_TABLE)
    of_backward_table(path)


# Tables of other kinds, made here: xicclu reads mft1 and mft2, transicc mAB and mBA


def backward(values):
    """Something smooth that a backward table may hold."""
    return np.clip(0.2 + 0.6 * values[:, [1, 0, 2]] ** 0.8 + 0.2 * values**2, 0.0, 1.0)


@pytest.mark.parametrize("lab", [True, False])
@pytest.mark.parametrize("kind", ["mft1", "mft2", "mAB "])
def test_a_table_of_each_kind(kind, lab, tmp_path):
    path = tmp_path / "table.icc"
    path.write_bytes(made_profiles.table_profile(kind, lab=lab, backward=backward))
    profile, rgb = read_profile(path.read_bytes()), digital(200, 3)
    ours = profile.xyz(rgb, "relative", tetrahedral)
    if kind == "mAB ":
        theirs = transicc(255.0 * rgb, f"-i{path}", "-o*XYZ") / 100.0
        back = transicc(100.0 * theirs, "-i*XYZ", f"-o{path}") / 255.0
    else:
        theirs = xicclu(path, rgb, "-ff", "-ir", "-px")
        back = xicclu(path, theirs, "-fb", "-ir", "-px")
    assert_near(apart(ours, theirs), OF_TABLE)
    assert np.abs(device_by_table(profile, theirs, "relative") - back).max() < 2e-3
    monitor = monitor_of(str(path))
    # Digital values come back, but of XYZ in 8 bits, whose steps of 3.5 L* fold the table.
    shown, again = monitor.xyz(rgb), monitor.xyz(monitor.digital(monitor.xyz(rgb)))
    folded = kind == "mft1" and not lab
    assert_near(apart(shown, again, monitor.white), (0.05, 2.5) if folded else (1e-6, 1e-5))
