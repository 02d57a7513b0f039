"""Pack files: reading, writing back, faults in one line; packs from artwork alone, their check."""

import dataclasses
import json

import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.cli import main
from relgloss_view.pack.built_in import FINISHES, load_finish
from relgloss_view.pack.check import check_pack, outside_srgb
from relgloss_view.pack.layers import layers_of
from relgloss_view.pack.pack import Placement
from relgloss_view.pack.pack_file import read_pack, write_pack
from relgloss_view.pack.quick import (
    finish_of_plate,
    finishes_of_artwork,
    plates_without_finish,
    quick_pack,
)
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.options import sample_words
from relgloss_view.picture.scene.pack_settings import with_pack_settings
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.picture.scene.setup import Setup

PACK = """
[pack]
form = "{form}"
artwork = "art.png"
[[finish]]
material = "matt-varnish"
[[finish]]
name = "spot"
material = "gloss-varnish"
mask = "spot.png"
k = 2.0
sigma_n_deg = 0.5
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with an artwork of 20 x 10 mm, a mask over its right half, and a pack."""
    monkeypatch.chdir(tmp_path)
    picture = np.full((50, 100, 3), 128, dtype=np.uint8)
    Image.fromarray(picture).save("art.png", dpi=(127, 127))
    mask = np.where(np.arange(100) >= 50, 255, 0).astype(np.uint8)
    Image.fromarray(np.tile(mask, (50, 1))).save("spot.png")
    (tmp_path / "pack.toml").write_text(PACK.format(form="plane"))
    return tmp_path


def test_a_pack_is_read_and_written_back(folder):
    pack = read_pack("pack.toml")
    assert [f.kind for f in pack.finishes] == ["ink", "varnish"]
    assert pack.finishes[1].k == 2.0
    assert pack.finishes[1].sigma_n_deg == 0.5
    assert pack.artwork.width_mm == pytest.approx(20.0, rel=1e-3)
    changed = dataclasses.replace(
        pack.with_finish("spot", invert=True, mask="artwork"), placement=Placement(turn_deg=90.0)
    )
    write_pack("again.toml", changed)
    again = read_pack("again.toml")
    assert again.finishes == changed.finishes
    assert again.placement == changed.placement
    assert again.artwork is pack.artwork  # read once
    assert 'artwork = "art.png"' in (folder / "again.toml").read_text()


def test_files_are_named_from_the_pack_file(folder):
    (folder / "sub").mkdir()
    write_pack("sub/moved.toml", read_pack("pack.toml"))
    moved = read_pack("sub/moved.toml")
    assert np.array_equal(
        next(iter(moved.masks.values())), read_pack("pack.toml").masks["spot.png"]
    )


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('form = "plane"', 'form = "jug"'), "pack.form: expected one of cylinder"),
        (('form = "plane"', "form = 3"), r"\[pack.form\]: expected a table"),
        (('artwork = "art.png"', 'artwork = "no.png"'), "no.png"),
        (('"matt-varnish"', '"velvet"'), r"\[\[finish\]\] 1: material 'velvet': expected"),
        (('name = "spot"', 'name = "matt-varnish"'), "two finishes have the same name"),
        (('"spot.png"', '"plate:Varnish"'), "no plate beside its colours"),
        (('"spot.png"', '"part:lid"'), "a part of the plane: front"),
        (('"spot.png"', '"nowhere.png"'), r"\[\[finish\]\] 2 \(spot\): .*nowhere.png"),
        (('"spot.png"', '""'), "expected plate:NAME"),
        (('"spot.png"', '"Spot UV"'), r'\(spot\): mask: expected .*plate:NAME.*found "Spot UV"'),
        (("k = 2.0", "k = -1"), r"\(spot\): k: expected 0 to 100"),
        (("k = 2.0", "kk = 1"), "finish.kk: no such entry"),
        (("[pack]", "[pack]\ncolour = 'loud'"), "pack.colour: expected one of lab, spectral"),
        (("[pack]", "[pack]\nplacement = {scale = 0}"), "pack.placement.scale: expected"),
        (("[pack]", "[pack]\ndpi = 'x'"), "pack.*dpi: expected"),
        (('"matt-varnish"', '"matt-varnish"\nkind = "varnish"'), "can't be a varnish"),
        (("[[finish]]", "[[finnish]]"), r"\[finnish\]: no such table"),
    ],
)
def test_faults_are_one_line(folder, change, message):
    text = PACK.format(form="plane").replace(*change)
    (folder / "bad.toml").write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_pack("bad.toml")
    assert "\n" not in str(caught.value)
    assert str(caught.value).startswith("bad.toml: ")


