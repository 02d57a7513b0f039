"""What a notebook shows for a frame, a material and a measurement."""

from __future__ import annotations

import dataclasses
import io
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from PIL import Image

import relgloss_view as r
from relgloss_view.base.notebook import html_table, span
from relgloss_view.base.resources import asset
from relgloss_view.display.icc_writing import matrix_profile, srgb_profile
from relgloss_view.material.material import FitRecord
from relgloss_view.measure.table import NEGATIVE

HOSTILE = "<script>alert('a')</script> & \"b\" <img src=x onerror=alert(1)>\n\x1b[31m"
TAGS = {"table", "caption", "tr", "th", "td", "p", "ul", "li"}


class Page(HTMLParser):
    """The tags of an HTML text, and the text between them."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.text = set(), ""
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        assert tag in ("th", "td") or not attrs
        self.tags.add(tag)

    def handle_data(self, data):
        self.text += data + " "


@pytest.fixture
def measurement():
    return r.read_measurement(asset("papers", "art-coated.csv"))


@pytest.fixture
def frame(renderer):
    scene = r.Scene(r.load_sample("art-coated"))
    return renderer.render(scene, r.Look(sigma_n_deg=1.0, samples=1), (20, 14))


def test_material_as_a_table():
    material = r.load_sample("uncoated")
    page = Page(material._repr_html_())
    assert page.tags <= TAGS
    lobe = material.specular[0]
    for text in (
        material.name,
        material.source,
        "yes, nothing was measured",
        "fit good",
        "35 bands, 390 to 730 nm",
        f"{material.diffuse.sigma_deg:.4g} deg",
        f"{lobe.s_deg:.4g} deg",
        f"{lobe.strength[0]:.4g}",
    ):
        assert text in page.text
    assert "Warnings" not in page.text
    measured = r.Material("a", "an instrument", material.bands, material.diffuse)
    assert "nothing was measured" not in measured._repr_html_()
    assert "not fitted" in measured._repr_html_()


def test_material_shows_its_warnings():
    fit = FitRecord(quality="poor", warnings=("poor: no model describes <b>it</b>",))
    page = Page(dataclasses.replace(r.load_sample("uncoated"), fit=fit)._repr_html_())
    assert "poor: no model describes <b>it</b>" in page.text
    assert page.tags == TAGS


def test_measurement_as_a_table(measurement):
    reasons = measurement.reasons.copy()
    used = np.flatnonzero(measurement.kept)
    reasons[used[:3]] = NEGATIVE
    text = Page(dataclasses.replace(measurement, reasons=reasons)._repr_html_()).text
    assert f"{len(used) - 3} of 997" in text
    assert f"left out: {NEGATIVE} 3 " in text
    assert "lamp and receiver within 8 degrees" in text
    assert "15 deg" in text
    assert "0.3 and 0.4 deg" in text


@pytest.mark.parametrize("name", [HOSTILE, "x" * 5000])
def test_names_from_outside_add_no_markup(name, measurement):
    for value in (
        dataclasses.replace(r.load_sample("uncoated"), name=name, source=name),
        dataclasses.replace(measurement, name=name, source=name, file=name, warnings=(name,)),
    ):
        page = Page(value._repr_html_())
        assert page.tags <= TAGS
        assert page.text.count(name[:8]) >= 2
        assert len(page.text) < 3000
        assert "\n" not in repr(value)
        assert "\x1b" not in repr(value) + page.text
        assert len(repr(value)) < 300
    # The control: the same checks see markup that is not escaped.
    assert "script" in Page(f"<table>{HOSTILE.replace('src=x onerror=alert(1)', '')}</table>").tags


def test_texts_name_what_they_are(measurement, frame):
    assert repr(measurement).startswith("<Measurement 'art-coated, green ink': 931 of 997 samples")
    assert repr(frame.scene.material) == (
        "<Material 'art-coated, green ink', synthetic: 35 bands, 390 to 730 nm, oren-nayar and "
        f"{len(frame.scene.material.specular)} lobes, fit good>"
    )
    assert f"20 x 14 pixels, sigma_N 1 deg, c {frame.c:.4g}" in repr(frame)


def test_frame_is_the_picture_of_its_file(frame, tmp_path):
    r.save_frame(frame, tmp_path / "a.png")
    with (
        Image.open(io.BytesIO(frame._repr_png_())) as image,
        Image.open(tmp_path / "a.png") as file,
    ):
        assert image.info["icc_profile"] == file.info["icc_profile"] == srgb_profile()
        np.testing.assert_array_equal(np.asarray(image), np.asarray(file))
    np.testing.assert_array_equal(np.asarray(image), frame.display)


def test_frame_for_another_display_carries_its_profile(renderer):
    wide = r.Display(primaries_xy=((0.68, 0.32), (0.265, 0.69), (0.15, 0.06)))
    scene = r.Scene(r.load_sample("art-coated"), display=wide)
    data = renderer.render(scene, r.Look(), (16, 16))._repr_png_()
    with Image.open(io.BytesIO(data)) as image:
        assert image.info["icc_profile"] == matrix_profile(wide)


def test_frame_of_a_closed_renderer_falls_back_to_text():
    scene = r.Scene(r.load_sample("art-coated"))
    with r.open_renderer() as renderer:
        kept = renderer.render(scene, r.Look(), (8, 8))
        assert kept.display.shape == (8, 8, 3)
        late = renderer.render(scene, r.Look(sigma_n_deg=2.0), (8, 8))
    assert kept._repr_png_() is not None
    with pytest.warns(UserWarning, match="renderer is closed"):
        assert late._repr_png_() is None
    assert repr(late).startswith("<Frame of 'art-coated")


def test_a_notebook_takes_what_it_can_show(measurement, frame):
    formatters = pytest.importorskip("IPython.core.formatters")
    show = formatters.DisplayFormatter().format
    bundle, _ = show(frame)
    assert set(bundle) == {"text/plain", "image/png"}
    assert bundle["image/png"] == frame._repr_png_()
    for value in (measurement, frame.scene.material):
        bundle, _ = show(value)
        assert bundle == {"text/plain": repr(value), "text/html": value._repr_html_()}


def test_tables_need_no_heavy_library():
    code = (
        "import sys, relgloss_view as r; m = r.load_sample('uncoated'); m._repr_html_(); repr(m); "
        "print(*{name.split('.')[0] for name in sys.modules})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = set(done.stdout.split())
    assert "numpy" in loaded
    assert not loaded & {"IPython", "PIL", "matplotlib", "scipy", "colour", "moderngl"}


def test_spans():
    assert span([2.0, np.nan, 14.25]) == "2 to 14.25"
    assert span([0.5], "deg") == "0.5 deg"
    assert span([np.nan, np.inf]) == "none"
    assert html_table("t", [("a", "b")]).count("<tr>") == 1
