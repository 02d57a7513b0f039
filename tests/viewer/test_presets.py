"""Presets: four published ones, and the user's own in a file that no damage gets written over."""

from __future__ import annotations

from pathlib import Path

import pytest
import states
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES
from relgloss_view.viewer.state import presets
from relgloss_view.viewer.state.presets import (
    Preset,
    add,
    built_in,
    find,
    load,
    remove,
    rename,
    save,
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("presets")


def refused(function, *args):
    with pytest.raises(InputError) as caught:
        function(*args)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 500
    return message


def test_the_published_optima():
    """Ishii et al.: sigma_N 0, 0, 2, 2 degrees and c of 6, 5, 2, 1 sixths."""
    found = {p.name: (p.look.sigma_n_deg, p.look.c_fraction) for p in built_in()}
    assert found == {
        "Published: cast-coated": (0.0, 1.0),
        "Published: art-coated": (0.0, 5 / 6),
        "Published: matte-coated": (2.0, 2 / 6),
        "Published: uncoated": (2.0, 1 / 6),
    }
    assert not set(found) & set(SAMPLES)  # no preset can be taken for a sample
    for name in (*found, *SAMPLES):
        assert "built-in" in refused(add, (), name, Look())


def test_where_they_are_kept(tmp_path, monkeypatch):
    monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path / "h"))
    assert load(presets.presets_file()) == ()
    assert not (tmp_path / "h").exists()
    save(presets.presets_file(), add((), "mine", Look()))
    assert (tmp_path / "h" / "config" / "presets.toml").is_file()


@settings(max_examples=60, deadline=None)
@given(
    named=st.dictionaries(
        st.text(max_size=60) | st.sampled_from(["a.b", '"', "[x]", "it's", "光沢 🎨", "=", "#1"]),
        states.looks,
        max_size=5,
    )
)
def test_round_trip(folder, named):
    made = ()
    for name, look in named.items():
        try:
            made = add(made, name, look)
        except InputError:  # a name that can't be; those that can are in test_names
            continue
    save(folder / "p.toml", made)
    assert load(folder / "p.toml") == made


class TestNames:
    @pytest.mark.parametrize(
        "name", ["a", "x" * 60, "two words", "光沢 é 🎨", "a.b", "[look]", '"', "-", "'''", "1"]
    )
    def test_good_ones(self, tmp_path, name):
        save(tmp_path / "p.toml", add((), name, Look(seed=1)))
        assert load(tmp_path / "p.toml") == (Preset(name, Look(seed=1)),)

    @pytest.mark.parametrize(
        "name", ["", "   ", "x" * 61, "a\nb", "a\0", "\x1b[31m", "\udcff", "a\u200bb", "a\u202eb"]
    )
    def test_bad_ones(self, name):
        assert "printable" in refused(add, (), name, Look())
        assert "printable" in refused(rename, add((), "a", Look()), "a", name)

    def test_they_are_unique_as_they_are_seen(self):
        some = add(add((), "é", Look()), "b", Look())
        assert "taken" in refused(add, some, "e\u0301 ", Look())
        assert "taken" in refused(rename, some, "b", "é")
        assert "built-in" in refused(add, some, "uncoated", Look())
        assert "built-in" in refused(rename, some, "b", "uncoated")


def test_changes():
    one, two = Look(seed=1), Look(seed=2)
    some = add(add((), "a", one), "b", two)
    assert find(some, "b") == Preset("b", two)
    assert find(some, "c") is None
    assert rename(some, "a", "c") == (Preset("c", one), Preset("b", two))
    assert rename(some, "a", "a") == some
    assert remove(some, "a") == (Preset("b", two),)
    assert "none of that name" in refused(remove, some, "x\ny")
    assert "none of that name" in refused(rename, some, "x", "y")
    assert some == (Preset("a", one), Preset("b", two))


def test_there_are_only_so_many(tmp_path, monkeypatch):
    look = Look(sigma_n_deg=0.1 + 0.2, c=1e-17, samples=None)
    many = tuple(Preset(f"{k:03}" + "光" * 57, look) for k in range(presets.MOST))
    assert "500" in refused(add, many, "one more", look)
    save(tmp_path / "p.toml", many)  # as long as they may be, they can be read again
    assert load(tmp_path / "p.toml") == many


DAMAGED = [
    ("[a", "not TOML"),
    ("[a]\nseed = 1\n[a]\nseed = 2\n", "a"),
    ("[a]\nseed = -1\n", "a: look.seed"),
    ("[a]\nsheen = 1\n", "a: look.sheen"),
    ("a = 1\n", "a: look"),
    ('["a\\nb"]\nseed = 1\n', "printable"),
    ('[" a"]\n["a "]\n', "taken"),
    ("[a.b]\nseed = 1\n", "look.b"),
    ("[a]\nc = 1\nc_fraction = 1\n", "not both"),
    ("[a]\nseed = " + "9" * 5000, "digits"),
    ("x" * 2**21, "larger"),
]


@pytest.mark.parametrize(("text", "says"), DAMAGED, ids=lambda v: v[:12])
def test_damaged_files_are_told_and_left_alone(tmp_path, text, says):
    path = tmp_path / "p.toml"
    path.write_text(text)
    message = refused(load, path)
    assert "p.toml" in message
    assert says in message
    assert "not written over" in refused(save, path, built_in())
    assert path.read_text() == text


def test_a_name_that_becomes_built_in_stays_the_users(tmp_path):
    (tmp_path / "p.toml").write_text("[uncoated]\nseed = 4\n[b]\n")
    mine = load(tmp_path / "p.toml")
    assert mine == (Preset("uncoated", Look(seed=4)), Preset("b", Look()))
    save(tmp_path / "p.toml", mine)
    assert load(tmp_path / "p.toml") == mine


def test_places_that_can_not_be_written(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("x")
    refused(save, tmp_path / "file" / "p.toml", built_in())
    refused(save, tmp_path, built_in())
    save(tmp_path / "p.toml", add((), "old", Look()))

    def full(self, data):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    assert "No space left" in refused(save, tmp_path / "p.toml", ())
    assert [p.name for p in load(tmp_path / "p.toml")] == ["old"]
