"""Packs in a proof: artwork in 8 bits, masks on its pixels, meshes, all drawn the same."""

from __future__ import annotations

import base64
import dataclasses
import io

import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.icc.profile import D50, read_profile
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.read import read_artwork
from relgloss_view.pack.built_in import load_finish
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.layers import layers_of
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof.carry_pack import SPACES, carried_pack, coded_paint
from relgloss_view.proof.content import Made, content_of
from relgloss_view.proof.grid import compare
from relgloss_view.proof.pair import Pair
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.unpack import opened
from relgloss_view.quality.backends import open_renderer

SIZE = (64, 48)


@pytest.fixture(scope="module")
def renderer():
    with open_renderer() as one:
        yield one


def srgb_artwork(height: int = 60, width: int = 90, levels: tuple[int, int] = (0, 256)) -> Artwork:
    """Random colours of sRGB in fields of a few pixels, with a soft plate of a varnish.

    levels: of the digital values, the last one excluded.
    """
    random = np.random.default_rng(3)
    coarse = random.integers(*levels, (height // 5, width // 5, 3), dtype=np.uint8)
    rgb = np.repeat(np.repeat(coarse, 5, 0), 5, 1)
    profile = read_profile(profile_of(Display()))
    xyz = profile.xyz(rgb.reshape(-1, 3) / 255.0, "relative").reshape(*rgb.shape)
    plate = random.integers(0, 256, (height, width), dtype=np.uint8)
    return Artwork(xyz.astype(np.float16), 200.0, 200.0 * height / width, plates={"Varnish": plate})


def pack_of(artwork: Artwork, shape: Shape | None = None, measured: str = "body") -> Pack:
    base = Finish("ink", "ink", load_finish("matt-varnish"), "matt-varnish")
    gloss = load_finish("gloss-varnish")
    spot = Finish("spot", "varnish", gloss, "gloss-varnish", "plate:Varnish", k=0.8, keeps_k=True)
    foil = load_finish("cold-foil-gold")
    rim = Finish("rim", "foil", foil, "cold-foil-gold", "plate:varnish", invert=True)
    return Pack("label", shape or Shape("can"), (base, rim, spot), artwork, measured=measured)


def pair_with(pack: Pack) -> SceneFile:
    setup = Setup(shape=pack.shape, display=Display().for_the_eye())
    setup = setup.with_entries("lamp", ambient=0.3)
    look = viewed_look()
    return SceneFile(
        Sample.of_pack(pack),
        look.at(Setting(0.5, c=0.2)),
        setup,
        Sample.built_in("cast-coated"),
        look.at(Setting(0.0, c=0.14)),
        reference_shape=Shape(),
    )


def proof_of(made: Made) -> Proof:
    return Proof(made.content, (Message(made.settings),))


def lab_of(xyz: np.ndarray) -> np.ndarray:
    return lab_from_xyz(xyz.astype(np.float64), D50)


def test_the_other_side_draws_the_carried_pack(renderer):
    scene = pair_with(pack_of(srgb_artwork()))
    made = content_of(scene, renderer, size=SIZE)
    with opened(proof_of(made)) as one:
        pictures = one.pair().drawn(renderer, SIZE)
    for side, picture in pictures.items():
        kept = made.content["grid"]["sides"][side]
        assert compare(kept, picture).largest < 1e-4  # the grid's own decimals
        assert compare(kept, picture).missed == 0
    # And that is nearly what the designer has: 8 bits change no colour of sRGB by much.
    original = Pair.of(scene).drawn(renderer, SIZE)["test"]
    seen = original.on_object
    errors = delta_e_2000(
        original.lab[seen].astype(float), pictures["test"].lab[seen].astype(float)
    )
    assert np.mean(errors) < 0.05
    # The negative control: the pack without its varnish is seen by the same comparison.
    bare = dataclasses.replace(scene.sample.pack, finishes=scene.sample.pack.finishes[:2])
    other = Pair.of(pair_with(bare)).drawn(renderer, SIZE)["test"]
    assert compare(made.content["grid"]["sides"]["test"], other).mean > 0.2


def test_layers_of_the_unpacked_pack_are_those_that_were_packed(renderer):
    pack = pack_of(srgb_artwork())
    made = content_of(pair_with(pack), renderer, size=SIZE)
    before = layers_of(pack)
    with opened(proof_of(made)) as one:
        unpacked = one.scene_file.sample.pack
        after = layers_of(unpacked)
    assert np.array_equal(before.channels, after.channels)
    assert before.specular_channel == after.specular_channel
    assert [f.k for f in unpacked.finishes] == [f.k for f in pack.finishes]
    assert [f.material for f in unpacked.finishes] == [f.material for f in pack.finishes]
    errors = delta_e_2000(lab_of(before.paint[..., :3]), lab_of(after.paint[..., :3]))
    # The colours were 8 bits of sRGB, and half floats find each step again.
    assert np.max(errors) < 0.1


def test_eight_bits_of_srgb_come_back_as_they_were():
    random = np.random.default_rng(1)
    rgb = random.integers(0, 256, (64, 64, 3), dtype=np.uint8)
    profile = read_profile(profile_of(Display()))
    xyz = profile.xyz(rgb.reshape(-1, 3) / 255.0, "relative").reshape(64, 64, 3)
    paint = np.concatenate([xyz, np.ones((64, 64, 1))], axis=2).astype(np.float16)
    coded = coded_paint(paint, has_alpha=False)
    assert coded.space == "sRGB"
    # XYZ as half floats, of 1/2048, moves a small channel beside large ones by a few steps.
    assert np.mean(coded.rgba != rgb) < 0.15
    assert coded.rounding.mean < 0.1


@pytest.mark.parametrize("space", list(SPACES))
def test_the_smallest_space_that_holds_all_is_taken(space, tmp_path):
    random = np.random.default_rng(2)
    rgb = random.random((40, 40, 3))
    rgb[:3, :, :] = np.eye(3)[:, None, :]  # its own corners lie outside the smaller ones
    profile = read_profile(profile_of(Display(primaries_xy=SPACES[space])))
    xyz = profile.xyz(rgb.reshape(-1, 3), "relative").reshape(40, 40, 3)
    paint = np.concatenate([xyz, np.ones((40, 40, 1))], axis=2).astype(np.float16)
    coded = coded_paint(paint, has_alpha=False)
    names = list(SPACES)
    # Those of Adobe RGB lie in no smaller space; the others' corners lie in none before them.
    assert names.index(coded.space) >= names.index(space)
    assert coded.rounding.clipped == 0.0
    assert coded.rounding.mean < 0.3
    # What the file holds is read by another way than it was written, and has the stated error.
    file = tmp_path / "art.png"
    Image.fromarray(coded.rgba).save(file, icc_profile=coded.icc)
    read = read_artwork(file, ArtworkOptions(width_mm=100.0, intent="relative"))
    errors = delta_e_2000(lab_of(paint[..., :3]), lab_of(read.xyz))
    assert np.mean(errors) == pytest.approx(coded.rounding.mean, abs=0.01)
    assert np.max(errors) == pytest.approx(coded.rounding.largest, abs=0.05)


def test_colours_beyond_every_space_are_counted():
    paint = np.ones((4, 4, 4), np.float16)
    paint[..., :3] = D50
    assert coded_paint(paint, has_alpha=False).rounding.clipped == 0.0
    paint[0, 0, :3] = (0.0, 0.9, 0.0)  # no light at all but Y
    coded = coded_paint(paint, has_alpha=False)
    assert coded.rounding.clipped == pytest.approx(1.0 / 16.0)
    assert coded.rounding.largest > 5.0


def test_alpha_is_kept(renderer, tmp_path):
    alpha = np.zeros((60, 90), np.float16)
    alpha[10:50, 20:70] = 1.0
    alpha[10:50, 20] = np.float16(128 / 255)
    plain = srgb_artwork()
    artwork = dataclasses.replace(
        plain, xyz=plain.xyz * alpha[..., None], alpha=alpha, plates={}
    )  # fmt: skip
    stock = Finish("board", "stock", load_finish("bare-board"), "bare-board")
    ink = Finish("ink", "ink", load_finish("matt-varnish"), "matt-varnish", "artwork")
    pack = Pack("box", Shape("carton"), (stock, ink), artwork)
    made = content_of(pair_with(pack), renderer, size=SIZE)
    with opened(proof_of(made)) as one:
        after = layers_of(one.scene_file.sample.pack)
    before = layers_of(pack)
    assert np.array_equal(before.channels, after.channels)
    assert np.abs(before.paint[..., 3] - after.paint[..., 3]).max() < 1e-3
    data = base64.b64decode(made.content["files"]["test-artwork.png"]["base64"])
    assert Image.open(io.BytesIO(data)).mode == "RGBA"


def test_colours_measured_45_0_go_along_as_the_body(renderer):
    # Colours with room below them, so that nothing becomes less than black without the lobes.
    pack = pack_of(srgb_artwork(levels=(120, 220)), measured="45-0")
    broad = Finish("ink", "ink", load_finish("uncoated"), "uncoated")
    pack = dataclasses.replace(pack, finishes=(broad,))
    made = content_of(pair_with(pack), renderer, size=SIZE)
    assert any("45/0" in note for note in made.notes)
    with opened(proof_of(made)) as one:
        unpacked = one.scene_file.sample.pack
        after = layers_of(unpacked).paint[..., :3]
    assert unpacked.measured == "body"
    before = layers_of(pack).paint[..., :3]
    plain = layers_of(dataclasses.replace(pack, measured="body")).paint[..., :3]
    assert np.mean(delta_e_2000(lab_of(before), lab_of(after))) < 0.3
    assert np.mean(delta_e_2000(lab_of(before), lab_of(plain))) > 1.0  # what 45/0 changes


def test_a_large_artwork_is_scaled_down_and_said(renderer):
    pack = pack_of(srgb_artwork(120, 180))
    made = content_of(pair_with(pack), renderer, size=SIZE, artwork_px=90)
    assert any("180 x 120 pixels goes along with 90 x 60" in note for note in made.notes)
    with opened(proof_of(made)) as one:
        unpacked = one.scene_file.sample.pack
    assert unpacked.artwork.size_px == (90, 60)
    assert (unpacked.artwork.width_mm, unpacked.artwork.height_mm) == pytest.approx(
        (200.0, 400.0 / 3.0), rel=1e-4
    )
    # Means of 2 x 2 equal areas in linear light.
    means = pack.artwork.xyz.astype(float).reshape(60, 2, 90, 2, 3).mean(axis=(1, 3))
    assert np.mean(delta_e_2000(lab_of(means), lab_of(unpacked.artwork.xyz))) < 0.3


def test_a_mesh_goes_along(renderer, tmp_path):
    obj = tmp_path / "my form.obj"
    corners = [(-0.05, -0.05, 0), (0.05, -0.05, 0), (0.05, 0.05, 0.01), (-0.05, 0.05, 0.01)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "f 1/1 2/2 3/3", "f 1/1 3/3 4/4"]
    obj.write_text("\n".join(lines))
    pack = pack_of(srgb_artwork(), Shape("mesh", file=str(obj)))
    scene = pair_with(pack)
    made = content_of(scene, renderer, size=SIZE)
    before = Pair.of(scene).drawn(renderer, SIZE)["test"]
    obj.unlink()
    with opened(proof_of(made)) as one:
        after = one.pair().drawn(renderer, SIZE)["test"]
    assert np.array_equal(before.on_object, after.on_object)
    assert before.on_object.any()
    seen = before.on_object
    errors = delta_e_2000(before.lab[seen].astype(float), after.lab[seen].astype(float))
    assert np.mean(errors) < 0.05  # of 8 bits
    assert "my form" not in str(made.content)


def test_files_of_a_pack_name_no_person_and_no_place(tmp_path):
    (tmp_path / "materials").mkdir()
    carried, _ = carried_pack(pack_of(srgb_artwork()), tmp_path, "test", 2048)
    names = sorted(p.name for p in tmp_path.rglob("*.png"))
    assert names == ["test-artwork.png", "test-mask-1.png"]  # one file for a mask and its inverse
    with Image.open(tmp_path / "test-artwork.png") as picture:
        assert set(picture.info) <= {"icc_profile"}
    assert carried.file == str(tmp_path / "test-pack.toml")
    assert "Varnish" not in (tmp_path / "test-pack.toml").read_text()  # it has become a mask


def test_an_unpacked_pack_is_saved_again_from_anywhere(renderer, tmp_path, monkeypatch):
    from relgloss_view.picture.scene.scene_file import read_scene_file
    from relgloss_view.picture.scene.scene_writer import write_scene_file

    made = content_of(pair_with(pack_of(srgb_artwork())), renderer, size=SIZE)
    monkeypatch.chdir(tmp_path)
    with opened(proof_of(made)) as one:
        write_scene_file(tmp_path / "copy.toml", one.scene_at())
        again = read_scene_file(tmp_path / "copy.toml")
        before = Pair.of(one.scene_file).drawn(renderer, SIZE)["test"]
        after = Pair.of(again).drawn(renderer, SIZE)["test"]
    assert np.array_equal(before.rgb, after.rgb)
