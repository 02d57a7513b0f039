"""Unpacking a proof of anybody: no name leads out of the folder, and it is whole or nothing."""

from __future__ import annotations

import base64
import re
from pathlib import Path

import pytest

import relgloss_view
from relgloss_view.base.errors import InputError
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import Sample, load_sample
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.picture.scene.setup import Eye, Setup
from relgloss_view.proof.carry import files_of
from relgloss_view.proof.page.whole import page_of
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.settings import LampPlace, PictureSetting, Settings
from relgloss_view.proof.unpack import MOST_BYTES, MOST_FILES, contents_of, opened, unpacked


@pytest.fixture
def files(tmp_path):
    """The files of a proof of two papers."""
    folder = tmp_path / "made"
    (folder / "materials").mkdir(parents=True)
    samples = {}
    for side, name in (("test", "uncoated"), ("reference", "cast-coated")):
        file = folder / "materials" / f"{side}.json"
        save_material(load_sample(name), file)
        samples[side] = Sample(load_sample(name), file=str(file))
    scene = SceneFile(
        samples["test"], Look(2.0, c=0.3), Setup(), samples["reference"], Look(c=0.14)
    )  # fmt: skip
    write_scene_file(folder / "scene.toml", scene)
    return files_of(folder)


def proof_of(files: dict, lamp: str = "HP5") -> Proof:
    settings = Settings(
        PictureSetting(0.0, 0.2), PictureSetting(1.0, 0.5), Eye(azimuth_deg=10.0),
        LampPlace(azimuth_deg=80.0, illuminant=lamp),
    )  # fmt: skip
    return Proof({"title": "x", "files": files}, (Message(settings),))


def test_a_scene_comes_out_as_it_went_in(files, tmp_path):
    scene = unpacked(proof_of(files), tmp_path / "out")
    assert scene.sample.material == load_sample("uncoated")
    assert scene.reference.material == load_sample("cast-coated")
    assert (scene.look.sigma_n_deg, scene.look.c) == (2.0, 0.3)
    assert read_scene_file(tmp_path / "out" / "scene.toml") == scene


def test_settings_of_a_message_come_with_it(files):
    with opened(proof_of(files)) as one:
        scene = one.scene_at()
        pair = one.pair()
    assert (scene.look.sigma_n_deg, scene.look.c) == (1.0, 0.5)
    assert scene.setup.eye.azimuth_deg == 10.0
    assert scene.setup.lamp.azimuth_deg == 80.0
    assert pair.settings.test == PictureSetting(1.0, 0.5)


