"""What catalogues and the exchange with other programs read, and valid files of each.

Refits take a second each, so here a search for lobes ends where it starts: what a file asks for is
read and checked as ever, and its picture is compared once.
"""

from __future__ import annotations

import base64
import contextlib
import functools
import hashlib
import io
import json
import struct
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset

WIDE_QUERY = "gloss 60 between 40 and 50 and colour within dE 3 of 50 20 10"


# What reads


def described(path: Path) -> object:
    """A material of a MaterialX or glTF file, without the search for the nearest lobes."""
    from relgloss_view.exchange.formats import reader_of

    with _unsearched():
        return reader_of(path).read(path, None)


def searched(path: Path) -> object:
    """A material of such a file as `relgloss import` reads it."""
    from relgloss_view.exchange.formats import reader_of

    return reader_of(path).read(path, None)


@contextlib.contextmanager
def _unsearched() -> Iterator[None]:
    from relgloss_view.exchange import judge, refit_lobes
    from relgloss_view.exchange.ways import Family, Way

    def first(target: Any, families: tuple[Family, ...]) -> tuple[Way, ...]:
        surface = families[0].make(np.array([unknown.start for unknown in families[0].unknowns]))
        return (Way(families[0].name, surface, judge.compare(target, surface)),)

    with mock.patch.object(refit_lobes, "ways_to_show", first):
        yield


def own_block(path: Path) -> object:
    """The text of a file as the material that a MaterialX document embeds, with a true digest."""
    from xml.sax.saxutils import quoteattr

    from relgloss_view.exchange.own import digest_of

    text = path.read_text("utf-8", "replace")
    legal = "".join(c if c >= " " and c not in "\ufffe\uffff" else " " for c in text)
    path.write_text(
        '<materialx version="1.39"><open_pbr_surface name="s" type="surfaceshader">'
        '<input name="base_color" type="color3" value="0.5, 0.4, 0.3" /></open_pbr_surface>'
        '<surfacematerial name="m" type="material" '
        f"relgloss_digest={quoteattr(digest_of({'base_color': (0.5, 0.4, 0.3)}))} "
        f"relgloss_material={quoteattr(legal)}>"
        '<input name="surfaceshader" type="surfaceshader" nodename="s" /></surfacematerial>'
        "</materialx>",
        encoding="utf-8",
    )
    return described(path)


def store_item(path: Path) -> object:
    """A record of a catalogue's store: head and body are the file's lines, its digest is true."""
    from relgloss_view.catalogue.store import Store

    data, key = path.read_bytes(), KEY
    with tempfile.TemporaryDirectory() as folder:
        store = Store(Path(folder))
        place = Path(folder) / "items" / key[:2] / f"{key}.json"
        place.parent.mkdir(parents=True)
        place.write_bytes(hashlib.sha256(data).hexdigest().encode() + b"\n" + data)
        kept, item = store.kept(key), store.item(key)
    if kept is None or item is None:
        raise InputError(f"{path}: no record")
    return _written(item.row)


def _written(row: dict[str, Any]) -> object:
    """A row as the table of a catalogue holds it."""
    import pyarrow as pa

    from relgloss_view.catalogue.table import SCHEMA

    return pa.Table.from_pylist([{**row, "path": "a.csv"}], schema=SCHEMA)


def catalogue_table(path: Path) -> object:
    """A catalogue whose table is the file: its rows, pictures, materials, a search and a page."""
    from relgloss_view.catalogue.catalogue import Catalogue
    from relgloss_view.catalogue.page.write import write_page
    from relgloss_view.catalogue.query.search import Searcher

    with tempfile.TemporaryDirectory(dir=path.parent) as name:
        folder = Path(name)
        (folder / "catalogue.json").write_text('{"format": "relgloss-catalogue", "version": 1}')
        (folder / "catalogue.parquet").write_bytes(path.read_bytes())
        catalogue = Catalogue.open(folder)
        paths = [row["path"] for row in catalogue.rows]
        catalogue.thumbnails(paths)
        for one in paths:
            with contextlib.suppress(InputError):
                assert folder.resolve() in catalogue.material_file(one).resolve().parents
        found = Searcher(catalogue).search("gloss 60 > 10, sort by gloss 60")
        write_page(found, catalogue, folder / "page.html", {})
    return None


