"""A material made from readings in the window's model: what is typed, undo, files. No window."""

from __future__ import annotations

import dataclasses
import time

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.fitting.estimate.colour import LabColour
from relgloss_view.fitting.estimate.estimate import estimate
from relgloss_view.material.files import load_material
from relgloss_view.material.recolour import Colour, colour_of
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files.new_material import NewMaterial
from relgloss_view.viewer.state import matching
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.readings_typed import ANGLES_DEG, ReadingsTyped
from relgloss_view.viewer.state.state import State

INITIAL = State.initial()


class Desk:
    """A model and what is made in it, with the frames of a window."""

    def __init__(self, side="test"):
        self.model = Model(INITIAL)
        self.making = NewMaterial(self.model, lambda: None)
        self.making.begin(side)

    def type(self, **texts):
        """Set fields, such as g60="45", and let frames pass until all is computed."""
        gloss = dict(zip(ANGLES_DEG, self.making.typed.gloss, strict=True))
        gloss |= {int(name[1:]): text for name, text in texts.items() if name != "lab"}
        more = {"lab": texts["lab"]} if "lab" in texts else {}
        self.making.typed = dataclasses.replace(
            self.making.typed, gloss=tuple(gloss.values()), **more
        )
        self.settle()

    def settle(self):
        limit = time.monotonic() + 60.0
        self.making.each_frame()
        while self.making.waiting:
            assert time.monotonic() < limit
            time.sleep(0.002)
            self.making.each_frame()

    @property
    def material(self):
        return self.model.state.side(self.making.side).sample.material


@pytest.fixture
def desk():
    return Desk()


def test_the_fields_are_the_estimates_readings():
    typed = ReadingsTyped(("12,3", " 45 ", "", ""))
    readings = typed.readings()
    assert [r.words for r in readings] == ["20=12.3", "60=45"]
    # "45" may be 44.5 to 45.5, "45.0" is nearer
    finer = ReadingsTyped(("", "45.0", "", "")).readings()[0]
    rounding = (1.0**2 - 0.1**2) / 12.0  # variances of uniform errors one step wide
    more = readings[1].standard_error ** 2 - finer.standard_error**2
    assert more == pytest.approx(rounding, rel=1e-6)
    with pytest.raises(InputError, match="gloss at 85 degrees: expected a number"):
        ReadingsTyped(("", "", "4x", "")).readings()
    with pytest.raises(InputError, match="at least one gloss reading"):
        ReadingsTyped().estimate()


def test_nothing_changes_before_the_first_reading(desk):
    desk.settle()
    assert desk.model.state is INITIAL
    assert not desk.making.complete
    lab = colour_of(INITIAL.test.sample.material)
    assert desk.making.typed.lab == pytest.approx(lab, abs=0.051)
    desk.type(g60="x")
    assert desk.model.state is INITIAL
    assert "expected a number" in desk.making.fault


def test_typing_is_one_step_of_undo_and_does_not_depend_on_the_way(desk):
    for text in ("4", "45", "4", "30"):
        desk.type(g60=text)
    assert desk.making.complete
    wanted = estimate({60: 30.0}, LabColour(desk.making.typed.lab))
    assert desk.material.specular[0].s_deg == pytest.approx(
        wanted.material.specular[0].s_deg, rel=0.2
    )
    assert desk.material.marks == "estimated"
    direct = Desk()
    direct.type(g60="30")
    assert direct.model.state == desk.model.state  # c and graininess, too
    history = desk.model.history
    assert history.undo()
    assert history.state == INITIAL
    assert not history.can_undo
    assert history.redo()
    assert history.state == direct.model.state
    # Negative control: a glossier reading is another picture.
    direct.type(g60="80")
    assert direct.model.state != desk.model.state


def test_cancel_brings_the_sample_back_and_leaves_no_step(desk):
    desk.type(g60="45")
    assert desk.material != INITIAL.test.sample.material
    desk.making.cancel()
    assert desk.model.state == INITIAL
    assert not desk.model.history.can_undo
    assert not desk.making.active


def test_cancel_keeps_what_else_was_changed():
    desk = Desk("reference")
    desk.type(g60="45")
    assert desk.model.state.reference.look.c != INITIAL.reference.look.c
    desk.model.set_part("lamp", azimuth_deg=33.0)
    desk.type(g60="50")
    assert desk.model.state.setup.lamp.azimuth_deg == 33.0
    desk.making.cancel()
    state = desk.model.state
    assert state.setup.lamp.azimuth_deg == 33.0
    assert (state.reference, state.test.sample) == (INITIAL.reference, INITIAL.test.sample)
    assert matching.share_of_match(state, "test") == pytest.approx(1.0)


