"""The .glb of packs and materials, judged by Khronos's validator and by trimesh."""

from __future__ import annotations

import dataclasses
import io

import numpy as np
import pytest
import trimesh
from gltf_judges import parts_of, picture, rebuilt, validated
from PIL import Image

import relgloss_view as rg
from relgloss_view.base.resources import asset
from relgloss_view.exchange import ggx
from relgloss_view.exchange.formats import ExportOptions, format_of
from relgloss_view.exchange.gltf import glb, write
from relgloss_view.exchange.gltf_brdf import GltfSurface
from relgloss_view.exchange.gltf_forms import triangles_of
from relgloss_view.exchange.gltf_maps import encoded, image_file, linear_of, scale_of
from relgloss_view.exchange.gltf_refit import refit_gltf
from relgloss_view.pack.built_in import load_finish
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.shape import ANALYTIC, Shape

SMALL = 256  #: of textures, so that the tests are quick
ALL_FORMS = ("can", "bottle", "carton", "pouch", *ANALYTIC)


def plain(shape: Shape) -> Pack:
    """A pack without an artwork: kraft, which is refitted fast."""
    return Pack(shape.kind, shape, (Finish("board", "stock", load_finish("kraft"), "kraft"),))


@pytest.fixture(scope="module")
def can():
    return rg.read_pack("can")


@pytest.fixture(scope="module")
def can_glb(can):
    return glb(can, most_px=SMALL)


@pytest.fixture(scope="module")
def whole_can(can):
    """Of textures as fine as the artwork."""
    return parts_of(glb(can)[0])


def loaded(data: bytes) -> trimesh.Scene:
    return trimesh.load(io.BytesIO(data), file_type="glb")


def test_the_validator_finds_nothing_in_packs_forms_and_materials(can_glb, tmp_path):
    mesh_file = tmp_path / "jar.obj"
    mesh_file.write_text(trimesh.creation.cylinder(0.03, 0.1).export(file_type="obj"))
    files = {"can": can_glb[0]}
    for kind in ALL_FORMS:
        files[f"pack-{kind}"] = glb(plain(Shape(kind)))[0]
        files[f"material-{kind}"] = glb(load_finish("kraft"), shape=Shape(kind))[0]
    files["mesh"] = glb(plain(Shape("mesh", file=str(mesh_file))))[0]
    files["foil"] = glb(load_finish("cold-foil-gold"))[0]
    assert_valid(files, tmp_path)


@pytest.mark.slow
def test_the_validator_finds_nothing_in_whole_packs(whole_can, tmp_path):
    files = {name: glb(rg.read_pack(name))[0] for name in ("carton",)}
    assert_valid(files | {"can": rebuilt(*whole_can)}, tmp_path)


def assert_valid(files, tmp_path):
    paths = [tmp_path / f"{name}.glb" for name in files]
    for path, data in zip(paths, files.values(), strict=True):
        path.write_bytes(data)
    for path, issues in zip(paths, validated(*paths), strict=True):
        wrong = [m for m in issues["messages"] if m["severity"] <= 1]
        assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), (path.name, wrong[:5])


