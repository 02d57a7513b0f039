"""The page's JavaScript keeps to the rules of the house: its twins, its numbers, its private names.

No browser is needed: the modules are read as text. What the twins compute is compared in a browser;
TWINS names the test of each.
"""

from __future__ import annotations

import ast
import importlib
import json
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import pytest

from relgloss_view.proof import proof, screens, settings

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "relgloss_view"
FOLDER = PACKAGE / "proof" / "page" / "js"
MOST_LINES = 420  #: of a module; canonical.js has an SHA-256 of its own


class Twin(NamedTuple):
    """Where the functions of a module are in Python.

    homes: modules of the package. test: file and function that runs both. named: exports whose
    Python name is another, as 'Class.method' where it is one. alone: exports of the browser alone.
    """

    homes: tuple[str, ...]
    test: str
    named: Mapping[str, str] = MappingProxyType({})
    alone: frozenset[str] = frozenset()


TWINS = {
    "arrays.js": Twin(
        ("proof/arrays.py",), "test_proof_engine_parts.py test_arrays_come_back",
        alone=frozenset({"bytesOf", "inflated", "unpackedAll"}),
    ),
    "canonical.js": Twin(
        ("proof/proof.py", "proof/page/parts.py", "proof/keys.py", "proof/read.py"),
        "test_proof_canonical_js.py test_json_and_digests_are_pythons",
        {"splitPage": "split", "checkPage": "Page", "wordsOfPart": "part_words",
         "withMessage": "joined", "checkSignatures": "checked", "followsThread": "proof_of"},
        frozenset({"Sha256", "sha256", "hexOf", "bytesOfHex", "pageText"}),
    ),
    "check.js": Twin(
        ("proof/grid.py",), "test_proof_check_grid.py test_same_picture",
        {"checkGrid": "compare"}, frozenset({"checkWords", "mountCheck"}),
    ),
    "evaluate.js": Twin(("picture/gpu/evaluate.py",), "test_proof_engine_parts.py test_hashes"),
    "finishes.js": Twin(
        ("picture/gpu/finishes.py",), "test_proof_packs_page.py",
        {"finishLook": "look_uniforms"},
    ),
    "hand.js": Twin(
        ("viewer/drawing/camera.py",), "test_proof_page.py test_the_hand_is_that_of_the_window",
        {"lifeSized": "life_sized"}, frozenset({"held", "listen"}),
    ),
    "held.js": Twin(("picture/gpu/held.py",), "test_proof_engine.py test_only_what_changed"),
    "layers.js": Twin(
        ("pack/layers.py",), "test_proof_layers_page.py", {},
        frozenset({"valuesOf", "halfOf", "halvesOf", "numbersOfHalves"}),  # numpy has them
    ),
    "mesh.js": Twin(
        ("picture/gpu/triangles.py", "picture/model/sight.py", "proof/mesh_drawing.py"),
        "test_proof_packs_page.py",
        {"meshOf": "mesh_drawing", "meshTextures": "Triangles", "meetMesh": "meet_ray",
         "listedTriangles": "listed", "TriangleBuffer": "Triangles"},
    ),
    "mesh_edges.js": Twin(("picture/gpu/mesh_edges.py",), "test_proof_packs_page.py"),
    "pair.js": Twin(
        ("picture/pair.py", "picture/frame.py"),
        "test_proof_engine_parts.py test_factors_are_those_of_python",
        {"scalingOf": "Scaling"}, frozenset({"NOTHING_SEEN", "SIDES"}),
    ),
    "passes.js": Twin(("picture/gpu/passes.py",), "test_proof_engine.py test_states_at_random"),
    "printed.js": Twin(
        ("picture/gpu/printed.py",), "test_proof_layers_page.py",
        {"placedLevels": "_placed", "printedTextures": "Printed"},
    ),
    "reduction.js": Twin(
        ("picture/gpu/reduction.py",), "test_proof_engine.py test_papers", {},
        frozenset({"blocksOf"}),  # for ahead.js
    ),
    "screens.js": Twin(
        ("proof/screens.py", "proof/screen_words.py"), "test_proof_screen.py",
        alone=frozenset({"unknownScreen"}),  # Screen() in Python
    ),
    "shader.js": Twin(
        ("picture/gpu/shader.py",),
        "test_proof_engine_parts.py test_stages_are_composed_as_on_the_desktop",
        alone=frozenset({"ownName"}),
    ),
    "shape.js": Twin(
        ("picture/model/shape.py", "pack/shape.py"),
        "test_proof_engine_parts.py test_views_are_those_of_python",
    ),
    "silhouette.js": Twin(
        ("picture/model/silhouette.py", "picture/gpu/edges.py"),
        "test_proof_engine_parts.py test_views_are_those_of_python",
        {"vertexList": "VertexList"},
    ),
    "static.js": Twin(
        ("proof/page/static.py",),
        "test_proof_static_js.py test_numbers_are_written_alike",
        {"shortNumber": "number"}, frozenset({"withStatic", "bringUpToDate", "putInPanel"}),
    ),
    "surface.js": Twin(
        ("picture/gpu/surface.py",), "test_proof_packs_page.py", alone=frozenset({"openForm"})
    ),
    "vectors.js": Twin(
        ("picture/scene/setup.py",), "test_proof_engine_parts.py test_views_are_those_of_python",
        alone=frozenset(
            {"cross3", "dot3", "float32", "minus3", "norm3", "plus3", "radians", "scaled3"}
        ),
    ),
    "view.js": Twin(
        ("picture/model/view.py", "picture/model/pixel_sampling.py", "picture/model/light.py",
         "picture/model/lights.py", "picture/model/grain.py", "picture/gpu/uniforms.py",
         "picture/gpu/variant.py"),
        "test_proof_engine_parts.py test_views_are_those_of_python",
        {"seesACap": "_sees_a_cap", "frontHit": "front_white"},
    ),
}  # fmt: skip

