"""Where the two scanned packs (YCB, CC-BY-4.0) lie, for the tests that need one."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

NAMES = ("mustard_bottle", "sugar_box")


def scanned_pack(name: str) -> str:
    """The path of NAME.obj; skips the test, with a reason, where it is absent."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data" / "meshes"
    folder = Path(os.environ.get("RELGLOSS_SCANS_DIR", default))
    path = folder / f"{name}.obj"
    if not path.is_file():
        pytest.skip(f"{path} is absent; RELGLOSS_SCANS_DIR names the folder of the scanned packs")
    return str(path)