def test_the_validator_would_find_a_fault(can_glb, tmp_path):
    content, binary = parts_of(can_glb[0])
    content["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 1.5
    path = tmp_path / "wrong.glb"
    path.write_bytes(rebuilt(content, binary))
    (issues,) = validated(path)
    assert issues["numErrors"] == 1
    assert issues["messages"][0]["code"] == "VALUE_NOT_IN_RANGE"


@pytest.mark.parametrize("kind", ALL_FORMS)
def test_trimesh_finds_the_form_in_metres_upright_and_outside_out(kind):
    shape = Shape(kind)
    scene = loaded(glb(plain(shape))[0])
    extent = scene.bounds[1] - scene.bounds[0]
    # float32, and the seam of a round form may lie half a facet beside an axis: none here does
    assert extent == pytest.approx(2.0 * shape.half_extent_m(), abs=2e-7)
    assert scene.bounds[0][1] == pytest.approx(0.0, abs=1e-9)
    assert scene.bounds[0][0] == pytest.approx(-scene.bounds[1][0], abs=2e-7)
    for mesh in scene.geometry.values():
        corners = mesh.vertices[mesh.faces]
        facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normals = mesh.vertex_normals[mesh.faces].mean(axis=1)
        assert np.all(np.sum(facing * normals, axis=-1) > 0.0)
    if kind in ("can", "bottle", "carton", "cylinder", "sphere", "box"):
        whole = trimesh.util.concatenate(list(scene.geometry.values()))
        whole = trimesh.Trimesh(whole.vertices, whole.faces)
        assert whole.volume > 0.0


def test_a_sphere_and_a_cylinder_have_their_volume():
    # An inscribed polygon of N sides has sin(2 pi / N) / (2 pi / N) of the circle's area.
    share = np.sinc(2.0 / 160.0)
    for kind, exact in (
        ("cylinder", np.pi * 0.0425**2 * 0.1),
        ("sphere", 4.0 / 3.0 * np.pi * 0.0425**3),
    ):
        mesh = triangles_of(Shape(kind))
        volume = trimesh.Trimesh(mesh.points_m, mesh.triangles, process=False).volume
        # A sphere is cut short along its meridians too, by half as much at most.
        assert share**3 < volume / exact <= share * (1.0 + 1e-6)


def test_the_texture_lies_where_the_label_does(can_glb):
    """trimesh counts v upwards, as the label does; glTF downwards."""
    mesh = triangles_of(Shape("can"))
    body = loaded(can_glb[0]).geometry
    found = next(m for name, m in body.items() if m.visual.material.name == "body")
    size = np.array(mesh.label_size_m)
    number = mesh.parts.index("body")
    used = np.unique(mesh.triangles[mesh.part[mesh.triangles[:, 0]] == number])
    expected = mesh.label_m[used] / size + 0.5
    assert np.asarray(found.visual.uv) == pytest.approx(expected, abs=1e-6)
    lifted = found.vertices - mesh.points_m[used]
    assert lifted == pytest.approx(np.tile(lifted[0], (len(used), 1)), abs=1e-6)


def test_the_base_colour_is_the_artwork_pixel_by_pixel(can, whole_can):
    content, binary = whole_can
    body = next(m for m in content["materials"] if m["name"] == "body")
    core = body["pbrMetallicRoughness"]
    ours = picture(content, binary, core["baseColorTexture"]["index"]).astype(int)
    with Image.open(asset("packs", "can.png")) as image:
        theirs = np.asarray(image.convert("RGB")).astype(int)
    foil = picture(content, binary, core["metallicRoughnessTexture"]["index"])[..., 2]
    printed = foil == 0
    assert 0.9 < printed.mean() < 1.0
    apart = np.abs(ours - theirs).max(axis=-1)[printed]
    # The artwork is held in float16, whose steps are 1/2048: at most one step of 1/255.
    assert apart.max() <= 1
    # ... and one that lies upside down would differ widely.
    assert np.abs(ours[::-1] - theirs).max(axis=-1)[printed].mean() > 5.0
    # Foil has its own colour, a gold.
    red, green, blue = ours[foil == 255].mean(axis=0)
    assert red > green > blue + 50


def test_each_finish_keeps_its_factors_in_the_textures(can, whole_can):
    content, binary = whole_can
    body = next(m for m in content["materials"] if m["name"] == "body")
    core, coat = body["pbrMetallicRoughness"], body["extensions"]["KHR_materials_clearcoat"]
    maps = picture(content, binary, core["metallicRoughnessTexture"]["index"]) / 255.0
    coats = picture(content, binary, coat["clearcoatTexture"]["index"]) / 255.0
    finishes = content["asset"]["extras"]["relgloss"]["finishes"]
    surface = {one["name"]: one["surface"] for one in finishes}
    # Where the foil lies alone, and where nothing but ink does.
    with Image.open(asset("packs", "can-varnish.png")) as image:
        varnish = np.asarray(image.convert("L"))
    for name, here in (
        ("gold foil", (maps[..., 2] == 1.0) & (varnish == 0)),
        ("spot gloss", varnish == 255),
        ("matt ink", (maps[..., 2] == 0.0) & (varnish == 0)),
    ):
        assert here.sum() > 1000
        stated = surface[name]["pbrMetallicRoughness"]
        rough = core["roughnessFactor"] * maps[here][:, 1]
        # Factors are scaled so that each finish lies near a step: within 1 % of roughness.
        assert np.allclose(rough, stated["roughnessFactor"], rtol=0.01)
        its = surface[name].get("extensions", {}).get("KHR_materials_clearcoat", {})
        weight = coat["clearcoatFactor"] * coats[here][:, 0]
        assert np.allclose(weight, its.get("clearcoatFactor", 0.0), atol=0.003)


def test_the_same_pack_gives_the_same_bytes(can, can_glb):
    assert glb(can, most_px=SMALL)[0] == can_glb[0]


def test_no_texture_is_larger_than_asked_and_nothing_lies_outside_the_file(can_glb):
    content, binary = parts_of(can_glb[0])
    assert len(content["images"]) >= 3
    for texture in range(len(content["textures"])):
        assert max(picture(content, binary, texture).shape[:2]) == SMALL
    assert "uri" not in str(content)
    assert content["asset"]["version"] == "2.0"


def test_the_loss_of_each_finish_is_in_the_file_and_in_the_lines(can_glb):
    data, exported = can_glb
    content, _ = parts_of(data)
    own = content["asset"]["extras"]["relgloss"]
    assert set(own["losses"]) == set(exported.losses) == {f["name"] for f in own["finishes"]}
    assert "matt ink" in own["losses"]
    for name, loss in exported.losses.items():
        assert own["losses"][name]["de2000_p95"] == loss.de2000_p95
        heads = [line.split(": ")[0] for line in exported.lines if ": fitted with" in line]
        assert sum(name in head.split(", ") for head in heads) == 1
    assert "metal lid, metal base" in heads  # one silver, said once
    body = next(m for m in content["materials"] if m["name"] == "body")
    assert body["extras"]["relgloss"]["finishes"] == ["matt ink", "gold foil", "spot gloss"]


def test_a_turned_artwork_beside_its_place_is_drawn_so(can):
    """Half a girth to the right: the texture is the same one, moved round by half its width."""
    label = triangles_of(can.shape).label_size_m
    moved = rg.read_pack("can")
    half = Placement(offset_x_mm=500.0 * label[0])
    there = parts_of(glb(dataclasses.replace(moved, placement=half), most_px=SMALL)[0])
    here = parts_of(glb(can, most_px=SMALL)[0])
    first, second = (picture(*one, 0).astype(int) for one in (here, there))
    rolled = np.roll(first, SMALL // 2, axis=1)
    assert np.abs(second - rolled).mean() < 1.0
    assert np.abs(second - first).mean() > 5.0


def test_head_on_the_surface_is_the_closed_form():
    up = np.array([0.0, 0.0, 1.0])
    surface = GltfSurface((0.5, 0.5, 0.5), 0.0, 0.3, ior=1.5, specular=0.5)
    diffuse, specular = surface.evaluate(up, up)
    # D = 1 / (pi alpha^2), G / 4 = 1 / 4, F0 = 0.04 times the factor (appendix B)
    assert specular == pytest.approx(0.02 / (4.0 * np.pi * 0.3**4), rel=1e-12)
    assert diffuse == pytest.approx(0.98 * 0.5 / np.pi, rel=1e-12)
    coated = GltfSurface((0.5, 0.5, 0.5), 0.0, 0.3, specular=0.5, clearcoat=1.0)
    assert coated.evaluate(up, up)[0] == pytest.approx(0.96 * diffuse, rel=1e-12)


@pytest.mark.parametrize("roughness", [0.2, 0.5, 1.0])
def test_no_surface_reflects_more_than_it_gets(roughness):
    """A white metal reflects everything but what its facets shadow: sampled over the hemisphere."""
    rng = np.random.default_rng(1)
    u, v = rng.random((2, 200_000))
    # facets by their own density (Walter et al. 2007, eq. 35)
    alpha = roughness**2
    cos_h = np.sqrt((1.0 - u) / (1.0 + (alpha**2 - 1.0) * u))
    sin_h = np.sqrt(1.0 - cos_h**2)
    h = np.stack([sin_h * np.cos(2 * np.pi * v), sin_h * np.sin(2 * np.pi * v), cos_h], axis=-1)
    i = np.array([np.sin(0.7), 0.0, np.cos(0.7)])
    i_dot_h = h @ i
    o = 2.0 * i_dot_h[:, None] * h - i
    _, specular = GltfSurface((1.0, 1.0, 1.0), 1.0, roughness).evaluate(i, o)
    pdf = ggx.density(cos_h, alpha) * cos_h / (4.0 * np.abs(i_dot_h))
    values = np.where((o[:, 2] > 0) & (i_dot_h > 0), specular[:, 0] * o[:, 2] / pdf, 0.0)
    error = values.std() / np.sqrt(len(values))
    assert values.mean() < 1.0 + 4.0 * error
    if roughness == 0.2:  # narrow facets shadow next to nothing
        assert values.mean() > 0.95


def test_a_scale_puts_values_on_steps():
    for values in ([0.121, 0.4], [0.1, 0.45, 0.11], [1.0, 0.085]):
        scale = scale_of(np.array(values))
        steps = np.rint(255.0 * np.array(values) / scale)
        assert scale <= 1.0
        assert steps.max() <= 255
        assert steps * scale / 255.0 == pytest.approx(values, rel=0.03)


def test_srgb_of_all_steps_comes_back():
    steps = np.arange(256, dtype=np.uint8)
    back = encoded(np.array([linear_of(np.full(3, step))[0] for step in steps]))
    assert np.array_equal(back, steps)
    # The published value of middle gray (IEC 61966-2-1): 0.5 is 188 of 255.
    assert encoded(np.array([0.5, -1.0, 2.0])).tolist() == [188, 0, 255]


def test_a_large_photograph_becomes_a_jpeg(monkeypatch):
    from relgloss_view.exchange import gltf_maps

    noise = np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    assert image_file(noise, may_be_jpeg=True).startswith(b"\x89PNG")
    monkeypatch.setattr(gltf_maps, "MOST_PNG_BYTES", 1000)
    assert image_file(noise, may_be_jpeg=True).startswith(b"\xff\xd8\xff")
    assert image_file(noise).startswith(b"\x89PNG")  # factors are never rounded again


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["soft-touch", "kraft", "uncoated-label", "uncoated", "bare-board", "satin-varnish"],
)
def test_the_loss_of_broad_finishes_is_small(name):
    assert refit_gltf(load_finish(name)).loss.de2000_p95 <= 3.0


def test_write_makes_a_whole_file_by_its_ending(tmp_path):
    path = tmp_path / "kraft.glb"
    exported = format_of(path).write(load_finish("kraft"), path, ExportOptions())
    assert path.read_bytes()[:4] == b"glTF"
    (loss,) = exported.losses.values()
    assert loss.de2000_p95 < 3.0
    again = tmp_path / "sphere.glb"
    write(load_finish("kraft"), again, ExportOptions(shape=Shape("sphere", diameter_m=0.05)))
    extent = np.ptp(loaded(again.read_bytes()).bounds, axis=0)
    assert extent == pytest.approx([0.05, 0.05, 0.05], abs=1e-6)
