"""`relgloss gloss`: readings in the terminal and as JSON, and the hypothetical material."""

from __future__ import annotations

import json
from pathlib import Path

import materials
import pytest

from relgloss_view import cli
from relgloss_view.base.resources import asset
from relgloss_view.gloss.meter.meter import gloss_readings, specular_gloss
from relgloss_view.material.files import load_material, material_to_dict, save_material
from relgloss_view.material.material import Lobe
from relgloss_view.picture.scene.sample import SAMPLES, load_sample

PAPER = str(asset("papers", "art-coated.csv"))
FITTED = str(asset("materials", "art-coated.json"))


def run(capsys, *words):
    """Exit status, standard output, standard error of `relgloss gloss`."""
    try:
        status = cli.main(["gloss", *(str(w) for w in words)])
    except SystemExit as end:
        status = int(end.code or 0)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def refused(capsys, *words):
    """The one line of a command that ends with status 1 and prints nothing else."""
    status, out, err = run(capsys, *words)
    assert status == 1, err
    assert out == ""
    assert err.startswith("relgloss: ")
    assert err.count("\n") == 1
    return err


def samples(capsys, *words):
    status, out, err = run(capsys, *words, "--json")
    assert (status, err) == (0, "")
    return json.loads(out)["samples"]


def test_json_holds_the_readings(capsys):
    (found,) = samples(capsys, FITTED)
    expected = gloss_readings(load_material(FITTED))
    assert list(found["readings"]) == [r.key for r in expected]
    for reading in expected:
        shown = found["readings"][reading.key]
        assert shown["value"] == reading.value
        assert shown["standard_error"] == reading.standard_error
        assert shown["diffuse"] == reading.diffuse
    assert found["kind"] == "material"
    assert found["source"].startswith("synthetic")
    assert found["warnings"] == []


def test_built_in_papers_are_in_order(capsys):
    found = samples(capsys, *SAMPLES)
    assert [s["name"] for s in found] == [load_sample(name).name for name in SAMPLES]
    gloss = [s["readings"]["gloss-75"]["value"] for s in found]
    assert gloss == sorted(gloss, reverse=True)
    assert "no standard error" in found[-1]["warnings"][0]  # its broad lobe is at the limit


def test_table_in_the_terminal(capsys):
    status, out, _ = run(capsys, FITTED, PAPER)
    assert status == 0
    first, second = out.split("\n\n")
    assert first.splitlines()[0] == "art-coated, green ink"
    (line,) = [row for row in first.splitlines() if "60 deg" in row]
    value = specular_gloss(load_material(FITTED), 60)
    assert f" {value:.1f} " in line
    assert "se" in first
    assert "no incidence within 1 degree of 85" in second
    assert max(len(row) for row in first.splitlines()) <= 100


def test_fit_beside_its_table(capsys):
    fit, table = samples(capsys, FITTED, PAPER)
    assert table["kind"] == "table"
    for key in ("gloss-20", "gloss-60"):
        # 1.5 % of noise a geometry; see tests/gloss/test_gloss_meter.py.
        assert table["readings"][key]["value"] == pytest.approx(
            fit["readings"][key]["value"], rel=0.03
        )
    assert table["readings"]["gloss-85"]["value"] is None
    assert table["readings"]["gloss-85"]["reason"]


def test_options_of_a_table(capsys, tmp_path):
    lines = Path(PAPER).read_text(encoding="utf-8").splitlines()
    bare = tmp_path / "bare.csv"
    bare.write_text("\n".join(x for x in lines if not x.startswith("# quantity")))
    assert "quantity" in refused(capsys, bare)
    (whole,) = samples(capsys, PAPER)
    (found,) = samples(capsys, bare, "--quantity", "radiance-factor", "--gamma-s-deg", "15")
    assert found["readings"] == whole["readings"]


