"""Proofs that mean harm: their texts stay texts, and what was changed is named and not drawn.

Whoever can write a file can write any HTML into it, so no page protects a reader from a file that a
stranger made. What holds here: a text that someone else wrote into a note, a name or a title never
becomes more than a text in the pages that relgloss makes; and a changed file says so.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import random

import pytest
from browsers import before_pages, call, console, open_page, requests, until
from opened_proofs import SEEN, page_of

from relgloss_view.base.errors import InputError
from relgloss_view.proof import proof as proofs
from relgloss_view.proof.drawing import shaders_of
from relgloss_view.proof.page.build import page, words
from relgloss_view.proof.page.static import body
from relgloss_view.proof.proof import MOST_MESSAGES, MOST_NOTE, Proof, Signature, canonical

WORDS = words()
CANARY = "window.canary=1"
#: Each of them runs the canary where it becomes HTML, in one of the places that HTML has.
ATTACKS = (
    f"<script>{CANARY}</script>",
    f"</script><script>{CANARY}</script>",
    f"<img src=x onerror={CANARY}>",
    f'"><svg onload="{CANARY}">',
    f"'><svg onload='{CANARY}'>",
    f"</title></style></textarea><img src=x onerror={CANARY}>",
    f"<!--<script>{CANARY}",
    f"--><script>{CANARY}</script>",
    f"]]><script>{CANARY}</script>",
    f"javascript:{CANARY}",
    f"&lt;script&gt;{CANARY}&lt;/script&gt; &#60;b&#62; &amp;lt;",
    "{name} {note} ${" + CANARY + "} {{" + CANARY + "}}",
    "$& $1 $` $' \\u003cscript>",
    "__proto__ constructor toString",
)
#: What confuses a reader or a parser, and no more.
CONFUSING = (
    "\u202efdp.exe \u2066abc\u2069 \u200e\u200f",  # right-to-left overrides
    "a\u0000b\u0007c\u001bd\u0085e\ufeff",
    "line\u2028line\u2029line\r\nline\rline",
    "\U0001f4a9 \ufffe \uffff \ufdd0",
    "Z" + "\u0335" * 60,
)
ALL = " ".join((*ATTACKS, *CONFUSING))


def hostile(paper, text):
    """A proof with a text in every name, note and title that a file has."""
    content = dict(paper.content)
    content["title"] = text
    content["notes"] = [text]
    content["display"] = {**content["display"], "words": text, "name": text, "sentences": [text]}
    content["meter"] = {
        key: {**value, "name": text} for key, value in [*content["meter"].items(), (text, {})]
    }
    content["meter_finishes"] = [{"finish": text, "readings": {text: 1.0}}]
    content["files"] = {**content["files"], text: {"text": text}}
    content[text] = text
    made = Proof(content, (dataclasses.replace(paper.messages[0], note=text),))
    for each in (*ATTACKS, *CONFUSING):
        answer = dataclasses.replace(
            paper.messages[0], note=each, author=each, program=each[:100], screen={each: each}
        )
        made = made.answered(answer)
    return made


@pytest.mark.parametrize("policy", [True, False], ids=["as it is", "without the policy"])
def test_texts_stay_texts(chromium_gl, paper, policy):
    """Without the policy, which would stop scripts too, the escaping alone has to hold."""
    html = page_of(hostile(paper, ALL))
    chromium_gl.cdp("Page.setBypassCSP", enabled=not policy)
    try:
        open_page(chromium_gl, html)
    finally:
        chromium_gl.cdp("Page.setBypassCSP", enabled=False)
    seen = call(chromium_gl, SEEN)
    assert call(chromium_gl, "() => window.canary ?? null") is None
    assert seen["canvases"] == 1
    for attack in ATTACKS:
        shown = call(
            chromium_gl, "(text) => document.body.textContent.split(text).length - 1", attack
        )
        assert shown >= 4, attack
    assert call(chromium_gl, "() => document.querySelectorAll('svg, iframe, object, embed, base,"
                " link, form, #main script, a[href]').length") == 0  # fmt: skip
    console(chromium_gl)
    assert requests(chromium_gl) == []


def test_the_attacks_are_attacks(chromium_gl):
    """The control: as HTML, each of the first ones runs."""
    for attack in ATTACKS[:6]:
        open_page(chromium_gl, f"<title>t</title><body>{attack}")
        until(chromium_gl, "window.canary !== undefined")
        assert call(chromium_gl, "() => window.canary ?? null") == 1, attack


@pytest.mark.parametrize("field", ["note", "author", "program"])
def test_half_a_surrogate_pair_is_refused(paper, field):
    """No file can hold one."""
    with pytest.raises(InputError, match=f"{field}: .*without lone surrogates"):
        dataclasses.replace(paper.messages[0], **{field: "a\ud800b"})


def long_thread(paper, count, note):
    """A proof with many messages, whose parents are right; each is hashed once."""
    begun = hashlib.sha256(b'{"content":' + canonical(paper.content))
    begun.update(b',"format":' + canonical(proofs.FORMAT) + b',"messages":[')
    messages, parent = [], ""
    for k in range(count):
        message = dataclasses.replace(paper.messages[0], note=note(k), parent=parent)
        messages.append(message)
        begun.update((b"," if k else b"") + canonical(message.as_json()))
        ended = begun.copy()
        ended.update(b'],"version":%d}' % proofs.VERSION)
        parent = ended.hexdigest()
    return Proof(paper.content, tuple(messages))


@pytest.mark.parametrize("count", [40, pytest.param(MOST_MESSAGES, marks=pytest.mark.slow)])
def test_a_giant_note_and_a_long_thread(chromium_gl, paper, count):
    """A note as long as relgloss reads, without a place to break; slow: as many messages too."""
    proof = long_thread(paper, count, lambda k: "W" * MOST_NOTE if k == count - 1 else f"note {k}")
    assert proof.digests[-2] == proof.messages[-1].parent
    open_page(chromium_gl, page_of(proof))
    seen = call(chromium_gl, SEEN)
    assert (seen["canvases"], seen["notice"]) == (1, "")
    assert f"note {count - 2}" in seen["text"]
    # The note doesn't push the page out of its window sideways.
    wide = call(chromium_gl, "() => document.documentElement.scrollWidth - innerWidth")
    assert wide <= 0


@pytest.mark.slow
def test_ten_thousand_messages(chromium_gl, paper):
    """More than relgloss reads or writes; the page lives."""
    proof = long_thread(paper, 10_000, lambda k: f"note {k}")
    open_page(chromium_gl, page_of(proof))
    assert call(chromium_gl, "() => document.querySelectorAll('#thread li').length") == 10_000
    assert call(chromium_gl, SEEN)["canvases"] == 1


DRAWS = """{
  window.contexts = 0;
  const get = HTMLCanvasElement.prototype.getContext;
  HTMLCanvasElement.prototype.getContext = function (...words) {
    window.contexts += 1;
    return get.apply(this, words);
  };
}"""


def assert_nothing_drawn(browser, words_there):
    """The reason, and no picture, no canvas, no control; no context was even asked for."""
    seen = call(browser, SEEN)
    assert words_there in seen["notice"]
    assert (seen["pictures"], seen["canvases"], seen["sliders"]) == ([], 0, 0)
    assert call(browser, "() => window.contexts") == 0
    console(browser)


def test_a_future_version(chromium_gl, paper, monkeypatch):
    monkeypatch.setattr(proofs, "VERSION", proofs.VERSION + 1)
    html = page_of(dataclasses.replace(paper))  # a copy, which has kept no digests
    before_pages(chromium_gl, DRAWS)
    open_page(chromium_gl, html)
    assert_nothing_drawn(chromium_gl, WORDS["state.newer"])


@pytest.mark.parametrize("what", ["drawing", "shaders", "note"])
def test_what_was_changed_is_named_and_nothing_drawn(chromium_gl, paper, what):
    """A byte of a block, changed with an editor."""
    html = page_of(paper)
    if what == "drawing":
        at = html.index('"drawing":') + 2000
        named = WORDS["part.entry"].format(name="drawing")
        digit = next(k for k in range(at, len(html)) if html[k].isdigit() and html[k - 1] == ".")
        changed = html[:digit] + str((int(html[digit]) + 1) % 10) + html[digit + 1 :]
    elif what == "shaders":
        block = html.index('id="shaders"')
        at = html.index("vec3", block)
        changed, named = html[:at] + "vec2" + html[at + 4 :], WORDS["part.shader"].split("{")[0]
    else:
        at = html.index("too strong", html.index('id="proof"'))
        changed = html[:at] + "too bright" + html[at + 10 :]
        named = WORDS["part.message"].format(entry="note", number=1)
    before_pages(chromium_gl, DRAWS)
    open_page(chromium_gl, changed)
    assert_nothing_drawn(chromium_gl, named)


def signed(proof, message=0, of=None):
    """A proof with a signature of a digest, by a key made for the test."""
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    key = Ed25519PrivateKey.from_private_bytes(bytes(range(32)))
    digest = bytes.fromhex(of or proof.digests[message])
    signature = Signature(
        message, key.public_key().public_bytes_raw().hex(), key.sign(digest).hex()
    )
    return dataclasses.replace(proof, signatures=(signature,))


def signed_words(browser, html):
    open_page(browser, html)
    call(
        browser,
        """() => new Promise(done => {
      const look = () => document.querySelector(".signed") ? done() : setTimeout(look, 10);
      look();
    })""",
    )
    return call(browser, "() => document.querySelector('.signed').innerText")


def test_a_wrong_signature_is_said(chromium_gl, paper):
    wrong = WORDS["signed.wrong"].split("{")[0]
    right = WORDS["signed.right"].split("{")[0]
    assert signed_words(chromium_gl, page_of(signed(paper))).startswith(right)
    other = page_of(signed(paper, of="00" * 32))
    assert signed_words(chromium_gl, other).startswith(wrong)


def leaves(value, path=()):
    """Paths of the numbers of JSON."""
    if isinstance(value, dict):
        return [p for key, one in value.items() for p in leaves(one, (*path, key))]
    if isinstance(value, list):
        return [p for k, one in enumerate(value) for p in leaves(one, (*path, k))]
    return [path] if isinstance(value, int | float) and not isinstance(value, bool) else []


def planted(value, path, new):
    """JSON with one value replaced."""
    copy = json.loads(json.dumps(value))
    place = copy
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = new
    return copy


def edited(drawing, edit):
    """A copy of JSON, edited in place."""
    copy = json.loads(json.dumps(drawing))
    edit(copy)
    return copy


def _define(name, value):
    def edit(drawing):
        for side in drawing["sides"].values():
            for variant in side["variants"].values():
                variant["shade"][name] = value

    return edit


#: A drawing that someone changed and sealed again: none of it is what Python writes.
SEALED_AGAIN = {
    "nothing": lambda drawing: drawing.clear(),
    "no sides": lambda drawing: drawing["sides"].clear(),
    "null": lambda drawing: drawing["display"].update(uniforms=None),
    "a text for a number": lambda drawing: drawing["numbers"].update(FILL="alert(1)"),
    "a define with code": _define("REACH", "0\n#error\nwhile (true) {}"),
    "a define of a name with code": _define("X 1\nvoid main() { for (;;) ; }\n#define Y", 1),
    "a huge array": lambda drawing: drawing.update(
        shared={"mesh": {"dtype": "Float32", "shape": [2**31, 2**20], "data": "eJwDAAAAAAE="}}
    ),
    "huge numbers": lambda drawing: drawing["numbers"].update(
        dict.fromkeys(drawing["numbers"], 1e308)
    ),
    "negative numbers": lambda drawing: drawing["numbers"].update(
        dict.fromkeys(drawing["numbers"], -1)
    ),
    "a prototype": lambda drawing: drawing.update({"__proto__": {"sides": 1}, "constructor": 1}),
}


def assert_alive(browser, html):
    """The page draws or shows what is stored, with a reason; the browser goes on in either case."""
    open_page(browser, html)
    seen = call(browser, SEEN)
    assert (seen["canvases"] == 1) == (seen["notice"] == ""), seen["notice"]
    if seen["canvases"] == 0:
        assert len(seen["pictures"]) == 2
        assert seen["sliders"] == 0
    assert requests(browser) == []
    assert call(browser, "() => window.canary ?? null") is None
    return seen["canvases"] == 1


def drawn_again(browser, paper, name):
    """A drawing that was changed, in a page sealed again."""
    drawn = assert_alive(
        browser, page_of(paper, edited(paper.content["drawing"], SEALED_AGAIN[name]))
    )
    if name in ("nothing", "no sides", "null") or name.startswith("a define"):
        assert not drawn, name


def test_drawings_that_were_changed_and_sealed_again(chromium_gl, paper):
    """Sealing is anybody's; what can't be drawn then is said as of a browser that can't draw."""
    for name in SEALED_AGAIN:
        drawn_again(chromium_gl, paper, name)
    assert assert_alive(chromium_gl, page_of(paper))


