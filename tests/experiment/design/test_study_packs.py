"""Packs as samples of a study: kept in a session without their artwork, and drawn again."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.experiment.design.stimuli import draw_stimulus
from relgloss_view.experiment.design.study_file import (
    load_study,
    study_digest,
    study_from_dict,
    study_to_dict,
)
from relgloss_view.experiment.design.study_packs import full_c_of_pack

PACK = """
[pack]
form = "cylinder"
artwork = "art.png"
[[finish]]
name = "ink"
material = "matt-varnish"
[[finish]]
name = "spot"
material = "gloss-varnish"
mask = "mask.png"
sigma_n_deg = 0.5
"""
STUDY = """
[[samples]]
pack = "pack.toml"
[[samples]]
name = "uncoated"
[grid]
sigma_n_deg = [0, 2]
c_fraction = [0.5, 1]
[screen]
width_px = 64
height_px = 64
"""


@pytest.fixture
def folder(tmp_path):
    """A study of a pack, whose artwork is orange with a mask over one half."""
    made = tmp_path / "study"
    made.mkdir()
    Image.new("RGB", (32, 16), (200, 120, 40)).save(made / "art.png")
    mask = np.zeros((16, 32), np.uint8)
    mask[:8] = 255
    Image.fromarray(mask).save(made / "mask.png")
    (made / "pack.toml").write_text(PACK)
    (made / "study.toml").write_text(STUDY)
    return made


def kept(study, tmp_path):
    """The study as a session gives it back."""
    return study_from_dict(json.loads(json.dumps(study_to_dict(study))), tmp_path)


def test_a_session_draws_the_same_again(folder, tmp_path, renderer):
    study = load_study(folder / "study.toml")
    ink, spot = study.samples[0].sample.pack.finishes
    assert ink.keeps_k and spot.keeps_k and ink.k == 1.0 != spot.k  # noqa: PT018
    assert (ink.sigma_n_deg, spot.sigma_n_deg) == (None, 0.5)  # the grid's; its own
    again = kept(study, tmp_path)
    again.check_drawn_again()
    pictures = [draw_stimulus(renderer, s, 0, 1).display for s in (study, again)]
    np.testing.assert_array_equal(*pictures)
    assert study_digest(study_to_dict(again)) == study_digest(study_to_dict(study))
    # Negative control: another setting is another picture.
    assert np.any(draw_stimulus(renderer, again, 0, 3).display != pictures[0])


def test_a_changed_pack_is_another_study(folder, tmp_path):
    study = load_study(folder / "study.toml")
    moved = tmp_path / "moved"
    shutil.copytree(folder, moved)
    digest = study_digest(study_to_dict(study))
    assert study_digest(study_to_dict(load_study(moved / "study.toml"))) == digest
    Image.new("L", (32, 16), 255).save(folder / "mask.png")
    assert study_digest(study_to_dict(load_study(folder / "study.toml"))) != digest


def test_without_its_files_a_study_can_be_analysed_but_not_drawn(folder, tmp_path):
    content = json.loads(json.dumps(study_to_dict(load_study(folder / "study.toml"))))
    Image.new("RGB", (32, 16), (10, 120, 40)).save(folder / "art.png")
    changed = study_from_dict(content, tmp_path)
    assert changed.samples[0].label == "pack"
    with pytest.raises(InputError, match="another than when the study began"):
        changed.scene(0)
    assert changed.scene(1).pack is None
    shutil.rmtree(folder)
    with pytest.raises(InputError, match=r"sample 'pack'.*(art|mask)\.png"):
        study_from_dict(content, tmp_path).check_drawn_again()


def test_c_max_of_a_pack(folder, renderer):
    """That of a picture; the highlight of the spot is narrower than its pixels."""
    study = load_study(folder / "study.toml")
    pack = study.samples[0].sample.pack
    frame = draw_stimulus(renderer, study, 0, 1)
    full = full_c_of_pack(pack.with_finish("spot", k=0.0), study.setup)
    assert full_c_of_pack(pack, study.setup) <= full
    assert 0.3 < full_c_of_pack(pack, study.setup) / frame.c_max < 1.5


def test_a_pack_is_no_reference(folder):
    (folder / "study.toml").write_text('[reference]\npack = "pack.toml"\n')
    with pytest.raises(InputError, match="can't be the reference"):
        load_study(folder / "study.toml")