class TestOtherWayRound:
    def test_writes_a_hypothetical_material(self, capsys, tmp_path):
        path = tmp_path / "glossier.json"
        (found,) = samples(capsys, "matte-coated", "--reading", "60=45", "-o", path)
        material = load_material(path)
        assert specular_gloss(material, 60) == pytest.approx(45.0, abs=1e-4)
        assert "hypothetical" in material.source
        assert material.synthetic
        assert found["kind"] == "hypothetical"
        assert found["output"] == str(path)
        assert found["s_deg"] == [lobe.s_deg for lobe in material.specular]
        assert found["readings"]["gloss-60"]["standard_error"] is None

    def test_in_the_terminal(self, capsys, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        status, out, _ = run(capsys, FITTED, "--reading", "75=50", "-o", "new.json")
        assert status == 0
        assert "hypothetical" in out
        assert "no one has measured" in out
        assert out.endswith("new.json: written\n")

    def test_nothing_is_written_without_a_place(self, capsys, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        assert run(capsys, FITTED, "--reading", "60=20")[0] == 0
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize(
        ("words", "said"),
        [
            (["--reading", "60=450"], "it reads 1.15 to 90.4"),
            (["--reading", "45=20"], "20, 60, 75, 85"),
            (["--reading", "60=-2"], "no lobe width reads -2"),
        ],
    )
    def test_out_of_reach(self, capsys, tmp_path, words, said):
        place = tmp_path / "a.json"
        assert said in refused(capsys, "matte-coated", *words, "-o", place)
        assert list(tmp_path.iterdir()) == []

    def test_places(self, capsys, tmp_path):
        own = tmp_path / "own.json"
        save_material(materials.paper("art"), own)
        before = own.read_bytes()
        for place, said in ((own, "the material itself"), (tmp_path / "a.png", ".json"),
                            (tmp_path / "gone" / "a.json", "gone"), ("", "''")):  # fmt: skip
            assert said in refused(capsys, own, "--reading", "60=20", "-o", place)
        assert own.read_bytes() == before
        assert [p.name for p in tmp_path.iterdir()] == ["own.json"]

    def test_of_a_table_or_without_a_lobe(self, capsys, tmp_path):
        assert "not JSON" in refused(capsys, PAPER, "--reading", "60=20")
        dull = tmp_path / "dull.json"
        save_material(materials.flat(0.5), dull)
        assert "no specular lobe" in refused(capsys, dull, "--reading", "60=20")


class TestFaults:
    @pytest.mark.parametrize(
        "words",
        [
            [],
            ["uncoated", "-o", "a.json"],
            ["uncoated", "art-coated", "--reading", "60=20"],
            ["uncoated", "--reading", "60"],
            ["uncoated", "--reading", "60=much"],
            ["uncoated", "--reading", "60=nan"],
            ["uncoated", "--quantity", "gloss"],
        ],
    )
    def test_wrong_usage(self, capsys, tmp_path, monkeypatch, words):
        monkeypatch.chdir(tmp_path)
        status, out, err = run(capsys, *words)
        assert (status, out) == (2, "")
        assert "usage" in err
        assert list(tmp_path.iterdir()) == []

    def test_what_is_no_sample(self, capsys, tmp_path):
        assert "nosuch" in refused(capsys, "nosuch")
        scene = tmp_path / "a.toml"
        scene.write_text("[look]\nsigma_n_deg = 1\n", encoding="utf-8")
        assert "this is a scene" in refused(capsys, scene)
        broken = tmp_path / "broken.json"
        broken.write_text('{"format": "relgloss-material", ', encoding="utf-8")
        assert "line 1" in refused(capsys, broken)
        # One bad sample among good ones: nothing of the others is printed.
        refused(capsys, "uncoated", broken)

    @pytest.mark.parametrize("wrong", ["much", [1.0], -0.1])
    def test_standard_errors_that_are_no_numbers(self, capsys, tmp_path, wrong):
        content = material_to_dict(load_material(FITTED))
        content["fit"]["standard_errors"]["albedo_relative"] = wrong
        path = tmp_path / "edited.json"
        path.write_text(json.dumps(content), encoding="utf-8")
        err = refused(capsys, path)
        assert "edited.json: fit.standard_errors.albedo_relative" in err

    def test_control_characters_in_names_are_shown(self, capsys, tmp_path):
        material = materials.flat(0.5, (Lobe((1.0,), 3.0),))
        content = material_to_dict(material) | {"name": "a\x1b[31mb", "source": "x\ny"}
        path = tmp_path / "odd.json"
        path.write_text(json.dumps(content), encoding="utf-8")
        status, out, _ = run(capsys, path)
        assert status == 0
        assert "\x1b" not in out


class TestPercent:
    """Reflectances in percent, which would read a hundred times too high without a word."""

    def table(self, tmp_path, factor):
        lines = []
        for line in Path(PAPER).read_text().splitlines():
            numbers = line.split(",")
            if not line.startswith("#") and numbers[0].lstrip("-").replace(".", "").isdigit():
                values = [f"{factor * float(v):.6g}" for v in numbers[3:]]
                line = ",".join([*numbers[:3], *values])
            lines.append(line)
        file = tmp_path / "table.csv"
        file.write_text("\n".join(lines) + "\n")
        return file

    def test_a_table_is_refused_in_one_line(self, capsys, tmp_path):
        said = refused(capsys, self.table(tmp_path, 100.0))
        assert "percent; pass --quantity radiance-factor-percent" in said

    def test_the_option_that_it_names_reads_it(self, capsys, tmp_path):
        (whole,) = samples(capsys, self.table(tmp_path, 1.0))
        table = self.table(tmp_path, 100.0)
        (found,) = samples(capsys, table, "--quantity", "radiance-factor-percent")
        for key, reading in whole["readings"].items():
            expected = reading["value"] and pytest.approx(reading["value"], rel=1e-4)
            assert found["readings"][key]["value"] == expected

    def test_a_table_of_radiance_factors_is_not(self, capsys, tmp_path):
        (found,) = samples(capsys, self.table(tmp_path, 1.0))
        assert found["warnings"] == []

    def test_every_reader_of_the_table_refuses_it(self, tmp_path):
        from relgloss_view import InputError, read_measurement

        assert not read_measurement(self.table(tmp_path, 1.0)).warnings
        table = self.table(tmp_path, 100.0)
        with pytest.raises(InputError, match="percent"):
            read_measurement(table)
        # Whoever insists on the quantity is warned.
        insisted = read_measurement(table, quantity="radiance-factor")
        assert any("percent" in w for w in insisted.warnings)

    def test_a_material_is_warned_of(self, capsys, tmp_path):
        content = json.loads(Path(FITTED).read_text())
        for lobe in content["specular"]:
            lobe["strength"] *= 100.0
        file = tmp_path / "percent.json"
        file.write_text(json.dumps(content))
        (found,) = samples(capsys, file)
        assert any("times the light that it receives" in w for w in found["warnings"])


def test_no_more_digits_than_a_meter_shows(capsys):
    """A tenth of a unit, the error rounded up; JSON keeps all of it."""
    import re

    status, out, _ = run(capsys, "matte-coated")
    assert status == 0
    (row,) = [line for line in out.splitlines() if "75 deg" in line]
    assert re.findall(r"\d+\.\d+", row) == ["30.1", "0.1", "0.3"]
    (found,) = samples(capsys, "matte-coated")
    assert found["readings"]["gloss-75"]["value"] == pytest.approx(30.06, abs=0.01)
    assert found["readings"]["gloss-75"]["value"] != 30.1
