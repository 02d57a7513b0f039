"""A catalogue in memory, of rows that are declared in a test, and what a search has found there."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
from made_catalogue import MemoryCatalogue

__all__ = ["MemoryCatalogue", "paths"]


def paths(found):
    return [hit.path for hit in found.hits]
