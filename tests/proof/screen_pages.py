"""A page that holds the engine, the check of the grid and the check of the screen, and no more."""

from __future__ import annotations

import json
from typing import Any

from browsers import Browser, open_page

from relgloss_view.picture.gpu.shader import stage_text
from relgloss_view.proof.drawing import shaders_of
from relgloss_view.proof.page.build import FOLDER, bundle, words
from relgloss_view.proof.proof import Proof

MODULES = ("engine.js", "check.js", "screens.js", "screen.js")
NAMES = (
    "Engine, checkGrid, checkWords, mountCheck, mountScreen, screenOf, say, "
    "unknownScreen, lstarOf, lightOfLstar, signalOf, pixelLight, shownLight, patternGamma, "
    "darkStep, blackOfStep, blackBounds, clippedFrom, possibleGammas, cases, highlightsOf, "
    "glossShown, orderOfGloss, designersScreen, significant, differences, orderWords"
)
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>screen</title>
<style>{style}</style></head><body>
<canvas id="canvas" width="64" height="64" hidden></canvas>
<main class="more"><section id="check"></section><section id="screen"></section></main>
<script type="application/json" id="words">{words}</script>
<script type="application/json" id="data">{data}</script>
<script>{code}
const data = JSON.parse(document.getElementById("data").textContent);
Object.assign(window, {{data, {names}}});
window.relgloss = {{ready: (async () => {{
  if (!data.proof) return;
  window.engine = await Engine.open(document.getElementById("canvas"), data.proof, data.shaders);
}})()}};
</script></body></html>
"""


def shaders_for(proof: Proof) -> dict[str, str]:
    """The shaders of a proof's page."""
    texts = shaders_of(proof.content["drawing"])
    for name in ("evaluate.frag", "difference.glsl"):
        texts.setdefault(name, stage_text(name))
    return texts


def open_screen(
    browser: Browser, proof: Proof | None, shaders: dict[str, str] | None = None
) -> None:
    """Open the page; `engine` draws the proof, where there is one."""
    data: dict[str, Any] = {"proof": None, "shaders": {}}
    if proof is not None:
        data = {"proof": proof.as_json(), "shaders": shaders or shaders_for(proof)}
    page = PAGE.format(
        style=(FOLDER / "style.css").read_text(encoding="utf-8"),
        words=json.dumps(words()).replace("<", "\\u003c"),
        data=json.dumps(data).replace("<", "\\u003c"),
        code=bundle(*MODULES),
        names=NAMES,
    )
    open_page(browser, page)
