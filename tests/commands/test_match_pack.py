"""`relgloss match --pack`, and packs in the commands that draw."""

from __future__ import annotations

import json

import pytest
from test_cli import refused, run

from relgloss_view.pack.pack_file import read_pack

PACK = """\
[pack]
name = "Two finishes"
form = "cylinder"
[[finish]]
name = "ink"
material = "matte-coated"
[[finish]]
name = "spot"
kind = "varnish"
material = "art-coated"
mask = "everywhere"
"""


@pytest.fixture
def pack(tmp_path):
    file = tmp_path / "two.toml"
    file.write_text(PACK)
    return file


def test_table_and_written_pack(capsys, tmp_path, pack):
    written = tmp_path / "matched.toml"
    status, out, err = run(capsys, "match", "--pack", pack, "--write", written)
    assert status == 0
    assert "lies nowhere on the pack" in err  # the ink, below a varnish that is everywhere
    assert "Two finishes: c 0.3" in out
    assert "matched.toml: written" in out
    content = read_pack(written)
    assert [f.sigma_n_deg for f in content.finishes] == [2.0, 0.0]
    assert all(f.keeps_k for f in content.finishes)
    numbers = json.loads(run(capsys, "match", "--pack", written, "--json")[1])
    assert [f["k"] for f in numbers["finishes"]] == [f.k for f in content.finishes]
    assert [f["k_kept"] for f in numbers["finishes"]] == [True, True]
    spot = numbers["finishes"][1]
    assert spot["shown"] == pytest.approx(spot["ratio"])  # what was written is the match


def test_grain_and_pose_are_those_of_the_words(capsys, pack):
    def numbers(*words):
        return json.loads(run(capsys, "match", "--pack", pack, *words, "--json")[1])

    mean, here = numbers(), numbers("--here", "--set", "lamp.azimuth_deg=80")
    assert mean["lamp_azimuths_deg"] == [20.0, 50.0, 80.0, 110.0]
    assert here["lamp_azimuths_deg"] == [80.0]
    assert here["c"] != mean["c"]
    assert {f["sigma_n_deg"] for f in numbers("--grain", 1.5)["finishes"]} == {1.5}


def test_refused(capsys, tmp_path, pack):
    other = tmp_path / "out.toml"
    words = refused(capsys, tmp_path, "match", pack, "--write", other)
    assert f"match its finishes with --pack {pack}" in words
    words = refused(capsys, tmp_path, "match", "--pack", pack, "--reference", pack)
    assert "can't be the reference" in words
    assert "No such file" in refused(capsys, tmp_path, "match", "--pack", tmp_path / "no.toml")
