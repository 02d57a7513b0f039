"""The page of a catalogue in a real browser: what it finds, keeps in its address, and lets in."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
from browsers import before_pages, call, console, emulate, frames, open_page, requests, until
from page_rows import seeded, seeded_rows, thumbnail
from PIL import Image
from search_rows import MemoryCatalogue
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.keys import Keys

from relgloss_view.base.errors import InputError
from relgloss_view.base.page_scripts import bundle
from relgloss_view.catalogue.columns import COLUMNS
from relgloss_view.catalogue.page import rows as page_rows_module
from relgloss_view.catalogue.page.write import FOLDER, page_of, write_page
from relgloss_view.catalogue.query.search import search
from relgloss_view.material.difference import delta_e_2000

COUNT = 300
#: Sharma, Wu, Dalal 2005, table 1, as published: L1 a1 b1 L2 a2 b2 dE00.
SHARMA = """
50 2.6772 -79.7751 50 0 -82.7485 2.0425
50 3.1571 -77.2803 50 0 -82.7485 2.8615
50 2.8361 -74.0200 50 0 -82.7485 3.4412
50 -1.3802 -84.2814 50 0 -82.7485 1.0000
50 -1.1848 -84.8006 50 0 -82.7485 1.0000
50 -0.9009 -85.5211 50 0 -82.7485 1.0000
50 0 0 50 -1 2 2.3669
50 -1 2 50 0 0 2.3669
50 2.4900 -0.0010 50 -2.4900 0.0009 7.1792
50 2.4900 -0.0010 50 -2.4900 0.0010 7.1792
50 2.4900 -0.0010 50 -2.4900 0.0011 7.2195
50 2.4900 -0.0010 50 -2.4900 0.0012 7.2195
50 -0.0010 2.4900 50 0.0009 -2.4900 4.8045
50 -0.0010 2.4900 50 0.0010 -2.4900 4.8045
50 -0.0010 2.4900 50 0.0011 -2.4900 4.7461
50 2.5 0 50 0 -2.5 4.3065
50 2.5 0 73 25 -18 27.1492
50 2.5 0 61 -5 29 22.8977
50 2.5 0 56 -27 -3 31.9030
50 2.5 0 58 24 15 19.4535
50 2.5 0 50 3.1736 0.5854 1.0000
50 2.5 0 50 3.2972 0 1.0000
50 2.5 0 50 1.8634 0.5757 1.0000
50 2.5 0 50 3.2592 0.3350 1.0000
60.2574 -34.0099 36.2677 60.4626 -34.1751 39.4387 1.2644
63.0109 -31.0961 -5.8663 62.8187 -29.7946 -4.0864 1.2630
61.2901 3.7196 -5.3901 61.4292 2.2480 -4.9620 1.8731
35.0831 -44.1164 3.7933 35.0232 -40.0716 1.5901 1.8645
22.7233 20.0904 -46.6940 23.0331 14.9730 -42.5619 2.0373
36.4612 47.8580 18.3852 36.2715 50.5065 21.2231 1.4146
90.8027 -2.0831 1.4410 91.1528 -1.6435 0.0447 1.4441
90.9257 -0.5406 -0.9208 88.6381 -0.8985 -0.7239 1.5381
6.7747 -0.2908 -2.4247 5.8714 -0.0985 -2.2286 0.6377
2.0776 0.0795 -1.1350 0.9033 -0.0636 -0.5514 0.9082
"""


@pytest.fixture(scope="module")
def all_rows():
    return seeded(COUNT)


@pytest.fixture(scope="module")
def written(all_rows, tmp_path_factory) -> Path:
    found, catalogue = all_rows
    path = tmp_path_factory.mktemp("page") / "page.html"
    write_page(found, catalogue, path)
    return path


@pytest.fixture(scope="module")
def done():
    return [row for row in seeded_rows(COUNT) if row.get("status") != "failed"]


def at(browser, page, fragment=""):
    open_page(browser, page.as_uri() + fragment)
    return browser


def paths_shown(browser):
    text = call(browser, "() => relgloss.csv()")
    return [row["path"] for row in csv.DictReader(io.StringIO(text))]


def test_differences_are_pythons_and_the_published_ones(page_browser):
    html = f"<!DOCTYPE html><script>{bundle(FOLDER / 'js', 'difference.js')}</script>"
    open_page(page_browser, html)
    pairs = np.array([line.split() for line in SHARMA.strip().splitlines()], float)
    assert pairs.shape == (34, 7)
    run = "(pairs) => pairs.map((p) => deltaE2000(p.slice(0, 3), p.slice(3, 6)))"
    own = call(page_browser, run, pairs.tolist())
    np.testing.assert_allclose(own, pairs[:, 6], atol=5.1e-5)  # as printed
    rng = np.random.default_rng(1)
    first = rng.uniform((0, -90, -90), (100, 90, 90), (2000, 3))
    second = np.concatenate([first[:1000] + rng.normal(0, 3, (1000, 3)), first[:999:-1]])
    own = call(page_browser, run, np.hstack([first, second]).tolist())
    # Both in float64: sums of cosines of angles below 30, each within some units of 2e-16.
    np.testing.assert_allclose(own, delta_e_2000(first, second), rtol=1e-9, atol=1e-9)
    assert abs(own[0] - np.linalg.norm(first[0] - second[0])) > 1e-3  # it is not dE 1976


@pytest.mark.parametrize(
    ("fragment", "meets"),
    [
        ("#gloss_60=40..50", lambda r: 40 <= r["gloss_60"] <= 50),
        ("#haze=0..9.5&gloss_60=20..90", lambda r: r["haze"] <= 9.5 and 20 <= r["gloss_60"] <= 90),
        ("#quality=good", lambda r: r["quality"] == "good"),
        ("#marks=estimated", lambda r: "estimated" in r["marks"]),
        ("#is_ratio_kept=no", lambda r: not r["is_ratio_kept"]),
        ("#text=STOCK-001%20matte", lambda r: "stock-001" in r["path"] and "matte" in r["name"]),
        ("#L_star=0..50", lambda r: r["L_star"] is not None and r["L_star"] <= 50),
    ],
)
def test_filters_find_what_python_finds(page_browser, written, done, fragment, meets):
    at(page_browser, written, fragment)
    expected = {row["path"] for row in done if meets(row)}
    assert 0 < len(expected) < len(done)
    assert set(paths_shown(page_browser)) == expected
    assert call(page_browser, "() => document.getElementById('count').textContent") == (
        f"{len(expected)} of {len(done)} samples"
    )
    assert not console(page_browser)


def test_the_colour_filter_finds_what_python_finds(page_browser, written, done):
    at(page_browser, written, "#lab=60,5,5&within=15&sort=distance")
    lab = {r["path"]: [r["L_star"], r["a_star"], r["b_star"]] for r in done if r["L_star"]}
    far = {k: float(delta_e_2000(np.array([60.0, 5, 5]), np.array(v))) for k, v in lab.items()}
    expected = sorted((k for k in far if far[k] <= 15), key=far.__getitem__)
    assert len(expected) > 3
    assert paths_shown(page_browser) == expected


def test_a_colour_can_be_typed_number_by_number(page_browser, written):
    emulate(page_browser, 1400, 900)
    at(page_browser, written)
    before = len(paths_shown(page_browser))
    call(page_browser, "() => document.querySelector('.colour input').focus()")
    keys = ActionChains(page_browser.driver)
    keys.send_keys("60", Keys.TAB, "5", Keys.TAB, "5", Keys.TAB, Keys.END, Keys.BACKSPACE, "15")
    keys.perform()
    typed = "() => [...document.querySelectorAll('.colour input')].map((f) => f.value)"
    assert call(page_browser, typed) == ["60", "5", "5", "15"]
    painted = "() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))"
    call(page_browser, painted)
    shown = paths_shown(page_browser)
    assert 3 < len(shown) < before
    call(page_browser, "() => document.getElementById('clear').click()")
    assert call(page_browser, typed)[:3] == ["", "", ""]
    at(page_browser, written, "#lab=60,5,5&within=15")
    assert set(paths_shown(page_browser)) == set(shown)


@pytest.mark.parametrize(("down", "sign"), [("", 1), ("&down=1", -1)])
def test_columns_sort_both_ways_with_missing_values_last(page_browser, written, done, down, sign):
    at(page_browser, written, "#view=table&sort=L_star" + down)
    shown = paths_shown(page_browser)
    values = {row["path"]: row["L_star"] for row in done}
    there = [values[path] for path in shown if values[path] is not None]
    assert there == sorted(there, key=lambda v: sign * v)
    assert all(values[path] is None for path in shown[len(there) :])
    assert len(there) < len(shown)
    heads = call(page_browser, "() => [...document.querySelectorAll('th[aria-sort]')]"
                 ".filter((h) => h.ariaSort !== 'none')"
                 ".map((h) => [h.textContent, h.ariaSort])")  # fmt: skip
    assert heads == [["L*", "ascending" if sign > 0 else "descending"]]


def test_hands_on_a_filter_write_the_address_and_it_comes_back(page_browser, written):
    emulate(page_browser, 1400, 900)
    at(page_browser, written)
    before = len(paths_shown(page_browser))
    call(page_browser, """async () => {
      const field = document.querySelectorAll('[data-range="gloss_60"] input[type="number"]');
      field[0].value = "40"; field[0].dispatchEvent(new Event("change"));
      field[1].value = "50"; field[1].dispatchEvent(new Event("change"));
      document.querySelectorAll('.pick input')[0].click();
    }""")  # fmt: skip
    until(page_browser, "['gloss_60=', 'picked='].every((word) => location.hash.includes(word))")
    shown = paths_shown(page_browser)
    assert 0 < len(shown) < before
    fragment = call(page_browser, "() => location.hash")
    assert "gloss_60=40..50" in fragment
    assert "picked=" in fragment
    at(page_browser, written, fragment)
    assert paths_shown(page_browser) == shown
    assert call(page_browser, "() => relgloss.asked().picked.length") == 1


@pytest.mark.parametrize(
    "fragment",
    ["#gloss_60=a..b&sort=constructor&picked=1e9,-1,x&size=9e9&lab=1,2&within=-1",
     "#__proto__=1&toString=2..3&text=%E0%A4%A", "#<script>window.canary=1</script>"],
)  # fmt: skip
def test_addresses_that_say_nothing_change_nothing(page_browser, written, done, fragment):
    at(page_browser, written, fragment)
    asked = call(page_browser, "() => relgloss.asked()")
    assert asked["ranges"] == {}
    assert asked["picked"] == []
    assert asked["sort"] == "rank"
    assert call(page_browser, "() => window.canary ?? null") is None
    assert not console(page_browser)


def test_keys_move_open_and_compare(page_browser, written):
    emulate(page_browser, 1400, 900)
    at(page_browser, written)
    driver = page_browser.driver
    call(page_browser, "() => document.querySelector('.open[tabindex=\"0\"]').focus()")
    row = "() => Number(document.activeElement.dataset.row)"
    order = call(page_browser, "() => relgloss.rows()")
    across = call(page_browser, "() => Number(getComputedStyle(document.querySelector('.grid'))"
                  ".getPropertyValue('--across'))")  # fmt: skip
    ActionChains(driver).send_keys(Keys.ARROW_RIGHT, Keys.ARROW_DOWN).perform()
    assert call(page_browser, row) == order[1 + across]
    ActionChains(driver).send_keys("c", Keys.END).perform()
    assert call(page_browser, row) == order[-1]  # which was no element before
    assert call(page_browser, "() => relgloss.asked().picked") == [order[1 + across]]
    seen = "() => getComputedStyle(document.activeElement).outlineStyle"
    assert call(page_browser, seen) == "solid"
    ActionChains(driver).send_keys(Keys.ENTER).perform()
    assert call(page_browser, "() => !!document.querySelector('dialog[open]')")
    ActionChains(driver).send_keys(Keys.ESCAPE).perform()
    assert not call(page_browser, "() => !!document.querySelector('dialog[open]')")
    assert call(page_browser, row) == order[-1]
    assert not console(page_browser)


def test_only_lines_in_view_are_elements(page_browser, written):
    emulate(page_browser, 1400, 900)
    at(page_browser, written)
    assert call(page_browser, "() => document.querySelectorAll('.tile').length") < 100
    call(page_browser, "() => { document.getElementById('list').scrollTop = 1e9; }")
    frames(page_browser)
    last, rows = call(page_browser, "() => [Number([...document.querySelectorAll('.open')].at(-1)"
                      ".dataset.row), relgloss.rows()]")  # fmt: skip
    assert last == rows[-1]
    whole = "() => { dispatchEvent(new Event('beforeprint'));"
    whole += " return document.querySelectorAll('.tile').length }"
    assert call(page_browser, whole) == len(rows)


def test_elements_are_used_again_and_lists_that_shrink_show_their_rows(page_browser, written):
    emulate(page_browser, 1400, 900)
    at(page_browser, written)
    kept, again, tiles = call(page_browser, """async () => {
      const frames = async () => { // the page draws in the next one
        for (let k = 0; k < 3; k++) await new Promise((done) => requestAnimationFrame(done));
      };
      const list = document.getElementById("list");
      const openers = () => [...document.querySelectorAll(".open")];
      const before = new Map(openers().map((one) => [one.dataset.row, one]));
      const text = document.getElementById("text");
      text.value = "gloss"; text.dispatchEvent(new Event("input"));
      await frames();
      const now = openers().filter((one) => before.has(one.dataset.row));
      const same = now.filter((one) => before.get(one.dataset.row) === one).length;
      list.scrollTop = 1e9;
      await frames();
      location.hash = "#text=gloss&gloss_60=40..50"; // which scrolls the list nowhere
      await new Promise((done) => addEventListener("hashchange", done, {once: true}));
      await frames();
      const box = list.getBoundingClientRect();
      const seen = [...document.querySelectorAll(".tile")]
        .map((one) => one.getBoundingClientRect())
        .filter(({top, bottom}) => bottom > box.top && top < box.bottom);
      return [same, now.length, seen.length];
    }""")  # fmt: skip
    assert kept == again > 5
    assert tiles > 5


def test_words_of_the_page_are_all_used():
    from relgloss_view.catalogue.page.sentences import sentences

    files = [*FOLDER.glob("js/*.js"), *FOLDER.glob("*.py")]
    code = "\n".join(file.read_text(encoding="utf-8") for file in files)
    used = set(re.findall(r"""["']([a-z][a-z.-]*)["']""", code))
    used |= {f"view.{view}" for view in ("grid", "table")}
    assert set(sentences()) <= used
    assert all(words == words.strip() for words in sentences().values())


def test_without_scripts_there_is_a_table_with_pictures(page_browser, written, done):
    emulate(page_browser, 900, 900)
    page_browser.cdp("Emulation.setScriptExecutionDisabled", value=True)
    open_page(page_browser, written, wait=False)
    page_browser.cdp("Emulation.setScriptExecutionDisabled", value=False)
    rows, wide = call(page_browser, """() => [document.querySelectorAll("#static tbody tr").length,
      [...document.images].map((one) => one.naturalWidth)]""")  # fmt: skip
    assert rows == 200
    assert set(wide) == {128}
    assert len(wide) == 200
    assert call(page_browser, "() => document.getElementById('failed').textContent").count(
        "line 3: no number"
    ) == COUNT - len(done)


CANARY = "window.canary=1"
HOSTILE = [
    f"<script>{CANARY}</script>", f"</script><script>{CANARY}</script>",
    f'"><img src=x onerror={CANARY}>', f"<!--<script>{CANARY}", f"javascript:{CANARY}",
    f"</title></style><svg onload={CANARY}>", "\u202etxt.exe\u2066", "a\x00\x07\x1b[31m\u2028b",
    "broken \udc80 surrogate", "x" * 10_000, "=HYPERLINK(1)", "__proto__", "'; rm -rf ~ #$(id)`id`",
    "http://example.org/a?b#c", "//example.org/x", "100% & more #1?.json", "{name} ${x} &lt;b&gt;",
]  # fmt: skip


@pytest.fixture
def hostile(tmp_path):
    rows, pictures = [], {}
    for k, text in enumerate(HOSTILE):
        path = f"{k}/{text}"
        rows.append({"path": path, "name": text, "source": text, "marks": text, "quality": text,
                     "kind": text, "model": text, "warnings": text, "gloss_60": float(k),
                     "material": f"materials/{k}/{text}".replace("/../", "")})  # fmt: skip
        rows.append({"path": f"f{k}/{text}", "status": "failed", "fault": text, "name": text})
        pictures[path] = thumbnail(0.5, 0.2, (1, 1, 1)) if k % 2 else text.encode(errors="replace")
    catalogue = MemoryCatalogue(rows, thumbnails=pictures)
    catalogue.folder = tmp_path / "cat"
    path = tmp_path / "page.html"
    found = search(catalogue, "", None)
    proofs = {row["path"]: tmp_path / "proofs" / f"{k}<b>#?.html" for k, row in enumerate(rows)}
    write_page(found, catalogue, path, proofs)
    return path


def test_hostile_texts_stay_texts(page_browser, hostile):
    before_pages(
        page_browser, "addEventListener('securitypolicyviolation', () => window.broken = 1)"
    )
    for view in ("grid", "table"):
        at(page_browser, hostile, f"#view={view}&picked=0,1,2,3,4,5")
        call(page_browser, """async () => {
          for (const one of document.querySelectorAll("details")) one.open = true;
          document.querySelector("#tray .first").click();
          for (const one of [...document.querySelectorAll(".open")].slice(0, 20)) {
            for (const box of document.querySelectorAll("dialog")) box.close();
            one.click();
          }
          await new Promise((done) => setTimeout(done, 200));
        }""")  # fmt: skip
        assert call(page_browser, "() => [window.canary ?? 0, window.broken ?? 0]") == [0, 0]
        inline = """() => [...document.querySelectorAll("*")].flatMap((one) => [...one.attributes]
          .filter(({name}) => name.startsWith("on")).map(({name}) => name))"""
        assert call(page_browser, inline) == []
        assert not console(page_browser)
        own = hostile.resolve().as_uri()  # as the log has it, without the fragment
        assert [one for one in requests(page_browser) if one != own] == []
    links = call(
        page_browser, "() => [...document.querySelectorAll('dialog a')].map((a) => a.href)"
    )
    assert links
    assert all(link.startswith("file:///") for link in links)
    assert len(hostile.read_bytes()) < 400_000  # none of the 10,000 characters is there whole


def test_links_and_commands_lead_to_the_files(all_rows, tmp_path):
    """Whatever the name: decoded as a browser does, the address is the file's path again."""
    import os
    import shlex

    for name in ("lot 1/100% #2?.json", "a'b\"c.json", "javascript:x.json", "\u00e9\u4e2d.json",
                 "-o.json", "a\\b.json"):  # fmt: skip
        target = page_rows_module.beside(tmp_path / name, tmp_path / "page.html")
        address = page_rows_module.address(target)
        assert re.fullmatch(r"\./[\w/%.~-]+", address)
        assert unquote(address).removeprefix("./") == name
        words = shlex.split(page_rows_module.command(target))
        assert words[:2] == ["relgloss", "view"]
        assert os.path.normpath(words[2]) == name
    found, catalogue = all_rows
    catalogue.folder = Path("catalogue")
    hit = found.hits[0]
    for place in ("../outside.json", "/etc/passwd", "a\\..\\b.json", ""):
        changed = type(hit)({**hit.row, "material": place}, 1)
        assert page_rows_module.material_place(changed, tmp_path, tmp_path / "p.html") == ""


def test_csv_holds_no_formulas(page_browser, hostile):
    at(page_browser, hostile)
    rows = list(csv.DictReader(io.StringIO(call(page_browser, "() => relgloss.csv()"))))
    assert len(rows) == len(HOSTILE)
    assert "'=HYPERLINK(1)" in {row["name"] for row in rows}


def test_thumbnails_keep_each_pixel():
    png = thumbnail(0.8, 0.3, (1, 0.8, 0.6))
    small = page_rows_module.small_picture(png)
    with Image.open(io.BytesIO(png)) as p, Image.open(io.BytesIO(small)) as w:
        assert w.format == "WEBP"
        np.testing.assert_array_equal(np.asarray(p), np.asarray(w.convert("RGB")))
    assert page_rows_module.small_picture(b"no picture") == b""


def test_the_policy_names_what_is_there_and_nothing_more(written):
    html = written.read_text("ascii")
    policy = re.search(r'Content-Security-Policy" content="([^"]*)"', html)[1]
    assert policy.startswith("default-src 'none'; ")
    assert "unsafe" not in policy
    scripts = re.findall(r"<script>(.*?)</script>", html, re.S)
    assert len(scripts) == 1
    assert len(re.findall("<style>", html)) == 1
    import base64

    digest = base64.b64encode(hashlib.sha256(scripts[0].encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy
    assert " style=" not in html
    assert json.loads(re.search(r'id="rows">(.*?)</script>', html, re.S)[1])["count"] == 294


def test_equal_results_are_equal_pages_and_faults_leave_nothing(tmp_path):
    found, catalogue = seeded(30)
    one, two = (page_of(found, catalogue, tmp_path / "p.html", {}) for _ in range(2))
    assert one == two
    with pytest.raises(InputError):
        write_page(found, catalogue, tmp_path / "no folder" / "p.html")
    assert not list(tmp_path.iterdir())


def test_every_column_of_the_page_is_one_of_the_table():
    names = {column.name for column in COLUMNS}
    assert set(page_rows_module.SHOWN + page_rows_module.FURTHER) <= names
