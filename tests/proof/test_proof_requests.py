"""No request leaves a proof: by the browser's own log, by a server that listens, by a policy."""

from __future__ import annotations

import json
import re
import time

import pytest
from browsers import SWIFTSHADER, as_before, call, chromium, console, emulate, open_page, requests
from listening import listening
from opened_proofs import SEEN, page_of

from relgloss_view.picture.scene.setup import Eye
from relgloss_view.proof.page import build
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.read import read_proof
from relgloss_view.proof.settings import LampPlace, PictureSetting, Settings

LONGEST_S = 60.0
POLICY = re.compile(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">')
PAGE = '<!DOCTYPE html>\n<html><head><meta charset="utf-8">{}<title>t</title></head><body>{}'
#: Words that injected HTML would use; {at} is an address of the listening server.
INJECTED = {
    "img": '<img src="{at}">',
    "srcset": '<img srcset="{at} 1x">',
    "style": "<style>body {{ background: url({at}) }}</style>",
    "attribute": '<p style="background: url({at})">x</p>',
    "import": "<style>@import url({at});</style>",
    "stylesheet": '<link rel="stylesheet" href="{at}">',
    "preload": '<link rel="preload" as="fetch" href="{at}">',
    "modulepreload": '<link rel="modulepreload" href="{at}">',
    "script": '<script src="{at}"></script>',
    "module": '<script type="module">import "{at}";</script>',
    "inline": "<script>new Image().src = {quoted};</script>",
    "handler": "<img src=\"data:,\" onerror='new Image().src = {quoted};'>",
    "frame": '<iframe src="{at}"></iframe>',
    "srcdoc": "<iframe srcdoc='<img src={quoted}>'></iframe>",
    "object": '<object data="{at}"></object>',
    "embed": '<embed src="{at}">',
    "audio": '<audio src="{at}" preload="auto"></audio>',
    "poster": '<video poster="{at}"></video>',
    "svg": '<svg><image href="{at}"></image></svg>',
}
#: What a script does, should one run in spite of all; `at` is the address.
SCRIPTED = {
    "fetch": "fetch(at, {mode: 'no-cors'}).catch(() => 0)",
    "xhr": "{ const x = new XMLHttpRequest(); x.open('GET', at); x.send(); }",
    "beacon": "navigator.sendBeacon(at, 'x')",
    "socket": "new WebSocket(at.replace('http', 'ws'))",
    "events": "new EventSource(at)",
    "image": "(new Image()).src = at",
    "worker": "new Worker(URL.createObjectURL(new Blob([`fetch('${at}', {mode: 'no-cors'})`])))",
    "form": """{ const f = document.createElement('form'); f.action = at; f.target = 'other';
      f.method = 'post'; document.body.append(f); f.submit(); }""",
    "font": "new FontFace('f', `url(${at})`).load().catch(() => 0)",
}
#: What no policy of a page holds, by HTML alone; the page's answer is that nobody's HTML gets in.
UNHELD = {
    "refresh": '<meta http-equiv="refresh" content="0;url={at}">',
    "preconnect": '<link rel="preconnect" href="{at}">',
}


def until(condition):
    end = time.monotonic() + LONGEST_S
    while not condition():
        assert time.monotonic() < end, "it does not come"
        time.sleep(0.02)


def address(server, name):
    return f"http://127.0.0.1:{server.port}/{name}"


def injected(server, words):
    return "\n".join(
        text.format(at=address(server, name), quoted=json.dumps(address(server, name)))
        for name, text in words.items()
    )


def arrived(server, names):
    return {name for name in names if f"/{name}" in server.paths}


def run_scripts(browser, server):
    for name, text in SCRIPTED.items():
        code = f"(at) => {{ try {{ {text}; }} catch {{ }} }}"
        call(browser, code, address(server, name))


def page_of_today():
    """A page without content, for what is the same in all."""
    settings = Settings(PictureSetting(), PictureSetting(), Eye(), LampPlace())
    return build.page(Proof({}, (Message(settings),)), {}, "")


@pytest.fixture(scope="module")
def policy():
    """The page's own, as HTML."""
    return POLICY.search(page_of_today())[0]


def test_the_policy_closes_every_way_out(chromium_gl, policy):
    """Whatever would be injected into the page, and whatever a script there would try.

    The control is the same page without the policy: there each line sends, and the server and the
    browser's log see it. The log of the page with the policy holds attempts that were refused.
    """
    names = {*INJECTED, *SCRIPTED}
    with listening() as server:
        begun = time.monotonic()
        open_page(chromium_gl, PAGE.format("", injected(server, INJECTED)), wait=False)
        run_scripts(chromium_gl, server)
        until(lambda: arrived(server, names) == names)
        took_s = time.monotonic() - begun
        logged = {line.rpartition("/")[2] for line in requests(chromium_gl)}
        # A form into another window and a worker are in the logs of targets of their own.
        assert names - logged <= {"form", "worker"}
        as_before(chromium_gl)
    with listening() as server:
        open_page(chromium_gl, PAGE.format(policy, injected(server, INJECTED)), wait=False)
        run_scripts(chromium_gl, server)
        time.sleep(2 * took_s)  # as nothing comes, nothing can be waited for
        assert server.paths == []
        # For a frame and a form Chromium dials before it asks the policy, and sends nothing.
        assert server.connections <= 2


@pytest.mark.parametrize("name", UNHELD)
def test_what_a_policy_does_not_hold(chromium_gl, policy, name):
    """These send in spite of it: so no text of a proof may become HTML (test_proof_hostile.py)."""
    with listening() as server:
        words = UNHELD[name].format(at=address(server, name))
        open_page(chromium_gl, PAGE.format(policy + words, ""), wait=False)
        until(lambda: server.connections > 0)


#: Use everything that a hand can reach, so many times; returns how many controls were used.
USE = """async (rounds) => {
  const rest = () => new Promise(done => setTimeout(done));
  const used = new Set();
  Element.prototype.setPointerCapture = () => {};  // of a pointer that is not there
  for (let round = 0; round < rounds; round++) {
    for (const details of document.querySelectorAll("details")) details.open = true;
    for (const field of document.querySelectorAll("input, select, textarea")) {
      if (field.disabled) continue;
      used.add(field);
      field.focus();
      if (field.type === "checkbox" || field.type === "radio") field.click();
      else if (field.tagName === "SELECT") {
        field.selectedIndex = (field.selectedIndex + 1) % field.options.length;
      } else if (field.type === "range" || field.type === "number") {
        const low = Number(field.min || 0), high = Number(field.max || 1);
        field.value = String(low + (high - low) * (round ? 0.7 : 0.3));
      } else field.value = `http://127.0.0.1:${round}/ <img src=//127.0.0.1/x>`;
      field.dispatchEvent(new Event("input", {bubbles: true}));
      field.dispatchEvent(new Event("change", {bubbles: true}));
      await rest();
    }
    for (const button of document.querySelectorAll("button")) {
      if (button.disabled) continue;
      used.add(button);
      button.click();
      await rest();
    }
    const canvas = document.getElementById("canvas");
    const box = canvas.getBoundingClientRect();
    for (const [name, step] of [["pointerdown", 0], ["pointermove", 9], ["pointermove", 30],
        ["pointerup", 30]]) {
      canvas.dispatchEvent(new PointerEvent(name, {bubbles: true, pointerId: 1, buttons: 1,
        clientX: box.x + 20 + step, clientY: box.y + 30 + step}));
      await rest();
    }
    canvas.dispatchEvent(new WheelEvent("wheel", {bubbles: true, deltaY: 100, cancelable: true,
      clientX: box.x + 20, clientY: box.y + 20}));
    for (const key of ["ArrowLeft", "ArrowUp", "+", "-", "w", "f", "s", "t", "l", "r", "Home", "0"])
      canvas.dispatchEvent(new KeyboardEvent("keydown", {key, bubbles: true}));
    await rest();
  }
  if (relgloss.idle) await relgloss.idle();
  return used.size;
}"""


def saved(folder):
    """Files that a browser has saved whole."""
    return [path for path in folder.iterdir() if path.suffix not in (".crdownload", ".tmp")]


def test_no_request_whatever_is_used(chromium_gl, paper, tmp_path):
    """Opened, everything used, answered, the answer opened: the browser's log stays empty."""
    saves = {"behavior": "allow", "downloadPath": str(tmp_path)}
    chromium_gl.cdp("Browser.setDownloadBehavior", **saves)
    emulate(chromium_gl, 500, 300)  # small, as every step draws
    open_page(chromium_gl, page_of(paper))
    assert call(chromium_gl, USE, 1) > 20
    until(lambda: saved(tmp_path))
    asked = requests(chromium_gl)
    console(chromium_gl)
    assert asked == []
    # The name that the walk typed has no ending, by which a browser knows a page.
    answer = saved(tmp_path)[0].rename(tmp_path / "answer.html")
    assert len(read_proof(answer).messages) == 2
    open_page(chromium_gl, answer)
    assert call(chromium_gl, SEEN)["canvases"] == 1
    console(chromium_gl)
    assert requests(chromium_gl) == []


def test_a_request_of_the_same_page_is_seen(chromium_gl, paper):
    """The control: one picture from elsewhere in the same page, without the policy."""
    with listening() as server:
        html = POLICY.sub("", page_of(paper))
        html = html.replace("<main", f'<img src="{address(server, "x")}"><main')
        open_page(chromium_gl, html)
        until(lambda: server.paths == ["/x"])
        assert requests(chromium_gl) == [address(server, "x")]


@pytest.mark.slow
def test_no_connection_of_the_whole_browser(paper, tmp_path):
    """Chromium's own record of all its processes, from start to end: no connection is made.

    The control is the same browser on a page that asks for a picture.
    """
    (tmp_path / "proof.html").write_text(page_of(paper), encoding="utf-8", newline="\n")
    with listening() as server:
        (tmp_path / "other.html").write_text(f'<img src="{address(server, "x")}">')
        for name, expected in (("proof.html", set()), ("other.html", {f"127.0.0.1:{server.port}"})):
            log = tmp_path / f"{name}.json"
            with chromium(*SWIFTSHADER, f"--log-net-log={log}") as browser:
                open_page(browser, tmp_path / name)
                if name == "proof.html":
                    call(browser, USE, 1)
            assert connections(log) == expected, name


def connections(log):
    """Addresses that a browser's network log says it has tried to connect to by TCP."""
    record = json.loads(log.read_text(encoding="utf-8", errors="replace"))
    kind = record["constants"]["logEventTypes"]["TCP_CONNECT_ATTEMPT"]
    return {
        event["params"]["address"]
        for event in record["events"]
        if event["type"] == kind and "address" in event.get("params", {})
    }


def test_the_policy_of_the_page(policy):
    """Nothing from outside, no style and no script but the page's own, by their digests."""
    words = dict(
        part.strip().partition(" ")[::2] for part in policy.split('content="')[1].split(";")
    )
    assert words["default-src"] == "'none'"
    assert words["base-uri"] == words["form-action"].partition('"')[0] == "'none'"
    assert words["img-src"] == "data: blob:"
    for name in ("script-src", "style-src"):
        assert re.fullmatch(r"'sha256-[A-Za-z0-9+/]{43}='", words[name])
    assert "unsafe" not in policy
    assert "http:" not in policy.replace("http-equiv", "")
