"""What is in a proof: a scene that is drawn on the other side exactly, and what goes with it."""

from __future__ import annotations

import base64
import dataclasses
import io
from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.gloss.meter.meter import gloss_readings
from relgloss_view.material.recolour import Colour
from relgloss_view.picture.scene.look import Look, viewed_look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import FurtherLamp, Setup
from relgloss_view.proof.content import Made, content_of, display_words
from relgloss_view.proof.grid import compare
from relgloss_view.proof.meter import SEEN
from relgloss_view.proof.pair import Pair
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.unpack import opened
from relgloss_view.quality.backends import open_renderer

SIZE = (64, 48)


@pytest.fixture(scope="module")
def renderer():
    with open_renderer() as one:
        yield one


def paper(test: Sample | None = None, **setup: object) -> SceneFile:
    """A pair of papers with smooth silhouettes, dither and grain of one size at the eye."""
    plain = Setup(display=Display().for_the_eye())
    look = viewed_look()
    return SceneFile(
        test or Sample.built_in("matte-coated"),
        look.at(Setting(2.0, c=0.37)),
        dataclasses.replace(plain, **setup),
        Sample.built_in("cast-coated"),
        look.at(Setting(0.0, c=0.14)),
    )


def proof_of(made: Made) -> Proof:
    return Proof(made.content, (Message(made.settings),))


def assert_same_pixels(renderer, scene: SceneFile, made: Made) -> None:
    """The unpacked scene is drawn as the original is, to the last bit of every stage."""
    before = Pair.of(scene).drawn(renderer, SIZE)
    with opened(proof_of(made)) as one:
        after = one.pair().drawn(renderer, SIZE)
    for side, picture in before.items():
        assert np.array_equal(picture.rgb, after[side].rgb), side
        assert np.array_equal(picture.lab, after[side].lab), side
        assert (picture.c, picture.c_max) == (after[side].c, after[side].c_max), side


def test_an_unpacked_paper_is_drawn_as_the_original(renderer):
    scene = paper()
    made = content_of(scene, renderer, size=SIZE)
    assert_same_pixels(renderer, scene, made)
    # The negative control: one setting a little off is seen by the same comparison.
    other = dataclasses.replace(scene, look=scene.look.with_entries(c=0.4))
    with pytest.raises(AssertionError, match="test"):
        assert_same_pixels(renderer, other, made)


def test_lamps_display_and_colours_go_along_whole(renderer, tmp_path):
    lamp = tmp_path / "my lamp.csv"
    lamp.write_text("nm;power\n" + "".join(f"{nm};{1 + nm / 400}\n" for nm in range(380, 781, 5)))
    setup = paper().setup.with_entries("lamp", illuminant=str(lamp), radius_m=0.05, ambient=0.1)
    recoloured = Sample.built_in("uncoated").in_colour(Colour((50.0, 60.0, 20.0)))
    scene = paper(
        recoloured,
        lamp=setup.lamp,
        further_lamps=(FurtherLamp(-40.0, 20.0, share=0.5),),
        display=dataclasses.replace(setup.display, background_lstar=30.0, pixel_pitch_mm=0.2),
    )
    made = content_of(scene, renderer, size=SIZE)
    lamp.unlink()  # the other side has none of the designer's files
    assert made.settings.lamp.illuminant == "lamp.csv"
    assert str(tmp_path) not in str(made.content)
    with opened(proof_of(made)) as one:
        assert one.scene_file.sample.material == recoloured.material
        assert one.scene_file.setup.further_lamps == scene.setup.further_lamps
        assert one.scene_file.setup.display == scene.setup.display
    made_again = content_of(
        paper(recoloured), renderer, size=SIZE
    )  # of HP5: what a lost lamp would look like
    assert made_again.content["grid"] != made.content["grid"]


def test_a_pixel_reads_the_same_in_the_grid_and_in_the_picture(renderer):
    scene = paper()
    made = content_of(scene, renderer, size=SIZE)
    pictures = Pair.of(scene).drawn(renderer, SIZE)
    for side, picture in pictures.items():
        found = compare(made.content["grid"]["sides"][side], picture)
        # Rounded to 4 decimals: half a step in each of three coordinates, where dE2000 is at most
        # that of CIELAB, 0.9e-4.
        assert found.largest < 1e-4
        assert found.missed == 0
        assert found.points > 100
    # The negative control: a picture with a fifth more gloss is told from it.
    other = dataclasses.replace(scene, look=scene.look.with_entries(c=0.44))
    drawn = Pair.of(other).drawn(renderer, SIZE)["test"]
    assert compare(made.content["grid"]["sides"]["test"], drawn).largest > 0.5


def test_both_pictures_have_one_factor(renderer):
    scene = paper()
    bright = dataclasses.replace(scene, look=scene.look.with_entries(c=5.0))
    pictures = Pair.of(bright).drawn(renderer, SIZE)
    ratio = pictures["test"].c / pictures["reference"].c
    assert ratio == pytest.approx(5.0 / 0.14, rel=1e-12)
    assert pictures["test"].c <= pictures["test"].c_max * (1.0 + 1e-9)
    assert pictures["test"].c < 4.9


def test_meter_readings_are_those_of_the_materials(renderer):
    made = content_of(paper(), renderer, size=SIZE)
    for side, name in (("reference", "cast-coated"), ("test", "matte-coated")):
        material = Sample.built_in(name).material
        for reading in gloss_readings(material):
            if reading.key in SEEN:
                assert reading.key not in made.content["meter"]
                continue
            kept = made.content["meter"][reading.key]
            assert kept[side] == pytest.approx(reading.value, abs=1e-6)
            assert kept["name"] == reading.name


def test_stored_pictures_are_those_that_are_drawn(renderer):
    from PIL import Image

    scene = paper()
    made = content_of(scene, renderer, size=SIZE)
    assert sum(map(len, made.content["pictures"].values())) < 120_000
    for side, picture in Pair.of(scene).drawn(renderer, SIZE).items():
        data = base64.b64decode(made.content["pictures"][side])
        stored = np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), float)
        error = np.mean(np.abs(stored - picture.rgb))
        # WebP halves the resolution of colour; its mean error at this quality is a few steps of
        # 255. The negative control is the picture mirrored, which shows the lamp on the other side.
        assert error < 4.0
        assert np.mean(np.abs(stored - picture.rgb[:, ::-1])) > 2.0 * error


def test_the_display_is_described_in_words(renderer):
    scene = paper(display=Display(luminance_cd_m2=160.0, black_cd_m2=0.2))
    display = content_of(scene, renderer, size=SIZE).content["display"]
    assert display["words"] == "sRGB"
    assert display["sentences"] == ["Its white has 160 cd/m2.", "Its black has 0.2 cd/m2."]
    assert display["luminance_known"]
    assert display["white_xy"] == [0.3127, 0.329]
    unmeasured = display_words(Display())
    assert unmeasured["sentences"] == ["Nobody measured the luminance of its white and black."]


def test_a_scene_without_a_reference_is_refused():
    with pytest.raises(InputError, match="reference"):
        Pair.of(SceneFile(Sample.built_in("uncoated"), Look(c=0.3)))


def test_nothing_of_the_temporary_folder_is_left(renderer, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    made = content_of(paper(), renderer, size=SIZE)
    with opened(proof_of(made)) as one:
        assert Path(one.folder).is_relative_to(tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert str(tmp_path) not in str(made.content)
