"""Packs in the window's state: placement by hand, finishes, files that another program edits."""

from __future__ import annotations

import dataclasses
import itertools
import math
import os
import time

import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.pack.built_in import load_finish
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.quick import quick_pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.drawing.arrangement import as_shown
from relgloss_view.viewer.drawing.mask_tints import ALPHA, TINTS, tinted
from relgloss_view.viewer.drawing.picking import label_place, pick
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.files.pack_edits import PackWatch, Poll, merged
from relgloss_view.viewer.files.plate_colours import PlateColours
from relgloss_view.viewer.files.scene_saving import save_scene
from relgloss_view.viewer.files.session_reading import SessionReading
from relgloss_view.viewer.state import matching, packs
from relgloss_view.viewer.state.command_line import snapshot_command
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.session import restore
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state

SHAPE = Shape("cylinder", diameter_m=0.066, height_m=0.115)
SIZE = (96, 128)
LONGEST_S = 120.0


def write_artwork(path, box=(200, 30, 30)):
    """A light label at 1 pixel a mm with a box over its middle, 27 mm wide and 35 mm high."""
    pixels = np.full((115, 207, 3), 230, np.uint8)
    pixels[40:75, 90:117] = box
    Image.fromarray(pixels).save(path, dpi=(25.4, 25.4))
    return path


def write_mask(path):
    pixels = np.zeros((115, 207), np.uint8)
    pixels[40:75, 90:117] = 255
    Image.fromarray(pixels).save(path)
    return path


@pytest.fixture
def pack(tmp_path):
    """An ink, and a varnish over the box alone."""
    made = packs.new_on_form(quick_pack(str(write_artwork(tmp_path / "a.png"))), SHAPE)
    mask = np.asarray(Image.open(write_mask(tmp_path / "m.png")))
    varnish = Finish(
        "Varnish", "varnish", load_finish("matt-varnish"), "matt-varnish", mask="m.png"
    )
    return dataclasses.replace(packs.added(made, varnish), masks={"m.png": mask})


@pytest.fixture
def state(pack):
    return State.initial().with_sample("test", Sample.of_pack(pack))


# --- the hand on the artwork ----------------------------------------------------------------------

PLACEMENTS = [
    Placement(),
    Placement(offset_x_mm=12.0, offset_y_mm=-5.0, turn_deg=33.0, scale=1.4),
    Placement(turn_deg=-120.0, scale=0.3),
]


@pytest.mark.parametrize("placement", PLACEMENTS)
def test_what_is_under_the_pointer_stays_there(placement):
    place = (7.0, 11.0)
    before = packs.artwork_place(placement, place)
    for after in (
        packs.turned(placement, 25.0, place),
        packs.scaled(placement, 1.7, place),
    ):
        np.testing.assert_allclose(packs.artwork_place(after, place), before, atol=1e-9)
        elsewhere = packs.artwork_place(after, (0.0, 0.0))
        assert math.dist(elsewhere, packs.artwork_place(placement, (0.0, 0.0))) > 0.1
    moved = packs.dragged(placement, place, (9.0, 10.0), None)
    np.testing.assert_allclose(packs.artwork_place(moved, (9.0, 10.0)), before, atol=1e-9)


def test_a_drag_across_the_seam_goes_the_short_way():
    girth = packs.girth_mm(SHAPE)
    assert girth == pytest.approx(math.pi * 66.0)
    moved = packs.dragged(Placement(), (0.5 * girth - 1.0, 0.0), (-0.5 * girth + 1.0, 3.0), girth)
    assert moved.offset_x_mm == pytest.approx(2.0)
    assert moved.offset_y_mm == pytest.approx(3.0)
    assert packs.girth_mm(Shape("carton")) is None or Shape("carton").kind == "carton"
    assert packs.girth_mm(Shape("plane")) is None


def test_turns_are_counter_clockwise():
    turned = packs.turned(Placement(), 90.0)
    np.testing.assert_allclose(packs.artwork_place(turned, (0.0, 5.0)), (5.0, 0.0), atol=1e-12)


# --- what is under a pixel ------------------------------------------------------------------------


