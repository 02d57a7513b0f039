"""Real browsers for the proof's page: Chromium on two drivers, its log, its console, its screen.

The fixtures (conftest.py) start one browser a worker process and lane, when a test first asks for
it; without the programs they fail with the line that brings them. A page comes from file://, as a
user opens it.

    def test_something(chromium_gl, tmp_path):
        open_page(chromium_gl, path)
        assert call(chromium_gl, "async (n) => (await relgloss.ready) && n + 1", 1) == 2
        assert console(chromium_gl) == []
        assert requests(chromium_gl) == []
"""

from __future__ import annotations

import base64
import contextlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.chrome.remote_connection import ChromeRemoteConnection

ELSEWHERE = (
    "maker.test"  #: this machine by a name that browsers do not trust as they trust localhost
)
BLANK = "about:blank"
KEEPER = Path(__file__).with_name("keeper.py")
TRIES = 3  #: to start a driver
LONGEST_S = 120.0  #: of one call, on a loaded machine
SCREEN = "1600x1200x24"
WINDOW = "500,400"  #: Chromium's narrowest, so that pages draw few pixels; `emulate` for others
PACKAGES = {
    "chromium": "chromium",
    "chromedriver": "chromium-driver",
    "Xvfb": "xvfb",
    "firefox-esr": "firefox-esr",
    "WebKitWebDriver": "webkit2gtk-driver",
}
FLAGS = (
    "--no-first-run",
    "--disable-dev-shm-usage",  # which may be as small as 64 MB
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-pings",
    # A window that another one covers draws all the same.
    "--disable-backgrounding-occluded-windows",
    "--disable-renderer-backgrounding",
    "--disable-background-timer-throttling",
    "--force-color-profile=srgb",
    f"--window-size={WINDOW}",
    f"--host-resolver-rules=MAP {ELSEWHERE} 127.0.0.1",
)
GL = ("--use-gl=angle", "--use-angle=gl", "--ignore-gpu-blocklist")  #: on llvmpipe, under Xvfb
SWIFTSHADER = (
    "--headless=new",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
#: Whether there is what the page needs; the answer is null or says what is missing.
_CONTEXT = """() => {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return {missing: "no WebGL 2 context"};
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  if (!gl.getExtension("EXT_color_buffer_float")) return {missing: "no float targets", renderer};
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, 4, 4);
  return {missing: null, renderer};
}"""


@dataclass
class Browser:
    """A running Chromium: Selenium's driver, and the pages that tests made for it.

    `driver` is Selenium's, for keys and pointers (ActionChains); `cdp` sends any command of the
    DevTools protocol.
    """

    driver: webdriver.Remote
    folder: Path
    renderer: str = ""
    emulated: bool = False
    events: list[dict[str, Any]] = field(default_factory=list)
    messages: list[dict[str, Any]] = field(default_factory=list)
    scripts: list[str] = field(default_factory=list)
    pages: int = 0
    address: str = BLANK  #: of the page that was opened last

    def cdp(self, command: str, **parameters: Any) -> Any:
        """One command of the DevTools protocol, and its answer."""
        words = {"cmd": command, "params": parameters}
        return self.driver.execute("executeCdpCommand", words)["value"]

    def log(self, kind: str) -> list[dict[str, Any]]:
        """What a log of the driver, "performance" or "browser", holds since it was last read."""
        return self.driver.execute("getLog", {"type": kind})["value"]


def program(name: str) -> str:
    """The path of a program; without it the test fails and names the line that brings it."""
    found = shutil.which(name)
    if found is None:
        pytest.fail(
            f"{name} is missing. Install it: apt-get install -y --no-install-recommends "
            f"{PACKAGES[name]} (or scripts/system-packages test)",
            pytrace=False,
        )
    return found


@contextlib.contextmanager
def kept(*words: str, folder: str = "", **more: Any) -> Iterator[subprocess.Popen[bytes]]:
    """A program that runs as long as the block, and never longer than this process.

    folder: removed when the program is gone.
    """
    if folder:
        Path(folder).mkdir(exist_ok=True)
    process = subprocess.Popen(
        [sys.executable, "-SE", str(KEEPER), folder, *words], stdin=subprocess.PIPE, **more
    )
    try:
        yield process
    finally:
        assert process.stdin is not None
        process.stdin.close()
        process.wait(LONGEST_S)
        for pipe in (process.stdout, process.stderr):
            if pipe is not None:
                pipe.close()


@contextlib.contextmanager
def screen() -> Iterator[str]:
    """The name of a display without a monitor, with an X server of its own."""
    words = ("-displayfd", "1", "-screen", "0", SCREEN, "-nolisten", "tcp", "-noreset")
    with kept(program("Xvfb"), *words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as server:
        assert server.stdout is not None
        number = server.stdout.readline().decode().strip()  # nothing, should the server end
        if not number:
            pytest.fail("Xvfb did not start", pytrace=False)
        yield f":{number}"


@contextlib.contextmanager
def driver_at(name: str, *words: str, **more: Any) -> Iterator[str]:
    """The address of a WebDriver program, which chooses its own port and prints it."""
    # It takes a free port of IPv4, then the same one of IPv6, and ends where another has that.
    for _ in range(TRIES):
        with kept(
            program(name), *words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, **more
        ) as process:
            port = _port(process)
            if port:
                yield f"http://127.0.0.1:{port}"
                return
    pytest.fail(f"{name} ended before it named its port", pytrace=False)


def _port(process: subprocess.Popen[bytes]) -> int:
    assert process.stdout is not None
    for line in iter(process.stdout.readline, b""):
        word = line.decode().rpartition("on port ")[2].strip().rstrip(".")
        if word.isdigit() and int(word):
            return int(word)
    return 0


@contextlib.contextmanager
def chromium(
    *flags: str, display: str | None = None, needs: str | None = None
) -> Iterator[Browser]:
    """A Chromium with a profile of its own in a temporary folder.

    flags: beside FLAGS, GL or SWIFTSHADER for instance. needs: a part of the renderer's name;
    where it is given, a browser without WebGL 2 with float targets on that renderer fails the test.
    """
    options = webdriver.ChromeOptions()
    options.binary_location = program("chromium")
    for flag in (*FLAGS, *flags):
        options.add_argument(flag)
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        options.add_argument("--no-sandbox")  # which root can't have
    options.set_capability("goog:loggingPrefs", {"performance": "ALL", "browser": "ALL"})
    options.set_capability("unhandledPromptBehavior", "dismiss")
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY")}
    environment["LANGUAGE"] = environment["LANG"] = "C.UTF-8"
    if display is not None:
        environment["DISPLAY"] = display
    with tempfile.TemporaryDirectory(
        prefix="relgloss-browser-", ignore_cleanup_errors=True
    ) as name:
        options.add_argument(f"--user-data-dir={name}/profile")
        environment["TMPDIR"] = name
        with driver_at("chromedriver", "--port=0", folder=name, env=environment) as address:
            connection = ChromeRemoteConnection(address, keep_alive=True)
            connection.client_config.timeout = LONGEST_S
            driver = webdriver.Remote(connection, options=options)
            try:
                driver.set_script_timeout(LONGEST_S)
                driver.set_page_load_timeout(LONGEST_S)
                browser = Browser(driver, Path(name))
                if needs is not None:
                    _look_at_context(browser, needs)
                yield browser
            finally:
                with contextlib.suppress(WebDriverException, OSError):
                    driver.quit()


def _look_at_context(browser: Browser, needs: str) -> None:
    found = call(browser, _CONTEXT)
    browser.renderer = found.get("renderer", "")
    if found["missing"] or needs not in browser.renderer:
        pytest.fail(
            f"Chromium has {found['missing'] or 'another driver'} ({browser.renderer or 'none'}); "
            f"the tests need {needs}. Install it: apt-get install -y --no-install-recommends "
            "chromium chromium-driver xvfb libgl1-mesa-dri libegl-mesa0 libglx-mesa0",
            pytrace=False,
        )


def open_page(browser: Browser, page: Path | str, *, wait: bool = True) -> str:
    """Open a file, or HTML as text, as a user does: from file://. Returns its address.

    The logs begin anew. wait: for the page's own `relgloss.ready`, where it has one.
    """
    if isinstance(page, Path):
        address = page.resolve().as_uri()
    elif page.startswith(("file:", "http:", "data:", "about:")):
        address = page
    else:
        browser.pages += 1
        path = browser.folder / f"page-{browser.pages}.html"
        path.write_bytes(page.encode("utf-8", "surrogatepass"))
        address = path.as_uri()
    browser.driver.get(BLANK)
    _drain(browser)
    browser.events.clear()
    browser.messages.clear()
    browser.address = address
    browser.driver.get(address)
    if wait:
        call(browser, "async () => { if (window.relgloss) await window.relgloss.ready; }")
    return address


def frames(browser: Browser) -> None:
    """Let frames pass, in which sizes, scrolling and what the page has put off come to be drawn."""
    for _ in range(3):
        call(browser, "() => new Promise((done) => requestAnimationFrame(() => done()))")


def until(browser: Browser, condition: str) -> None:
    """Wait for a JavaScript expression to come true, however busy the machine is."""
    look = f"({condition}) ? done() : setTimeout(look, 10)"
    call(browser, f"() => new Promise((done) => {{ const look = () => {look}; look(); }})")


def call(browser: Browser, function: str, *arguments: Any) -> Any:
    """Call a JavaScript function with JSON arguments; a promise is waited for.

    function: its text, "(a, b) => a + b" for instance. What it returns must be JSON. Whatever it
    throws fails the test with the browser's message and stack.
    """
    words = ", ".join(json.dumps(argument) for argument in arguments)
    answer = browser.cdp(
        "Runtime.evaluate",
        expression=f"({function})({words})",
        awaitPromise=True,
        returnByValue=True,
        userGesture=True,
    )
    if "exceptionDetails" in answer:
        details = answer["exceptionDetails"]
        thrown = details.get("exception", {})
        message = thrown.get("description") or thrown.get("value") or details.get("text")
        raise AssertionError(f"the page threw: {message}")
    return answer["result"].get("value")


def call_array(browser: Browser, function: str, *arguments: Any, dtype: Any = None) -> Any:
    """As `call`, for a function that returns a typed array, which comes back as numpy's.

    dtype: of the numpy array; otherwise the one that belongs to the typed array.
    """
    kind, data = call(
        browser,
        f"""async (...words) => {{
          const found = await ({function})(...words);
          const bytes = new Uint8Array(found.buffer, found.byteOffset, found.byteLength);
          let text = "";
          for (let at = 0; at < bytes.length; at += 32768)
            text += String.fromCharCode(...bytes.subarray(at, at + 32768));
          return [found.constructor.name, btoa(text)];
        }}""",
        *arguments,
    )
    names = {"Uint8ClampedArray": "u1", "Uint8Array": "u1", "Int8Array": "i1"}
    names |= {"Float32Array": "<f4", "Float64Array": "<f8"}
    names |= {f"Uint{n}Array": f"<u{n // 8}" for n in (16, 32)}
    names |= {f"Int{n}Array": f"<i{n // 8}" for n in (16, 32)}
    return np.frombuffer(base64.b64decode(data), dtype or names[kind])


def _drain(browser: Browser) -> None:
    for entry in browser.log("performance"):
        browser.events.append(json.loads(entry["message"])["message"])
    browser.messages.extend(browser.log("browser"))


def console(browser: Browser, *, allowed: str | None = None) -> list[str]:
    """What the page wrote to its console since it was opened; errors among it fail the test.

    allowed: a part of the messages of errors that are meant to be there.
    """
    _drain(browser)
    errors = [
        entry["message"]
        for entry in browser.messages
        if entry["level"] == "SEVERE" and (allowed is None or allowed not in entry["message"])
    ]
    assert not errors, "the page reports errors:\n" + "\n".join(errors)
    return [entry["message"] for entry in browser.messages]


def requests(browser: Browser) -> list[str]:
    """Addresses that the page asked for since it was opened, beside itself, data: and blob:.

    From the browser's own network log, which holds what a policy refused too.
    """
    _drain(browser)
    asked = []
    for event in browser.events:
        if event["method"] == "Network.webSocketCreated":
            asked.append(event["params"]["url"])
        if event["method"] != "Network.requestWillBeSent":
            continue
        address = event["params"]["request"]["url"]
        if address == browser.address or address.startswith(("data:", "blob:", BLANK)):
            continue
        asked.append(address)
    return asked


def emulate(
    browser: Browser,
    width: int = 1280,
    height: int = 800,
    scale: float = 1.0,
    *,
    touch: bool = False,
    reduced_motion: bool = False,
    forced_colours: bool = False,
) -> None:
    """The window's size in CSS pixels, device pixels a CSS pixel, and the reader's preferences.

    Undone after each test.
    """
    browser.emulated = True
    metrics = {"width": width, "height": height, "deviceScaleFactor": scale, "mobile": touch}
    browser.cdp("Emulation.setDeviceMetricsOverride", **metrics)
    browser.cdp("Emulation.setTouchEmulationEnabled", enabled=touch, maxTouchPoints=5)
    features = [
        {"name": "prefers-reduced-motion", "value": "reduce" if reduced_motion else ""},
        {"name": "forced-colors", "value": "active" if forced_colours else ""},
    ]
    browser.cdp("Emulation.setEmulatedMedia", features=features)


def before_pages(browser: Browser, script: str) -> None:
    """Run JavaScript before any of a page's own, in pages opened later; undone after each test."""
    made = browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=script)
    browser.scripts.append(made["identifier"])


def screenshot(browser: Browser, path: Path) -> None:
    """What the browser shows, as a PNG."""
    shot = browser.cdp("Page.captureScreenshot", format="png")
    path.write_bytes(base64.b64decode(shot["data"]))


def as_before(browser: Browser) -> None:
    """Undo what a test set: sizes, preferences, scripts before pages, windows beside the first."""
    for identifier in browser.scripts:
        browser.cdp("Page.removeScriptToEvaluateOnNewDocument", identifier=identifier)
    browser.scripts.clear()
    if browser.emulated:
        browser.cdp("Emulation.clearDeviceMetricsOverride")
        browser.cdp("Emulation.setTouchEmulationEnabled", enabled=False)
        browser.cdp("Emulation.setEmulatedMedia", features=[])
        browser.cdp("Emulation.setScriptExecutionDisabled", value=False)
        browser.emulated = False
    first, *others = browser.driver.window_handles
    for handle in others:
        browser.driver.switch_to.window(handle)
        browser.driver.close()
    if others:
        browser.driver.switch_to.window(first)
