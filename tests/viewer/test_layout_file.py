"""The window's own file: what is written comes back; whatever else is there is the first start."""

from __future__ import annotations

import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.viewer.state import layout_file
from relgloss_view.viewer.state.layout_file import WindowLayout, load_layout, save_layout

FIRST = WindowLayout()
sides = st.integers(layout_file.SMALLEST, layout_file.LARGEST)
#: No file in UTF-8 has half a pair of surrogates.
texts = st.text(st.characters(exclude_categories=["Cs"]))
layouts = st.builds(
    WindowLayout,
    size=st.tuples(sides, sides),
    font_scale=st.sampled_from(layout_file.FONT_SCALES),
    closed=st.none() | st.lists(texts).map(tuple),
    hidden=st.booleans(),
    docking=texts,
)
OTHER = WindowLayout((640, 480), 1.5, ("Look",), True, "[Window][Look]\nPos=1,2\n")


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    return tmp_path_factory.mktemp("layout") / "window.toml"


@given(layouts)
def test_round_trip(file, layout):
    save_layout(file, layout)
    assert load_layout(file) == layout


def test_docking_as_imgui_writes_it(file):
    docking = (
        '[Window][Look]\nPos=948,21\nSize=332,751\nDockId=0x00000002,0\n\n[Docking][Data]\n"\t\\\n'
    )
    save_layout(file, WindowLayout(docking=docking))
    assert load_layout(file).docking == docking


def written(path, text):
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return load_layout(path)


@pytest.mark.parametrize(
    "text",
    [
        "", "x", "size = ", "[", "= 3", b"\xff\xfe", b"\0" * 100, '"size', "[[size]]\n[size]",
        "hidden = true\nhidden = true", "[" * 5000, "#" * (layout_file.MAX_BYTES + 1),
    ],
    ids=lambda text: repr(text[:12]),
)  # fmt: skip
def test_damaged_file(tmp_path, text):
    assert written(tmp_path / "w.toml", text) == FIRST


def test_cut_at_every_byte(tmp_path):
    """What a full disk leaves of a file is a layout that the window can take, or the first."""
    path = tmp_path / "w.toml"
    save_layout(path, OTHER)
    content = path.read_bytes()
    got = [written(path, content[:length]) for length in range(len(content) + 1)]
    assert got[0] == FIRST
    assert got[-1] == OTHER
    for layout in got:
        assert layout.size in (FIRST.size, OTHER.size)
        assert layout.font_scale in layout_file.FONT_SCALES
        assert layout.closed in (FIRST.closed, OTHER.closed)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        *(
            ("size", text)
            for text in (
                "3", "[640]", "[640, 480, 3]", "[640.0, 480]", "[true, 480]", '["640", 480]',
                "[63, 480]", "[640, 8193]", "[-640, 480]", "[640, 99999999999999999999]", "{}",
                "[[640, 480]]", "nan",
            )
        ),
        *(
            ("font_scale", text)
            for text in ("true", "'1.5'", "nan", "inf", "-1.5", "0", "1.4", "[1.5]", "{}")
        ),
        *(("closed", text) for text in ("true", "'Look'", "3", "[3, true, []]", "{Look = true}")),
        *(("hidden", text) for text in ("1", "'true'", "[true]", "{}", "nan")),
        *(("docking", text) for text in ("3", "true", "['a']", "{}", "1979-05-27")),
    ],
)  # fmt: skip
def test_wrong_type_of_one_entry_leaves_the_others(tmp_path, name, text):
    path = tmp_path / "w.toml"
    save_layout(path, OTHER)
    lines = {
        "size": "size = [640, 480]",
        "font_scale": "font_scale = 1.5",
        "closed": 'closed = ["Look"]',
        "hidden": "hidden = true",
        "docking": 'docking = "[Window][Look]\\nPos=1,2\\n"',
    }
    assert written(path, "\n".join(lines.values())) == OTHER  # the control: all are right
    lines[name] = f"{name} = {text}"
    got = written(path, "\n".join(lines.values()))
    for entry in lines:
        expected = FIRST if entry == name else OTHER
        assert getattr(got, entry) == getattr(expected, entry), entry


def test_whole_numbers_are_scales_too(tmp_path):
    got = written(tmp_path / "w.toml", "font_scale = 2").font_scale
    assert got == 2.0
    assert isinstance(got, float)


def test_titles_among_other_things(tmp_path):
    assert written(tmp_path / "w.toml", 'closed = [3, "Look", true]').closed == ("Look",)


def test_unknown_entries_are_left_alone(tmp_path):
    assert written(tmp_path / "w.toml", "colour = 'red'\nhidden = true").hidden


@pytest.mark.parametrize("place", ["gone/w.toml", ".", "pipe"])
def test_file_that_cannot_be_had(tmp_path, place):
    os.mkfifo(tmp_path / "pipe")
    assert load_layout(tmp_path / place) == FIRST


def test_place_that_takes_nothing(tmp_path):
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError):
        save_layout(tmp_path / "gone" / "w.toml", OTHER)
    assert sorted(tmp_path.rglob("*")) == before
