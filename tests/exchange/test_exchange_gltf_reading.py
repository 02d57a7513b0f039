"""Materials of others' glTF files: what is read, what is named, what is refused."""

from __future__ import annotations

import base64
import io
import json
import os
from pathlib import Path

import numpy as np
import pytest
import trimesh
from gltf_judges import parts_of, rebuilt
from PIL import Image

import relgloss_view as rg
from relgloss_view.base.errors import InputError
from relgloss_view.exchange.formats import reader_of
from relgloss_view.exchange.gltf import glb
from relgloss_view.exchange.gltf_material import GltfMaterial
from relgloss_view.exchange.gltf_reading import read_gltf as read
from relgloss_view.exchange.gltf_refit import refit_gltf
from relgloss_view.exchange.metered import gloss_units
from relgloss_view.pack.built_in import load_finish
from relgloss_view.pack.forms.gltf_document import Document, Source
from relgloss_view.pack.forms.mesh_files import read_mesh


def file(folder: Path, *materials: dict, **more) -> Path:
    path = folder / "theirs.gltf"
    content = {"asset": {"version": "2.0"}, "materials": list(materials), **more}
    path.write_text(json.dumps(content))
    return path


def surface(entry: dict, **content):
    """A material's surface, and what is named as not carried."""
    theirs = GltfMaterial(Document(Source(content, None, None)), entry)
    return theirs.surface(), theirs.lines


def png(colour, size=(4, 4)) -> str:
    data = io.BytesIO()
    Image.new("RGBA" if len(colour) == 4 else "RGB", size, colour).save(data, "PNG")
    return "data:image/png;base64," + base64.b64encode(data.getvalue()).decode()


def textured(*pictures: str) -> dict:
    return {
        "images": [{"uri": uri} for uri in pictures],
        "textures": [{"source": k} for k in range(len(pictures))],
    }


@pytest.mark.parametrize("name", ["kraft", "cold-foil-gold"])
def test_an_unchanged_file_gives_the_material_back(name, tmp_path):
    material = load_finish(name)
    path = tmp_path / "own.glb"
    path.write_bytes(glb(material)[0])
    assert read(path, None) == material
    assert reader_of(path).read(path, None) == material


def test_an_edited_file_is_read_by_its_factors(tmp_path):
    content, binary = parts_of(glb(load_finish("soft-touch"))[0])
    content["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] = 0.3
    path = tmp_path / "edited.glb"
    path.write_bytes(rebuilt(content, binary))
    material = read(path, None)
    assert material.described is not None
    assert material.marks == "described"
    assert material.described.parameters["roughnessFactor"] == 0.3


def test_out_and_in_again_without_our_own_numbers_keeps_the_gloss(tmp_path):
    """Two refits in a row; of matt and satin surfaces, which GGX can hold."""
    for name in ("soft-touch", "uncoated-label", "matt-varnish"):
        content, binary = parts_of(glb(load_finish(name))[0])
        del content["materials"][0]["extras"]
        path = tmp_path / "bare.glb"
        path.write_bytes(rebuilt(content, binary))
        again, before = gloss_units(read(path, None)), gloss_units(load_finish(name))
        for key, value in before.items():
            assert again[key] == pytest.approx(value, abs=2.0), (name, key)


def test_no_coat_is_a_bright_point_in_a_matt_highlight():
    """The meters alone would take a narrow coat, whose mirror image of the lamp is 11 dE2000."""
    refit = refit_gltf(load_finish("soft-touch"))
    assert refit.loss.de2000_max < 3.0
    for surface in (refit.surface, *(found.surface for found in refit.others)):
        if surface.clearcoat > 0.0:
            assert surface.clearcoat_roughness > 0.5 * surface.roughness


@pytest.mark.slow
def test_a_pack_gives_its_finishes_by_name(tmp_path):
    pack = rg.read_pack("can")
    path = tmp_path / "can.glb"
    path.write_bytes(glb(pack, most_px=32)[0])
    with pytest.raises(InputError, match="materials; choose one with --part NAME: base, body"):
        read(path, None)
    assert read(path, "gold foil") == pack.finish("gold foil").material
    with pytest.raises(InputError, match="has no material 'moon'; it has: base"):
        read(path, "moon")


def test_a_file_of_trimesh_is_read(tmp_path):
    mesh = trimesh.creation.box((0.1, 0.1, 0.1))
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=np.zeros((len(mesh.vertices), 2)),
        material=trimesh.visual.material.PBRMaterial(
            name="paint", baseColorFactor=[0.5, 0.25, 0.125, 1.0], metallicFactor=0.0,
            roughnessFactor=0.5, emissiveFactor=[0.1, 0.0, 0.0],
        ),
    )  # fmt: skip
    path = tmp_path / "box.glb"
    path.write_bytes(trimesh.Scene([mesh]).export(file_type="glb"))
    material = read(path, None)
    assert material.name == "paint"
    red, green, blue = material.diffuse.albedo
    # trimesh states factors in steps of 1/255; the body loses about 4 % below the dielectric.
    assert (red, green, blue) == pytest.approx((0.5, 0.25, 0.125), rel=0.08)
    assert "its own light (emissiveFactor)" in material.described.not_carried
    assert any("emissiveFactor" in line for line in material.warnings)


