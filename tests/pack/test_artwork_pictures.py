"""Pictures of every layout, read back exactly; what is damaged or too large is refused."""

import itertools
import os
import struct
import zlib

import artwork_files as files
import numpy as np
import pytest
from PIL import Image, ImageCms

from relgloss_view.base.errors import InputError
from relgloss_view.base.terminal import no_progress
from relgloss_view.pack import mask_file
from relgloss_view.pack.artwork import pictures, read
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.raster import area_means, to_artwork
from relgloss_view.pack.artwork.spaces import REC709, rgb_to_xyz, srgb_light

USUAL = ArtworkOptions()
RNG = np.random.default_rng(0)


def values_of(height, width, channels, dtype=np.uint8):
    return RNG.integers(0, np.iinfo(dtype).max + 1, (height, width, channels)).astype(dtype)


def raster(path):
    return pictures.read_picture(path, USUAL, no_progress)


@pytest.mark.parametrize(("colour_type", "channels"), [(0, 1), (2, 3), (4, 2), (6, 4)])
def test_a_png_keeps_its_16_bits(tmp_path, colour_type, channels):
    values = values_of(9, 7, channels, np.uint16)
    (tmp_path / "a.png").write_bytes(files.deep_png(values, colour_type))
    got = raster(tmp_path / "a.png")
    own = 1 if channels < 3 else 3
    assert (got.samples == values[..., :own]).all()
    assert got.alpha is None if channels in (1, 3) else (got.alpha == values[..., -1]).all()


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_tiff_of_every_layout(tmp_path, order, dtype, monkeypatch):
    monkeypatch.setattr(pictures, "check_room", lambda *_: None)
    path = tmp_path / "a.tif"
    kinds = ((3, 2, ()), (4, 2, (2,)), (5, 2, (2, 0)), (1, 1, ()), (2, 0, (1,)))
    layouts = itertools.product((1, 8, 32773), (None, 16), (1, 2), (1, 2), kinds)
    for compression, tile, planar, predictor, (channels, kind, extra) in layouts:
        values = values_of(19, 21, channels, dtype)
        path.write_bytes(
            files.tiff(values, order, kind=kind, compression=compression, tile=tile, planar=planar,
                       predictor=predictor, extra=extra)
        )  # fmt: skip
        got = raster(path)
        own = 1 if kind < 2 else 3
        top = np.iinfo(dtype).max
        colour = values[..., :own]
        assert (got.samples == (top - colour if kind == 0 else colour)).all()
        assert extra == () or (got.alpha == values[..., own]).all()
        assert got.premultiplied == (extra == (1,))
        for plate in got.plates.values():
            assert (plate == np.rint(values[..., 4] / (top / 255))).all()


def test_channels_of_photoshop_have_their_names(tmp_path):
    values = values_of(9, 11, 5)
    names = b"\x07Varnish\x04Foil"
    tags = [(34377, 7, files.resource(1006, names))]
    (tmp_path / "a.tif").write_bytes(files.tiff(values, ">", extra=(0, 0), tags=tags))
    got = raster(tmp_path / "a.tif")
    assert list(got.plates) == ["Varnish", "Foil"]
    assert (got.plates["Foil"] == values[..., 4]).all()
    for packed, version, dtype in itertools.product((0, 1), (1, 2), (np.uint8, np.uint16)):
        values = values_of(9, 11, 5, dtype)
        data = files.psd(values, 3, packed=packed, kinds=(2, 0), names=names, version=version)
        (tmp_path / "a.psd").write_bytes(data)
        got = raster(tmp_path / "a.psd")
        assert (got.samples == values[..., :3]).all()
        eight = np.rint(values / (np.iinfo(dtype).max / 255)).astype(np.uint8)
        assert (got.plates["Varnish"] == 255 - eight[..., 3]).all(), "a spot channel is inverted"
        assert (got.plates["Foil"] == eight[..., 4]).all()
        assert got.width_mm == pytest.approx(11 * 25.4 / 200)


def decoded(path):
    with path.open("rb") as file, Image.open(file) as image:
        samples, _, space = pictures._samples(image, file)
    return samples, space


def test_cmyk_of_a_jpeg_is_upright_with_and_without_the_mark_of_adobe(tmp_path):
    """The second file is the first without its marker, so that its bytes mean the opposite ink."""
    ink = np.full((16, 16, 4), (200, 30, 60, 10), np.uint8)
    Image.fromarray(ink, "CMYK").save(tmp_path / "a.jpg", quality=100)
    samples, space = decoded(tmp_path / "a.jpg")
    assert space == "CMYK"
    assert np.abs(samples.astype(int) - ink).max() <= 2
    data = (tmp_path / "a.jpg").read_bytes()
    at = data.index(b"\xff\xee")
    plain = data[:at] + data[at + 2 + int.from_bytes(data[at + 2 : at + 4], "big") :]
    (tmp_path / "b.jpg").write_bytes(plain)
    upside, _ = decoded(tmp_path / "b.jpg")
    assert np.abs(upside.astype(int) - (255 - ink)).max() <= 2
    with pytest.raises(InputError, match=r"CMYK without a profile; .*--profile FILE.icc"):
        read.read_artwork(tmp_path / "a.jpg")


