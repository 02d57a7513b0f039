"""Scene files of a pair: what is written is read back; what is broken is refused in one line."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

import materials
import numpy as np
import pytest
import states
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.material.files import load_material
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import load_scene
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("scenes of mine")


@pytest.fixture(scope="module")
def any_state(folder):
    (folder / "lamps").mkdir()
    made = (states.write_materials(folder / "papers"), states.write_lamps(folder / "lamps"))
    return states.states(*made)


def refused(function, *args):
    with pytest.raises(InputError) as caught:
        function(*args)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 600
    return message


@settings(max_examples=100, deadline=None)
@given(data=st.data())
def test_round_trip_is_exact(folder, any_state, data):
    state = data.draw(any_state)
    place = folder / data.draw(st.sampled_from(["scene.toml", "lamps/beside.toml", "papers/s"]))
    save_state(place, state)
    assert load_state(place) == state
    # `snapshot --scene` draws the test picture of the same file.
    scene, look = load_scene(place)
    assert (scene, look) == (state.scene("test"), state.test.look)


def test_files_move_with_their_scene(tmp_path):
    here, there = tmp_path / "a", tmp_path / "b"
    here.mkdir()
    (sample, *_) = states.write_materials(here / "papers")
    lamp = states.write_lamps(here)[1]
    state = State.initial().with_sample("test", dataclasses.replace(sample, table=str(here / "t")))
    state = state.with_part("lamp", illuminant=lamp)
    save_state(here / "s.toml", state)
    here.rename(there)
    moved = load_state(there / "s.toml")
    assert moved.test.sample.file == str(there / "papers" / "plain.json")
    assert moved.test.sample.table == str(there / "t")
    assert moved.setup.lamp.illuminant == str(there / "FL2")
    # What lies elsewhere is named in full.
    (tmp_path / "c").mkdir()
    save_state(tmp_path / "c" / "s.toml", moved)
    assert str(there) in (tmp_path / "c" / "s.toml").read_text()
    assert load_state(tmp_path / "c" / "s.toml") == moved


def test_relative_names_are_of_the_present_folder(tmp_path, monkeypatch):
    states.write_materials(tmp_path / "papers")
    monkeypatch.chdir(tmp_path)
    sample = Sample(load_material("papers/plain.json"), file="papers/plain.json")
    save_state("papers/s.toml", State.initial().with_sample("test", sample))
    monkeypatch.chdir("/")
    loaded = load_state(tmp_path / "papers" / "s.toml")
    assert loaded.test.sample.file == str(tmp_path / "papers" / "plain.json")


def test_without_a_reference_there_is_the_papers(tmp_path):
    (tmp_path / "s.toml").write_text('[sample]\nname = "uncoated"\n[look]\nseed = 3\n')
    state = load_state(tmp_path / "s.toml")
    initial = State.initial().reference
    assert state.reference.sample == initial.sample
    assert state.reference.look == dataclasses.replace(initial.look, quality="exact")
    assert state.test.sample.name == "uncoated"
    assert state.test.look == Look(seed=3)
    (tmp_path / "s.toml").write_text('[look]\nquality = "auto"\n')
    assert load_state(tmp_path / "s.toml").reference == initial
    (tmp_path / "s.toml").write_text('[reference]\nname = "uncoated"\n')
    assert load_state(tmp_path / "s.toml").reference.look == Look()
    (tmp_path / "s.toml").write_text("[reference.look]\nseed = 4\n")
    state = load_state(tmp_path / "s.toml")
    assert state.reference.look == Look(seed=4)
    assert state.reference.sample == State.initial().reference.sample


def test_numpy_numbers_are_written_as_numbers(tmp_path):
    look = {"sigma_n_deg": np.float64(0.1), "seed": np.int64(7), "c": np.float32(0.5)}
    state = State.initial().with_look("test", c_fraction=None, **look)
    save_state(tmp_path / "s.toml", state)
    assert "np." not in (tmp_path / "s.toml").read_text()
    assert load_state(tmp_path / "s.toml") == state


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("reference = 3\n", "[reference]"),
        ('[reference]\nname = "x"\n', "'x'"),
        ("[reference]\nname = 3\n", "reference.name: expected a text"),
        ('[reference]\nmaterial = "gone.json"\n', "gone.json"),
        ('[reference]\nname = "uncoated"\nmaterial = "a"\n', "either name or material"),
        ("[reference]\ncolour = 1\n", "reference.colour"),
        ("[reference.look]\nseed = 1.5\n", "reference.look.seed"),
        ("[reference.look]\nsheen = 1\n", "reference.look.sheen"),
        ("[reference]\nlook = 1\n", "[reference.look]"),
        ("[reference.look]\nsamples = 'all'\n", "reference.look.samples"),
        ("[look]\nseed = 'auto'\n", "look.seed"),
        ("[sample]\ntable = 1\n", "sample.table"),
        ('[sample]\nmaterial = ["a"]\n', "sample.material"),
        ("presentation = []\n", "[presentation]"),
        ("[presentation]\nwipe = 2\n", "presentation.wipe"),
        ("[presentation]\nwipe = true\n", "presentation.wipe"),
        ("[presentation]\nglow = 1\n", "presentation.glow"),
        ("[presentation]\ncompare = {a = 1}\n", "presentation.compare"),
        ("[presentation]\ncompare = ['x']\n", "presentation.compare"),
        ("[presentation]\ngap_px = 0x" + "f" * 400, "presentation.gap_px"),
        ("[presentation]\nmirror = 1\n", "presentation.mirror"),
        ("[look]\nseed = 1\nseed = 2\n", "line 3"),
        ("[look]\n[look]\n", "look"),
        ('"' + "x" * 5000 + '" = 1\n', "no such table"),
        ("[look]\n" + "x" * 5000 + " = 1\n", "no such entry"),
        ('"a\\nb" = 1\n', "no such table"),
    ],
)
def test_broken_files_are_refused_in_one_line(tmp_path, text, says):
    path = tmp_path / "broken.toml"
    path.write_text(text)
    message = refused(load_state, path)
    assert "broken.toml" in message
    assert says in message
    if "presentation." not in says:
        assert says in refused(load_scene, path)
    else:  # what the window keeps there does not matter to a picture
        assert load_scene(path)[1] == Look()


class TestSaving:
    def test_a_sample_in_no_file(self, tmp_path):
        state = State.initial().with_sample("reference", Sample(materials.paper("art")))
        message = refused(save_state, tmp_path / "s.toml", state)
        assert "[reference]" in message
        assert "save its material first" in message
        assert list(tmp_path.iterdir()) == []

    def test_a_sample_whose_file_is_gone(self, tmp_path):
        (sample, *_) = states.write_materials(tmp_path / "papers")
        Path(sample.file).unlink()
        state = State.initial().with_sample("test", sample)
        message = refused(save_state, tmp_path / "s.toml", state)
        assert "plain.json" in message
        assert "put it back" in message
        assert not (tmp_path / "s.toml").exists()

    def test_a_name_that_is_none(self, tmp_path):
        state = State.initial().with_sample("test", Sample(materials.paper("art"), name="x"))
        assert "'x'" in refused(save_state, tmp_path / "s.toml", state)

    def test_names_that_are_not_utf8(self, tmp_path):
        file = tmp_path / os.fsdecode(b"\xff.json")
        (sample, *_) = states.write_materials(tmp_path / "papers")
        os.rename(sample.file, file)
        named = dataclasses.replace(sample, file=str(file))
        state = State.initial().with_sample("test", named)
        message = refused(save_state, tmp_path / "s.toml", state)
        assert "rename the file" in message
        state = State.initial().with_part("lamp", illuminant=str(tmp_path / "\udcff.csv"))
        assert "rename the file" in refused(save_state, tmp_path / "s.toml", state)
        assert not (tmp_path / "s.toml").exists()

    def test_places_that_can_not_be_written(self, tmp_path, monkeypatch):
        state = State.initial()
        assert "is a folder" in refused(save_state, tmp_path, state)
        refused(save_state, tmp_path / "no" / "s.toml", state)
        refused(save_state, "/dev/full", state)
        refused(save_state, tmp_path / "nul\0", state)
        (tmp_path / "s.toml").write_text("old")

        def full(self, data):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(Path, "write_bytes", full)
        assert "No space left" in refused(save_state, tmp_path / "s.toml", state)
        assert (tmp_path / "s.toml").read_text() == "old"
        assert [p.name for p in tmp_path.iterdir()] == ["s.toml"]


class TestForgiving:
    """What a session needs: one thing that is lost takes nothing else with it."""

    def test_what_is_gone_is_replaced_and_told(self, tmp_path):
        first, second, *_ = states.write_materials(tmp_path / "papers")
        lamp = states.write_lamps(tmp_path)[0]
        state = State.initial().with_sample("test", first).with_sample("reference", second)
        state = state.with_part("lamp", illuminant=lamp, azimuth_deg=20.0)
        state = state.with_look("test", seed=5).with_look("reference", seed=6)
        save_state(tmp_path / "s.toml", state)
        for file in (first.file, second.file, lamp):
            Path(file).unlink()
        told = []
        loaded = load_state(tmp_path / "s.toml", told)
        initial = State.initial()
        assert loaded.test.sample == initial.test.sample
        assert loaded.reference.sample == initial.reference.sample
        assert loaded.test.look == state.test.look
        assert loaded.reference.look == state.reference.look
        assert loaded.setup.lamp == dataclasses.replace(state.setup.lamp, illuminant="HP5")
        assert len(told) == 3
        for line, name in zip(told, ("lamp.csv", "plain.json", "two words.json"), strict=True):
            assert name in line
            assert "is used as the" in line

    def test_what_can_not_be_named_is_left_out(self, tmp_path):
        state = State.initial().with_sample("test", Sample(materials.paper("art")))
        lost = Sample(materials.paper("art"), file="/gone/\udcff.json", table="/t.csv")
        state = state.with_sample("reference", lost).with_look("reference", seed=9)
        state = state.with_part("lamp", illuminant="/\udcff.csv", azimuth_deg=3.0)
        save_state(tmp_path / "s.toml", state, forgiving=True)
        loaded = load_state(tmp_path / "s.toml")
        assert loaded.reference.look == state.reference.look
        assert loaded.setup.lamp.azimuth_deg == 3.0
        assert loaded.test.sample == State.initial().test.sample

    def test_a_wrong_value_is_still_wrong(self, tmp_path):
        (tmp_path / "s.toml").write_text("[look]\nseed = -1\n")
        refused(load_state, tmp_path / "s.toml", [])
