"""Measure a proof's page in Chromium: how soon it shows, and how fast its sliders draw.

Usage: python scripts/measure_page.py [--driver gl|swiftshader] [--size PIXELS] [--frames N] [FILE]

Without FILE it makes a proof of two of the samples. Frames hold both pictures, and each is ended by
reading one pixel of the canvas, so that nothing is queued. `gl` is llvmpipe where there is no
graphics card; it needs Xvfb. Chromium's own start is not counted.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
browsers = importlib.import_module("browsers")

SAMPLES = ("matte-coated", "art-coated")
#: A part of a frame that changes, and what changes it.
MOVES = {
    "c": "s.reference.c *= 0.995; s.test.c *= 0.995;",
    "sigma_N": "s.reference.sigma_n_deg += 0.01; s.test.sigma_n_deg += 0.01;",
    "lamp": "s.lamp.azimuth_deg += 0.2;",
    "view": "s.eye.azimuth_deg += 0.2;",
}
FRAMES = """async (size, count) => {
  const engine = relgloss.engine, gl = engine.device.gl, canvas = engine.device.canvas;
  const start = relgloss.settings(), pixel = new Uint8Array(4);
  canvas.width = 2 * size; canvas.height = size;
  const boxes = ["reference", "test"].map((side, k) =>
    ({side, from: [0, 0, size, size], to: [k * size, 0, size, size]}));
  const s = JSON.parse(JSON.stringify(start)); // no common factor holds c
  s.reference.c *= 0.5; s.test.c *= 0.5;
  const frame = () => {
    engine.draw(s, [size, size]);
    engine.show(boxes);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  };
  const times = [], tones = () => engine.passes.test.draws.tone, before = tones();
  for (let k = 0; k < count; k++) {
    MOVE
    const begun = performance.now();
    frame();
    if (k >= 5) times.push(performance.now() - begun);
    if (k % 10 === 9) await new Promise((done) => setTimeout(done));
  }
  if (tones() - before < count) throw new Error("some frames drew nothing");
  times.sort((a, b) => a - b);
  return [times[times.length >> 1], times[Math.floor(0.95 * times.length)]];
}"""
#: Milliseconds from the beginning of the page to the first picture, and to the first rest.
FIRST = """async () => {
  await relgloss.ready;
  return [window.firstPicture, performance.now()];
}"""
WATCH = """document.addEventListener("DOMContentLoaded", () => {
  const look = () => {
    const engine = window.relgloss?.app?.engine ?? null;
    if (document.getElementById("main")?.dataset.state === "ready" || engine?.drawn) {
      window.firstPicture ??= performance.now();
    } else setTimeout(look, 1);
  };
  new MutationObserver(() => {
    if (document.getElementById("main")?.dataset.state === "ready") {
      window.firstPicture ??= performance.now();
    }
  }).observe(document, {attributes: true, subtree: true, attributeFilter: ["data-state"]});
});"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", nargs="?", metavar="FILE")
    parser.add_argument("--driver", choices=("gl", "swiftshader"), default="gl")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--frames", type=int, default=65)
    args = parser.parse_args()
    with contextlib.ExitStack() as stack:
        if args.file is None:
            folder = stack.enter_context(tempfile.TemporaryDirectory())
            args.file = str(Path(folder) / "proof.html")
            reference, sample = SAMPLES
            words = ["--sample", sample, "--reference", reference, "-o", args.file]
            subprocess.run(["relgloss", "proof", "make", *words], check=True)
        flags, display = browsers.SWIFTSHADER, None
        if args.driver == "gl":
            flags, display = browsers.GL, stack.enter_context(browsers.screen())
        browser = stack.enter_context(browsers.chromium(*flags, display=display))
        measure(browser, Path(args.file), args.size, args.frames)
    return 0


def measure(browser: Any, path: Path, size: int, count: int) -> None:
    """Print the figures of a page."""
    print(f"{browser.renderer or 'Chromium'}; {path.stat().st_size / 1e3:.0f} kB")
    browser.cdp("Page.addScriptToEvaluateOnNewDocument", source=WATCH)
    for name in ("first opening", "second opening"):
        browsers.open_page(browser, path, wait=False)
        picture, ready = browsers.call(browser, FIRST)
        print(f"{name}: picture after {picture:.0f} ms, at rest after {ready:.0f} ms")
    browsers.call(browser, "async () => { await relgloss.engine.prepare(relgloss.settings()); }")
    print(f"a frame of two pictures of {size} x {size}: median and 95th percentile")
    for name, move in MOVES.items():
        median, slow = browsers.call(browser, FRAMES.replace("MOVE", move), size, count)
        print(f"  {name:8}{median:7.1f} ms {slow:7.1f} ms {1e3 / median:6.0f} frames/s")


if __name__ == "__main__":
    sys.exit(main())