HOSTILE = (
    "../evil.json", "/etc/evil.json", "a/../../evil.json", "..\\evil.json", "C:evil.json",
    "con.json", "materials/nul.json", "aux.toml", "a\0.json", "", ".", "..", "~/evil.json",
    "materials/a/b.json", "Scene.toml", "scene.TOML", "scene.toml ", "scene.toml.", "a.exe",
    ".hidden.json", "a" * 300 + ".json", "m\u0430terials/test.json", "-o.json", "a b.json",
    "scene.toml/x.json", "//server/share.json", "lpt1.csv", "a:b.json", "\u202ea.json",
)  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_no_hostile_name_leads_out(name, files, tmp_path):
    hostile = {**files, name: {"text": "evil"}}
    target = tmp_path / "deep" / "out"
    before = {p for p in tmp_path.rglob("*") if "made" not in p.parts}
    with pytest.raises(InputError) as raised:
        unpacked(proof_of(hostile), target)
    assert "\n" not in str(raised.value)
    assert {p for p in tmp_path.rglob("*") if "made" not in p.parts} == before
    assert not Path("/etc/evil.json").exists()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("materials/test.json", "/etc/passwd"),
        ("materials/test.json", "../../../secret.json"),
        ('illuminant = "HP5"', 'illuminant = "/etc/hosts.csv"'),
        ('illuminant = "HP5"', 'illuminant = "..\\\\hosts.csv"'),
        ('transfer = "srgb"', 'transfer = "srgb"\nprofile = "/usr/share/color/x.icc"'),
        ('transfer = "srgb"', 'transfer = "srgb"\nseen_on = "~/x.icc"'),
        ("[sample]\n", '[sample]\ntable = "C:\\\\measured.csv"\n'),
    ],
)
def test_no_file_of_the_reader_is_opened(old, new, files, tmp_path):
    text = files["scene.toml"]["text"]
    assert old in text
    hostile = {**files, "scene.toml": {"text": text.replace(old, new)}}
    with pytest.raises(InputError, match="no file of the proof"):
        unpacked(proof_of(hostile), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_display_file_names_no_profile_elsewhere(files, tmp_path):
    hostile = {**files, "display.toml": {"text": '[display]\nprofile = "/tmp/other.icc"\n'}}
    with pytest.raises(InputError, match="no file of the proof"):
        contents_of(hostile)


def test_what_is_too_much_is_refused(files, monkeypatch):
    many = {f"materials/m{k}.json": {"text": ""} for k in range(MOST_FILES)}
    with pytest.raises(InputError, match="at most"):
        contents_of({**files, **many})
    monkeypatch.setattr("relgloss_view.proof.unpack.MOST_BYTES", 20_000)
    with pytest.raises(InputError, match="at most"):
        contents_of({**files, "lamp.csv": {"text": 10_000 * "1"}})
    with pytest.raises(InputError, match="at most"):
        contents_of({**files, "a.png": {"base64": base64.b64encode(bytes(10_000)).decode()}})
    assert MOST_BYTES == 64 << 20


@pytest.mark.parametrize(
    "file",
    [{"base64": "!!"}, {"base64": "AA==", "text": ""}, {}, None, [], {"text": 3}, {"base64": 3}],
)
def test_what_no_program_has_written_is_refused(file, files, tmp_path):
    with pytest.raises(InputError):
        unpacked(proof_of({**files, "a.png": file}), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_damaged_scene_leaves_nothing(files, tmp_path):
    hostile = {**files, "materials/test.json": {"text": "{}"}}
    with pytest.raises(InputError):
        unpacked(proof_of(hostile), tmp_path / "out")
    assert not (tmp_path / "out").exists()
    with pytest.raises(InputError, match="the proof's"), opened(proof_of(hostile)):
        pass


def test_a_lamp_of_settings_is_one_of_the_proof(files):
    with opened(proof_of(files, lamp="../lamp.csv")) as one, pytest.raises(InputError):
        one.pair()


def test_without_a_scene_there_is_nothing(files):
    files.pop("scene.toml")
    with pytest.raises(InputError, match=r"scene\.toml"):
        contents_of(files)
    for nothing in (None, [], "scene.toml"):
        with pytest.raises(InputError):
            contents_of(nothing)


def test_python_of_the_docs(paper, tmp_path, monkeypatch, capsys):
    """The block of docs/proof.md, run on a file; a changed one is refused by both entries."""
    docs = (Path(__file__).parents[2] / "docs" / "proof.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"```python\n(.*?)```", docs, re.S)
    html = page_of(paper)
    (tmp_path / "carton.html").write_text(html, encoding="utf-8", newline="\n")
    monkeypatch.chdir(tmp_path)
    exec(compile(block, "docs/proof.md", "exec"), {})
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(paper.messages) + 1
    assert str(paper.sent.test.c) in lines[0]
    assert lines[-1].endswith("(256, 256, 3)")
    (tmp_path / "changed.html").write_text(html.replace("<title>", "<title>x"), encoding="utf-8")
    for entry in (relgloss_view.read_proof, relgloss_view.open_proof):
        words = r"changed\.html: changed after it was made"
        with pytest.raises(InputError, match=words), entry("changed.html"):
            pass
