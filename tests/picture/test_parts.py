"""Files that are written in parts hold what they hold when written whole, to the last byte."""

import dataclasses

import numpy as np
import pytest

from relgloss_view.base.errors import RelglossError
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.operators.registry import make_operator
from relgloss_view.pack.shape import Shape
from relgloss_view.picture import stages
from relgloss_view.picture.frame import Extremes
from relgloss_view.picture.model import tone
from relgloss_view.picture.output import exr_parts
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye

pytest.importorskip("OpenEXR")
SIZE = (70, 50)
NAMES = ("diffuse", "specular", "lab", "light", "display", "normal", "tilted_normal", "point_m")
SMOOTH = Display(edges="smooth", dither="ordered")
ART = Scene(load_sample("art-coated"), display=SMOOTH)
CASES = {
    "smooth edges": (ART, Look(sigma_n_deg=1.0, samples=1)),
    "several samples": (ART, Look(sigma_n_deg=1.0, samples=2)),
    "grain at the eye": (ART, Look(sigma_n_deg=2.0, grain="eye", samples=1)),
    "grain on the surface": (
        dataclasses.replace(ART, shape=Shape("box"), eye=Eye(azimuth_deg=30.0)),
        Look(sigma_n_deg=2.0, grain="surface", samples=1),
    ),
    "far away": (
        dataclasses.replace(ART, shape=Shape("sphere"), eye=Eye(distance_m=300.0)),
        Look(c=1.0, samples=1),
    ),
}


@pytest.fixture(params=CASES)
def case(request):
    return CASES[request.param]


def files(frame, folder, monkeypatch, pixels, displayed=None):
    monkeypatch.setattr(stages, "PART_PIXELS", pixels)
    for name, bits in (("a.exr", 8), ("a.png", 16)):
        save_frame(frame, folder / name, "a command", bits=bits, displayed=displayed)
    return (folder / "a.exr").read_bytes(), (folder / "a.png").read_bytes()


def test_files_are_the_same_to_the_last_byte(renderer, case, tmp_path, monkeypatch):
    scene, look = case
    whole = files(renderer.render(scene, look, SIZE), tmp_path, monkeypatch, 1 << 20)
    before = renderer.draws["geometry"]
    other = renderer.render(scene, look, (8, 8))  # so that nothing is kept
    assert other.size == (8, 8)
    assert files(renderer.render(scene, look, SIZE), tmp_path, monkeypatch, 1) == whole
    assert renderer.draws["geometry"] == before + 4  # 50 rows in parts of 16
    seed = dataclasses.replace(look, seed=1, c=0.7)  # negative control
    assert files(renderer.render(scene, seed, SIZE), tmp_path, monkeypatch, 1) != whole


def test_of_the_reference(reference, tmp_path, monkeypatch):
    frames = [reference.render(*CASES["smooth edges"], SIZE) for _ in range(2)]
    whole = files(frames[0], tmp_path, monkeypatch, 1 << 20)
    assert files(frames[1], tmp_path, monkeypatch, 1) == whole


def test_of_an_operator(renderer, tmp_path, monkeypatch):
    frame = renderer.render(*CASES["smooth edges"], SIZE)
    displayed = make_operator("ward-histogram").draw(frame)
    whole = files(frame, tmp_path, monkeypatch, 1 << 20, displayed)
    assert files(frame, tmp_path, monkeypatch, 1, displayed) == whole


@pytest.mark.parametrize("backend", ["renderer", "reference"])
def test_every_stage_by_rows(backend, request):
    drawer = request.getfixturevalue(backend)
    frame, again = (drawer.render(*CASES["several samples"], size) for size in (SIZE, SIZE))
    for name in NAMES:
        whole = np.array(frame._fetch(name))
        for rows in (slice(0, 1), slice(7, 40), slice(49, 50), slice(0, 50)):
            np.testing.assert_array_equal(again.fetch(name, rows), whole[rows], err_msg=name)


def test_what_was_fetched_is_not_fetched_again(renderer, tmp_path, monkeypatch):
    frame = renderer.render(*CASES["smooth edges"], SIZE)
    for name in NAMES:
        getattr(frame, name)
    _ = frame.on_object, frame.edges, frame.clip_count
    renderer.release()
    monkeypatch.setattr(frame, "_fetch", None)
    files(frame, tmp_path, monkeypatch, 1)


def test_a_part_knows_its_neighbours(renderer, monkeypatch):
    monkeypatch.setattr(stages, "PART_PIXELS", 1)
    parts = list(stages.parts_of(renderer.render(*CASES["smooth edges"], SIZE)))
    assert [(p.first, p.rows.start, p.rows.stop) for p in parts] == [
        (0, 0, 17),
        (16, 15, 33),
        (32, 31, 49),
        (48, 47, 50),
    ]
    assert [p.display[p.own].shape[0] for p in parts] == [16, 16, 16, 2]


def test_extremes_of_parts_join_to_those_of_all():
    rng = np.random.default_rng(1)
    l_d, l_s = rng.uniform(0, 60, 200), rng.uniform(0, 40, 200)
    l_d[150], l_s[150] = l_d[20], l_s[20]
    joined = Extremes.over(l_d[:100], l_s[:100]).joined(Extremes.over(l_d[100:], l_s[100:]))
    assert joined == Extremes.over(l_d, l_s)
    assert Extremes.over(l_d[:100], l_s[:100]) != joined


def test_dither_goes_on_from_part_to_part():
    light, model = np.full((20, 9, 3), 0.2), DisplayModel.of(Display())
    shows = np.ones((20, 9), dtype=bool)
    whole = tone.digital_steps(light, model, shows)
    part = tone.digital_steps(light[:7], model, shows[:7], 13)
    np.testing.assert_array_equal(part, whole[:7])
    assert not np.array_equal(tone.digital_steps(light[:7], model, shows[:7]), part)


@pytest.mark.parametrize("data", [b"", b"PNG.....", exr_parts.MAGIC + b"\2\0\0\0channels\0chl"])
def test_a_file_that_is_no_exr_is_refused(data, tmp_path):
    (tmp_path / "a").write_bytes(data)
    with (
        open(tmp_path / "a", "rb") as file,
        pytest.raises(RelglossError, match="unexpected way"),
    ):
        exr_parts._header(file, (4, 4))
