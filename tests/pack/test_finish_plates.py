"""Plates with names that nobody knows: inks, until a finish lies where they print."""

import dataclasses
import shutil
import tomllib
from pathlib import Path

import artwork_files as files
import numpy as np
import pytest

from relgloss_view.base.icc.profile import read_profile
from relgloss_view.pack.artwork.artwork import REPAIRED
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.read import read_artwork
from relgloss_view.pack.check import check_pack
from relgloss_view.pack.finish_plates import has_right_plates, with_right_plates
from relgloss_view.pack.pack_file import open_artwork, pack_of_tables, read_pack, write_pack
from relgloss_view.pack.quick import quick_pack
from relgloss_view.picture.scene.pack_settings import with_pack_settings
from relgloss_view.viewer.state.packs import artwork_words

CMYK = Path("/usr/share/color/icc/ghostscript/default_cmyk.icc")
SPOTS = {
    "V": ("VP7", (1, 0, 0, 0)),
    "R": ("Rot", (0, 1, 1, 0)),
    "P": ("PANTONE 300 C", (1, 0.4, 0, 0)),
}
#: Yellow, with the three plates side by side above it.
CONTENT = b"""0 0 1 0 k 0 0 80 40 re f /OV gs
/V cs 1 scn 0 0 20 40 re f /R cs 1 scn 20 0 20 40 re f /P cs 1 scn 40 0 20 40 re f
"""
PACK = """[pack]
form = "carton"
artwork = "a.pdf"
dpi = 36
[[finish]]
name = "ink"
kind = "ink"
material = "satin-varnish"
[[finish]]
name = "top"
kind = "{kind}"
material = "{material}"
mask = "plate:{plate}"
"""

pytestmark = pytest.mark.skipif(
    shutil.which("gs") is None or not CMYK.is_file(), reason="Ghostscript is absent"
)


