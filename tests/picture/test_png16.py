"""PNG with 16 bits a channel, read by programs that nobody here wrote."""

from __future__ import annotations

import io
import struct
import zlib

import mitsuba
import numpy as np
import pytest
from PIL import Image, ImageCms

from relgloss_view import cli
from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile, srgb_profile
from relgloss_view.picture.output import png16
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.output.png import digital, save_pair, save_rgb
from relgloss_view.picture.output.png16 import write_png16
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

mitsuba.set_variant("scalar_rgb")
TEXT = {"Software": "relgloss", "Parameters": '{"name": "光沢 é", "n": 1}', "Command": "a\nb"}


def pixels(path):
    """As Mitsuba (libpng) reads them."""
    got = np.array(mitsuba.Bitmap(str(path)))
    assert got.dtype == np.uint16
    return got


def chunks(path):
    """The chunks of a PNG, their check sums held against zlib's."""
    data = path.read_bytes()
    assert data[:8] == png16.SIGNATURE
    at, found = 8, []
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, content = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        (check,) = struct.unpack(">I", data[at + 8 + length : at + 12 + length])
        assert check == zlib.crc32(kind + content)
        found.append((kind.decode(), content))
        at += 12 + length
    return found


def pictures():
    rng = np.random.default_rng(3)
    ramp = np.linspace(0, 65535, 64 * 48).reshape(48, 64)
    smooth = np.stack([ramp, ramp[::-1], ramp[:, ::-1]], axis=-1).astype(np.uint16)
    return {
        "noise": rng.integers(0, 65536, (31, 47, 3), dtype=np.uint16),
        "smooth": smooth,
        "flat": np.full((9, 5, 3), 0x1234, dtype=np.uint16),
        "ends": np.array([[[0, 65535, 255], [256, 1, 65280]]], dtype=np.uint16),
        "one pixel": np.array([[[1, 2, 3]]], dtype=np.uint16),
        "column": rng.integers(0, 65536, (200, 1, 3), dtype=np.uint16),
        "mirrored view": smooth[:, ::-1],
    }


@pytest.mark.parametrize("name", pictures())
def test_every_value_comes_back(tmp_path, name):
    rgb = pictures()[name]
    write_png16(tmp_path / "a.png", rgb, {}, None)
    assert np.array_equal(pixels(tmp_path / "a.png"), rgb)


@pytest.mark.parametrize("rows_bytes", [1, 47 * 6 * 3, 1 << 30])
def test_pieces_make_one_picture(tmp_path, monkeypatch, rows_bytes):
    monkeypatch.setattr(png16, "ROWS_BYTES", rows_bytes)
    monkeypatch.setattr(png16, "DATA_BYTES", 100)
    rgb = pictures()["noise"]
    write_png16(tmp_path / "a.png", rgb, {}, None)
    assert np.array_equal(pixels(tmp_path / "a.png"), rgb)


