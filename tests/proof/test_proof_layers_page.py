"""Layers and meshes in the page: every number that Python has, bit for bit."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest
from browsers import call_array, open_page
from pack_pages import FINISHES, carried, make_pack
from PIL import Image

from relgloss_view.pack.forms import mesh_of
from relgloss_view.pack.layers import layers_of
from relgloss_view.pack.shape import Shape
from relgloss_view.proof.layers_drawing import is_plain_png, layers_drawing
from relgloss_view.proof.mesh_drawing import mesh_drawing
from relgloss_view.proof.page.build import bundle

PAGE = f"""<!DOCTYPE html><html><head><meta charset="utf-8"></head><body><script>
{bundle("layers.js", "mesh.js")}
</script></body></html>"""
LEVELS = """async (printed, files) => {
  const { levels } = await layersOf(printed, files);
  const parts = levels.flatMap(({ paint, channels }) => [new Uint8Array(paint.buffer), channels]);
  return new Uint8Array(await new Blob(parts).arrayBuffer());
}"""
MESH = """async (content) => {
  const { points, normals, label, part, triangles, outline_m } = await meshOf(content);
  const lists = [points, normals, label, part, triangles, Float64Array.from(outline_m.flat())];
  return new Uint8Array(await new Blob(lists).arrayBuffer());
}"""
THREE = (*FINISHES, ("varnish", "matt-varnish", "small.png", "invert = true"))
CASES = {
    "rgb": {"size": (201, 134), "finishes": THREE},
    "rgba": {"mode": "RGBA", "size": (64, 31)},
    "gray": {"mode": "L", "size": (37, 64), "finishes": ()},
    "gray with alpha": {"mode": "LA", "size": (1, 37)},
    "palette": {"mode": "P", "size": (101, 33)},
    "black and white": {"mode": "1", "size": (101, 7), "finishes": ()},
    "measured 45/0": {"size": (77, 53), "more": 'measured = "45-0"', "finishes": THREE},
    "one pixel": {"size": (1, 1), "finishes": ()},
}


def levels_of(browser, folder, pack, files=None):
    """What the page makes of a pack's layers, and what Python has: bytes, level by level."""
    layers = layers_of(pack)
    printed = json.loads(json.dumps(layers_drawing(pack, layers)))
    made = call_array(browser, LEVELS, printed, files or carried(folder)).tobytes()
    wanted = b"".join(paint.tobytes() + shares.tobytes() for paint, shares in layers.levels)
    return made, wanted, printed


def small_mask(folder):
    """A mask of another size than the artwork."""
    folder.mkdir(exist_ok=True)
    values = np.random.default_rng(5).integers(0, 256, (21, 40)).astype(np.uint8)
    Image.fromarray(values).save(folder / "small.png")


def test_levels_are_those_of_python(chromium_sw, tmp_path):
    open_page(chromium_sw, PAGE)
    for name, entries in CASES.items():
        folder = tmp_path / name.replace("/", "-")
        small_mask(folder)
        pack = make_pack(folder, "can", **entries)
        made, wanted, printed = levels_of(chromium_sw, folder, pack)
        assert "file" in printed["paint"], name
        assert made == wanted, name


def test_other_samples_are_found(chromium_sw, tmp_path):
    """The control: a sample that is off by one, and a mask's step, are in the levels."""
    open_page(chromium_sw, PAGE)
    pack = make_pack(tmp_path, "can", size=(40, 30))
    for name, at in (("art.png", (3, 5)), ("foil.png", (15, 20))):
        files = carried(tmp_path)
        picture = np.array(Image.open(tmp_path / name))
        picture[at] = picture[at] - 1
        Image.fromarray(picture).save(tmp_path / "other.png")
        data = base64.b64encode((tmp_path / "other.png").read_bytes()).decode("ascii")
        files[name] = {"base64": data}
        made, wanted, _ = levels_of(chromium_sw, tmp_path, pack, files)
        assert len(made) == len(wanted), name
        assert made != wanted, name


