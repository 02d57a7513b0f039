"""Many tables at once: `relgloss fit` into a folder, and `relgloss measure` before any fit."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_cli import run

from relgloss_view.base.errors import InputError
from relgloss_view.commands import fit_many, table_places
from relgloss_view.material.files import load_material

QUICK = ("--model", "lambert")


def write_table(path, level=0.5, lamps=(15, 30, 45, 60), name=None):
    """A Lambertian table of a few incidences in one plane."""
    rows = [
        f"{lamp},180,{abs(r)},{0 if r >= 0 else 180},{level},{level},{level}"
        for lamp in lamps
        for r in range(-60, 61, 20)
    ]
    head = ["# quantity: radiance-factor", *([f"# name: {name}"] if name else [])]
    head.append("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,R,G,B")
    Path(path).parent.mkdir(exist_ok=True)
    Path(path).write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def scans(tmp_path, monkeypatch):
    """A working folder with scans/: two tables, a broken one, and what is no table."""
    monkeypatch.chdir(tmp_path)
    write_table("scans/a.csv", 0.4)
    write_table("scans/b.txt", 0.6, name="Lot B")
    text = Path(write_table("scans/broken.csv")).read_text(encoding="utf-8")
    Path("scans/broken.csv").write_text(text.replace("0.5,0.5,0.5", "0.5,x,0.5", 1))
    Path("scans/notes.md").write_text("theta_i, phi_i and theta_r are in the table below.\n")
    Path("scans/material.json").write_text('{"format": "relgloss-material"}')
    Path("scans/picture.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    Path("scans/old").mkdir()
    return tmp_path


class TestFit:
    def test_a_folder(self, capsys, scans):
        """One file's fault is one line; the others are written, with a summary."""
        status, out, err = run(
            capsys, "fit", "scans", "-o", "materials/", "--report", "reports", *QUICK
        )
        assert status == 1
        assert sorted(p.name for p in Path("materials").iterdir()) == ["a.json", "b.json"]
        assert sorted(p.name for p in Path("reports").iterdir()) == ["a.png", "b.png"]
        assert load_material("materials/b.json").name == "Lot B"
        passed_over, fault = err.splitlines()
        assert passed_over.startswith("warning: passed over 4 entries")
        for name in ("notes.md", "material.json", "picture.png", "old/"):
            assert name in passed_over
        assert fault.startswith("relgloss: scans/broken.csv: line 3, column 6")
        lines = out.splitlines()
        assert lines[0].split()[:2] == ["name", "geometries"]
        assert lines[1].split()[:4] == ["a", "28", "RGB", "lambert"]
        assert lines[2].startswith("Lot B")
        assert "2 of 3 tables fitted; 1 failed" in out

    def test_names_never_collide(self, capsys, scans):
        for place in ("lot1/paper.csv", "lot2/Paper.csv"):
            write_table(place)
        words = ("lot1/paper.csv", "lot2/Paper.csv", "./lot1/paper.csv", "scans/a.csv")
        status, out, _ = run(capsys, "fit", *words, "-o", "out", *QUICK, "--json")
        assert status == 0
        names = sorted(p.name for p in Path("out").iterdir())
        assert names == ["a.json", "lot1-paper.json", "lot2-Paper.json"]
        content = json.loads(out)
        assert [entry["status"] for entry in content["tables"]] == ["fitted"] * 3
        assert {Path(entry["output"]).name for entry in content["tables"]} == set(names)
        assert content["tables"][0]["fit"]["chosen"] == "lambert"

    def test_stems_are_apart_whatever_the_names_are(self):
        parts = ["a", "A", "b", "a-b", "a-2", "\u00e9", "e\u0301"]
        endings = [".csv", ".txt", ""]
        for seed in range(50):
            random = np.random.default_rng(seed)
            places = {
                f"{random.choice(parts)}/{random.choice(parts)}{random.choice(endings)}"
                for _ in range(30)
            }
            stems = table_places.stems(sorted(places))
            assert len({table_places._folded(stem) for stem in stems}) == len(places)
            # Control: the tables' own names are not apart.
            assert len({table_places._folded(Path(place).stem) for place in places}) < len(places)

    def test_inputs_and_files_of_others_stay(self, capsys, scans):
        """Content decides what a table is: one may be called .json."""
        table = Path(write_table("mine/a.json")).read_bytes()
        write_table("mine/package.csv")
        Path("mine/package.json").write_text('{"name": "not ours"}')
        write_table("mine/good.csv")
        words = ("mine/a.json", "mine/package.csv", "mine/good.csv")
        status, _, err = run(capsys, "fit", *words, "-o", "mine", *QUICK)
        assert status == 1
        assert Path("mine/a.json").read_bytes() == table
        assert Path("mine/package.json").read_text() == '{"name": "not ours"}'
        assert load_material("mine/good.json").name == "good"
        assert err.count("\n") == 2
        # A former run's own file is replaced.
        assert run(capsys, "fit", "mine/good.csv", "-o", "mine", *QUICK)[0] == 0

    def test_interrupted(self, capsys, scans, monkeypatch):
        """What is done is kept, and what is not is listed."""
        write_table("scans/c.csv")
        fit_one, count = fit_many._fit, iter(range(9))

        def fit(*words):
            if next(count) == 1:
                raise KeyboardInterrupt
            fit_one(*words)

        monkeypatch.setattr(fit_many, "_fit", fit)
        words = ("scans/a.csv", "scans/b.txt", "scans/c.csv")
        status, out, err = run(capsys, "fit", *words, "-o", "out", *QUICK)
        assert status == 130
        assert [p.name for p in Path("out").iterdir()] == ["a.json"]
        assert "1 of 3 tables fitted" in out
        assert err.splitlines()[0] == "not fitted: scans/b.txt, scans/c.csv"

    @pytest.mark.parametrize(
        ("words", "place"),
        [
            (["scans", "-o", "m.json"], "m.json"),
            (["scans", "-o", "m", "--report", "r.png"], "r.png"),
            (["scans", "-o", "scans/a.csv"], "scans/a.csv"),
            (["scans/old", "-o", "m"], "scans/old"),
            (["scans", "-o", ""], "-o"),
        ],
    )
    def test_wrong_places(self, capsys, scans, words, place):
        before = sorted(str(p) for p in scans.rglob("*"))
        status, out, err = run(capsys, "fit", *words)
        assert (status, out) == (1, "")
        assert place in err
        assert err.count("\n") == 1
        assert sorted(str(p) for p in scans.rglob("*")) == before