def test_a_wrong_byte_is_found(tmp_path):
    """Negative control: what reads the pictures notices damage and other values."""
    rgb = pictures()["smooth"]
    write_png16(tmp_path / "a.png", rgb, {}, None)
    assert not np.array_equal(pixels(tmp_path / "a.png"), rgb + np.uint16(1))
    data = bytearray((tmp_path / "a.png").read_bytes())
    data[len(data) // 2] ^= 0x10
    (tmp_path / "b.png").write_bytes(data)
    with pytest.raises((RuntimeError, AssertionError)):
        assert np.array_equal(pixels(tmp_path / "b.png"), rgb)


def test_chunks_are_in_order_and_texts_are_read(tmp_path):
    write_png16(tmp_path / "a.png", pictures()["smooth"], TEXT, srgb_profile())
    found = chunks(tmp_path / "a.png")
    assert [kind for kind, _ in found] == ["IHDR", "iCCP", "iTXt", "iTXt", "iTXt", "IDAT", "IEND"]
    assert found[0][1][8:10] == bytes((16, 2))
    with Image.open(tmp_path / "a.png") as picture:
        picture.load()
        assert picture.size == (64, 48)
        assert picture.text == TEXT
        profile = picture.info["icc_profile"]
    assert profile == srgb_profile()
    assert "sRGB" in ImageCms.getProfileDescription(ImageCms.ImageCmsProfile(io.BytesIO(profile)))


def test_filters_are_worth_their_time(tmp_path):
    rgb = pictures()["smooth"]
    write_png16(tmp_path / "a.png", rgb, {}, None)
    plain = len(zlib.compress(rgb.astype(">u2").tobytes(), 9))
    assert (tmp_path / "a.png").stat().st_size < 0.7 * plain


@pytest.fixture
def frame(renderer):
    return renderer.render(
        Scene(load_sample("matte-coated")), Look(sigma_n_deg=1.0, seed=4), (96, 64)
    )


def test_values_are_the_light_encoded(frame, tmp_path):
    save_frame(frame, tmp_path / "a.png", "relgloss snapshot", bits=16)
    deep = pixels(tmp_path / "a.png")
    light = frame.light.astype(np.float64)
    # IEC 61966-2-1, written down once more.
    expected = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    assert np.max(np.abs(deep - 65535.0 * expected)) <= 0.5 + 1e-6
    assert np.max(np.abs(deep / 257.0 - frame.display)) < 0.51
    assert np.any(deep % 257 != 0)
    assert list(tmp_path.iterdir()) == [tmp_path / "a.png"]


def test_a_display_that_is_not_srgb_has_its_own_profile(renderer, tmp_path):
    scene = Scene(load_sample("matte-coated"), display=Display(transfer="gain-offset-gamma"))
    got = renderer.render(scene, Look(), (32, 24))
    save_frame(got, tmp_path / "a.png", bits=16)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.info["icc_profile"] == matrix_profile(scene.display)
    assert np.max(np.abs(pixels(tmp_path / "a.png") / 257.0 - got.display)) < 0.51


def test_the_disk_is_full(frame, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    (tmp_path / "a.png").write_bytes(b"held before")
    monkeypatch.setattr(png16, "_chunk", full)
    with pytest.raises(InputError, match="No space left"):
        save_frame(frame, tmp_path / "a.png", bits=16)
    assert (tmp_path / "a.png").read_bytes() == b"held before"
    assert list(tmp_path.iterdir()) == [tmp_path / "a.png"]


def test_a_pair_is_a_png(frame, tmp_path):
    with pytest.raises(InputError, match=r"\.png"):
        save_pair((frame, frame), tmp_path / "a.exr", ("", ""))
    save_pair((frame, frame), tmp_path / "a.png", ("one", "two"), gap_px=0, bits=16)
    got = pixels(tmp_path / "a.png")
    assert np.array_equal(got, np.concatenate([digital(frame, None, 16)] * 2, axis=1))
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.text["Command"] == "one\ntwo"


def test_eight_bits_stay_pillows(frame, tmp_path):
    save_rgb(frame.display, tmp_path / "a.png", {})
    with Image.open(tmp_path / "a.png") as picture:
        assert np.array_equal(np.asarray(picture), frame.display)


class TestSnapshot:
    def run(self, capsys, *words):
        status = cli.main(["snapshot", "--size", "32x24", *map(str, words)])
        return status, capsys.readouterr().err

    def test_bits(self, capsys, tmp_path):
        for bits in (8, 16):
            assert self.run(capsys, "--bits", bits, "-o", tmp_path / f"{bits}.png")[0] == 0
        assert self.run(capsys, "-o", tmp_path / "default.png")[0] == 0
        deep = pixels(tmp_path / "16.png")
        with Image.open(tmp_path / "8.png") as picture:
            assert np.max(np.abs(deep / 257.0 - np.asarray(picture))) < 1.01  # and dither
        assert chunks(tmp_path / "8.png")[0] == chunks(tmp_path / "default.png")[0]

    def test_floats_have_no_bits(self, capsys, tmp_path):
        for bits in (8, 16):
            status, told = self.run(capsys, "--bits", bits, "-o", tmp_path / "a.exr")
            assert status == 2
            assert "--bits" in told.splitlines()[-1]
            assert "OpenEXR" in told.splitlines()[-1]
        assert self.run(capsys, "--bits", "12", "-o", tmp_path / "a.png")[0] == 2
        assert list(tmp_path.iterdir()) == []
