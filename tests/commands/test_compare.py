"""`relgloss compare` as its users meet it."""

from __future__ import annotations

import base64
import io
import json
import re
import shlex
from html.parser import HTMLParser

import numpy as np
import pytest
from materials import paper
from PIL import Image
from test_cli import refused, run

from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile, srgb_profile
from relgloss_view.gloss.match import Reference, matched_point
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.material.files import save_material
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample

SMALL = ("--size", "64x64")


def published(name):
    return SampleLook(name, load_sample(name), Look().at(SAMPLES[name]))


def sheet_pixels(path):
    with Image.open(path) as picture:
        return np.asarray(picture), dict(picture.info)


class Page(HTMLParser):
    """What a page shows, with every element closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.words, self.images = [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        if tag == "img":
            self.images.append(dict(attributes))
        elif tag != "meta":
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.mark.slow
def test_papers_by_default(capsys, tmp_path):
    png, page = tmp_path / "a.png", tmp_path / "a.html"
    # Large enough that the narrow highlight of cast-coated is not lost between pixels.
    large = ("--size", "256x256")
    status, out, err = run(capsys, "compare", *large, "-o", png, "-o", page)
    assert status == 0
    for words in ("cast-coated", "uncoated", "split", "clip", "multiscale", "order kept", "drifts"):
        assert words in out
    assert "all samples: matched to cast-coated" in out
    assert "c = 1.0" not in err
    shown = Page(page.read_text(encoding="utf-8"))
    assert len(shown.images) == 12
    assert all(image["src"].startswith("data:image/png;base64,") for image in shown.images)
    assert not re.search(r"https?://|src=\"[^d]", page.read_text(encoding="utf-8"))
    assert "relgloss compare" in " ".join(shown.words)
    first, info = sheet_pixels(png)
    command = shlex.split(info["Command"])
    assert run(capsys, *command[1:])[0] == 0
    np.testing.assert_array_equal(sheet_pixels(png)[0], first)


def test_materials_settings_and_parameters(capsys, tmp_path):
    mine = tmp_path / "mine=1.json"
    save_material(paper("matte"), mine)
    status, out, _ = run(
        capsys, "compare", "art-coated", f"{mine}=1.5,2/6", mine, *SMALL, "--json",
        "--operators", "split,multiscale:local=0:rods=true,multiscale", "--gloss", "gloss-60",
        "-o", tmp_path / "a.png",
    )  # fmt: skip
    assert status == 0
    found = json.loads(out)
    assert [s["label"] for s in found["samples"]] == ["art-coated", "mine=1", "mine=1 (2)"]
    assert [s["sigma_n_deg"] for s in found["samples"]] == [0.0, 1.5, 0.0]
    assert found["samples"][1]["c"] == pytest.approx(found["samples"][1]["c_max"] / 3)
    wanted = matched_point(Reference.of(published("cast-coated"), "gloss-60"), paper("matte"), 0.0)
    assert found["samples"][2]["c"] == pytest.approx(found["factor"] * wanted.c)
    assert [o["parameters"].get("local") for o in found["operators"]] == [None, 0, 0.5]
    assert found["gloss"] == "gloss-60"
    assert found["samples"][0]["rank"] == 0


def test_a_file_is_matched_and_not_at_c_max(capsys, tmp_path):
    """A matte paper between two glossier ones keeps its place, whatever its own c_max."""
    save_material(paper("uncoated"), tmp_path / "mine.json")
    words = ("cast-coated", "art-coated", tmp_path / "mine.json", "--size", "256x256", "--json")
    out = run(capsys, "compare", *words, "--operators", "split", "-o", tmp_path / "a.png")[1]
    found = json.loads(out)
    assert found["operators"][0]["orders"]["peak_contrast"]["verdict"] == "kept"
    mine = found["samples"][2]
    assert mine["c"] < 0.2 * mine["c_max"]
    # The control: what c = c_max shows, asked for by name.
    words = (*words[:2], f"{words[2]}=0,1", *words[3:])
    out = run(capsys, "compare", *words, "--operators", "split", "-o", tmp_path / "a.png")[1]
    found = json.loads(out)
    assert found["operators"][0]["orders"]["peak_contrast"]["verdict"] != "kept"


def test_one_factor_scales_all_that_are_matched(capsys, tmp_path):
    words = (
        "cast-coated",
        "matte-coated=2,0.5",
        "uncoated",
        *SMALL,
        "--json",
        "--operators",
        "split",
    )
    aside = ("--set", "lamp.azimuth_deg=120", "--size", "256x256")
    found = json.loads(run(capsys, "compare", *words, *aside, "-o", tmp_path / "a.png")[1])
    assert found["factor"] < 1.0
    reference = Reference.default()
    cast, matte, uncoated = (sample["c"] for sample in found["samples"])
    assert cast == pytest.approx(found["factor"] * reference.c)
    wanted = matched_point(reference, load_sample("uncoated"), 2.0).c
    assert uncoated == pytest.approx(found["factor"] * wanted)
    assert matte == pytest.approx(0.5 * found["samples"][1]["c_max"])


def test_the_profile_is_the_displays(capsys, tmp_path):
    other = ("--set", "display.transfer=gain-offset-gamma")
    for words, expected in (
        ((), srgb_profile()),
        (other, matrix_profile(Display(transfer="gain-offset-gamma").for_the_eye())),
    ):
        png, page = tmp_path / "a.png", tmp_path / "a.html"
        common = ("art-coated", *SMALL, "--operators", "clip", "-o", png, "-o", page)
        assert run(capsys, "compare", *common, *words)[0] == 0
        assert sheet_pixels(png)[1]["icc_profile"] == expected
        (image,) = Page(page.read_text(encoding="utf-8")).images
        held = base64.b64decode(image["src"].partition(",")[2])
        with Image.open(io.BytesIO(held)) as picture:
            assert picture.info["icc_profile"] == expected


@pytest.mark.parametrize(
    ("words", "place"),
    [
        (("glass",), "glass"),
        (("absent.json",), "absent.json"),
        (("art-coated=1,1/0",), "expected SAMPLE=SIGMA_N,C"),
        (("art-coated=1.2.3,1",), "expected SAMPLE=SIGMA_N,C"),
        (("art-coated=11,1",), "sigma_n_deg"),
        (("--operators", "split,aces"), "aces"),
        (("--operators", ""), "operator"),
        (("--operators", "clip,clip"), "twice"),
        (("--operators", "multiscale:A=1"), "expected a parameter of local"),
        (("--operators", "clip:cut"), "expected NAME=VALUE"),
        (("--size", "0x9"), "size 0x9"),
        (("-o", "a.jpg"), ".png or .html"),
        (("-o", "gone/a.png"), "gone"),
    ],
    ids=str,
)
def test_refused(capsys, tmp_path, monkeypatch, words, place):
    monkeypatch.chdir(tmp_path)
    assert place in refused(capsys, tmp_path, "compare", *SMALL, "-o", "a.png", *words)


def test_no_output_is_wrong_usage(capsys, tmp_path):
    refused(capsys, tmp_path, "compare", status=2)


def test_a_view_without_highlights_ranks_nothing(capsys, tmp_path):
    words = ("compare", *SMALL, "--operators", "split", "--set", "shape.kind=plane")
    words = (*words, "--lamp", "given", "-o", tmp_path / "a.png")
    found = json.loads(run(capsys, *words, "--json")[1])
    assert found["refused"] == ["cast-coated", "art-coated", "matte-coated", "uncoated"]
    orders = found["operators"][0]["orders"].values()
    assert {order["verdict"] for order in orders} == {"none"}
    err = run(capsys, *words)[2]
    assert "not ranked; turn the lamp" in err