def test_sixteen_bits_and_what_no_matrix_gives(chromium_sw, tmp_path):
    open_page(chromium_sw, PAGE)
    pack = make_pack(tmp_path, "can", size=(40, 30))
    wide = np.random.default_rng(2).integers(0, 65536, (30, 40)).astype(np.uint16)
    Image.fromarray(wide).save(tmp_path / "art.png")
    pack = make_pack_again(tmp_path)
    made, wanted, printed = levels_of(chromium_sw, tmp_path, pack)
    assert "file" in printed["paint"]
    assert made == wanted
    Image.fromarray(wide.astype(np.uint8)).save(tmp_path / "art.png", transparency=7)
    pack = make_pack_again(tmp_path)
    made, wanted, printed = levels_of(chromium_sw, tmp_path, pack)
    assert "values" in printed["paint"]  # a transparent gray: the page does not read it
    assert made == wanted


def make_pack_again(folder):
    """The pack of a folder whose artwork was written anew."""
    from relgloss_view.pack.pack_file import read_pack

    return read_pack(folder / "pack.toml")


def test_plain_png(tmp_path):
    gray = Image.fromarray(np.zeros((4, 4), np.uint8))
    gray.save(tmp_path / "plain.png")
    gray.save(tmp_path / "clear.png", transparency=0)
    gray.convert("P").save(tmp_path / "palette.png", transparency=0)
    gray.save(tmp_path / "other.jpg")
    plain = {path.name: is_plain_png(path.read_bytes()) for path in tmp_path.iterdir()}
    assert plain == {
        "plain.png": True, "clear.png": False, "palette.png": True, "other.jpg": False,
    }  # fmt: skip
    assert not is_plain_png(b"")


FORMS = {
    "can": Shape("can"),
    "bottle": Shape("bottle"),
    "profile": Shape("bottle", profile_mm=((0, 0), (30, 0), (32, 60), (12, 100), (0, 120))),
    "carton": Shape("carton"),
    "pouch": Shape("pouch"),
}


@pytest.mark.parametrize("name", FORMS)
def test_meshes_are_those_of_python(chromium_sw, name):
    mesh = mesh_of(FORMS[name])
    content = json.loads(json.dumps(mesh_drawing(mesh)))
    # A can has 28,019 points of eight numbers: as they are, 900 kB.
    assert len(json.dumps(content)) < (25_000 if "ring" in content else 90_000)
    open_page(chromium_sw, PAGE)
    made = call_array(chromium_sw, MESH, content).tobytes()
    wanted = (
        mesh.points_m.astype(np.float32), mesh.normals.astype(np.float32),
        mesh.label_m.astype(np.float32), mesh.part.astype(np.int32),
        mesh.triangles.astype(np.uint32),
    )  # fmt: skip
    at = 0
    for numbers in wanted:
        page = np.frombuffer(made, numbers.dtype, numbers.size, at).reshape(numbers.shape)
        np.testing.assert_array_equal(page, numbers)
        at += numbers.nbytes
    outline = np.frombuffer(made, np.float64, offset=at).reshape(-1, 3)
    for direction in np.random.default_rng(1).normal(size=(50, 3)):
        assert np.max(outline @ direction) == pytest.approx(
            np.max(mesh.outline_m @ direction), rel=1e-15
        )


def test_rings_that_are_none_come_as_columns():
    """The control: a can with one point moved is no longer made of rings."""
    mesh = mesh_of(FORMS["can"])
    points = mesh.points_m.copy()
    points[1000] *= 1.0 + 1e-12
    moved = type(mesh)(
        points, mesh.normals, mesh.label_m, mesh.part, mesh.triangles, parts=mesh.parts
    )
    assert "ring" in mesh_drawing(mesh)
    assert "columns" in mesh_drawing(moved)
