"""Measure the window: what a drag, a start and an hour of it cost on this machine.

Usage: python scripts/measure_viewer.py [drag] [pack] [display] [catalogue] [start] [idle] [soak]
                                       [--frames N] [--profile FILE] [--items N]

`display` drags c for sRGB and for the displays of --profile, which may be given several times.
`catalogue` opens a catalogue of N made items, scrolls through it and types into its search. Then
the panel shows, scrolled through by the wheel, and is hidden, in turn, in one run.
`pack` drags on a can with an ink, a spot varnish and an artwork of 4096 x 4096 pixels.

Everything runs on GLFW's null platform but `idle`, which needs a display. Times are of whole
frames, interface and all, each ended by a finish. The pictures are two of 640 x 640 pixels.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

PICTURE_PX = 640
WARM_UP = 15
DRAG_FRAMES = 120
CATALOGUE_ITEMS, PHASE_FRAMES = 10_000, 200
TURN_FRAMES, PAIRS = 60, 8  #: with the panel and without it, in turn
TURNS = ("scrolling, with the panel", "the same without the panel")
TYPED = "gloss 60 between 40 and 50 and quality good, sort by haze"
SOAK_FRAMES, RESIZES, SWITCHES = 20_000, 1_000, 1_000


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", default=["drag", "start"])
    parser.add_argument("--frames", type=int, default=SOAK_FRAMES)
    parser.add_argument("--items", type=int, default=CATALOGUE_ITEMS)
    parser.add_argument("--profile", action="append", default=[])
    args = parser.parse_args()
    for name in args.what:
        modes: dict[str, Callable[[], None]] = {
            "drag": drag,
            "pack": pack,
            "catalogue": partial(catalogue, args.items),
            "display": partial(display, args.profile),
            "start": start,
            "idle": idle,
        }
        modes.get(name, lambda: soak(args.frames))()
    return 0


def drag() -> None:
    from relgloss_view.viewer.state.state import State

    _drag(
        State.initial(),
        {
            "nothing": lambda model, share: None,
            "c": lambda m, x: m.set_look("test", "c", c=None, c_fraction=float(x)),
            "sigma_n": lambda m, x: m.set_look("test", "s", sigma_n_deg=float(3 * x)),
            "the lamp": lambda m, x: m.set_part("lamp", "l", azimuth_deg=float(90 * x)),
            "the camera": lambda m, x: m.set_part("eye", "e", azimuth_deg=float(60 * x)),
        },
    )


def display(profiles: list[str]) -> None:
    """Twice each, in turn, since other work on the machine comes and goes."""
    from relgloss_view.viewer.state.state import State

    for profile in 2 * ["", *profiles]:
        state = State.initial()
        shown = dataclasses.replace(state.setup.display, profile=profile)
        state = dataclasses.replace(state, setup=dataclasses.replace(state.setup, display=shown))
        print(f"display {profile or 'sRGB'}:", end=" ")
        drags = {"c": lambda m, x: m.set_look("test", "c", c=None, c_fraction=float(x))}
        _drag(state, drags)


def pack() -> None:
    from pack_speed import pack_of

    from relgloss_view.pack.shape import Shape
    from relgloss_view.picture.scene.sample import Sample
    from relgloss_view.viewer.state import matching, packs
    from relgloss_view.viewer.state.state import State

    sample = Sample.of_pack(pack_of(Shape("can")))
    state = packs.first_lit(matching.with_sample(State.initial(), "test", sample))
    _drag(
        state,
        {
            "nothing": lambda model, share: None,
            "k of a finish": lambda m, x: m.set_finish("test", "spot", "k", k=float(x)),
            "sigma_n of a finish": lambda m, x: m.set_finish(
                "test", "spot", "s", sigma_n_deg=float(3 * x)
            ),
            "the lamp": lambda m, x: m.set_part("lamp", "l", azimuth_deg=float(90 * x)),
            "the camera": lambda m, x: m.set_part("eye", "e", azimuth_deg=float(60 * x)),
        },
    )


def _drag(state: Any, changes: dict[str, Any]) -> None:
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window

    class Dragged(App):
        """Changes something in every frame, as a hand would that drags a slider."""

        def __init__(self, change: Any) -> None:
            super().__init__(state)
            self.change, self.count, self.times = change, 0, []  # type: ignore[var-annotated]
            self._last = self._cpu = self.cpu_s = 0.0

        def _note_hand(self) -> None:
            super()._note_hand()
            self.model.dragging = True
            self.draft_scale.scale = 1.0  # full resolution, whatever it takes

        def frame(self) -> None:
            self.count += 1
            self.change(self.model, 0.5 + 0.4 * np.sin(0.2 * self.count))
            super().frame()

        def after_frame(self, frame_s: float) -> bool:
            assert self.pair_renderer is not None
            self.pair_renderer.ctx.finish()
            now, cpu = time.perf_counter(), time.process_time()
            if self.count > WARM_UP:
                self.times.append(now - self._last)
                self.cpu_s += cpu - self._cpu
            self._last, self._cpu = now, cpu
            return True

    for name, change in changes.items():
        app = Dragged(change)
        window = Window(app, _window_for(PICTURE_PX), headless=True)
        window.run(WARM_UP + DRAG_FRAMES)
        ms = 1e3 * np.array(app.times)
        size = app.model.picture_size
        print(
            f"dragging {name}: two pictures of {size[0]}x{size[1]}, {1e3 / np.median(ms):.0f} "
            f"frames a second (median {np.median(ms):.1f} ms, p90 {np.percentile(ms, 90):.1f} ms, "
            f"of all cores {1e3 * app.cpu_s / len(ms):.0f} ms)"
        )


def _window_for(picture_px: int) -> tuple[int, int]:
    """The window whose pictures have this size, panels as at the first start."""
    return 2 * picture_px + 24 + 378, picture_px + 48


def catalogue(items: int) -> None:
    """Frames while a catalogue is opened, scrolled through by the wheel, and searched."""
    from pathlib import Path

    from imgui_bundle import imgui

    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.state import State

    class Timed(App):
        """Goes from phase to phase as a hand would; notes the time of every frame."""

        phase, step, last_s = "nothing", 0, 0.0

        def __init__(self, folder: str) -> None:
            super().__init__(State.initial())
            self.folder = folder
            self.times: dict[str, list[float]] = {}
            self.most_kept = 0
            self.layout.focus("Catalogue")

        def frame(self) -> None:
            many, self.step = self.files.catalogue, self.step + 1
            count = self.step
            if self.phase == "nothing" and count > PHASE_FRAMES:
                self.begin("opening")
                many.open(self.folder)
            elif self.phase == "opening" and many.found is not None:
                self.begin("scrolling")
            elif self.phase == "scrolling":
                size = imgui.get_main_viewport().size
                imgui.get_io().add_mouse_pos_event(0.3 * size.x, size.y - 60.0)
                imgui.get_io().add_mouse_wheel_event(0.0, -3.0)
                if count > 2 * PHASE_FRAMES:
                    self.begin("typing")
            elif self.phase == "typing" and count % 4 == 0:
                many.ask(text=TYPED[: count // 4])
                if count > 4 * len(TYPED) and not many.searching:
                    many.ask(text="")
                    self.begin("pairs")
            elif self.phase in TURNS or self.phase == "pairs":
                self.take_turns()
            super().frame()

        def take_turns(self) -> None:
            """Some frames with the panel, some without it, again and again."""
            turn, within = divmod(self.step - 1, TURN_FRAMES)
            if turn >= 2 * PAIRS:
                self.begin("over")
                self.quit()
                return
            shows = turn % 2 == 0
            if within == 0:
                panel = next(p for p in self.layout.panels if p.title == "Catalogue")
                panel.visible = shows
                if shows:
                    self.layout.focus("Catalogue")
            # The first frames of a turn lay the panels out and bring pictures back.
            self.phase = "pairs" if within < WARM_UP else TURNS[turn % 2]
            size = imgui.get_main_viewport().size
            imgui.get_io().add_mouse_pos_event(0.3 * size.x, size.y - 60.0)
            if shows:  # over a picture the wheel is the camera's
                imgui.get_io().add_mouse_wheel_event(0.0, -3.0)

        def begin(self, phase: str) -> None:
            self.phase, self.step = phase, 0

        def after_frame(self, frame_s: float) -> bool:
            assert self.pair_renderer is not None
            self.pair_renderer.ctx.finish()
            now_s = time.perf_counter()
            self.most_kept = max(self.most_kept, self.files.catalogue.thumbnails.count)
            if self.last_s:
                self.times.setdefault(self.phase, []).append(now_s - self.last_s)
            self.last_s = now_s
            return True

    with tempfile.TemporaryDirectory() as folder:
        many = os.path.join(folder, "many")
        maker = Path(__file__).with_name("made_catalogue.py")
        # In a process of its own, so that the first import of pyarrow is measured too.
        subprocess.run([sys.executable, str(maker), many, str(items)], check=True)
        app = Timed(many)
        Window(app, (1280, 800), headless=True).run(100_000)
    for phase in ("nothing", "opening", "scrolling", "typing", *TURNS):
        ms = 1e3 * np.array(app.times[phase][WARM_UP if phase == "nothing" else 0 :])
        p95, p99 = np.percentile(ms, [95, 99])
        print(
            f"catalogue of {items} items, {phase}: {len(ms)} frames in {ms.sum() / 1e3:.1f} s, "
            f"median {np.median(ms):.1f} ms, p95 {p95:.1f} ms, p99 {p99:.1f} ms, longest "
            f"{ms.max():.1f} ms"
        )
    print(f"memory {_memory_mb():.0f} MB, at most {app.most_kept} thumbnails on the device")


def start() -> None:
    script = (
        "import sys, time; from relgloss_view.cli import main; "
        "sys.exit(main(['view', '--screenshot', sys.argv[1], '--frames', '1']))"
    )
    with tempfile.TemporaryDirectory() as folder:
        times = []
        for _ in range(6):
            began = time.perf_counter()
            subprocess.run(
                [sys.executable, "-c", script, os.path.join(folder, "a.png")],
                check=True,
                stdout=subprocess.DEVNULL,
            )
            times.append(time.perf_counter() - began)
    shown = ", ".join(f"{t:.2f}" for t in times[1:])
    print(f"process start to the first full frame, saved as PNG: {shown} s")


def idle() -> None:
    with tempfile.TemporaryDirectory() as home:
        environment = {**os.environ, "RELGLOSS_HOME": home}
        process = subprocess.Popen(
            [sys.executable, "-m", "relgloss_view.cli", "view"], env=environment
        )
        time.sleep(6)
        before = _cpu_s(process.pid)
        time.sleep(10)
        share = (_cpu_s(process.pid) - before) / 10
        process.terminate()
        process.wait(10)
    print(f"idle: {100 * share:.1f} % of one core over 10 s")


def _cpu_s(pid: int) -> float:
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _memory_mb() -> float:
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def soak(frames: int) -> None:
    """Random sliders in every frame; resizes and sample switches in between."""
    import ctypes

    from imgui_bundle import hello_imgui  # isort: skip - before glfw, so that both use one library
    import glfw

    from relgloss_view.picture.scene.sample import SAMPLES, Sample
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.state import State

    rng = random.Random(1)
    resize_every, switch_every = max(frames // RESIZES, 1), max(frames // SWITCHES, 1)

    class Soaked(App):
        count = 0
        errors = 0
        memory: list[tuple[int, float]] = []  # noqa: RUF012 - one run

        def frame(self) -> None:
            self.count += 1
            model, side = self.model, rng.choice(("reference", "test"))
            kind = rng.randrange(4)
            if kind == 0:
                model.set_look(side, c=None, c_fraction=rng.random())
            elif kind == 1:
                model.set_look(side, sigma_n_deg=3 * rng.random())
            elif kind == 2:
                model.set_part("lamp", azimuth_deg=180 * rng.random() - 90)
            else:
                model.set_part("eye", elevation_deg=60 * rng.random() - 30)
            if self.count % switch_every == 0:
                model.set_sample(side, Sample.built_in(rng.choice(list(SAMPLES))))
            if self.count % resize_every == 0:
                library: Any = hello_imgui
                handle = ctypes.cast(
                    library.get_glfw_window_address(), ctypes.POINTER(glfw._GLFWwindow)
                )
                glfw.set_window_size(handle, rng.randrange(200, 400), rng.randrange(150, 300))
            super().frame()

        def after_frame(self, frame_s: float) -> bool:
            assert self.pair_renderer is not None
            self.errors += self.pair_renderer.ctx.error != "GL_NO_ERROR"
            if self.count % max(frames // 20, 1) == 0:
                self.memory.append((self.count, _memory_mb()))
            return super().after_frame(frame_s)

    app = Soaked(State.initial())
    app.layout.hidden = True
    began = time.perf_counter()
    Window(app, (300, 200), headless=True).run(frames)
    steady = app.memory[len(app.memory) // 10 :]
    print(
        f"{frames} frames, {frames // resize_every} resizes, {frames // switch_every} sample "
        f"switches in {time.perf_counter() - began:.0f} s: memory {steady[0][1]:.0f} MB at frame "
        f"{steady[0][0]}, {steady[-1][1]:.0f} MB at the end; {app.errors} GL errors"
    )


if __name__ == "__main__":
    sys.exit(main())
