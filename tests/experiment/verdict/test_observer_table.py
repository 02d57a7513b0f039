"""The table of docs/experiment.md, from what `simulate --json` prints."""

from __future__ import annotations

import importlib.util
from pathlib import Path

SCRIPT = Path(__file__).resolve().parents[3] / "scripts" / "observer_table.py"


def script():
    spec = importlib.util.spec_from_file_location("observer_table", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def case(exact, inside, status):
    c_inside = None if inside is None else True
    return {
        "exact": exact, "near": True, "in_set": exact, "sigma_n_inside": inside,
        "c_inside": c_inside, "status": status,
    }  # fmt: skip


def test_rows_of_several_files_are_put_together():
    """By hand: one of two is exact; the one with an interval holds sigma_N; one of two is best."""
    one = {"kind": "unique", "grain_weight": -4.0, "one_best": True,
           "studies": [case(True, None, "best")]}  # fmt: skip
    other = {**one, "studies": [case(False, True, "broad")]}
    mixed = {"kind": "two-optima", "grain_weight": None, "one_best": False,
             "studies": [case(True, False, "ridge"), case(True, False, "broad")]}  # fmt: skip
    lines = script().table([{"tables": [one, mixed]}, other])
    head, rule, first, second, _, count = lines
    assert head.count("|") == rule.count("|") == first.count("|") == second.count("|")
    assert first == (
        "| unique | -4 | 50 % | 100 % | 50 % | 100 %, 100 % of 1 | best 50 %, broad 50 % |"
    )
    assert second == (
        "| two-optima | sees no picture | 100 % | 100 % | 100 % | 0 %, 100 % | "
        "ridge 50 %, broad 50 %; *best* is wrong |"
    )
    assert count == "Samples judged in each row: 2."
