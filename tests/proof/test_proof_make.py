"""`relgloss proof make`: one file, whole or not at all, and a line for what can't be."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from relgloss_view.cli import main
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.proof.grid import compare
from relgloss_view.proof.proof import MOST_NOTE
from relgloss_view.proof.read import read_proof
from relgloss_view.proof.unpack import opened
from relgloss_view.quality.backends import open_renderer

SMALL = ["--size", "48x48"]


@pytest.fixture(scope="module")
def paper(tmp_path_factory):
    """A proof of the default paper, and what the command printed."""
    file = tmp_path_factory.mktemp("proof") / "paper.html"
    words = ["proof", "make", "matte-coated", "-o", str(file), "--note", "Right <b>?", "--author",
             "Ada", "--json", *SMALL]  # fmt: skip
    assert main(words) == 0
    return file


def test_the_file_holds_what_the_window_shows(paper):
    proof = read_proof(paper)
    assert (proof.messages[0].note, proof.messages[0].author) == ("Right <b>?", "Ada")
    assert proof.messages[0].parent == ""
    assert proof.sent.test.sigma_n_deg == 2.0  # of the paper's observers, as the window begins
    # The match of the window's own start: State.initial().
    assert proof.sent.test.c == pytest.approx(0.3674657899764722, rel=1e-9)
    assert proof.sent.reference.c == pytest.approx(0.14028224403454445, rel=1e-9)
    with opened(proof) as one, open_renderer() as renderer:
        pictures = one.pair().drawn(renderer, (48, 48))
        for side, picture in pictures.items():
            assert compare(proof.content["grid"]["sides"][side], picture).largest < 1e-4
        assert one.scene_file.look.grain == "eye"
        assert one.scene_file.setup.display.edges == "smooth"


def test_it_prints_name_sizes_and_the_next_step(paper, capsys):
    answer = paper.with_name("answer.html")
    words = ["proof", "make", str(paper), "-o", str(answer), "--note", "Less", "--c", "0.3"]
    assert main([*words, "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    proof, parent = read_proof(answer), read_proof(paper)
    assert printed["digest"] == proof.digest
    assert printed["bytes"] == answer.stat().st_size
    assert printed["parent"] == parent.digest
    assert proof.sent.test.c == 0.3
    assert proof.sent.reference == parent.sent.reference
    assert proof.content == parent.content
    assert main(words) == 0
    out = capsys.readouterr().out
    assert "opens it in a browser" in out
    assert f"digest {read_proof(answer).digest}" in out


def test_a_paper_is_smaller_than_400_kb(tmp_path, capsys):
    file = tmp_path / "paper.html"
    assert main(["proof", "make", "matte-coated", "-o", str(file), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["bytes"] < 400_000, printed["sizes"]
    assert sum(printed["sizes"].values()) < printed["bytes"]


def test_a_material_a_scene_and_a_pack_are_told_apart(tmp_path, capsys):
    save_material(load_sample("uncoated"), tmp_path / "mine.json")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        '[sample]\nmaterial = "mine.json"\n[look]\nc = 0.2\n[reference]\nname = "art-coated"\n'
        '[reference.look]\nc_fraction = 0.5\n[presentation]\ntest_operator = "clip"\n'
    )
    file = tmp_path / "out.html"
    assert main(["proof", "make", str(scene), "-o", str(file), *SMALL]) == 0
    assert "a proof shows the split" in capsys.readouterr().err
    proof = read_proof(file)
    assert proof.sent.test.c == 0.2
    # A share of c_max became the number that its picture has.
    grid = proof.content["grid"]["sides"]["reference"]
    drawn = [a for a in zip(grid["l_d"], grid["l_s"], strict=True) if a[1]]
    assert 0.0 < proof.sent.reference.c <= 0.5 * min((100 - d) / s for d, s in drawn)
    assert main(["proof", "make", str(tmp_path / "mine.json"), "-o", str(file), *SMALL]) == 0
    assert read_proof(file).title == "uncoated, green ink"


REFUSED = {
    "not .html": (["matte-coated", "-o", "proof.pdf"], "ends in .html"),
    "no file": (["gone.toml", "-o", "proof.html"], "gone.toml: there is no such file"),
    "no name": (["cartoon", "-o", "proof.html"], "uncoated, can, carton"),
    "no folder": (["matte-coated", "-o", "gone/proof.html"], "gone"),
    "dull reference": (["art-coated", "--reference", "dull.json", "-o", "p.html"], "no highlight"),
    "long note": (["art-coated", "-o", "p.html", "--note", "x" * (MOST_NOTE + 1)], str(MOST_NOTE)),
    "no key": (["art-coated", "-o", "p.html", "--sign", "gone.pem"], "gone.pem"),
    "no note file": (["art-coated", "-o", "p.html", "--note-file", "gone.txt"], "gone.txt"),
    "no proof": (["other.html", "-o", "p.html", "--note", "x"], "other.html"),
}


@pytest.mark.parametrize("name", list(REFUSED))
def test_one_line_for_what_can_not_be(name, tmp_path, monkeypatch, capsys):
    import dataclasses

    monkeypatch.chdir(tmp_path)
    dull = dataclasses.replace(load_sample("uncoated"), specular=())
    save_material(dull, "dull.json")
    Path("other.html").write_text("<!DOCTYPE html><p>hello</p>")
    words, expected = REFUSED[name]
    assert main(["proof", "make", *words, *SMALL]) == 1
    printed = capsys.readouterr().err
    assert len([line for line in printed.splitlines() if "warning" not in line]) == 1
    assert expected in printed
    assert sorted(p.name for p in tmp_path.iterdir()) == ["dull.json", "other.html"]


def test_an_answer_needs_a_note_and_keeps_the_scene(paper, tmp_path, capsys):
    output = str(tmp_path / "answer.html")
    assert main(["proof", "make", str(paper), "-o", output]) == 1
    assert "--note" in capsys.readouterr().err
    words = ["proof", "make", str(paper), "-o", output, "--note", "x", "--sample", "uncoated"]
    assert main(words) == 1
    assert "keeps the scene" in capsys.readouterr().err
    # The default of an option that an answer can't follow is no wish; another value is.
    assert main([*words[:-2], "--size", "100x100"]) == 1
    assert "--size: an answer keeps the scene" in capsys.readouterr().err
    assert not Path(output).exists()
    assert main([*words[:-2], "--size", "512x512"]) == 0


def test_a_stop_leaves_nothing(tmp_path, monkeypatch):
    def stopped(*args: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("relgloss_view.proof.content.meter_of", stopped)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    output = tmp_path / "proof.html"
    assert main(["proof", "make", "art-coated", "-o", str(output), *SMALL]) == 130
    assert list(tmp_path.iterdir()) == []


def test_a_signed_proof_names_its_key(tmp_path, capsys):
    from relgloss_view.proof.keys import make_key

    public = make_key(tmp_path / "my.pem")
    output = tmp_path / "proof.html"
    words = ["proof", "make", "art-coated", "-o", str(output), "--sign", str(tmp_path / "my.pem")]
    assert main([*words, *SMALL]) == 0
    assert [s.key for s in read_proof(output).signatures] == [public]


def test_a_snapshot_draws_the_scene_of_a_proof(paper, tmp_path):
    import numpy as np
    from PIL import Image

    output = tmp_path / "test.png"
    assert main(["snapshot", "--scene", str(paper), "-o", str(output), *SMALL]) == 0
    with opened(read_proof(paper)) as one, open_renderer() as renderer:
        drawn = one.pair().drawn(renderer, (48, 48))
    with Image.open(output) as picture:
        pixels = np.asarray(picture)
    assert np.array_equal(pixels, drawn["test"].rgb)
    assert not np.array_equal(pixels, drawn["reference"].rgb)


def test_a_study_of_a_proof_shows_its_pair(paper, tmp_path, capsys):
    from relgloss_view.experiment.design.study_file import load_study
    from relgloss_view.picture.scene.setting import Setting

    study_file = tmp_path / "mine.toml"
    assert main(["experiment", "new", "--proof", str(paper), "-o", str(study_file)]) == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine-files", "mine.toml"]
    study = load_study(study_file)
    proof = read_proof(paper)
    assert [s.sample.material for s in study.samples] == [load_sample("matte-coated")]
    assert study.screen.size == (48, 48)
    with opened(proof) as one, open_renderer() as renderer:
        pair = one.pair()
        own = renderer.render(study.reference_scene(), study.reference_look, (48, 48))
        sent = renderer.render(pair.scenes["reference"], pair.looks["reference"], (48, 48))
        assert (own.display == sent.display).all()
        look = study.test_look(Setting(2.0, c=proof.sent.test.c))
        own = renderer.render(study.scene(0), look, (48, 48))
        sent = renderer.render(pair.scenes["test"], pair.looks["test"], (48, 48))
        assert (own.display == sent.display).all()
    # An existing study stays, and so do its files.
    before = study_file.read_bytes()
    assert main(["experiment", "new", "--proof", str(paper), "-o", str(study_file)]) == 1
    assert study_file.read_bytes() == before
    assert main(["experiment", "simulate", str(paper), "-o", str(tmp_path / "s.sqlite")]) == 1
    assert "experiment new --proof" in capsys.readouterr().err
