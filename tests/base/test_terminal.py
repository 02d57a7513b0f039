"""Tables line up whatever their cells hold; the bar is drawn only where someone watches."""

from __future__ import annotations

import io
import sys

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.terminal import (
    Column,
    Progress,
    SafeStream,
    make_streams_safe,
    no_progress,
    table,
    warn,
)

COLUMNS = (Column("sample", left=True), Column("gloss\n60 deg", 8), Column("note", left=True))


def test_columns_align_under_their_headings():
    text = table(COLUMNS, [("uncoated", "2.2", ""), ("art", "30.3", "glossy")], indent="  ")
    assert text.split("\n") == [
        "  sample       gloss  note",
        "              60 deg",
        "  uncoated       2.2",
        "  art           30.3  glossy",
    ]


@pytest.mark.parametrize("cell", ["a name much longer than its column", "", "Ä"])
def test_a_cell_never_moves_its_neighbours(cell):
    columns = (Column("a", 3, left=True), Column("b", 3), Column("c", 3))
    first, second, third = table(columns, [(cell, "1", "2"), ("x", "10", "20")]).split("\n")
    assert len(first) == len(second) == len(third)
    assert first.index("b") == second.rindex("1") == third.rindex("10") + 1


def test_no_heading_no_line():
    assert table([Column(), Column()], [("1", "2")]) == "1  2"
    assert table([Column("a")], []) == "a"
    assert table([Column()], []) == ""


def test_a_row_has_a_cell_for_each_column():
    with pytest.raises(ValueError, match="argument 2"):
        table([Column("a"), Column("b")], [("1",)])


class Watched(io.StringIO):
    def isatty(self):
        return True


def test_the_bar_is_cleared(monkeypatch):
    watched = Watched()
    monkeypatch.setattr(sys, "stderr", watched)
    with Progress("fit") as progress:
        assert progress(0.5, "half")
    written = watched.getvalue()
    assert "fit [============            ] half" in written
    assert written.endswith("\r")
    assert not written.split("\r")[-2].strip()


@pytest.mark.parametrize(("every_s", "expected"), [(0.0, "fit: one of 2\n"), (1e9, ""), (None, "")])
def test_a_log_gets_a_line_now_and_then(monkeypatch, every_s, expected):
    """Where nobody watches, a run of hours would be silent without."""
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with Progress("fit", every_s) as progress:
        progress(0.5, "one of 2")
    assert stream.getvalue() == expected


def test_nobody_watches(capsys):
    with Progress("fit") as progress:
        assert progress(1.0, "done")
    no_progress(1.0, "done")
    assert capsys.readouterr().err == ""


def test_a_warning_is_one_line(capsys):
    warn("two\nlines \x1b[31m" + 1000 * "x")
    error = capsys.readouterr().err
    assert error.startswith("warning: two lines \\x1b[31mxx")
    assert error.count("\n") == 1
    assert len(error) < 320


EVIL = "\x1b[31mred\x07 \x9b5m \r\u202egnp \x00\x7f\ud800"


def test_no_terminal_obeys_what_is_printed(monkeypatch):
    out = io.StringIO()
    monkeypatch.setattr(sys, "stdout", out)
    make_streams_safe()
    make_streams_safe()  # twice is once
    print(EVIL, "Büttenpapier 紙\u00a0x")
    sys.stdout.writelines([EVIL, "\n"])
    first, second, rest = out.getvalue().split("\n")
    assert rest == ""
    assert "Büttenpapier 紙" in first
    for line in (first.replace("\u00a0", ""), second):
        assert line.isprintable()
        assert line.startswith("\\x1b[31mred\\x07 \\x9b5m \\r\\u202egnp \\x00\\x7f\\ud800")


def test_a_table_and_the_bar_obey_nothing(monkeypatch):
    text = table([Column("a")], [(EVIL + "\nforged line",)])
    assert len(text.split("\n")) == 2
    assert text.split("\n")[1].isprintable()
    watched = Watched()
    monkeypatch.setattr(sys, "stderr", watched)
    make_streams_safe()
    with Progress(EVIL) as progress:
        progress(0.5, EVIL)
    assert set(watched.getvalue()) & set("\x1b\x07\x9b\x00\n") == set()
    assert watched.getvalue().endswith("\r")


@pytest.mark.parametrize("text", [EVIL, "two\nlines", "a\x85b\u2028c"])
def test_an_error_is_one_line_that_no_terminal_obeys(text):
    assert str(InputError(f"{text}: no rows")).isprintable()


class Failing(io.StringIO):
    """A stream that fails from its second text on."""

    def __init__(self, error):
        super().__init__()
        self.error = error
        self.asked = 0

    def write(self, text):
        self.asked += 1
        if self.asked > 1:
            raise self.error
        return super().write(text)

    def isatty(self):
        return True


@pytest.mark.parametrize("error", [BrokenPipeError(), OSError(28, "No space left on device")])
def test_a_stream_that_fails_ends_printing_and_nothing_else(error):
    stream = SafeStream(Failing(error))
    for text in ("a", "b", "c"):
        assert stream.write(text) == 1
    stream.flush()
    assert stream.fault is error
    assert stream.stream.getvalue() == "a"
    assert stream.stream.asked == 2


def test_the_bar_outlives_its_terminal(monkeypatch):
    """A terminal that is closed gives an input/output error to whoever prints."""
    monkeypatch.setattr(sys, "stderr", Failing(OSError(5, "Input/output error")))
    with Progress("fit") as progress:
        assert progress(0.1, "a")
        assert progress(0.2, "b")