def colours(artwork):
    """XYZ of the four fields: below VP7, Rot and PANTONE 300 C, and without a plate."""
    height, width = artwork.xyz.shape[:2]
    return [artwork.xyz[height // 2, width * k // 80].astype(float) for k in (10, 30, 50, 70)]


@pytest.fixture
def folder(tmp_path):
    files.pdf(tmp_path / "a.pdf", CONTENT, SPOTS, profile=CMYK.read_bytes(), size=(80, 40))
    return tmp_path


def pack_with(folder, plate, kind="varnish", material="matt-varnish"):
    path = folder / f"{kind}-{plate.strip()}.toml"
    path.write_text(PACK.format(plate=plate, kind=kind, material=material))
    return read_pack(path)


def test_a_plate_that_a_finish_names_prints_no_colour(folder):
    yellow = read_profile(CMYK.read_bytes()).xyz(np.array([[0.0, 0.0, 1.0, 0.0]]))[0]
    for kind, material in (("varnish", "matt-varnish"), ("foil", "cold-foil-gold")):
        artwork = pack_with(folder, " vp7", kind, material).artwork
        vp7, red, blue, bare = colours(artwork)
        assert bare == pytest.approx(yellow, abs=2e-3)
        assert vp7.tolist() == bare.tolist()
        assert artwork.plates["VP7"].max() == 255
        assert artwork.coloured == {"Rot", "PANTONE 300 C"}
        assert any("'VP7'" in note for note in artwork.notes)
        # Negative control: inks that no finish names keep their colours.
        assert np.abs(red - bare).max() > 0.1 < np.abs(blue - bare).max()
    ink = pack_with(folder, "VP7", "ink", "gloss-varnish").artwork
    assert np.abs(colours(ink)[0] - yellow).max() > 0.1, "an ink's gloss where the plate prints"
    coded = pack_with(folder, "PANTONE 300 C").artwork
    assert colours(coded)[2].tolist() == colours(ink)[2].tolist(), "varnish above a known ink"


def test_settings_take_the_colour_out_and_put_it_back(folder):
    pack = pack_with(folder, "VP7")
    moved = with_pack_settings(pack, ["finish.top.mask=plate:Rot"])
    assert moved.artwork.finish_plates == {"Rot"}
    vp7, red, _, bare = colours(moved.artwork)
    assert red.tolist() == bare.tolist() != vp7.tolist()
    back = with_pack_settings(moved, ["finish.top.mask=plate:VP7"])
    assert back.artwork is pack.artwork, "what is held is not read twice"
    assert with_pack_settings(pack, ["finish.top.k=2"]).artwork is pack.artwork
    write_pack(folder / "b.toml", moved)
    assert read_pack(folder / "b.toml").artwork is moved.artwork


def test_a_profile_beside_a_scene_is_found_again(folder, monkeypatch):
    """A pack inside a scene has no file of its own, and its profile lies beside the scene."""
    files.pdf(folder / "a.pdf", CONTENT, SPOTS, size=(80, 40))
    (folder / "p.icc").write_bytes(CMYK.read_bytes())
    text = PACK.format(plate="Rot", kind="varnish", material="matt-varnish")
    tables = tomllib.loads(text.replace("dpi = 36", 'dpi = 36\nprofile = "p.icc"'))
    monkeypatch.chdir("/")
    pack = pack_of_tables(tables, folder)
    moved = with_pack_settings(pack, ["finish.top.mask=plate:VP7"])
    assert moved.artwork.finish_plates == {"VP7"}


@pytest.mark.slow
def test_a_name_that_means_a_finish_to_a_pack_alone(tmp_path):
    """ "Gold" is an ink to the artwork, and a foil to a pack that is made of it."""
    spots = {"Go": ("Gold", (0, 0.2, 0.8, 0))}
    content = b"1 0 0 rg 0 0 80 40 re f /OV gs /Go cs 1 scn 0 0 40 40 re f"
    path = tmp_path / "a.pdf"
    files.pdf(path, content, spots, profile=CMYK.read_bytes(), size=(80, 40))
    pack = quick_pack(path, "carton", given={"dpi": 36.0})
    assert pack.finish("Gold").kind == "foil"
    assert pack.artwork.finish_plates == {"Gold"}
    first, *_, bare = colours(pack.artwork)
    assert first.tolist() == bare.tolist()


def test_a_page_of_rgb_needs_no_profile_for_a_finish(tmp_path):
    content = b"1 0 0 rg 0 0 80 40 re f /OV gs /V cs 1 scn 0 0 40 40 re f"
    files.pdf(tmp_path / "a.pdf", content, {"V": SPOTS["V"]}, size=(80, 40))
    artwork = read_artwork(tmp_path / "a.pdf", ArtworkOptions(dpi=36.0, finish_plates=("VP7",)))
    first, *_, bare = colours(artwork)
    assert first.tolist() == bare.tolist()
    assert artwork.plates["VP7"][:, :20].min() == 255


def test_pictures_are_read_once_whatever_finishes_name(tmp_path):
    from PIL import Image

    path = tmp_path / "a.png"
    Image.new("RGB", (8, 4), "red").save(path)
    one = open_artwork(path, {"finish_plates": ("VP7",)}, tmp_path)
    assert open_artwork(path, {}, tmp_path) is one
    assert has_right_plates(one, ("VP7",))
    pack = dataclasses.replace(quick_pack(path), artwork=one)
    assert with_right_plates(pack) is pack


def test_a_pdf_that_was_repaired_gets_a_note(folder):
    artwork = read_artwork(folder / "a.pdf", ArtworkOptions(dpi=36.0))
    assert REPAIRED not in artwork.notes
    whole = (folder / "a.pdf").read_bytes()
    (folder / "b.pdf").write_bytes(whole[: whole.rindex(b"xref")])
    pack = quick_pack(folder / "b.pdf", given={"dpi": 36.0})
    found = check_pack(pack, 4.0)
    assert REPAIRED in found.warnings
    assert REPAIRED not in found.notes
    assert REPAIRED in artwork_words(pack)
