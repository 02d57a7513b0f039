"""Every option and every entry of a scene file survives the way through a printed command."""

from __future__ import annotations

import argparse
import dataclasses
import shlex
import tempfile
from pathlib import Path

import pytest

from relgloss_view.cli import main
from relgloss_view.commands import snapshot
from relgloss_view.commands.scene_options import add_scene_options, scene_from, scene_words_of
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.lamp_placement import lit_for_gloss
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.options import (
    NEW_DISPLAY,
    OPTIONS,
    SETTING_ENTRIES,
    sample_words,
    scene_words,
    with_options,
)
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import TABLES
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

FILES = tempfile.TemporaryDirectory()  #: of displays, which commands read before they draw


def profile_file(name):
    file = Path(FILES.name, name)
    file.write_bytes(matrix_profile(Display(transfer="gain-offset-gamma")))
    return file


#: Values of tuples and texts, which declare no range.
OTHERS = {
    "illuminant": ("D65",),
    "primaries_xy": (((0.68, 0.32), (0.265, 0.69), (0.15, 0.06)),),
    "white_xy": ((0.31, 0.32),),
    "profile_mm": (((30.0, 0.0), (32.5, 100.0)),),
    "file": (str(Path("pack.obj").absolute()),),
    "profile": (str(profile_file("monitor.icc")),),
    "seen_on": (str(profile_file("other.icc")),),
}


def values_of(field):
    """Values of a declared field, its ends among them, that are not its default."""
    meta = field.metadata
    if "options" in meta:
        values = meta["options"]
    elif meta.get("switch"):
        values = (True, False)
    elif "range" in meta:
        low, high = meta["range"].low, meta["range"].high
        middle = 0.3 * low + 0.7 * high
        values = (low, high, round(middle) if meta.get("whole") else middle)
    else:
        values = OTHERS[field.name]
    values = (*values, None) if meta.get("optional") else values
    return [value for value in values if value != field.default]


ENTRIES = [
    (table, field, value)
    for table, kind in TABLES.items()
    for field in dataclasses.fields(kind)
    for value in values_of(field)
]


def parser():
    made = argparse.ArgumentParser(prog="relgloss")
    snapshot.add(made.add_subparsers(required=True))
    return made


def scene_of(words):
    scene, look, _ = scene_from(parser().parse_args(["snapshot", "-o", "a.png", *words]))
    return scene, look


def drawn_without(option):
    """What a snapshot has where the option is left out."""
    scene, look = scene_of([])
    return getattr(look if option.table == "look" else getattr(scene, option.table), option.entry)


def changed(table, entry, value):
    """A setup and a look with one entry changed; gain goes with offset, black with white."""
    setup, look = Setup(), Look()
    if table == "look":
        return setup, look.with_entries(**{entry: value})
    entries = {entry: value}
    if entry == "offset":
        entries["gain"] = 2.0
    if entry == "gain":
        entries["offset"] = 0.05
    if entry == "black_cd_m2":
        entries["luminance_cd_m2"] = 10000.0
    if value == "mesh":
        entries["file"] = OTHERS["file"][0]
    return setup.with_entries(table, **entries), look


def test_every_table_has_entries():
    assert {table for table, _, _ in ENTRIES} == set(TABLES)
    assert {f"{t}.{f.name}" for t, f, _ in ENTRIES} == {
        f"{table}.{f.name}" for table, kind in TABLES.items() for f in dataclasses.fields(kind)
    }


@pytest.mark.parametrize(
    ("table", "field", "value"),
    ENTRIES,
    ids=lambda x: getattr(x, "name", str(x).rsplit("/", 1)[-1]),
)
def test_an_entry_comes_back_from_the_printed_command(table, field, value):
    setup, look = changed(table, field.name, value)
    line = shlex.join(scene_words(setup, look))
    scene, drawn = scene_of(shlex.split(line))
    assert (scene.setup, drawn.setting) == (setup, look.setting)
    assert drawn.without_c() == look.without_c()


