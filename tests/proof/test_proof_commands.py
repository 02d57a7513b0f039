"""`relgloss proof check`, `show` and `key` as a user calls them."""

from __future__ import annotations

import copy
import json
import random
import re
import stat

import proof_samples as samples
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.cli import main
from relgloss_view.picture.scene.file_kinds import PROOF, likely_kind
from relgloss_view.picture.scene.scene_file import read_scene_file
from relgloss_view.proof import check, keys
from relgloss_view.proof.page import whole
from relgloss_view.proof.page.parts import MARK, SEAL, Page, joined, script_json, seal_of, split
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.read import read_proof


@pytest.fixture(scope="module")
def proof():
    """A small one that can be drawn: two papers, and an answer."""
    opening = samples.drawable((64, 48))
    return opening.answered(Message(opening.sent, "Ja", "Bo"))


@pytest.fixture(autouse=True)
def _home(monkeypatch, tmp_path_factory):
    monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path_factory.mktemp("home")))


@pytest.fixture
def file(proof, tmp_path):
    path = tmp_path / "a.html"
    path.write_text(whole.page_of(proof), encoding="utf-8", newline="\n")
    return path


def ran(capsys, *words):
    status = main([str(word) for word in words])
    out, err = capsys.readouterr()
    assert "Traceback" not in err
    return status, out, err


def edited(file, **parts):
    """The page with parts replaced, named and sealed anew, as a forger does it."""
    texts = split(file.read_text(encoding="utf-8"))
    html = joined(texts | parts, "0" * 64)
    digest = Page(html).digest
    file.write_text(joined(texts | parts, digest), encoding="utf-8", newline="\n")


def content_with(file, **entries):
    texts = split(file.read_text(encoding="utf-8"))
    proof = json.loads(texts["proof"])
    proof["messages"] = proof["messages"][:1]
    proof["content"] |= entries
    edited(file, proof=script_json(proof))


def test_check_of_a_whole_proof(capsys, file, proof):
    status, out, _ = ran(capsys, "proof", "check", file, "--json")
    found = json.loads(out)
    assert status == 0
    assert found["ok"]
    assert found["digest"] == proof.digest
    # The grid is rounded to 1e-4 of L*, a*, b*; the same program draws the same floats.
    assert found["largest_de2000"] < 1e-3
    assert found["drawing_is_derived"] is True
    assert found["page_differs"] == []
    status, out, _ = ran(capsys, "proof", "check", file)
    assert status == 0
    assert "nothing was changed" in out
    assert "signatures: none" in out


def test_check_by_the_reference_renderer(capsys, file):
    """Float64 without OpenGL: another computation of the same picture."""
    status, out, _ = ran(capsys, "proof", "check", file, "--json", "--backend", "reference")
    assert status == 0
    assert 0 < json.loads(out)["largest_de2000"] < 0.05


@pytest.mark.slow
def test_a_thousand_bytes_of_a_whole_page(file):
    data = file.read_bytes()
    chosen = random.Random(19)
    for _ in range(1000):
        at, changed = chosen.randrange(len(data)), bytearray(data)
        changed[at] ^= chosen.randrange(1, 256)
        page = Page(bytes(changed).decode("utf-8", errors="replace"))
        found = check.check_page(page, {})
        assert found.changes, at
        assert found.faults[0].startswith("changed after it was made: ")


def test_check_names_a_changed_byte(capsys, file):
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace('"note":"Ja"', '"note":"Na"'), encoding="utf-8", newline="\n")
    status, out, err = ran(capsys, "proof", "check", file)
    assert status == 1
    assert "message 2's note" in out
    assert re.fullmatch(r"relgloss: .*a\.html: changed after .*message 2's note.*\n", err)
    status, out, _ = ran(capsys, "proof", "check", file, "--json")
    assert status == 1
    assert json.loads(out)["changes"] == [{"part": "messages/2/note", "words": "message 2's note"}]


def test_check_draws_again(capsys, file):
    """A sealed proof whose scene is not the one that its grid was drawn from."""
    texts = split(file.read_text(encoding="utf-8"))
    files = json.loads(texts["proof"])["content"]["files"]
    files["materials/test.json"] = files["materials/reference.json"]
    content_with(file, files=files)
    status, out, err = ran(capsys, "proof", "check", file, "--json")
    found = json.loads(out)
    assert status == 1
    assert found["largest_de2000"] > check.LARGEST_DE2000
    assert not found["drawing_is_derived"]
    assert "drawn here it differs by up to" in err


def test_check_finds_numbers_that_its_files_do_not_give(capsys, file, proof):
    content_with(file, drawing={**proof.content["drawing"], "added": 1})
    status, out, err = ran(capsys, "proof", "check", file, "--json")
    assert status == 1
    assert json.loads(out)["drawing_is_derived"] is False
    assert "the page's numbers" in err


