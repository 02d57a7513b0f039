"""Fonts: which letters they have, by FreeType; what is reported where one is missing."""

from __future__ import annotations

import stat
import sys

import numpy as np
import pytest
from fonts_needed import need_east_asian
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image, ImageDraw, ImageFont

from relgloss_view.base import figures, fonts
from relgloss_view.base.errors import InputError
from relgloss_view.base.fonts import FontFile
from relgloss_view.picture.output.lettering import Lettering

NAMES = ("Größe", "γυαλί", "бумага", "光沢紙カナ", "铜版纸", "광택지", "ورق", "σ_N 2° ≤ →")


@pytest.fixture
def only(monkeypatch):
    """Makes the program find the fonts that a test gives it, and no others of the system."""

    def give(files):
        monkeypatch.setattr(fonts, "_of_the_system", lambda: list(files))
        fonts.font_files.cache_clear()

    yield give
    monkeypatch.undo()
    fonts.font_files.cache_clear()


def has_glyph(file, character):
    """Whether FreeType finds a glyph: one that differs from that of no character at all."""
    font = ImageFont.truetype(file.path, 32, index=file.index, layout_engine=ImageFont.Layout.BASIC)
    none = font.getmask("\U0010fffd")
    drawn = font.getmask(character)
    return drawn.size != none.size or bytes(drawn) != bytes(none)


def test_characters_are_those_that_freetype_finds():
    need_east_asian()
    files = fonts.font_files()
    assert len(files) >= 2
    found = {(k, c): has_glyph(f, c) for k, f in enumerate(files) for c in "aßжγ光沢かカ铜광กक"}
    assert {key: ord(key[1]) in files[key[0]].characters for key in found} == found
    assert set(found.values()) == {True, False}


@pytest.mark.parametrize("name", NAMES)
def test_nothing_is_missing_where_the_fonts_are(name):
    need_east_asian()
    assert fonts.missing(name) == ""
    assert fonts.missing_scripts() == {}


def test_what_is_missing_is_reported_with_what_mends_it(only):
    only([])
    text = "\t光沢紙 c_max 光\u200d\ufe0f"
    assert fonts.missing(text) == "光沢紙"
    (line,) = fonts.warnings({"the title": "Größe", "the consent text": text})
    assert "光 (U+5149), 沢 (U+6CA2), 紙 (U+7D19) of the consent text" in line
    assert "apt install fonts-noto-cjk" in line
    assert "the title" not in line
    assert set(fonts.missing_scripts()) == {"Japanese", "Chinese", "Korean"}
    (line,) = fonts.warnings({"a": "".join(map(chr, range(0x0E01, 0x0E0B)))})  # Thai
    assert "and 4 more" in line
    assert "apt" not in line
    assert fonts.VARIABLE in line


def test_letters_that_the_window_does_not_join_are_reported(only):
    only([])
    (line,) = fonts.warnings({"a label": "ورق"})
    assert "a label" in line
    assert "unjoined" in line
    assert fonts.warnings({"a label": "ورق"}, shaped=True) == []
    assert fonts.warnings({"a label": "Größe, бумага"}) == []


class TestNamedFiles:
    def test_a_named_font_is_used(self, only, monkeypatch):
        need_east_asian()
        file = fonts.font_files()[1]
        only([])
        assert fonts.missing("광택지")
        monkeypatch.setenv(fonts.VARIABLE, file.path)
        only([])
        assert FontFile(file.path) in fonts.font_files()
        assert fonts.missing("광택지") == ""

    @pytest.mark.parametrize("kind", ["absent", "no font", "folder"])
    def test_what_is_no_font_is_one_clear_line(self, only, monkeypatch, tmp_path, kind):
        path = tmp_path / "letters.ttf"
        if kind == "no font":
            path.write_bytes(b"OTTO" + bytes(64))
        elif kind == "folder":
            path.mkdir()
        monkeypatch.setenv(fonts.VARIABLE, str(path))
        only([])
        with pytest.raises(InputError, match=r"letters\.ttf") as caught:
            fonts.font_files()
        assert "\n" not in str(caught.value)