def recipe(path: Path) -> object:
    """The recipe in the metadata of a catalogue's table, and the reference that it names."""
    from relgloss_view.base.json_files import read_json
    from relgloss_view.catalogue.catalogue import recipe_of
    from relgloss_view.catalogue.look import reference_of

    made = recipe_of(read_json(path, 1 << 22, "a recipe"), path)
    try:
        return reference_of(made)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def marked(path: Path) -> object:
    """A folder whose mark is the file."""
    from relgloss_view.catalogue.folder import claimed
    from relgloss_view.catalogue.tree import is_catalogue

    with tempfile.TemporaryDirectory(dir=path.parent) as name:
        (Path(name) / "catalogue.json").write_bytes(path.read_bytes())
        with claimed(name, "/"):
            return is_catalogue(name)


def query(path: Path) -> object:
    """A query, searched for in rows."""
    from relgloss_view.catalogue.query.search import Searcher

    try:
        return Searcher(_few()).search(path.read_text("utf-8", "surrogateescape")).as_json()
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


@functools.cache
def _few() -> Any:
    """A catalogue of a few rows in memory."""
    from made_catalogue import MemoryCatalogue

    from relgloss_view.material.files import load_material

    rows = _rows(5)
    material = load_material(asset("materials", "uncoated.json"))
    pictures = {row["path"]: _picture(k) for k, row in enumerate(rows)}
    return MemoryCatalogue(rows, dict.fromkeys(pictures, material), pictures)


# Valid files

KEY = "ab" * 32


def _rows(count: int) -> list[dict[str, Any]]:
    from relgloss_view.catalogue.columns import COLUMNS, FLAG, NUMBER, TEXT, WHOLE

    values: dict[str, Callable[[int], Any]] = {
        NUMBER: lambda k: 7.5 * k + 0.25,
        WHOLE: lambda k: k + 1,
        FLAG: lambda k: k % 2 == 0,
        TEXT: lambda k: f"text {k}",
    }
    rows = []
    for k in range(count):
        row = {c.name: values[c.kind](k) for c in COLUMNS if c.name != "thumbnail"}
        row |= {"path": f"lot/paper {k}.csv", "kind": "table", "status": "done", "fault": None}
        row |= {"material": f"materials/lot/paper {k}.csv.json", "sha256": "0" * 64}
        rows.append(row)
    return rows


def _picture(k: int = 0) -> bytes:
    from PIL import Image

    memory = io.BytesIO()
    Image.new("RGB", (128, 128), (40 + 30 * (k % 6), 90, 120)).save(memory, "PNG")
    return memory.getvalue()


def tables_of_catalogues() -> list[bytes]:
    """Tables of 1 and 5 rows."""
    from relgloss_view.catalogue.recipe import Recipe
    from relgloss_view.catalogue.table import write_table

    made = []
    for count in (1, 5):
        rows = [{**row, "thumbnail": _picture(k)} for k, row in enumerate(_rows(count))]
        metadata = {
            "format": "relgloss-catalogue", "version": 1, "recipe": Recipe().as_json(),
            "program": "1", "drivers": ["d"], "reference": "cast-coated",
        }  # fmt: skip
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "catalogue.parquet"
            write_table(path, rows, metadata, path)
            made.append(path.read_bytes())
    return made


def records() -> list[bytes]:
    """Records of a store without their digest: done, and failed."""
    from relgloss_view.catalogue.item import Fitted, Item
    from relgloss_view.catalogue.recipe import Recipe
    from relgloss_view.catalogue.store import Store

    material = json.loads(asset("materials", "uncoated.json").read_bytes())
    row = {**_rows(1)[0], "thumbnail": _picture()}
    done = Item(row, material, Fitted(material, 40, 0.5), driver="d")
    failed = Item({**_rows(1)[0], "status": "failed", "fault": "it is"}, failed_in="file")
    made = []
    for item in (done, failed):
        with tempfile.TemporaryDirectory() as folder:
            Store(Path(folder)).put(KEY, item, Recipe())
            data = (Path(folder) / "items" / KEY[:2] / f"{KEY}.json").read_bytes()
            made.append(data.partition(b"\n")[2])
    return made


