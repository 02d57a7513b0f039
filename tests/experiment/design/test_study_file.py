"""Study files: what they may say, what is said where they are wrong, and studies kept whole."""

from __future__ import annotations

import copy
import json
import tomllib
from pathlib import Path

import pytest
import tomli_w

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.experiment.design.study import CATEGORIES
from relgloss_view.experiment.design.study_file import (
    built_in_file,
    load_study,
    study_digest,
    study_from_dict,
    study_to_dict,
)
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample


def written(folder, text, name="study.toml"):
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def test_the_papers_study():
    """Ishii et al., "Subjective Evaluation": reference at sigma_N 0 and c_max, 42 stimuli each."""
    study = load_study("paper")
    assert [s.label for s in study.samples] == ["art-coated", "matte-coated", "uncoated"]
    assert study.reference.name == "cast-coated"
    assert (study.reference_look.sigma_n_deg, study.reference_look.c_fraction) == (0.0, 1.0)
    assert len(study.grid) == 42
    assert study.categories == CATEGORIES
    assert study.procedure.adaptation_min == 10.0


def test_an_empty_file_is_the_papers_study(tmp_path):
    empty = load_study(written(tmp_path, ""))
    paper = load_study("paper")
    assert (empty.samples, empty.grid, empty.reference) == (
        paper.samples,
        paper.grid,
        paper.reference,
    )
    assert empty.procedure == paper.procedure


def test_everything_that_may_be_said(tmp_path):
    save_material(load_sample("art-coated"), tmp_path / "mine.json")
    (tmp_path / "lamp.csv").write_bytes(asset("spectra", "D65.csv").read_bytes())
    file = written(
        tmp_path,
        """
        [study]
        title = "Ours"
        categories = ["yes", "no"]
        consent = ""
        [reference]
        name = "art-coated"
        look = { sigma_n_deg = 0.5, c_fraction = 0.9 }
        [[samples]]
        material = "mine.json"
        label = "ours"
        [[samples]]
        name = "uncoated"
        [grid]
        sigma_n_deg = [0, 1.5]
        c_fraction = ["1/6", 0.5]
        [procedure]
        design = "adaptive"
        ask_grain = true
        repeats = 2
        [adaptive]
        trials = 5
        [screen]
        width_px = 64
        height_px = 32
        mirror = true
        [lamp]
        illuminant = "lamp.csv"
        azimuth_deg = 80
        [look]
        grain = "surface"
        seed = 7
        """,
    )
    study = load_study(file)
    assert [s.label for s in study.samples] == ["ours", "uncoated"]
    assert study.test_look(study.grid.settings[-1]) == Look(
        sigma_n_deg=1.5, c_fraction=0.5, grain="surface", seed=7
    )
    assert study.questions == ("ratio", "grain")
    assert study.scene(0).lamp.azimuth_deg == 80.0
    assert study.screen.size == (64, 32)
    # Kept whole: it comes back without the files that it was made from.
    content = json.loads(json.dumps(study_to_dict(study)))
    (tmp_path / "mine.json").unlink()
    (tmp_path / "lamp.csv").unlink()
    (tmp_path / "elsewhere").mkdir()
    again = study_from_dict(content, tmp_path / "elsewhere")
    assert study_digest(study_to_dict(again)) == study_digest(content)
    assert again.samples[0].sample.material == study.samples[0].sample.material
    with open(again.setup.lamp.illuminant, encoding="utf-8") as lamp:
        assert lamp.read() == asset("spectra", "D65.csv").read_text(encoding="utf-8")


def test_the_guide_names_the_studys_own_categories():
    paper = load_study("paper")
    assert "keys 1 (close) to 5 (far)" in paper.guide
    assert "grain" not in paper.guide
    other = load_study(
        "paper", {"study": {"categories": ["yes", "no"]}, "procedure": {"ask_grain": True}}
    )
    assert "keys 1 (yes) to 2 (no)" in other.guide
    assert "grain" in other.guide
    assert load_study("paper", {"study": {"instructions": "Look."}}).guide == "Look."


