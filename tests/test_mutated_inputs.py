"""The harness of damaged inputs: a few of them in every run, and what it finds where a fault is."""

import dataclasses
import sys
import warnings
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "scripts"))

import mutated_inputs
from input_layouts import differences
from input_readers import Reader, readers, structured_bombs

from relgloss_view.base.errors import InputError

EVERY = readers()
FAST = [name for name in EVERY if name != "session"]  # its seed takes seconds
FEW = {
    "comma, repeated", "bracket, repeated", "digit, repeated", "line end, repeated",
    "TOML key of many parts", "TOML key of parts with quotes", "JSON nested arrays",
}  # fmt: skip


@pytest.mark.parametrize("name", FAST)
def test_damaged_files_are_read_or_refused(name, tmp_path):
    reader = EVERY[name]
    seeds = reader.seeds()
    path = tmp_path / f"input{reader.suffix}"
    outcomes = [
        mutated_inputs.attempt(
            reader, k, mutated_inputs.input_of(reader, seeds, 77, k), path, timed=False
        )
        for k in range(25)
    ]
    assert [o for o in outcomes if o.fault] == []


@pytest.mark.parametrize("bomb", sorted(FEW))
def test_a_tenth_of_the_bombs(bomb, tmp_path):
    data = mutated_inputs.all_bombs(100_000)[bomb]
    for name in ("measurement", "lamp", "material", "scene", "kind"):
        reader = EVERY[name]
        path = tmp_path / f"input{reader.suffix}"
        outcome = mutated_inputs.attempt(reader, bomb, data, path, timed=False)
        assert outcome.fault == ""


def test_files_whose_parts_claim_much(tmp_path):
    for name, data in structured_bombs(100_000):
        reader = EVERY[name.partition(":")[0]]
        path = tmp_path / f"input{reader.suffix}"
        assert mutated_inputs.attempt(reader, name, data, path, timed=False).fault == ""


def _raise(error):
    raise error


@pytest.mark.parametrize(
    ("read", "fault"),
    [
        (lambda path: {}["x"], "KeyError"),
        (lambda path: _raise(InputError("no name")), "without the file's name"),
        (lambda path: _raise(InputError(f"{path}: not enough memory")), "out of memory"),
        (lambda path: warnings.warn("of numpy", stacklevel=1), "warning: of numpy"),
        (lambda path: print("hello"), "printed: hello"),
        (lambda path: [0] * 50_000_000, "large"),
        (lambda path: sum(range(20_000_000)), "slow"),
        (lambda path: sys.exit(1), "SystemExit"),
    ],
    ids=["exception", "name", "memory", "warning", "print", "large", "slow", "exit"],
)
def test_a_planted_fault_is_found(read, fault, tmp_path, monkeypatch):
    monkeypatch.setattr(mutated_inputs, "MOST_S", 0.1 if fault == "slow" else 60.0)
    reader = Reader("planted", ".csv", read, lambda: [b"a"])
    assert fault in mutated_inputs.attempt(reader, 0, b"a", tmp_path / "input.csv").fault
    sane = Reader("sane", ".csv", lambda path: path.read_bytes(), lambda: [b"a"])
    assert mutated_inputs.attempt(sane, 0, b"a", tmp_path / "input.csv").fault == ""


@pytest.mark.parametrize("name", ["zemax", "ssdd", "astm-e1392", "alta"])
def test_other_layouts_of_a_file_have_the_same_values(name):
    found = list(differences(EVERY[name]))
    assert len(found) > 20
    assert [place for place, fault in found if fault] == []


def test_a_reader_that_exchanges_columns_is_found():
    def exchanged(path):
        reading = EVERY["alta"].read(path)
        other = b"  \n" in path.read_bytes()
        return dataclasses.replace(reading, to_lamp=reading.to_receiver) if other else reading

    reader = dataclasses.replace(EVERY["alta"], read=exchanged)
    assert any("another value" in fault for _, fault in differences(reader))


@pytest.mark.slow
def test_ten_thousand_damaged_files(capsys):
    arguments = ["--count", "10000", "--seed", "5", "--workers", "2"]
    assert mutated_inputs.main(arguments) == 0, capsys.readouterr().out


@pytest.mark.slow
def test_all_bombs(capsys):
    assert mutated_inputs.main(["--bombs", "--workers", "2"]) == 0, capsys.readouterr().out
