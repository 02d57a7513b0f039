"""`relgloss match` as its users meet it."""

from __future__ import annotations

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
    assert content.look.c_fraction == pytest.approx(proposed["c_fraction"])
    assert (content.sample.name, content.reference.name) == ("matte-coated", "cast-coated")
    assert content.reference_look.c_fraction == 1.0
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
        (("uncoated", "--gloss", "contrast-gloss", "--write", "a.toml"), "no setting of uncoated"),
        (("--set", "eye.shift_right=20"), "too little of the object is seen"),
    ],
    ids=str,
)
def test_refused(capsys, tmp_path, monkeypatch, words, place):
    monkeypatch.chdir(tmp_path)
    assert place in refused(capsys, tmp_path, "match", *SMALL, *words)


def test_a_scene_takes_one_sample(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    err = refused(capsys, tmp_path, "match", "--write", "a.toml", status=2)
    assert "expected one sample" in err
