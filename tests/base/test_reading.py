"""What comes from outside is read within bounds and printed without surprises."""

from __future__ import annotations

import json
import os

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import number, printable, read_text
from relgloss_view.material.files import load_material, material_to_dict, save_material
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene_file import load_scene

READERS = {"material": load_material, "scene": load_scene, "lamp": illuminant}


def refused(read, path):
    with pytest.raises(InputError) as caught:
        read(path)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_only_regular_files_of_a_sane_size_are_read(read, tmp_path):
    """A pipe would hang and /dev/zero would fill the memory."""
    fifo, huge = tmp_path / "fifo.csv", tmp_path / "huge.csv"
    os.mkfifo(fifo)
    assert "fifo.csv: this is not a regular file" in refused(read, str(fifo))
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    assert "not a regular file" in refused(read, str(tmp_path / "zero.csv"))
    with huge.open("wb") as file:
        file.truncate(70 * 1024 * 1024)  # sparse
    assert "huge.csv: larger than" in refused(read, str(huge))
    for name in ("gone.csv", "nul\0.csv", "x" * 300 + ".csv", "lone\ud800.csv"):
        assert "can't be read" in refused(read, str(tmp_path / name))


def test_no_more_than_the_limit_is_read(tmp_path):
    path = tmp_path / "t"
    path.write_bytes(b"\xef\xbb\xbfabc")
    assert read_text(path, 6, "a text") == "abc"
    with pytest.raises(InputError, match="larger than 5 bytes"):
        read_text(path, 5, "a text")
    path.write_bytes(b"ab\xff")
    with pytest.raises(InputError, match="byte 2: not UTF-8"):
        read_text(path, 5, "a text")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a = " + "[" * 5000, "nested too deeply"),
        ("a = " + "[" * 400 + "]" * 400, ""),
        ("[look]\nseed = " + "9" * 5000, "too many digits"),
        ("[look]\nseed = 0x" + "f" * 5000, "scene.toml"),
        ("[lamp]\nazimuth_deg = 0x" + "f" * 900, "azimuth_deg: expected"),
        ("[lamp]\nazimuth_deg = 1979-05-27", "azimuth_deg"),
        ('[sample]\nmaterial = "\\u0000"', "null"),
        ('[lamp]\nilluminant = "\\u0000.csv"', "null"),
    ],
)
def test_scene_files_of_any_content_are_one_short_line(tmp_path, text, says):
    path = tmp_path / "scene.toml"
    path.write_text(text)
    message = refused(load_scene, path)
    assert says in message
    assert "set_int" not in message
    assert "recursion" not in message
    path.write_text("[look]\nseed = 3\n", encoding="utf-8-sig")
    assert load_scene(path)[1].seed == 3


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("two\nlines\tand\x85more", "two lines and more"),
        ("\x1b[31mred\x07", "\\x1b[31mred\\x07"),
        ("a\u202eb", "a\\u202eb"),
        ("lone \ud800", "lone \\ud800"),
        ("Büttenpapier 紙", "Büttenpapier 紙"),
        ("x" * 500, "x" * 197 + "..."),
    ],
)
def test_printable(text, shown):
    assert printable(text) == shown


@pytest.mark.parametrize(
    "value", [True, "1", None, float("nan"), 10**400, -1, 16**5000], ids=range(7)
)
def test_numbers(value):
    with pytest.raises(InputError, match=r"^n: expected a number, found .{1,60}$"):
        number(value, "n", "a number", 0.0, 1e300)
    assert number(3, "n", "a number", 0.0, 4.0) == 3.0


@pytest.mark.parametrize(
    "text",
    [
        "[look]\n" + "a." * 20_000 + "a = 1",
        "[" + "a." * 20_000 + "a]",
        "x = {" + '"a" . ' * 20_000 + "a = 1}",
        "x = [1, {" + "'a'." * 20_000 + "a = 1}]",
    ],
    ids=["key", "header", "inline", "in a list"],
)
def test_keys_of_very_many_parts_are_never_parsed(monkeypatch, tmp_path, text):
    """tomllib's time for one grows with the square of its parts: 6 s for 20,000."""
    path = tmp_path / "scene.toml"
    path.write_text(text)
    monkeypatch.setattr("tomllib.loads", lambda _: pytest.fail("parsed"))
    assert "a key of more than 8 parts" in refused(load_scene, path)


def test_keys_of_a_few_parts_are(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text("# a.b.c.d.e.f.g.h.i.j.k.l = 1\nlook.seed = 3\n")
    assert load_scene(path)[1].seed == 3


@pytest.mark.parametrize(
    ("field", "value"),
    [("wavelengths_nm", [0.5] * 20_000), ("diffuse", {"model": "lambert", "albedo": [0] * 20_000})],
)
def test_lists_of_very_many_numbers_are_refused_before_each_is_looked_at(tmp_path, field, value):
    content = material_to_dict(load_sample("uncoated")) | {field: value}
    path = tmp_path / "m.json"
    path.write_text(json.dumps(content))
    assert "at most 10000 numbers, found 20000" in refused(load_material, path)


@pytest.mark.parametrize("name", ["lot [ 12 ]", "[  1,\t2 ]", "[\n]"])
def test_a_name_with_brackets_is_saved_as_it_is(tmp_path, name):
    content = material_to_dict(load_sample("uncoated")) | {"name": name}
    (tmp_path / "m.json").write_text(json.dumps(content))
    material = load_material(tmp_path / "m.json")
    save_material(material, tmp_path / "again.json")
    assert load_material(tmp_path / "again.json") == material
    assert material.name == name
