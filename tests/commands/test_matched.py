"""What `snapshot` and `grid` draw where nobody asks for a c: the matched one, scaled as a pair."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from materials import paper
from PIL import Image
from test_cli import refused, run

from relgloss_view.gloss.match import Reference, full_c, matched_point
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.sample import SAMPLES, load_sample

SIZE = ("--size", "200x200")
ASIDE = ("--set", "lamp.azimuth_deg=125")


def drawn(capsys, tmp_path, *words):
    status, out, err = run(
        capsys, "snapshot", *SIZE, *words, "--json", "-o", tmp_path / "picture.png"
    )
    assert status == 0, err
    return json.loads(out)


class TestDefault:
    @pytest.mark.parametrize("name", SAMPLES)
    def test_a_built_in_paper_is_matched_at_its_own_grain(self, capsys, tmp_path, name):
        found = drawn(capsys, tmp_path, "--sample", name)
        sigma = SAMPLES[name].sigma_n_deg
        wanted = matched_point(Reference.default(), load_sample(name), sigma).c
        assert found["sigma_n_deg"] == sigma
        assert found["c"] == pytest.approx(wanted)
        assert found["match"]["reference"]["label"] == "cast-coated"
        assert found["match"]["factor"] == 1.0
        assert found["match"]["ratio"] == pytest.approx(wanted / Reference.default().c)

    def test_a_file_is_smooth_and_matched(self, capsys, tmp_path):
        save_material(paper("matte"), tmp_path / "mine.json")
        found = drawn(capsys, tmp_path, "--material", tmp_path / "mine.json")
        assert found["sigma_n_deg"] == 0.0
        assert found["c"] == pytest.approx(
            matched_point(Reference.default(), paper("matte"), 0.0).c
        )
        assert found["c"] < 0.5 * found["c_max"]  # and not at c_max

    def test_a_given_graininess_is_kept(self, capsys, tmp_path):
        found = drawn(capsys, tmp_path, "--sample", "uncoated", "--sigma-n", 0.5)
        assert found["sigma_n_deg"] == 0.5
        wanted = matched_point(Reference.default(), load_sample("uncoated"), 0.5).c
        assert found["c"] == pytest.approx(wanted)

    def test_another_reference(self, capsys, tmp_path):
        found = drawn(capsys, tmp_path, "--reference", "art-coated=0,0.5")
        art = load_sample("art-coated")
        assert found["match"]["reference"]["c"] == pytest.approx(0.5 * full_c(art))

    @pytest.mark.parametrize("size", ["64x64", "200x200", "700x500"])
    def test_the_size_does_not_change_c(self, capsys, tmp_path, size):
        found = drawn(capsys, tmp_path, "--size", size)
        assert (
            found["match"]["c"]
            == matched_point(Reference.default(), load_sample("matte-coated"), 2.0).c
        )


class TestInAView:
    def test_reference_and_test_are_scaled_alike(self, capsys, tmp_path):
        pair = [drawn(capsys, tmp_path, "--sample", n, *ASIDE) for n in ("cast-coated", "uncoated")]
        assert pair[0]["match"]["factor"] < 0.9
        assert [found["clip_count"] for found in pair] == [0, 0]
        wanted = pair[1]["match"]["ratio"]
        assert pair[1]["c"] / pair[0]["c"] == pytest.approx(wanted, rel=1e-6)

    def test_the_view_is_reported(self, capsys, tmp_path):
        out = run(capsys, "snapshot", *SIZE, *ASIDE, "-o", tmp_path / "a.png")[1]
        assert "times as large in this view" in out
        assert "times as large" not in run(capsys, "snapshot", *SIZE, "-o", tmp_path / "a.png")[1]

    def test_a_number_is_drawn_as_it_is_and_clips(self, capsys, tmp_path):
        """The control: what is asked for by value is not scaled."""
        found = drawn(capsys, tmp_path, "--c", 3.0, *ASIDE)
        assert found["c"] == 3.0
        assert found["match"] is None
        assert found["clip_count"] > 0


class TestAskedFor:
    def test_c_max(self, capsys, tmp_path):
        found = drawn(capsys, tmp_path, "--c", "max")
        assert found["c"] == found["c_max"]
        assert found["match"] is None

    def test_a_share_is_of_this_pictures_c_max(self, capsys, tmp_path):
        found = drawn(capsys, tmp_path, "--c-fraction", 0.5)
        assert found["c"] == pytest.approx(0.5 * found["c_max"])

    def test_published(self, capsys, tmp_path):
        found = drawn(capsys, tmp_path, "--sample", "uncoated", "--published")
        assert found["c"] == pytest.approx(found["c_max"] / 6)

    @pytest.mark.parametrize(
        ("words", "place"),
        [
            (("--c", "most"), "--c"),
            (("--c", "matched", "--c-fraction", "1"), "not allowed"),
            (("--reference", "glass"), "glass"),
            (("--reference", "art-coated=0,0"), "has no gloss"),
        ],
        ids=str,
    )
    def test_refused(self, capsys, tmp_path, words, place):
        status = 2 if words[0] == "--c" else 1
        out = tmp_path / "a.png"
        err = refused(capsys, tmp_path, "snapshot", *words, "-o", out, status=status)
        assert place in err


class TestSceneFiles:
    def test_a_file_without_a_match_draws_what_it_always_has(self, capsys, tmp_path):
        (tmp_path / "old.toml").write_text('[sample]\nname = "uncoated"\n[look]\nsigma_n_deg = 1\n')
        found = drawn(capsys, tmp_path, "--scene", tmp_path / "old.toml")
        assert (found["c"], found["match"]) == (found["c_max"], None)
        words = ("snapshot", "--scene", tmp_path / "old.toml", *SIZE, "-o", tmp_path / "a.png")
        assert "--c matched keeps the ratio" in run(capsys, *words)[1]
        found = drawn(capsys, tmp_path, "--scene", tmp_path / "old.toml", "--c", "matched")
        wanted = matched_point(Reference.default(), load_sample("uncoated"), 1.0).c
        assert found["c"] == pytest.approx(wanted)

    @pytest.fixture
    def pair(self, capsys, tmp_path):
        file = tmp_path / "pair.toml"
        assert run(capsys, "match", "matte-coated", *ASIDE, "--write", file)[0] == 0
        return file

    def test_a_pair_is_scaled_as_the_window_shows_it(self, capsys, tmp_path, pair):
        found = drawn(capsys, tmp_path, "--scene", pair)
        assert found["match"]["factor"] < 0.9
        assert found["clip_count"] == 0

    def test_a_pair_whose_highlights_are_to_clip_does(self, capsys, tmp_path, pair):
        with pair.open("a") as file:
            file.write("\n[presentation]\nclip_highlights = true\n")
        found = drawn(capsys, tmp_path, "--scene", pair)
        assert (found["match"], found["pair_factor"]) == (None, 1.0)

    def test_another_sample_in_a_pair_is_matched(self, capsys, tmp_path, pair):
        found = drawn(capsys, tmp_path, "--scene", pair, "--sample", "uncoated")
        wanted = matched_point(Reference.default(), load_sample("uncoated"), 2.0).c
        assert found["match"]["c"] == pytest.approx(wanted)

    def test_a_pairs_own_share_is_kept(self, capsys, tmp_path, pair):
        text = pair.read_text()
        c = drawn(capsys, tmp_path, "--scene", pair)["match"]["c"]
        pair.write_text(text.replace(f"c = {c!r}", f"c = {0.5 * c!r}", 1))
        found = drawn(capsys, tmp_path, "--scene", pair)
        assert found["match"]["share"] == pytest.approx(0.5)
        assert found["c"] == pytest.approx(0.5 * found["match"]["factor"] * c)


def test_the_command_in_a_picture_draws_it_again(capsys, tmp_path):
    import shlex

    first = tmp_path / "a.png"
    assert run(capsys, "snapshot", "--sample", "art-coated", *SIZE, *ASIDE, "-o", first)[0] == 0
    with Image.open(first) as picture:
        command, pixels = picture.info["Command"], np.asarray(picture)
    assert run(capsys, *shlex.split(command)[1:])[0] == 0
    with Image.open(first) as again:
        np.testing.assert_array_equal(np.asarray(again), pixels)


class TestFoundByOthers:
    """What someone else met first."""

    def test_graininess_of_a_pair_keeps_its_share(self, capsys, tmp_path):
        file = tmp_path / "pair.toml"
        assert run(capsys, "match", "art-coated", "--write", file)[0] == 0
        found = drawn(capsys, tmp_path, "--scene", file, "--sigma-n", 2)
        wanted = matched_point(Reference.default(), load_sample("art-coated"), 2.0).c
        assert found["c"] == pytest.approx(wanted)
        assert found["match"]["share"] == pytest.approx(1.0)

    def test_a_reference_that_is_not_used_is_refused(self, capsys, tmp_path):
        words = ("--c", 0.3, "--reference", "art-coated", "-o", tmp_path / "a.png")
        assert "nothing is matched" in refused(capsys, tmp_path, "snapshot", *words)

    def test_a_sample_without_lobes_is_named(self, capsys, tmp_path):
        flat = dataclasses.replace(paper("matte"), specular=())
        save_material(flat, tmp_path / "flat.json")
        words = ("snapshot", "--material", tmp_path / "flat.json", *SIZE, "-o", tmp_path / "a.png")
        assert "no gloss to match" in run(capsys, *words)[1]
        words = (*SIZE, "--reference", tmp_path / "flat.json", "-o", tmp_path / "b.png")
        status, _, err = run(capsys, "snapshot", *words)
        assert status == 1
        assert "has no specular lobe" in err

    def test_a_highlight_between_two_pixels_is_no_missing_highlight(self, capsys, tmp_path):
        base = load_sample("art-coated")
        lobe = dataclasses.replace(base.specular[0], s_deg=0.05)
        save_material(dataclasses.replace(base, specular=(lobe,), fit=None), tmp_path / "s.json")
        found = drawn(capsys, tmp_path, "--material", tmp_path / "s.json", "--size", "128x128")
        assert any("narrower" in text for text in found["warnings"])
        assert not any("no gloss is visible" in text for text in found["warnings"])

    def test_an_operator_without_c_shows_the_same_surface(self, capsys, tmp_path):
        found = drawn(capsys, tmp_path, "--sample", "uncoated", "--operator", "clip")
        assert (found["sigma_n_deg"], found["match"]) == (2.0, None)
