"""Make docs/images/proof*.webp: the proof in browsers and in the window, and two strips.

Run: python scripts/proof_strips.py [FOLDER]

All parts are real: the window, drawn without a display and driven by labels as the tests do, and
Chromium on Mesa's software driver, with the page that `relgloss proof make` writes.
"""

from __future__ import annotations

import os
import sys
import time
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from relgloss_view.cli import main as relgloss

ROOT = Path(__file__).resolve().parents[1]
TESTS = (ROOT / "tests", ROOT / "tests" / "viewer", ROOT / "tests" / "proof")
sys.path[:0] = [str(folder) for folder in (*TESTS, ROOT / "scripts")]
MOST_BYTES = 400_000
TITLE, AUTHOR = "Carton with gold foil", "Maria, design"
NOTE = "Is the foil too strong beside the varnish?"
ANSWER, MAKER = "A little. With this we can print it.", "Jo, print"
FOIL = 0.62  #: of the designer's c that the maker answers
SCENE = (
    "--set eye.azimuth_deg=28 --set eye.elevation_deg=10 --set lamp.azimuth_deg=-24 "
    "--set lamp.elevation_deg=2 --set lamp.ambient=0.3 --set lamp.radius_m=0.08"
)
COMPARING_S = 4.0  #: in which a page compares its picture with the proof's grid
WINDOW, FONT = (1240, 800), 1.15  #: of the window, and its text
WIDE, PHONE = (1240, 800), (390, 780)  #: of the browser, CSS pixels
GROUND, INK, QUIET = (246, 246, 245), (34, 34, 34), (110, 110, 110)
MARGIN, GAP, LINE = 36, 28, 30  #: pixels of a strip
PANEL_W, PHONE_W = 760, 390  #: width of a panel in a strip


# --- scripts that the window's process runs -------------------------------------------------------


def saves(hand: Any, found: dict[str, Any]) -> None:
    """The window with the design, and the dialog that makes a proof of it."""
    model, files = hand.model, hand.app.files
    _first_panels(hand)
    files.open_path(os.environ["PROOF_STRIPS_SCENE"])
    hand.until(lambda: model.proof is not None and files._job is None)
    hand.frames(4)
    hand.until(lambda: files.proofs._compared is not None)
    hand.do(lambda: setattr(model, "proof", None))  # the designer begins with a scene
    next(p for p in hand.app.layout.panels if p.title == "Proof").visible = False
    hand.do(files.save_proof)
    hand.frames(4)
    dialog = files.proofs._dialog
    dialog.title, dialog.note, dialog.author = TITLE, NOTE, AUTHOR
    dialog.name.put("carton.html")
    model.notes.clear()
    hand.frames(8)


def reads(hand: Any, found: dict[str, Any]) -> None:
    """The window with the maker's answer."""
    model, files = hand.model, hand.app.files
    _first_panels(hand)
    files.open_path(os.environ["PROOF_STRIPS_ANSWER"])
    hand.until(lambda: model.proof is not None and files._job is None)
    hand.until(lambda: files.proofs._compared is not None)
    model.notes.clear()
    hand.frames(8)


def _first_panels(hand: Any) -> None:
    for panel in hand.app.layout.panels:
        panel.visible = panel.at_first
    hand.do(hand.app.layout.reset)
    hand.frames(4)


SCRIPTS = [saves, reads]


# --- pictures -------------------------------------------------------------------------------------


def window(script: str) -> Image.Image:
    """The window at the end of a script."""
    driven = import_module("driven")

    with TemporaryDirectory() as name:
        driven.drive(
            "proof_strips", Path(name), panels=True, size=list(WINDOW), font=FONT, scripts=[script]
        )
        return Image.fromarray(np.load(Path(name) / "window.npy"))


@dataclass
class Page:
    """A proof in Chromium."""

    browser: Any
    folder: Path

    def opened(
        self, file: Path, size: tuple[int, int], scale: float, *, mobile: bool = False
    ) -> None:
        """Open a proof in a view of a size in CSS pixels, each of them so many pixels."""
        browsers = import_module("browsers")

        self.browser.cdp(
            "Emulation.setDeviceMetricsOverride", width=size[0], height=size[1],
            deviceScaleFactor=scale, mobile=mobile,
        )  # fmt: skip
        self.browser.cdp("Emulation.setTouchEmulationEnabled", enabled=mobile)
        browsers.open_page(self.browser, file)
        self.run("async () => { await relgloss.ready; }")
        time.sleep(COMPARING_S)

    def run(self, function: str, *arguments: Any) -> Any:
        """Call a function in the page."""
        browsers = import_module("browsers")

        return browsers.call(self.browser, function, *arguments)

    def shot(self, at: str = "top") -> Image.Image:
        """The page, scrolled so that an element is at its top."""
        browsers = import_module("browsers")

        self.run(
            "async (id) => { await relgloss.idle(); const e = document.getElementById(id);"
            " if (id === 'top') window.scrollTo({top: 0, behavior: 'instant'});"
            " else window.scrollBy({top: e.getBoundingClientRect().top - 16, behavior: 'instant'});"
            " await new Promise((r) => setTimeout(r, 400)); await relgloss.idle(); }",
            at,
        )
        file = self.folder / "shot.png"
        browsers.screenshot(self.browser, file)
        with Image.open(file) as image:
            return image.convert("RGB")


def font(size: int, *, bold: bool = False) -> Any:
    """A sans-serif font of the system."""
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    try:
        return ImageFont.truetype(name, size)
    except OSError:
        return ImageFont.load_default(size)


