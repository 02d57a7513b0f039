"""Mutation testing of the heart: does a test fail when one line of it is wrong?

Usage: python scripts/mutants.py [--count 300] [--seed 1] [--module NAME ...] [--jobs 2] [--list]

Draws faults over the modules of HEART, the same ones for the same seed and text. Each is put into a
copy of the tree, where the tests of its module run; a fault that they let pass survives. Prints
each survivor with its place, then a table. Exit status 1: fewer than 90 % were killed.

mutmut and cosmic-ray mutate Python only. Half of the heart here is GLSL, hence a tester of our own.
"""

from __future__ import annotations

import argparse
import json
import os
import queue
import random
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from mutations import Mutation, mutations

ROOT = Path(__file__).resolve().parent.parent
LEAST_KILLED = 0.9
COPIED = ("relgloss_view", "shaders", "tests", "docs", "scripts")
LINKED = ("assets", "pyproject.toml", "README.md", "CHANGELOG.md", "Makefile")


@dataclass(frozen=True)
class Part:
    """A part of the heart: its files, and the tests that answer for it, quick ones first."""

    files: tuple[str, ...]
    tests: tuple[str, ...]


HEART = {
    "brdf": Part(
        ("relgloss_view/material/brdf.py", "shaders/brdf.glsl"),
        (
            "tests/picture/test_twins.py::TestBrdf",
            "tests/picture/test_any_shape.py",
            "tests/material/test_albedo.py",
            "tests/material/test_approximations.py",
            "tests/material/test_brdf.py",
            "tests/stability/test_functions.py",
        ),
    ),
    "noise": Part(
        ("relgloss_view/picture/model/noise.py", "shaders/noise.glsl"),
        (
            "tests/picture/test_twins.py::TestNoise",
            "tests/picture/test_any_shape.py",
            "tests/picture/test_noise.py",
            "tests/stability/test_functions.py",
        ),
    ),
    "tone": Part(
        ("relgloss_view/picture/model/tone.py", "shaders/tone.glsl"),
        (
            "tests/picture/test_twins.py::TestTone",
            "tests/picture/test_tone_shader.py",
            "tests/picture/test_any_shape.py",
            "tests/picture/test_tone.py",
            "tests/stability/test_functions.py",
        ),
    ),
    "shape": Part(
        ("relgloss_view/picture/model/shape.py", "shaders/shape.glsl"),
        (
            "tests/picture/test_twins.py::TestShape",
            "tests/picture/test_shape.py",
            "tests/picture/test_any_shape.py",
            "tests/picture/test_mitsuba.py",
        ),
    ),
    "spectra": Part(
        ("relgloss_view/material/spectra.py",),
        ("tests/material/test_spectra.py",),
    ),
    "solver": Part(
        ("relgloss_view/fitting/problem.py", "relgloss_view/fitting/descent.py"),
        (
            "tests/fitting/test_fit_descent.py",
            "tests/fitting/test_fit_verdict.py",
            "tests/fitting/test_fit_solver.py",
            "tests/fitting/test_fit.py",
        ),
    ),
    "verdict": Part(
        ("relgloss_view/fitting/verdict.py", "relgloss_view/experiment/verdict/full_grid.py"),
        (
            "tests/experiment/verdict/test_full_grid.py",
            "tests/experiment/verdict/test_full_grid_by_hand.py",
            "tests/fitting/test_fit_verdict.py",
            "tests/fitting/test_fit.py",
        ),
    ),
    "ordinal": Part(
        (
            "relgloss_view/experiment/scaling/ordinal.py",
            "relgloss_view/experiment/scaling/ordinal_draws.py",
        ),
        (
            "tests/experiment/scaling/test_ordinal_starts.py",
            "tests/experiment/scaling/test_ordinal.py",
            "tests/experiment/scaling/test_ordinal_draws.py",
            "tests/experiment/scaling/test_successive_categories.py",
        ),
    ),
    "unfolding": Part(
        (
            "relgloss_view/experiment/scaling/unfolding.py",
            "relgloss_view/experiment/scaling/bounded_minima.py",
        ),
        (
            "tests/experiment/scaling/test_unfolding_posterior.py",
            "tests/experiment/scaling/test_unfolding.py",
            "tests/experiment/session/test_adaptive.py",
        ),
    ),
    "gloss meter": Part(
        (
            "relgloss_view/gloss/meter/meter.py",
            "relgloss_view/gloss/meter/geometry.py",
            "relgloss_view/gloss/meter/table.py",
            "relgloss_view/gloss/meter/uncertainty.py",
        ),
        ("tests/gloss/test_gloss_meter.py", "tests/commands/test_gloss.py"),
    ),
}


