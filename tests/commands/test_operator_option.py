"""--operator of snapshot and grid: the picture, its numbers, its command, and what is refused."""

from __future__ import annotations

import json
import shlex

import numpy as np
import pytest
from PIL import Image
from test_cli import refused, run

from relgloss_view.gloss.match import Reference, matched_point
from relgloss_view.operators.registry import OPERATORS, make_operator
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.options import NEW_DISPLAY
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.backends import open_renderer

OpenEXR = pytest.importorskip("OpenEXR")
SMALL = ("--sample", "art-coated", "--sigma-n", 1, "--size", "48x40")


def pixels(path):
    with Image.open(path) as picture:
        return np.asarray(picture)


class TestSnapshot:
    @pytest.mark.parametrize("name", list(OPERATORS))
    def test_shows_the_operators_picture(self, capsys, tmp_path, name):
        path = tmp_path / "a.png"
        status, out, _ = run(capsys, "snapshot", *SMALL, "--operator", name, "--json", "-o", path)
        assert status == 0
        with open_renderer() as renderer:
            c = matched_point(Reference.default(), load_sample("art-coated"), 1.0).c
            look = viewed_look(sigma_n_deg=1.0, c=c)
            scene = Scene(load_sample("art-coated"), display=NEW_DISPLAY)
            frame = renderer.render(scene, look, (48, 40))
            shown = make_operator(name).draw(frame)
            np.testing.assert_array_equal(pixels(path), shown.digital)
        numbers = json.loads(out)
        assert numbers["operator"] == name
        assert (numbers["clip_count"], numbers["out_of_gamut_count"]) == (
            shown.clip_count,
            shown.out_of_gamut_count,
        )

    def test_parameters_and_the_command_that_draws_it_again(self, capsys, tmp_path):
        path = tmp_path / "a.png"
        words = (*SMALL, "--operator", "multiscale", "--operator-set", "local=0.1", "--bits", 16)
        assert run(capsys, "snapshot", *words, "-o", path)[0] == 0
        first = pixels(path)
        with Image.open(path) as picture:
            numbers = json.loads(picture.info["Parameters"])
            command = shlex.split(picture.info["Command"])
        assert numbers["operator_parameters"]["local"] == 0.1
        assert numbers["operator_parameters"]["rods"] is False
        path.unlink()
        assert run(capsys, *command[1:])[0] == 0
        np.testing.assert_array_equal(pixels(path), first)
        assert run(capsys, "snapshot", *words[:-4], "-o", path)[0] == 0
        assert not np.array_equal(pixels(path), first)

    def test_exr_keeps_its_layers(self, capsys, tmp_path):
        files = {}
        for name in ("split", "clip"):
            path = tmp_path / f"{name}.exr"
            assert run(capsys, "snapshot", *SMALL, "--operator", name, "-o", path)[0] == 0
            with OpenEXR.File(str(path), separate_channels=True) as file:
                header = dict(file.header())
                files[name] = {k: v.pixels for k, v in file.channels().items()}
            assert header["operator"] == name
        split, clip = files["split"], files["clip"]
        assert split.keys() == clip.keys()
        same = {name for name in split if np.array_equal(split[name], clip[name])}
        # Lab is that of the split, whose c the operator does not use.
        assert set("RGB") <= set(split) - same <= {*"RGB", "Lab.L"}

    def test_c_that_is_not_used_is_told_only_where_it_was_asked_for(self, capsys, tmp_path):
        words = ("snapshot", *SMALL, "--operator", "clip", "-o", tmp_path / "a.png")
        assert "account of c" not in run(capsys, *words)[2]
        assert "clip takes no account of c" in run(capsys, *words, "--c", 0.2)[2]
        # What the split would warn of is no concern of another operator.
        told = run(capsys, *words, "--c", 5)[2]
        assert "exaggerates" not in told
        assert told.count("account of c") == 1

    def test_warnings_of_operators_reach_the_terminal_and_the_file(self, capsys, tmp_path):
        path = tmp_path / "a.png"
        words = ("--operator", "multiscale", "--operator-set", "rods=true", "-o", path)
        err = run(capsys, "snapshot", *SMALL, *words)[2]
        assert "warning: rods rely on approximated transducers" in err
        with Image.open(path) as picture:
            assert "rods rely" in " ".join(json.loads(picture.info["Parameters"])["warnings"])

    def test_what_is_left_open_is_auto(self, capsys, tmp_path):
        words = ("--operator", "schlick", "--operator-set", "p=auto", "--json")
        out = run(capsys, "snapshot", *SMALL, *words, "-o", tmp_path / "a.png")[1]
        assert json.loads(out)["operator_parameters"]["p"] is None

    @pytest.mark.parametrize(
        ("words", "place"),
        [
            (("--operator", "clip", "--operator-set", "local=1"), "expected a parameter of cut"),
            (("--operator", "clip", "--operator-set", "cut=hue"), "clip.cut: expected one of"),
            (("--operator", "multiscale", "--operator-set", "local=2"), "multiscale.local"),
            (("--operator", "multiscale", "--operator-set", "rods=3"), "expected true or false"),
            (("--operator", "multiscale", "--operator-set", "local=auto"), "multiscale.local"),
            (("--operator", "clip", "--operator-set", "cut"), "setting cut: expected NAME"),
            (("--operator-set", "c=1"), "split: expected a parameter of none"),
        ],
    )
    def test_refused(self, capsys, tmp_path, words, place):
        assert place in refused(capsys, tmp_path, "snapshot", *words, "-o", tmp_path / "a.png")
        refused(capsys, tmp_path, "grid", *words, "-o", tmp_path / "stimuli")

    def test_unknown_name_is_wrong_usage(self, capsys, tmp_path):
        words = ("snapshot", "--operator", "aces", "-o", tmp_path / "a.png")
        assert "multiscale" in refused(capsys, tmp_path, *words, status=2)


class TestGrid:
    def test_of_an_operator_without_c(self, capsys, tmp_path):
        folder = tmp_path / "stimuli"
        words = ("--operator", "clip", "--operator-set", "cut=rgb", "--size", "32x32")
        assert run(capsys, "grid", *words, "-o", folder)[0] == 0
        manifest = json.loads((folder / "manifest.json").read_text())
        assert manifest["operator"] == "clip"
        assert manifest["operator_parameters"] == {"cut": "rgb"}
        assert [s["sigma_n_deg"] for s in manifest["stimuli"]] == [0, 0.5, 1, 1.5, 2, 2.5, 3]
        assert all(s["c_sixths"] is None for s in manifest["stimuli"])
        one = folder / manifest["stimuli"][3]["file"]
        first = pixels(one)
        with Image.open(one) as picture:
            command = shlex.split(picture.info["Command"])
        command[command.index("-o") + 1] = str(tmp_path / "again.png")
        assert run(capsys, *command[1:])[0] == 0
        np.testing.assert_array_equal(pixels(tmp_path / "again.png"), first)
        assert not any(s["warnings"] for s in manifest["stimuli"])
