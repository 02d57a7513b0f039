"""`relgloss export` and `relgloss import`: status, words, JSON and whole files."""

from __future__ import annotations

import json

import pytest

from relgloss_view.cli import main
from relgloss_view.material.files import load_material


def test_out_and_in(tmp_path, capsys):
    out, back = tmp_path / "u.mtlx", tmp_path / "u.json"
    assert main(["export", "satin-varnish", "-o", str(out)]) == 0
    printed = capsys.readouterr()
    # One sentence for a designer first, then the numbers.
    first, second, *rest = printed.out.splitlines()
    assert "satin_varnish: the highlight looks nearly the same, and the gloss is kept (60" in first
    assert "highlight dE2000 p95" in second
    assert len(rest) < 5
    assert not printed.err
    assert main(["import", str(out), "-o", str(back)]) == 0
    assert "unchanged" in capsys.readouterr().out
    assert load_material(back).name == "satin varnish"
    assert main(["export", str(back), "-o", str(out), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["is_small"] is (max(v["de2000_p95"] for v in content["losses"].values()) < 3.0)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["u.json", "u.mtlx"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["export", "uncoated", "-o", "x.txt"], "expected a name that ends with one of .mtlx"),
        (["export", "nothing-here", "-o", "x.mtlx"], "nothing-here"),
        (["export", "uncoated", "-o", "x.mtlx", "--pixels", "3"], "expected 16 to"),
        (
            ["export", "uncoated", "-o", "x.csv", "--grid", "in-plane:nan"],
            "expected a step from 0.1 to",
        ),
        (["import", "nothing-here", "-o", "x.json"], "nothing-here"),
    ],
)
def test_faults_are_one_line(tmp_path, monkeypatch, capsys, words, said):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 1
    printed = capsys.readouterr()
    assert said in printed.err
    assert len(printed.err.splitlines()) == 1
    assert not list(tmp_path.iterdir())


def test_another_file_is_no_description(tmp_path, capsys):
    (tmp_path / "a.mtlx").write_text("hello")
    assert main(["import", str(tmp_path / "a.mtlx"), "-o", str(tmp_path / "a.json")]) == 1
    assert "expected a material of MaterialX" in capsys.readouterr().err