def test_a_pixel_names_its_finish_and_its_place(state):
    scene = state.scene("test")
    middle = pick(scene, SIZE, (48.0, 64.0))
    assert middle.finish == "Varnish"
    assert sum(middle.shares.values()) == pytest.approx(1.0)
    assert middle.part == "side"
    assert abs(middle.label_mm[0]) < 0.01
    # sRGB 200, 30, 30 as Lab under D50 (Bradford), by colour-science 0.4.7.
    np.testing.assert_allclose(middle.lab, [44.03, 63.74, 47.04], atol=0.15)
    assert pick(scene, SIZE, (48.0, 30.0)).finish == "ink"
    assert pick(scene, SIZE, (2.0, 2.0)) is None
    assert label_place(scene, SIZE, (2.0, 2.0)) is None
    right = label_place(scene, SIZE, (60.0, 64.0))[0]
    assert right[0] > 5.0
    assert pick(State.initial().scene("test"), SIZE, (48.0, 64.0)) is None


def test_tints_lie_where_the_mask_does(state):
    scene = state.scene("test")
    pixels = tinted(scene, SIZE, frozenset({"Varnish"}))
    assert pixels.shape == (128, 96, 4)
    varnish = [one.name for one in scene.pack.finishes].index("Varnish")
    colour = [round(255 * v) for v in TINTS[varnish]]
    np.testing.assert_allclose(pixels[64, 48], [*colour, round(255 * ALPHA)], atol=1)
    assert pixels[30, 48, 3] == 0
    assert pixels[0, 0, 3] == 0
    assert tinted(scene, SIZE, frozenset({"ink"}))[30, 48, 3] > 100  # the control: the other one


# --- finishes -------------------------------------------------------------------------------------


def test_finishes_move_above_the_base(pack):
    more = packs.added(pack, dataclasses.replace(pack.finishes[-1], name="Top"))
    base, *others = (one.name for one in more.finishes)
    lowest = packs.moved(more, "Top", -9)
    assert [one.name for one in lowest.finishes] == [base, "Top", *others[:-1]]
    assert packs.moved(more, base, 3) == more
    assert packs.removed(more, "Top") == pack
    with pytest.raises(InputError, match="base"):
        packs.removed(more, base)
    assert packs.renamed(pack, "Varnish", "Spot").finishes[-1].name == "Spot"
    with pytest.raises(InputError, match="name"):
        packs.renamed(pack, "Varnish", " ")
    with pytest.raises(InputError, match="same name"):
        packs.renamed(pack, "Varnish", base)


def test_another_form_keeps_the_finishes_that_it_can_have(tmp_path):
    on_can = quick_pack(str(write_artwork(tmp_path / "a.png")), "can")
    assert {one.mask for one in on_can.finishes} >= {"part:lid"}
    on_cylinder = packs.on_form(on_can, SHAPE)
    assert not any(one.mask.startswith("part:") for one in on_cylinder.finishes)
    again = packs.on_form(on_cylinder, Shape("can"))
    assert [one.name for one in again.finishes] == [one.name for one in on_can.finishes]
    own = packs.on_form(packs.renamed(on_can, on_can.base.name, "My ink"), SHAPE)
    assert [one.name for one in own.finishes] == ["My ink"]


def test_a_match_sets_every_finish_and_one_c(state):
    matched = matching.rematched(state)
    finishes = packs.pack_of(matched, "test").finishes
    assert all(one.sigma_n_deg is not None for one in finishes)
    reference = matching.reference_of(state)
    alone = [matching.matched(reference, one.material, one.sigma_n_deg) for one in finishes]
    assert finishes[0].k == pytest.approx(1.0)
    assert finishes[-1].k > 1.5  # its lobe is broad, so that the same c would show less
    assert alone[0].test_c == pytest.approx(matched.test.look.c, rel=0.2)
    assert matched.match.test_c == matched.test.look.c
    assert matching.share_of_match(matched, "test") == pytest.approx(1.0)


def test_the_pair_is_at_one_scale(state):
    """A pack and its reference of another form are drawn at one scale; equal forms as ever."""
    shown = as_shown(state, SIZE, None)
    assert shown.setup.eye.field_of_view_deg is not None
    same = State.initial()
    assert as_shown(same, SIZE, None) == same


# --- files ----------------------------------------------------------------------------------------


def test_a_state_with_a_pack_comes_back(state, tmp_path):
    state = state.with_part("shape", height_m=0.12)
    pack = packs.pack_of(state, "test")
    pack = dataclasses.replace(pack, masks={}, finishes=pack.finishes[:1])
    state = packs.with_pack(state, "test", pack.with_finish(pack.base.name, sigma_n_deg=1.5))
    save_state(tmp_path / "s.toml", state)
    again = load_state(tmp_path / "s.toml")
    assert again.setup == state.setup
    got = packs.pack_of(again, "test")
    assert got.finishes == packs.pack_of(state, "test").finishes
    assert got.shape == SHAPE
    line = snapshot_command(state, "test", (64, 64), "a.png")
    assert "--artwork" in line
    assert "sigma_n_deg=1.5" in line


