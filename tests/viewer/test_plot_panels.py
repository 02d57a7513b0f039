"""The panels with plots, run for real in a window without a display, and looked at."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import plot_window
import pytest
from plot_window import PANELS, STRIP

from relgloss_view.base.resources import asset
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.viewer.panels import plot_widgets, polar
from relgloss_view.viewer.panels.fit import facts

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
    case("pixel nowhere", ["pixel"], "built-in", pointer=None),
    case("pixel pinned", ["pixel"], "built-in", pinned=("test", 20, 60)),
    case("pixel large", ["pixel"], "built-in", size=(1000, 560)),
    case("polar", ["reflection"], "measured", reflection={"polar": True}),
    case("linear", ["reflection"], "measured", reflection={"logarithmic": False}),
    case("no table", ["reflection"], "measured", table=False),
    *(case(f"{panel} dragged", [panel], "dragged", dragging=True) for panel in PANELS),
    case("gone", ["lightness"], "gone"),
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


@pytest.mark.parametrize("panel", ["lightness", "pixel"])
def test_without_pictures_there_is_next_to_nothing(found, panel):
    """Negative control of everything below: what is counted as drawn is not there by itself."""
    empty, full = found[f"{panel} no frames"], found[f"{panel} built-in"]
    assert 5.0 * ink(empty) < ink(full)
    assert (empty["items"], full["items"]) == (0, {"lightness": 7, "pixel": 0}[panel])


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
    """Curves have a trace of hue, the pixel's green print has all of it."""

    def chroma(entry):
        return np.ptp(entry["picture"].astype(int), axis=-1)

    for panel in ("lightness", "reflection"):
        assert np.max(chroma(found[f"{panel} built-in"])) < 70
    assert np.max(chroma(found["fit built-in"])) <= 1
    assert np.mean(chroma(found["pixel built-in"]) > 30) > 0.05


def test_the_pixel_follows_the_mouse_and_a_pin(found):
    pointed, pinned = found["pixel built-in"], found["pixel pinned"]
    assert differ(pointed, pinned) > 0.01
    assert ink(found["pixel nowhere"]) < 0.5 * ink(pointed)
    # Large cells carry their L*: more than two inks in a cell's middle.
    assert found["pixel large"]["vertices"] > found["pixel built-in"]["vertices"] + 500


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


def test_a_drag_fetches_nothing_and_still_scales(found):
    """Nothing can be fetched from the frames of the drag; c shows all the same."""
    for panel in ("lightness", "pixel"):
        assert found[f"{panel} dragged"]["plots"] == found[f"{panel} built-in"]["plots"]
    assert found["lightness dragged"]["items"] == 7
    assert differ(found["lightness dragged"], found["lightness built-in"]) > 0.005
    # The pixel's numbers hang on c itself: they are the old ones, and it says so.
    waits = differ(found["pixel dragged"], found["pixel built-in"])
    assert 0.001 < waits < 0.02


def test_what_can_no_longer_be_fetched_is_told(found):
    assert found["gone"]["plots"] == 0
    assert ink(found["gone"]) > 0.005


@pytest.mark.parametrize(
    ("peak", "top"), [(0.9, 1.0), (1.0, 2.0), (1.9, 2.0), (2.1, 5.0), (4.9, 10.0), (0.031, 0.05)]
)
def test_ends_of_scales_are_round(peak, top):
    assert plot_widgets.nice_ceiling(peak) == pytest.approx(top)
    assert plot_widgets.nice_ceiling(1e3 * peak) == pytest.approx(1e3 * top)


def test_polar_distance_counts_decades():
    scale = polar.RadialScale(100.0, 0.001)
    radius = scale.radius(np.array([1e-9, 0.001, 0.1, 100.0]))
    np.testing.assert_allclose(radius, [0.0, 0.0, 0.4, 1.0], atol=1e-12)
    np.testing.assert_allclose(polar.RadialScale(4.0).radius(np.array([1.0, 4.0])), [0.25, 1.0])
    assert all(0.0 < r <= 100.0 for r in scale.rings())


def test_facts_are_the_files():
    """The evidence in words holds the numbers of the material's JSON."""
    record = json.loads(asset("materials", "matte-coated.json").read_text(encoding="utf-8"))
    fit = record["fit"]
    material = load_sample("matte-coated")
    texts = {fact.title: fact.text for fact in facts(material, material.fit)}
    assert texts["Chosen model"] == fit["chosen"]
    for k in range(2):
        lobe, errors = record["specular"][k], fit["standard_errors"]
        assert (
            f"width (s) {lobe['s_deg']:.3g} deg ± {errors['s_deg'][k]:.2g}"
            in texts[f"Lobe {k + 1}"]
        )
    assert f"median {100 * fit['residuals']['median_relative_error']:.3g} %" in texts["Residuals"]
    assert texts["Samples"].startswith(f"{fit['residuals']['samples']} used, 66 left out")
    assert fit["standard_errors"]["method"] in texts["Errors"]
    assert texts["Quality"].startswith("good")
    assert not {"Gloss 60", "Peak"} & set(texts)  # a kept file of an older fit has neither
    judged = dataclasses.replace(
        material.fit,
        derived={"peak": {"value": 1.46, "standard_error": 0.005}},
        judgement={
            "gloss": [{"angle_deg": 60, "fit": 9.51, "table": 9.46, "table_error": 0.1}],
            "pictures": [],
            "tail": None,
        },
    )
    texts = {fact.title: fact.text for fact in facts(material, judged)}
    assert texts["Gloss 60"] == "fit 9.5, table 9.5 +- 0.1"
    assert "1.46 +- 0.005" in texts["Peak"]
