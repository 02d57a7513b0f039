"""Text in the encodings of other programs."""

from __future__ import annotations

import pytest

from relgloss_view.base.decoding import decoded, first_byte_of_no_text, wide_encoding
from relgloss_view.base.errors import InputError

TEXT = "angle;400\n0,5;1,25\n"


@pytest.mark.parametrize(
    "encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32", "cp1252"]
)
def test_ascii_is_the_same_in_all(encoding):
    found = decoded(TEXT.encode(encoding), "x")
    assert (found.text, found.note) == (TEXT, None)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_letters_beyond_ascii_in_unicode_come_without_a_note(encoding):
    text = "Bütten 45°\n" * 5
    assert decoded(text.encode(encoding), "x").text == text
    assert decoded(text.encode(encoding), "x").note is None


@pytest.mark.parametrize("encoding", ["latin-1", "cp1252"])
def test_a_code_page_is_read_with_a_note_that_names_the_line(encoding):
    found = decoded((TEXT + "Bütten 45°\n").encode(encoding), "x")
    assert found.text.endswith("Bütten 45°\n")
    assert "line 3 is not UTF-8" in found.note


def test_a_byte_that_windows_1252_leaves_open_is_no_error():
    assert decoded(TEXT.encode() + b"\x81", "x").text == TEXT + "\x81"


def test_the_end_of_a_file_in_dos_is_no_character():
    assert decoded(TEXT.encode() + b"\x1a", "x").text == TEXT


@pytest.mark.parametrize("data", [TEXT.encode("utf-16")[:-1], b"\xff\xfe\x00\xd8" * 3])
def test_damaged_utf_16_is_named(data):
    with pytest.raises(InputError, match=r"^x: byte \d+: the text is UTF-16"):
        decoded(data, "x")


def test_bytes_of_no_text():
    with pytest.raises(InputError, match="byte 0: neither"):
        decoded(b"\xfe\xed\xfa\xce" * 100, "x")
    assert first_byte_of_no_text(b"\xfe\xed\xfa\xce" * 100) == 0
    # A character cut off at the end of what was looked at is text all the same.
    assert first_byte_of_no_text("ü".encode()[:1] + b"") is None


def test_numbers_of_sixteen_bits_are_not_taken_for_utf_16():
    assert wide_encoding(bytes(range(200))) is None
    assert wide_encoding(b"\x01\x00" * 3 + b"\x00\x01" * 3) is None
