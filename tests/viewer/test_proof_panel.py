"""The panel "Proof" in a real window: a thread of 20, what shows now, the comparison, a reply."""

from __future__ import annotations

import driven
import pytest

CHAIN = 20


# --- scripts, run in the window's process ---------------------------------------------------------


def proof_here(hand, folder, count=CHAIN):
    """An open proof of the window's own state whose grid this window has drawn."""
    import dataclasses

    from test_proof_state import chain

    from relgloss_view.proof.drawing import page_display
    from relgloss_view.proof.grid import grid_of
    from relgloss_view.proof.pair import Pair
    from relgloss_view.proof.proof import Proof
    from relgloss_view.viewer.state.proofs import OpenProof
    from relgloss_view.viewer.state.state import SIDES

    base = hand.model.state
    shown = base.placed(display=page_display(base.setup.display))
    looks = {side: shown.side(side).look.with_entries(quality="exact") for side in SIDES}
    pair = Pair({side: shown.scene(side) for side in SIDES}, looks)
    size = [96, 80]
    drawn = hand.do(lambda: pair.drawn(hand.model.renderer, tuple(size)))
    proof = chain(base, count)
    content = {"title": "A green can", "size_px": size, "grid": grid_of(drawn), "files": {}}
    first = Proof(content, proof.messages[:1])
    for message in proof.messages[1:]:
        first = first.answered(dataclasses.replace(message, parent=""))
    return OpenProof("can.html", folder, first, base, ("not signed",) * count)


def shows_the_thread(hand, found):
    from relgloss_view.viewer.state.proofs import settings_of

    model, actions = hand.model, hand.app.files.proofs
    hand.app.layout.focus("Proof")
    hand.frames(4)
    found["empty"] = hand.there("//Proof/Save as proof...")
    opened = proof_here(hand, "/unpacked")
    hand.do(lambda: model.change(opened.newest))
    hand.do(lambda: actions.opened(opened))
    hand.frames(6)
    hand.until(lambda: actions._compared is not None)
    found["same"] = actions._compared[1]
    found["settings"] = []
    for k in range(CHAIN):
        hand.ctx.item_click(f"//Proof/$${k}/##show")
        hand.frames(1)
        found["settings"].append(
            model.state.test.look.c == opened.proof.messages[k].settings.test.c
        )
    found["chosen"] = model.proof_message
    hand.click("//Proof/$$2/##show")
    hand.click("//Proof/Back to what was sent")
    found["back"] = settings_of(model.state) == opened.proof.sent
    hand.do(model.history.undo)
    hand.do(lambda: model.set_c("test", 0.123))
    hand.frames(2)
    found["mine"] = model.state.test.look.c
    hand.click("//Proof/Back to what was sent")
    found["theirs"] = model.state.test.look.c == opened.proof.sent.test.c
    hand.do(model.history.undo)
    found["undone"] = model.state.test.look.c


def finds_another_picture(hand, found):
    import copy
    import dataclasses

    from relgloss_view.proof.proof import Proof

    model, actions = hand.model, hand.app.files.proofs
    opened = proof_here(hand, "/altered", 1)
    content = copy.deepcopy(dict(opened.proof.content))
    row = next(lab for lab in content["grid"]["sides"]["test"]["lab"] if lab is not None)
    row[0] += 3.0
    altered = dataclasses.replace(opened, proof=Proof(content, opened.proof.messages))
    hand.do(lambda: actions.opened(altered))
    hand.until(lambda: actions._compared is not None and actions._compared[0] == "/altered")
    found["words"] = actions._compared[1]
    found["reported"] = [note.text for note in model.notes if note.fault]


def answers(hand, found):
    import os

    from relgloss_view.viewer.files import proof_writing
    from relgloss_view.viewer.files.proof_writing import WrittenProof, _message

    model, actions = hand.model, hand.app.files.proofs
    opened = proof_here(hand, "/answered", 2)
    hand.do(lambda: model.change(opened.newest))
    hand.do(lambda: actions.opened(opened))
    hand.do(lambda: model.set_c("test", 0.2))
    asked = []

    def written(request, cancelled):
        asked.append(request)
        if len(asked) == 1:
            raise proof_writing.InputError("the disk is full")
        with open(request.path, "w", encoding="utf-8") as file:
            file.write("a proof")
        return WrittenProof(request.path, opened.proof.answered(_message(request)), 7)

    proof_writing.written = written
    hand.app.layout.focus("Proof")
    hand.frames(3)
    hand.click("//Proof/Reply...")
    hand.frames(3)
    hand.type("//Reply/##Note", "a little less")
    hand.type("//Reply/##Your name", "Jo")
    path = os.path.join(hand.app.files.dialogs.folder, "can-3.html")
    hand.click("//Reply/Save##proof")
    hand.until(lambda: len(asked) == 1 and not actions.writing.busy)
    hand.frames(3)
    found["failed"] = [actions._dialog._fault, actions._dialog.note, os.path.exists(path)]
    hand.click("//Reply/Save##proof")
    hand.until(lambda: len(asked) == 2 and not actions.writing.busy)
    hand.frames(3)
    found["asked"] = [asked[1].note, asked[1].author, asked[1].is_reply, asked[1].path == path]
    found["messages"] = [m.note for m in model.proof.proof.messages]
    found["c"] = model.proof.proof.sent.test.c
    found["closed"] = not hand.there("//Reply/Save##proof")
    found["line"] = model.notes[-1].text


SCRIPTS = [shows_the_thread, finds_another_picture, answers]


# --- tests ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return driven.drive("test_proof_panel", tmp_path_factory.mktemp("proof"), panels=True)


@pytest.mark.slow
def test_each_of_20_messages_shows_its_settings(found):
    got = found["shows_the_thread"]
    assert got["empty"]
    assert got["settings"] == [True] * CHAIN
    assert got["chosen"] == CHAIN - 1


@pytest.mark.slow
def test_one_button_leads_back_and_undo_forth(found):
    got = found["shows_the_thread"]
    assert got["back"]
    assert got["mine"] == 0.123
    assert got["theirs"]
    assert got["undone"] == 0.123


@pytest.mark.slow
def test_the_window_compares_its_own_picture_with_the_proofs(found):
    assert found["shows_the_thread"]["same"].startswith("This window draws what the designer saw")
    words = found["finds_another_picture"]["words"]
    assert words.startswith("This window does not draw what the designer saw")
    assert words in found["finds_another_picture"]["reported"]


@pytest.mark.slow
def test_a_reply_is_written_and_takes_the_place_of_what_it_answers(found):
    got = found["answers"]
    assert got["failed"] == ["the disk is full", "a little less", False]
    assert got["asked"] == ["a little less", "Jo", True, True]
    assert got["messages"] == ["note 0", "note 1", "a little less"]
    assert got["c"] == 0.2
    assert got["closed"]
    assert "send this one file" in got["line"]