def test_a_given_profile_of_another_space_is_named(tmp_path):
    rgb = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    (tmp_path / "rgb.icc").write_bytes(rgb)
    Image.new("L", (4, 4), 128).save(tmp_path / "gray.png")
    Image.new("RGB", (4, 4), 128).save(tmp_path / "rgb.png")
    options = ArtworkOptions(profile=str(tmp_path / "rgb.icc"))
    notes = [
        " ".join(read.read_artwork(tmp_path / f, options).notes) for f in ("gray.png", "rgb.png")
    ]
    assert ["profile is of RGB, so it is left out" in text for text in notes] == [True, False]


@pytest.mark.parametrize("orientation", range(1, 9))
def test_orientation_is_that_of_pillow(tmp_path, orientation):
    from PIL import ImageOps

    values = values_of(6, 4, 3)
    exif = Image.Exif()
    exif[274] = orientation
    Image.fromarray(values).save(tmp_path / "a.png", exif=exif)
    with Image.open(tmp_path / "a.png") as image:
        expected = np.asarray(ImageOps.exif_transpose(image))
    assert (raster(tmp_path / "a.png").samples == expected).all()


def test_colours_that_a_png_names_without_a_profile(tmp_path):
    head = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    pixel = (b"IDAT", zlib.compress(b"\0\x80\x40\xc0"))
    values = np.array([128, 64, 192]) / 255

    def xyz(*chunks):
        (tmp_path / "a.png").write_bytes(files.png(head, *chunks, pixel))
        return read.read_artwork(tmp_path / "a.png").xyz[0, 0].astype(float)

    expected = rgb_to_xyz(REC709) @ srgb_light(values)
    assert xyz() == pytest.approx(expected, abs=2e-3)
    assert xyz((b"cICP", bytes((1, 13, 0, 1)))) == pytest.approx(expected, abs=2e-3)
    assert xyz((b"gAMA", struct.pack(">I", 100_000))) == pytest.approx(
        rgb_to_xyz(REC709) @ values, abs=2e-3
    )
    assert np.abs(xyz((b"cICP", bytes((12, 13, 0, 1)))) - expected).max() > 0.01
    with pytest.raises(InputError, match="transfer 16"):
        xyz((b"cICP", bytes((9, 16, 0, 1))))


def test_large_artwork_becomes_area_means_of_light(tmp_path):
    values = values_of(30, 45, 4)
    Image.fromarray(values, "RGBA").save(tmp_path / "a.png")
    whole = read.read_artwork(tmp_path / "a.png")
    small = read.read_artwork(tmp_path / "a.png", ArtworkOptions(most_px=15))
    assert small.size_px == (15, 10)
    blocks = whole.xyz.astype(float).reshape(10, 3, 15, 3, 3).mean((1, 3))
    assert np.abs(small.xyz - blocks).max() < 1e-3
    assert (
        np.abs(small.alpha - whole.alpha.astype(float).reshape(10, 3, 15, 3).mean((1, 3))).max()
        < 1e-3
    )
    assert any("scaled down to 15 x 10" in note for note in small.notes)
    # Negative control: the mean of the values, without linear light, is another.
    plain = Image.fromarray(values[..., :3]).reduce(3)
    wrong = rgb_to_xyz(REC709) @ srgb_light(np.asarray(plain).reshape(-1, 3) / 255).T
    assert np.abs(wrong.T.reshape(10, 15, 3) * small.alpha[..., None] - small.xyz).max() > 0.02
    uneven = area_means(np.arange(5.0)[:, None], np.array([0.0, 2.5, 5.0]), 1)
    assert uneven[:, 0] == pytest.approx([(0 + 1 + 2 / 2) / 2.5, (2 / 2 + 3 + 4) / 2.5])


def test_printed_size(tmp_path):
    Image.fromarray(values_of(10, 20, 3)).save(tmp_path / "a.png")
    plain = read.read_artwork(tmp_path / "a.png")
    assert plain.width_mm == pytest.approx(20 * 25.4 / 300)
    assert any("300 dpi" in note for note in plain.notes)
    wide = read.read_artwork(tmp_path / "a.png", ArtworkOptions(width_mm=50.0))
    assert (wide.width_mm, wide.height_mm) == (50.0, 25.0)
    assert read.read_artwork(tmp_path / "a.png", ArtworkOptions(dpi=100.0)).width_mm == 5.08


