"""Second engines, that no code of Chromium's is in: Firefox and WebKitGTK.

Firefox by WebDriver BiDi over a WebSocket of its own (there is no geckodriver in Debian), without a
window but with a display: without one it has no WebGL. WebKitGTK's MiniBrowser by WebKitWebDriver.
Both draw on the machine's OpenGL, llvmpipe.
"""

from __future__ import annotations

import base64
import contextlib
import itertools
import json
import os
import socket
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
import websocket
from browsers import LONGEST_S, kept, program
from selenium import webdriver
from selenium.common.exceptions import JavascriptException, WebDriverException
from selenium.webdriver.remote.client_config import ClientConfig
from selenium.webdriver.remote.remote_connection import RemoteConnection

CONTEXT = """() => {
  const gl = document.createElement("canvas").getContext("webgl2");
  return gl !== null && gl.getExtension("EXT_color_buffer_float") !== null;
}"""
_JSON = "async () => JSON.stringify(await ({function})({words})) ?? 'null'"
PREFERENCES: dict[str, bool | int | str] = {
    "webgl.force-enabled": True,  # on a software driver too
    "remote.active-protocols": 1,  # BiDi alone
    "browser.startup.page": 0,
    "browser.aboutwelcome.enabled": False,
    "browser.shell.checkDefaultBrowser": False,
    "browser.newtabpage.activity-stream.feeds.topsites": False,
    "app.update.enabled": False,
    "app.normandy.enabled": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "extensions.getAddons.cache.enabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "services.settings.server": "data:,#remote-settings-dummy/v1",
    "toolkit.telemetry.enabled": False,
}


@dataclass
class Firefox:
    """A running Firefox with one tab. What it saves lands in `saved`."""

    wire: websocket.WebSocket
    saved: Path
    tab: str = ""
    address: str = "about:blank"
    events: list[dict[str, Any]] = field(default_factory=list)
    numbers: Iterator[int] = field(default_factory=lambda: itertools.count(1))

    def command(self, method: str, **parameters: Any) -> dict[str, Any]:
        """One command of WebDriver BiDi, and its result."""
        number = next(self.numbers)
        self.wire.send(json.dumps({"id": number, "method": method, "params": parameters}))
        while True:
            answer = json.loads(self.wire.recv())
            if answer.get("id") == number:
                assert answer["type"] == "success", f"{method}: {answer.get('message')}"
                return answer["result"]
            if answer["type"] == "event":
                self.events.append(answer)

    def open(self, path: Path) -> None:
        """Open a file; the logs begin anew."""
        self.command("browsingContext.navigate", context=self.tab, url="about:blank")
        self.events.clear()
        self.address = path.resolve().as_uri()
        self.command(
            "browsingContext.navigate", context=self.tab, url=self.address, wait="complete"
        )

    def resize(self, width: int, height: int) -> None:
        """The page's size, CSS pixels."""
        size = {"width": width, "height": height}
        self.command("browsingContext.setViewport", context=self.tab, viewport=size)

    def screenshot(self) -> bytes:
        """What is seen of the page, as a PNG."""
        shot = self.command("browsingContext.captureScreenshot", context=self.tab)
        return base64.b64decode(shot["data"])

    @contextlib.contextmanager
    def before_pages(self, script: str) -> Iterator[None]:
        """Run JavaScript before any of a page's own, in pages opened within the block."""
        function = f"() => {{ {script} }}"
        made = self.command("script.addPreloadScript", functionDeclaration=function)
        try:
            yield
        finally:
            self.command("script.removePreloadScript", script=made["script"])

    def act(self, kind: str, *actions: dict[str, Any]) -> None:
        """Actions of one "key" or "pointer", as WebDriver names them."""
        source = {"type": kind, "id": kind, "actions": actions}
        self.command("input.performActions", context=self.tab, actions=[source])

    def call(self, function: str, *arguments: Any) -> Any:
        """Call a JavaScript function with JSON arguments, and wait for what it promises."""
        words = ", ".join(json.dumps(argument) for argument in arguments)
        answer = self.command(
            "script.callFunction",
            functionDeclaration=_JSON.format(function=function, words=words),
            awaitPromise=True,
            target={"context": self.tab},
        )
        if answer["type"] == "exception":
            raise AssertionError(f"the page threw: {answer['exceptionDetails']['text']}")
        return json.loads(answer["result"]["value"])

    def requests(self) -> list[str]:
        """Addresses that the page asked for, beside itself, data: and blob:."""
        self.call("() => 0")
        asked = [
            event["params"]["request"]["url"]
            for event in self.events
            if event["method"] == "network.beforeRequestSent"
        ]
        return [one for one in asked if one != self.address and not one.startswith(OWN)]

    def errors(self) -> list[str]:
        """What the page threw and nobody caught, and what it wrote as an error."""
        self.call("() => 0")
        return [
            event["params"]["text"]
            for event in self.events
            if event["method"] == "log.entryAdded" and event["params"]["level"] == "error"
        ]


OWN = ("data:", "blob:", "about:")


