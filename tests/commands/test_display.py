"""`relgloss display`: profiles, readings, conversion, check and patches, as a user calls them."""

from __future__ import annotations

import csv
import io
import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageCms

from relgloss_view import cli
from relgloss_view.display.coverage import STANDARDS, coverage
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile
from relgloss_view.display.patches import patch_values
from relgloss_view.display.temperature import correlated_temperature
from relgloss_view.material.spectra import D65_XY, rgb_to_xyz_matrix

WHITE_CD_M2 = 160.0
P3 = STANDARDS["Display P3"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(capsys, *words):
    """Exit status, standard output and standard error of a command line."""
    try:
        status = cli.main([str(word) for word in words])
    except SystemExit as end:
        status = int(end.code or 0)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def as_json(capsys, *words):
    status, out, err = run(capsys, "display", *words, "--json")
    assert status == 0, err
    return json.loads(out)


def refused(capsys, *words):
    status, out, err = run(capsys, *words)
    assert (status, out) == (1, ""), err
    assert err.count("\n") == 1
    return err


def write_profile(name="monitor.icc", **entries):
    """A profile of this program's own writing: gamma 2.2 and P3 primaries unless they are given."""
    display = {"transfer": "gain-offset-gamma", "gamma": 2.2, "primaries_xy": P3, **entries}
    Path(name).write_bytes(matrix_profile(Display(**display)))
    return name


def write_readings(name="readings.csv", *, gamma=2.2, white=WHITE_CD_M2, black=0.0, count=31):
    """Readings of a display with P3 primaries, by the closed form."""
    digital = np.array(patch_values(count))
    xyz = white * ((digital / 255.0) ** gamma) @ rgb_to_xyz_matrix(P3, D65_XY).T + black
    with open(name, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["R (0-255)", "G (0-255)", "B (0-255)", "X (cd/m2)", "Y", "Z"])
        writer.writerows(np.hstack([digital, xyz]).tolist())
    return name


def test_a_profile_in_numbers(capsys):
    found = as_json(capsys, write_profile())
    assert found["kind"] == "profile"
    assert np.allclose(found["primaries_xy"], P3, atol=5e-4)  # 16 bits after the point
    assert np.allclose(found["white"]["xy"], D65_XY, atol=5e-4)
    assert np.allclose(found["gamma"], 2.2, atol=1e-3)
    assert found["gamut"]["sRGB"]["covered"] > 0.995
    assert found["gamut"]["Display P3"]["covered"] > 0.995
    assert found["white"]["luminance_cd_m2"] is None
    assert {one["what"] for one in found["missing"]} == {"white luminance", "black"}
    out = run(capsys, "display", "monitor.icc")[1]
    assert "missing" in out
    assert "display.luminance_cd_m2" in out


def test_readings_become_a_display_file_that_scenes_name(capsys):
    write_readings(black=0.2)
    status, out, err = run(
        capsys, "display", "readings.csv", "-o", "monitor.toml", "--report", "monitor.html"
    )
    assert status == 0, err
    assert "relgloss snapshot --display monitor.toml -o paper.png" in out
    page = Path("monitor.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64") == 1
    found = as_json(capsys, "monitor.toml")
    # The file is what was measured, without noise: within the rounding of one part in 1,000.
    assert found["white"]["luminance_cd_m2"] == pytest.approx(WHITE_CD_M2 + 0.2, rel=1e-3)
    assert found["black"]["luminance_cd_m2"] == pytest.approx(0.2, rel=0.05)
    assert np.allclose(found["gamma"], 2.2, atol=0.02)
    status, _, err = run(
        capsys, "snapshot", "--display", "monitor.toml", "--size", "64x64", "-o", "a.png"
    )
    assert status == 0, err


def test_a_profile_gets_luminance_and_black_from_two_readings(capsys):
    write_profile()
    write_readings("two.csv", black=0.16, count=2)
    found = as_json(capsys, "monitor.icc", "two.csv", "-o", "monitor.toml")
    assert found["readings"]["agrees"]
    assert found["warnings"] == []
    again = as_json(capsys, "monitor.toml")
    assert again["white"]["luminance_cd_m2"] == pytest.approx(WHITE_CD_M2 + 0.16)
    assert again["black"]["luminance_cd_m2"] == pytest.approx(0.16)
    assert again["missing"] == []
    # Negative control: readings of another display are no completion.
    write_readings("other.csv", gamma=1.2)
    assert "does not describe" in as_json(capsys, "monitor.icc", "other.csv")["warnings"][0]


def test_a_display_file_lies_beside_its_profile(capsys, folder):
    (folder / "sub").mkdir()
    write_profile()
    write_readings("two.csv", count=2)
    err = refused(capsys, "display", "monitor.icc", "two.csv", "-o", "sub/monitor.toml")
    assert "beside" in err


def test_a_scene_is_no_display(capsys, folder):
    (folder / "scene.toml").write_text('[display]\nprofile = "monitor.icc"\n')
    assert "scene.toml: not a display file" in refused(capsys, "display", "scene.toml")


def test_the_check_finds_what_changed(capsys):
    write_readings(black=0.2)
    run(capsys, "display", "readings.csv", "-o", "monitor.toml")
    good = as_json(capsys, "check", "monitor.toml", "readings.csv")
    assert good["verdict"] == "good"
    write_readings("darker.csv", black=0.2, white=0.6 * WHITE_CD_M2, gamma=2.6)
    bad = as_json(capsys, "check", "monitor.toml", "darker.csv")
    assert bad["verdict"] == "poor"
    assert bad["luminance_drift"] == pytest.approx(-0.4, abs=0.01)
    words = ("display", "check", "monitor.toml")
    assert run(capsys, *words, "darker.csv")[0] == 0
    assert run(capsys, *words, "darker.csv", "--fail-above", "1")[0] == 1
    assert run(capsys, *words, "readings.csv", "--fail-above", "1")[0] == 0


def converted(capsys, monkeypatch, text, *words):
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    status, out, err = run(capsys, "display", "convert", *words)
    assert status == 0, err
    return np.array([[float(v) for v in line.split()] for line in out.splitlines()]), err


@pytest.mark.parametrize("to", ["xyz", "lab"])
@pytest.mark.parametrize("more", [(), ("--pcs",), ("--intent", "absolute")])
def test_conversion_goes_there_and_back(capsys, monkeypatch, to, more):
    write_profile()
    rgb = np.random.default_rng(1).random((20, 3))
    text = "R,G,B\n" + "\n".join(",".join(map(repr, map(float, row))) for row in rgb)
    there, _ = converted(
        capsys, monkeypatch, text, "monitor.icc", "--from", "rgb", "--to", to, *more
    )
    back = "\n".join(" ".join(map(repr, map(float, row))) for row in there)
    again, err = converted(
        capsys, monkeypatch, back, "monitor.icc", "--from", to, "--to", "rgb", *more
    )
    assert err == ""
    # The profile's curves have 4096 entries of 16 bits: in deep shadow two neighbours may be equal,
    # and the way back gives the darker one.
    assert np.abs(again - rgb).max() < 1.0 / 4095.0
    bright = rgb.min(axis=1) > 0.05  # there 7 printed decimals are what is left
    assert bright.sum() > 10
    assert np.abs(again - rgb)[bright].max() < 1e-5


def test_conversion_as_little_cms_has_it(capsys, monkeypatch):
    """CIELAB of the connection space, as Pillow's engine gives it with 8 bits out."""
    write_profile()
    rgb = np.array([[255, 0, 0], [0, 128, 0], [30, 60, 200], [255, 255, 255], [90, 90, 90]])
    text = "\n".join(" ".join(f"{v / 255.0:.9f}" for v in row) for row in rgb)
    lab, _ = converted(
        capsys, monkeypatch, text, "monitor.icc", "--from", "rgb", "--to", "lab", "--pcs"
    )
    profile = ImageCms.getOpenProfile("monitor.icc")
    change = ImageCms.buildTransform(profile, ImageCms.createProfile("LAB"), "RGB", "LAB",
                                     ImageCms.Intent.RELATIVE_COLORIMETRIC)  # fmt: skip
    image = ImageCms.applyTransform(Image.fromarray(rgb[None].astype(np.uint8)), change)
    pixels = np.frombuffer(image.tobytes(), np.uint8).reshape(-1, 3).astype(float)
    other = np.stack(
        [pixels[:, 0] / 2.55, *((pixels[:, k] + 128.0) % 256.0 - 128.0 for k in (1, 2))], axis=1
    )
    inside = np.abs(lab[:, 1:]) < 127.0  # its 8 bits hold no more
    assert np.abs(lab[:, 0] - other[:, 0]).max() < 0.5  # half a step, and its own rounding
    assert np.abs((lab - other)[:, 1:][inside]).max() < 1.5


@pytest.mark.skipif(shutil.which("xicclu") is None, reason="Argyll's xicclu is not installed")
def test_conversion_as_xicclu_has_it(capsys, monkeypatch):
    # xicclu 2.3 reads profiles of version 2; a chad tag is none of its business there.
    name = "/usr/share/color/argyll/ref/ClayRGB1998.icm"
    if not Path(name).is_file():
        pytest.skip("Argyll's reference profiles are not installed")
    text = "\n".join(
        " ".join(f"{v:.9f}" for v in row) for row in np.random.default_rng(2).random((50, 3))
    )
    for more, option in ((("--pcs",), "-ir"), (("--intent", "absolute"), "-ia")):
        lab, _ = converted(capsys, monkeypatch, text, name, "--from", "rgb", "--to", "lab", *more)
        out = subprocess.run(
            ["xicclu", "-ff", option, "-pl", name], input=text, capture_output=True, text=True,
            check=True,
        ).stdout  # fmt: skip
        found = re.findall(r"-> ([-\d.]+) ([-\d.]+) ([-\d.]+)", out)
        # It prints 6 decimals; the tags have 16 bits after the point, 1.5e-5 of XYZ.
        assert np.abs(lab - np.array(found, dtype=float)).max() < 0.005


def test_colours_beyond_the_display_are_named(capsys, monkeypatch):
    write_profile()
    words = ("monitor.icc", "--from", "lab", "--to", "rgb")
    values, err = converted(capsys, monkeypatch, "50 0 0\n90 -120 90\n", *words)
    assert "1 of 2 colours" in err
    assert ((values >= 0.0) & (values <= 1.0)).all()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no colours"), ("0.1 0.2\n0.3\n", "line 2"), ("0 0 0\nnan 0 0\n", "line 2"),
        ("255 0 0\n", "divide 8-bit values"), ("0,5;0,5;0,5\n0 0 a\n", "line 2"),
    ],
)  # fmt: skip
def test_colours_that_are_none(capsys, monkeypatch, text, words):
    write_profile()
    monkeypatch.setattr("sys.stdin", io.StringIO(text))
    err = refused(capsys, "display", "convert", "monitor.icc", "--from", "rgb", "--to", "lab")
    assert words in err


