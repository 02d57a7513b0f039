"""The rules of the house: imports point one way, rooms keep their libraries, the wheel is whole."""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import zipfile
from functools import cache
from pathlib import Path

import pytest

from relgloss_view.base.resources import data_root
from relgloss_view.cli import COMMANDS
from relgloss_view.picture.gpu.shader import ShaderError, ShaderSource

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "relgloss_view"
#: From the ground up; a room may import itself and those before it.
ROOMS = [
    "base",
    "measure",
    "material",
    "display",
    "pack",
    "picture",
    "quality",
    "operators",
    "gloss",
    "exchange",
    "proof",
    "fitting",
    "experiment",
    "catalogue",
    "bench",
    "viewer",
    "commands",
    "cli",
]
LONGEST_MODULE = 400
STAGES = sorted(p.name for p in (ROOT / "shaders").iterdir() if p.suffix in (".vert", ".frag"))


def modules():
    return sorted(PACKAGE.rglob("*.py"))


def room_of(path):
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


@cache
def imported(path):
    """Every module that a file imports, anywhere in it."""
    names = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            names.append(node.module)
    return tuple(names)


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_point_down(path):
    room = room_of(path)
    if room == "__init__":
        return  # the public names come from everywhere, when first used
    for name in imported(path):
        parts = name.split(".")
        if parts[0] != "relgloss_view" or len(parts) == 1:
            continue
        assert ROOMS.index(parts[1]) <= ROOMS.index(room), f"{path} imports {name}"


@pytest.mark.parametrize(
    ("library", "homes"),
    [
        ("moderngl", ("picture/gpu/", "bench/")),
        ("imgui_bundle", ("viewer/",)),
        ("glfw", ("viewer/", "picture/gpu/context.py")),
        ("OpenEXR", ("picture/output/exr.py", "picture/output/exr_parts.py")),
        (
            "matplotlib",
            (
                "base/figures.py",
                "measure/overview/figure.py",
                "fitting/report.py",
                "experiment/report/",
                "bench/",
            ),
        ),
        ("distributed", ("catalogue/cluster",)),
        ("pyarrow", ("catalogue/table.py",)),
        ("colour", ("material/lamp_names.py", "bench/peers/scientist.py")),
    ],
)
def test_libraries_keep_to_their_rooms(library, homes):
    places = [
        str(path.relative_to(PACKAGE))
        for path in modules()
        if any(name.split(".")[0] == library for name in imported(path))
    ]
    for place in places:
        assert place.startswith(homes), f"{place} imports {library}"
    for home in homes:
        assert any(place.startswith(home) for place in places), f"{home} imports no {library}"


def test_modules_stay_small():
    long = {
        str(p.relative_to(ROOT)): n
        for p in [*modules(), *(ROOT / "shaders").iterdir()]
        if (n := len(p.read_text(encoding="utf-8").splitlines())) > LONGEST_MODULE
    }
    assert not long


def loaded_by(statement):
    code = f"{statement}\nimport sys; print(chr(10).join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in done.stdout.splitlines()}


def test_importing_the_package_is_light():
    heavy = {"moderngl", "glfw", "imgui_bundle", "colour", "scipy", "matplotlib", "OpenEXR", "PIL"}
    assert not loaded_by("import relgloss_view") & heavy
    listing = "from relgloss_view.cli import main; main(['--help'])"
    assert not loaded_by(listing) & {*heavy, "numpy", "cryptography", "selenium"}
    # A picture, drawn and written, needs neither the fit's libraries nor colour-science: they cost
    # more than it does.
    drawing = (
        "import relgloss_view as r, tempfile, os; f = tempfile.mkdtemp()\n"
        "with r.open_renderer() as d: r.save_frame(d.render(r.Scene(r.load_sample('uncoated')),"
        " r.Look(sigma_n_deg=1), (8, 8)), os.path.join(f, 'a.png'))"
    )
    assert not loaded_by(drawing) & {"scipy", "colour", "matplotlib", "imgui_bundle", "OpenEXR"}
    assert "moderngl" in loaded_by("from relgloss_view.picture.gpu.renderer import Renderer")


def test_public_names_are_there():
    import relgloss_view

    for name in relgloss_view.__all__:
        assert getattr(relgloss_view, name) is not None
    with pytest.raises(AttributeError):
        _ = relgloss_view.no_such_name


