"""The gloss panel, driven by labels: readings of both sides, and the slider the other way round."""

from __future__ import annotations

import time

import driven
import pytest

from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.material.files import load_material
from relgloss_view.picture.scene.sample import load_sample

GLOSS = "//Gloss"


# --- scripts, run in the window's process ---------------------------------------------------------


def control(hand, label):
    """A control of the panel, by its label; in the column of controls it has one part only."""
    return f"{GLOSS}/gloss/{label}"


def worked_out(hand):
    from relgloss_view.viewer.panels.gloss import _memory

    def there():
        time.sleep(0.01)
        memory, state = _memory.of(hand.model), hand.model.state
        return all(
            hand.app._gloss_readings.of(state.side(side).sample.material) is not None
            and side in memory.last
            for side in ("reference", "test")
        )

    assert hand.until(there)
    hand.frames(2)


def readings_of_both_sides(hand, found):
    from relgloss_view.viewer.panels.gloss import _memory

    hand.app.layout.focus("Gloss")
    hand.frames(4)
    worked_out(hand)
    found["shown"] = {
        side: {r.key: r.value for r in readings}
        for side, readings in _memory.of(hand.model).last.items()
    }


def slider_makes_a_hypothetical(hand, found):
    model = hand.model
    hand.ctx.item_input_value(control(hand, "##Wanted reading"), 25.0)
    hand.frames(2)
    sample = model.state.test.sample
    found["name"], found["source"] = sample.material.name, sample.material.source
    found["reads"] = specular_gloss(sample.material, 60)
    found["in no file"] = sample.file is None
    hand.ctx.item_input_value(control(hand, "##Wanted reading"), 40.0)
    hand.frames(2)
    found["made from the measured one"] = model.state.test.sample.material.name
    hand.app.files.copy_command()
    found["command"] = [model.notes[-1].text, model.notes[-1].fault]
    hand.click(control(hand, "Keep in a file"))
    hand.frames(2)
    found["file"] = model.state.test.sample.file
    worked_out(hand)
    hand.frames(3)
    hand.app.files.copy_command()
    found["command of kept"] = [model.notes[-1].text, model.notes[-1].fault]
    hand.ctx.item_input_value(control(hand, "##Wanted reading"), 105.0)
    hand.frames(2)
    from relgloss_view.viewer.panels.gloss import _memory

    found["out of reach"] = _memory.of(model).refused.fault
    found["still"] = specular_gloss(model.state.test.sample.material, 60)
    model.active_side = "reference"  # what is refused there is no matter here
    hand.frames(2)
    found["other side"] = _memory.of(model).refused is None
    model.active_side = "test"
    hand.frames(2)


def goes_back(hand, found):
    model = hand.model
    hand.click(control(hand, "Go back"))
    hand.frames(2)
    found["name"] = model.state.test.sample.name
    model.history.undo()
    hand.frames(1)
    found["undone"] = model.state.test.sample.material.hypothetical


SCRIPTS = (readings_of_both_sides, slider_makes_a_hypothetical, goes_back)


# --- what they found ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("gloss")
    return driven.drive(__name__, folder, panels=True, size=(1280, 800))


def test_shows_what_the_command_reads(found):
    shown = found["readings_of_both_sides"]["shown"]
    for side, name in (("reference", "cast-coated"), ("test", "matte-coated")):
        for angle in (20, 60, 75, 85):
            real = specular_gloss(load_sample(name), angle)
            assert shown[side][f"gloss-{angle}"] == pytest.approx(real)


def test_the_other_way_round(found):
    told = found["slider_makes_a_hypothetical"]
    assert told["reads"] == pytest.approx(25.0, abs=0.01)
    assert "hypothetical" in told["name"]
    assert "hypothetical" in told["source"]
    assert told["in no file"]
    # It is made from the sample, not from what was made before.
    assert told["made from the measured one"].count("hypothetical") == 1
    assert "40 gloss units" in told["made from the measured one"]


def test_kept_in_a_file_it_can_be_named(found):
    told = found["slider_makes_a_hypothetical"]
    assert told["command"][1]
    assert "in no file" in told["command"][0]
    kept = load_material(told["file"])
    assert kept.hypothetical
    assert kept.fit is None
    assert specular_gloss(kept, 60) == pytest.approx(40.0, abs=0.01)
    assert not told["command of kept"][1]


def test_out_of_reach_says_what_can_be_reached(found):
    told = found["slider_makes_a_hypothetical"]
    assert "no lobe width reads 105" in told["out of reach"]
    assert told["still"] == pytest.approx(40.0, abs=0.01)
    assert told["other side"]


def test_back_to_the_measured_one(found):
    assert found["goes_back"] == {"name": "matte-coated", "undone": True}
