"""Draws panels in a window without a display, one after another, and keeps their pictures.

Run as a program, in a process of its own: ImGui's state is global. `draw` is its other side.
"""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

STRIP = (940, 230)
PANELS = ("lightness", "reflection", "fit", "pixel")
PICTURE = (160, 120)
PANEL_GRAY = 40  #: theme.PANEL in 8 bits


def draw(cases: list[dict], folder: Path) -> dict[str, dict]:
    """Draw cases in another process: by name, the picture (H, W, 3) and what was found."""
    (folder / "cases.json").write_text(json.dumps(cases), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, __file__, str(folder)], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr[-4000:]
    found = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    for name, entry in found.items():
        entry["picture"] = np.load(folder / f"{name}.npy")
    return found


# --- in the process of its own -------------------------------------------------------------------


def models(names: set[str]) -> dict:
    """Models by name, their frames drawn and fetched before there is a window."""
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
    import materials

    from relgloss_view.base.resources import asset
    from relgloss_view.material.material import Lobe
    from relgloss_view.measure.readers import read_measurement
    from relgloss_view.picture.gpu.context import open_context
    from relgloss_view.picture.gpu.renderer import Renderer
    from relgloss_view.picture.scene.sample import Sample, load_sample
    from relgloss_view.picture.scene.setup import Eye
    from relgloss_view.picture.stages import KEPT
    from relgloss_view.viewer.state.model import Model
    from relgloss_view.viewer.state.state import Side, State

    start = State.initial()

    def made(name: str) -> Model:
        size = PICTURE
        state = start
        if name == "large":
            size = (640, 640)
        elif name == "no fit":
            state = start.with_sample("test", Sample(materials.paper("matte")))
        elif name == "no lobes":
            state = start.with_sample("test", Sample(materials.flat(0.4)))
        elif name == "nothing seen":
            state = start.placed(eye=Eye(distance_m=0.01))
        elif name == "one pixel":
            size = (1, 1)
        elif name == "poor fit":
            material = load_sample("uncoated")
            told = ("the fit is poor: " + 12 * "words and more words ",)
            record = replace(material.fit, quality="poor", warnings=told, grounds=told)
            state = start.with_sample("test", Sample(replace(material, fit=record)))
        elif name == "odd fit":  # a file may hold anything in a fit's tables
            odd = replace(
                load_sample("uncoated").fit,
                candidates=({"name": 3, "cv_mean": "x", "verdict": ["y"]}, {}),
                residuals={"left_out": [1], "near_mirror": None},
                standard_errors={"s_deg": "wide", "sigma_deg": None},
                bounds={"main_lobe": 7, "no_lobe": {"largest_strength_upper": "?"}},
            )
            state = start.with_sample("test", Sample(replace(load_sample("uncoated"), fit=odd)))
        elif name == "light":
            white = materials.flat(0.9, (Lobe((1.0,), 2.0),))
            state = start.with_sample("test", Sample(white))
        elif name == "measured":
            state = start.with_sample(
                "test", Sample(load_sample("cast-coated"), name="cast-coated", table="cast.csv")
            )
        model = Model(state)
        if name == "measured":
            table = read_measurement(asset("papers", "cast-coated.csv"))
            model.measurements["cast.csv"] = table
        if name == "no frames":
            return model
        for side in ("reference", "test"):
            own: Side = state.side(side)
            frame = renderer.render(state.scene(side), own.look, size)
            if name != "gone":
                for kept in KEPT.values():  # the frame keeps what it has fetched
                    getattr(frame, kept)
            model.frames[side] = frame
        if name == "dragged":  # frames of another c, of which nothing is fetched, nor ever can be
            model.later = {
                side: renderer.render(
                    state.scene(side), replace(state.side(side).look, c=0.05, c_fraction=None), size
                )
                for side in model.frames
            }
        return model

    ctx = open_context("egl")
    renderer = Renderer(ctx)
    drawn = {name: made(name) for name in names}
    renderer.release()
    ctx.release()
    return drawn


def main(folder: Path) -> None:
    cases = json.loads((folder / "cases.json").read_text(encoding="utf-8"))
    drawn = models({case["model"] for case in cases})
    found = {}
    for case in cases:
        picture, entry = _window(case, drawn[case["model"]])
        np.save(folder / f"{case['name']}.npy", picture)
        found[case["name"]] = entry
    (folder / "found.json").write_text(json.dumps(found), encoding="utf-8")


