"""The file of a proof: written, read, sealed, and every change of it found and named."""

from __future__ import annotations

import collections
import random

import proof_samples as samples
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.proof.page.parts import MARK, SEAL, Page, joined, script_json, split
from relgloss_view.proof.proof import Message, Proof, Signature, canonical
from relgloss_view.proof.read import is_proof, part_words, proof_of, read_proof


@pytest.fixture(autouse=True)
def _small_page(monkeypatch, tmp_path_factory):
    samples.small_page(monkeypatch, tmp_path_factory.mktemp("page"))


def written(path, proof):
    path.write_bytes(samples.page_of(proof).encode("utf-8"))
    return path


def resealed(proof_json, signatures="[]"):
    """A page with right digests and seal around whatever JSON, as a forger makes it."""
    texts = split(samples.page_of(samples.thread(1)))
    text = proof_json if isinstance(proof_json, str) else script_json(proof_json)
    texts |= {"proof": text, "signatures": signatures}
    digest = Page(joined(texts, "0" * 64)).digest or "1" * 64
    return Page(joined(texts, digest))


def test_what_is_written_is_read(tmp_path):
    for count in (1, 3, 20):
        proof = samples.thread(count)
        again = read_proof(written(tmp_path / "a.html", proof))
        assert again == proof
        assert again.digests == proof.digests


def test_recognised_by_content(tmp_path):
    assert is_proof(written(tmp_path / "a.txt", samples.thread(1)))
    (tmp_path / "b.html").write_text("<!DOCTYPE html>\n<html><p>relgloss-proof")
    assert not is_proof(tmp_path / "b.html")


def test_digests_name_every_proof_of_the_thread():
    proof = samples.thread(20)
    for k in range(20):
        assert Proof(proof.content, proof.messages[: k + 1]).digest == proof.digests[k]
    assert [m.parent for m in proof.messages[1:]] == list(proof.digests[:-1])
    assert len(set(proof.digests)) == 20


def test_a_thousand_single_bytes():
    """Every one is found; the part that holds it is named by where it lies in the page."""
    data = samples.page_of(samples.thread(3)).encode("utf-8")
    chosen, found = random.Random(19), collections.Counter()
    for _ in range(1000):
        at, changed = chosen.randrange(len(data)), bytearray(data)
        changed[at] ^= chosen.randrange(1, 256)
        page = Page(bytes(changed).decode("utf-8", errors="replace"))
        assert page.changes, (at, changed[at])
        with pytest.raises(InputError, match=r"changed after|not a proof|newer"):
            proof_of(page)
        found[page.changes[0].partition("/")[0]] += 1
    assert {"head", "style", "static", "content", "messages", "parts", "script"} <= set(found)
    assert not Page(data.decode()).changes


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("weniger «Glanz» \U0001f642 2", "weniger «Glans» \U0001f642 2", "messages/3/note"),
        ('"author":"Aya"', '"author":"Aia"', "messages/1/author"),
        ('"c":1.125', '"c":1.126', "messages/2/settings"),
        ("return 1.0 ", "return 1.1 ", "shaders/a.glsl"),
        ("<h1>Dose", "<h1>Rose", "static"),
        ("body {", "bodi {", "style"),
        ("window.relgloss", "window.relglos5", "script"),
        ('"pictures":{"reference":{"base64":"AAEC', '"pictures":{"reference":{"base64":"AAED',
         "content/pictures/reference"),
        ('a = \\"\\u003cb>', 'a = \\"\\u003cc>', "content/files/scene.toml"),
        ("1.0 \\u003c", "1.0 \\u003C", "shaders"),  # the same values, written otherwise
        ("5e-324", "5E-324", "proof"),
        ('"signatures">[]', '"signatures">[ ]', "signatures"),
        ("width=device", "width=devise", "head"),
        ('"style":"', '"style":"0', "parts"),
    ],
)  # fmt: skip
def test_changes_are_named(old, new, part):
    html = samples.page_of(samples.thread(3))
    assert old in html
    assert Page(html.replace(old, new, 1)).changes == (part,)


def test_seal_and_name_themselves():
    html = samples.page_of(samples.thread(2))
    page = Page(html)
    for mark, stated, part in ((SEAL, page.seal, "seal"), (MARK, page.named, "name")):
        other = "0" if stated[0] != "0" else "1"
        assert Page(html.replace(mark + stated[0], mark + other)).changes == (part,)
        assert part_words(part) in str(_error(html.replace(mark + stated[0], mark + other)))


def _error(html):
    with pytest.raises(InputError) as caught:
        proof_of(Page(html))
    return caught.value


def as_json(count=2):
    return samples.thread(count).as_json()


def edited(**changes):
    proof = as_json()
    for path, value in changes.items():
        *steps, last = path.split("__")
        part = proof
        for step in steps:
            part = part[int(step) if isinstance(part, list) else step]
        if value is KeyError:
            del part[last]
        else:
            part[int(last) if isinstance(part, list) else last] = value
    return proof