@pytest.mark.slow
@pytest.mark.parametrize("name", SEALED_AGAIN)
def test_a_drawing_that_was_changed_and_sealed_again(chromium_gl, paper, name):
    """As above, each followed by the page as it was."""
    drawn_again(chromium_gl, paper, name)
    assert assert_alive(chromium_gl, page_of(paper))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_any_number_of_a_drawing_changed_and_sealed_again(chromium_gl, paper, seed):
    draw = random.Random(seed)
    drawing = paper.content["drawing"]
    path = draw.choice(leaves(drawing))
    new = draw.choice([None, "x", -1, 1e308, -1e308, 5e-324, 2**53 - 1, [], {}, True, "NaN"])
    assert_alive(chromium_gl, page_of(paper, planted(drawing, path, new)))


@pytest.mark.slow
def test_a_shader_that_never_ends(chromium_sw, paper):
    """Sealed again with a loop in it: the browser takes its driver away, and goes on."""
    shaders = shaders_of(paper.content["drawing"])
    name = "tone.frag"
    text = shaders[name]
    at = text.index("void main()")
    brace = text.index("{", at) + 1
    loop = "for (int k = 0; k < 2000000000; k++) { if (float(k) < -1.0) break; }"
    shaders = {**shaders, name: text[:brace] + loop + text[brace:]}
    open_page(chromium_sw, page(paper, shaders, body(paper)), wait=False)
    assert_alive(chromium_sw, page_of(paper))