def test_names_of_plates_mean_finishes():
    meant = {
        "Varnish": "gloss-varnish", "SpotUV": "gloss-varnish", "UV-Mattlack": "matt-varnish",
        "Heissfolie Gold": "cold-foil-gold", "Silver": "cold-foil-silver", "matt": "matt-varnish",
        "Soft Touch": "soft-touch", "Black": None, "Format": None, "CutContour": None,
        "White": None, "PANTONE 186 C": None,
    }  # fmt: skip
    assert {name: finish_of_plate(name) for name in meant} == meant


def test_an_artwork_alone_is_a_pack(folder):
    pack = quick_pack("art.png", "can")
    assert [f.mask for f in pack.finishes] == ["", "part:lid", "part:base"]
    assert pack.placement.scale == pytest.approx(207.345 / 20.0, rel=1e-3)
    assert any("scaled" in note for note in pack.notes)
    assert Sample.from_file("art.png").pack.shape.kind == "can"


def test_a_scene_names_or_holds_its_pack(folder):
    sample = Sample.from_file("pack.toml")
    setup = Setup(shape=sample.pack.shape)
    write_scene_file("named.toml", SceneFile(sample, Look(), setup))
    assert 'pack = "pack.toml"' in (folder / "named.toml").read_text()
    assert read_scene_file("named.toml").sample.pack.finishes == sample.pack.finishes
    other = Sample.of_pack(sample.pack.with_finish("spot", k=3.0))
    write_scene_file("held.toml", SceneFile(other, Look(), setup, reference=sample))
    held = read_scene_file("held.toml")
    assert held.sample.pack.finish("spot").k == 3.0
    assert held.setup.shape.kind == "plane"
    assert held.reference.pack.finish("spot").k == 2.0
    (folder / "both.toml").write_text((folder / "named.toml").read_text() + "\n[shape]\n")
    with pytest.raises(InputError, match="own form"):
        read_scene_file("both.toml")


def test_copied_words_give_the_pack_again(folder):
    pack = read_pack("pack.toml").with_finish("spot", k=3.5, sigma_n_deg=None)
    words = sample_words(Sample.of_pack(pack))
    assert words[0] == "--pack"
    settings = [word for word in words[2:] if word != "--set"]
    again = with_pack_settings(read_pack(words[1]), settings)
    assert again.finish("spot").k == 3.5
    assert again.finish("spot").sigma_n_deg is None
    with pytest.raises(InputError, match="expected one of"):
        with_pack_settings(pack, ["finish.foil.k=2"])


def test_plates_are_sorted_by_what_they_print(folder):
    """Inks are in the artwork's colours, cuts and white are no finish; only the rest is a loss."""
    names = ("PANTONE 186 C", "CutContour", "Weiss", "Sandpaper", "Spot UV")
    plate = np.full((50, 100), 255, dtype=np.uint8)
    artwork = dataclasses.replace(
        quick_pack("art.png").artwork,
        plates=dict.fromkeys(names, plate),
        coloured=frozenset(names[:1]),
    )
    assert plates_without_finish(artwork, ["Spot UV"]) == (["Sandpaper"], ["CutContour", "Weiss"])
    finishes, notes = finishes_of_artwork(artwork, Shape("can"))
    assert [f.mask for f in finishes][3:] == ["plate:Spot UV"]
    assert any("not drawn: Sandpaper." in note for note in notes)
    assert not any("PANTONE" in note for note in notes)


def test_shipped_packs_have_names(folder):
    assert Sample.from_file("carton").pack.name.startswith("MERIDIAN")
    (folder / "can").write_text(PACK.format(form="plane"))
    assert read_pack("can").shape.kind == "plane", "a file of the name comes first"