@pytest.mark.parametrize(
    ("part", "text"),
    [("script", "alert(1)"), ("style", "body{}"), ("words", "{}"), ("static", "<p>hello</p>")],
)
def test_check_finds_a_foreign_program(capsys, file, part, text):
    edited(file, **{part: text})
    status, out, err = ran(capsys, "proof", "check", file, "--json")
    assert status == 1
    assert json.loads(out)["page_differs"] == [part]
    assert "open it with `relgloss view`" in err


def test_check_of_another_versions_page(capsys, file, monkeypatch):
    """Its program can't be compared; its pictures can."""
    monkeypatch.setattr(check, "PROGRAM", "relgloss 99")
    edited(file, script="older()")
    status, out, _ = ran(capsys, "proof", "check", file)
    assert status == 0
    assert "not compared with relgloss 99" in out


def test_check_of_signatures(capsys, file, proof, tmp_path):
    keys.make_key(tmp_path / "k")
    signed = keys.signed(proof, keys.read_private(tmp_path / "k"))
    file.write_text(whole.page_of(signed), encoding="utf-8", newline="\n")
    status, out, _ = ran(capsys, "proof", "check", file)
    assert status == 0
    assert "message 2: signed by an unknown key" in out
    ran(capsys, "proof", "key", "--trust", tmp_path / "k.pub", "--name", "Bo")
    assert "message 2: signed by Bo (" in ran(capsys, "proof", "check", file)[1]
    wrong = [{**vars(s), "message": 0} for s in signed.signatures]
    edited(file, signatures=script_json(wrong))
    status, out, err = ran(capsys, "proof", "check", file)
    assert status == 1
    assert "message 1: wrong signature" in err
    assert "valid" not in out


def test_a_future_version(capsys, file):
    texts = split(file.read_text(encoding="utf-8"))
    edited(file, proof=texts["proof"].replace('],"version":1}', '],"version":2}'))
    for part in ("check", "show"):
        status, _, err = ran(capsys, "proof", part, file)
        assert status == 1
        assert "made by a newer program" in err
        assert "update relgloss" in err


def test_show(capsys, file, proof, tmp_path):
    status, out, _ = ran(capsys, "proof", "show", file, "--files", tmp_path / "inside")
    assert status == 0
    for text in ("Dose", "| Genug Glanz?", "| Sag es.", "Aya", "| Ja", *proof.digests,
                 "contrast gloss (c) 0.37", "the settings as before", "scene.toml"):  # fmt: skip
        assert text in out, text
    written = {p.relative_to(tmp_path / "inside").as_posix()
               for p in (tmp_path / "inside").rglob("*") if p.is_file()}  # fmt: skip
    assert written == {*proof.content["files"], "message-2.toml"}
    for name, message in zip(("scene.toml", "message-2.toml"), proof.messages, strict=True):
        scene = read_scene_file(tmp_path / "inside" / name)
        assert scene.look.c == message.settings.test.c, name
        assert scene.look.sigma_n_deg == message.settings.test.sigma_n_deg, name
    assert "message-2.toml has those of the newest message" in out
    status, _, err = ran(capsys, "proof", "show", file, "--files", tmp_path / "inside")
    assert status == 1
    assert "holds materials of another proof; choose a new folder" in err
    found = json.loads(ran(capsys, "proof", "show", file, "--json")[1])
    assert found["digest"] == proof.digest
    assert [m["note"] for m in found["messages"]] == ["Genug Glanz?\nSag es.", "Ja"]
    assert [m["digest"] for m in found["messages"]] == list(proof.digests)


def test_show_of_hostile_words(capsys, proof, tmp_path):
    """No character of a note reaches the terminal that it would obey."""
    nasty = "a\x1b[2Jb\u202ec\x07\rd"
    hostile = Proof({**proof.content, "title": nasty},
                    (Message(proof.sent, nasty, nasty),))  # fmt: skip
    path = tmp_path / "n.html"
    path.write_text(whole.page_of(hostile), encoding="utf-8", newline="\n")
    assert read_proof(path).messages[0].note == nasty
    status, out, _ = ran(capsys, "proof", "show", path)
    assert status == 0
    assert not set(out) & set("\x1b\u202e\x07\r")


def test_a_thread_of_twenty(capsys, proof, tmp_path):
    for k in range(18):
        proof = proof.answered(Message(samples.settings(c=1 + k / 8), f"note {k}"))
    path = tmp_path / "t.html"
    path.write_text(whole.page_of(proof), encoding="utf-8", newline="\n")
    found = json.loads(ran(capsys, "proof", "show", path, "--json")[1])
    assert len(found["messages"]) == 20
    assert found["messages"][-1]["digest"] == proof.digest
    for before, after in zip(found["messages"], found["messages"][1:], strict=False):
        assert after["parent"] == before["digest"]


