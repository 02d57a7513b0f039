"""A long time with the window: random sliders, sizes and samples; memory and errors stay."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "measure_viewer.py"


@pytest.mark.slow
def test_neither_memory_nor_errors_grow():
    """4,000 frames of the 20,000 that the script draws by itself, with 800 resizes and switches."""
    done = subprocess.run(
        [sys.executable, str(SCRIPT), "soak", "--frames", "4000"],
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr
    first, last = (int(mb) for mb in re.findall(r"(\d+) MB", done.stdout))
    # One texture of the smallest picture drawn here takes 0.2 MB: one that is kept by each of 800
    # resizes would show as more than 100 MB.
    assert last - first < 20
    assert "0 GL errors" in done.stdout