#: The interface and the device: no science. Of Math they need these alone, or what is named here.
PLAIN_MATH = {"abs", "ceil", "floor", "max", "min", "round"}
INTERFACE: dict[str, set[str]] = {
    "ahead.js": set(),
    "app.js": {"sqrt"},  # a picture's side, from the time that its pixels take
    "device.js": set(), "dom.js": set(), "engine.js": set(), "life.js": set(),
    "layout.js": {"hypot"},  # a form's half width as it turns, for the shape of its pane
    "main.js": set(), "png.js": set(), "preprocessor.js": set(), "readout.js": set(),
    "press.js": {"hypot"},  # how far a finger has moved
    "reply.js": set(), "screen.js": set(), "setter.js": set(), "sliders.js": set(),
    "thread.js": set(), "tools.js": set(), "words.js": set(),
}  # fmt: skip

#: Numbers and names that stand in both languages: of a module, the constant and its Python one.
NUMBERS: dict[str, dict[str, str]] = {
    "canonical.js": {
        name: f"proof.page.parts {name}" for name in ("BLOCKS", "DIGITS", "DIVIDED", "MARK", "SEAL")
    } | {"FORMAT": "proof.proof FORMAT", "VERSION": "proof.proof VERSION"},
    "check.js": {"MOST_POINTS": "proof.entries MOST_POINTS"},
    "evaluate.js": {"EVALUATED_WIDE": "picture.gpu.evaluate WIDTH"},
    "hand.js": {
        name: f"viewer.drawing.camera {name}"
        for name in (
            "ANGLES_DEG", "BISECTIONS", "DEGREES_ACROSS", "FARTHEST_SHIFT", "INNER",
            "NARROWEST_DEG", "WIDEST_DEG", "ZOOM_STEP",
        )
    },
    "mesh.js": {"LEAST_COSINE": "picture.model.sight LEAST_COSINE"},
    "mesh_edges.js": {
        "PART_PX": "picture.gpu.mesh_edges TILE_PX", "BLOCK_PX": "picture.gpu.mesh_edges BLOCK",
        "EDGE_MARK": "picture.gpu.mesh_edges MARK",
        "BESIDE_PX": "picture.gpu.mesh_edges BESIDE_PX",
    },
    "reduction.js": {
        "FIRST_BLOCK": "picture.gpu.reduction FIRST_BLOCK",
        "FURTHER_BLOCK": "picture.gpu.reduction BLOCK",
        "READ_SIDE": "picture.gpu.reduction READ_SIDE",
    },
    "reply.js": {"MOST_NAME": "proof.proof MOST_AUTHOR", "MOST_NOTE": "proof.proof MOST_NOTE"},
    "screens.js": {
        name: f"proof.screens {name}"
        for name in (
            "BRIGHT_STEPS", "DARK_STEPS", "GAMMA_ERROR", "HIGHLIGHT_SHARES", "LINES_LIGHT",
            "MOST_BLACK", "REFERENCE_CD_M2", "SEEN_LSTAR", "SRGB_GAMMA_RANGE", "STEP_LSTAR",
            "UNSEEN_LSTAR", "USUAL_WHITES_CD_M2",
        )
    } | {
        name: f"proof.screen_words {name}"
        for name in ("SAME_BLACK", "SAME_CHANNELS", "SAME_GAMMA", "SAME_WHITE", "WIDE_BLACK")
    } | {"CHANNEL_NAMES": "proof.screens CHANNELS"},
    "shader.js": {
        "FILL_VERTEX": "picture.gpu.shader VERTEX", "HANDED_ON": "picture.gpu.shader HANDED_ON",
    },
    "silhouette.js": {
        "LIST_WIDE": "picture.gpu.edges WIDE",
        "TILE_VERTICES": "picture.gpu.edges TILE_VERTICES",
    },
    "view.js": {"MOST_FURTHER_LAMPS": "picture.scene.setup MOST_FURTHER_LAMPS"},
}  # fmt: skip