def test_key(capsys, tmp_path):
    status, out, _ = ran(capsys, "proof", "key", "-o", tmp_path / "me.key")
    assert status == 0
    assert stat.S_IMODE((tmp_path / "me.key").stat().st_mode) == 0o600
    fingerprint = re.search(r"(?:[0-9A-F]{4} ){7}[0-9A-F]{4}", out)[0]
    assert fingerprint in ran(capsys, "proof", "key", "--show", tmp_path / "me.key.pub")[1]
    status, _, err = ran(capsys, "proof", "key", "-o", tmp_path / "me.key")
    assert status == 1
    assert "me.key" in err
    assert "no known keys" in ran(capsys, "proof", "key")[1]
    ran(capsys, "proof", "key", "--trust", tmp_path / "me.key.pub", "--name", "Me")
    known = json.loads(ran(capsys, "proof", "key", "--json")[1])["keys"]
    assert [(one["name"], one["fingerprint"]) for one in known] == [("Me", fingerprint)]
    ran(capsys, "proof", "key", "--forget", "Me")
    assert "no known keys" in ran(capsys, "proof", "key")[1]
    assert ran(capsys, "proof", "key", "--trust", tmp_path / "me.key.pub")[0] == 2


@pytest.mark.parametrize("option", ["SCENE", "--note-file", "--sign"])
def test_make_never_replaces_what_it_reads(capsys, tmp_path, option):
    """A link may have any name: here one that ends in .html."""
    read = tmp_path / "read"
    read.write_text("kept")
    link = tmp_path / "link.html"
    link.symlink_to(read)
    words = [str(read)] if option == "SCENE" else ["matte-coated", option, str(read)]
    assert main(["proof", "make", *words, "-o", str(link)]) == 1
    assert "this is the file that is read" in capsys.readouterr().err
    assert read.read_text() == "kept"


@pytest.mark.parametrize("part", ["check", "show"])
def test_files_that_are_no_proofs(capsys, tmp_path, part):
    (tmp_path / "x.html").write_text("<!DOCTYPE html>\n<html></html>")
    status, _, err = ran(capsys, "proof", part, tmp_path / "x.html")
    assert status == 1
    assert "x.html: not a proof; give a proof" in err


def test_other_readers_name_a_proof(file):
    assert PROOF.decode() == MARK
    with pytest.raises(InputError, match=r"this is a proof; open it with `relgloss view`"):
        likely_kind(file)


#: What a forger may write in the place of any value.
HOSTILE = [None, True, -1, 1e308, "", "../../x", [], [[]], {}, {"a": []}, [None] * 3, "x" * 500]


def places(value, path=()):
    """The paths of a JSON value's parts, and those of their parts, not too deep."""
    yield path
    if len(path) < 5 and isinstance(value, dict | list):
        items = value.items() if isinstance(value, dict) else enumerate(value[:2])
        for key, inner in items:
            yield from places(inner, (*path, key))


@pytest.mark.parametrize("count", [12, pytest.param(300, marks=pytest.mark.slow)])
def test_forged_values_are_read_or_refused_in_one_line(proof, count):
    """A sealed proof with any value in the place of any other: no traceback, nothing drawn."""
    texts = split(whole.page_of(proof))
    whole_json = json.loads(texts["proof"])
    del whole_json["messages"][1:]
    chosen, refused = random.Random(5), 0
    every = [path for path in places(whole_json) if path]
    for _ in range(count):
        path, value = chosen.choice(every), chosen.choice(HOSTILE)
        forged = copy.deepcopy(whole_json)
        part = forged
        for key in path[:-1]:
            part = part[key]
        part[path[-1]] = value
        html = joined_as_forged(texts, forged)
        try:
            found = check.check_page(Page(html), {})
            refused += bool(found.faults)
        except InputError as error:
            assert "\n" not in str(error)
            refused += 1
    assert refused > count / 3


def joined_as_forged(texts, forged):
    text = script_json(forged)
    changed = {**texts, "proof": text}
    try:
        digest = Page(joined(changed, "0" * 64)).digest or "0" * 64
        return joined(changed, digest)
    except (AttributeError, KeyError, TypeError):  # too strange for the list of parts
        return whole_page_with(texts, text)


def whole_page_with(texts, text):
    html = joined(texts, "0" * 64)
    html = html.replace(texts["proof"], text, 1)
    page = Page(html)
    return html.replace(SEAL + page.seal, SEAL + seal_of(html.replace(page.seal, "0" * 64)), 1)


@pytest.mark.parametrize("stage", ["../../../etc/passwd", "/etc/passwd", "no.frag", "../x.frag", 3])
def test_no_file_goes_into_a_page_that_is_no_shader(proof, stage):
    """An answer to a forged proof sends none of the reader's own files."""
    drawing = {**proof.content["drawing"], "stages": [stage]}
    with pytest.raises(InputError, match=r"content\.drawing\.stages"):
        whole.page_of(Proof({**proof.content, "drawing": drawing}, proof.messages))
