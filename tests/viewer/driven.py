"""The whole window without a display, driven by labels: ImGui's test engine clicks and types.

Run as a program, in a process of its own; `drive` is its other side. The engine's licence is not
MIT: it is for tests only. What runs in the window is the viewer, unless the test module has a
function `opened(folder, run)`, a context that gives another program.
"""

from __future__ import annotations

import contextlib
import importlib
import json
import os
import subprocess
import sys
import time
import traceback
from pathlib import Path
from typing import ClassVar

LONGEST_S = 300.0  #: a busy machine draws a few frames a second
UNTIL_S = 60.0
NEVER_S = 1e6


def drive(module: str, folder: Path, **more) -> dict:
    """Run the scripts of a test module, functions (hand, found) in its SCRIPTS, in one window.

    scripts: names of those to run, if not all are. Each fills a dictionary `found` that comes back
    under the script's name. The window as it was at the end is in window.npy, (H, W, 3).
    """
    (folder / "home").mkdir()
    (folder / "run.json").write_text(json.dumps({"module": module, **more}), encoding="utf-8")
    environment = {**os.environ, "RELGLOSS_DIALOG": "own", "RELGLOSS_HOME": str(folder / "kept")}
    environment["HOME"] = str(folder / "home")
    done = subprocess.run(
        [sys.executable, __file__, str(folder)],
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
        env=environment,
        cwd=folder,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return json.loads((folder / "found.json").read_text(encoding="utf-8"))


class FakeJob:
    """A job that ends when it is told to."""

    made: ClassVar[list[FakeJob]] = []

    def __init__(self, path, wake, *_, **__):
        self.path, self.progress, self.wake = path, (0.4, "lobes"), wake
        self.result = self.fault = None
        self.done = self.cancelled = False
        self.made.append(self)

    def end(self, result=None, fault=None):
        self.result, self.fault, self.done = result, fault, True

    def cancel(self):
        self.done = self.cancelled = True

    def close(self, limit_s=1.0):
        self.cancel()


class Hand:
    """What a script has in its hands: the program, and the engine's hand on it."""

    def __init__(self, driven, ctx, folder):
        self.driven, self.ctx, self.folder = driven, ctx, folder
        self.app = driven.program
        self.model = getattr(self.app, "model", None)

    def click(self, *items):
        for item in items:
            self.ctx.item_click(item)
            self.frames(1)

    def double_click(self, item):
        from imgui_bundle import imgui

        # Frames of a busy machine may be further apart than two clicks of a hand.
        io = imgui.get_io()
        usual = io.mouse_double_click_time, io.mouse_single_click_delay
        io.mouse_double_click_time, io.mouse_single_click_delay = 5.0, 5.5
        self.ctx.item_double_click(item)
        self.frames(2)
        io.mouse_double_click_time, io.mouse_single_click_delay = usual

    def key(self, key):
        self.ctx.key_press(key)
        self.frames(2)

    def type(self, item, text, *, enter=False):
        self.ctx.item_click(item)
        if enter:
            self.ctx.key_chars_replace_enter(text)
        else:
            self.ctx.key_chars_replace(text)
        self.frames(2)

    def choose(self, combo, text):
        self.ctx.item_click(combo)
        self.ctx.item_click(f"//$FOCUSED/{text}")
        self.frames(1)

    def frames(self, count):
        self.ctx.yield_(count)

    def there(self, item):
        return self.ctx.item_exists(item)

    def do(self, action):
        """Call something on the window's thread, which alone may use OpenGL; returns its value."""
        results = []
        self.driven.to_do = lambda: results.append(action())
        self.until(lambda: bool(results))
        return results[0]

    def until(self, condition, frames=600):
        """Let frames pass until something holds; returns whether it came to.

        So many frames pass at least, and a minute: what works beside the frames may get little of
        a busy machine while they get much.
        """
        end_s = time.monotonic() + UNTIL_S
        while frames > 0 or time.monotonic() < end_s:
            if condition():
                return True
            self.ctx.yield_()
            frames -= 1
        return False

    def drag(self, start, moved, *, button=0, keys=0, steps=4, at_once=False):
        """Press at a place of the screen, move and let go, all in pixels.

        at_once: the mouse moves and is let go within one frame, as in a window that draws slowly.
        """
        if keys:
            self.ctx.key_down(keys)
        self.ctx.mouse_move_to_pos(start)
        self.ctx.mouse_down(button)
        self.frames(1)
        if at_once:
            from imgui_bundle import imgui

            end = (start[0] + moved[0], start[1] + moved[1])
            self.ctx.mouse_teleport_to_pos(end, imgui.test_engine.TestOpFlags_.no_yield)
            steps = 0
        for k in range(1, steps + 1):
            share = k / steps
            self.ctx.mouse_move_to_pos((start[0] + moved[0] * share, start[1] + moved[1] * share))
            self.frames(1)
        self.ctx.mouse_up(button)
        if keys:
            self.ctx.key_up(keys)
        self.frames(2)

    def turn_wheel(self, place, notches):
        self.ctx.mouse_move_to_pos(place)
        self.ctx.mouse_wheel_y(notches)
        self.frames(2)

    def said(self):
        return [[note.text, note.fault] for note in self.model.notes]


class Driven:
    """A program in whose window scripts run; it ends with the last of them."""

    def __init__(self, program, ended):
        self.program, self.ended = program, ended
        self.to_do = None
        self.window = None

    def __getattr__(self, name):
        return getattr(self.program, name)

    def start(self, ctx, window):
        self.window = window
        self.program.start(ctx, window)

    def after_frame(self, frame_s):
        self.program.after_frame(frame_s)
        action, self.to_do = self.to_do, None
        if action is not None:
            action()
        if self.ended():
            self.window.close()
        return True


@contextlib.contextmanager
def viewer(folder, run):
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.state.state import State

    app = App(State.initial())
    app.layout.hidden = not run.get("panels", False)  # other panels cost time
    for panel in app.layout.panels:
        panel.visible = True
    yield app


def main(folder: Path) -> None:
    import numpy as np
    from imgui_bundle import hello_imgui, imgui

    from relgloss_view.viewer.shell.window import Window

    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    here = Path(__file__).resolve().parent
    sys.path[:0] = [str(here), str(here.parent)]
    module = importlib.import_module(run["module"])
    scripts = module.SCRIPTS
    if "scripts" in run:
        scripts = [script for script in scripts if script.__name__ in run["scripts"]]
    found = {script.__name__: {} for script in scripts}
    faults = []
    over = []
    kept = []  # the engine does not keep what it calls
    engine_io = imgui.test_engine

    def test_of(driven, script):
        def test(ctx):
            try:
                script(Hand(driven, ctx, folder), found[script.__name__])
            except BaseException:
                faults.append(f"{script.__name__}: {traceback.format_exc()}")
            finally:
                over.append(script)

        return test

    def ended():
        engine = hello_imgui.get_imgui_test_engine()
        if len(over) < len(scripts) or not engine_io.is_test_queue_empty(engine):
            return False
        for script, test in kept:
            if test.output.status != engine_io.TestStatus.success:
                faults.append(f"{script.__name__}: {test.output.log.get_text()}")
        return True

    def register():
        engine = hello_imgui.get_imgui_test_engine()
        io = engine_io.get_io(engine)
        io.config_run_speed = engine_io.TestRunSpeed.fast
        io.config_log_to_tty = False
        # `drive` holds the limit: a script is slow where the machine is.
        io.config_watchdog_warning = io.config_watchdog_kill_test = NEVER_S
        for script in scripts:
            test = engine_io.register_test(engine, "driven", script.__name__)
            test.test_func = test_of(driven, script)
            kept.append((script, test))
            engine_io.queue_test(engine, test)

    def tune(params):
        params.use_imgui_test_engine = True
        params.callbacks.register_tests = register

    size = tuple(run.get("size", (800, 560)))
    with getattr(module, "opened", viewer)(folder, run) as program:
        driven = Driven(program, ended)
        window = Window(driven, size, headless=True, font_scale=run.get("font", 1.0), tune=tune)
        np.save(folder / "window.npy", window.run())
    if faults:
        print("\n".join(faults))
        sys.exit(1)
    (folder / "found.json").write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
