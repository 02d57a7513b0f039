"""Mesh files: what trimesh writes and reads, scanned packs, and damaged and hostile files."""

from __future__ import annotations

import base64
import json
import os
import struct
from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.pack.forms import mesh_of
from relgloss_view.pack.forms.mesh_files import MESH_SUFFIXES, read_mesh
from relgloss_view.pack.shape import Shape

TRIANGLE = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]], "<f4")


def glb(content, binary=None):
    binary = TRIANGLE.tobytes() if binary is None else binary
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    parts = struct.pack("<I", len(text)) + b"JSON" + text
    parts += struct.pack("<I", len(binary)) + b"BIN\0" + binary
    return b"glTF" + struct.pack("<II", 2, 12 + len(parts)) + parts


def document(**changes):
    return {
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], **changes,
    }  # fmt: skip


def with_buffer(uri):
    return json.dumps(document(buffers=[{"byteLength": 36, "uri": uri}])).encode()


PLY = (
    b"ply\nformat %s 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face %d\nproperty list uchar int vertex_indices\nend_header\n"
)
BINARY = b"binary_little_endian"
POLYGONS = PLY.replace(b"%s", BINARY).replace(b"vertex 3", b"vertex 4").replace(b"int", b"uchar")
THREE = b"v 0 0 0\nv .1 0 0\nv 0 .1 0\n"
#: Files that make no mesh, with words of the one line that each gives.
REFUSED = {
    "cyclic.glb": (glb(document(nodes=[{"mesh": 0, "children": [0]}])), "within itself"),
    "count.glb": (
        glb(document(accessors=[{"componentType": 5126, "count": 10**8, "type": "VEC3"}])),
        "more than 500000 triangles",
    ),
    "long.glb": (
        glb(document(accessors=[{"bufferView": 0, "componentType": 5126, "count": 4,
                                 "type": "VEC3"}])), "shorter than its numbers"),
    "nan.glb": (glb(document(), np.full(9, np.nan, "<f4").tobytes()), "not a finite number"),
    "zero.glb": (glb(document(nodes=[{"mesh": 0, "scale": [0, 0, 0]}])), "longest side is 0 m"),
    "short.glb": (glb(document())[:-20], "ends before"),
    "coded.gltf": (with_buffer("data:application/octet-stream;base64,@@"), "broken base64"),
    "up.gltf": (with_buffer("../secret.bin"), "not in its folder"),
    "coded-up.gltf": (with_buffer("%2e%2e/secret.bin"), "not in its folder"),
    "root.gltf": (with_buffer("/etc/passwd"), "not in its folder"),
    "url.gltf": (with_buffer("http://example.org/a.bin"), "not in its folder"),
    "deep.gltf": (b"[" * 100_000, "nested too deeply"),
    "draco.gltf": (
        json.dumps(document(extensionsRequired=["KHR_draco_mesh_compression"])).encode(),
        "KHR_draco_mesh_compression"),
    "nodes.gltf": (json.dumps({"nodes": 5}).encode(), "expected a list"),
    "none.obj": (THREE, "no triangles"),
    "range.obj": (THREE + b"f 1 2 9\n", "names point 9 of 3"),
    "before.obj": (THREE + b"f -4 -2 -1\n", "before the first"),
    "nan.obj": (THREE + b"v nan 0 0\nf 1 2 4\n", "not a finite number"),
    "flat.obj": (THREE + b"v .2 0 0\nf 1 2 4\nf 1 1 2\n", "has an area"),
    "word.obj": (THREE + b"f 1 2 x\n", "whole numbers"),
    "tiny.obj": (b"v 0 0 0\nv 1e-8 0 0\nv 0 1e-8 0\nf 1 2 3\n", "state the unit"),
    "faces.obj": (THREE + b"f 1 2 3\n" * 600_000, "more than 500000 triangles"),
    "lines.obj": (b"\n" * 3_000_000, "lines"),
    "count.ply": (PLY % (b"binary_little_endian", 10**8), "more than 500000 triangles"),
    "short.ply": (PLY % (b"binary_little_endian", 9) + TRIANGLE.tobytes(), "ends before"),
    "corners.ply": (
        POLYGONS % 3000 + bytes(48) + (bytes([255]) + bytes(k % 4 for k in range(255))) * 3000,
        "more than 500000 triangles"),
    "words.ply": (POLYGONS.replace(BINARY, b"ascii") % 1 + b" " * 25_000_000, "numbers"),
    "header.ply": (b"ply\nelement vertex x\nend_header\n", "no line of PLY"),
    "count.stl": (b"x" * 80 + struct.pack("<I", 10**8) + bytes(50), "ends before"),
    "count-of-text.stl": (b"solid\nfacet\n" + b"Vertex 0 0 0\n" * 1_500_001, "more than 500000"),
    "empty.glb": (b"", "no header"),
    "a.txt": (b"", "expected a mesh"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_a_file_that_makes_no_mesh_gives_one_line(tmp_path, name):
    data, words = REFUSED[name]
    (tmp_path / "secret.bin").write_bytes(TRIANGLE.tobytes())
    folder = tmp_path / "here"
    folder.mkdir()
    (folder / name).write_bytes(data)
    with pytest.raises(InputError) as caught:
        read_mesh(folder / name)
    line = str(caught.value)
    assert line.startswith(str(folder / name))
    assert words in line
    assert "\n" not in line


def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    (tmp_path / "secret.bin").write_bytes(TRIANGLE.tobytes())
    folder = tmp_path / "here"
    folder.mkdir()
    (folder / "a.gltf").write_bytes(with_buffer("a.bin"))
    try:
        (folder / "a.bin").symlink_to(tmp_path / "secret.bin")
    except OSError:
        pytest.skip("no links on this system")
    with pytest.raises(InputError, match="not in its folder"):
        read_mesh(folder / "a.gltf")
    (folder / "a.bin").unlink()
    (folder / "a.bin").write_bytes(TRIANGLE.tobytes())
    first = read_mesh(folder / "a.gltf")
    assert len(first.triangles) == 1
    assert read_mesh(folder / "a.gltf") is first
    (folder / "a.bin").write_bytes((2.0 * TRIANGLE).tobytes())  # its buffer alone is another
    os.utime(folder / "a.bin", ns=(1, 1))
    assert read_mesh(folder / "a.gltf").half_extent_m[0] == pytest.approx(0.1)


def test_a_mesh_is_read_once_until_its_file_changes(tmp_path):
    file = tmp_path / "a.glb"
    file.write_bytes(glb(document()))
    first = mesh_of(Shape("mesh", file=str(file)))
    assert mesh_of(Shape("mesh", file=str(file))) is first
    file.write_bytes(glb(document(nodes=[{"mesh": 0, "scale": [2, 2, 2]}])))
    os.utime(file, ns=(1, 1))
    second = mesh_of(Shape("mesh", file=str(file)))
    np.testing.assert_allclose(second.half_extent_m, 2.0 * first.half_extent_m, rtol=1e-6)


def test_a_mirroring_node_keeps_the_outside_out(tmp_path):
    box = mesh_of(Shape("carton", edge_radius_m=0.0))
    points = box.points_m.astype("<f4").tobytes()
    indices = box.triangles.astype("<u4").tobytes()
    content = document(
        buffers=[{"byteLength": len(points + indices)}],
        bufferViews=[{"buffer": 0, "byteLength": len(points)},
                     {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)}],
        accessors=[{"bufferView": 0, "componentType": 5126, "count": 24, "type": "VEC3"},
                   {"bufferView": 1, "componentType": 5125, "count": 36, "type": "SCALAR"}],
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        nodes=[{"children": [1], "scale": [-1, 1, 1]}, {"mesh": 0, "translation": [1, 2, 3]}],
    )  # fmt: skip
    (tmp_path / "a.glb").write_bytes(glb(content, points + indices))
    mesh = read_mesh(tmp_path / "a.glb")
    np.testing.assert_allclose(2.0 * mesh.half_extent_m, [0.07, 0.16, 0.04], rtol=1e-6)
    assert np.einsum("ij,ij->i", mesh.normals, np.sign(mesh.points_m)).min() > 0.99
    # Inside out, without normals: the volume shows it.
    turned = box.triangles[:, ::-1].astype("<u4").tobytes()
    (tmp_path / "b.glb").write_bytes(glb(content | {"nodes": [{"mesh": 0}]}, points + turned))
    mesh = read_mesh(tmp_path / "b.glb")
    assert "inside out" in " ".join(mesh.notes)
    assert np.einsum("ij,ij->i", mesh.normals, np.sign(mesh.points_m)).min() > 0.99


def test_units_and_parts(tmp_path):
    file = tmp_path / "a.obj"
    file.write_bytes(b"v 0 0 0\nv 70 0 0\nv 0 160 0\nusemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n")
    mesh = read_mesh(file)
    np.testing.assert_allclose(2.0 * mesh.half_extent_m, [0.07, 0.16, 0.0], atol=1e-12)
    assert "millimetres" in mesh.notes[0]
    assert mesh.parts == ("a", "b")
    assert mesh.printed == (False, False)
    assert read_mesh(file, "cm").half_extent_m[1] == pytest.approx(0.8)
    assert read_mesh(file, "inch").half_extent_m[1] == pytest.approx(80.0 * 0.0254)


def test_edges_sharper_than_the_crease_stay_sharp(tmp_path):
    """Without normals: those of a box stay those of its faces, those of a ball become smooth."""
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box((0.1, 0.1, 0.1)).export(tmp_path / "box.stl")
    box = read_mesh(tmp_path / "box.stl")
    assert np.allclose(np.abs(box.normals).max(axis=1), 1.0)
    trimesh.creation.icosphere(4, 0.05).export(tmp_path / "ball.stl")
    ball = read_mesh(tmp_path / "ball.stl")
    angle = np.degrees(np.linalg.norm(ball.normals - ball.points_m / 0.05, axis=1))
    assert angle.max() < 0.3
    a, b, c = np.moveaxis(ball.points_m[ball.triangles], 1, 0)
    facets = np.cross(b - a, c - a)
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    assert np.degrees(np.linalg.norm(facets - a / 0.05, axis=1)).max() > 1.0  # what facets show


@pytest.mark.parametrize("suffix", MESH_SUFFIXES)
def test_what_trimesh_writes_comes_back(tmp_path, suffix):
    """Points, normals and the label of a carton, through each format."""
    trimesh = pytest.importorskip("trimesh")
    mesh = mesh_of(Shape("carton", edge_radius_m=0.003))
    uv = mesh.label_m / mesh.label_size_m + 0.5
    theirs = trimesh.Trimesh(
        mesh.points_m,
        mesh.triangles,
        vertex_normals=mesh.normals,
        process=False,
        visual=trimesh.visual.TextureVisuals(uv=uv),
    )
    file = tmp_path / f"a{suffix}"
    if suffix in (".glb", ".gltf"):
        files = {
            file.name: trimesh.exchange.gltf.export_glb(trimesh.Scene(theirs), include_normals=True)
        }
        if suffix == ".gltf":
            files = trimesh.exchange.gltf.export_gltf(trimesh.Scene(theirs), include_normals=True)
            files[file.name] = files.pop("model.gltf")
        for name, data in files.items():
            (tmp_path / name).write_bytes(data)
    elif suffix == ".obj":
        file.write_text(trimesh.exchange.obj.export_obj(theirs, include_normals=True))
    else:
        theirs.export(file)
    read = read_mesh(file)
    own = np.sort(mesh.points_m[mesh.triangles].reshape(-1, 9), axis=0)
    np.testing.assert_allclose(
        np.sort(read.points_m[read.triangles].reshape(-1, 9), axis=0), own, atol=1e-7
    )
    if suffix == ".stl":
        assert read.printed == (False,)
        assert "no artwork" in read.notes[0]
        return
    assert read.printed == (True,)
    np.testing.assert_allclose(read.label_size_m, mesh.label_size_m, rtol=1e-3)
    for label, of in ((read.label_m[read.triangles], mesh.label_m[mesh.triangles]),):
        np.testing.assert_allclose(
            np.sort(label.reshape(-1, 6), axis=0), np.sort(of.reshape(-1, 6), axis=0), atol=3e-4
        )
    np.testing.assert_allclose(np.sort(read.normals[read.triangles].reshape(-1, 9), axis=0),
                               np.sort(mesh.normals[mesh.triangles].reshape(-1, 9), axis=0),
                               atol=1e-5)  # fmt: skip


def test_base64_buffers(tmp_path):
    coded = base64.b64encode(TRIANGLE.tobytes()).decode()
    (tmp_path / "a.gltf").write_bytes(with_buffer(f"data:;base64,{coded}"))
    assert read_mesh(tmp_path / "a.gltf").half_extent_m[0] == pytest.approx(0.05)


def scan(name):
    default = Path(__file__).resolve().parents[3] / "shared" / "data" / "meshes"
    path = Path(os.environ.get("RELGLOSS_MESH_DIR", default)) / f"{name}.obj"
    if not path.is_file():
        pytest.skip(f"{path} is absent; RELGLOSS_MESH_DIR names the folder of scanned packs")
    return path


@pytest.mark.parametrize(
    ("name", "size_m"),
    # Calli et al. 2015: 38 x 89 x 175 mm and 58 x 95 x 190 mm by hand; scans stand askew.
    [("sugar_box", (0.038, 0.089, 0.175)), ("mustard_bottle", (0.058, 0.095, 0.190))],
)
def test_scanned_packs(name, size_m):
    """The size of the real one, and the triangles, normals and label that trimesh reads."""
    trimesh = pytest.importorskip("trimesh")
    path = scan(name)
    mesh = read_mesh(path)
    extent = np.sort(2.0 * mesh.half_extent_m)
    assert np.all(extent >= np.array(size_m) - 0.002)
    assert np.all(extent <= np.array(size_m) + 0.012)
    theirs = trimesh.load(path, process=False, force="mesh", skip_materials=True)
    middle = 0.5 * (theirs.vertices.min(axis=0) + theirs.vertices.max(axis=0))
    kept = theirs.area_faces > 1e-12
    own = np.sort(mesh.points_m[mesh.triangles].reshape(-1, 9), axis=0)
    np.testing.assert_allclose(
        own, np.sort((theirs.vertices - middle)[theirs.faces[kept]].reshape(-1, 9), axis=0),
        atol=2e-4,
    )  # fmt: skip
    assert mesh.printed == (True,)
    uv = np.array(theirs.visual.uv)
    np.testing.assert_allclose(np.sort(mesh.label_m[:, 0]).min() / mesh.label_size_m[0] + 0.5,
                               uv[:, 0].min(), atol=1e-3)  # fmt: skip
    a, b, c = np.moveaxis(mesh.points_m[mesh.triangles], 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    label = mesh.label_m[mesh.triangles]
    e, f = label[:, 1] - label[:, 0], label[:, 2] - label[:, 0]
    on_label = 0.5 * np.abs(e[:, 0] * f[:, 1] - e[:, 1] * f[:, 0]).sum()
    assert on_label == pytest.approx(area, rel=1e-6)


def comb(teeth):
    """A concave polygon in the plane z = 0.01 that no fan fills: a bar with teeth, m."""
    x = np.repeat(np.arange(2 * teeth), 2)
    y = np.tile([0.0, 1.0, 1.0, 0.0], teeth)
    top = np.stack([x, y], axis=-1)[1:-1]
    corners = np.concatenate(
        [[[0, -1]], [[2 * teeth - 1, -1]], [[2 * teeth - 1, 0]], top[::-1], [[0, 0]]]
    )
    return 0.01 * np.column_stack([corners, np.ones(len(corners))])


@pytest.mark.parametrize("suffix", [".obj", ".ply"])
@pytest.mark.parametrize("turned", [0, 3])
def test_concave_polygons_are_filled_once(tmp_path, suffix, turned):
    """Area by the shoelace formula; a fan covers more, and what lies beside the polygon."""
    points = np.roll(comb(4), turned, axis=0)
    count = len(points)
    order = range(count)
    if suffix == ".obj":
        text = "".join("v {} {} {}\n".format(*p) for p in points)
        text += "f " + " ".join(str(k + 1) for k in order) + "\n"
    else:
        text = (PLY % (b"ascii", 1)).decode().replace("vertex 3", f"vertex {count}")
        text += "".join("{} {} {}\n".format(*p) for p in points)
        text += f"{count} " + " ".join(map(str, order)) + "\n"
    (tmp_path / f"a{suffix}").write_text(text)
    mesh = read_mesh(tmp_path / f"a{suffix}", "m")
    a, b, c = (mesh.points_m[mesh.triangles[:, k]] for k in range(3))
    x, y = points[:, 0], points[:, 1]
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    covered = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    assert covered == pytest.approx(area, rel=1e-9)
    a, b, c = points[0], points[1:-1], points[2:]
    assert 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() > 1.2 * area  # a fan


def test_other_ways_to_write_the_same(tmp_path):
    obj = THREE + b"vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"
    stl = b"solid a\nfacet normal 0 0 1\nouter loop\n" + THREE.replace(b"v ", b"vertex ")
    stl += b"endloop\nendfacet\nendsolid\n"
    for name, data, other in (
        ("bom.obj", b"\xef\xbb\xbf" + obj, obj),
        ("slash.obj", obj.replace(b"/1 2/2 3/3", b"/1/ 2/2/ 3/3/"), obj),
        ("upper.stl", stl.upper(), stl),
    ):
        (tmp_path / name).write_bytes(data)
        (tmp_path / f"usual{name}").write_bytes(other)
        one, usual = (read_mesh(tmp_path / n) for n in (name, f"usual{name}"))
        assert np.array_equal(one.points_m[one.triangles], usual.points_m[usual.triangles])
        assert np.array_equal(one.label_m[one.triangles], usual.label_m[usual.triangles])
