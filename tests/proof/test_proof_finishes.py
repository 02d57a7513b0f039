"""The readings of a pack's finishes in a proof: within bounds, and those of its own materials."""

from __future__ import annotations

import copy

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.proof.entries import check_entries
from relgloss_view.proof.meter import are_same_finishes

METER = {"gloss-60": {"name": "60\u00b0", "decimals": 1}}
OWN = [
    {"finish": "foil", "kind": "foil", "material": "gold", "lies_somewhere": True,
     "readings": {"gloss-60": 584.8}},
    {"finish": "spare", "kind": "varnish", "material": "matte", "lies_somewhere": False,
     "readings": {"gloss-60": None}},
]  # fmt: skip


@pytest.mark.parametrize(
    ("finishes", "named"),
    [
        ({}, "meter_finishes"),
        ([OWN[0]] * 101, "meter_finishes"),
        (["foil"], "meter_finishes[0]"),
        ([{"finish": 3, "readings": {}}], "finish"),
        ([{"finish": "a"}], "readings"),
        ([{"finish": "a", "readings": {"g": "<b>"}}], "readings['g']"),
        ([{"finish": "a", "readings": {"g": 1e9}}], "readings['g']"),
        ([{"finish": "a", "readings": dict.fromkeys(map(str, range(101)), 1.0)}], "readings"),
    ],
)
def test_finishes_beyond_bounds_are_refused(finishes, named):
    content = {"size_px": [8, 8], "meter_finishes": finishes}
    with pytest.raises(InputError) as refused:
        check_entries(content)
    assert f"content.{named}" in str(refused.value) or named in str(refused.value)
    check_entries({**content, "meter_finishes": OWN})  # the negative control


def test_finishes_are_those_of_the_pack():
    assert are_same_finishes(copy.deepcopy(OWN), OWN, METER)
    assert are_same_finishes(None, [], METER)
    close, other, renamed = (copy.deepcopy(OWN) for _ in range(3))
    close[0]["readings"]["gloss-60"] += 0.05  # which no meter shows
    assert are_same_finishes(close, OWN, METER)
    other[0]["readings"]["gloss-60"] += 0.2
    renamed[0]["finish"] = "varnish"
    for forged in (other, renamed, OWN[:1], None):
        assert not are_same_finishes(forged, OWN, METER)