def test_an_edited_file_is_noticed(tmp_path):
    path = tmp_path / "a.png"
    Image.fromarray(values_of(4, 4, 3)).save(path)
    artwork = read.read_artwork(path)
    assert not read.changed(artwork)
    Image.fromarray(values_of(4, 5, 3)).save(path)
    assert not read.changed(artwork), "more of it may come"
    os.utime(path, (1e9, 1e9))
    assert read.changed(artwork)
    path.unlink()
    assert not read.changed(artwork)


def test_what_is_no_picture_is_refused(tmp_path):
    head = struct.pack(">IIBBBBB", 40_000, 40_000, 8, 2, 0, 0, 0)
    bomb = files.png(head, (b"IDAT", zlib.compress(bytes(100_000))))
    whole = files.deep_png(values_of(50, 50, 3, np.uint16), 2)
    cases = {
        b"": "an empty file", b"text": "no picture", bomb: "too many", whole[:2000]: "truncated",
        files.tiff(values_of(9, 9, 3))[:100]: "decoded", b"8BPS" + bytes(22): "PSD of a mode",
        files.tiff(values_of(9, 9, 4), kind=5): "CMYK without a profile",
    }  # fmt: skip
    for data, words in cases.items():
        (tmp_path / "a.png").write_bytes(data)
        with pytest.raises(InputError, match=words) as caught:
            read.read_artwork(tmp_path / "a.png")
        assert str(caught.value).startswith(f"{tmp_path / 'a.png'}: ")
    with pytest.raises(InputError, match="a folder"):
        read.read_artwork(tmp_path)


def test_alpha_is_multiplied_in(tmp_path):
    values = np.zeros((4, 4, 4), np.uint8)
    values[..., :3], values[:, 2:, 3] = 255, 128
    Image.fromarray(values, "RGBA").save(tmp_path / "a.png")
    got = to_artwork(raster(tmp_path / "a.png"), USUAL, "", (0, 0))
    assert got.alpha[0].tolist() == pytest.approx([0, 0, 128 / 255, 128 / 255], abs=1e-3)
    assert got.xyz[0, :, 1].tolist() == pytest.approx([0, 0, 128 / 255, 128 / 255], abs=1e-3)


def test_further_pages_of_a_tiff_are_noted(tmp_path):
    """Pages are noted; a thumbnail behind the picture is none."""
    page, thumbnail = Image.new("RGB", (9, 5)), Image.new("RGB", (3, 2))
    notes = []
    for name, more, tags in (
        ("one", [], {}),
        ("two", [page], {}),
        ("small", [thumbnail], {254: 1}),
    ):
        page.save(tmp_path / f"{name}.tif", save_all=True, append_images=more)
        if tags:
            thumbnail.encoderinfo = {"tiffinfo": tags}
            page.save(tmp_path / f"{name}.tif", save_all=True, append_images=[thumbnail])
        notes.append(" ".join(read.read_artwork(tmp_path / f"{name}.tif").notes))
    assert ["several pages" in text for text in notes] == [False, True, False]


def test_a_mask_is_read_as_an_artwork_is(tmp_path, monkeypatch, recwarn):
    """Turned by EXIF, clear where a gray value of 16 bits is, without Pillow's own limit."""
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 5)
    exif = Image.Exif()
    exif[274] = 6
    gray = np.arange(0, 240, 10, dtype=np.uint8).reshape(4, 6)
    Image.fromarray(gray).save(tmp_path / "a.png", exif=exif)
    monkeypatch.setattr(mask_file, "AT_ONCE", 12)  # in strips
    assert np.array_equal(mask_file.read_mask(tmp_path / "a.png"), np.rot90(gray, -1))
    assert read.read_artwork(tmp_path / "a.png").size_px == (4, 6)
    head = struct.pack(">IIBBBBB", 6, 4, 16, 0, 0, 0, 0)
    rows = b"".join(b"\0" + (row * 257).astype(">u2").tobytes() for row in gray.astype(int))
    clear = (b"tRNS", struct.pack(">H", 230 * 257))
    data = files.png(head, clear, (b"IDAT", zlib.compress(rows)))
    (tmp_path / "b.png").write_bytes(data)
    assert np.array_equal(mask_file.read_mask(tmp_path / "b.png"), np.where(gray == 230, 0, gray))
    alpha = read.read_artwork(tmp_path / "b.png").alpha
    assert np.array_equal(alpha == 0.0, gray == 230)
    assert not recwarn.list