class TestFontconfig:
    def answer(self, folder, monkeypatch, text):
        """Let fc-match print something, whatever it is asked."""
        program = folder / "fc-match"
        program.write_text(f"#!/bin/sh\nprintf '%s' '{text}'\n")
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("PATH", str(folder))

    def test_a_font_without_the_language_is_not_taken(self, tmp_path, monkeypatch):
        """fc-match always names a font, the nearest."""
        path = str(fonts.dejavu())
        self.answer(tmp_path, monkeypatch, f"{path}\n0\nde|en|el")
        assert fonts._by_fontconfig("ja") is None
        self.answer(tmp_path, monkeypatch, f"{path}\n65537\nde|ja|el")
        assert fonts._by_fontconfig("ja") == FontFile(path, 1)

    @pytest.mark.parametrize("text", ["", "a", "/nowhere.ttf\n0\nja", "/etc/passwd\nx\nja"])
    def test_odd_answers_are_no_font(self, tmp_path, monkeypatch, text):
        self.answer(tmp_path, monkeypatch, text)
        assert fonts._by_fontconfig("ja") is None

    def test_without_it_known_paths_are_looked_at(self, tmp_path, monkeypatch):
        need_east_asian()
        place = next(f.path for f in fonts.font_files() if ord("光") in f.characters)
        broken = tmp_path / "broken.ttf"
        broken.write_bytes(b"no font")
        monkeypatch.setenv("PATH", str(tmp_path))
        paths = (str(tmp_path / "absent.ttf"), str(broken), place)
        monkeypatch.setattr(fonts, "KNOWN_PATHS", {sys.platform: paths})
        assert fonts._of_the_system() == [FontFile(place)]

    def test_the_users_own_language_comes_first(self, monkeypatch):
        for name in ("LC_ALL", "LC_CTYPE", "LANG"):
            monkeypatch.delenv(name, raising=False)
        assert fonts._languages()[0] == "ja"
        monkeypatch.setenv("LANG", "zh_TW.UTF-8")
        assert fonts._languages()[0] == "zh-tw"
        assert sorted(fonts._languages()) == sorted(fonts.LANGUAGES)


LETTERS = st.text(st.sampled_from("ab c\u0301ß光沢광ж\n\u200d"), max_size=12)


@given(LETTERS)
def test_runs_are_the_text_each_in_a_font_that_has_it(text):
    held = (frozenset(map(ord, "ab cß")), frozenset(map(ord, "ж光沢")), frozenset(map(ord, "광光")))
    parts = fonts.runs(text, held)
    assert "".join(part for _, part in parts) == text
    for number, part in parts:
        for c in part:
            first = next((k for k, characters in enumerate(held) if ord(c) in characters), 0)
            assert number == first or c in " \u0301\n\u200d"


# --- on sheets and figures ------------------------------------------------------------------------


def drawn(write):
    """What a function draws with a pen on black, as numbers (H, W)."""
    sheet = Image.new("L", (300, 40))
    write(ImageDraw.Draw(sheet))
    return np.asarray(sheet).astype(int)


@pytest.mark.parametrize(("text", "anchor"), [("cast-coated, c 0.5", "la"), ("c ± 0.5° “a”", "mm")])
def test_plain_names_on_sheets_are_drawn_as_by_pillow_alone(text, anchor):
    font = ImageFont.load_default(16)
    alone = drawn(lambda pen: pen.text((150, 12), text, fill=255, font=font, anchor=anchor))
    ours = drawn(lambda pen: Lettering(16).draw(pen, (150, 12), text, 255, anchor))
    np.testing.assert_array_equal(ours, alone)
    assert alone.max() > 200


@pytest.mark.parametrize("text", ["光沢紙", "광택지", "бумага", "ورق", "Größe"])
@pytest.mark.parametrize("anchor", ["la", "lm", "mm"])
def test_other_names_on_sheets_have_their_letters(text, anchor):
    need_east_asian()
    file = next(f for f in fonts.font_files() if all(ord(c) in f.characters for c in text))
    font = ImageFont.truetype(file.path, 16, index=file.index)
    low = {"l": 20, "m": 20 + font.getlength(text) / 2}[anchor[0]]
    ours = drawn(lambda pen: Lettering(16).draw(pen, (low, 12), text, 255, anchor))
    alone = drawn(lambda pen: pen.text((20, 30), text, fill=255, font=font, anchor="ls"))
    rows = [np.flatnonzero(image.any(axis=1)) for image in (ours, alone)]
    np.testing.assert_allclose(
        ours[rows[0][0] : rows[0][-1] + 1], alone[rows[1][0] : rows[1][-1] + 1], atol=90
    )
    own = ImageFont.load_default(16)  # the control: its signs for what it has not
    boxes = drawn(lambda pen: pen.text((20, 30), text, fill=255, font=own, anchor="ls"))
    assert np.abs(boxes - alone).mean() > 2.0


def test_figures_have_the_letters(tmp_path, only, recwarn):
    need_east_asian()

    def complaints(text):
        recwarn.clear()
        with figures.drawing():
            import warnings

            warnings.simplefilter("always")
            figure = figures.new_figure(3.0, 0.5, 72)
            figure.text(0.0, 0.2, text)
            figures.save_figure(figure, tmp_path / "figure.png")
        return [str(w.message) for w in recwarn if "Glyph" in str(w.message)]

    for name in NAMES:
        assert complaints(name) == []
    only([])
    assert len(complaints("光沢紙")) == 3