@dataclass(frozen=True)
class Equivalent:
    """A fault that changes nothing which the program promises, and why; it is never drawn."""

    file: str
    line: str  #: how it begins in the file, without its indent
    old: str  #: what is replaced
    new: str  #: by what; empty for anything
    why: str

    def covers(self, file: str, line: str, one: Mutation) -> bool:
        """Whether a fault in a line of a file is this one."""
        same = (self.file, self.old) == (file, " ".join(one.old.split()))
        return same and line.startswith(self.line) and self.new in ("", one.new)


_MISS = "the hit of a ray that misses is unspecified; callers check `found` first"
_ORDER = "the quadrature has converged to rounding; one node more or less changes nothing"
_BUDGET = "a budget of a search that ends long before; one more or less changes no result"
_START = "where an iteration begins whose end does not depend on it"
_ACCEPTED = "decides how early a step is accepted, not where the search ends"
EQUIVALENTS = (
    Equivalent(
        "relgloss_view/experiment/scaling/ordinal_draws.py",
        "falls = after[0] <= value",
        "DECREASE * share * promise",
        "",
        _ACCEPTED,
    ),
    Equivalent(
        "relgloss_view/experiment/scaling/ordinal_draws.py",
        "promise = np.sum(slope * step, axis=1)",
        "np.sum(slope * step, axis=1)",
        "(np.mean(slope * step, axis=1))",
        _ACCEPTED,
    ),
    Equivalent(
        "relgloss_view/experiment/scaling/ordinal.py",
        "FIRST_RADIUS = 10.0",
        "10.0",
        "11.0",
        _START,
    ),
    Equivalent(
        "relgloss_view/picture/model/shape.py",
        "latitude = np.arcsin(np.clip(n[..., 1], -1.0, 1.0))",
        "np.clip(n[..., 1], -1.0, 1.0)",
        "",
        "a component over the root of its square plus others is at most 1, rounding included",
    ),
    Equivalent(
        "relgloss_view/experiment/scaling/unfolding.py",
        "self._ends = np.where(ends > 0.0, ends, 1.0)",
        "0.0",
        "1.0",
        "an axis of one step has the end 1.0 either way; ends are whole numbers",
    ),
    Equivalent(
        "relgloss_view/experiment/scaling/ordinal.py",
        "MOST_STEPS = 200",
        "200",
        "",
        _BUDGET,
    ),
    Equivalent(
        "relgloss_view/experiment/scaling/ordinal.py",
        "share = np.cumsum(loss.counts.sum(axis=0))",
        "loss.counts.sum(axis=0)",
        "(loss.counts.mean(axis=0))",
        "the shares are divided by the last one, so a common factor drops out",
    ),
    Equivalent(
        "relgloss_view/picture/model/shape.py",
        "travel = np.where(facing, -eye_m[2] / np.where(facing, dz, -1.0), 0.0)",
        "0.0",
        "1.0",
        _MISS,
    ),
    Equivalent(
        "relgloss_view/picture/model/shape.py",
        "travel = np.where(facing, -eye_m[2] / np.where(facing, dz, -1.0), 0.0)",
        "-1.0",
        "(1.0)",
        "a divisor whose quotient is not used",
    ),
    Equivalent("relgloss_view/fitting/descent.py", "TRIALS = 6", "6", "", _BUDGET),
    Equivalent(
        "relgloss_view/fitting/descent.py",
        "damping = np.full(len(states), 1e-4)",
        "1e-4",
        "",
        "where the damping begins; it follows the loss from then on",
    ),
    Equivalent(
        "relgloss_view/fitting/problem.py",
        "kd, ks = self._linear(values, weight, np.zeros(",
        "np.zeros((len(columns), self.bands))",
        "",
        _START,
    ),
    Equivalent(
        "relgloss_view/fitting/verdict.py",
        "_LARGEST_STRENGTH = 1e4",
        "1e4",
        "11000.0",
        "the upper end of a bisection, a thousand times what any sample reflects",
    ),
    Equivalent(
        "shaders/noise.glsl",
        "float radius = sqrt(max(-2.0 * log(u.x), 0.0));",
        "max(-2.0 * log(u.x), 0.0)",
        "(-2.0 * log(u.x))",
        "guards against a driver whose logarithm is above 0 near 1; Mesa's never is",
    ),
    Equivalent(
        "relgloss_view/gloss/meter/geometry.py",
        "x, wx = _gauss(SOURCE_NODES[0]) if half_x > 0.0",
        "np.zeros(1)",
        "",
        "the one node of a source of no extent is multiplied by that extent, zero",
    ),
    Equivalent(
        "relgloss_view/gloss/meter/geometry.py",
        "y, wy = _gauss(SOURCE_NODES[1]) if half_y > 0.0",
        "np.zeros(1)",
        "",
        "the one node of a source of no extent is multiplied by that extent, zero",
    ),
    Equivalent(
        "relgloss_view/material/brdf.py",
        "return np.polynomial.legendre.leggauss(96)",
        "96",
        "",
        _ORDER,
    ),
    Equivalent(
        "relgloss_view/picture/model/shape.py",
        "n = np.where(found[..., None], n, np.array([0.0, 0.0, 1.0]))",
        "0.0",
        "",
        _MISS,
    ),
    Equivalent(
        "shaders/shape.glsl",
        "float root = sqrt(max(discriminant, 0.0));",
        "max(discriminant, 0.0)",
        "",
        _MISS,
    ),
)


