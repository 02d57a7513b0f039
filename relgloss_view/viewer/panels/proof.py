"""The panel "Proof": what was sent, by whom, the thread, and whether it is what shows now."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.proof.proof import MOST_NOTE, MOST_TITLE
from relgloss_view.viewer.panels.list_rows import row
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em, gray
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.proofs import (
    DIGEST_SHOWN,
    OpenProof,
    author_of,
    message_words,
    shown_message,
    standing_words,
    time_of,
)

if TYPE_CHECKING:
    from relgloss_view.viewer.shell.proof_actions import ProofActions

EMPTY = (
    "A proof is one file with both pictures and their settings. Open or drop one (.html), or save "
    "yours: File > Save as proof..."
)
CHECKING = "Drawing the designer's picture to compare"


def show(actions: ProofActions) -> None:
    """Draw the panel into the present window."""
    model = actions.model
    opened = model.proof
    if opened is None:
        widgets.wrapped(EMPTY, dim=True)
        if widgets.button("Save as proof...", "writes the pair as one file for a browser"):
            actions.save_as_proof()
        return
    _heading(opened)
    _standing(model, opened, actions)
    imgui.separator_text("Same picture?")
    same = actions.same_picture(opened)
    widgets.wrapped(CHECKING if same is None else same)
    imgui.separator_text(f"Messages ({len(opened.proof.messages)})")
    _thread(model, opened)


def _heading(opened: OpenProof) -> None:
    newest = opened.proof.messages[-1]
    widgets.wrapped(printable(opened.proof.title, MOST_TITLE) or "Without a title")
    widgets.wrapped(f"Sent by {author_of(newest)}, {time_of(newest)}", dim=True)
    widgets.wrapped(widgets.sentence(printable(opened.signed[-1], 200)), dim=True)


def _standing(model: Model, opened: OpenProof, actions: ProofActions) -> None:
    """Whose picture shows, with one button back."""
    state = model.state
    index = shown_message(state, opened, model.proof_message)
    words = standing_words(state, opened, model.proof_message)
    imgui.spacing()
    (widgets.wrapped if index is not None else _bright)(words)
    if widgets.button(
        "Back to what was sent", "shows the newest message's picture; undo brings yours back",
        enabled=index is None or opened.proof.messages[index].settings != opened.proof.sent,
    ):  # fmt: skip
        model.show_message(len(opened.proof.messages) - 1)
    imgui.same_line()
    if widgets.button("Reply...", "saves your settings and a note as a proof that answers this"):
        actions.reply()


def _bright(text: str) -> None:
    """A line that must not be overlooked: one looks at something that nobody has sent."""
    imgui.push_style_color(imgui.Col_.text, gray(1.0))
    widgets.wrapped(f"! {text}")
    imgui.pop_style_color()


def _thread(model: Model, opened: OpenProof) -> None:
    """All messages, the newest first; a click shows one's settings."""
    present = shown_message(model.state, opened, model.proof_message)
    messages = opened.proof.messages
    for index in reversed(range(len(messages))):
        message = messages[index]
        imgui.push_id(index)
        title = f"{index + 1}. {author_of(message)}"
        if row("show", title, index == present, beside=time_of(message)):
            model.show_message(index)
        widgets.tooltip("Shows the settings of this message. Undo goes back.", beside=True)
        imgui.indent(em(0.8))
        if message.note:
            widgets.wrapped(printable_lines(message.note))
        for line in message_words(opened.proof, index):
            widgets.wrapped(line, dim=True)
        digest = opened.proof.digests[index][:DIGEST_SHOWN]
        widgets.wrapped(f"{digest}: {printable(opened.signed[index], 200)}", dim=True)
        widgets.tooltip(f"Digest (SHA-256): {opened.proof.digests[index]}")
        imgui.unindent(em(0.8))
        imgui.dummy(ImVec2(0.0, em(0.2)))
        imgui.pop_id()


def printable_lines(text: str) -> str:
    """A note of several lines, fit to print.

    >>> printable_lines("one\\ntwo")
    'one\\ntwo'
    """
    return "\n".join(printable(line, MOST_NOTE) for line in text[:MOST_NOTE].splitlines())