def test_patches_to_measure_by_hand(capsys, folder):
    assert run(capsys, "display", "patches", "-o", "p", "--count", 12, "--size", "96x64")[0] == 0
    names = sorted(file.name for file in (folder / "p").glob("*.png"))
    assert len(names) == 12
    for name, value in zip(names, patch_values(12), strict=True):
        with Image.open(folder / "p" / name) as image:
            assert image.getpixel((48, 32)) == value
            assert "icc_profile" not in image.info
    # What is filled in is read: the digital values of the table are those of the pictures.
    table = list(csv.reader((folder / "p" / "patches.csv").read_text().splitlines()))
    xyz = (
        WHITE_CD_M2 * (np.array(patch_values(12)) / 255.0) ** 2.2 @ rgb_to_xyz_matrix(P3, D65_XY).T
    )
    filled = [
        table[0],
        *(row[:5] + [str(v) for v in x] for row, x in zip(table[1:], xyz, strict=True)),
    ]
    with (folder / "p" / "patches.csv").open("w", newline="") as file:
        csv.writer(file).writerows(filled)
    found = as_json(capsys, "p/patches.csv")
    assert found["white"]["luminance_cd_m2"] == pytest.approx(WHITE_CD_M2, rel=1e-3)
    # A folder with readings is never written over.
    assert "readings" in refused(capsys, "display", "patches", "-o", "p")
    assert len(set(patch_values(300))) == 300


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("nothing.icc",), "No such file"),
        (("readings.csv", "monitor.icc"), "these are readings already"),
        (("monitor.icc", "monitor.icc"), "expected readings"),
        (("monitor.icc", "-o", "monitor.icc"), "ends in .toml"),
        (("monitor.icc", "--report", "r.pdf"), "ends in .html or .png"),
        (("check", "monitor.icc", "monitor.icc"), "expected readings"),
        (("patches", "-o", "p", "--count", "3"), "expected 9 to 1000"),
        (("readings.csv", "--seed", "-1"), "0 or more"),
    ],
)
def test_wrong_uses_are_one_line(capsys, words, expected):
    write_profile()
    write_readings()
    assert expected in refused(capsys, "display", *words)


