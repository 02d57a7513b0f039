"""Scenes that are saved with all that no other computer has."""

from __future__ import annotations

import dataclasses
import shutil

import materials
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material, save_material
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files import scene_saving
from relgloss_view.viewer.files.own_materials import keep_material
from relgloss_view.viewer.files.scene_saving import save_scene
from relgloss_view.viewer.state.places import data_folder
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    folder = tmp_path / "home"
    monkeypatch.setenv("RELGLOSS_HOME", str(folder))
    return folder


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "scenes"
    made.mkdir()
    return made


def fitted(kind, table=None):
    """A sample whose file is in the program's own folder, as after a fit in the window."""
    file = keep_material(materials.paper(kind), data_folder() / "materials")
    return Sample.from_file(str(file), table)


def names(folder):
    return sorted(file.name for file in folder.iterdir())


def moved(folder, home):
    """The folder on another computer: somewhere else, without the program's own files."""
    shutil.rmtree(home, ignore_errors=True)
    return folder.rename(folder.with_name("elsewhere"))


@pytest.mark.parametrize("side", ["test", "reference"])
def test_a_fitted_sample_goes_with_the_scene(folder, home, side):
    state = State.initial().with_sample(side, fitted("matte", "/tables/matte.csv"))
    saved = save_scene(folder / "pair.toml", state)
    assert names(folder) == ["pair-matte.json", "pair.toml"]
    assert str(home) not in (folder / "pair.toml").read_text()
    assert saved.words == f"saved pair.toml and pair-matte.json to {folder}"
    opened = load_state(moved(folder, home) / "pair.toml")
    sample = opened.side(side).sample
    assert sample.material == state.side(side).sample.material
    assert sample.table == "/tables/matte.csv"
    assert opened.with_sample(side, state.side(side).sample) == state


def test_the_control_is_a_scene_that_opens_here_only(folder, home):
    """What was written before: the scene alone, which names the program's own folder."""
    save_state(folder / "pair.toml", State.initial().with_sample("test", fitted("matte")))
    with pytest.raises(InputError, match="matte"):
        load_state(moved(folder, home) / "pair.toml")


def test_one_material_on_both_sides_is_one_file(folder):
    state = State.initial()
    for side in ("reference", "test"):
        state = state.with_sample(side, fitted("matte"))
    save_scene(folder / "pair.toml", state)
    assert names(folder) == ["pair-matte.json", "pair.toml"]


def test_a_sample_in_no_file_and_one_whose_file_is_gone(folder, home):
    gone = fitted("art")
    (data_folder() / "materials" / "art-1.json").unlink()
    state = State.initial().with_sample("reference", gone)
    state = state.with_sample("test", Sample(materials.flat(0.25)))
    saved = save_scene(folder / "pair.toml", state)
    assert len(saved.beside) == 2
    opened = load_state(moved(folder, home) / "pair.toml")
    assert opened.test.sample.material == state.test.sample.material
    assert opened.reference.sample.material == gone.material


def test_saving_again_writes_no_other_file(folder):
    state = State.initial().with_sample("test", fitted("matte"))
    save_scene(folder / "pair.toml", state)
    before = (folder / "pair-matte.json").stat().st_mtime_ns
    save_scene(folder / "pair.toml", state.with_look("test", seed=5))
    assert names(folder) == ["pair-matte.json", "pair.toml"]
    assert (folder / "pair-matte.json").stat().st_mtime_ns == before
    assert load_state(folder / "pair.toml").test.look.seed == 5


@pytest.mark.parametrize("held", ["mine", "{}", "material"])
def test_nothing_is_written_over(folder, held):
    other = folder / "pair-matte.json"
    if held == "material":
        save_material(materials.paper("art"), other)
    else:
        other.write_text(held)
    before = other.read_bytes()
    state = State.initial().with_sample("test", fitted("matte"))
    for _ in range(2):
        save_scene(folder / "pair.toml", state)
        assert names(folder) == ["pair-matte-2.json", "pair-matte.json", "pair.toml"]
        assert other.read_bytes() == before
    assert load_state(folder / "pair.toml").test.sample.material == state.test.sample.material


def test_a_scene_that_cannot_be_written_leaves_no_sample(folder, monkeypatch):
    def refuse(path, state):
        raise InputError("the disk is full")

    monkeypatch.setattr(scene_saving, "save_state", refuse)
    with pytest.raises(InputError, match="full"):
        save_scene(folder / "pair.toml", State.initial().with_sample("test", fitted("matte")))
    assert names(folder) == []


def test_a_file_that_was_there_stays_when_the_scene_cannot_be_written(folder, monkeypatch):
    state = State.initial().with_sample("test", fitted("matte"))
    save_scene(folder / "pair.toml", state)

    def refuse(path, state):
        raise InputError("the disk is full")

    monkeypatch.setattr(scene_saving, "save_state", refuse)
    with pytest.raises(InputError, match="full"):
        save_scene(folder / "pair.toml", state)
    assert load_material(folder / "pair-matte.json") == state.test.sample.material


def test_files_of_the_user_stay_where_they_are(folder, tmp_path):
    """They are named, and the message lists those that another computer needs too."""
    save_material(materials.paper("art"), folder / "art.json")
    save_material(materials.paper("matte"), tmp_path / "matte.json")
    lamp = tmp_path / "lamp.csv"
    lamp.write_bytes(asset("spectra", "D65.csv").read_bytes())
    state = State.initial().with_sample("reference", Sample.from_file(str(folder / "art.json")))
    state = state.with_sample("test", Sample.from_file(str(tmp_path / "matte.json")))
    state = state.placed(lamp=dataclasses.replace(state.setup.lamp, illuminant=str(lamp)))
    saved = save_scene(folder / "pair.toml", state)
    assert names(folder) == ["art.json", "pair.toml"]
    assert saved.elsewhere == (tmp_path / "matte.json", lamp)
    assert saved.words.endswith(f"copy these too: {tmp_path / 'matte.json'}, {lamp}")
    assert load_state(folder / "pair.toml") == state
    # The control: built-in samples need nothing.
    assert (
        save_scene(folder / "plain.toml", State.initial()).words == f"saved plain.toml to {folder}"
    )


def test_odd_names_make_a_file_all_the_same(folder, home):
    material = dataclasses.replace(materials.paper("matte"), name='光沢 / "x" ' + 80 * "é")
    state = State.initial().with_sample("test", Sample(material))
    save_scene(folder / f"{60 * 'ü'}.toml", state)
    opened = load_state(moved(folder, home) / f"{60 * 'ü'}.toml")
    assert opened.test.sample.material == material