def test_extensions_become_factors():
    read_one, lines = surface({
        "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.25},
        "extensions": {
            "KHR_materials_specular": {
                "specularFactor": 0.5, "specularColorFactor": [1.0, 0.5, 0.25]},
            "KHR_materials_ior": {"ior": 2.0},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.75, "clearcoatRoughnessFactor": 0.1},
        },
    })  # fmt: skip
    # ((2 - 1) / (2 + 1))^2 = 1 / 9, times colour and factor (KHR_materials_specular)
    assert read_one.f0 == pytest.approx(np.array([1.0, 0.5, 0.25]) / 18.0)
    assert (read_one.clearcoat, read_one.clearcoat_roughness) == (0.75, 0.1)
    assert lines == []


def test_glossiness_is_the_older_word():
    gloss, _ = surface({
        "extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.5, 0.5, 0.5, 1.0], "specularFactor": [0.2, 0.2, 0.2],
            "glossinessFactor": 0.6}},
    })  # fmt: skip
    assert gloss.base_color == (0.5, 0.5, 0.5)
    assert gloss.metallic == 0.0
    assert gloss.roughness == pytest.approx(0.4)
    assert gloss.f0 == pytest.approx(0.2)


def test_an_unlit_material_is_matt():
    unlit, lines = surface({"extensions": {"KHR_materials_unlit": {}}})
    assert unlit.specular == unlit.metallic == 0.0
    assert "KHR_materials_unlit" in lines[0]


def test_means_of_textures_are_means_of_light():
    half = io.BytesIO()
    picture = Image.new("RGB", (2, 1))
    picture.putpixel((0, 0), (255, 255, 255))
    picture.save(half, "PNG")
    black_and_white = "data:image/png;base64," + base64.b64encode(half.getvalue()).decode()
    entry = {
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1},
            "roughnessFactor": 0.5,
        },
    }  # fmt: skip
    read_one, lines = surface(entry, **textured(black_and_white, png((9, 102, 51))))
    # Black and white is half the light; a mean of sRGB values would be 0.21 of it.
    assert read_one.base_color == pytest.approx((0.5, 0.5, 0.5))
    assert read_one.roughness == pytest.approx(0.5 * 0.4)
    assert read_one.metallic == pytest.approx(0.2)
    assert lines == [
        "the picture of the base colour: its mean stands for it",
        "the picture of the roughness and metallic: its mean stands for it",
    ]


def test_what_is_not_carried_is_named():
    factors = {
        "transmission": {"transmissionFactor": 0.5},
        "volume": {"thicknessFactor": 0.1},
        "sheen": {"sheenColorFactor": [0.0, 0.0, 0.1]},
        "anisotropy": {"anisotropyStrength": 0.3},
        "iridescence": {"iridescenceFactor": 1.0},
        "emissive_strength": {"emissiveStrength": 2.0},
    }
    entry = {
        "extensions": {f"KHR_materials_{name}": part for name, part in factors.items()}
        | {"ACME_glitter": {}},
        "emissiveFactor": [0.1, 0.0, 0.0],
        "normalTexture": {"index": 0},
        "occlusionTexture": {"index": 0},
        "alphaMode": "BLEND",
    }
    _, lines = surface(entry)
    assert len(lines) == len(factors) + 5
    for word in (*list(factors)[:-1], "ACME_glitter", "normalTexture", "occlusion", "alphaMode"):
        assert any(word in line for line in lines), word
    # Extensions whose factors are 0, their default, change nothing, and are not named.
    entry = {"extensions": {f"KHR_materials_{name}": {} for name in factors}}
    assert surface(entry)[1] == []


def test_a_picture_of_another_kind_leaves_the_gloss_a_guess(tmp_path):
    Image.new("RGB", (2, 2), (0, 51, 0)).save(tmp_path / "rough.webp", lossless=True)
    entry = {"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}}
    for extension, expected in (
        ("EXT_texture_webp", "its mean stands"),
        ("KHR_texture_basisu", "guess"),
    ):
        content = {
            "asset": {"version": "2.0"},
            "materials": [entry],
            "textures": [{"extensions": {extension: {"source": 0}}}],
            "images": [{"uri": "rough.webp"}],
        }
        theirs = GltfMaterial(Document(Source(content, tmp_path, None)), entry)
        rough = theirs.surface().roughness
        assert expected in theirs.lines[0]
        assert rough == pytest.approx(0.2 if "webp" in extension else 1.0)


def test_light_that_passes_through_is_no_colour_of_the_body():
    entry = {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.75}}}
    entry["pbrMetallicRoughness"] = {"metallicFactor": 0.0}
    theirs = GltfMaterial(Document(Source({}, None, None)), entry)
    assert theirs.seen_through(theirs.surface()).base_color == (0.25, 0.25, 0.25)


