"""The lock files of requirements/, read."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RUNTIME, DEVELOPMENT = "runtime.txt", "development.txt"
_PIN = re.compile(r"([A-Za-z0-9][\w.-]*)(\[[\w,-]+\])?==([^\s;\\]+)(?: *; *([^\\]+?))? *\\?")
_HASH = re.compile(r"--hash=sha256:([0-9a-f]{64}) *\\?")


@dataclass(frozen=True)
class Pin:
    """A package in its one version, with the hashes of its files (SHA-256)."""

    name: str  #: normalised: lower case, with hyphens
    version: str
    hashes: tuple[str, ...] = ()
    marker: str = ""  #: where it is needed at all, as in "sys_platform == 'win32'"
    needed_by: str = "program"  #: or "tests"


def normalised(name: str) -> str:
    """A package's name as the index spells it (PEP 503).

    >>> normalised("Tomli_W")
    'tomli-w'
    """
    return re.sub(r"[-_.]+", "-", name).lower()


def read_lock(path: Path) -> dict[str, Pin]:
    """The packages of a lock file by name; ValueError for a line that is no pin and no hash."""
    pins: dict[str, Pin] = {}
    name = ""
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        if hashed := _HASH.fullmatch(text):
            pin = pins[name]
            hashes = (*pin.hashes, hashed[1])
            pins[name] = Pin(pin.name, pin.version, hashes, pin.marker)
        elif pinned := _PIN.fullmatch(text):
            name = normalised(pinned[1])
            pins[name] = Pin(name, pinned[3], (), pinned[4] or "")
        else:
            raise ValueError(f"{path}: line {number}: neither a pinned version nor a hash: {text}")
    return pins


def locked_sets(folder: Path) -> list[Pin]:
    """All packages in the order of their names; those that the program itself needs are marked."""
    runtime, development = (read_lock(folder / name) for name in (RUNTIME, DEVELOPMENT))
    return [
        Pin(p.name, p.version, p.hashes, p.marker, "program" if p.name in runtime else "tests")
        for p in sorted((runtime | development).values(), key=lambda p: p.name)
    ]
