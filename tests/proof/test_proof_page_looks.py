"""How the page looks and reads: sizes, languages, contrast, targets, focus, hostile names."""

from __future__ import annotations

import dataclasses
import itertools
import json
import re
from pathlib import Path

import pytest
from browsers import call, console, emulate, open_page, requests
from page_samples import sample_page, sample_proof
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from relgloss_view.proof.page import build, static

FOLDER = Path(build.__file__).parent
#: The last is 1280 x 800 at 200 %. At 2560 x 1440 there are eight times as many pixels to draw.
SIZES = (
    (390, 844),
    (768, 1024),
    (1280, 800),
    pytest.param((2560, 1440), marks=pytest.mark.slow, id="2560x1440"),
    (640, 400),
)
HOSTILE = "<script>window.hurt = 1</script><img src=x onerror=window.hurt=1>" * 15
#: Elements that reach beyond the page's right edge; boxes that scroll or cut by themselves hold
#: theirs.
OVERFLOW = """() => {
  const wide = document.documentElement.clientWidth;
  const cut = (e) => e && (getComputedStyle(e).overflowX !== "visible" || cut(e.parentElement));
  const out = [...document.querySelectorAll("body *")].filter((e) => !e.closest("#live")
    && e.getBoundingClientRect().right > wide + 1 && !cut(e.parentElement));
  return [document.documentElement.scrollWidth, wide, out.map((e) => e.tagName + "#" + e.id)];
}"""
#: Text that is seen, with its colour and the ground below it; canvases and disabled controls apart.
CONTRASTS = """() => {
  const channel = (v) => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  const rgb = (css) => css.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => 0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
  const ground = (e) => {
    for (; e; e = e.parentElement) {
      const colour = rgb(getComputedStyle(e).backgroundColor);
      if (colour.length < 4 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const found = [];
  for (const e of document.querySelectorAll("body *")) {
    const own = [...e.childNodes].some((n) => n.nodeType === 3 && n.data.trim());
    const typed = e.matches("input[type=number], textarea, select, #reply-file");
    if (!(own || typed) || !e.checkVisibility() || e.matches("script, option, :disabled")) continue;
    const pair = [light(rgb(getComputedStyle(e).color)), light(ground(e))];
    found.push([(Math.max(...pair) + 0.05) / (Math.min(...pair) + 0.05),
      `${e.tagName}#${e.id}.${e.className}`]);
  }
  return found.sort((a, b) => a[0] - b[0]);
}"""


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("looks")
    return {
        "plain": sample_page(folder / "plain.html"),
        "hostile": sample_page(folder / "hostile.html", text=HOSTILE),
    }


