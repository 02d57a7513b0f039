"""Proofs that an attacker has changed and sealed again: what the seal can't find."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from proof_samples import drawable, page_of, thread

from relgloss_view.base.errors import InputError
from relgloss_view.proof.entries import check_entries
from relgloss_view.proof.grid import compare, grid_of
from relgloss_view.proof.keys import known_keys, trust
from relgloss_view.proof.page.parts import (
    MARK,
    MARKERS,
    PARTS,
    SEAL,
    UNSEALED,
    Page,
    seal_of,
    split,
)
from relgloss_view.proof.pair import Drawn
from relgloss_view.proof.pictures import is_shown, webp
from relgloss_view.proof.read import changed_words

MARKUP = '</script><meta http-equiv="refresh" content="0;url=https://a.example">'


def sealed_again(html, **changed):
    """A page with other texts of its parts, named and sealed as before."""
    texts = split(html) | changed
    again = "".join(texts[name] + marker for name, marker in zip(PARTS, MARKERS, strict=True))
    again = again.replace(MARK + UNSEALED, MARK + Page(html).named, 1)
    return again.replace(SEAL + UNSEALED, SEAL + seal_of(again), 1)


@pytest.mark.parametrize("block", ["proof", "signatures", "words", "shaders", "parts"])
def test_markup_in_a_block_is_found(block):
    """A browser takes `<` of a block for markup, though its JSON is the same."""
    html = page_of(thread(2))
    assert Page(sealed_again(html)).changes == ()
    text = split(html)[block]
    changed = MARKUP if block == "parts" else " " + text
    page = Page(sealed_again(html, **{block: changed}))
    assert page.is_sealed
    assert page.changes == (block,)


def test_markup_in_a_note_is_found():
    """The same JSON, the same digest; and `<` as it is."""
    html = page_of(thread(2))
    raw = split(html)["proof"].replace("\\u003c", "<")
    assert raw != split(html)["proof"]
    page = Page(sealed_again(html, proof=raw))
    assert page.holds_proof
    assert page.changes == ("proof",)


@pytest.mark.parametrize(
    ("what", "change"),
    [("lines", lambda html: html.replace("\n", "\r\n")), ("mark", lambda html: "\ufeff" + html)],
)
def test_what_mail_programs_and_editors_do_has_a_name(what, change):
    page = Page(change(page_of(thread(1))))
    assert page.changes == (what,)
    assert "mail programs" in changed_words(("lines",))


def _with(path, value):
    def edit(content):
        place = content
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = value

    return edit


HOSTILE = {
    "markup in a media type": _with(("pictures", "test"), {"type": f'x"{MARKUP}', "base64": ""}),
    "markup for base64": _with(("pictures", "test"), f'">{MARKUP}'),
    "a grid beyond all colours": _with(("grid", "sides", "test", "lab", 0), [1e308, 0.0, 0.0]),
    "a grid of 1e9 columns": _with(("grid", "columns"), 10**9),
    "a reading of 1e8 decimals": _with(("meter",), {"a": {"name": "a", "decimals": 10**8}}),
    "a picture of 16384 pixels": _with(("size_px",), [16384, 16384]),
    "a light that is a text": _with(("display",), {"luminance_cd_m2": "x"}),
    "sentences that are a number": _with(("display",), {"sentences": 5}),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_entries_beyond_their_bounds_are_refused(name):
    content = copy.deepcopy(thread(1).content)
    check_entries(content)
    HOSTILE[name](content)
    with pytest.raises(InputError, match="content"):
        check_entries(content)


def _picture(level):
    """A gray picture whose numbers are all one."""
    lab = np.full((32, 48, 3), 50.0, np.float32)
    number = np.full((32, 48), 50.0, np.float32)
    rgb = np.full((32, 48, 3), level, np.uint8)
    return Drawn(lab, number, number, np.ones((32, 48), bool), rgb, 1.0, 1.0)


def test_a_grid_that_gives_no_number_is_refused():
    """1e308 squared is infinite, and what follows is no number, which no bound finds."""
    drawn = _picture(90)
    grid = grid_of({"test": drawn})["sides"]["test"]
    assert compare(grid, drawn).largest < 1e-3
    grid["lab"] = [[1e308, -1e308, 1e308] for _ in grid["lab"]]
    with pytest.raises(InputError, match=r"content\.grid"):
        compare(grid, drawn)
    with pytest.raises(InputError, match=r"content\.grid"):
        compare(None, drawn)


def test_another_stored_picture_is_found():
    import base64

    coded = base64.b64encode(webp(_picture(90).rgb, 20)).decode()
    assert is_shown(coded, _picture(90).rgb)
    assert not is_shown(coded, _picture(140).rgb)
    assert not is_shown(coded, _picture(90).rgb[:16])
    assert not is_shown("AAAA", _picture(90).rgb)


def test_messages_behind_the_last_signature_are_counted():
    """A stranger's message behind a signed one looks signed."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    from relgloss_view.proof.keys import signed

    first = signed(thread(1), Ed25519PrivateKey.generate())
    assert first.unsigned == 0
    assert first.answered(first.messages[0]).unsigned == 1


@pytest.mark.parametrize("name", ["Aya ", "aya", "\uff21ya"])
def test_no_second_key_has_a_name_that_looks_the_same(tmp_path, name):
    trust(tmp_path, "00" * 32, "Aya")
    with pytest.raises(InputError, match="like it"):
        trust(tmp_path, "11" * 32, name)
    trust(tmp_path, "11" * 32, "Bo")
    assert len(known_keys(tmp_path)) == 2


@pytest.mark.parametrize("text", ["", '{"keys": {"zz": "Aya"}}', "[]"])
def test_a_damaged_table_of_keys(tmp_path, text):
    (tmp_path / "proof-keys.json").write_text(text)
    with pytest.raises(InputError, match="remove the file"):
        known_keys(tmp_path)


def test_no_lamp_of_the_reader_is_read(tmp_path, monkeypatch):
    """A message that names a file beside the reader's own work."""
    import dataclasses

    from relgloss_view.proof.unpack import opened

    monkeypatch.chdir(tmp_path)
    (tmp_path / "lamp.csv").write_text("nm,power\n" + "".join(f"{n},1\n" for n in range(380, 781)))
    proof = drawable((16, 12))
    place = dataclasses.replace(proof.sent.lamp, illuminant="lamp.csv")
    with opened(proof) as one, pytest.raises(InputError, match="no such file"):
        one.pair(dataclasses.replace(proof.sent, lamp=place))
