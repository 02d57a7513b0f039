"""Lamps and ambient light in files, options and copied commands; bad ones are one line."""

from __future__ import annotations

import argparse
import dataclasses
import json

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.commands.scene_options import add_scene_options, scene_from, scene_words_of
from relgloss_view.experiment.design.study_file import (
    load_study,
    study_digest,
    study_from_dict,
    study_to_dict,
)
from relgloss_view.picture.scene.file_kinds import SCENE, kind_of
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.options import further_lamp_of, further_lamp_text, scene_words
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.picture.scene.setup import FurtherLamp, Lamp, Setup

LAMPS = (FurtherLamp(-30.0, 10.0), FurtherLamp(140.0, -5.0, 0.7, 0.05, 2.5), FurtherLamp(share=0.0))
RICH = Setup(lamp=Lamp(radius_m=0.1, ambient=0.25), further_lamps=LAMPS)


def written(tmp_path, setup):
    file = tmp_path / "scene.toml"
    write_scene_file(file, SceneFile(Sample.built_in("uncoated"), Look(), setup))
    return file


def scene_of(*words):
    parser = argparse.ArgumentParser()
    add_scene_options(parser)
    args = parser.parse_args(words)
    return scene_from(args)[0], args


class TestSceneFiles:
    def test_there_and_back(self, tmp_path):
        file = written(tmp_path, RICH)
        assert read_scene_file(file).setup == RICH
        assert kind_of(file) == SCENE
        lone = tmp_path / "lone.toml"
        lone.write_text("[[further_lamp]]\nazimuth_deg = -40\n")
        assert kind_of(lone) == SCENE
        assert read_scene_file(lone).setup.further_lamps == (FurtherLamp(-40.0),)

    def test_a_point_lamp_alone_is_written_as_before(self, tmp_path):
        text = written(tmp_path, Setup()).read_text()
        assert not {"radius_m", "ambient", "further_lamp"} & set(text.replace("[", " ").split())

    @pytest.mark.parametrize(
        ("text", "named"),
        [
            ("[further_lamp]\nazimuth_deg = 1.0\n", "further_lamp"),
            ("further_lamp = 3\n", "further_lamp"),
            ("further_lamp = [1, 2]\n", "further_lamp"),
            ("[[further_lamp]]\nilluminant = 'D65'\n", "further_lamp.illuminant"),
            ("[[further_lamp]]\nshare = -1.0\n", "further_lamp.share"),
            ("[[further_lamp]]\nshare = nan\n", "further_lamp.share"),
            ("[[further_lamp]]\ndistance_m = 'far'\n", "further_lamp.distance_m"),
            ("[[further_lamp]]\n" * 4, "at most 3"),
            ("[lamp]\nambient = 1.5\n", "lamp.ambient"),
            ("[lamp]\nradius_m = inf\n", "lamp.radius_m"),
            ("[lamp]\nradius_m = true\n", "lamp.radius_m"),
        ],
    )
    def test_bad_ones(self, tmp_path, text, named):
        file = tmp_path / "bad.toml"
        file.write_text(text)
        with pytest.raises(InputError, match=named) as caught:
            read_scene_file(file)
        assert "\n" not in str(caught.value)


class TestOptions:
    def test_copied_words_make_the_same(self):
        scene, args = scene_of(*scene_words(RICH, Look()))
        assert scene.setup == RICH
        assert scene_of(*scene_words_of(args))[0].setup == RICH

    def test_they_replace_those_of_a_file(self, tmp_path):
        file = str(written(tmp_path, RICH))
        assert scene_of("--scene", file)[0].setup.further_lamps == LAMPS
        one = scene_of("--scene", file, "--further-lamp=-20,5,2")[0].setup
        assert one.further_lamps == (FurtherLamp(-20.0, 5.0, 2.0),)
        assert one.lamp == RICH.lamp
        none = scene_of("--scene", file, "--further-lamp", "none")[0].setup
        assert none.further_lamps == ()
        assert scene_of("--scene", file, "--set", "lamp.ambient=0")[0].setup.further_lamps == LAMPS

    @pytest.mark.parametrize("lamp", LAMPS)
    def test_a_lamp_as_words(self, lamp):
        assert further_lamp_of(further_lamp_text(lamp)) == lamp

    @pytest.mark.parametrize(
        "words",
        [
            ("--further-lamp", "3"),
            ("--further-lamp", "a,b"),
            ("--further-lamp", "1,2,3,4,5,6"),
            ("--further-lamp", "1,nan"),
            ("--further-lamp", "400,2"),
            ("--further-lamp", "1,2,,"),
            ("--further-lamp", "none", "--further-lamp", "1,2"),
            ("--further-lamp", "1,2") * 4,
            ("--set", "further_lamp.share=2"),
            ("--set", "lamp.ambient=2"),
        ],
    )
    def test_bad_words(self, words):
        with pytest.raises(InputError) as caught:
            scene_of(*words)
        assert "\n" not in str(caught.value)


def test_a_study_keeps_its_lamps(tmp_path):
    """And one without them has the digest that it had."""
    study = load_study("paper")
    plain = study_to_dict(study)
    assert "further_lamp" not in plain
    assert "ambient" not in plain["lamp"]
    rich = study_to_dict(dataclasses.replace(study, setup=RICH))
    assert study_from_dict(json.loads(json.dumps(rich)), tmp_path).setup == RICH
    assert study_digest(rich) != study_digest(plain)
