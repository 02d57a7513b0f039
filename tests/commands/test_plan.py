import json

import pytest

from relgloss_view.cli import main


def test_it_tells_each_choice(capsys):
    assert main(["plan", "--sample", "uncoated", "--published", "--size", "320x240"]) == 0
    shown = capsys.readouterr().out
    for word in ("uncoated", "grain", "diffuse reflection", "shadowing G", "together:", "saved"):
        assert word in shown


def test_json_is_the_method(capsys):
    assert main(["plan", "--json", "--size", "320x240"]) == 0
    plan = json.loads(capsys.readouterr().out)
    assert plan["error"]["object_p95"] <= plan["tolerance"]["p95"] == 0.5
    stages = {choice["stage"]: choice for choice in plan["choices"]}
    assert stages["lamp"]["chosen"] == plan["method"]["lamp"] == "point"
    assert stages["lamp"]["simpler"] == "distant"
    assert stages["lamp"]["simpler_error"]["largest"] > 2.0
    assert plan["simplified"].items() <= plan["method"].items()


def test_a_wider_tolerance_saves_more(capsys):
    def saved(*words):
        assert main(["plan", "--json", "--sample", "uncoated", "--size", "320x240", *words]) == 0
        return json.loads(capsys.readouterr().out)["saved_percent"]

    assert saved("--p95", "3", "--largest", "9") > saved("--p95", "0.01")


def test_nothing_seen(capsys):
    assert main(["plan", "--set", "eye.shift_right=50"]) == 0
    assert "no pixel shows the object" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "told"),
    [(["--p95", "-1"], "tolerance.p95"), (["--size", "0x5"], "size"), (["--c", "-1"], "look.c")],
)
def test_bad_input_is_one_line(capsys, words, told):
    assert main(["plan", *words]) == 1
    captured = capsys.readouterr()
    assert told in captured.err
    assert captured.err.count("\n") == 1
    assert not captured.out


def test_snapshot_draws_it(tmp_path, capsys):
    words = ["snapshot", "--json", "--size", "200x150", "--published", "--quality"]
    pictures = {}
    for quality in ("auto", "exact"):
        path = tmp_path / f"{quality}.png"
        assert main([*words, quality, "-o", str(path)]) == 0
        pictures[quality] = json.loads(capsys.readouterr().out)
    assert main(["plan", "--json", "--size", "200x150", "--published"]) == 0
    plan = json.loads(capsys.readouterr().out)
    assert pictures["auto"]["method"] == plan["simplified"] != {}
    assert pictures["exact"]["method"] == {}
    assert pictures["auto"]["look"]["quality"] == "auto"


def test_names_of_options_are_not_shortened(capsys):
    # `match` takes samples as words: --sample must not be read as --samples.
    assert main(["match", "--sample", "uncoated"]) == 2
    assert "unrecognized arguments: --sample" in capsys.readouterr().err


@pytest.mark.parametrize("word", ["cast-coated=1", "cast-coated=nan,1", "cast-coated=-1,1"])
def test_mistyped_settings_are_told(capsys, tmp_path, word):
    assert main(["compare", word, "-o", str(tmp_path / "a.png")]) == 1
    assert "expected SIGMA_N,C after the sample" in capsys.readouterr().err
