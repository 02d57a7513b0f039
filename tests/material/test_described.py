"""Materials that another program's parameters describe."""

from __future__ import annotations

import dataclasses
import json

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material.described import DescribedRecord
from relgloss_view.material.files import load_material, material_to_dict, save_material
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import RGB

RECORD = DescribedRecord(
    "OpenPBR surface", {"specular_roughness": 0.3}, ("coat_color",), {"de2000_p95": 1.5}
)
MATERIAL = Material(
    "varnish",
    "shop.mtlx",
    RGB,
    Diffuse("lambert", (0.2, 0.3, 0.4)),
    (Lobe((1.0,), 4.0),),
    described=RECORD,
)


def test_a_described_material_comes_back_from_its_file(tmp_path):
    save_material(MATERIAL, tmp_path / "a.json")
    assert load_material(tmp_path / "a.json") == MATERIAL
    bare = dataclasses.replace(MATERIAL, described=None)
    assert "described" not in material_to_dict(bare)  # older programs read these files


def test_it_is_marked_wherever_a_caption_states_the_origin():
    assert MATERIAL.marks == "described"
    assert MATERIAL.evidence_words == "described, not measured"
    assert MATERIAL.warnings == ("not carried over from OpenPBR surface: coat_color",)
    assert "yes, as OpenPBR surface" in MATERIAL._repr_html_()


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ([], "described: expected an object"),
        ({}, "described.model: expected a text"),
        ({"model": "x", "not_carried": "coat"}, "described.not_carried: expected a list"),
        ({"model": "x", "not_carried": [1]}, "described.not_carried[0]: expected a text"),
        ({"model": "x", "parameters": 3}, "described.parameters: expected an object"),
        ({"model": "x", "losses": {str(k): k for k in range(1001)}}, "described.losses: expected"),
        ({"model": "x", "losses": {"a": float("inf")}}, "expected finite numbers"),
    ],
)
def test_a_wrong_record_is_one_line(tmp_path, entry, words):
    content = material_to_dict(MATERIAL) | {"described": entry}
    path = tmp_path / "a.json"
    path.write_text(json.dumps(content).replace("Infinity", "1e999"))
    with pytest.raises(InputError) as caught:
        load_material(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