class TestMeasure:
    def test_a_picture_and_the_same_by_a_dry_run(self, capsys, scans):
        words = ("uncoated", "--report", "u.png")
        status, out, _ = run(capsys, "measure", *words)
        assert status == 0
        for label in ("read as", "left out", "ridge", "reciprocity", "spectra", "serves for"):
            assert f"\n  {label}" in out
        with Image.open("u.png") as picture:
            assert min(picture.size) > 800
        pixels = Path("u.png").read_bytes()
        Path("u.png").unlink()
        assert run(capsys, "fit", *words, "-o", "u.json", "--dry-run")[:2] == (0, out)
        assert Path("u.png").read_bytes() == pixels
        assert not Path("u.json").exists()

    def test_json_and_faults_of_several(self, capsys, scans):
        Path("one.csv").write_text(
            "# quantity: radiance-factor\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,450,550,650\n"
            "45,180,0,0,0.2,0.3,0.4\n"
        )
        status, out, err = run(capsys, "measure", "one.csv", "--json")
        entry = json.loads(out)
        assert status == 0
        assert (entry["serves_for"]["use"], entry["used"]) == ("estimate", 1)
        status, out, err = run(capsys, "measure", "scans", "one.csv", "-o", "pics", "--json")
        content = json.loads(out)
        assert status == 1
        assert ["fault" in entry for entry in content["tables"]] == [False, False, True, False]
        assert sorted(p.name for p in Path("pics").iterdir()) == ["a.png", "b.png", "one.png"]
        assert "broken.csv" in err
        status, _, err = run(capsys, "measure", "one.csv", "-o", "one.csv")
        assert status == 1
        assert "one.csv" in err


def test_a_hard_link_of_a_table_is_the_table(scans):
    Path("scans/b.json").hardlink_to("scans/b.txt")
    with pytest.raises(InputError, match="would replace"):
        table_places.output_of("scans", "b", ".json", ["scans/b.txt"])
    assert table_places.output_of("scans", "c", ".json", ["scans/b.txt"])
