"""Scene files and commands that hold a form; files of the older forms stay as they were."""

from __future__ import annotations

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.toml import entries
from relgloss_view.pack.shape import ANALYTIC, Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.options import with_settings
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.picture.scene.setup import Setup

OBJ = b"v 0 0 0\nv .1 0 0\nv 0 .1 0\nf 1 2 3\n"


@pytest.mark.parametrize("kind", ANALYTIC)
def test_older_forms_are_written_as_ever(kind):
    sizes = {"diameter_m": 0.085, "height_m": 0.1, "width_m": 0.085, "depth_m": 0.085}
    assert entries(Shape(kind)) == {"kind": kind, **sizes}


def test_forms_come_back_from_a_scene_file(tmp_path):
    (tmp_path / "pack.obj").write_bytes(OBJ)
    shapes = (
        Shape("can"),
        Shape("carton", height_m=0.2, edge_radius_m=0.002),
        Shape("bottle", profile_mm=((30, 0), (32, 100), (10, 150))),
        Shape("mesh", file=str(tmp_path / "pack.obj"), unit="m"),
    )
    for shape in shapes:
        content = SceneFile(Sample.built_in("uncoated"), Look(), Setup(shape=shape))
        write_scene_file(tmp_path / "s.toml", content)
        assert read_scene_file(tmp_path / "s.toml").setup.shape == shape
    assert 'file = "pack.obj"' in (tmp_path / "s.toml").read_text()
    (tmp_path / "pack.obj").unlink()
    with pytest.raises(InputError, match=r"s\.toml: .*pack\.obj"):
        read_scene_file(tmp_path / "s.toml")
    replaced: list[str] = []
    assert read_scene_file(tmp_path / "s.toml", replaced).setup.shape == Shape()
    assert "pack.obj" in replaced[0]


def test_sizes_follow_the_form():
    setup, _ = with_settings(Setup(), Look(), ["shape.kind=can"])
    assert setup.shape == Shape("can")
    setup = Setup().with_entries("shape", height_m=0.2).with_entries("shape", kind="bottle")
    assert setup.shape == Shape("bottle", height_m=0.2)