def test_a_saved_scene_has_each_material_and_names_the_artwork(state, tmp_path):
    """A material in no file is written beside the scene; files in other folders are named."""
    pack = packs.pack_of(state, "test")
    paper = load_finish("uncoated")
    pack = dataclasses.replace(pack, masks={}).with_finish("Varnish", mask="everywhere")
    state = packs.with_pack(state, "test", pack.with_finish("Varnish", material=paper, source=""))
    folder = tmp_path / "kept"
    folder.mkdir()
    saved = save_scene(folder / "s.toml", state)
    assert len(saved.beside) == 1
    assert saved.elsewhere == (tmp_path / "a.png",)
    again = packs.pack_of(load_state(folder / "s.toml"), "test")
    assert again.finish("Varnish").material == paper
    plain = save_scene(folder / "t.toml", packs.with_pack(state, "test", pack))
    assert plain.beside == ()  # the control: built-in finishes need no file


def opened(path):
    job = OpenJob(path, lambda: None)
    assert job.wait(60.0)
    assert job.fault is None
    return job.result


def test_artwork_opens_on_the_present_pack_or_a_new_one(state, tmp_path):
    other = opened(write_artwork(tmp_path / "b.png", box=(0, 0, 90)))
    placed = Placement(offset_x_mm=3.0)
    pack = dataclasses.replace(packs.pack_of(state, "test"), placement=placed)
    after = packs.pack_of(other.applied(packs.with_pack(state, "test", pack), "test"), "test")
    assert after.artwork is other.artwork.artwork
    assert after.placement == placed
    assert after.finishes == pack.finishes
    fresh = other.applied(State.initial().placed(shape=SHAPE), "test")
    assert packs.pack_of(fresh, "test").shape == SHAPE
    assert packs.pack_of(fresh, "reference") is None
    assert fresh.setup.shape == SHAPE


def test_a_sample_becomes_the_material_of_the_finish(state):
    from relgloss_view.base.resources import asset

    paper = opened(asset("materials", "uncoated.json"))
    changed = packs.pack_of(paper.applied(state, "test", "Varnish"), "test")
    assert changed.finish("Varnish").material == paper.sample.material
    assert changed.artwork is packs.pack_of(state, "test").artwork
    assert packs.pack_of(paper.applied(state, "test"), "test") is None


# --- files that are edited elsewhere --------------------------------------------------------------


def looked(watch, model, until, times=None):
    """Let looks and frames pass until something holds; so many, or for as long as it takes."""
    end_s = time.monotonic() + LONGEST_S
    looks = itertools.count() if times is None else range(times)
    for _ in looks:
        watch.poll.look()
        watch.each_frame()
        if until():
            return True
        if time.monotonic() > end_s:
            break
        time.sleep(0.02)
    return False


@pytest.fixture
def watched(state):
    model = Model(state)
    watch = PackWatch(model, lambda: None)
    watch.poll._over.set()  # looks by hand
    return model, watch


def test_artwork_that_is_edited_is_read_again(watched, tmp_path):
    model, watch = watched
    model.set_finish("test", "Varnish", k=0.4)
    before = model.pack("test").artwork
    assert not looked(watch, model, lambda: model.pack("test").artwork is not before, times=5)
    path = write_artwork(tmp_path / "a.png", box=(10, 120, 10))
    os.utime(path, ns=(1, before.stamp[0] + 10**9))
    assert looked(watch, model, lambda: model.pack("test").artwork is not before)
    assert model.pack("test").finish("Varnish").k == 0.4
    assert pick(model.state.scene("test"), SIZE, (48.0, 64.0)).lab[1] < -20.0
    model.history.undo()
    assert model.pack("test").artwork is not before  # undo never brings an old file back
    assert model.pack("test").finish("Varnish").k == 1.0


