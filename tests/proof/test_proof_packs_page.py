"""Packs and forms of triangles in the page: the pictures that the window draws, pixel by pixel."""

from __future__ import annotations

import base64
import dataclasses
import io

import numpy as np
import pytest
from browsers import before_pages, call, console
from engines import desktop, draw, open_engine, settings_of
from pack_pages import LIT, TORUS, carried, make_pack, pair_of
from PIL import Image

from relgloss_view import Display, Eye, Look, Scene, Shape
from relgloss_view.picture.gpu import surface
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.proof.settings import PictureSetting

SIZE = (96, 96)
#: Relative, of c_max: on another driver a lobe's exp and division differ in float32's last places.
C_MAX = 1e-4
OTHER_DRIVER = 0.9999  #: least share of pixels that another driver draws within 1
GRAIN = Look(1.0, c=2.0, grain="surface")


def apart(browser, renderer, sides, size=SIZE, settings=None, *, same_scaling=True):
    """Largest difference of each pixel's three values, by side; the page is open already.

    same_scaling: whether c_max and the pair's factor must be those of the window.
    """
    settings = settings or settings_of(sides)
    report, pictures = draw(browser, settings, size)
    factor, frames = desktop(renderer, sides, settings, size)
    if same_scaling:
        assert report["factor"] == pytest.approx(factor, rel=C_MAX)
    for side, frame in frames.items():
        if same_scaling and frame["c_max"] is not None:
            assert report[side]["c_max"] == pytest.approx(frame["c_max"], rel=C_MAX)
    console(browser)
    return {
        side: np.abs(pictures[side].astype(int) - frame["display"].astype(int)).max(axis=-1)
        for side, frame in frames.items()
    }


def largest(found):
    return {side: int(one.max()) for side, one in found.items()}


SAME = {"reference": 0, "test": 0}


def turned(settings, rng):
    """Settings with eye, lamp, both sigma_N and both c anywhere."""
    return dataclasses.replace(
        settings,
        reference=PictureSetting(float(rng.uniform(0, 4)), float(rng.uniform(0, 5))),
        test=PictureSetting(float(rng.uniform(0, 4)), float(rng.uniform(0, 5))),
        eye=Eye(
            azimuth_deg=float(rng.uniform(-180, 180)),
            elevation_deg=float(rng.uniform(-60, 60)),
            distance_m=float(rng.uniform(0.25, 1.5)),
            shift_right=float(rng.uniform(-0.02, 0.02)),
            field_of_view_deg=float(rng.uniform(10, 40)),
        ),
        lamp=dataclasses.replace(
            settings.lamp,
            azimuth_deg=float(rng.uniform(-180, 180)),
            elevation_deg=float(rng.uniform(-60, 60)),
            illuminant=str(rng.choice(["HP5", "D65", "A", "FL11"])),
        ),
    )


def test_a_can_from_two_places_and_two_controls(chromium_gl, renderer, tmp_path):
    """Artwork, foil and varnish; then what must not pass: another sigma_N, a texel's shift."""
    more = "sigma_n_deg = 0.5\nk = 1.3"
    finishes = (
        ("foil", "cold-foil-gold", "foil.png"),
        ("varnish", "gloss-varnish", "gloss.png", more),
    )
    sides = pair_of(make_pack(tmp_path, "can", finishes=finishes), GRAIN)
    files = carried(tmp_path)
    open_engine(chromium_gl, sides, files=files)
    settings = settings_of(sides)
    assert largest(apart(chromium_gl, renderer, sides)) == SAME
    other = turned(settings, np.random.default_rng(11))
    assert largest(apart(chromium_gl, renderer, sides, settings=other)) == SAME
    call(chromium_gl, "() => { engine.drawing.sides.test.own_sigma_n_deg[2] = 0.6; }")
    found = apart(chromium_gl, renderer, sides, same_scaling=False)
    assert np.count_nonzero(found["test"]) > 50
    shifted = np.roll(np.array(Image.open(tmp_path / "art.png")), 1, axis=1)
    file = io.BytesIO()
    Image.fromarray(shifted).save(file, "PNG")
    files["art.png"] = {"base64": base64.b64encode(file.getvalue()).decode("ascii")}
    open_engine(chromium_gl, sides, files=files)
    found = apart(chromium_gl, renderer, sides, same_scaling=False)
    assert np.count_nonzero(found["test"]) > 500


def test_a_carton_on_another_driver(chromium_sw, renderer, tmp_path):
    sides = pair_of(make_pack(tmp_path, "carton", mode="RGBA"), GRAIN, **LIT)
    open_engine(chromium_sw, sides, files=carried(tmp_path))
    for found in apart(chromium_sw, renderer, sides).values():
        assert np.mean(found <= 1) >= OTHER_DRIVER


