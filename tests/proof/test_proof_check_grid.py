"""Same picture? The page draws the check grid, and finds what is changed."""

from __future__ import annotations

import copy
import dataclasses

import numpy as np
import pytest
from browsers import call, call_array
from screen_pages import open_screen, shaders_for

from relgloss_view.display.display import Display
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof.content import content_of
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.quality.backends import open_renderer

SIZE = (200, 160)
#: dE2000 of the same picture by any driver here. The grid keeps four digits, 0.0001 in all. A
#: driver's exp, of an exponent up to 10, may be off by 23 units in the last place (GLSL 4.6,
#: 4.7.1), 3e-6 of L_s* and so 3e-4; log and sqrt of the grain's tilts add as much. Found: 0.0002.
SAME = 0.001
TOLERANCE = 0.005  #: of check.js


def proof_of(reference="cast-coated", test="uncoated", sigma_n_deg=2.0, fraction=0.5):
    look = viewed_look()
    c = {"cast-coated": 0.1406, "art-coated": 0.4488, "matte-coated": 1.28, "uncoated": 6.11}
    scene = SceneFile(
        Sample.built_in(test),
        look.at(Setting(sigma_n_deg, c=fraction * c[test])),
        Setup(display=Display().for_the_eye()),
        Sample.built_in(reference),
        look.at(Setting(0.0, c=fraction * c[reference])),
    )
    with open_renderer() as renderer:
        made = content_of(scene, renderer, size=SIZE)
    return Proof(made.content, (Message(made.settings, program="unchanged"),))


@pytest.fixture(scope="module")
def proof():
    return proof_of()


def checked(browser):
    return call(browser, "() => checkGrid(engine, data.proof)")


def open_once(browser, proof):
    """The page of the proof, which may be open still."""
    there = call(browser, "() => globalThis.data?.proof?.messages?.[0]?.program ?? ''")
    if there != "unchanged":
        open_screen(browser, proof)


def spoken(browser):
    return call(
        browser,
        "() => say(...checkWords(checkGrid(engine, data.proof), data.proof.content.size_px))",
    )


@pytest.mark.parametrize("lane", ["chromium_gl", "chromium_sw"])
def test_same_picture(lane, request, proof):
    browser = request.getfixturevalue(lane)
    open_once(browser, proof)
    found = checked(browser)
    assert found["same"]
    assert found["missed"] == 0
    kept = sum(
        lab is not None for side in proof.content["grid"]["sides"].values() for lab in side["lab"]
    )
    assert kept - 4 <= found["points"] <= kept  # a silhouette may fall to either side
    assert found["largest"] <= SAME
    assert "what the designer saw" in spoken(browser)
    assert call(browser, "() => engine.device.errors()") == []


def changed_c(settings):
    """c of the design off by 1 %."""
    settings["test"]["c"] *= 1.01


def changed_grain(settings):
    """sigma_N of the design off by 1 %."""
    settings["test"]["sigma_n_deg"] *= 1.01


def changed_outline(settings):
    """An object seen from above."""
    settings["eye"]["elevation_deg"] += 10.0


@pytest.mark.parametrize("change", [changed_c, changed_grain, changed_outline])
def test_other_settings_are_found(chromium_gl, proof, change):
    settings = copy.deepcopy(proof.messages[0].settings.as_json())
    change(settings)
    open_once(chromium_gl, proof)
    with_settings = """(settings) => {
      const proof = structuredClone(data.proof);
      proof.messages[0].settings = settings;
      const found = checkGrid(engine, proof);
      return [found, say(...checkWords(found, proof.content.size_px))];
    }"""
    found, words = call(chromium_gl, with_settings, settings)
    assert not found["same"]
    assert found["largest"] > TOLERANCE or found["missed"] > 0
    assert "than the designer saw" in words


def changed_seed(proof):
    """Other grains."""
    content = copy.deepcopy(dict(proof.content))
    stack, seeds = [content["drawing"]], 0
    while stack:
        part = stack.pop()
        for key, value in list(part.items() if isinstance(part, dict) else enumerate(part)):
            if key == "seed":
                part[key] = value + 1
                seeds += 1
            elif isinstance(value, dict | list):
                stack.append(value)
    assert seeds
    changed = dataclasses.replace(proof.messages[0], program="")
    return Proof(content, (changed,)), shaders_for(proof)


def changed_constant(proof):
    """One constant of a shader: CIELAB's 116, off by a thousandth."""
    shaders = shaders_for(proof)
    name = next(n for n in ("tone.glsl", "split.frag") if "116.0" in shaders[n])
    shaders[name] = shaders[name].replace("116.0", "116.116")
    changed = dataclasses.replace(proof.messages[0], program="")
    return Proof(proof.content, (changed,)), shaders


@pytest.mark.parametrize("change", [changed_seed, changed_constant])
def test_another_drawing_is_found(chromium_gl, proof, change):
    open_screen(chromium_gl, *change(proof))
    found = checked(chromium_gl)
    assert not found["same"]
    assert found["largest"] > TOLERANCE
    assert "than the designer saw" in spoken(chromium_gl)


def test_nothing_shown_is_disturbed(chromium_gl, proof):
    open_once(chromium_gl, proof)
    settings = proof.messages[0].settings
    own = dataclasses.replace(settings, test=dataclasses.replace(settings.test, sigma_n_deg=0.0))
    draw = "(s) => { engine.draw(s, [90, 70]); return engine.pixels('test').data; }"
    before = call_array(chromium_gl, draw, own.as_json())
    checked(chromium_gl)
    after = call_array(chromium_gl, "() => engine.pixels('test').data")
    assert np.array_equal(before, after)
    assert before.size == 90 * 70 * 4
    assert np.ptp(before) > 50


def test_the_section_says_it(chromium_gl, proof):
    open_once(chromium_gl, proof)
    words = """async (spoil) => {
      const element = document.getElementById("check");
      element.replaceChildren();
      const proof = structuredClone(data.proof);
      if (spoil) proof.messages[0].settings.test.c *= 0.9;
      const app = { engine, proof, announce(text) { window.announced = text; } };
      await mountCheck(element, app);
      return [element.dataset.same, element.querySelector("#check-answer").textContent,
        element.querySelector("#check-advice").hidden, window.announced ?? ""];
    }"""
    same, answer, hidden, announced = call(chromium_gl, words, False)
    assert (same, hidden, announced) == ("true", True, "")
    assert "what the designer saw" in answer
    same, answer, hidden, announced = call(chromium_gl, words, True)
    assert (same, hidden, announced) == ("false", False, answer)
    assert "the picture of the design" in answer
    assert "dE2000" in answer


def test_no_number_is_a_difference(chromium_gl, proof):
    shaders = shaders_for(proof)
    body = shaders["difference.glsl"]
    end = body.rindex("return sqrt(")
    shaders["difference.glsl"] = body[:end] + "return log(-first.x - 1.0);\n}\n"
    changed = dataclasses.replace(proof.messages[0], program="")
    open_screen(chromium_gl, Proof(proof.content, (changed,)), shaders)
    assert not call(chromium_gl, "() => checkGrid(engine, data.proof).same")