def test_the_forger_of_these_tests_makes_pages_that_are_read():
    assert proof_of(resealed(as_json())) == samples.thread(2)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"version": 2}, "newer program .*update relgloss"),
        ({"version": 0}, "version: expected 1"),
        ({"version": True}, "version: expected 1"),
        ({"format": "else"}, "format: expected"),
        ({"more": 1}, "expected content, format"),
        ({"messages": []}, "changed"),
        ({"messages": {}}, "changed"),
        ({"messages__0__note": "x" * 20001}, r"messages\[0\]\.note: longer than 20000"),
        ({"messages__0__note": 1}, r"messages\[0\]\.note: expected a text"),
        ({"messages__0__note": None}, r"note: expected a text"),
        ({"messages__0__author": "x" * 201}, "author: longer than 200"),
        ({"messages__0__made": "yesterday"}, "made: expected a time in UTC"),
        ({"messages__0__made": "2026-02-30T00:00:00Z"}, "made: expected a time in UTC"),
        ({"messages__0__parent": "x"}, "parent: expected the SHA-256"),
        ({"messages__1__parent": "0" * 64}, r"messages\[1\]\.parent: expected [0-9a-f]{64}"),
        ({"messages__1__parent": ""}, r"messages\[1\]\.parent"),
        ({"messages__0__screen": []}, "screen: expected an object"),
        ({"messages__0__screen": {"a": "x" * 20001}}, "screen: longer than"),
        ({"messages__0__extra": 1}, r"messages\[0\]\.entries: expected settings"),
        ({"messages__0__settings__test__c": -1}, "0 to "),
        ({"messages__0__settings__test__c": "1"}, "expected 0 to "),
        ({"messages__0__settings__test__c": True}, "expected 0 to "),
        ({"messages__0__settings__test__c": 1e308}, "expected 0 to "),
        ({"messages__0__settings__test__c": KeyError}, "expected every entry"),
        ({"messages__0__settings__test__sigma_n_deg": 10.1}, "0 to 10"),
        ({"messages__0__settings__eye__distance_m": 0}, "0.001 to 1000"),
        ({"messages__0__settings__lamp": []}, "expected a table"),
        ({"messages__0__settings__lamp__illuminant": 3}, "illuminant: expected a name"),
        ({"messages__0__settings__tets": 3}, "expected reference, test"),
        ({"content__title": "x" * 201}, "title: longer than 200"),
        ({"content__title": KeyError}, "content.title: expected a text"),
        ({"content__size_px": [0, 4]}, "content.size_px"),
        ({"content__size_px": [4, 4.5]}, "content.size_px"),
        ({"content__pictures": {}}, "content.pictures"),
        ({"content__files": {}}, "scene.toml"),
        ({"content__files__../x": {"text": ""}}, "within the proof's own folder"),
        ({"content__files__/etc/x": {"text": ""}}, "within the proof's own folder"),
        ({"content__files__C:/x": {"text": ""}}, "within the proof's own folder"),
        ({"content__files__a\\b": {"text": ""}}, "within the proof's own folder"),
        ({"content__files__x": {"text": 1}}, "base64"),
        ({"content__files__x": "text"}, "base64"),
        ({"content": []}, "content: expected an object"),
    ],
)
def test_wrong_fields_are_refused(changes, words):
    with pytest.raises(InputError, match=words) as caught:
        proof_of(resealed(edited(**changes)))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "null", "1", "{", '{"content":{},"content":{}}', '{"a":NaN}', '{"a":1e999}',
        "[" * 100, '"\\ud800"', "{}", '{"version":1}', "9" * 5000,
    ],
)  # fmt: skip
def test_broken_json_is_refused(text):
    with pytest.raises(InputError):
        proof_of(resealed_text(text))


def resealed_text(text):
    html = samples.page_of(samples.thread(1))
    texts = split(html)
    return Page(html.replace(texts["proof"], text, 1))


def test_duplicate_names_are_refused():
    text = canonical(as_json()).decode()
    page = resealed_text(text.replace('"author":"Aya"', '"author":"Aya","author":"Aya"'))
    assert page.changes == ("proof",)
    with pytest.raises(InputError, match='"author" comes twice'):
        page.block("proof")


@pytest.mark.parametrize(
    ("signatures", "words"),
    [
        ("{}", "signatures: expected a list"),
        ('[{"key":"","message":0,"signature":""}]', r"signatures\[0\]\.key"),
        ("[1]", r"signatures\[0\]: expected"),
        (f'[{{"key":"{"a" * 64}","message":2,"signature":"{"b" * 128}"}}]', "one of the 2"),
        (f'[{{"key":"{"a" * 64}","message":true,"signature":"{"b" * 128}"}}]', "the index"),
    ],
)
def test_wrong_signatures_are_refused(signatures, words):
    with pytest.raises(InputError, match=words):
        proof_of(resealed(as_json(), signatures))


def test_a_message_that_is_too_long_is_never_made():
    with pytest.raises(InputError, match="note: longer"):
        Message(samples.settings(), note="x" * 20001)
    with pytest.raises(InputError, match="key"):
        Signature(0, "xyz", "b" * 128)


def test_a_changed_message_in_the_middle_of_a_long_thread_is_named():
    html = samples.page_of(samples.thread(20))
    changed = Page(html.replace("\U0001f642 9", "\U0001f642 8", 1))
    assert changed.changes == ("messages/10/note",)
    assert "message 10's note" in str(_error(changed.html))


def test_script_in_every_text_stays_text():
    nasty = "</script><script>alert(1)</script><!--" * 25
    proof = Proof({**samples.content(), "title": nasty[:200]},
                  (Message(samples.settings(), nasty, nasty[:200]),))  # fmt: skip
    html = samples.page_of(proof)
    assert html.count("<script") == html.count("</script>") == 6
    assert "<!--" not in html
    assert proof_of(Page(html)) == proof


def test_missing_and_foreign_files(tmp_path):
    for path, data in (("none.html", None), ("e.html", b""), ("b.html", bytes(3000))):
        if data is not None:
            (tmp_path / path).write_bytes(data)
        with pytest.raises(InputError, match=path):
            read_proof(tmp_path / path)
