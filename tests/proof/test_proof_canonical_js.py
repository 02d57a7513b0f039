"""canonical.js in a real browser against Python: JSON, digests, changes, replies, signatures."""

from __future__ import annotations

import collections
import hashlib
import random

import proof_samples as samples
import pytest
from browsers import before_pages, call, console, open_page, requests
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from relgloss_view.proof.page.parts import Page
from relgloss_view.proof.proof import Message, canonical

CHECKED = """document.addEventListener("DOMContentLoaded", () => {
  window.text = canon.pageText();
  window.checked = canon.checkPage(window.text);
});"""


@pytest.fixture
def browser(chromium_sw, monkeypatch, tmp_path_factory):
    """A browser whose pages look at themselves by canonical.js, and draw nothing."""
    before_pages(chromium_sw, samples.canonical_module())
    samples.small_page(monkeypatch, tmp_path_factory.mktemp("page"), CHECKED)
    return chromium_sw


@pytest.fixture
def page(browser):
    open_page(browser, samples.page_of(samples.thread(1)))
    return browser


NUMBERS = [0.0, -0.0, 1e21, 1e20, 5e-324, 1.7976931348623157e308, 1e-7, 1e-6, 0.1, 2.0**53 - 1,
           333333333.33333329, 4.5, 2e-3, 1e23, 9.999999999999997e22, -1.5e-300]  # fmt: skip
TEXTS = ["", "\u20ac$\u000f\nA'B\"\\\\\"/", "\U0001f642", "\ufb33", "\u2028", "\x7f\x80", "</x>",
         "\0", "\ufeff", "\uffff", "\xa0"]  # fmt: skip


def values():
    """JSON of every kind, with the numbers and letters that serialisers get wrong."""
    texts = st.one_of(
        st.sampled_from(TEXTS), st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
    )
    numbers = st.one_of(
        st.sampled_from(NUMBERS),
        st.floats(allow_nan=False, allow_infinity=False),
        st.integers(-(2**53) + 1, 2**53 - 1),
    )
    leaf = st.one_of(st.none(), st.booleans(), numbers, texts)
    return st.recursive(
        leaf, lambda v: st.one_of(st.lists(v, max_size=4), st.dictionaries(texts, v, max_size=5))
    )


def collected(count):
    found = [*NUMBERS, *TEXTS, {text: k for k, text in enumerate(TEXTS)}]

    @settings(max_examples=count, database=None, derandomize=True, deadline=None,
              phases=[Phase.generate], suppress_health_check=list(HealthCheck))  # fmt: skip
    @given(values())
    def collect(value):
        found.append(value)

    collect()
    return found


@pytest.mark.parametrize("count", [100, pytest.param(2000, marks=pytest.mark.slow)])
def test_json_and_digests_are_pythons(page, count):
    made = collected(count)
    assert len(made) >= count
    want = [[(t := canonical(v)).decode(), hashlib.sha256(t).hexdigest()] for v in made]
    got = call(page, "(vs) => vs.map(v => [canon.canonical(v), canon.sha256(canon.canonical(v))])",
               made)  # fmt: skip
    assert got == want


def test_sha256_in_pieces_of_every_length(page):
    lengths = [*range(130), 1000, 65537]
    data = bytes(k * 37 % 251 for k in range(65537))
    got = call(
        page,
        """(lengths) => lengths.map((n) => {
          const bytes = Uint8Array.from({length: n}, (_, k) => k * 37 % 251);
          const half = new canon.Sha256().update(bytes.subarray(0, n >> 1));
          const other = half.copy().update(new Uint8Array(7));
          return [half.update(bytes.subarray(n >> 1)).hex(), other.hex()];
        })""",
        lengths,
    )
    for n, (whole, other) in zip(lengths, got, strict=True):
        assert whole == hashlib.sha256(data[:n]).hexdigest()
        assert other == hashlib.sha256(data[: n >> 1] + bytes(7)).hexdigest()


@pytest.mark.parametrize(
    "value", ['"\\ud800"', '"\\udc00x"', '{"\\ud83d": 1}', "NaN", "Infinity", "[undefined]"]
)
def test_what_json_cannot_hold_is_refused(page, value):
    with pytest.raises(AssertionError, match="TypeError"):
        call(page, f"() => canon.canonical({value})")


@pytest.mark.parametrize("count", [1, 3, 20])
def test_the_browser_sees_the_file_as_it_is(browser, count):
    proof = samples.thread(count)
    html = samples.page_of(proof)
    open_page(browser, html)
    assert call(browser, "() => window.text") == html
    checked = call(browser, "() => window.checked")
    assert checked["changes"] == []
    assert checked["readable"]
    assert checked["digests"] == list(proof.digests)
    assert checked["proof"] == proof.as_json()
    assert requests(browser) == []
    console(browser)


def test_replies_byte_for_byte(browser):
    """Twenty messages, each written by the browser into the page that it has got."""
    proof = samples.thread(1)
    open_page(browser, samples.page_of(proof))
    call(browser, "() => { window.reply = window.text; }")
    for k in range(1, 20):
        answer = Message(samples.settings(c=k / 7), f"Antwort {k} </script> \xa0 \U0001f642", "Bo")
        proof = proof.answered(answer)
        message = {**answer.as_json(), "parent": ""}
        call(browser, "(m) => { window.reply = canon.withMessage(window.reply, m); }", message)
    html = call(browser, "() => window.reply")
    assert html == samples.page_of(proof)
    open_page(browser, html)
    assert call(browser, "() => window.checked.digests") == list(proof.digests)
    changed = html.replace("Antwort 9 ", "Antwort 8 ")
    open_page(browser, changed)
    checked = call(browser, "() => window.checked")
    assert checked["changes"] == ["messages/10/note"]
    assert not checked["readable"]