def test_the_other_side_gets_its_sample_back(desk):
    desk.type(g60="45")
    desk.making.put_on("reference")
    assert desk.model.state.test.sample == INITIAL.test.sample
    assert desk.model.state.reference.sample.material.marks == "estimated"


def test_it_goes_with_its_sample_when_sides_are_swapped(desk):
    desk.type(g60="45")
    desk.model.change(matching.swapped(desk.model.state))
    desk.type(g60="50")
    assert desk.making.side == "reference"
    assert desk.material.estimate.readings[0]["value"] == 50.0
    desk.making.cancel()
    assert desk.model.state.reference.sample == INITIAL.test.sample


def test_bad_readings_are_named_and_the_last_good_picture_stays(desk):
    desk.type(g60="45")
    good = desk.model.state
    desk.type(g60="45x")
    assert desk.model.state is good
    assert desk.making.fault.count("\n") == 0
    assert not desk.making.complete
    desk.type(g60="45", lab=(50.0, 120.0, -120.0))
    assert "no reflectance has this colour" in desk.making.fault
    assert desk.model.state is good
    desk.type(lab=(46.0, -50.0, 25.0))
    assert desk.making.fault == ""
    assert colour_of(desk.material) == pytest.approx((46.0, -50.0, 25.0), abs=0.3)
    desk.type(g60="")
    assert not desk.making.complete
    assert desk.material.marks == "estimated"


def test_ghosts_are_the_ends_of_the_interval(desk):
    assert desk.making.ghosts == {}
    desk.type(g60="45")
    ghosts = desk.making.ghosts
    widths = [ghosts[name].specular[0].s_deg for name in ("dullest", "glossiest")]
    assert widths[0] > desk.material.specular[0].s_deg > widths[1]
    desk.model.history.undo()
    assert desk.making.ghosts == {}


def test_keep_writes_a_file_that_a_scene_can_name(desk, tmp_path):
    with pytest.raises(InputError, match="no estimate yet"):
        desk.making.keep(tmp_path)
    desk.making.rename("fine satin")
    desk.type(g20="12.3", g60="45")
    file = desk.making.keep(tmp_path / "materials")
    assert file.name == "fine-satin-1.json"
    assert load_material(file) == desk.model.state.test.sample.material
    assert desk.material.estimate.intervals["s_deg"].lower < desk.material.specular[0].s_deg
    assert desk.model.state.test.sample == Sample.from_file(str(file))  # as a scene opens it
    assert desk.model.history.undo()
    assert desk.model.state == INITIAL


def test_a_spectrum_takes_the_place_of_lab(desk, tmp_path):
    file = tmp_path / "two.csv"
    rows = "\n".join(f"{w},0.2,0.{w // 100}" for w in range(400, 701, 10))
    file.write_text(f"nm,gray,reddish\n{rows}\n", encoding="utf-8")
    desk.type(g60="45")
    desk.making.read_spectrum(str(file))
    desk.settle()
    assert "2 samples" in desk.making.fault
    assert "--" not in desk.making.fault
    assert not desk.making.complete
    desk.making.read_spectrum(str(file), "gray")
    desk.settle()
    assert desk.making.fault == ""
    assert colour_of(desk.material)[1:] == pytest.approx((0.0, 0.0), abs=0.5)
    desk.making.without_spectrum()
    desk.settle()
    assert colour_of(desk.material)[1] < -30.0
    desk.making.read_spectrum(str(tmp_path / "none.csv"))
    desk.settle()
    assert "none.csv" in desk.making.fault


def test_a_recoloured_estimate_keeps_what_is_of_its_lobes():
    made = estimate({20: 50.0, 60: 10.0}, None).material
    assert made.estimate.contradiction
    sample = dataclasses.replace(INITIAL.test.sample, material=made, name=None)
    changed = sample.in_colour(Colour((50.0, 60.0, 20.0)))
    record = changed.material.estimate
    assert changed.material.evidence_words == "estimated, poor"
    assert changed.material.hypothetical
    for name in ("s_deg", "strength", "refractive_index", "second_s_deg", "second_strength"):
        assert record.intervals[name] == made.estimate.intervals[name]
    assert len(record.intervals) == 5  # and none of gloss, peak and diffuse reflectance
    assert record.draws == {}
    assert record.warnings == (record.contradiction,)  # the gray is no longer assumed
    assert len(made.estimate.warnings) == 2
    assert changed.in_colour(None).material == made
