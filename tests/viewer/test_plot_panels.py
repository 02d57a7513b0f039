"""The panels with plots, run for real in a window without a display, and looked at."""

from __future__ import annotations

import numpy as np
import plot_window
import pytest
from plot_window import PANELS, STRIP

MODELS = (
    "no frames",
    "built-in",
    "no fit",
    "no lobes",
    "nothing seen",
    "one pixel",
    "measured",
    "poor fit",
    "odd fit",
)
PIXEL = ("test", 90, 60)


def case(name, panels, model, **more):
    return {"name": name, "panels": panels, "model": model, "pointer": PIXEL, **more}


CASES = [
    *(case(f"{panel} {model}", [panel], model) for panel in PANELS for model in MODELS),
    *(case(f"{panel} twice", [panel], "built-in", font=2.0) for panel in PANELS),
    *(case(f"{panel} tall", [panel], "built-in", size=(380, 640)) for panel in PANELS),
    *(case(f"{panel} tiny", [panel], "built-in", size=(40, 30)) for panel in PANELS),
    case("all", list(PANELS), "built-in", size=(940, 920)),
    case("reference", ["lightness"], "built-in", side="reference"),
    case("inspector nowhere", ["inspector"], "built-in", pointer=None),
    case("inspector pinned", ["inspector"], "built-in", pinned=("test", 20, 60)),
    case("inspector large", ["inspector"], "built-in", size=(1000, 560)),
    case("polar", ["reflection"], "measured", reflection={"polar": True}),
    case("linear", ["reflection"], "measured", reflection={"logarithmic": False}),
    case("no table", ["reflection"], "measured", table=False),
    case("bad lamp", ["reflection"], "built-in", lamp="gone.csv"),
]


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return plot_window.draw(CASES, tmp_path_factory.mktemp("panels"))


def ink(entry):
    """Share of the pixels that differ from the panel's gray: text, curves, controls."""
    picture = entry["picture"].astype(int)
    return float(np.mean(np.max(np.abs(picture - plot_window.PANEL_GRAY), axis=-1) > 12))


def differ(a, b):
    """Share of the pixels in which two pictures differ visibly."""
    return float(np.mean(np.max(np.abs(a["picture"].astype(int) - b["picture"]), axis=-1) > 24))


def test_every_case_is_drawn_as_large_as_its_window(found):
    assert set(found) == {c["name"] for c in CASES}
    for c in CASES:
        width, height = c.get("size", STRIP)
        assert found[c["name"]]["picture"].shape == (height, width, 3), c["name"]


@pytest.mark.parametrize("panel", ["lightness", "inspector"])
def test_without_pictures_there_is_next_to_nothing(found, panel):
    """Negative control of everything below: what is counted as drawn is not there by itself."""
    empty, full = found[f"{panel} no frames"], found[f"{panel} built-in"]
    assert 5.0 * ink(empty) < ink(full)
    assert (empty["items"], full["items"]) == (0, {"lightness": 7, "inspector": 0}[panel])


@pytest.mark.parametrize("model", ["built-in", "no fit", "no lobes", "measured"])
def test_curves_are_there(found, model):
    for panel in ("lightness", "reflection"):
        entry = found[f"{panel} {model}"]
        assert entry["plots"] == 2
        assert ink(entry) > 0.02
    # A lobe has a specular and a diffuse curve of its own, in both plots.
    lobes = 0 if model == "no lobes" else 4  # beside the totals of both sides
    measured = 2 if model == "measured" else 0  # the points, and the curve through the apertures
    assert found[f"reflection {model}"]["items"] == 4 + lobes + measured


def test_what_cannot_be_seen_leaves_its_axes(found):
    """The eye inside the object, and one pixel: the axes stay, the curves are gone."""
    for model in ("nothing seen", "one pixel"):
        assert found[f"lightness {model}"]["plots"] == 2
        assert differ(found[f"lightness {model}"], found["lightness built-in"]) > 0.01


def test_the_fit_shows_its_table_only_where_there_is_one(found):
    assert ink(found["fit built-in"]) > 2.5 * ink(found["fit no fit"])
    assert differ(found["fit poor fit"], found["fit built-in"]) > 0.01
    assert ink(found["fit odd fit"]) > ink(found["fit no fit"])


@pytest.mark.parametrize("panel", PANELS)
def test_nothing_is_cut_off_at_the_side(found, panel):
    for name in ("built-in", "twice", "tall"):
        entry = found[f"{panel} {name}"]
        assert entry["scroll_x"] <= 5.0, name  # the line under tabs reaches into the padding
        assert np.all(entry["picture"][2:-2, -3:] == plot_window.PANEL_GRAY) or entry["scroll_y"]


@pytest.mark.parametrize("panel", PANELS)
def test_the_strip_holds_it_without_scrolling(found, panel):
    assert found[f"{panel} built-in"]["scroll_y"] == 0.0
    if panel in ("lightness", "reflection"):
        assert found[f"{panel} twice"]["scroll_y"] == 0.0


def test_all_panels_share_a_window(found):
    entry = found["all"]
    assert entry["plots"] == 4
    height = STRIP[1]
    for k in range(4):
        part = entry["picture"][k * height : (k + 1) * height]
        assert ink({"picture": part}) > 0.02


def test_the_interface_is_gray_and_the_pixels_are_not(found):
    """Curves have a trace of hue, the inspector's green print has all of it."""

    def chroma(entry):
        return np.ptp(entry["picture"].astype(int), axis=-1)

    for panel in ("lightness", "reflection"):
        assert np.max(chroma(found[f"{panel} built-in"])) < 70
    assert np.max(chroma(found["fit built-in"])) <= 1
    assert np.mean(chroma(found["inspector built-in"]) > 30) > 0.05


def test_the_inspector_follows_the_mouse_and_a_pin(found):
    pointed, pinned = found["inspector built-in"], found["inspector pinned"]
    assert differ(pointed, pinned) > 0.01
    assert ink(found["inspector nowhere"]) < 0.5 * ink(pointed)
    # Large cells carry their L*: more than two inks in a cell's middle.
    assert found["inspector large"]["vertices"] > found["inspector built-in"]["vertices"] + 500


def test_sides_scales_and_tables_show(found):
    assert differ(found["reference"], found["lightness built-in"]) > 0.01
    log = found["reflection measured"]
    for other in ("polar", "linear", "no table"):
        assert differ(found[other], log) > 0.005, other
    assert found["no table"]["items"] == log["items"] - 2


def test_a_lamp_that_has_gone_is_told(found):
    entry = found["bad lamp"]
    assert entry["plots"] == 0
    assert 0.005 < ink(entry) < ink(found["reflection built-in"])