def test_a_broken_file_keeps_the_last_good_one(watched, tmp_path):
    model, watch = watched
    before = model.pack("test").artwork
    assert not looked(watch, model, lambda: False, times=3)
    whole = (tmp_path / "a.png").read_bytes()
    (tmp_path / "a.png").write_bytes(whole[: len(whole) // 3])
    assert looked(watch, model, lambda: bool(model.notes))
    assert model.notes[-1].fault
    assert "last good one" in model.notes[-1].text
    assert model.pack("test").artwork is before
    assert not looked(watch, model, lambda: len(model.notes) > 1, times=5)  # once


def test_a_look_waits_until_a_file_is_whole(tmp_path):
    path = tmp_path / "growing"
    path.write_bytes(b"a")
    poll = Poll(lambda: None)
    poll._over.set()
    poll.watch((str(path),))
    poll.look()
    assert poll.whole(str(path)) is None
    path.write_bytes(b"ab")
    poll.look()
    assert poll.whole(str(path)) is None
    poll.look()
    assert poll.whole(str(path))[1] == 2
    path.unlink()
    poll.look()
    assert poll.whole(str(path))[1] == 2


def test_edits_of_the_file_and_of_the_window_are_merged(pack):
    window = pack.with_finish("Varnish", k=0.3)
    window = dataclasses.replace(window, placement=Placement(offset_x_mm=4.0))
    base = pack.base.name
    file = pack.with_finish("Varnish", sigma_n_deg=2.0, k=5.0).with_finish(base, k=0.8)
    file = dataclasses.replace(file, colour="spectral")
    both = merged(pack, file, window)
    assert (both.finish("Varnish").k, both.finish("Varnish").sigma_n_deg) == (0.3, 2.0)
    assert both.finish(base).k == 0.8
    assert (both.placement.offset_x_mm, both.colour) == (4.0, "spectral")
    added = packs.added(pack, dataclasses.replace(pack.finishes[-1], name="Mine"))
    gone = dataclasses.replace(pack, finishes=pack.finishes[:1])
    assert [one.name for one in merged(pack, gone, added).finishes] == [base, "Mine"]
    assert [one.name for one in merged(pack, pack, gone).finishes] == [base]


def test_packs_with_other_masks_differ_without_a_fault(pack):
    other = dataclasses.replace(pack, masks={"m.png": pack.masks["m.png"].copy()})
    assert other != pack
    assert dataclasses.replace(pack) == pack
    assert isinstance(hash(pack), int)
    assert isinstance(other, Pack)


def test_a_session_shows_before_its_pack_is_read(state, tmp_path):
    """What was changed meanwhile stays, and undo never brings the sample in its place back."""
    path = tmp_path / "session.toml"
    pack = packs.pack_of(state, "test")
    pack = dataclasses.replace(pack, masks={}, finishes=pack.finishes[:1])
    save_state(path, packs.with_pack(state, "test", pack))
    state = load_state(path)
    found = restore(path)
    assert dict(found.coming) == {"test": "a.png"}
    assert packs.pack_of(found.state, "test") is None
    model = Model(found.state)
    reading = SessionReading(model, path, found.coming)
    assert model.awaited("test") == "a.png"
    assert not model.awaited("reference")
    model.set_look("test", sigma_n_deg=1.75)
    reading.take(reading.read(lambda share, text: None))
    assert not model.awaited("test")
    assert packs.pack_of(model.state, "test") == packs.pack_of(state, "test")
    assert model.state.test.look.sigma_n_deg == 1.75
    assert model.state.setup == state.setup
    model.history.undo()
    assert model.state == state
    other = Model(found.state)  # the control: a sample that was chosen meanwhile stays
    reading = SessionReading(other, path, found.coming)
    other.set_sample("test", Sample.built_in("uncoated"))
    assert not other.awaited("test")
    reading.take(reading.read(lambda share, text: None))
    assert packs.pack_of(other.state, "test") is None


def test_what_was_opened_is_prepared_in_its_thread(tmp_path):
    made = []
    job = OpenJob(write_artwork(tmp_path / "b.png"), lambda: None, made.append)
    assert job.wait(60.0)
    assert made == [job.result]
    fails = OpenJob(tmp_path / "no.png", lambda: None, made.append)
    assert fails.wait(60.0)
    assert fails.fault is not None
    assert len(made) == 1


def test_undo_holds_no_more_artworks_than_memory_allows(pack, monkeypatch):
    states = [State.initial().with_sample("test", Sample.of_pack(pack))]
    history = Model(states[0]).history
    for k in range(4):
        artwork = dataclasses.replace(pack.artwork, width_mm=100.0 + k)
        one = dataclasses.replace(pack, artwork=artwork)
        history.change(packs.with_pack(history.state, "test", one))
        history.change(history.state.with_look("test", seed=k + 1))
    history.forget(packs.within_memory)
    assert len(history._past) == 8  # the control: small ones all stay
    monkeypatch.setattr(packs, "MOST_ARTWORK_BYTES", 2.5 * pack.artwork.xyz.nbytes)
    history.forget(packs.within_memory)
    assert len(history._past) == 3  # of two artworks, with two steps each
    assert packs.pack_of(history._past[0], "test").artwork.width_mm == 102.0


def test_a_plate_becomes_a_finish_below_the_varnishes(pack):
    plates = {
        "Lack 1": np.full((115, 207), 255, np.uint8),
        "CutContour": np.zeros((1, 1), np.uint8),
    }
    pack = dataclasses.replace(pack, artwork=dataclasses.replace(pack.artwork, plates=plates))
    assert packs.free_plates(pack) == ("Lack 1",)
    foil, name = packs.with_plate(pack, "Lack 1", "cold-foil-gold")
    assert (name, foil.finish(name).kind) == ("Lack 1", "foil")
    assert [one.name for one in foil.finishes][-2:] == ["Lack 1", "Varnish"]
    assert packs.free_plates(foil) == ()
    folded = foil.with_finish("Lack 1", mask="plate:lack1")  # as masks name it, so is it tied
    assert (packs.free_plates(folded), packs.missing_plates(folded)) == ((), ())
    other = foil.with_finish("Lack 1", mask="plate:Lack 2")  # the control
    assert (packs.free_plates(other), packs.missing_plates(other)) == (("Lack 1",), ("Lack 2",))
    varnish, _ = packs.with_plate(pack, "Lack 1", "soft-touch")
    assert varnish.finishes[-1].name == "Lack 1"


def test_a_plate_that_becomes_a_finish_loses_its_colour_and_undo_gives_it_back(tmp_path):
    """The artwork is read again in the background, for the steps that need it alone."""
    path = write_artwork(tmp_path / "a.png")
    pack = quick_pack(str(path))
    plates = {"VP7": np.full((115, 207), 255, np.uint8)}
    inked = dataclasses.replace(pack.artwork, plates=plates, coloured=frozenset({"VP7"}))
    bare = dataclasses.replace(inked, coloured=frozenset(), finish_plates=frozenset({"VP7"}))
    read = []

    def open_artwork(file, given, folder, progress):
        read.append(given["finish_plates"])
        return bare if "VP7" in given["finish_plates"] else inked

    pack = dataclasses.replace(pack, artwork=inked)
    model = Model(State.initial().with_sample("test", Sample.of_pack(pack)))
    colours = PlateColours(model, lambda: None)

    def settled():
        end_s = time.monotonic() + LONGEST_S
        while time.monotonic() < end_s:
            colours.each_frame()
            if not colours._worker.busy:
                return model.pack("test").artwork
            time.sleep(0.01)
        raise AssertionError("it never ends")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("relgloss_view.pack.pack_file.open_artwork", open_artwork)
        assert settled() is inked  # the control: no finish names it
        made, name = packs.with_plate(pack, "VP7", "matt-varnish")
        model.set_pack("test", made)
        assert settled() is bare
        assert "VP7" in model.notes[-1].text
        model.history.undo()
        assert settled() is inked
        model.history.redo()
        assert settled() is bare
        assert read == [("VP7",)]  # undo and redo read nothing
        model.set_finish("test", name, mask="everywhere")
        assert settled() is inked
        assert read == [("VP7",), ()]


def test_an_artwork_that_is_gone_keeps_its_colours(tmp_path):
    pack = quick_pack(str(write_artwork(tmp_path / "a.png")))
    plates = {"VP7": np.full((115, 207), 255, np.uint8)}
    inked = dataclasses.replace(
        pack.artwork, plates=plates, coloured=frozenset({"VP7"}), file=str(tmp_path / "gone.pdf")
    )
    made, _ = packs.with_plate(dataclasses.replace(pack, artwork=inked), "VP7", "matt-varnish")
    model = Model(State.initial().with_sample("test", Sample.of_pack(made)))
    colours = PlateColours(model, lambda: None)
    end_s = time.monotonic() + LONGEST_S
    more = 10  # frames after the first fault, which would tell of it again
    while more and time.monotonic() < end_s:
        colours.each_frame()
        more -= any(note.fault for note in model.notes) and not colours._worker.busy
        time.sleep(0.01)
    assert [note.fault for note in model.notes].count(True) == 1  # once
    assert model.pack("test").artwork is inked