#: GLSL library -> its numpy twin, and the functions that only float32 or a pixel needs.
TWINS = {
    "brdf.glsl": ("material/brdf.py", {"squared_angle", "above", "polar_angle"}),
    "noise.glsl": ("picture/model/noise.py", {"cosine_of_turn", "direction_of_turn", "turn"}),
    "grain_field.glsl": ("picture/model/grain_field.py", set()),
    "shape.glsl": ("picture/model/shape.py", {"arc_tangent", "cosine", "meet_face"}),
    "tone.glsl": ("picture/model/tone.py", {"on_object", "over", "in_table"}),
    "transfer.glsl": (
        "picture/model/tone.py",
        {"curves_encode", "table_place", "table_encode", "table_reach"},  # what images hold
    ),
    "screen.glsl": ("picture/model/tone.py", {"digital_of"}),
    "approximations.glsl": ("material/approximations.py", set()),
    "lamp_size.glsl": ("picture/model/lights.py", {"sized"}),
    "difference.glsl": ("material/difference.py", set()),
}


class TestShaders:
    @pytest.mark.parametrize("library", list(TWINS))
    def test_twins_share_their_names(self, library):
        twin, alone = TWINS[library]
        text = (ROOT / "shaders" / library).read_text(encoding="utf-8")
        names = set(re.findall(r"^\w+ (\w+)\(", text, re.M)) - {"Facing", "Hit", "Lobe"}
        assert len(names) > 2
        module = ast.parse((PACKAGE / twin).read_text(encoding="utf-8"))
        twins = {node.name for node in module.body if isinstance(node, ast.FunctionDef)}
        assert names - twins == alone

    def test_no_shader_text_in_python(self):
        assert "gl_FragCoord" in (ROOT / "shaders" / "evaluate.frag").read_text(encoding="utf-8")
        for path in modules():
            assert "gl_FragCoord" not in path.read_text(encoding="utf-8")

    @pytest.mark.parametrize("stage", STAGES)
    def test_independent_compiler_accepts_them(self, stage, tmp_path):
        """Khronos's glslang reads the language more strictly than Mesa does."""
        names = ("SHAPE", "DIFFUSE", "NOISE", "GRAIN", "TRANSFER", "NOISY_DIFFUSE", "GAMUT")
        defines = dict.fromkeys((*names, "SAMPLED"), 1) | {"LOBES": 2, "BLOCK": 16, "FIRST": 1}
        defines |= {"BANDS": 0, "WRITES": 0, "STRIDE": 1, "DITHER": 1}
        defines |= {"OVERLAY": 3, "SEEN_ON": 1, "REACH": 1, "CURVE_CELLS": "8.0"}
        defines |= {"TABLE_NODES": "9.0"}
        if stage == "surface.frag":
            defines |= {"SHAPE": 4, "FINISHES": 2, "CHANNELS": 2, "INK_SECOND": 1, "MESH_WIDE": 64}
            defines |= {"LOBE_CHANNELS": "-1, 4", "BODY_CHANNELS": "-1, -2"}
            defines |= {"OUTSIDE_LOBES": 0, "OUTSIDE_DIFFUSE": 0}
        file = tmp_path / stage
        file.write_text(ShaderSource(stage, defines).text, encoding="utf-8")
        done = subprocess.run(["glslangValidator", str(file)], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout

    def test_faults_name_their_place(self, tmp_path, monkeypatch):
        from relgloss_view.picture.gpu import shader

        monkeypatch.setattr(shader, "shader_folder", lambda: tmp_path)
        (tmp_path / "a.frag").write_text('#version 330 core\n#include "gone.glsl"\n')
        with pytest.raises(ShaderError, match=r"gone\.glsl \(included by a\.frag\)"):
            ShaderSource("a.frag")
        (tmp_path / "b.glsl").write_text('#include "c.glsl"\n')
        (tmp_path / "c.glsl").write_text('#include "b.glsl"\n')
        (tmp_path / "b.frag").write_text('#version 330 core\n#include "b.glsl"\n')
        with pytest.raises(ShaderError, match="includes itself"):
            ShaderSource("b.frag")
        (tmp_path / "d.frag").write_text("void main() {}\n")
        with pytest.raises(ShaderError, match="#version"):
            ShaderSource("d.frag")

    def test_compiler_logs_get_file_names(self, ctx, tmp_path, monkeypatch):
        import moderngl

        from relgloss_view.picture.gpu import shader

        monkeypatch.setattr(shader, "shader_folder", lambda: tmp_path)
        (tmp_path / "lib.glsl").write_text(
            "float good() { return 1.0; }\nfloat bad() { return x; }\n"
        )
        (tmp_path / "e.frag").write_text(
            '#version 330 core\n\n#include "lib.glsl"\nvoid main() {}\n'
        )
        source = ShaderSource("e.frag")
        vertex = "#version 330 core\nvoid main() { gl_Position = vec4(0); }\n"
        with pytest.raises(moderngl.Error) as caught:
            ctx.program(vertex_shader=vertex, fragment_shader=source.text)
        assert "lib.glsl:2" in source.explain(str(caught.value))


class TestWheel:
    @pytest.fixture(scope="class")
    @classmethod
    def wheel(cls, tmp_path_factory):
        folder = tmp_path_factory.mktemp("wheel")
        code = f"import hatchling.build as b; print(b.build_wheel({str(folder)!r}))"
        done = subprocess.run(
            [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
        )
        return folder / done.stdout.split()[-1]

    def test_it_carries_shaders_and_assets(self, wheel):
        with zipfile.ZipFile(wheel) as archive:
            names = set(archive.namelist())
        for folder in ("shaders", "assets", "docs"):
            for path in (data_root() / folder).rglob("*"):
                if path.is_file():
                    place = f"relgloss_view/_data/{path.relative_to(data_root()).as_posix()}"
                    assert place in names, place
        for path in [*modules(), *(PACKAGE / "bench").glob("floor*")]:
            assert path.relative_to(ROOT).as_posix() in names
        assert not any(name.startswith(("tests/", "scripts/", "shaders/")) for name in names)
        assert not any(name.endswith((".bsdf", ".pyc")) for name in names)

    def test_it_works_from_an_empty_folder(self, wheel, tmp_path):
        """Unpacked away from the source tree, with nothing of it on the path."""
        site, empty = tmp_path / "site", tmp_path / "empty"
        empty.mkdir()
        with zipfile.ZipFile(wheel) as archive:
            archive.extractall(site)
        code = (
            "import sys; sys.path.insert(0, sys.argv.pop(1)); "
            "import relgloss_view; assert sys.path[0] in relgloss_view.__file__; "
            "from relgloss_view.cli import main; sys.exit(main(sys.argv[1:]))"
        )
        words = ["snapshot", "--sample", "cast-coated", "--size", "32x32", "-o", "cast.png"]
        done = subprocess.run(
            [sys.executable, "-P", "-c", code, str(site), *words],
            cwd=empty,
            env={k: v for k, v in os.environ.items() if k != "PYTHONPATH"},
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stderr
        assert [p.name for p in empty.iterdir()] == ["cast.png"]


def printed_commands(path):
    """Texts of a module that put a value into a command line of this program, as in f-strings."""
    command = re.compile(rf"relgloss (?:{'|'.join(COMMANDS)})\b[^`<]*\0")
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.JoinedStr):
            parts = [p.value if isinstance(p, ast.Constant) else "\0" for p in node.values]
            yield from command.findall("".join(parts))


def test_commands_are_quoted_by_one_helper():
    """A command that is printed to be pasted is made by `base.shell.command_line`."""
    found = {str(path.relative_to(PACKAGE)): list(printed_commands(path)) for path in modules()}
    assert not {path: texts for path, texts in found.items() if texts}
    quoting = [path for path in modules() if "shlex" in set(imported(path))]
    assert quoting == [PACKAGE / "base" / "shell.py"]


def test_the_search_for_unquoted_commands_finds_one(tmp_path):
    (tmp_path / "a.py").write_text('x = f"go on with `relgloss experiment run {path} --new`"\n')
    assert len(list(printed_commands(tmp_path / "a.py"))) == 1


def test_csv_is_written_in_one_place():
    """Where no text becomes a formula of a spreadsheet."""
    writing = re.compile(r"csv\.(?:writer|DictWriter)")
    writers = [p for p in modules() if writing.search(p.read_text(encoding="utf-8"))]
    assert writers == [PACKAGE / "base" / "csv_files.py"]


#: Modules that search in a text and put something else there: all of them read, or name a file.
REPLACING = {
    "catalogue/proofs.py",  # names of files, in letters that any system takes
    "catalogue/query/vocabulary.py",  # headings as they are compared
    "base/csv_files.py",  # cells that are read back
    "base/two_columns.py",
    "measure/quantity.py",
    "measure/readers/aspecular.py",
    "measure/readers/astm_e1392.py",
    "measure/readers/spectral_columns.py",
    "base/cells.py",
    "display/readings_table.py",  # headings
    "measure/readers/csv_table.py",
    "measure/readers/header.py",
    "measure/readers/headings.py",
    "pack/artwork/pdf_page.py",  # the words of a page
    "base/page_scripts.py",  # import lines of our own JavaScript
    "pack/artwork/plate_names.py",  # names as they are compared
    "picture/gpu/constants.py",  # the names of our own choices
    "picture/gpu/shader.py",  # the compiler's log
    "viewer/files/own_materials.py",  # the name of a file
}


def edits_by_search(text):
    """Whether a module replaces what a regular expression finds."""
    return re.search(r"\bre\.subn?\(|\b_?[A-Z_]+\.subn?\(", text) is not None


def test_no_output_is_edited_by_a_search():
    """Output is written in the form that it has: a name in it may look like any of its parts."""
    paths = [p for p in modules() if edits_by_search(p.read_text(encoding="utf-8"))]
    assert {p.relative_to(PACKAGE).as_posix() for p in paths} == REPLACING
    assert edits_by_search('text = re.sub(r"\\[\\s+", "[", json.dumps(content))')
    assert not edits_by_search("figure.subplots(2, 1)")