@contextlib.contextmanager
def _counting(entry: dict):
    """Count the plots and the labelled curves and points that reach ImPlot in a redraw."""
    from imgui_bundle import implot

    names = ("begin_plot", "plot_line", "plot_stairs", "plot_scatter")
    real = {name: getattr(implot, name) for name in names}

    def counted(name):
        def call(*arguments):
            entry["plots" if name == "begin_plot" else "items"] += 1
            return real[name](*arguments)

        return call

    for name in names:
        setattr(implot, name, counted(name))
    try:
        yield
    finally:
        for name in names:
            setattr(implot, name, real[name])


def _window(case: dict, model) -> tuple[np.ndarray, dict]:
    """Show panels, one below the other, for a few frames."""
    import importlib
    import time

    from imgui_bundle import hello_imgui, imgui, immapp

    import glfw  # isort: skip  (the bundle's own library has to be the first)

    from relgloss_view.viewer.panels import reflection
    from relgloss_view.viewer.shell import theme
    from relgloss_view.viewer.state.model import Pixel

    shows = [
        importlib.import_module(f"relgloss_view.viewer.panels.{name}").show
        for name in case["panels"]
    ]
    width, height = case.get("size", STRIP)
    for name in case["panels"]:  # models are shared between cases, what panels remember is not
        kept = getattr(sys.modules[f"relgloss_view.viewer.panels.{name}"], "_memory", None)
        if kept is not None:
            kept._of.clear()
    for name, value in case.get("reflection", {}).items():
        setattr(reflection._memory.of(model), name, value)
    model.picture_size = max((f.size for f in model.frames.values()), default=(1, 1))
    model.pointer = Pixel(*case["pointer"]) if case.get("pointer") else None
    model.pinned = Pixel(*case["pinned"]) if case.get("pinned") else None
    model.active_side = case.get("side", "test")
    model.history.undo()
    tables, frames = model.measurements, model.frames
    model.measurements = tables if case.get("table", True) else {}
    if "lamp" in case:
        model.set_part("lamp", illuminant=case["lamp"])
    entry: dict = {"vertices": 0, "plots": 0, "items": 0, "scroll_x": 0.0, "scroll_y": 0.0}
    entry["ms"] = []
    count = _counting(entry)

    def gui() -> None:
        imgui.get_style().font_scale_main = case.get("font", 1.0)
        each = height / len(shows)
        entry["plots"] = entry["items"] = 0
        if case.get("dragging") and imgui.get_frame_count() > 3:
            model.dragging, model.frames = True, model.later
        for k, show in enumerate(shows):
            imgui.set_next_window_pos((0, k * each))
            imgui.set_next_window_size((width, each))
            flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_resize
            imgui.begin(f"panel {k}", None, flags)
            start = time.perf_counter()
            show(model)
            entry["ms"].append(1e3 * (time.perf_counter() - start))
            if imgui.get_frame_count() > 3:  # the first frames find the layout
                entry["scroll_x"] = max(entry["scroll_x"], imgui.get_scroll_max_x())
                entry["scroll_y"] = max(entry["scroll_y"], imgui.get_scroll_max_y())
            imgui.end()

    def after() -> None:
        entry["vertices"] = imgui.get_draw_data().total_vtx_count

    glfw.init_hint(glfw.PLATFORM, glfw.PLATFORM_NULL)
    assert glfw.init()
    glfw.default_window_hints()
    glfw.window_hint(glfw.CONTEXT_CREATION_API, glfw.EGL_CONTEXT_API)
    params = hello_imgui.RunnerParams()
    params.callbacks.show_gui = gui
    params.callbacks.setup_imgui_style = theme.apply
    params.callbacks.after_swap = after
    params.app_window_params.window_geometry.size = (width, height)
    params.ini_disable = True
    kinds = hello_imgui.DefaultImGuiWindowType
    params.imgui_window_params.default_imgui_window_type = kinds.no_default_window
    params.fps_idling.enable_idling = False
    params.renderer_backend_options.open_gl_options.anti_aliasing_samples = 0
    immapp.manual_render.setup_from_runner_params(params, immapp.AddOnsParams(with_implot=True))
    with count:
        for _ in range(case.get("frames", 6)):
            immapp.manual_render.render()
    immapp.manual_render.tear_down()
    model.measurements, model.frames, model.dragging = tables, frames, False
    return np.asarray(hello_imgui.final_app_window_screenshot())[..., :3], entry


if __name__ == "__main__":
    main(Path(sys.argv[1]))