def recipes() -> list[bytes]:
    """Recipes of a built-in paper and of a material."""
    from relgloss_view.catalogue.recipe import Recipe

    material = json.loads(asset("materials", "uncoated.json").read_bytes())
    made = (Recipe(), Recipe(material, 1.0, 0.5, fit={"model": "metal"}, table={"part": "1"}))
    return [json.dumps(one.as_json()).encode() for one in made]


def marks() -> list[bytes]:
    """The mark of a catalogue's folder."""
    return [b'{"format": "relgloss-catalogue", "version": 1}\n']


def queries() -> list[bytes]:
    """Queries of each phrase."""
    return [
        text.encode()
        for text in (
            WIDE_QUERY,
            "looks 0.7 x as glossy as cast-coated, sort by gloss 60 descending, first 3",
            "nearest to uncoated",
            "not (name contains 'a\"b' or kind is table) but haze < 3 and lobe width >= 2",
            "quality is good and bands > 3 and L* 40 to 60 or c_max is empty",
        )
    ]


def own_blocks() -> list[bytes]:
    """Materials as files of other programs embed them."""
    from relgloss_view.exchange.own import own_numbers
    from relgloss_view.material.files import load_material

    names = ("uncoated", "art-coated")
    materials = [load_material(asset("materials", f"{name}.json")) for name in names]
    return [own_numbers(material, {})["material"].encode() for material in materials]


def material_x() -> list[bytes]:
    """Documents of each model, with constants behind names, interfaces and our own numbers."""
    head = '<?xml version="1.0"?>\n<materialx version="1.39" colorspace="lin_rec709">\n'
    inputs = {
        "open_pbr_surface": "base_weight=0.9 base_color=0.5,0.2,0.1 base_diffuse_roughness=0.3 "
        "base_metalness=0.1 specular_weight=1 specular_color=1,1,1 specular_roughness=0.3 "
        "specular_ior=1.5 coat_weight=0.4 coat_roughness=0.1 coat_ior=1.6 coat_darkening=1 "
        "transmission_weight=0 fuzz_weight=0.2",
        "standard_surface": "base=1 base_color=0.5,0.2,0.1 diffuse_roughness=0.3 metalness=1 "
        "specular=1 specular_color=1,1,1 specular_roughness=0.3 specular_IOR=1.5 coat=0.1 "
        "coat_roughness=0.2 coat_IOR=1.5 sheen=0 emission=0",
        "gltf_pbr": "base_color=0.5,0.2,0.1 metallic=0 roughness=0.3 specular=1 ior=1.5 "
        "specular_color=1,1,1 clearcoat=1 clearcoat_roughness=0.1 alpha=1",
        "UsdPreviewSurface": "diffuseColor=0.5,0.2,0.1 useSpecularWorkflow=1 "
        "specularColor=0.2,0.2,0.1 metallic=0 roughness=0.3 clearcoat=0.4 ior=1.5 opacity=1",
    }
    made = []
    for tag, words in inputs.items():
        lines = []
        for word in words.split():
            name, _, value = word.partition("=")
            kind = "color3" if "," in value else "float"
            lines.append(f'    <input name="{name}" type="{kind}" value="{value}" />')
        shader = f'  <{tag} name="s" type="surfaceshader">\n' + "\n".join(lines) + f"\n  </{tag}>\n"
        material = (
            '  <surfacematerial name="m" type="material" relgloss_digest="0" '
            'relgloss_material="{}">\n    <input name="surfaceshader" type="surfaceshader" '
            'nodename="s" />\n  </surfacematerial>\n'
        )
        made.append(head + shader + material + "</materialx>\n")
    graph = (
        head + '  <constant name="c" type="color3"><input name="value" type="color3" '
        'value="0.2, 0.3, 0.4" colorspace="srgb_texture" /></constant>\n  <nodegraph name="g">'
        '<input name="face" type="float" value="0.25" /><dot name="d" type="float"><input '
        'name="in" type="float" interfacename="face" /></dot><output name="out" type="float" '
        'nodename="d" /></nodegraph>\n  <open_pbr_surface name="s" type="surfaceshader"><input '
        'name="base_color" type="color3" nodename="c" /><input name="specular_roughness" '
        'type="float" nodegraph="g" output="out" /></open_pbr_surface>\n'
        '  <surfacematerial name="m" type="material"><input name="surfaceshader" '
        'type="surfaceshader" nodename="s" /></surfacematerial>\n</materialx>\n'
    )
    return [text.encode() for text in (*made, graph)]