def test_one_paper_on_a_bottle(chromium_gl, renderer):
    """Triangles without finishes, and both sides of one mesh."""
    paper, matte = load_sample("cast-coated"), load_sample("matte-coated")
    sides = {
        side: (Scene(material, shape=Shape("bottle")), Look(0.5, c=1.5))
        for side, material in (("reference", paper), ("test", matte))
    }
    open_engine(chromium_gl, sides)
    assert call(chromium_gl, "() => engine.drawing.sides.test.surface.mesh") == "reference"
    assert largest(apart(chromium_gl, renderer, sides)) == SAME


def test_a_device_that_takes_too_few_targets(chromium_gl, tmp_path):
    before_pages(
        chromium_gl,
        """{ const own = WebGL2RenderingContext.prototype.getParameter;
        WebGL2RenderingContext.prototype.getParameter = function (name) {
          return name === this.MAX_DRAW_BUFFERS ? 4 : own.call(this, name);
        }; }""",
    )
    sides = pair_of(make_pack(tmp_path, "carton"), GRAIN)
    with pytest.raises(AssertionError, match="few targets"):
        open_engine(chromium_gl, sides, files=carried(tmp_path))


CASES = {
    "can": {"form": "can", "more": 'measured = "45-0"\ncolour = "spectral"'},
    "bottle": {"form": "bottle", "more": "placement = { turn_deg = 30.0, scale = 0.7 }"},
    "carton": {"form": "carton", "mode": "RGBA"},
    "pouch": {"form": "pouch", "mode": "P"},
    "cylinder": {"form": "cylinder", "mode": "L"},
    "plane": {"form": "plane", "mode": "LA"},
    "mesh file": {"form": "torus.obj"},
}


def drawn_on(browser, renderer, sides, folder, states):
    """The settings themselves, and others, one after the other; both pictures of each."""
    open_engine(browser, sides, files=carried(folder))
    rng = np.random.default_rng(7)
    first = settings_of(sides)
    asked = [((512, 512), first)] + [((128, 128), turned(first, rng)) for _ in range(states)]
    found = []
    for size, settings in asked:
        found += apart(browser, renderer, sides, size, settings).values()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("lit", ["one lamp", "two lamps and ambient light"])
@pytest.mark.parametrize("name", CASES)
def test_packs_on_the_same_driver(chromium_gl, renderer, tmp_path, name, lit):
    (tmp_path / "torus.obj").write_text(TORUS)
    pack = make_pack(tmp_path, **CASES[name])
    edges = "smooth" if lit == "one lamp" else "sampled"
    setup = {**(LIT if edges == "sampled" else {}), "display": Display(edges=edges)}
    sides = pair_of(pack, GRAIN, **setup)
    assert max(one.max() for one in drawn_on(chromium_gl, renderer, sides, tmp_path, 5)) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_packs_on_another_driver(chromium_sw, renderer, tmp_path, name):
    (tmp_path / "torus.obj").write_text(TORUS)
    pack = make_pack(tmp_path, **CASES[name])
    sides = pair_of(pack, GRAIN, **LIT)
    found = drawn_on(chromium_sw, renderer, sides, tmp_path, 3)
    shown = np.concatenate([one.ravel() for one in found])
    print(name, f"{np.mean(shown == 0):.5%} equal, {np.mean(shown <= 1):.5%} within 1")
    assert np.mean(shown <= 1) >= OTHER_DRIVER


@pytest.mark.slow
def test_tiles_of_a_surface(chromium_gl, renderer, tmp_path, monkeypatch):
    """A picture of more texels than the limit is drawn tile by tile, here as there."""
    monkeypatch.setattr(surface, "MOST_TEXELS", 3000)
    sides = pair_of(make_pack(tmp_path, "can"), GRAIN.with_entries(samples=2))
    open_engine(chromium_gl, sides, files=carried(tmp_path))
    call(chromium_gl, "() => { engine.drawing.sides.test.surface.most_texels = 3000; }")
    assert largest(apart(chromium_gl, renderer, sides)) == SAME


@pytest.mark.slow
def test_a_context_that_was_lost(chromium_gl, renderer, tmp_path):
    sides = pair_of(make_pack(tmp_path, "can"), GRAIN)
    open_engine(chromium_gl, sides, files=carried(tmp_path))
    assert largest(apart(chromium_gl, renderer, sides)) == SAME
    call(
        chromium_gl,
        """async () => {
          const more = engine.device.gl.getExtension("WEBGL_lose_context");
          const back = new Promise((resolve) => { engine.onRestored = resolve; });
          more.loseContext();
          await new Promise((resolve) => setTimeout(resolve, 100));
          more.restoreContext();
          await back;
        }""",
    )
    assert largest(apart(chromium_gl, renderer, sides)) == SAME