_EXPORTED = re.compile(r"^export (?:async )?(?:function\*?|class|const|let) (\w+)", re.M)
_PRIVATE = re.compile(r"(?<!\bthis)(?<!\bother)\??\.(_[a-z]\w*)")
_NUMBER = re.compile(r"^-?\d[\d.e-]*$")


def text_of(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def plain(text: str) -> str:
    """A module without its comments."""
    return re.sub(r"/\*.*?\*/|(?<![:\"'])//[^\n]*", "", text, flags=re.S)


def snake(name: str) -> str:
    """A name of JavaScript as Python writes it."""
    return re.sub(r"(?<=[a-z0-9])[A-Z]", lambda match: "_" + match[0].lower(), name)


def names_in(path: str) -> set[str]:
    """What a Python module defines, methods too, with and without the mark of private names."""
    tree = ast.parse((PACKAGE / path).read_text(encoding="utf-8"))
    kinds = (ast.FunctionDef, ast.ClassDef)
    names = {node.name for node in ast.walk(tree) if isinstance(node, kinds)}
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else []
        for target in targets:
            names |= {one.id for one in ast.walk(target) if isinstance(one, ast.Name)}
    return names | {name.lstrip("_") for name in names}


def constants(text: str) -> dict[str, Any]:
    """The constants of a module that are a number, a text or a list of them."""
    found: dict[str, Any] = {}
    for statement in re.findall(r"^(?:export )?const ([A-Z].*?);$", plain(text), re.M | re.S):
        for name, value in re.findall(
            r"(\w+) = (\[[^\]]*\]|'[^']*'|\"[^\"]*\"|[-\w.]+(?: / [\d.]+)?)"
            r"(?=\s*(?:$|;|,\s*[A-Z]))",
            statement,
        ):
            if value.startswith("'") and '"' in value:
                found[name] = value[1:-1]
                continue
            if " / " in value:
                part, whole = map(float, value.split(" / "))
                found[name] = part / whole
                continue
            try:
                found[name] = json.loads(re.sub(r",\s*\]", "]", value))
            except ValueError:
                continue
    return found


def python_value(place: str) -> Any:
    module, name = place.split()
    value = getattr(importlib.import_module(f"relgloss_view.{module}"), name)
    return list(value) if isinstance(value, tuple) else value


def test_each_module_is_a_twin_or_the_interface() -> None:
    there = {path.name for path in FOLDER.glob("*.js")}
    assert not set(TWINS) & set(INTERFACE)
    assert there == {*TWINS, *INTERFACE}, "a new module: add its line to TWINS or INTERFACE"


@pytest.mark.parametrize("name", TWINS)
def test_twins_share_their_names(name: str) -> None:
    twin = TWINS[name]
    there = set().union(*map(names_in, twin.homes))
    exported = set(_EXPORTED.findall(text_of(name)))
    assert exported >= twin.alone | set(twin.named), "a line of TWINS that nothing needs"
    wanted = {one: twin.named.get(one, snake(one)) for one in exported - twin.alone}
    missing = {one for one, own in wanted.items() if not {one, own} & there}
    assert not missing, f"no such name in {' or '.join(twin.homes)}"


@pytest.mark.parametrize("name", TWINS)
def test_each_twin_is_run_beside_python(name: str) -> None:
    file, _, function = TWINS[name].test.partition(" ")
    text = (Path(__file__).parent / file).read_text(encoding="utf-8")
    assert f"def {function or 'test_'}" in text


@pytest.mark.parametrize("name", INTERFACE)
def test_the_interface_holds_no_science(name: str) -> None:
    text = plain(text_of(name))
    needs = set(re.findall(r"\bMath\.(\w+)", text))
    assert needs <= PLAIN_MATH | INTERFACE[name], "a formula belongs into a twin of Python"
    assert INTERFACE[name] <= needs, "a line of INTERFACE that nothing needs"
    assert "**" not in text.replace("2 ** depth", ""), "a formula belongs into a twin of Python"


@pytest.mark.parametrize("name", NUMBERS)
def test_numbers_are_those_of_python(name: str) -> None:
    own = constants(text_of(name))
    for constant, place in NUMBERS[name].items():
        assert own[constant] == python_value(place), f"{constant} and {place}"


def test_no_number_of_a_twin_is_the_pages_own() -> None:
    """Each constant of a twin that is a number is compared, or comes from Python, or is listed."""
    alone = {
        # Of the page's own question, and of what a browser should hold.
        "check.js": {"CHECK_TOLERANCE", "CHECK_LEAST"},
        "hand.js": {"KEY_DEGREES"},  # the window turns by other keys
        "mesh.js": {"CORNER_NUMBERS"},  # of a vertex in a buffer
        "layers.js": {"KEPT_COLOURS", "KEPT_SHIFT"},  # colours that are not converted twice
    }
    for name in TWINS:
        numbers = {
            key for key, value in constants(text_of(name)).items() if isinstance(value, int | float)
        }
        rest = numbers - set(NUMBERS.get(name, {}))
        assert rest == alone.get(name, set()), f"{name}: add it to NUMBERS"


def test_sides_are_named_once() -> None:
    assert constants(text_of("pair.js"))["SIDES"] == list(settings.SIDES)
    again = [path.name for path in FOLDER.glob("*.js") if '["reference", "test"]' in plain(
        path.read_text(encoding="utf-8"))]  # fmt: skip
    assert again == ["pair.js"]


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.js")), ids=lambda path: path.name)
def test_private_names_stay_inside(path: Path) -> None:
    """`_name` belongs to its object, and `#name` to the language."""
    found = _PRIVATE.findall(plain(path.read_text(encoding="utf-8")))
    assert not found, f"private names of another object: {found}"


@pytest.mark.parametrize("path", sorted(FOLDER.glob("*.js")), ids=lambda path: path.name)
def test_modules_stay_small_and_say_what_they_are(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    assert len(lines) <= MOST_LINES
    assert re.match(r"// [A-Z\"].{20,}", lines[0])


def test_these_tests_find_what_is_wrong() -> None:
    """Each rule on a text that breaks it, and on one that keeps it."""
    assert _PRIVATE.findall("engine._draw(1)") == ["_draw"]
    assert _PRIVATE.findall("app?._draw") == ["_draw"]
    assert not _PRIVATE.findall("this._draw(other._held)")
    assert snake("eyeGrainSamples") == "eye_grain_samples"
    values = constants(
        'const A = 4; // four\nexport const B = [1, 2.5], C = "x";\n'
        "  const D = 1;\nconst E = 2 ** 8;\n"
    )
    assert values == {"A": 4, "B": [1, 2.5], "C": "x"}
    assert "two" not in plain("a // two\n/* two */ b")
    assert "orbited" in names_in("viewer/drawing/camera.py")
    assert "no such" not in names_in("viewer/drawing/camera.py")


def keys_of(value: Any) -> set[str]:
    """The keys of a drawing but those of numbers by a name of the shaders or of a lamp."""
    if not isinstance(value, dict):
        return set()
    named = {
        "colours",
        "edge",
        "finish_tables",
        "material",
        "sides",
        "tone",
        "uniforms",
        "variants",
    }
    inner = (keys_of(one) for key, one in value.items() if key not in named)
    return set(value).union(*inner, *(keys_of(one) for one in value.get("sides", {}).values()))


def unread(keys: set[str]) -> set[str]:
    """Keys that no module of the page names outside of its comments."""
    code = "\n".join(plain(path.read_text(encoding="utf-8")) for path in FOLDER.glob("*.js"))
    return {key for key in keys if not re.search(rf"(?:\.|[{{,]\s*){key}\b", code)}


def test_a_drawing_holds_nothing_that_no_page_reads(paper: proof.Proof) -> None:
    drawing = paper.content["drawing"]
    keys = keys_of(drawing) | set(drawing["sides"]["test"]["variants"]["smooth one"])
    assert {"narrowest_s", "definitions", "OFF_OBJECT", "reads_field"} <= keys
    of_python = {"stages"}  # which chooses the shaders by it
    assert not unread(keys - of_python)
    assert unread({"narrowest_s", "no_page_reads_this"}) == {"no_page_reads_this"}


def test_versions_agree() -> None:
    assert json.dumps(proof.FORMAT) in text_of("canonical.js")
    assert screens.RANK == {"kept": 0, "hidden": 1, "reversed": 2}
    assert "RANK = { kept: 0, hidden: 1, reversed: 2 }" in text_of("screens.js")