def scaled(image: Image.Image, width: int) -> Image.Image:
    """An image at a width."""
    height = round(image.height * width / image.width)
    return image.resize((width, height), Image.Resampling.LANCZOS)


def framed(image: Image.Image) -> Image.Image:
    """An image with a thin line around it."""
    made = Image.new("RGB", (image.width + 2, image.height + 2), (190, 190, 188))
    made.paste(image, (1, 1))
    return made


def strip(panels: list[tuple[Image.Image, str]], panel_width: int) -> Image.Image:
    """Panels in a row, each with its number and a caption below."""
    made = [(framed(scaled(image, panel_width)), text) for image, text in panels]
    width = 2 * MARGIN + len(made) * (panel_width + 2) + (len(made) - 1) * GAP
    tallest = max(image.height for image, _ in made)
    sheet = Image.new("RGB", (width, MARGIN + tallest + LINE + MARGIN), GROUND)
    draw = ImageDraw.Draw(sheet)
    for k, (image, text) in enumerate(made):
        x, below = MARGIN + k * (panel_width + 2 + GAP), MARGIN + image.height + 14
        sheet.paste(image, (x, MARGIN))
        draw.text((x, below), str(k + 1), INK, font(20, bold=True))
        draw.text((x + 26, below), text, INK, font(20))
    return sheet


def side_by_side(wide: Image.Image, phone: Image.Image) -> Image.Image:
    """One design in two browsers, with what their users hold in common below."""
    height = 780
    left = framed(scaled(wide, round(wide.width * height / wide.height)))
    right = framed(scaled(phone, round(phone.width * height / phone.height)))
    width = 2 * MARGIN + left.width + GAP + right.width
    sheet = Image.new("RGB", (width, MARGIN + height + 2 + 84), GROUND)
    sheet.paste(left, (MARGIN, MARGIN))
    sheet.paste(right, (MARGIN + left.width + GAP, MARGIN))
    draw, y = ImageDraw.Draw(sheet), MARGIN + height + 18
    draw.text((MARGIN, y), "The designer's browser", INK, font(22, bold=True))
    draw.text((MARGIN, y + 30), "Both hold the same reference sample beside the left picture.",
              QUIET, font(20))  # fmt: skip
    draw.text((MARGIN + left.width + GAP, y), "The maker's phone", INK, font(22, bold=True))
    draw.text((MARGIN + left.width + GAP, y + 30), "The same file.", QUIET, font(20))
    return sheet


def save(image: Image.Image, path: Path) -> None:
    """Write a picture as WebP, as well as MOST_BYTES allow."""
    for quality in range(92, 40, -4):
        image.save(path, quality=quality, method=6)
        if path.stat().st_size < MOST_BYTES:
            break
    print(f"{path}: {image.width} x {image.height}, {path.stat().st_size / 1000:.0f} kB")


def answered(file: Path, answer: Path) -> None:
    """The maker's answer to a proof, as the page writes it."""
    words = ["proof", "make", str(file), "-o", str(answer), "--note", ANSWER, "--author", MAKER]
    from relgloss_view.proof.read import read_proof

    c = FOIL * read_proof(file).sent.test.c
    assert relgloss([*words, "--c", f"{c:.4g}"]) == 0


def main(folder: Path) -> None:
    """Make all pictures."""
    browsers = import_module("browsers")

    with TemporaryDirectory() as name:
        here = Path(name)
        file, answer = here / "carton.html", here / "carton-2.html"
        words = ["proof", "make", "carton", "-o", str(file), "--note", NOTE, "--author", AUTHOR]
        assert relgloss([*words, "--title", TITLE, *SCENE.split()]) == 0
        answered(file, answer)
        os.environ |= {"PROOF_STRIPS_SCENE": str(file), "PROOF_STRIPS_ANSWER": str(answer)}
        os.environ["PYTHONPATH"] = os.pathsep.join(map(str, (ROOT, ROOT / "scripts", *TESTS)))
        designer, reader = window("saves"), window("reads")
        with browsers.screen() as display, browsers.chromium(*browsers.GL, display=display) as one:
            page = Page(one, here)
            one.cdp("Emulation.setScrollbarsHidden", hidden=True)
            page.opened(file, WIDE, 1.5)
            sent = page.shot()
            page.opened(file, PHONE, 2.0, mobile=True)
            phone = page.shot()
            check, screen = page.shot("check"), page.shot("screen")
            page.run(
                "async (f) => { const s = relgloss.settings();"
                " await relgloss.set({...s, test: {...s.test, c: f * s.test.c}}); }",
                FOIL,
            )
            changed = page.shot()
            page.run(
                "async (note, name) => { const put = (id, t) => {"
                " const e = document.getElementById(id); e.value = t;"
                " e.dispatchEvent(new Event('input', {bubbles: true})); };"
                " put('reply-note', note); put('reply-name', name); }",
                ANSWER, MAKER,
            )  # fmt: skip
            reply = page.shot("reply")
    save(side_by_side(sent, phone), folder / "proof.webp")
    save(reader, folder / "proof-window.webp")
    made = [
        (designer, "The designer adds a note and saves the pair as one file"),
        (sent, "The maker opens the file in a browser: nothing to install"),
    ]
    save(strip(made, PANEL_W), folder / "proof-make.webp")
    answer_panels = [
        (check, "The picture is the same here"),
        (screen, "What does this screen show?"),
        (changed, "Less gloss: changed by you"),
        (reply, "The answer is a file again"),
    ]
    save(strip(answer_panels, PHONE_W), folder / "proof-answer.webp")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images")
