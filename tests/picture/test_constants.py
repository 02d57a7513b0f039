"""Named choices have their numbers from one table: picture/gpu/constants.py."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

import relgloss_view
from relgloss_view.display.display import TRANSFERS, Display
from relgloss_view.pack.shape import ANALYTIC, Shape
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.gpu.constants import NAMES, code, definitions, glsl_name
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.shader import ShaderSource, shader_folder
from relgloss_view.picture.gpu.variant import Variant, tone_defines
from relgloss_view.picture.method import Method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene

DEFINED = {
    glsl_name(table, name): (table, name) for table, names in NAMES.items() for name in names
}
SHADERS = sorted(
    path for ending in ("*.frag", "*.glsl", "*.vert") for path in shader_folder().glob(ending)
)


def code_of(text):
    """GLSL without its comments."""
    return re.sub(r"//.*", "", re.sub(r"/\*.*?\*/", "", text, flags=re.S))


GLSL = {path.name: code_of(path.read_text(encoding="utf-8")) for path in SHADERS}


def faults(text):
    """Where GLSL compares or assigns a named choice by its number, or makes a table of its own."""
    tables = "|".join(sorted(NAMES, key=len, reverse=True))
    compared = (
        rf"\b(?:{tables})\b\s*(?:[=!]=|[<>]=?)\s*\d|\b\d+\s*(?:[=!]=|[<>]=?)\s*(?:{tables})\b"
    )
    argument = "|".join(t.lower() for t in NAMES)
    by_argument = rf"\b(?:{argument}|model|law|kind)\s*[=!]=\s*\d"
    assigned = rf"\bconst\s+int\s+(?:{'|'.join(DEFINED)}|(?:{tables})_\w+)\b"
    redefined = rf"#\s*define\s+(?:{'|'.join(DEFINED)})\b"
    return [
        match[0] for pattern in (compared, by_argument, assigned, redefined)
        for match in re.finditer(pattern, code_of(text))
    ]  # fmt: skip


class TestTables:
    @pytest.mark.parametrize("table", list(NAMES))
    def test_numbers_are_unique_and_count_from_zero(self, table):
        codes = [code(table, name) for name in NAMES[table]]
        assert codes == list(range(len(codes)))

    def test_no_two_names_are_one_constant(self):
        assert len(DEFINED) == sum(len(names) for names in NAMES.values())
        assert all(re.fullmatch(r"[A-Z][A-Z0-9_]*", name) for name in DEFINED)
        # A constant is no variable of a variant, which ShaderSource defines beside it.
        assert not set(DEFINED) & set(NAMES)

    def test_definitions_are_what_code_gives(self):
        lines = [line.split() for line in definitions()]
        assert {name: int(number) for _, name, number in lines} == {
            glsl: code(*entry) for glsl, entry in DEFINED.items()
        }
        assert len(lines) == len(DEFINED)

    @pytest.mark.parametrize(
        ("table", "name", "fault"),
        [
            ("SHAPE", "cone", ValueError),
            ("NOISE", "Paper", ValueError),
            ("WRITES", "", ValueError),
            ("SHAPES", "cylinder", KeyError),
        ],
    )
    def test_a_wrong_name_raises(self, table, name, fault):
        with pytest.raises(fault):
            code(table, name)

    def test_names_are_those_of_the_choices_that_people_make(self):
        """A name that a scene, a look or a method offers and no shader draws would be a fault."""
        scene = Scene(load_sample("matte-coated"))
        assert set(NAMES["SHAPE"]) == {*ANALYTIC, "triangles"}  # the other forms
        for table, field in (("NOISE", "noise_law"), ("GRAIN", "grain")):
            for name in set(NAMES[table]) - {"none"}:
                look = Look(sigma_n_deg=1.0, **{field: name})
                defines = Variant.of(scene, look).defines()
                assert defines[table] == code(table, name)
        for table in ("FRESNEL", "SHADOWING", "LAMP", "FACETS"):
            offered = set(NAMES[table])
            if table == "FACETS":
                offered -= {"mean-gaussian"}  # of noise "mean"
            for name in offered:
                chosen = Method(**{table.lower(): name})
                assert Variant.of(scene, Look(), 1, chosen).defines()[table] == code(table, name)
        for gamut in NAMES["GAMUT"]:
            assert tone_defines(Display(gamut=gamut), "tone.frag")["GAMUT"] == code("GAMUT", gamut)
        assert set(NAMES["TRANSFER"]) == {*TRANSFERS, "curves", "table"}  # those two of files
        for transfer in TRANSFERS:
            defines = tone_defines(Display(transfer=transfer), "tone.frag")
            assert defines["TRANSFER"] == code("TRANSFER", transfer)


class TestShaders:
    def test_every_name_is_used(self):
        """By GLSL, or as the default that it takes where no other name is compared."""
        text = "\n".join(GLSL.values())
        unused = {n for n in DEFINED if not re.search(rf"\b{n}\b", text)}
        python = "\n".join(
            path.read_text(encoding="utf-8")
            for path in Path(relgloss_view.__file__).parent.rglob("*.py")
            if path.name != "constants.py"
        )
        for name in unused:
            table, word = DEFINED[name]
            siblings = [n for n, (other, _) in DEFINED.items() if other == table]
            compared = [n for n in siblings if n not in unused]
            assert len(compared) == len(siblings) - 1, f"{name}: no shader compares {table}"
            assert re.search(rf"""["']{re.escape(word)}["']""", python), name

    def test_every_constant_that_glsl_names_is_defined(self):
        prefixes = "|".join(NAMES)
        for file, text in GLSL.items():
            named = set(re.findall(rf"\b(?:{prefixes})_[A-Z0-9_]+\b", text))
            own = set(re.findall(r"\bconst\s+float\s+(\w+)", text)) | {"LAMP_SIZE"}  # a switch
            own |= {"DIFFUSE_WEIGHTS", "DIFFUSE_LIGHT"}  # types, as LOBE_WEIGHTS
            assert named - own <= set(DEFINED), file

    @pytest.mark.parametrize("file", list(GLSL))
    def test_no_choice_is_compared_with_a_number(self, file):
        assert faults(GLSL[file]) == []

    @pytest.mark.parametrize(
        "text",
        [
            "if (SHAPE == 0) x = 1;",
            "#if WRITES != 1",
            "return 2 == NOISE;",
            "if (OVERLAY >= 3) x = 1;",
            "if (gamut == 1) x = 1;",
            "if (model == 2) x = 1;",
            "const int SHAPE_SPHERE = 1;",
            "const int NOISE_OTHER = 7;",
            "#define GAMUT_CLIP 1",
        ],
    )
    def test_negative_control(self, text):
        assert len(faults(text)) == 1
        assert faults(f"// {text}") == []

    def test_nothing_but_switches_is_compared_with_a_number(self):
        """What is left in capitals beside a number counts or is on or off; it is no choice."""
        plain = {
            "LAMPS",
            "CHANNELS",
            "FINISHES",
            "INK_SECOND",  # or -1: none
            "LAMP_SIZE",
            "AMBIENT",
            "LOBES",
            "METALS",
            "BANDS",
            "SAMPLED",
            "SEEN_ON",
            "REACH",
            "NOISY_DIFFUSE",
            "CAPS",
            "AFAR",
            "SOME_ROWS",
            "FIRST",
            "STRIDE",
            "BLOCK",
        }
        for file, text in GLSL.items():
            compared = set(re.findall(r"\b([A-Z][A-Z_]+)\s*(?:[=!]=|[<>])\s*\d", text))
            assert compared <= plain, file

    def test_every_stage_is_given_the_table(self):
        for path in SHADERS:
            if path.suffix == ".frag":
                lines = ShaderSource(path.name, {}).text.splitlines()
                assert set(definitions()) <= set(lines)

    def test_numbers_reach_the_pixels(self, ctx, monkeypatch):
        """Every table in another order: the same pictures, for nothing repeats a number."""
        scene = Scene(
            load_sample("matte-coated"), shape=Shape("box"), display=Display(gamut="clip")
        )
        look, size = Look(sigma_n_deg=1.0, c=0.4, noise_law="tangent", grain="surface"), (48, 36)
        plain = Renderer(ctx)
        expected = plain.render(scene, look, size)
        stages = ("lab", "display", "tilted_normal")
        wanted = {name: getattr(expected, name).copy() for name in stages}
        assert wanted["display"].std() > 1.0
        turned = {table: names[1:] + names[:1] for table, names in NAMES.items()}
        monkeypatch.setattr(constants, "NAMES", turned)
        assert code("SHAPE", "box") != NAMES["SHAPE"].index("box")
        other = Renderer(ctx)
        frame = other.render(scene, look, size)
        for name, values in wanted.items():
            assert (getattr(frame, name) == values).all()
        for made in (plain, other):
            made.release()


def test_python_repeats_no_number():
    """No module but this one's subject gives a constant of the shaders a number."""
    root = Path(sys.modules["relgloss_view"].__file__).parent
    pattern = rf"\b(?:{'|'.join(DEFINED)})\b\s*[=:]\s*\d|[\"'](?:{'|'.join(NAMES)})[\"']\s*:\s*\d"
    for path in root.rglob("*.py"):
        assert not re.search(pattern, path.read_text(encoding="utf-8")), path.name
