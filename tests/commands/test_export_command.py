"""`relgloss export` and `relgloss import`: status, words, JSON and whole files."""

from __future__ import annotations

import json

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.cli import main
from relgloss_view.commands.outputs import files_behind, refuse_read
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


def test_no_file_that_is_read_is_replaced(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    grid = "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n20,0,20,180\n"
    (tmp_path / "grid.csv").write_text(grid)
    (tmp_path / "glass.json").write_text('{"asset": {"version": "2.0"}, "materials": [{}]}')
    (tmp_path / "other.csv").symlink_to("grid.csv")
    for words in (
        ["import", "glass.json", "-o", "./glass.json"],
        ["export", "kraft", "--grid", "grid.csv", "-o", "other.csv"],
    ):
        before = (tmp_path / words[-1]).read_text()
        assert main(words) == 1
        assert "this is the file that is read" in capsys.readouterr().err
        assert (tmp_path / words[-1]).read_text() == before


def test_a_material_file_ends_in_json(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.gltf").write_text('{"asset": {"version": "2.0"}, "materials": [{}]}')
    assert main(["import", "a.gltf", "-o", "a.glb"]) == 1
    assert "expected a name that ends in .json" in capsys.readouterr().err
    assert not (tmp_path / "a.glb").exists()


def test_options_of_other_formats_are_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "grid.csv").write_text("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n20,0,20,180\n")
    words = ["export", "kraft", "--grid", "grid.csv", "--basis", "klems", "-o", "k.csv"]
    assert main(words) == 0
    error = capsys.readouterr().err
    assert "--basis changes nothing in a file of CSV" in error
    assert "--grid" not in error


@pytest.mark.parametrize(
    "words",
    [
        ("snapshot", "--artwork", "a.png", "--size", "32x32", "-o", "a.png"),
        ("snapshot", "--pack", "can.toml", "--size", "32x32", "-o", "a.png"),
        ("snapshot", "--pack", "can.toml", "--size", "32x32", "-o", "link.png"),
        ("compare", "can.toml", "-o", "a.png"),
        ("match", "a.png", "-o", "a.png"),
        ("view", "a.png", "--screenshot", "a.png"),
    ],
)
def test_no_artwork_is_replaced_by_a_picture_of_it(words, tmp_path, monkeypatch, capsys):
    """A pack beside its artwork of the same name is what `pack new` makes."""
    from PIL import Image

    monkeypatch.chdir(tmp_path)
    Image.new("RGB", (16, 16), (200, 30, 30)).save("a.png")
    (tmp_path / "link.png").symlink_to("a.png")
    assert main(["pack", "new", "a.png", "-o", "can.toml"]) == 0
    before = (tmp_path / "a.png").read_bytes()
    assert main([*words]) == 1
    assert "this is the file that is read" in capsys.readouterr().err
    assert (tmp_path / "a.png").read_bytes() == before


def test_the_mesh_of_a_pack_is_read_too(tmp_path):
    """`export can.toml -o can.glb` would replace a designer's own can.glb."""
    from relgloss_view.pack.built_in import load_finish
    from relgloss_view.pack.finish import Finish
    from relgloss_view.pack.pack import Pack
    from relgloss_view.pack.shape import Shape

    mesh, link, other = tmp_path / "can.obj", tmp_path / "link.obj", tmp_path / "other.obj"
    mesh.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
    link.hardlink_to(mesh)
    other.write_bytes(mesh.read_bytes())
    board = Finish("board", "stock", load_finish("bare-board"), "bare-board")
    pack = Pack("can", Shape("mesh", file=str(mesh), unit="m"), (board,))
    files = files_behind([("can.json", None), (None, pack)])
    assert files == ["can.json", str(mesh)]
    with pytest.raises(InputError, match="this is the file that is read"):
        refuse_read(link, files)
    refuse_read(other, files)
