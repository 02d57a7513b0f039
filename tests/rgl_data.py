"""Where the measured files of the RGL material database lie, for the tests that need one."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

NAMES = ("paper_white", "satin_rosaline", "cg_sunflower", "vch_golden_yellow")


def rgl_file(name: str) -> Path:
    """The path of NAME_rgb.bsdf; skips the test, with a reason, where it is absent."""
    default = Path(__file__).resolve().parents[2] / "shared" / "data" / "rgl"
    folder = Path(os.environ.get("RELGLOSS_RGL_DIR", default))
    path = folder / f"{name}_rgb.bsdf"
    if not path.is_file():
        pytest.skip(f"{path} is absent; RELGLOSS_RGL_DIR names the folder of the RGL files")
    return path
