"""The lock: pyproject.toml and requirements/ agree, every file has its hash, and make uses them."""

from __future__ import annotations

import re
import sys
import tomllib
from itertools import product
from pathlib import Path

import pytest
from packaging.markers import Marker
from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

import lock  # noqa: E402
from locked import Pin, locked_sets, normalised, read_lock  # noqa: E402

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")
SETS = {kind: read_lock(ROOT / "requirements" / f"{kind}.txt") for kind in lock.wanted()}


def disagreements(pins: dict[str, Pin], requirements: list[str]) -> list[str]:
    """The requirements that a set does not pin, or pins outside their bounds."""
    wrong = []
    for text in requirements:
        requirement = Requirement(text)
        pin = pins.get(normalised(requirement.name))
        if pin is None or not requirement.specifier.contains(pin.version):
            wrong.append(text)
    return wrong


@pytest.mark.parametrize("kind", SETS)
def test_every_requirement_is_pinned_within_its_bounds(kind):
    requirements = lock.wanted()[kind]
    assert len(requirements) > 10
    assert disagreements(SETS[kind], requirements) == []


def test_disagreements_are_found():
    pins = {"numpy": Pin("numpy", "1.26.4"), "pillow": Pin("pillow", "13.0")}
    assert disagreements(pins, ["numpy>=2", "Pillow>=11", "scipy"]) == ["numpy>=2", "scipy"]


@pytest.mark.parametrize("kind", SETS)
def test_every_package_has_hashes_of_its_files(kind):
    assert all(pin.hashes for pin in SETS[kind].values())
    assert len({h for pin in SETS[kind].values() for h in pin.hashes}) > 500


def test_the_program_is_the_same_in_both_sets():
    runtime, development = SETS["runtime"], SETS["development"]
    files = {name: (pin.version, pin.hashes) for name, pin in development.items()}
    assert {name: files.get(name) for name in runtime} == {
        name: (pin.version, pin.hashes) for name, pin in runtime.items()
    }
    # What the tests need on more platforms has a wider marker there, never a narrower one.
    for implementation, os_name, platform in product(
        ("cpython", "pypy"), ("posix", "nt"), ("linux", "darwin", "win32")
    ):
        where = {
            "implementation_name": implementation,
            "platform_python_implementation": {"cpython": "CPython", "pypy": "PyPy"}[
                implementation
            ],
            "os_name": os_name,
            "sys_platform": platform,
        }
        for name, pin in runtime.items():
            if not pin.marker or Marker(pin.marker).evaluate(where):
                wider = development[name].marker
                assert not wider or Marker(wider).evaluate(where), (name, where)
    assert {p.needed_by for p in locked_sets(ROOT / "requirements")} == {"program", "tests"}


@pytest.mark.parametrize("kind", SETS)
def test_a_lock_names_no_index_and_no_place(kind):
    text = (ROOT / "requirements" / f"{kind}.txt").read_text(encoding="utf-8")
    assert text.startswith(lock.HEADER)
    assert not re.search(r"https?:|file:|--(extra-)?index|--find-links|(^|\s)/\w", text)


@pytest.mark.parametrize(
    "line",
    [
        "numpy>=2",
        "numpy",
        "-e .",
        "--index-url there",
        "numpy @ https://x/y.whl",
        "--hash=sha256:1",
    ],
)
def test_a_line_that_pins_nothing_is_found(tmp_path, line):
    good = "numpy==2.4.6 ; python_version < '4' \\\n    --hash=sha256:" + 64 * "a" + "\n"
    (tmp_path / "lock.txt").write_text(good)
    (pin,) = read_lock(tmp_path / "lock.txt").values()
    assert (pin.name, pin.version, len(pin.hashes)) == ("numpy", "2.4.6", 1)
    (tmp_path / "lock.txt").write_text(f"{good}{line}\n")
    with pytest.raises(ValueError, match="line 3"):
        read_lock(tmp_path / "lock.txt")


def test_make_installs_from_the_lock_alone():
    installs = [line for line in MAKEFILE.splitlines() if "-m pip install" in line]
    assert len(installs) == 3
    assert sum("$(LOCKED) -r requirements/" in line for line in installs) == 2
    # The project itself, built by what is locked.
    assert sum("--no-deps --no-build-isolation -e ." in line for line in installs) == 1
    choices = [line for line in MAKEFILE.splitlines() if "LOCKED ?=" in line]
    assert choices
    assert all("--require-hashes" in line for line in choices)
    assert not (ROOT / "constraints.txt").exists()
    assert "requirements" in PROJECT["tool"]["hatch"]["build"]["targets"]["sdist"]["include"]
