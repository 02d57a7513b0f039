"""The engine of the page in a page of its own, with what the window draws beside it."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from browsers import Browser, call, call_array, open_page

from relgloss_view import Look, Scene
from relgloss_view.picture.method import EXACT
from relgloss_view.picture.model.view import at_one_scale
from relgloss_view.picture.pair import common_factor
from relgloss_view.proof.drawing import drawing_of, page_display, shaders_of
from relgloss_view.proof.page.build import bundle
from relgloss_view.proof.settings import LampPlace, PictureSetting, Settings

ENTRIES = ("engine.js", "evaluate.js")
PAGE = """<!DOCTYPE html>
<html><head><meta charset="utf-8"><title>engine</title></head><body>
<canvas id="canvas" width="64" height="64"></canvas>
<script type="application/json" id="data">{data}</script>
<script>{code}
const data = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("canvas");
Object.assign(window, {{Engine, Device, Passes, View, Unsupported, evaluate, unpacked, canvas, data,
  commonFactor, heldFactor, sampleCount, fromAfar, seesACap, edgeTiles, meet, ShaderSource}});
window.relgloss = {{ready: (async () => {{
  window.engine = await Engine.open(canvas, {{content: data}}, data.shaders);
}})()}};
</script></body></html>
"""

Sides = Mapping[str, tuple[Scene, Look]]


def open_engine(
    browser: Browser, sides: Sides, *, files: Mapping[str, Any] | None = None, ready: bool = True
) -> None:
    """Open a page that holds nothing but the engine of a pair, as `engine`.

    files: of a proof's content.
    """
    drawing = json.loads(json.dumps(drawing_of(sides)))
    content = {"drawing": drawing, "shaders": shaders_of(drawing), "files": dict(files or {})}
    data = json.dumps(content)
    page = PAGE.format(data=data.replace("<", "\\u003c"), code=bundle(*ENTRIES))
    open_page(browser, page, wait=ready)


def settings_of(sides: Sides) -> Settings:
    """The settings that scenes and looks have."""
    scene, look = sides["reference"]
    _, test = sides["test"]
    return Settings(
        PictureSetting(look.sigma_n_deg, look.c),
        PictureSetting(test.sigma_n_deg, test.c),
        scene.eye,
        LampPlace.of(scene.lamp),
    )


def draw(
    browser: Browser, settings: Settings, size: tuple[int, int]
) -> tuple[dict[str, Any], dict[str, Any]]:
    """What the page draws: its report, and the pictures of both sides, (H, W, 3)."""
    report = call(browser, "(s, size) => engine.draw(s, size)", settings.as_json(), list(size))
    pictures = {}
    for side in ("reference", "test"):
        data = call_array(browser, f"() => engine.pixels('{side}').data")
        pictures[side] = data.reshape(size[1], size[0], 4)[..., :3]
    assert call(browser, "() => engine.device.errors()") == []
    return report, pictures


def desktop(
    renderer: Any, sides: Sides, settings: Settings, size: tuple[int, int]
) -> tuple[float, dict[str, Any]]:
    """What the window draws for the page's display: the common factor, and frames by side."""
    asked = {}
    eye = at_one_scale([scene.shape for scene, _ in sides.values()], settings.eye, size)
    for side, (scene, look) in sides.items():
        setting = settings.side(side)
        entries = dataclasses.asdict(settings.lamp)
        placed = scene.placed(
            display=page_display(scene.display),
            eye=eye,
            lamp=dataclasses.replace(scene.lamp, **entries),
        )
        asked[side] = (
            placed,
            look.with_entries(sigma_n_deg=setting.sigma_n_deg, c=setting.c, quality="exact"),
        )
    contrasts = []
    for scene, look in asked.values():
        frame = renderer.render(scene, look, size, EXACT)
        contrasts.append((look.c, frame.c_max))
    factor = common_factor(contrasts)
    frames = {}
    for side, (scene, look) in asked.items():
        frame = renderer.render(scene, look, size, EXACT, factor=factor)
        display = np.array(frame.display)
        frames[side] = {"display": display, "c": frame.c, "c_max": frame.c_max}
    return factor, frames