@dataclass(frozen=True)
class Mutant:
    """One fault of a file, chosen for the sample."""

    part: str
    file: str
    line: str  #: its text, without the indent
    fault: Mutation

    def __str__(self) -> str:
        where = f"   in {self.line}" if len(self.fault.old) < 12 else ""
        return f"{self.file}:{self.fault.line}  {self.fault}{where}"


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=300, help="faults over the whole heart")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draw")
    parser.add_argument("--module", action="append", choices=list(HEART), help="this part alone")
    parser.add_argument("--jobs", type=int, default=2, help="test runs at the same time")
    parser.add_argument("--list", action="store_true", help="print the faults and run no test")
    args = parser.parse_args()
    faults = missing()
    if faults:
        print("\n".join(f"scripts/mutants.py names {path}, which is missing" for path in faults))
        return 2
    parts = args.module or list(HEART)
    sample = [one for part in parts for one in draw(part, args.count // len(HEART), args.seed)]
    if args.list:
        print("\n".join(f"[{one.part}] {one}" for one in sample))
        return 0
    return run(sample, parts, args.jobs)


def missing() -> list[str]:
    """The paths of the table that the tree does not have."""
    paths = [p for part in HEART.values() for p in (*part.files, *part.tests)]
    return [path for path in paths if not (ROOT / path.partition("::")[0]).is_file()]


def draw(part: str, count: int, seed: int) -> list[Mutant]:
    """`count` faults of a part, spread over its files by the number of places in each."""
    places = {file: candidates(file) for file in HEART[part].files}
    total = sum(map(len, places.values()))
    sample: list[Mutant] = []
    for k, (file, groups) in enumerate(places.items()):
        last = k == len(places) - 1
        share = count - len(sample) if last else round(count * len(groups) / total)
        rng = random.Random(f"{seed} {Path(file).name}")
        mine: list[Mutant] = []
        for group in rng.sample(groups, len(groups)):
            if len(mine) == share:
                break
            fault = rng.choice(group)
            one = Mutant(part, file, line_of(file, fault), fault)
            if compiles(one):
                mine.append(one)
        sample += mine
    return sample


@lru_cache
def candidates(file: str) -> list[list[Mutation]]:
    """The faults of a file, by place, without those known to be equivalent."""
    groups = []
    for group in mutations((ROOT / file).read_text(encoding="utf-8"), Path(file).suffix):
        line = line_of(file, group[0])
        kept = [m for m in group if not any(e.covers(file, line, m) for e in EQUIVALENTS)]
        if kept:
            groups.append(kept)
    return groups


def line_of(file: str, fault: Mutation) -> str:
    """The line in which a fault begins, without its indent."""
    return (ROOT / file).read_text(encoding="utf-8").splitlines()[fault.line - 1].strip()


def compiles(one: Mutant) -> bool:
    """Whether a compiler accepts the faulty file: one that none accepts tests nothing."""
    text = one.fault.applied((ROOT / one.file).read_text(encoding="utf-8"))
    if one.file.endswith(".py"):
        try:
            compile(text, one.file, "exec")
        except SyntaxError:
            return False
        return True
    from relgloss_view.picture.gpu.shader import ShaderSource

    constants = {"FRESNEL": 0, "SHADOWING": 0, "FACETS": 0}
    stage = ShaderSource("mutant", constants, f"#version 330 core\n{text}\nvoid main() {{}}\n")
    command = ["glslangValidator", "--stdin", "-S", "frag"]
    done = subprocess.run(command, input=stage.text, capture_output=True, text=True)
    return done.returncode == 0


class Copy:
    """A copy of the tree in which one fault at a time is tried."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in COPIED:
            skip = shutil.ignore_patterns("failed", "__pycache__")
            shutil.copytree(ROOT / name, folder / name, ignore=skip)
        for name in LINKED:
            (folder / name).symlink_to(ROOT / name)
        self._clock = 1_000_000_000  # of faulty files: Python recognises stale bytecode by the time
        environment = {"PYTHONPATH": str(folder)}
        environment |= {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        self._runner = subprocess.Popen(
            [sys.executable, str(ROOT / "scripts" / "mutant_runner.py")],
            env=os.environ | environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def close(self) -> None:
        """End the process that runs the tests."""
        self._runner.communicate()

    def untouched(self, part: str) -> float:
        """Seconds of a part's tests without a fault."""
        probe = self.folder / "tests" / "test_of_the_copy.py"
        probe.write_text(
            "import relgloss_view\n\ndef test_the_copy_is_imported():\n"
            f"    assert relgloss_view.__file__.startswith({str(self.folder)!r})\n"
        )
        begin = time.monotonic()
        status, text = self._test((str(probe), *HEART[part].tests), 3600.0, keep_bytecode=False)
        if status != 0:
            raise SystemExit(f"the tests of {part} fail without a fault:\n{text[-3000:]}")
        return time.monotonic() - begin

    def kills(self, one: Mutant, limit_s: float) -> bool:
        """Whether a test fails, or never ends, with a fault."""
        path = self.folder / one.file
        text, times = path.read_text(encoding="utf-8"), path.stat()
        try:
            path.write_text(one.fault.applied(text), "utf-8")
            self._clock += 10
            os.utime(path, (self._clock, self._clock))
            return self._test(HEART[one.part].tests, limit_s, keep_bytecode=True)[0] != 0
        finally:
            path.write_text(text, "utf-8")
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
            shutil.rmtree(self.folder / ".hypothesis", ignore_errors=True)

    def _test(
        self, tests: tuple[str, ...], limit_s: float, *, keep_bytecode: bool
    ) -> tuple[int, str]:
        log = self.folder / "log.txt"
        words = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "--hypothesis-seed=0"]
        request: dict[str, Any] = {
            "words": [*words, *tests],
            "folder": str(self.folder),
            "log": str(log),
        }
        request |= {"limit_s": limit_s, "keep_bytecode": keep_bytecode}
        assert self._runner.stdin is not None
        assert self._runner.stdout is not None
        self._runner.stdin.write(json.dumps(request) + "\n")
        self._runner.stdin.flush()
        status = int(self._runner.stdout.readline())
        return status, log.read_text(encoding="utf-8")


def run(sample: list[Mutant], parts: list[str], jobs: int) -> int:
    """Try every fault, print what survives and the table; the exit status."""
    with tempfile.TemporaryDirectory(prefix="relgloss-mutants-") as folder:
        everywhere = [Copy(Path(folder) / str(k)) for k in range(jobs)]
        copies: queue.Queue[Copy] = queue.Queue()
        for copy in everywhere:
            copies.put(copy)

        def whole(part: str) -> float:
            copy = copies.get()
            try:
                return copy.untouched(part)
            finally:
                copies.put(copy)

        def tried(one: Mutant) -> bool:
            copy = copies.get()
            try:
                killed = copy.kills(one, limits[one.part])
            finally:
                copies.put(copy)
            if not killed:
                print(f"survived  {one}", flush=True)
            return killed

        with ThreadPoolExecutor(jobs) as pool:
            # Twice the time of the untouched tests, and a margin for a busy machine.
            limits = {p: 30.0 + 2.0 * s for p, s in zip(parts, pool.map(whole, parts), strict=True)}
            results = list(pool.map(tried, sample))
        for copy in everywhere:
            copy.close()
    return report(sample, results, parts)


def report(sample: list[Mutant], results: list[bool], parts: list[str]) -> int:
    """Print the table; 1 where too many survived."""
    print(f"\n{'module':12} {'mutants':>8} {'killed':>8} {'survived':>9} {'killed %':>9}")
    rows = [
        (p, [k for one, k in zip(sample, results, strict=True) if one.part == p]) for p in parts
    ]
    for name, killed in (*rows, ("all", results)):
        share = 100.0 * sum(killed) / max(len(killed), 1)
        print(
            f"{name:12} {len(killed):8} {sum(killed):8} {len(killed) - sum(killed):9} {share:9.1f}"
        )
    return 0 if sum(results) >= LEAST_KILLED * len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
