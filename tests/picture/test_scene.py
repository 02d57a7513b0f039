"""Scenes: absolute anchors of the axes, and every parameter held to its declared range."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.view import FILL, View
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import load_scene, read_scene_file
from relgloss_view.picture.scene.setup import Eye, Lamp, polar_point

PARTS = (Shape, Lamp, Eye, Display, Look)


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "expected"),
    [
        (0, 0, (0, 0, 2)),
        (90, 0, (2, 0, 0)),
        (180, 0, (0, 0, -2)),
        (0, 90, (0, 2, 0)),
        (0, 30, (0, 1, np.sqrt(3))),
        (-90, -30, (-np.sqrt(3), -1, 0)),
    ],
)
def test_axes(azimuth_deg, elevation_deg, expected):
    np.testing.assert_allclose(polar_point(azimuth_deg, elevation_deg, 2.0), expected, atol=1e-12)


def numeric_fields():
    for part in PARTS:
        for field in dataclasses.fields(part):
            if "range" in field.metadata:
                yield part, field


@pytest.mark.parametrize(
    ("part", "field"),
    list(numeric_fields()),
    ids=lambda v: getattr(v, "name", getattr(v, "__name__", "")),
)
def test_every_number_has_a_range_that_holds(part, field):
    limits = field.metadata["range"]
    wrong = [limits.high * 2 + 1, float("nan"), float("inf"), -float("inf"), "1", True, 10**400, []]
    usual = part is Shape and field.default is None  # of the kind
    wrong += [limits.low - 1] + ([None] if "None" not in field.type and not usual else [])
    wrong += [0.5 * (limits.low + limits.high) + 0.25] if field.metadata.get("whole") else []
    for value in wrong:
        with pytest.raises(
            InputError, match=rf"{part.__name__.lower()}\.{field.name}: expected"
        ) as e:
            part(**{field.name: value})
        assert len(str(e.value)) < 200
    if field.name not in ("offset", "gain"):  # these two also have to agree with each other
        for value in (limits.low, limits.high):
            part(**{field.name: value})
    assert limits.meaning


@pytest.mark.parametrize(
    "values",
    [
        {"gain": 0.1, "offset": -0.5},
        {"gain": 0.5, "offset": -0.5},
        {"white_xy": (0.3, 0.0)},
        {"white_xy": (0.7, 0.7)},
        {"white_xy": 3},
        {"primaries_xy": ((0.1, 0.1), (0.2, 0.2), (0.3, 0.3))},
        {"primaries_xy": ((0.6, 0.3), (0.3, 0.6))},
        {"transfer": "hlg"},
        {"gamut": "none"},
    ],
)
def test_displays_that_can_not_be(values):
    with pytest.raises(InputError, match="display"):
        Display(transfer=values.pop("transfer", "gain-offset-gamma"), **values)


def test_c_is_asked_for_once():
    with pytest.raises(InputError, match="not both"):
        Look(c=1.0, c_fraction=1.0)


@pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
@pytest.mark.parametrize("eye", [Eye(), Eye(azimuth_deg=40.0, elevation_deg=50.0)])
@pytest.mark.parametrize("size", [(120, 120), (200, 100), (60, 150)])
def test_objects_are_framed(renderer, kind, eye, size):
    """The tighter direction is filled to its share, to within two pixels."""
    scene = Scene(materials.flat(), shape=Shape(kind=kind), eye=eye)
    seen = renderer.render(scene, Look(), size).on_object
    spans = [np.ptp(np.where(seen.any(axis=k))[0]) + 1 for k in (0, 1)]
    # The object is centred by its middle, so a perspective view may fill one side less.
    largest = max(spans[0] / size[0], spans[1] / size[1])
    assert FILL * 0.88 - 2 / min(size) < largest <= FILL + 2 / min(size)
    assert not seen[0].any()
    assert not seen[:, 0].any()


def test_views_start_from_float32():
    view = View.of(Scene(materials.flat(), eye=Eye(azimuth_deg=33.0, elevation_deg=7.0)), (64, 64))
    for vector in (view.eye_m, view.right, view.up, view.forward, np.array([view.pixel_step])):
        np.testing.assert_array_equal(vector, vector.astype(np.float32).astype(np.float64))


class TestSceneFile:
    def test_entries_that_are_left_open(self, tmp_path):
        file = tmp_path / "s.toml"
        file.write_text('[look]\nsamples = "auto"\nc = "auto"\n[eye]\nfield_of_view_deg = "auto"\n')
        scene, look = load_scene(file)
        assert look == Look(samples=None)
        assert scene.eye == Eye()
        file.write_text('[lamp]\ndistance_m = "auto"\n')
        with pytest.raises(InputError, match=r"lamp\.distance_m: expected"):
            load_scene(file)

    def test_a_pair_is_a_scene_of_its_sample(self, tmp_path):
        file = tmp_path / "s.toml"
        file.write_text(
            '[sample]\nname = "uncoated"\ntable = "measured/at home.csv"\n[look]\nseed = 1\n'
            '[reference]\nname = "art-coated"\n[reference.look]\nseed = 2\n'
            "[presentation]\nwhatever = [1, 2]\n"
        )
        scene, look = load_scene(file)
        assert scene.material.name.startswith("uncoated")
        assert look == Look(seed=1)
        content = read_scene_file(file)
        assert content.sample.table == str(tmp_path / "measured" / "at home.csv")
        assert content.reference.name == "art-coated"
        assert content.reference_look == Look(seed=2)
        assert content.presentation == {"whatever": [1, 2]}
        assert content.scene() == scene
