"""The page as `relgloss proof make` writes it, in a browser: whole, answered, changed."""

from __future__ import annotations

import proof_samples as samples
import pytest
from browsers import call, open_page, requests

from relgloss_view.proof import check
from relgloss_view.proof.page import whole
from relgloss_view.proof.page.parts import Page
from relgloss_view.proof.proof import Message
from relgloss_view.proof.read import proof_of

ANSWER = """async (words) => {
  URL.createObjectURL = (blob) => { window.saved = blob; return "#"; };
  for (const [id, text] of Object.entries(words)) {
    const field = document.getElementById(id);
    field.value = text;
    field.dispatchEvent(new Event("input", {bubbles: true}));
  }
  document.getElementById("reply-save").click();
  return window.saved.text();
}"""


@pytest.fixture(scope="module")
def proof():
    return samples.drawable((64, 48))


def test_an_answer_of_the_page_is_pythons_byte_for_byte(chromium_gl, proof):
    """Twice in turn: Python's answer to the page's answer is answered by the page again."""
    html = whole.page_of(proof)
    for k in range(2):
        open_page(chromium_gl, html)
        assert call(chromium_gl, "() => relgloss.page.changes") == []
        words = {"reply-note": f"Zu <viel> & zu \xa0 wenig {k}\nZeile", "reply-name": "Zoë"}
        html = call(chromium_gl, ANSWER, words)
        answer = proof_of(Page(html))
        assert answer.messages[-1].note == words["reply-note"]
        assert html == whole.page_of(answer)
        assert check.check_page(Page(html), {}).faults == ()
        html = whole.page_of(answer.answered(Message(answer.sent, f"Antwort {k}", "Aya")))
    assert len(proof_of(Page(html)).messages) == 5
    assert requests(chromium_gl) == []


@pytest.mark.parametrize(
    ("old", "new", "readable"),
    [('"author":"Aya"', '"author":"Ava"', False), ("float", "flOat", True)],
)
def test_a_changed_page_draws_nothing_before_a_click(chromium_gl, proof, old, new, readable):
    html = whole.page_of(proof)
    at = html.index('id="proof">' if old.startswith('"') else 'id="shaders">')
    changed = html[:at] + html[at:].replace(old, new, 1)
    assert changed != html
    open_page(chromium_gl, changed)
    page = call(chromium_gl, "() => ({changes: relgloss.page.changes, r: relgloss.page.readable})")
    assert page["changes"] == list(Page(changed).changes)
    assert page["r"] is readable
    assert call(chromium_gl, "() => document.getElementById('canvas')") is None
    assert call(chromium_gl, "() => document.getElementById('all-the-same') !== null") is readable
