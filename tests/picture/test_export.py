"""Files against the frame they hold, channel by channel; sheets and thumbnails."""

from __future__ import annotations

import json
import subprocess
import sys

import materials
import numpy as np
import pytest
from pictures import assert_same_pixels
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile
from relgloss_view.display.model import DisplayModel
from relgloss_view.fitting.estimate import report as estimate_report
from relgloss_view.gloss import comparison_sheet
from relgloss_view.operators.registry import make_operator
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.displayed import cut_out
from relgloss_view.picture.model.tone import encode
from relgloss_view.picture.output.contact_sheet import (
    INK_GRAY,
    PAPER_GRAY,
    PLATE_GRAY,
    contact_sheet,
    thumbnail,
)
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.exr import LAYERS
from relgloss_view.picture.output.parameters import parameters
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

OpenEXR = pytest.importorskip("OpenEXR")

SIZE = (60, 44)
OTHER = Display(primaries_xy=((0.68, 0.32), (0.265, 0.69), (0.15, 0.06)), white_xy=(0.3457, 0.3585))


@pytest.fixture
def frame(renderer):
    look = Look(sigma_n_deg=2.0, samples=3, c=0.4, seed=7)
    return renderer.render(Scene(materials.paper("art")), look, SIZE)


def read(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        header = dict(file.header())
        return header, {name: channel.pixels for name, channel in file.channels().items()}


def over(channels, background):
    """The picture (H, W, 3) laid over a gray, as compositors do (Porter and Duff 1984)."""
    rgb = np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float64)
    return rgb + (1.0 - channels["A"][..., None].astype(np.float64)) * background


def digital_over_surround(channels, display):
    model = DisplayModel.of(display)
    return np.floor(255 * encode(over(channels, model.background_light), model) + 0.5)


def test_exr_holds_the_frame(frame, tmp_path):
    save_frame(frame, tmp_path / "a.exr", "a command")
    header, channels = read(tmp_path / "a.exr")
    rgb, alpha = cut_out(frame, frame.light)
    expected = {"A": alpha, "Ld.Y": frame.split[0], "Ls.Y": frame.split[1]}
    expected["samples.Y"] = frame.coverage
    for k, name in enumerate("RGB"):
        expected[name] = rgb[..., k]
    for layer, attribute, names in LAYERS:
        for k, name in enumerate(names):
            expected[f"{layer}.{name}"] = getattr(frame, attribute)[..., k]
    assert set(channels) == set(expected)
    for name, values in expected.items():
        np.testing.assert_array_equal(channels[name], np.asarray(values, dtype=np.float32))
    # The layers that could be mistaken for one another are not the same picture.
    assert not np.array_equal(channels["diffuse.Y"], channels["specular.Y"])
    assert not np.array_equal(channels["N.X"], channels["Np.X"])
    assert len(np.unique(channels["A"])) > 3
    # R, G, B are light: over the surround and encoded they give the digital picture.
    assert_same_pixels(digital_over_surround(channels, Display()), frame.display, within=1)
    assert header["command"] == "a command"
    assert json.loads(header["parameters"])["look"]["seed"] == header["seed"] == 7
    assert header["clip_count"] == np.sum(frame.clipped)


@pytest.mark.parametrize("edges", ["sampled", "smooth"])
@pytest.mark.parametrize("samples", [1, 3])
@pytest.mark.parametrize("background_lstar", [0.0, 50.0, 100.0])
def test_exr_composites(renderer, tmp_path, edges, samples, background_lstar):
    """Over its own surround the cut-out object is the picture; over any other it adds no light."""
    display = Display(edges=edges, background_lstar=background_lstar)
    scene = Scene(materials.paper("art"), shape=Shape("sphere"), display=display)
    frame = renderer.render(scene, Look(c=0.4, samples=samples), SIZE)
    save_frame(frame, tmp_path / "a.exr")
    channels = read(tmp_path / "a.exr")[1]
    assert_same_pixels(digital_over_surround(channels, display), frame.display, within=1)
    rgb = np.stack([channels[name] for name in "RGB"], axis=-1)
    assert not np.any(rgb[channels["A"] == 0.0])
    assert np.all(rgb <= channels["A"][..., None] * (1.0 + 1e-6))  # premultiplied: no glow
    assert np.max(over(channels, 1.0)) <= 1.0 + 1e-6
    partly = (channels["A"] > 0.0) & (channels["A"] < 1.0)
    assert np.any(partly) == (edges == "smooth" or samples > 1)
    # The layers hold where samples meet the object, and nowhere else.
    met = channels["samples.Y"] > 0.0
    np.testing.assert_array_equal(met, channels["N.Z"] > 0.0)
    assert not np.any(channels["Lab.L"][~met])


def test_light_that_holds_the_surround_glows(renderer):
    """Control: what earlier files held fails the check above where A is 0, and over white."""
    frame = renderer.render(Scene(materials.paper("art")), Look(c=0.4), SIZE)
    off = frame.coverage == 0.0
    assert np.all(frame.light[off] > 0.1)
    channels = {name: frame.light[..., k] for k, name in enumerate("RGB")} | {"A": frame.coverage}
    assert np.max(over(channels, 1.0)) > 1.1


def test_no_layer_has_an_alpha_of_its_own(frame, tmp_path):
    """Viewers take `NAME.A` for the alpha of the layer NAME."""
    save_frame(frame, tmp_path / "a.exr")
    names = set(read(tmp_path / "a.exr")[1])
    assert [name for name in names if name.upper().split(".")[-1] == "A"] == ["A"]
    assert {"Lab.L", "Lab.a_star", "Lab.b_star"} <= names