def test_digest_tells_studies_apart():
    contents = [
        study_to_dict(load_study("paper", changes))
        for changes in (
            {},
            {"procedure": {"seed": 1}},
            {"grid": {"sigma_n_deg": [0.0, 1.0]}},
            {"lamp": {"azimuth_deg": 51}},
            {"reference": {"name": "art-coated"}},
        )
    ]
    assert len({study_digest(content) for content in contents}) == 5
    assert study_digest(contents[0]) == study_digest(study_to_dict(load_study("paper")))


def test_template_has_no_entry_that_is_not_read(tmp_path):
    """Each entry of the template counts: with a table in its place it is refused by name."""
    template = tomllib.loads(built_in_file("paper").read_text(encoding="utf-8"))
    checked = 0
    for table in ("study", "grid", "procedure", "screen"):
        for entry in template[table]:
            changed = copy.deepcopy(template)
            changed[table][entry] = {"nonsense": 1}
            with pytest.raises(InputError, match=entry):
                load_study(written(tmp_path, tomli_w.dumps(changed)))
            checked += 1
    assert checked >= 12


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[stdy]\n", r"\[stdy\]: no such table"),
        ("[study]\ntitel = 'x'\n", "study.titel: no such entry"),
        ("[study]\ncategories = ['a']\n", "categories: expected 2 to 9 names"),
        ("[study]\ncategories = 'close'\n", "study.categories: expected a list"),
        ("[study]\ncategories = ['a', 'a']\n", "is there twice"),
        ("[study]\ntitle = ''\n", "title: expected a text"),
        ("[study]\ntitle = 5\n", "title: expected a text"),
        ("[[samples]]\nname = 'glossy'\n", "sample 'glossy': expected one of"),
        ("[[samples]]\nlabel = 'x'\n", r"samples\[0\]: expected a name, a material or a pack"),
        ("[[samples]]\nmaterial = 'gone.json'\n", "gone.json: can't be read"),
        ("[[samples]]\nname = 'uncoated'\n[[samples]]\nname = 'uncoated'\n", "another sample's"),
        ("samples = 3\n", r"samples: expected \[\[samples\]\]"),
        ("samples = []\n", "samples: expected at least one sample"),
        ("[reference]\nname = 'cast-coated'\nlook = 3\n", r"\[reference.look\]: expected a table"),
        ("[grid]\nsigma_n_deg = 3\n", "grid.sigma_n_deg: expected a list"),
        ("[grid]\nc_fraction = [2, 1]\n", "ascending"),
        ("[grid]\nc = [1]\n", "grid.c: no such entry"),
        ("[procedure]\nrepeats = 0\n", "procedure.repeats: expected 1 to 20, found 0"),
        ("[procedure]\norder = 'shuffled'\n", "procedure.order: expected one of balanced, random"),
        ("[procedure]\nask_grain = 1\n", "procedure.ask_grain: expected true or false"),
        ("[adaptive]\ntrials = 2.5\n", "adaptive.trials: expected a whole number"),
        ("[screen]\nwidth_px = 1\n", "screen.width_px"),
        ("[look]\nsigma_n_deg = 1\n", r"look.sigma_n_deg: the settings come from \[grid\]"),
        ("[lamp]\nilluminant = 'gone.csv'\n", "gone.csv"),
        ("[study\n", "not TOML"),
    ],
)
def test_one_line_says_what_is_wrong(tmp_path, text, words):
    file = written(tmp_path, text)
    with pytest.raises(InputError, match=words) as caught:
        load_study(file)
    assert str(file) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_name_that_is_no_study(tmp_path):
    with pytest.raises(InputError, match="check the name"):
        load_study(tmp_path / "none.toml")


def test_digest_is_that_of_the_version_before_the_display_had_a_pitch():
    """A session of an earlier version continues; another viewing distance is another study."""
    content = study_to_dict(load_study("paper"))
    earlier = copy.deepcopy(content)
    for name in ("pixel_pitch_mm", "viewing_distance_m"):
        earlier["display"].pop(name)
    for look in (earlier["look"], earlier["reference"]["look"]):
        look.pop("grain_arcmin")
    assert study_digest(earlier) == study_digest(content)
    kept, kept_earlier = (json.loads(json.dumps(study)) for study in (content, earlier))
    assert study_from_dict(kept_earlier, Path()) == study_from_dict(kept, Path())
    farther = copy.deepcopy(content)
    farther["display"]["viewing_distance_m"] = 0.8
    assert study_digest(farther) != study_digest(content)
