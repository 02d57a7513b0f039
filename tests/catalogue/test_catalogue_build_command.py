"""`relgloss catalogue build` as it is typed: its lines, its exit status, its options."""

from __future__ import annotations

import json
import shlex
import shutil

import pytest
from catalogue_trees import BROKEN_TABLE, contents, quick_item, quick_tree, save

from relgloss_view import cli
from relgloss_view.base.resources import asset
from relgloss_view.catalogue import build as building
from relgloss_view.catalogue.catalogue import Catalogue
from relgloss_view.gloss.match import full_c
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.picture.scene.sample import load_sample


@pytest.fixture
def quick(monkeypatch):
    monkeypatch.setattr(building, "make_item", quick_item)


@pytest.fixture
def build(tmp_path, capsys, monkeypatch):
    """Runs the command on tmp_path/tree; returns status, lines of stdout, lines of stderr."""
    monkeypatch.setattr("relgloss_view.commands.catalogue_build.LOGGED_S", None)

    def run(*options):
        words = ["catalogue", "build", str(tmp_path / "tree"), "-o", str(tmp_path / "stock")]
        status = cli.main([*words, "--workers", "1", *options])
        seen = capsys.readouterr()
        return status, seen.out.splitlines(), seen.err.splitlines()

    return run


def test_what_was_done_is_printed(quick, tmp_path, build):
    quick_tree(tmp_path / "tree")
    (tmp_path / "tree" / "notes.txt").write_text("no sample", encoding="utf-8")
    (tmp_path / "tree" / "can.glb").write_bytes(b"glTF")
    status, out, err = build()
    assert (status, err) == (0, [])
    assert out == [
        "6 files: 6 done, 0 failed",
        "6 new or changed; 0 only metered and drawn again; 0 unchanged",
        "2 files passed over: no table, material or proof",
        "is one of these a table? `relgloss measure FILE` prints what is wrong:",
        "  notes.txt",
        "materials of other programs; `relgloss import FILE -o MATERIAL.json` reads them:",
        "  can.glb",
        f"{tmp_path}/stock/catalogue.parquet: written",
    ]
    shutil.rmtree(tmp_path / "tree" / "lot 0")
    status, out, _ = build("--json")
    report = json.loads(out[0])
    assert (status, report["unchanged"], report["removed"], report["is_complete"]) == (
        0,
        4,
        2,
        True,
    )


def test_fits_that_are_not_good_are_counted() -> None:
    """Else a foil that no model describes is wrong in silence."""
    report = building.Report(rows=3, done=3, is_complete=True, qualities={"good": 2, "poor": 1})
    assert building.words_of(report, "my stock")[1] == (
        "fits: 2 good, 1 poor; gloss and pictures of the others may be wrong: "
        "relgloss catalogue search 'my stock' 'quality is not good'"
    )
    report.qualities = {"good": 3}
    assert building.words_of(report, "stock")[1] == "fits: 3 good"


def test_faults_end_a_build_unless_it_keeps_going(quick, tmp_path, build):
    quick_tree(tmp_path / "tree")
    for k in range(25):
        save(tmp_path / "tree" / f"broken-{k:02d}.json")
    status, out, err = build()
    assert status == 1
    assert err[0] == "relgloss: broken-00.json: line 3: is broken"
    assert len(err) == 2
    assert "the table is not written, because of this fault; 0 of 31 files are done" in err[1]
    # The line ends with what can be pasted.
    assert shlex.split(err[1].rpartition(": ")[2])[:4] == [
        "relgloss", "catalogue", "build", "--keep-going",
    ]  # fmt: skip
    status, out, err = build("--keep-going")
    assert status == 1
    assert out[0] == "31 files: 6 done, 25 failed"
    assert len(err) == 21
    assert err[-1] == "relgloss: 5 more faults; the table has them all in its column fault"
    rows = Catalogue.open(tmp_path / "stock").rows
    assert sum(row["fault"] == "line 3: is broken" for row in rows) == 25


def test_the_settings_of_the_command_are_in_the_recipe(quick, tmp_path, build):
    quick_tree(tmp_path / "tree", 1)
    build("--reference", "matte-coated=2.0,2/6", "--gloss", "gloss-60", "--model", "lobe",
          "--refractive-index", "1.45", "--gamma-s-deg", "5")  # fmt: skip
    recipe = Catalogue.open(tmp_path / "stock").recipe
    assert (recipe.reference, recipe.reference_sigma_n_deg) == ("matte-coated", 2.0)
    assert recipe.reference_c == pytest.approx(2 / 6 * full_c(load_sample("matte-coated")))
    assert (recipe.gloss, recipe.fit) == ("gloss-60", {"model": "lobe", "refractive_index": 1.45})
    assert recipe.table == {"gamma_s_deg": 5.0}
    build("--reference", str(asset("materials", "uncoated.json")))
    recipe = Catalogue.open(tmp_path / "stock").recipe
    assert isinstance(recipe.reference, dict)
    assert recipe.reference["name"] == "uncoated, green ink"
    assert recipe.reference_c is None


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--reference", "can.toml"], "can.toml"),
        (["--reference", "nothing"], "nothing"),
        (["--refractive-index", "20"], "--refractive-index 20"),
        (["--workers", "0"], "--workers 0: expected 1 to"),
        (["--scheduler", "localhost"], "expected tcp://HOST:PORT"),
        (["-o", ""], "empty name"),
    ],
)
def test_a_wrong_option_is_one_line_and_nothing_is_worked_on(
    quick, tmp_path, build, options, words
):
    quick_tree(tmp_path / "tree", 1)
    status, out, err = build(*options)
    assert (status, out) == (1, [])
    assert len(err) == 1
    assert words in err[0]
    assert not [*tmp_path.glob("stock/items/*/*")]


def test_a_real_fault_names_file_and_place(tmp_path, build):
    save(tmp_path / "tree" / "paper.json")
    (tmp_path / "tree" / "lot 1").mkdir()
    (tmp_path / "tree" / "lot 1" / "broken.csv").write_text(BROKEN_TABLE, encoding="utf-8")
    status, out, err = build("--keep-going")
    assert status == 1
    assert out[0] == "2 files: 1 done, 1 failed"
    assert err[0].startswith("relgloss: lot 1/broken.csv: none of the 1 samples")
    assert err[0].count("broken.csv") == 1
    before = contents(tmp_path / "stock")
    assert build("--keep-going")[1][1].endswith("2 unchanged")
    assert contents(tmp_path / "stock") == before


def test_a_proof_is_a_sample_with_its_own_grain(tmp_path, build):
    (tmp_path / "tree").mkdir()
    proof = str(tmp_path / "tree" / "matte.html")
    words = ["proof", "make", "matte-coated", "-o", proof, "--size", "64x64", "--title", "Matte"]
    assert cli.main(words) == 0
    assert build()[0] == 0
    row = Catalogue.open(tmp_path / "stock").row("matte.html")
    assert (row["kind"], row["name"]) == ("proof", "Matte")
    assert row["gloss_75"] == pytest.approx(
        specular_gloss(load_sample("matte-coated"), 75.0), rel=1e-9
    )
    assert row["sigma_n_deg"] > 0.0
