"""The page as it is heard: the tree that Chromium hands to screen readers."""

from __future__ import annotations

import itertools
import re

import pytest
from browsers import call, console, emulate, open_page
from page_samples import sample_page
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

CONTROLS = {"button", "slider", "spinbutton", "textbox", "combobox", "radio", "image",
            "DisclosureTriangle"}  #: roles of what can be used  # fmt: skip
FOCUSED = """() => { const e = document.activeElement;
  return e === document.body ? null : Number(e.dataset.place); }"""


@pytest.fixture(scope="module")
def page_file(tmp_path_factory):
    return sample_page(tmp_path_factory.mktemp("heard") / "proof.html")


@pytest.fixture
def page(chromium_gl, page_file):
    emulate(chromium_gl, 1280, 800)
    if chromium_gl.address != page_file.resolve().as_uri():
        open_page(chromium_gl, page_file)
    call(chromium_gl, "() => relgloss.idle()")
    yield chromium_gl
    assert console(chromium_gl) == []


def heard(browser):
    """What is not hidden from screen readers, in reading order: (role, name, node)."""
    nodes = browser.cdp("Accessibility.getFullAXTree")["nodes"]
    by_id = {node["nodeId"]: node for node in nodes}
    found = []

    def walk(node):
        if not node.get("ignored"):
            found.append((node["role"]["value"], node.get("name", {}).get("value", ""), node))
        for child in node.get("childIds", ()):
            if child in by_id:
                walk(by_id[child])

    walk(nodes[0])
    return found


def property_of(node, name):
    values = {entry["name"]: entry["value"].get("value") for entry in node.get("properties", ())}
    return values.get(name)


def attribute(browser, node, name):
    """An attribute of a node's element."""
    answer = browser.cdp("DOM.resolveNode", backendNodeId=node["backendDOMNodeId"])
    return browser.cdp(
        "Runtime.callFunctionOn",
        objectId=answer["object"]["objectId"],
        functionDeclaration="function (name) { return this.getAttribute(name); }",
        arguments=[{"value": name}],
        returnByValue=True,
    )["result"].get("value")


def test_controls_say_what_they_are(page):
    """Each has a name; what holds a value has one, and groups say whose it is."""
    tree = heard(page)
    controls = [entry for entry in tree if entry[0] in CONTROLS]
    assert len(controls) > 40
    assert [entry for entry in controls if not entry[1].strip()] == []
    groups = [name for role, name, _ in tree if role == "group" and name]
    for name in ("The design", "Reference sample", "Black", "White", "Grays", "Light"):
        assert name in groups
    for role, name, node in controls:
        if role in ("slider", "combobox"):
            assert str(node["value"]["value"]) != "", name
        if role == "radio":
            assert property_of(node, "checked") in ("true", "false"), name
    pressed = [property_of(node, "pressed") for role, _, node in controls if role == "button"]
    assert {"true", "false"} <= set(pressed)
    call(page, "() => document.getElementById('life-size').setAttribute('aria-label', ' ')")
    call(page, "() => { document.getElementById('life-size').textContent = ''; }")
    silent = [name for role, name, _ in heard(page) if role in CONTROLS and not name.strip()]
    assert len(silent) == 1  # the negative control
    page.address = ""  # it is opened again


def test_sliders_say_their_value_with_its_unit(page):
    call(
        page, "() => { document.querySelector('[data-key=wipe]').click(); return relgloss.idle(); }"
    )
    units = {"Graininess": r"\d\.\d\d °", "Contrast": r"\d\.\d\d", "Share": r"\d+ %",
             "Brightness": r"\d+ of 255"}  # fmt: skip
    said = {}
    for role, name, node in heard(page):
        if role == "slider":
            text = attribute(page, node, "aria-valuetext")
            said.setdefault(name.split()[0], []).append(text)
            assert re.fullmatch(units[name.split()[0]], text), (name, text)
    assert set(said) == set(units)
    before = said["Graininess"][0]
    call(page, "() => document.getElementById('test-grain').focus()")
    ActionChains(page.driver).send_keys(Keys.ARROW_RIGHT * 20).perform()
    call(page, "() => relgloss.idle()")
    text = call(page, "() => document.getElementById('test-grain').ariaValueText")
    assert text != before
    page.address = ""


def test_headings_landmarks_and_live_regions(page):
    tree = heard(page)
    levels = [property_of(node, "level") for role, _, node in tree if role == "heading"]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in itertools.pairwise(levels))
    roles = [role for role, _, _ in tree]
    assert (roles.count("main"), roles.count("banner")) == (1, 1)
    assert roles.index("banner") < roles.index("main")
    live = [node for role, _, node in tree if role in ("status", "alert")]
    assert len(live) >= 4
    assert {property_of(node, "live") for node in live} <= {"polite", "assertive"}


def test_a_rest_does_not_read_all_out_again(page):
    """A slider that rests changes no live region whose words stay as they are."""
    count = """async (change) => {
      let changes = 0;
      const seen = new MutationObserver((list) => { changes += list.length; });
      const order = [...document.querySelectorAll("#screen [role=status]")].at(-1);
      seen.observe(order, {childList: true, subtree: true, characterData: true});
      const now = relgloss.settings();
      relgloss.set({...now, eye: {...now.eye, azimuth_deg: now.eye.azimuth_deg + 0.25}});
      await relgloss.idle();
      if (change) relgloss.set({...now, test: {...now.test, c: 0}});
      await relgloss.idle();
      return changes + seen.takeRecords().length;
    }"""
    assert call(page, count, False) == 0
    assert call(page, count, True) > 0  # the control: without any highlight the order is another
    page.address = ""


def test_the_picture_is_described_as_it_is(page):
    def name():
        return next(name for role, name, _ in heard(page) if role == "image")

    node = next(node for role, _, node in heard(page) if role == "image")
    assert "arrow keys" in node["description"]["value"]
    before = name()
    for change, words in (
        ({"eye": {"azimuth_deg": 41.0}}, "direction 41°"),
        ({"lamp": {"azimuth_deg": -17.0}}, "direction -17°"),
        ({"lamp": {"illuminant": "D50"}}, "D50"),
        ({"test": {"sigma_n_deg": 1.37}}, "1.37°"),
    ):
        assert words not in before
        call(
            page,
            """(change) => {
              const now = relgloss.settings();
              const [[name, part]] = Object.entries(change);
              relgloss.set({...now, [name]: {...now[name], ...part}});
              return relgloss.idle();
            }""",
            change,
        )
        assert words in name()
    page.address = ""


def test_focus_goes_in_reading_order(page):
    """Where Tab goes next is what is read next."""
    order = []
    for role, _, node in heard(page):
        if role in CONTROLS:
            order.append(node["backendDOMNodeId"])
    for place, node in enumerate(order):
        answer = page.cdp("DOM.resolveNode", backendNodeId=node)
        page.cdp(
            "Runtime.callFunctionOn",
            objectId=answer["object"]["objectId"],
            functionDeclaration="function (place) { this.dataset.place = place; }",
            arguments=[{"value": place}],
        )
    call(page, "() => document.activeElement.blur()")
    reached = []
    for _ in order:
        ActionChains(page.driver).send_keys(Keys.TAB).perform()
        place = call(page, FOCUSED)
        if place is None or place in reached:
            break
        reached.append(place)
    assert len(reached) > 25
    assert reached == sorted(reached)
