"""The mutation tester: its table names what exists, its faults are faults, the draw repeats."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

import mutants  # noqa: E402
from mutations import mutations  # noqa: E402

PYTHON = '''
"""A docstring with 1 + 1."""
LIMIT: float = 0.5

@lru_cache(maxsize=3)
def area(width: float, height: float = 2.0) -> float:
    """Another: a > b."""
    if width < 0.0 and height < 0.0:
        raise ValueError(f"{width + 7} is below {8}")
    return max(width * height, LIMIT) - abs(width)
'''
GLSL = """
// a + b, and 7 > 3
#define CAPS 9
const float LIMIT = 0.5;  /* 1.0 + 1.0 */
float area(vec2 size) {
    float a = -size.x;
    a += max(size.x * size.y, 2.0);
    if (a > LIMIT) return clamp(a, 0.0, 1.0);
    return a;
}
"""


def changes(text, suffix):
    return {str(one) for group in mutations(text, suffix) for one in group}


def test_the_table_names_what_exists():
    assert mutants.missing() == []
    files = [file for part in mutants.HEART.values() for file in part.files]
    assert len(set(files)) == len(files)


@pytest.mark.parametrize("suffix", [".py", ".glsl"])
def test_every_fault_changes_one_stretch(suffix):
    text = PYTHON if suffix == ".py" else GLSL
    groups = mutations(text, suffix)
    assert sum(map(len, groups)) > 14
    for one in (one for group in groups for one in group):
        faulty = one.applied(text)
        assert faulty != text
        assert text[one.start : one.end] == one.old
        assert text.count("\n", 0, one.start) + 1 == one.line
        if suffix == ".py":
            assert ast.dump(ast.parse(faulty)) != ast.dump(ast.parse(text))


def test_faults_of_python():
    faults = changes(PYTHON, ".py")
    assert {
        "0.5 -> 0.55", "2.0 -> 2.2", "0.0 -> 1.0", "width < 0.0 -> (width >= 0.0)",
        "width * height -> (width / height)", "width * height -> (width)", "abs(width) -> (width)",
        "width < 0.0 and height < 0.0 -> (width < 0.0 or height < 0.0)",
        "width < 0.0 and height < 0.0 -> (height < 0.0)",
        "max(width * height, LIMIT) -> (min(width * height, LIMIT))",
    } <= faults  # fmt: skip
    # Text for people, decorators and what is raised stay as they are.
    assert not any(word in fault for fault in faults for word in ("7", "8", "3", "1 + 1"))


def test_faults_of_glsl():
    faults = changes(GLSL, ".glsl")
    assert {
        "0.5 -> 0.55", "* -> /", "> -> <=", "x -> y", "- -> (nothing)", "+= -> -=", "max -> min",
        "clamp(a, 0.0, 1.0) -> (a)", "(a > LIMIT) -> (!(a > LIMIT))", "0.0 -> 1.0", "1.0 -> 0.0",
        "a += max(size.x * size.y, 2.0) -> (nothing)",
    } <= faults  # fmt: skip
    assert not any(word in fault for fault in faults for word in ("7", "3", "9"))


def test_multibyte_text_before_a_fault_moves_nothing():
    (group,) = mutations('NAME = "σ_N"; width = a < b\n', ".py")
    assert group[0].old == "a < b"


def test_the_same_seed_draws_the_same_faults():
    first, again, other = (mutants.draw("spectra", 12, seed) for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert len({(one.fault.start, one.fault.end) for one in first}) == len(first) == 12


def test_files_share_a_part_by_their_places():
    drawn = mutants.draw("noise", 20, 1)
    counts = [sum(one.file == file for one in drawn) for file in mutants.HEART["noise"].files]
    assert sum(counts) == 20
    assert min(counts) >= 5


def test_equivalent_faults_are_of_this_text_and_never_drawn():
    for one in mutants.EQUIVALENTS:
        text = (ROOT / one.file).read_text(encoding="utf-8")
        groups = mutations(text, Path(one.file).suffix)
        lines = text.splitlines()
        covered = [
            m for g in groups for m in g if one.covers(one.file, lines[m.line - 1].strip(), m)
        ]
        assert covered, f"{one.file} has no fault {one.old!r} in {one.line!r}"
        left = [m for group in mutants.candidates(one.file) for m in group]
        assert not any(m in left for m in covered)
        assert len(one.why) > 20


def test_a_library_that_no_compiler_accepts_is_no_mutant():
    file = "shaders/tone.glsl"
    text = (ROOT / file).read_text(encoding="utf-8")
    start = text.index("float lightness(")
    broken = mutants.Mutation(1, start, start + 5, "float", "flaot")
    sound = mutants.Mutation(1, start, start, "", "")
    assert not mutants.compiles(mutants.Mutant("tone", file, "", broken))
    assert mutants.compiles(mutants.Mutant("tone", file, "", sound))


def test_the_table_of_results_fails_below_nine_in_ten(capsys):
    drawn = mutants.draw("spectra", 10, 1)
    assert mutants.report(drawn, [True] * 9 + [False], ["spectra"]) == 0
    assert "90.0" in capsys.readouterr().out
    assert mutants.report(drawn, [True] * 8 + [False] * 2, ["spectra"]) == 1