def test_pictures_beside_the_file_are_read_and_none_elsewhere(tmp_path):
    Image.new("RGB", (2, 2), (255, 0, 0)).save(tmp_path / "red.png")
    inside = tmp_path / "inside"
    inside.mkdir()
    Image.new("RGB", (2, 2), (255, 0, 0)).save(inside / "red.png")
    entry = {
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.0},
        "extensions": {"KHR_materials_specular": {"specularFactor": 0.0}},
    }
    material = read(file(inside, entry, **textured("red.png")), None)
    assert material.diffuse.albedo == pytest.approx((1.0, 0.0, 0.0), abs=0.06)
    for name in ("../red.png", "/etc/passwd", "file:///etc/passwd", "..\\red.png"):
        with pytest.raises(InputError, match="not in its folder"):
            read(file(inside, entry, **textured(name)), None)
    os.symlink(tmp_path / "red.png", inside / "link.png")
    with pytest.raises(InputError, match="not in its folder"):
        read(file(inside, entry, **textured("link.png")), None)


CORE = "pbrMetallicRoughness"
HOSTILE = {
    "no material": ([], {}, "has no materials"),
    "NaN": ([{CORE: {"roughnessFactor": float("nan")}}], {}, "roughnessFactor"),
    "infinite": ([{CORE: {"roughnessFactor": 1e999}}], {}, "roughnessFactor"),
    "negative": ([{CORE: {"metallicFactor": -1}}], {}, "from 0 to 1, found -1"),
    "text": ([{CORE: {"roughnessFactor": "shiny"}}], {}, "roughnessFactor"),
    "true": ([{CORE: {"roughnessFactor": True}}], {}, "roughnessFactor"),
    "a list": ([{CORE: []}], {}, "expected an object"),
    "short colour": ([{CORE: {"baseColorFactor": [1, 1]}}], {}, "expected 4 numbers"),
    "no texture": ([{CORE: {"baseColorTexture": {"index": 7}}}], {}, "there is no such entry"),
    "no number": ([{CORE: {"baseColorTexture": {"index": {}}}}], {}, "there is no such entry"),
    "broken picture": (
        [{CORE: {"baseColorTexture": {"index": 0}}}],
        textured("data:image/png;base64,iVBORw0KGgoAAAA="),
        "a texture is broken",
    ),
    "another kind": (
        [{CORE: {"baseColorTexture": {"index": 0}}}],
        textured("data:image/gif;base64,R0lGODlhAQABAAAAACw="),
        "neither PNG nor JPEG",
    ),
    "broken base64": (
        [{CORE: {"baseColorTexture": {"index": 0}}}],
        textured("data:image/png;base64,!!!"),
        "broken base64",
    ),
    "a view beyond its buffer": (
        [{CORE: {"baseColorTexture": {"index": 0}}}],
        {
            "images": [{"bufferView": 0}], "textures": [{"source": 0}],
            "bufferViews": [{"buffer": 0, "byteLength": 10**12}],
            "buffers": [{"uri": "data:;base64,AAAA"}],
        },
        "shorter than its picture",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", HOSTILE)
def test_hostile_files_end_in_one_line_that_names_the_file(case, tmp_path):
    materials, more, words = HOSTILE[case]
    path = file(tmp_path, *materials, **more)
    with pytest.raises(InputError, match=words) as caught:
        read(path, None)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        '{"asset":' + "[" * 100_000,
        '{"asset":1',
        '{"materials":[' + ",".join(["{}"] * 10_001) + "]}",
        '{"materials":[' + ",".join(["1"] * 600_000) + "]}",
        '{"materials":5}',
        "[]",
    ],
)
def test_odd_json_is_refused(text, tmp_path):
    path = tmp_path / "odd.gltf"
    path.write_text(text)
    with pytest.raises(InputError):
        read(path, None)


def test_a_bomb_of_pixels_is_refused(tmp_path):
    # A PNG whose header states 60,000 x 60,000 pixels and holds none.
    import zlib

    head = b"IHDR" + (60_000).to_bytes(4, "big") * 2 + b"\x08\x02\0\0\0"
    data = b"\x89PNG\r\n\x1a\n\0\0\0\x0d" + head + zlib.crc32(head).to_bytes(4, "big")
    uri = "data:image/png;base64," + base64.b64encode(data + b"\0\0\0\0IDAT").decode()
    path = file(tmp_path, {CORE: {"baseColorTexture": {"index": 0}}}, **textured(uri))
    with pytest.raises(InputError, match=r"pixels|broken"):
        read(path, None)


def test_extensions_that_the_reader_of_meshes_ignores_are_named(tmp_path):
    mesh = trimesh.creation.box((0.1, 0.1, 0.1))
    content, binary = parts_of(mesh.export(file_type="glb"))
    content["extensionsUsed"] = [
        "KHR_texture_transform", "KHR_materials_sheen", "KHR_mesh_quantization", "ACME_bend",
    ]  # fmt: skip
    path = tmp_path / "box.glb"
    path.write_bytes(rebuilt(content, binary))
    notes = " ".join(read_mesh(path).notes)
    assert "KHR_texture_transform, which is ignored: artwork lies by" in notes
    assert "ACME_bend" in notes
    assert "sheen" not in notes
    assert "quantization" not in notes