def pseudo(text: str) -> str:
    """A text of another language, which is two fifths longer, in letters that English lacks."""
    parts = re.split(r"(\{\w+\})", text)
    return "".join(p if p[:1] == "{" else p + "\u00fc\u015f" * (len(p) // 5) for p in parts)


@pytest.fixture(scope="session")
def pseudo_file(tmp_path_factory):
    table = {key: pseudo(text) for key, text in build.words().items()}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(build, "words", lambda language="en": table)
        return sample_page(tmp_path_factory.mktemp("pseudo") / "pseudo.html", "eo")


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
def test_nothing_reaches_beyond_the_page(chromium_gl, files, size):
    emulate(chromium_gl, *size)
    for name in ("plain", "hostile") if size[0] < 1000 else ("plain",):
        open_page(chromium_gl, files[name])
        scrolled, wide, out = call(chromium_gl, OVERFLOW)
        assert out == [], name
        assert scrolled <= wide, name
    planted = """() => {
      const wide = document.createElement("p");
      wide.id = "wide";
      Object.assign(wide.style, {width: "9000px", height: "9px"});
      document.body.append(wide);
    }"""
    call(chromium_gl, planted)
    scrolled, wide, out = call(chromium_gl, OVERFLOW)
    assert scrolled > wide
    assert out == ["P#wide"]  # the negative control


def test_a_longer_language_fits(chromium_gl, pseudo_file):
    emulate(chromium_gl, 390, 844)
    open_page(chromium_gl, pseudo_file)
    scrolled, wide, out = call(chromium_gl, OVERFLOW)
    assert out == []
    assert scrolled <= wide
    cut = """() => [...document.querySelectorAll("button, label, legend, h2")].filter((e) =>
      e.checkVisibility() && e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0
      && getComputedStyle(e).display !== "inline").map((e) => e.textContent)"""
    assert call(chromium_gl, cut) == []
    title = call(chromium_gl, "() => document.querySelector('#thread h2').textContent")
    assert title == pseudo("Messages")


def test_names_and_notes_of_script_are_inert(chromium_gl, files):
    open_page(chromium_gl, files["hostile"])
    assert call(chromium_gl, "() => document.getElementById('main').dataset.state") == "ready"
    assert call(chromium_gl, "() => window.hurt ?? null") is None
    assert call(chromium_gl, "() => document.querySelector('h1').textContent") == HOSTILE[:200]
    notes = "() => document.querySelector('blockquote').textContent"
    assert call(chromium_gl, notes) == HOSTILE
    assert call(chromium_gl, "() => document.querySelectorAll('#top script').length") == 0
    assert console(chromium_gl) == []
    assert requests(chromium_gl) == []


def test_text_has_a_contrast_of_4_5(chromium_gl, files):
    """WCAG 2.2, 1.4.3, as sent and after a change; colours on their way do not count."""
    emulate(chromium_gl, 1280, 800, reduced_motion=True)
    open_page(chromium_gl, files["plain"])
    for _ in range(2):
        found = call(chromium_gl, CONTRASTS)
        assert len(found) > 60
        assert found[0][0] >= 4.5, found[:5]
        call(
            chromium_gl,
            """async () => {
              const now = relgloss.settings();
              relgloss.set({...now, eye: {...now.eye, azimuth_deg: 1}});
              await relgloss.idle();
            }""",
        )
    call(chromium_gl, "() => { document.querySelector('h1').style.color = '#555'; }")
    assert call(chromium_gl, CONTRASTS)[0][1].startswith("H1")  # the negative control


def test_fingers_have_targets_of_44_pixels(chromium_gl, files):
    emulate(chromium_gl, 390, 844, 2, touch=True)
    open_page(chromium_gl, files["plain"])
    small = """() => [...document.querySelectorAll("#look button, #controls input,"
        + "#controls select, #thread button, #reply input, #reply button, #wipe")]
      .map((e) => [e.id || e.textContent, e.getBoundingClientRect()])
      .filter(([, box]) => box.height > 0 && (box.height < 43.9 || box.width < 43.9))
      .map(([name]) => name)"""
    assert call(chromium_gl, small) == []
    call(chromium_gl, "() => document.documentElement.style.setProperty('--target', '20px')")
    assert call(chromium_gl, small)  # the negative control


def test_the_keyboard_reaches_all_and_shows_where_it_is(chromium_gl, files):
    emulate(chromium_gl, 1280, 800)
    open_page(chromium_gl, files["plain"])
    wanted = call(
        chromium_gl,
        """() => [...document.querySelectorAll(
      "#top button, #top input, #top select, #top textarea, #top summary, #top [tabindex]")]
      .filter((e) => e.checkVisibility() && !e.disabled && e.type !== "radio")
      .map((e, k) => { e.dataset.stop = k; return k; })""",
    )
    here = """() => { const e = document.activeElement, box = e.getBoundingClientRect();
      return [e.dataset.stop ?? null, getComputedStyle(e).outlineStyle,
        parseFloat(getComputedStyle(e).outlineWidth), box.bottom > 0 && box.top < innerHeight]; }"""
    reached = set()
    for _ in range(len(wanted) + 20):
        ActionChains(chromium_gl.driver).send_keys(Keys.TAB).perform()
        stop, style, width, inside = call(chromium_gl, here)
        if stop is not None:
            if int(stop) in reached:
                break
            reached.add(int(stop))
            assert style != "none", stop
            assert width >= 2, stop
            assert inside, stop
    assert reached == set(wanted)


def test_controls_have_names(chromium_gl, files):
    open_page(chromium_gl, files["plain"])
    tree = chromium_gl.cdp("Accessibility.getFullAXTree")["nodes"]
    roles = {"button", "slider", "spinbutton", "textbox", "combobox", "image", "img"}
    named = [
        (node["role"]["value"], node.get("name", {}).get("value", ""))
        for node in tree
        if not node.get("ignored") and node["role"]["value"] in roles
    ]
    assert len(named) > 20
    assert [role for role, name in named if not name.strip()] == []
    assert any("Reference sample: graininess" in name for _, name in named)


def test_forced_colours_and_reduced_motion_keep_all(chromium_gl, files):
    emulate(chromium_gl, 1280, 800, forced_colours=True, reduced_motion=True)
    open_page(chromium_gl, files["plain"])
    pressed = """() => { const style = (e) => getComputedStyle(e).backgroundColor;
      const [both, wipe] = document.querySelectorAll(".segment");
      return [style(both), style(wipe),
        getComputedStyle(document.getElementById("canvas")).forcedColorAdjust,
        getComputedStyle(document.querySelector(".button")).transitionDuration]; }"""
    on, off, adjust, duration = call(chromium_gl, pressed)
    assert on != off
    assert adjust == "none"
    assert duration == "0s"


def _scripts() -> dict[str, str]:
    """The JavaScript of the page without comments."""
    texts = {path.name: path.read_text(encoding="utf-8") for path in (FOLDER / "js").glob("*.js")}
    return {
        name: re.sub(r"^\s*//.*$|(?<=\s)//.*$|/\*[\s\S]*?\*/", "", text, flags=re.M)
        for name, text in texts.items()
    }


def test_each_key_of_the_words_is_used_and_exists():
    table = build.words()
    code = "\n".join([*_scripts().values(), (FOLDER / "static.py").read_text(encoding="utf-8")])
    keys = set(re.findall(r'["\'`]([a-z]+(?:\.[\w-]+)+)["\'`]', code))
    heads = {head for head, *_ in (key.split(".") for key in table)}
    asked = {
        key
        for key in keys
        if key.split(".")[0] in heads and not key.endswith((".js", ".frag", ".glsl"))
    }
    begun = re.findall(r'["\'`]([a-z]+\.(?:[\w-]+\.)*[\w-]*)[$\{]', code)
    assert asked <= set(table), asked - set(table)
    spare = {key for key in table if key not in asked and not key.startswith(tuple(begun))}
    assert spare == set()


def test_no_english_in_javascript_or_html():
    """Two words in a row within quotes are a text; those of errors are for programmers."""
    allowed = re.compile(r"(Error|Unsupported)\(|console\.|throw |querySelector|matchMedia|@")
    found = []
    own = "app check hand layout life main readout reply screen screens sliders static thread tools"
    for name, text in _scripts().items():
        if name.removesuffix(".js") not in own.split():
            continue
        for line in text.splitlines():
            if allowed.search(line):
                continue
            texts = re.sub(r'class: "[^"]*"|className = "[^"]*"', "", line)
            found += [(name, m) for m in re.findall(r'"([A-Za-z]{2,} [a-z]{2,}[^"]*)"', texts)]
    known = ("no webgl2", "no float targets", "no memory", "few targets", "no inflation")
    assert [entry for entry in found if entry[1] not in known] == []


def test_the_static_body_has_no_words_of_its_own(monkeypatch):
    proof = sample_proof(text="\u00e4")
    monkeypatch.setattr(build, "words", lambda language="en": dict.fromkeys(json.loads(
        (FOLDER / "words" / "en.json").read_text(encoding="utf-8")), "\u00f6"))  # fmt: skip
    text = re.sub(r"<[^>]+>", " ", static.body(proof))
    assert set(re.findall(r"[^\W\d_]+", text)) <= {"\u00e4", "\u00f6", "UTC"}


def test_the_static_body_is_complete():
    """What is seen with JavaScript off: pictures, notes, readings, settings."""
    proof = sample_proof(replies=2)
    html = static.body(proof)
    assert len(re.findall(r'<img alt="[^"]+" src="data:image/webp;base64,[\w+/=]+">', html)) == 2
    for text in ("Please look at the edge.", "Answer 2", "55.2", "White 160 cd/m2.", "Ayako Ishii"):
        assert text in html
    assert html.count('<li class="message">') == 3
    assert 'style="' not in html
    assert not re.search(r"\son\w+=", html)


def test_top_level_names_are_unique():
    pattern = r"^(?:export )?(?:async )?(?:function|const|let|class)\s+(\w+)"
    names = [re.findall(pattern, text, re.M) for text in _scripts().values()]
    flat = list(itertools.chain.from_iterable(names))
    assert len(flat) > 100
    assert sorted(flat) == sorted(set(flat))


def test_finishes_of_a_pack_are_folded_below_the_readings():
    proof = sample_proof()
    finishes = [
        {"finish": "<foil>", "lies_somewhere": True, "readings": {"gloss-60": 701.2, "haze": None}},
        {"finish": "spare", "lies_somewhere": False, "readings": {"gloss-60": 1.0, "haze": 2.0}},
    ]
    plain = static.body(proof)
    assert "<details>" not in plain
    content = {**proof.content, "meter_finishes": finishes}
    html = static.body(dataclasses.replace(proof, content=content))
    folded = re.search(r"<details>.*</details>", html, re.S)[0]
    assert "&lt;foil&gt;" in folded
    assert "701.2" in folded
    assert "spare" not in folded  # no place of the pack shows it
    assert "glossiest finish" in html


def test_messages_list_what_they_change():
    html = static.body(sample_proof(replies=2))
    items = re.findall(r'<li class="message">.*?</li>', html, re.S)
    assert [item.count("<dt>") for item in items] == [4, 3, 0]
    assert "those of the message before" in items[2]
    assert "Reference sample" not in items[1]  # which is as it was