def test_exr_without_a_highlight(renderer, tmp_path):
    flat = renderer.render(Scene(materials.flat()), Look(), SIZE)
    save_frame(flat, tmp_path / "a.exr")
    header, _ = read(tmp_path / "a.exr")
    assert np.isnan(header["c_max"])
    assert header["c"] == 1.0


def test_files_name_their_own_colours(renderer, tmp_path):
    frame = renderer.render(Scene(materials.paper("art"), display=OTHER), Look(), SIZE)
    save_frame(frame, tmp_path / "a.exr")
    save_frame(frame, tmp_path / "a.png")
    header, _ = read(tmp_path / "a.exr")
    expected = [*np.ravel(OTHER.primaries_xy), *OTHER.white_xy]
    np.testing.assert_allclose(header["chromaticities"], expected, rtol=1e-6)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.info["icc_profile"] == matrix_profile(OTHER)


def test_parameters_tell_every_entry(frame):
    numbers = json.loads(json.dumps(parameters(frame)))
    assert numbers["look"]["sigma_n_deg"] == 2.0
    assert numbers["shape"]["diameter_m"] == 0.085
    assert numbers["display"]["transfer"] == "srgb"
    assert numbers["lamp"]["illuminant"] == "HP5"
    assert numbers["samples"] == 3


def test_warnings_travel_with_the_picture(renderer, tmp_path):
    frame = renderer.render(Scene(materials.paper("uncoated")), Look(c=2.0), SIZE)
    assert any("above 1" in warning for warning in frame.warnings)
    save_frame(frame, tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as picture:
        assert json.loads(picture.info["Parameters"])["warnings"] == list(frame.warnings)


def test_profile_is_the_same_bytes_each_time(frame, tmp_path):
    for name in ("a.png", "b.png"):
        save_frame(frame, tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


@pytest.mark.parametrize("name", ["a.png", "a.exr"])
def test_full_disk_leaves_nothing(tmp_path, name):
    """A limit on file sizes stands in for a full disk, in a process of its own."""
    code = (
        "import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        "resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048));"
        "from relgloss_view.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    words = ["snapshot", "--size", "64x64", "-o", name]
    done = subprocess.run(
        [sys.executable, "-c", code, *words], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 1, done.stderr
    assert "can't be written" in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["a.jpg", "a", "a.exr.gz"])
def test_unknown_endings(frame, tmp_path, name):
    with pytest.raises(InputError, match="expected a name that ends in"):
        save_frame(frame, tmp_path / name)


def test_thumbnails_average_light(renderer):
    look = Look(sigma_n_deg=3.0)
    frame = renderer.render(Scene(materials.paper("matte")), look, (300, 240))
    small = thumbnail(frame, 100)
    assert small.shape == (80, 100, 3)
    model = DisplayModel.of(Display())
    mean = frame.light.astype(np.float64).reshape(80, 3, 100, 3, 3).mean(axis=(1, 3))
    assert np.max(np.abs(small - 255 * encode(mean, model))) <= 0.51
    assert_same_pixels(thumbnail(frame, 300), frame.display)


def test_sheet_holds_the_pictures_unchanged():
    rng = np.random.default_rng(0)
    rows = [
        [rng.integers(0, 256, (90, 120, 3), dtype=np.uint8) for _ in range(3)] for _ in range(2)
    ]
    sheet = contact_sheet(rows, [["a", "b", "c"], ["d", "e", "f"]], "title", "note")
    windows = np.lib.stride_tricks.sliding_window_view(sheet[..., 0], (90, 120))
    for row in rows:
        for picture in row:
            first = np.argwhere(windows[:, :, 0, 0] == picture[0, 0, 0])
            assert any(np.array_equal(sheet[y : y + 90, x : x + 120], picture) for y, x in first)
    # Everything around the pictures is neutral.
    gray = sheet[-20:]
    assert np.array_equal(gray[..., 0], gray[..., 1])


def contrast(one: int, other: int) -> float:
    """Contrast of two grays of sRGB by WCAG 2.2."""
    dark, light = sorted(
        (v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4)
        for v in (one / 255.0, other / 255.0)
    )
    return (light + 0.05) / (dark + 0.05)


def test_text_on_sheets_can_be_read():
    assert contrast(0, 255) == 21.0
    assert contrast(PAPER_GRAY, 255) < 4.5  # so that no ink is light enough without a plate
    assert contrast(PLATE_GRAY, INK_GRAY) >= 4.5
    for muted in (comparison_sheet.MUTED_GRAY, estimate_report.MUTED_GRAY):
        assert contrast(PLATE_GRAY, muted) >= 4.5
    sheet = contact_sheet([[np.zeros((90, 120, 3), np.uint8)]], [["a caption"]], "title", "note")
    light = np.argwhere(sheet[..., 0] > 200)  # letters; what is near them is a plate
    assert len(light) > 100
    for y, x in light[::7]:
        assert PLATE_GRAY in sheet[max(y - 4, 0) : y + 5, max(x - 4, 0) : x + 5, 0]
    # The surround is what touches a picture, on all sides.
    ys, xs = np.nonzero(sheet[..., 0] == 0)
    around = sheet[ys.min() - 1 : ys.max() + 2, xs.min() - 1 : xs.max() + 2, 0]
    for edge in (around[0], around[-1], around[:, 0], around[:, -1]):
        assert np.unique(edge).tolist() == [PAPER_GRAY]


def test_the_former_name_of_a_keyword_still_works(tmp_path, renderer):
    frame = renderer.render(Scene(load_sample("uncoated")), Look(), (16, 16))
    picture = make_operator("clip").draw(frame)
    for k, words in enumerate(({"displayed": picture}, {"shown": picture}, {})):
        save_frame(frame, tmp_path / f"{k}.png", **words)
    first, second, split = ((tmp_path / f"{k}.png").read_bytes() for k in range(3))
    assert first == second != split
