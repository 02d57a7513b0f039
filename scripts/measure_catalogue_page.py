"""Measure a catalogue's page in Chromium: how soon it opens, and how fast it filters and sorts.

Usage: python scripts/measure_catalogue_page.py [--rows N ...] [--times N] [FILE ...]

Without FILE it writes pages of seeded rows. Opening is counted from the navigation's start: to the
first contentful paint, to the first frame of hits with all their pictures decoded, and to the end
of loading. A filter is counted from before the input event to after the frame that shows it (two
animation frames later, so up to 33 ms are the wait for frames of 60 Hz). "thread" is the time
that the page's thread computes for a filter: other programs of the machine do not change it much.
Chromium's own start is not counted.
"""

from __future__ import annotations

import argparse
import importlib
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

TESTS = Path(__file__).parent.parent / "tests"
sys.path[:0] = [str(TESTS), str(TESTS / "catalogue")]
browsers = importlib.import_module("browsers")

OPENED = """async () => {
  await relgloss.ready;
  await new Promise((done) => setTimeout(done, 100));
  const paint = performance.getEntriesByName("first-contentful-paint")[0];
  const all = performance.getEntriesByType("navigation")[0];
  return [paint?.startTime ?? null, window.firstHits ?? null, all.loadEventEnd];
}"""
#: The first frame in which all hits in view have their pictures.
WATCH = """new MutationObserver((_, watch) => {
  if (!document.querySelector("#list .open")) return;
  watch.disconnect();
  requestAnimationFrame(async () => {
    await Promise.all([...document.querySelectorAll("#list img")].map((one) => one.decode()));
    requestAnimationFrame(() => setTimeout(() => { window.firstHits = performance.now(); }));
  });
}).observe(document, {childList: true, subtree: true});"""
ACTS = {
    "range": """const s = document.querySelector('[data-range="gloss_60"] input[type="range"]');
      s.value = 1 + (k * 37) % 150; s.dispatchEvent(new Event("input"));""",
    "text": """const t = document.getElementById("text");
      t.value = String(k % 10); t.dispatchEvent(new Event("input"));""",
    "colour": """const c = document.querySelectorAll(".colour input");
      c[0].value = 40 + k; c[1].value = 5; c[2].value = 5; c[3].value = 30;
      c[0].dispatchEvent(new Event("input"));""",
    "sort": """const o = document.getElementById("sort");
      o.value = ["haze", "name", "gloss_60", "L_star"][k % 4];
      o.dispatchEvent(new Event("change"));""",
    "scroll": """const l = document.getElementById("list");
      l.scrollTop = ((k * 7919) % 97) / 97 * l.scrollHeight;""",
}
TIMES = """async (count) => {
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const whole = [];
  document.getElementById("clear").click();
  await frame(); await frame();
  for (let k = 0; k < count; k++) {
    await new Promise((done) => setTimeout(done, 20 + (k * 7) % 16));
    const begun = performance.now();
    ACT
    await frame(); // in which the page draws, or after which it does
    await new Promise((done) => { const c = new MessageChannel(); c.port1.onmessage = done;
      requestAnimationFrame(() => c.port2.postMessage(0)); });
    whole.push(performance.now() - begun);
  }
  whole.sort((a, b) => a - b);
  return [whole[whole.length >> 1], whole[Math.floor(0.95 * whole.length)]];
}"""


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", metavar="FILE", type=Path)
    parser.add_argument("--rows", nargs="+", type=int, default=[1000, 10_000])
    parser.add_argument("--times", type=int, default=30)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        files = args.files or [_seeded(count, Path(folder)) for count in args.rows]
        with browsers.chromium("--headless=new", "--disable-gpu") as browser:
            browsers.emulate(browser, 1400, 900)
            browsers.before_pages(browser, WATCH)
            for file in files:
                _measure(browser, file, args.times)
    return 0


def _seeded(count: int, folder: Path) -> Path:
    from relgloss_view.catalogue.page.write import write_page

    found, catalogue = importlib.import_module("page_rows").seeded(count)
    path = folder / f"{count}.html"
    begun = time.perf_counter()
    write_page(found, catalogue, path)
    print(f"{count} rows written in {time.perf_counter() - begun:.1f} s")
    return path


def _measure(browser: Any, file: Path, times: int) -> None:
    opened = []
    for _ in range(5):
        browsers.open_page(browser, file)
        opened.append(browsers.call(browser, OPENED))
    words = ("first contentful paint", "first hits", "loaded")
    print(f"{file.name}: {file.stat().st_size / 1e6:.1f} MB")
    for k, word in enumerate(words):
        column = sorted(one[k] for one in opened if one[k] is not None)
        print(f"  {word}: median {column[len(column) // 2]:.0f} ms, most {column[-1]:.0f} ms")
    for name, act in ACTS.items():
        before = _computed_ms(browser)
        middle, most = browsers.call(browser, TIMES.replace("ACT", act), times)
        thread = (_computed_ms(browser) - before) / times
        print(f"  {name}: median {middle:.0f} ms, 95 % {most:.0f} ms, thread {thread:.1f} ms each")


def _computed_ms(browser: Any) -> float:
    """Time that the page's main thread has computed since it was opened, ms."""
    browser.cdp("Performance.enable", timeDomain="threadTicks")
    metrics = {
        one["name"]: one["value"] for one in browser.cdp("Performance.getMetrics")["metrics"]
    }
    return 1000 * float(metrics["TaskDuration"])


if __name__ == "__main__":
    sys.exit(main())