@pytest.mark.parametrize("option", OPTIONS, ids=lambda option: option.flag)
class TestOption:
    def test_it_sets_its_entry(self, option):
        for value in values_of(option.field):
            if value is None and not option.takes_auto:
                continue  # left out
            scene, look = scene_of(option.words(value))
            part = look if option.table == "look" else getattr(scene, option.table)
            assert getattr(part, option.entry) == value

    def test_it_is_found_in_the_printed_command(self, option):
        """The control: a command without the option draws another picture."""
        values = (*values_of(option.field), option.field.default)
        value = next(v for v in values if v not in (None, drawn_without(option)))
        setup, look = changed(option.table, option.entry, value)
        words = scene_words(setup, look)
        k = words.index(option.flag)
        assert scene_of(words)[1].setting == look.setting
        scene, drawn = scene_of(words[:k] + words[k + 2 :])
        assert (scene.setup, drawn.setting, drawn.without_c()) != (
            setup,
            look.setting,
            look.without_c(),
        )

    def test_the_words_that_were_given_are_given_again(self, option):
        """What a grid records: the options as they were typed, none dropped."""
        value = next(v for v in values_of(option.field) if v is not None)
        tuned = option.entry in SETTING_ENTRIES
        grid = argparse.ArgumentParser()
        add_scene_options(grid, tuned=True)
        typed = ["--sample", "uncoated", "--set", "lamp.azimuth_deg=20", *option.words(value)]
        words = scene_words_of(grid.parse_args(typed))
        scene, look, _ = scene_from(grid.parse_args([*typed, "--size", "512x512"]))
        assert scene_of(words) == (scene, look)
        # The control: typed for `snapshot`, the words mean a grain of one size at the eye.
        assert (scene_of(typed)[1].grain == look.grain) == (option.flag == "--grain-kind")
        assert option.flag in words
        assert tuned == (option.flag in ("--sigma-n", "--c", "--c-fraction"))


def test_a_grid_records_its_quality(tmp_path):
    """The recorded command draws the recorded picture: quality, seed and samples are in it."""
    import json

    words = ["--sample", "uncoated", "--size", "16x16", "--quality", "auto", "--seed", "7"]
    assert main(["grid", *words, "--samples", "2", "-o", str(tmp_path / "stimuli")]) == 0
    from PIL import Image

    manifest = json.loads((tmp_path / "stimuli" / "manifest.json").read_text())
    name = manifest["stimuli"][20]["file"]
    with Image.open(tmp_path / "stimuli" / name) as picture:
        line = picture.text["Command"]
        pixels = picture.tobytes()
    for part in ("--quality auto", "--seed 7", "--samples 2"):
        assert part in line
    again = shlex.split(line)[1:]
    again[again.index("-o") + 1] = str(tmp_path / "again.png")
    assert main(again) == 0
    with Image.open(tmp_path / "again.png") as picture:
        assert picture.tobytes() == pixels


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_named(name):
    scene, _ = scene_of(sample_words(Sample.built_in(name)))
    assert scene == Scene(Sample.built_in(name).material, display=NEW_DISPLAY)


def test_options_change_what_a_table_holds_together():
    setup, look = with_options(Setup(), Look(c=0.3), {"--c-fraction": 0.5, "--seed": 3})
    assert look == Look(c_fraction=0.5, seed=3)
    assert setup == Setup()


class TestLamp:
    """The lamp of new pictures, turned to the highlight where nobody places it."""

    def placed(self, *words):
        return scene_of(["--set", "shape.kind=box", *words])[0].setup

    def test_another_form_is_lit_for_gloss(self):
        assert self.placed() == lit_for_gloss(self.placed("--lamp", "given"))
        assert self.placed().lamp != Lamp()

    def test_the_cylinder_keeps_the_papers_geometry(self):
        assert scene_of([])[0].setup.placed(display=Display()) == Setup()
        assert scene_of(["--set", "lamp.azimuth_deg=170"])[0].lamp.azimuth_deg == 170.0

    @pytest.mark.parametrize("word", ["lamp.azimuth_deg=50", "eye.elevation_deg=10"])
    def test_what_is_placed_stays(self, word):
        setup = self.placed("--set", word)
        assert (setup.lamp, setup.eye.azimuth_deg) == (Lamp(), 0.0)

    def test_by_name_it_is_turned_all_the_same(self):
        setup = self.placed("--set", "eye.azimuth_deg=30", "--lamp", "auto")
        assert setup.lamp != Lamp()
        assert setup.eye == Eye(azimuth_deg=30.0)

    def test_an_old_scene_file_is_drawn_as_it_was(self, tmp_path):
        file = tmp_path / "old.toml"
        file.write_text('[sample]\nname = "uncoated"\n[shape]\nkind = "box"\n')
        scene, _ = scene_of(["--scene", str(file)])
        assert scene.setup == Setup(Shape("box"))
        assert scene_of(["--scene", str(file), "--lamp", "auto"])[0].lamp != Lamp()

    def test_a_grid_keeps_its_stimuli_and_records_them(self):
        grid = argparse.ArgumentParser()
        add_scene_options(grid, tuned=False, for_the_eye=False)
        args = grid.parse_args(["--set", "shape.kind=box"])
        scene, _, _ = scene_from(args)
        assert scene.setup == Setup(Shape("box"))
        assert scene_of(scene_words_of(args))[0] == scene


def test_files_from_before_have_no_smooth_edges(tmp_path):
    """And what is written at the defaults holds no word of them: digests of studies stay."""
    from relgloss_view.base.toml import entries

    assert not {"edges", "dither"} & set(entries(Display()))
    assert {"edges", "dither"} <= set(entries(NEW_DISPLAY))
