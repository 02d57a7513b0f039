from __future__ import annotations

import dataclasses
import sys

import numpy as np
import pytest

from relgloss_view.base.errors import RelglossError
from relgloss_view.bench.peers import mitsuba_runner, peers, scientist
from relgloss_view.bench.peers.mitsuba_runner import MitsubaPeer, llvm_libraries, open_peer
from relgloss_view.bench.speed import scenes
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look

SIZE = (96, 54)
SCENES = {chart_scene.name: chart_scene for chart_scene in scenes.chart_scenes(SIZE)}


@pytest.mark.parametrize("name", ["matte-coated az50", "uncoated az110", "art-coated az50"])
def test_the_plain_pipeline_draws_what_the_reference_draws(name):
    """Under a smooth lamp: a discharge lamp's lines fall between the plain one's 10 nm."""
    chart_scene = SCENES[name]
    lamp = dataclasses.replace(chart_scene.scene.lamp, illuminant="E")
    scene = dataclasses.replace(chart_scene.scene, lamp=lamp)
    picture = scientist.draw(scene, SIZE, 0.0, 0.5, 0)
    frame = ReferenceRenderer().render(scene, Look(c_fraction=0.5), SIZE)
    seen = frame.on_object & ~frame.out_of_gamut
    assert np.mean(seen) > 0.15
    off = 255.0 * np.abs(picture[seen] - frame.display[seen] / 255.0)
    assert np.percentile(off, 99.0) < 3.0
    assert np.all(picture[~frame.on_object] == 0.0)
    # Negative control: another c shows.
    other = scientist.draw(scene, SIZE, 0.0, 0.3, 0)
    assert np.max(np.abs(other - picture)) > 10.0 / 255.0


def test_its_grain_is_grain():
    chart_scene = SCENES["matte-coated az50"]
    smooth, grainy, again = (
        scientist.draw(chart_scene.scene, SIZE, sigma, 1.0, seed)
        for sigma, seed in ((0.0, 0), (2.0, 0), (2.0, 0))
    )
    assert np.array_equal(grainy, again)
    assert 0.002 < np.mean(np.abs(grainy - smooth)) < 0.2


def serving(monkeypatch, code):
    monkeypatch.setattr(mitsuba_runner, "program", lambda variant: [sys.executable, "-c", code])
    return MitsubaPeer("scalar_rgb", SCENES["matte-coated az50"], SIZE)


def test_a_peer_answers_with_its_own_times(monkeypatch):
    code = (
        "import sys, json; asked = json.loads(sys.stdin.readline()); print('noise', flush=True)\n"
        "print(json.dumps({'size': asked['size']}), flush=True)\n"
        "for k, line in enumerate(sys.stdin): print(json.dumps({'ms': 7.0 + k}), flush=True)"
    )
    peer = serving(monkeypatch, code)
    assert peer.facts == {"size": list(SIZE)}
    peer.warm()
    assert peer.frame(0) == 8.0
    peer.release()


@pytest.mark.parametrize(
    ("code", "said"),
    [
        ("import sys; sys.exit('no such variant')", "status 1 (no such variant)"),
        ("import os; os.abort()", "status -6"),
        ("print('{}', flush=True)", "status 0"),
    ],
    ids=["fault", "abort", "silence"],
)
def test_a_peer_that_dies_is_told_and_kills_nothing(monkeypatch, code, said):
    def start_and_ask():
        peer = serving(monkeypatch, code)
        try:
            peer.frame(0)
        finally:
            peer.release()

    with pytest.raises(RelglossError) as caught:
        start_and_ask()
    assert said in str(caught.value)


def test_a_peer_that_hangs_is_left(monkeypatch):
    monkeypatch.setattr(mitsuba_runner, "START_SECONDS", 0.3)
    with pytest.raises(RelglossError, match=r"no answer within 0\.3 s"):
        serving(monkeypatch, "import time; time.sleep(60)")


def test_mitsuba_not_installed_is_told(ctx, monkeypatch):
    monkeypatch.setattr(mitsuba_runner.importlib.util, "find_spec", lambda name: None)
    chart_scene = SCENES["matte-coated az50"]
    found = peers.time_mitsuba(ctx, chart_scene, SIZE, ("scalar_rgb",), 2, lambda share, text: None)
    assert found == [{"name": "mitsuba scalar_rgb", "fault": "mitsuba is not installed"}]


def test_llvm_libraries_are_tried_newest_first(monkeypatch, tmp_path):
    for name in ("libLLVM-14.so.1", "libLLVM-15.so", "libLLVM.so.19.1", "libLLVMnot.so"):
        (tmp_path / name).touch()
    monkeypatch.delenv(mitsuba_runner.LLVM_VARIABLE, raising=False)
    monkeypatch.setattr(mitsuba_runner, "LLVM_PLACES", (f"{tmp_path}/libLLVM[-.]*",))
    names = [path.rpartition("/")[2] for path in llvm_libraries()]
    assert names == ["libLLVM.so.19.1", "libLLVM-14.so.1", "libLLVM-15.so"]
    monkeypatch.setenv(mitsuba_runner.LLVM_VARIABLE, "/there/libLLVM.so")
    assert llvm_libraries() == ["/there/libLLVM.so"]
    monkeypatch.setattr(mitsuba_runner, "MitsubaPeer", None)
    monkeypatch.delenv(mitsuba_runner.LLVM_VARIABLE)
    monkeypatch.setattr(mitsuba_runner, "LLVM_PLACES", ())
    pytest.importorskip("mitsuba")
    with pytest.raises(RelglossError, match="no LLVM library"):
        open_peer("llvm_ad_rgb", SCENES["matte-coated az50"], SIZE)


def test_mitsuba_draws_the_same_cylinder(ctx):
    """The object covers as much of its picture as of ours, and takes turns with it."""
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    from relgloss_view.bench.peers.mitsuba_peer import world

    chart_scene = SCENES["matte-coated az50"]
    asked = mitsuba_runner.scene_for_mitsuba(chart_scene, SIZE)
    picture = np.asarray(mi.render(world(mi, asked), spp=4))
    ours = ReferenceRenderer().render(
        chart_scene.scene, dataclasses.replace(chart_scene.look, c=1.0), SIZE
    )
    lit = ours.diffuse[..., 1] > 1e-3
    # A pixel of it is the mean of four random places, ours its centre: the silhouettes differ.
    assert np.mean((picture.max(axis=-1) > 0.0) != lit) < 0.05
    found = peers.time_mitsuba(ctx, chart_scene, SIZE, ("scalar_rgb",), 2, lambda share, text: None)
    assert found[0]["frames"] == 2
    assert found[0]["ms"] > 0.0
    assert found[0]["ours"] > 0.0
    assert found[0]["auto"] > 0.0


def test_a_library_that_does_not_load_is_a_missing_peer(monkeypatch):
    """Whatever it raises: the rest of the chart is not lost for it."""

    def broken():
        raise RuntimeError("no plots today")

    monkeypatch.setattr(peers.scientist, "load", broken)
    found = peers.time_scientist(None, "uncoated", 1)
    assert found == {"name": peers.SCIENTIST, "fault": "RuntimeError: no plots today"}