@pytest.mark.parametrize("option", ["--display", "--seen-on"])
@pytest.mark.parametrize("command", ["snapshot", "grid", "compare", "plan", "view"])
def test_a_foreign_display_ends_the_command_before_it_draws(capsys, folder, command, option):
    (folder / "a.txt").write_text("nothing of a display")
    output = {"snapshot": "a.png", "grid": "g", "compare": "c.png", "view": "w.png"}.get(command)
    flag = "--screenshot" if command == "view" else "-o"
    words = () if output is None else (flag, output)
    for name, found in (("a.txt", "a.txt"), ("gone.icc", "No such file")):
        assert found in refused(capsys, command, option, name, *words)
    assert [file.name for file in folder.iterdir()] == ["a.txt"]


def test_the_command_in_a_grid_names_a_display_that_looks_like_an_option(capsys, folder):
    write_profile("-m.icc")
    assert run(capsys, "grid", "--display=-m.icc", "--size", "48x48", "-o", "g")[0] == 0
    with Image.open(folder / "g" / "sigma_0.0_c_1of6.png") as image:
        command = image.text["Command"]
    assert "--display=-m.icc" in command
    assert run(capsys, *shlex.split(command)[1:])[0] == 0


def test_temperatures_and_gamuts_of_the_literature():
    """CIE 15:2004, table T.3 and T.8.1: illuminants A, D50, D65, D75."""
    for xy, kelvin in (
        ((0.44757, 0.40745), 2856), ((0.34567, 0.35850), 5003), ((0.31272, 0.32903), 6504),
        ((0.29902, 0.31485), 7504),
    ):  # fmt: skip
        found = correlated_temperature(xy)
        assert found is not None
        assert found[0] == pytest.approx(kelvin, abs=0.002 * kelvin)  # steps, 5 digits of xy
    assert correlated_temperature((0.15, 0.06)) is None  # blue has none
    assert coverage(P3, "sRGB").covered == 1.0
    half = coverage(STANDARDS["sRGB"], "Display P3")
    assert half.covered == pytest.approx(half.size)  # sRGB lies within P3
    assert half.covered < 0.9