def gltf_materials() -> list[bytes]:
    """A .gltf and a .glb with factors, extensions, a texture, and a pack's finishes."""
    memory = io.BytesIO()
    from PIL import Image

    Image.new("RGBA", (4, 4), (200, 90, 40, 200)).save(memory, "PNG")
    picture = memory.getvalue()
    materials = [
        {
            "name": "ink",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.5, 0.2, 0.1, 1.0], "metallicFactor": 0.2,
                "roughnessFactor": 0.4, "baseColorTexture": {"index": 0},
                "metallicRoughnessTexture": {"index": 0},
            },
            "extensions": {
                "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 1, 1]},
                "KHR_materials_ior": {"ior": 1.4},
                "KHR_materials_clearcoat": {
                    "clearcoatFactor": 1.0, "clearcoatRoughnessFactor": 0.1,
                    "clearcoatTexture": {"index": 0},
                },
                "KHR_materials_sheen": {},
            },
            "emissiveFactor": [0, 0, 0], "alphaMode": "OPAQUE",
            "extras": {"relgloss": {"digest": "0", "material": "{}", "loss": "none"}},
        }
    ]  # fmt: skip
    glossiness = [
        {"name": "old", "extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseFactor": [0.2, 0.3, 0.4, 1], "specularFactor": [0.1, 0.1, 0.1],
            "glossinessFactor": 0.7}}},
    ]  # fmt: skip
    content: dict[str, Any] = {
        "asset": {"version": "2.0", "extras": {"relgloss": {"finishes": [
            {"name": "foil", "digest": "0", "material": "{}",
             "surface": {"pbrMetallicRoughness": {"roughnessFactor": 0.3}}}]}}},
        "materials": materials, "textures": [{"source": 0}],
        "images": [{"bufferView": 0, "mimeType": "image/png"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(picture)}],
        "buffers": [{"byteLength": len(picture)}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "material": 0}]}],
    }  # fmt: skip
    uri = "data:application/octet-stream;base64," + base64.b64encode(picture).decode()
    text = content | {"buffers": [{"byteLength": len(picture), "uri": uri}]}
    old = {"asset": {"version": "2.0"}, "materials": glossiness}
    coded = json.dumps(content).encode()
    coded += b" " * (-len(coded) % 4)
    blob = picture + bytes(-len(picture) % 4)
    parts = struct.pack("<I", len(coded)) + b"JSON" + coded
    parts += struct.pack("<I", len(blob)) + b"BIN\0" + blob
    glb = b"glTF" + struct.pack("<II", 2, 12 + len(parts)) + parts
    return [json.dumps(text).encode(), json.dumps(old).encode(), glb]


def tensor_trees() -> list[bytes]:
    """BSDF XML with trees of three and four dimensions, in the words of Radiance and our own."""
    head = (
        "<?xml version='1.0' encoding='UTF-8'?>\n<WindowElement><Optical><Layer><Material><Name>"
        "made</Name></Material><DataDefinition><IncidentDataStructure>{0}"
        "</IncidentDataStructure></DataDefinition>{1}</Layer></Optical></WindowElement>"
    )
    block = (
        "<WavelengthData><Wavelength unit='Integral'>{0}</Wavelength><WavelengthDataBlock>"
        "<WavelengthDataDirection>Reflection Front</WavelengthDataDirection><AngleBasis>"
        "LBNL/Shirley-Chiu</AngleBasis><ScatteringDataType>BTDF</ScatteringDataType>"
        "<ScatteringData>{1}</ScatteringData></WavelengthDataBlock></WavelengthData>"
    )
    leaf = "{ 0.2 }"
    third = "{ { 0.1 } { 0.1 0.2 0.3 0.4 0.1 0.2 0.3 0.4 } " + leaf * 6 + " }"
    fourth = "{ { 0.1 } " + "{ 0.3 } " * 15 + "}"
    flat = "{ " + "0.1 " * 4096 + "}"
    texts = [
        head.format("TensorTree3", block.format("Visible", third)),
        head.format("TensorTree3", block.format("Visible", flat)),
        head.format("TensorTree4", block.format("Visible", fourth)),
        head.format(
            "TensorTree3",
            "".join(block.format(band, third) for band in ("Visible", "CIE-u", "CIE-v")),
        ),
    ]
    return [text.encode() for text in texts]