@dataclass
class WebKit:
    """A running MiniBrowser of WebKitGTK. It has no log of its network to read.

    What it saves lands in `saved`.
    """

    driver: webdriver.Remote
    saved: Path

    def open(self, path: Path) -> None:
        """Open a file."""
        self.driver.get(path.resolve().as_uri())

    def resize(self, width: int, height: int) -> None:
        """The window's size, CSS pixels; it is never below 447 wide."""
        self.driver.set_window_size(width, height)

    def screenshot(self) -> bytes:
        """What is seen of the page, as a PNG."""
        return self.driver.get_screenshot_as_png()

    def act(self, kind: str, *actions: dict[str, Any]) -> None:
        """Actions of one "key" or "pointer", as WebDriver names them."""
        source: dict[str, Any] = {"type": kind, "id": kind, "actions": actions}
        self.driver.execute("actions", {"actions": [source]})

    def call(self, function: str, *arguments: Any) -> Any:
        """Call a JavaScript function with JSON arguments, and wait for what it promises."""
        words = ", ".join(json.dumps(argument) for argument in arguments)
        made = _JSON.format(function=function, words=words)
        try:
            answer = self.driver.execute_async_script(
                f"const done = arguments[arguments.length - 1];"
                f"({made})().then(text => done([text]), why => done([null, String(why)]));"
            )
        except JavascriptException as why:
            raise AssertionError(f"the page threw: {why.msg}") from why
        if answer[0] is None:
            raise AssertionError(f"the page threw: {answer[1]}")
        return json.loads(answer[0])


def _environment(display: str, folder: str) -> dict[str, str]:
    kept_ones = {k: v for k, v in os.environ.items() if k != "WAYLAND_DISPLAY"}
    return kept_ones | {"DISPLAY": display, "HOME": folder, "TMPDIR": folder, "LANG": "C.UTF-8"}


@contextlib.contextmanager
def firefox(
    display: str, preferences: Mapping[str, bool | int | str] | None = None
) -> Iterator[Firefox]:
    """A Firefox with a profile of its own.

    preferences: beside PREFERENCES; whoever gives some gets one that may have no WebGL.
    """
    path = program("firefox-esr")
    with tempfile.TemporaryDirectory(
        prefix="relgloss-browser-", ignore_cleanup_errors=True
    ) as name:
        profile, log, saved = (Path(name) / part for part in ("profile", "log", "saved"))
        profile.mkdir()
        saved.mkdir()
        wanted = {**PREFERENCES, **(preferences or {})}
        lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});\n" for k, v in wanted.items()]
        (profile / "user.js").write_text("".join(lines), encoding="utf-8")
        words = ("--headless", "--no-remote", "--remote-debugging-port", "0", "--profile")
        with (
            log.open("wb") as output,
            kept(
                path,
                *words,
                str(profile),
                folder=name,
                stdout=output,
                stderr=output,
                env=_environment(display, name),
            ) as process,
        ):
            address = _told(log, process)
            wire = websocket.create_connection(
                f"{address}/session", timeout=LONGEST_S, suppress_origin=True
            )
            try:
                found = Firefox(wire, saved)
                found.command("session.new", capabilities={})
                found.tab = found.command("browsingContext.getTree")["contexts"][0]["context"]
                events = ["network.beforeRequestSent", "log.entryAdded"]
                found.command("session.subscribe", events=events)
                where = {"type": "allowed", "destinationFolder": str(saved)}
                found.command("browser.setDownloadBehavior", downloadBehavior=where)
                if preferences is None:
                    _look_at_context(found, "Firefox")
                yield found
            finally:
                wire.close()


def _told(log: Path, process: Any) -> str:
    """The address that Firefox writes when it listens."""
    end = time.monotonic() + LONGEST_S
    while time.monotonic() < end and process.poll() is None:
        for line in log.read_text(encoding="utf-8", errors="replace").splitlines():
            if "BiDi listening on" in line:
                return line.split()[-1]
        time.sleep(0.01)
    pytest.fail(f"Firefox did not start: {log.read_text(errors='replace')}", pytrace=False)


@contextlib.contextmanager
def webkit(display: str, *flags: str) -> Iterator[WebKit]:
    """A MiniBrowser of WebKitGTK, which keeps nothing.

    flags: whoever gives some gets one that may have no WebGL, or no JavaScript.
    """
    path = program("WebKitWebDriver")
    binaries = sorted(Path("/usr/lib").glob("*/webkit2gtk-4.*/MiniBrowser"))
    if not binaries:
        pytest.fail(
            "MiniBrowser of WebKitGTK is missing. Install it: apt-get install -y "
            "--no-install-recommends webkit2gtk-driver",
            pytrace=False,
        )
    options = webdriver.WebKitGTKOptions()
    options.binary_location = str(binaries[-1])
    for flag in ("--automation", *flags):
        options.add_argument(flag)
    with (
        tempfile.TemporaryDirectory(prefix="relgloss-browser-", ignore_cleanup_errors=True) as name,
        socket.socket() as free,
    ):
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
        free.close()
        with kept(path, f"--port={port}", folder=name, env=_environment(display, name)):
            _listens(port)
            config = ClientConfig(remote_server_addr=f"http://127.0.0.1:{port}", timeout=LONGEST_S)
            driver = webdriver.Remote(RemoteConnection(client_config=config), options=options)
            try:
                driver.set_script_timeout(LONGEST_S)
                found = WebKit(driver, Path(name))
                if not flags:
                    _look_at_context(found, "WebKitGTK")
                yield found
            finally:
                with contextlib.suppress(WebDriverException, OSError):
                    driver.quit()


def _listens(port: int) -> None:
    end = time.monotonic() + LONGEST_S
    while time.monotonic() < end:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
            return
        time.sleep(0.01)
    pytest.fail("WebKitWebDriver did not start", pytrace=False)


def _look_at_context(engine: Firefox | WebKit, name: str) -> None:
    if not engine.call(CONTEXT):
        pytest.fail(
            f"{name} has no WebGL 2 with float targets. Install it: apt-get install -y "
            "--no-install-recommends xvfb libgl1-mesa-dri libegl-mesa0 libglx-mesa0",
            pytrace=False,
        )
