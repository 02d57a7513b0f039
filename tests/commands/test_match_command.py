"""`relgloss match` as its users meet it."""

from __future__ import annotations

import dataclasses
import json

import pytest
from materials import paper
from PIL import Image
from test_cli import refused, run

from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.scene_file import read_scene_file

SMALL = ("--size", "64x64")


def test_papers_by_default(capsys, tmp_path):
    plot = tmp_path / "a.png"
    status, out, _ = run(capsys, "match", *SMALL, "-o", plot)
    assert status == 0
    for words in ("reference cast-coated", "sigma_N 2 deg", "proposed", "published", "a.png"):
        assert words in out
    assert "the experiment decides" in out
    assert [line.split()[0] for line in out.splitlines() if line.startswith("      0.")] == [
        "0.00", "0.25", "0.50", "0.75",
    ]  # fmt: skip
    with Image.open(plot) as picture:
        assert picture.format == "PNG"


def test_json_of_a_material_with_its_grain(capsys, tmp_path):
    save_material(paper("matte"), tmp_path / "mine.json")
    words = (tmp_path / "mine.json", "--reference", "art-coated=0,1", "--grain", 1.5)
    status, out, _ = run(capsys, "match", *words, *SMALL, "--gloss", "gloss-60", "--json")
    found = json.loads(out)
    assert status == 0
    assert found["reference"]["label"] == "art-coated"
    (sample,) = found["samples"]
    assert sample["label"] == "mine"
    assert sample["proposed"]["sigma_n_deg"] == 1.5
    assert sample["present"] is None
    assert sample["wanted"] == pytest.approx(found["reference"]["shown"] * sample["ratio"])


def test_written_scene_is_the_pair(capsys, tmp_path):
    scene = tmp_path / "pair.toml"
    words = ("matte-coated", *SMALL, "--set", "lamp.azimuth_deg=40", "--write", scene, "--json")
    found = json.loads(run(capsys, "match", *words)[1])
    content = read_scene_file(scene)
    proposed = found["samples"][0]["proposed"]
    assert content.look.sigma_n_deg == proposed["sigma_n_deg"]
    assert content.look.c == pytest.approx(proposed["c"])
    assert content.match.test_c == content.look.c
    assert content.match.reference_c == content.reference_look.c == found["reference"]["c"]
    assert content.match.made_by == "match"
    assert (content.sample.name, content.reference.name) == ("matte-coated", "cast-coated")
    assert content.setup.lamp.azimuth_deg == 40.0
    picture = tmp_path / "a.png"
    assert run(capsys, "snapshot", "--scene", scene, *SMALL, "-o", picture)[0] == 0


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("glass",), "glass"),
        (("--reference", "glass"), "glass"),
        (("--grain", "-1"), "sigma_n_deg"),
        (("--grain", "nan"), "sigma_n_deg"),
        (("-o", "a.html"), "ends in .png"),
        (("art-coated", "--write", "a.json"), "ends in .toml"),
        (("-o", "gone/a.png"), "gone"),
        (("--here", "--set", "eye.shift_right=20"), "shows no gloss in this view"),
        (("--here", "--set", "shape.kind=plane", "--lamp", "given"), "shows no gloss in this view"),
    ],
    ids=str,
)
def test_refused(capsys, tmp_path, monkeypatch, words, place):
    monkeypatch.chdir(tmp_path)
    assert place in refused(capsys, tmp_path, "match", *SMALL, *words)


def test_a_sample_without_a_highlight_has_no_scene(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    save_material(dataclasses.replace(paper("matte"), specular=()), tmp_path / "flat.json")
    before = sorted(tmp_path.iterdir())
    status, _, err = run(capsys, "match", "flat.json", *SMALL, "--write", "a.toml", "-o", "a.png")
    assert status == 1
    assert "no setting of flat keeps the ratio" in err
    assert sorted(tmp_path.iterdir()) == before


def test_here_is_the_pose_of_the_options(capsys, tmp_path):
    words = ("matte-coated", *SMALL, "--json", "--set", "lamp.azimuth_deg=90")
    here = json.loads(run(capsys, "match", *words, "--here")[1])
    mean = json.loads(run(capsys, "match", *words)[1])
    assert here["lamp_azimuths_deg"] == [90.0]
    assert len(mean["lamp_azimuths_deg"]) == len(mean["poses"]) > 3
    mine, theirs = (found["samples"][0]["proposed"] for found in (here, mean))
    assert mine["spread"] == 1.0 < theirs["spread"]
    assert theirs["low"] < mine["c"] < theirs["high"]


@pytest.mark.slow
def test_the_order_by_each_measure_is_reported(capsys, tmp_path):
    status, out, _ = run(capsys, "match", *SMALL)
    assert status == 0
    rows = {line.split("  ")[1].strip(): line for line in out.splitlines() if "kept" in line}
    assert "highlight" in rows
    found = json.loads(run(capsys, "match", *SMALL, "--json")[1])
    verdicts = [pose["orders"]["contrast_gloss"] for pose in found["poses"]]
    assert set(verdicts) == {"broken"}


def test_a_scene_takes_one_sample(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    err = refused(capsys, tmp_path, "match", "--write", "a.toml", status=2)
    assert "expected one sample" in err