def test_a_pack_option_that_names_an_artwork(folder, capsys):
    assert main(["snapshot", "--pack", "art.png", "-o", "a.png"]) == 1
    assert "draw it with --artwork" in capsys.readouterr().err


def test_a_mesh_file_is_a_form(folder, capsys):
    (folder / "quad.obj").write_text(
        "v 0 0 0\nv .02 0 0\nv .02 .01 0\nv 0 .01 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
        "f 1/1 2/2 3/3 4/4\n"
    )
    assert main(["pack", "new", "art.png", "--form", "quad.obj", "-o", "quad.toml"]) == 0
    assert read_pack("quad.toml").shape.file.endswith("quad.obj")
    assert 'form = "quad.obj"' in (folder / "quad.toml").read_text()
    assert not any("texture" in text for text in check_pack(read_pack("quad.toml"), 1.0).warnings)
    (folder / "bare.obj").write_text("v 0 0 0\nv .02 0 0\nv .02 .01 0\nf 1 2 3\n")
    found = check_pack(quick_pack("art.png", "bare.obj"), 1.0)
    assert any("no texture coordinates" in text for text in found.warnings)
    in_mm = dataclasses.replace(
        read_pack("quad.toml"), shape=Shape("mesh", file="quad.obj", unit="mm")
    )
    write_pack("quad.toml", in_mm)
    assert read_pack("quad.toml").shape.unit == "mm"
    assert main(["pack", "new", "art.png", "--form", "quad.txt", "-o", "quad.toml"]) == 2


def test_the_check_finds_what_would_surprise(folder):
    found = check_pack(read_pack("pack.toml"), 10.0)
    assert found.finishes[1].coverage == pytest.approx(0.5)
    assert found.finishes[0].visible == pytest.approx(0.5)
    assert found.artwork_px_per_mm == pytest.approx(5.0, rel=1e-3)
    assert any("looks soft" in text for text in found.warnings)
    assert any("are not printed" in text for text in found.warnings)
    assert not any(
        "looks soft" in text for text in check_pack(read_pack("pack.toml"), 4.0).warnings
    )


def test_colours_outside_srgb_are_counted():
    from relgloss_view.material.cielab import xyz_from_lab
    from relgloss_view.material.spectra import illuminant

    white = illuminant("D50").white_xyz()
    lab = np.array([[[50.0, 0.0, 0.0], [60.0, -110.0, 60.0]]])  # gray; a green beyond sRGB
    assert outside_srgb(xyz_from_lab(lab, white), np.ones((1, 2))) == 0.5


def test_pack_commands(folder, capsys):
    assert main(["pack", "check", "pack.toml", "--json"]) == 0
    numbers = json.loads(capsys.readouterr().out)
    assert numbers["finishes"][1]["coverage"] == pytest.approx(0.5)
    assert main(["pack", "new", "art.png", "--form", "carton", "-o", "new.toml"]) == 0
    assert read_pack("new.toml").shape.kind == "carton"
    capsys.readouterr()
    assert main(["pack", "finishes", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["finishes"]
    assert [one["name"] for one in listed] == list(FINISHES)


def test_finishes_read_as_their_kinds_are_published():
    """60-degree gloss: gloss 70 to 90, satin 30 to 45, matt 5 to 15, soft touch 2 to 4."""
    from relgloss_view.gloss.meter.meter import specular_gloss

    ranges = {"gloss-varnish": (70, 90), "satin-varnish": (30, 45), "matt-varnish": (5, 15),
              "soft-touch": (2, 4)}  # fmt: skip
    for name, (low, high) in ranges.items():
        assert low <= specular_gloss(load_finish(name), 60.0) <= high
    assert specular_gloss(load_finish("cold-foil-silver"), 20.0) > 500.0
    assert all(load_finish(name).synthetic for name in FINISHES)


def test_shipped_packs_open_without_other_programs():
    for name in ("can", "carton"):
        pack = read_pack(asset("packs", f"{name}.toml"))
        assert pack.shape.kind == name
        layers = layers_of(pack)
        foil = next(k for k, f in enumerate(pack.finishes) if f.name == "gold foil")
        mean = layers.shares(layers.levels[-1][1][0, 0] / 255.0)[1]
        assert 0.003 < mean[foil] < 0.1
