"""Files for somebody else: --bare leaves out the material itself and what was measured on it."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

import relgloss_view as rg
from relgloss_view.base.errors import InputError
from relgloss_view.exchange.formats import ExportOptions, format_of, reader_of
from relgloss_view.pack.built_in import load_finish

SECRET = "goniophotometer of the mill"


@pytest.mark.parametrize("ending", [".mtlx", ".glb"])
def test_a_bare_file_holds_factors_alone(tmp_path, ending) -> None:
    material = replace(load_finish("kraft"), source=SECRET)
    written = {}
    for bare in (False, True):
        path = tmp_path / f"{bare}{ending}"
        exported = format_of(path).write(material, path, ExportOptions(bare=bare))
        assert exported.losses  # they are printed in any case
        written[bare] = path.read_bytes()
    for word in (SECRET.encode(), b"wavelengths_nm", b"de2000", b"digest", b"gloss at"):
        assert word in written[False].lower(), word  # negative control
        assert word not in written[True].lower(), word
    path = tmp_path / f"True{ending}"
    back = reader_of(path).read(path, None)
    assert back.described is not None
    path = tmp_path / f"False{ending}"
    assert reader_of(path).read(path, None) == material


def test_a_bare_pack_names_no_finish_in_extras(tmp_path) -> None:
    path = tmp_path / "can.glb"
    format_of(path).write(rg.read_pack("can"), path, ExportOptions(bare=True, most_px=64))
    data = path.read_bytes()
    content = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    assert "extras" not in json.dumps(content)
    assert b"relgloss_material" not in data
    assert {one["name"] for one in content["materials"]}


@pytest.mark.parametrize("ending", [".csv", ".xml", ".binary"])
def test_a_table_is_not_bare(tmp_path, ending) -> None:
    path = tmp_path / f"a{ending}"
    with pytest.raises(InputError, match="can't be written --bare"):
        format_of(path).write(load_finish("kraft"), path, ExportOptions(bare=True))
    assert not path.exists()