def changed_pages(count, html):
    """(place, text) of `count` pages with one byte changed, as a browser decodes them."""
    data, chosen = html.encode("utf-8"), random.Random(19)
    for _ in range(count):
        at, changed = chosen.randrange(len(data)), bytearray(data)
        changed[at] ^= chosen.randrange(1, 256)
        yield at, bytes(changed)


#: What a browser does with a file's text before it is a page, by its own parser.
PARSED = """(texts) => texts.map((text) => {
  const page = new DOMParser().parseFromString(text, "text/html");
  const written = page.documentElement.outerHTML;
  const type = page.doctype && `<!DOCTYPE ${page.doctype.name}>\\n`;
  const whole = type + written === window.text && page.childNodes.length === 2;
  return [whole, canon.checkPage(type + written)];
})"""


@pytest.mark.parametrize("count", [200, pytest.param(1000, marks=pytest.mark.slow)])
def test_single_bytes(page, count):
    """Every one that leaves a trace in the page is found and named as Python names it.

    A browser folds letters of markup to one case, and every end of line to one character, before a
    page can see them: such a page is the sent one, node for node, and Python finds the byte.
    """
    html = samples.page_of(samples.thread(3))
    open_page(page, html)
    found, unseen = collections.Counter(), 0
    pages = [data.decode("utf-8", errors="replace") for _, data in changed_pages(count, html)]
    for start in range(0, count, 100):
        part = pages[start : start + 100]
        for text, (whole, checked) in zip(part, call(page, PARSED, part), strict=True):
            assert bool(checked["changes"]) != whole
            assert Page(text).changes
            if whole:
                unseen += 1
            else:
                found[checked["changes"][0].partition("/")[0]] += 1
    assert unseen < 0.03 * count, unseen
    assert {"head", "style", "static", "content", "messages", "parts", "script"} <= set(found)


@pytest.mark.parametrize("count", [6, pytest.param(40, marks=pytest.mark.slow)])
def test_changed_files_that_are_opened(browser, tmp_path, count):
    """As above by real files: the program ran and found it, or the browser refused to run it."""
    html = samples.page_of(samples.thread(3))
    for k, (at, data) in enumerate(changed_pages(count, html)):
        path = tmp_path / f"{k}.html"
        path.write_bytes(data)
        open_page(browser, path)
        checked = call(browser, "() => window.checked ?? null")
        same = call(browser, "() => window.text ?? null") == html
        assert checked is None or same or checked["changes"], at
        if checked is None:  # only where the byte lies in what the policy covers, or before it
            assert Page(data.decode("utf-8", "replace")).changes[0] in ("script", "head", "parts")


@pytest.mark.parametrize(
    ("old", "new", "part", "words"),
    [
        ("\U0001f642 2", "\U0001f642 5", "messages/3/note",
         ["part.message", {"number": "3", "entry": "note"}]),
        ("1.0 : 0", "1.0 : 1", "shaders/a.glsl", ["part.shader", {"name": "a.glsl"}]),
        ('"test":{"base64":"AAEC', '"test":{"base64":"AAED', "content/pictures/test",
         ["part.picture", {"name": "test"}]),
        ('"text":"{}"', '"text":"{ "', "content/files/materials/a.json",
         ["part.file", {"name": "materials/a.json"}]),
        ("12345678.9", "12345678.8", "content/drawing", ["part.entry", {"name": "drawing"}]),
        ("<h1>Dose", "<h1>Rose", "static", ["part.static", {}]),
        ("body {", "bodi {", "style", ["part.style", {}]),
        ('"style":"', '"style":"0', "parts", ["part.parts", {}]),
    ],
)  # fmt: skip
def test_changes_are_named_as_python_names_them(page, old, new, part, words):
    html = samples.page_of(samples.thread(3))
    assert old in html
    changed = html.replace(old, new, 1)
    got = call(page, "(t) => { const c = canon.checkPage(t).changes;"
                     " return [c, canon.wordsOfPart(c[0])]; }", changed)  # fmt: skip
    assert got == [[part], words]
    assert Page(changed).changes == (part,)


@pytest.mark.parametrize(
    ("old", "new", "part"),
    [
        ("</body>", '<div id="ext"></div></body>', "page"),
        ("</body>", "<style>p{}</style></body>", "page"),
        ("</body></html>", "</body><ext-root></ext-root></html>", "page"),
        ("<style>", '<style class="dark">p{}</style><style>', "head"),
        ("<body>", '<body data-ext="1">', "page"),
        ("<html lang", '<html data-theme="dark" lang', "head"),
    ],
)
def test_what_an_extension_adds_is_found(page, old, new, part):
    """The sealed JSON is whole: the page may be drawn after a click."""
    html = samples.page_of(samples.thread(2)).replace(old, new, 1)
    checked = call(page, "(t) => canon.checkPage(t)", html)
    assert checked["changes"] == [part] == list(Page(html).changes)
    assert checked["readable"]
    for text in (html.replace("5e-324", "4e-323"), html.replace('"Aya"', '"Ay\\u0061"')):
        checked = call(page, "(t) => canon.checkPage(t)", text)
        assert not checked["readable"]
        assert checked["changes"]


def test_a_future_version(page):
    proof = samples.thread(1)
    text = samples.page_of(proof).replace('],"version":1}', '],"version":2}')
    assert call(page, "(t) => canon.checkPage(t).newer", text)
    assert not call(page, "(t) => canon.checkPage(t).newer", samples.page_of(proof))
