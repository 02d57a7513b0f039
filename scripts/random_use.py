"""Use the window at random for a while, and log what its process holds.

Usage: python scripts/random_use.py [--minutes M] [--seed N] [--most-mb MB]

A seeded hand moves, drags, clicks, types, turns the wheel, resizes the window between 0 x 0 and
1920 x 1200 pixels, chooses actions, changes every entry of the state, opens files, exports, undoes.
Everything runs on GLFW's null platform. A line every ten seconds gives the resident memory and
counts of what the program keeps. The status is 1 where memory passes --most-mb, where a change of
the state raises an error that is not an InputError, or where the device reports an error.
"""

# ruff: noqa: D102 - each way of the hand is named for what it does

from __future__ import annotations

import argparse
import ctypes
import dataclasses
import gc
import os
import random
import sys
import tempfile
import threading
import time
import webbrowser
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

LARGEST_WINDOW = (1920, 1200)
LARGEST_EXPORT = 1024  #: side of an exported picture, pixels
LOG_S = 10.0
WORTH_A_LINE_MB = 10.0
#: Of one event in so many frames: the interface has time to settle and to warm up between some.
IDLE_FRAMES = 6
TYPED = "0123456789.-eabcgλ漢"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--minutes", type=float, default=20.0, help="how long (default 20)")
    parser.add_argument("--seed", type=int, default=1, help="of the random events (default 1)")
    parser.add_argument("--most-mb", type=float, default=500.0, help="of memory (default 500)")
    parser.add_argument("--no-fits", action="store_true", help="open no tables")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        os.environ.update(RELGLOSS_HOME=f"{folder}/kept", RELGLOSS_DIALOG="own", HOME=folder)
        os.chdir(folder)
        return use(Path(folder), args)


def resident_mb() -> tuple[float, float]:
    """The process's memory now, and at most so far, in MB of 10^6 bytes."""
    with open("/proc/self/status", encoding="ascii") as file:
        lines = dict(line.split(":", 1) for line in file)
    now, most = (int(lines[name].split()[0]) * 1024 / 1e6 for name in ("VmRSS", "VmHWM"))
    return now, most


def kinds_of_memory() -> str:
    """Resident memory by what lies behind it, in MB."""
    total: Counter[str] = Counter()
    kind = ""
    with open("/proc/self/smaps", encoding="ascii", errors="replace") as file:
        for line in file:
            words = line.split()
            if "-" in words[0] and not words[0].endswith(":"):
                name = words[5] if len(words) > 5 else ""
                kind = "files" if name.startswith("/") else name.strip("[]") or "blocks"
            elif words[0] == "Rss:":
                total[kind] += int(words[1])
    return ", ".join(f"{n} {1.024e-3 * kb:.0f}" for n, kb in total.most_common() if kb > 1000)


def use(folder: Path, args: argparse.Namespace) -> int:
    """Run the window under the hand; returns the status."""
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.session import Autosave, session_file
    from relgloss_view.viewer.state.state import State

    webbrowser.open = lambda *_, **__: True

    class Used(App):
        """The program, with a hand that does something between frames."""

        hand: Hand

        def after_frame(self, frame_s: float) -> bool:
            super().after_frame(frame_s)
            self.hand.between_frames()
            return True

    app = Used(State.initial())
    app.files.session = Autosave(session_file(), app.model.state)
    app.hand = Hand(app, folder, args)
    Window(app, (1280, 800), headless=True).run()
    return app.hand.end()


class Hand:
    """What happens to the window, and the log of what it holds."""

    def __init__(self, app: Any, folder: Path, args: argparse.Namespace) -> None:
        from relgloss_view.picture.scene.sample import SAMPLES

        self.app, self.folder, self.args = app, folder, args
        self.rng = random.Random(args.seed)
        self.done: Counter[str] = Counter()
        self.refused: Counter[str] = Counter()
        self.began_s = self.logged_s = time.monotonic()
        self.steps: list[Callable[[], None]] = []  #: of a gesture, one a frame
        self.most_mb = 0.0
        self.errors = 0
        self.last = "the start"
        self.place = (400.0, 300.0)
        self.samples = list(SAMPLES)
        self.files = 0
        self.art: Path | None = None  #: the last artwork
        self.ways: list[tuple[float, Callable[[], None]]] = [
            (3.0, self.move),
            (4.0, self.drag),
            (4.0, self.click),
            (2.0, self.wheel),
            (2.0, self.key),
            (1.0, self.type),
            (3.0, self.action),
            (5.0, self.look),
            (3.0, self.setup),
            (1.0, self.presentation),
            (1.0, self.sample),
            (1.0, self.material),
            (1.5, self.undo),
            (1.0, self.resize),
            (1.0, self.panels),
            (0.3, self.export),
            (0.3, self.view),
            (0.3, self.open_material),
            (0.3, self.open_scene),
            (0.1 if not args.no_fits else 0.0, self.open_table),
            (0.3, self.preset),
            (0.3, self.leave),
            (0.05, self.drop_nothing),
            (0.4, self.open_artwork),
            (0.2, self.open_many),
            (3.0, self.finish),
            (1.5, self.form),
            (2.0, self.artwork),
            (0.3, self.edit_artwork),
        ]

    # --- the loop -----------------------------------------------------------------------------

    def between_frames(self) -> None:
        """One step of what is under way, or something new."""
        now_s = time.monotonic()
        self.errors += self.app.pair_renderer.ctx.error != "GL_NO_ERROR"
        self.note_memory()
        if now_s - self.logged_s > LOG_S:
            self.logged_s = now_s
            self.log()
        if now_s - self.began_s > 60.0 * self.args.minutes:
            self.app.quit()
            return
        if not self.steps:
            weights = [weight for weight, _ in self.ways]
            way = self.rng.choices([way for _, way in self.ways], weights)[0]
            self.attempt(way)
            self.steps += [lambda: None] * self.rng.randrange(IDLE_FRAMES)
        else:
            self.attempt(self.steps.pop(0))

    def note_memory(self) -> None:
        """Take the kernel's own maximum, and print where it has grown, to find the cause."""
        now, most = resident_mb()
        if most > self.most_mb + WORTH_A_LINE_MB:
            threads = threading.active_count() - 1
            print(
                f"most {most:.0f} MB, now {now:.0f}, after {self.last}, {threads} threads at work: "
                f"{kinds_of_memory()}, window {self.app._window.size_now()}, "
                f"pictures {self.app.model.picture_size}",
                flush=True,
            )
            self.most_mb = most

    def attempt(self, act: Callable[[], None]) -> None:
        from relgloss_view.base.errors import RelglossError

        name = act.__name__
        self.last = name if name != "<lambda>" else self.last
        try:
            act()
        except RelglossError as error:
            self.refused[f"{name}: {type(error).__name__}"] += 1
        else:
            if name != "<lambda>":
                self.done[name] += 1

    def log(self) -> None:
        app, (now, most) = self.app, resident_mb()
        pair = app.pair_renderer
        renderers = {
            **{f"full {side}": r for side, r in pair._full.items()},
            **{f"draft {side}": r for side, r in pair._draft.items()},
            "warm": pair._warm,
        }
        held = {name: targets_mb(r) for name, r in renderers.items()}
        parts = [
            f"{time.monotonic() - self.began_s:6.0f} s",
            f"{now:5.0f} MB (most {most:.0f})",
            kinds_of_memory(),
            f"programs {len(pair._programs._arrays)} of {pair._programs.compiled}",
            f"targets {sum(held.values()):.0f} MB ("
            + ", ".join(f"{n} {mb:.0f}" for n, mb in held.items() if mb >= 1.0)
            + ")",
            f"frames {frames_mb():.0f} MB",
            f"dropped objects {len(pair.ctx.objects)}",
            f"undo {len(app.model.history._past)}+{len(app.model.history._future)}",
            f"tables {len(app.model.measurements)}",
            f"fonts {font_texture_mb():.1f} MB",
            f"threads {threading.active_count()}",
            f"events {sum(self.done.values())}",
            f"window {app._window.size_now()}",
        ]
        print("  ".join(parts), flush=True)

    def end(self) -> int:
        """Print what was done; returns the status."""
        print(f"done: {dict(self.done.most_common())}")
        print(f"refused: {dict(self.refused)}")
        print(f"notes: {len(self.app.model.notes)}, the last: {self.app.model.notes[-3:]}")
        self.most_mb = resident_mb()[1]
        gc.collect()
        print(
            f"{sum(self.done.values())} events in {time.monotonic() - self.began_s:.0f} s: at most "
            f"{self.most_mb:.0f} MB; {self.errors} device errors"
        )
        return int(self.most_mb > self.args.most_mb or self.errors > 0)

    # --- the mouse and the keys ---------------------------------------------------------------

    def anywhere(self) -> tuple[float, float]:
        width, height = self.app._window.size_now()
        return self.rng.uniform(-5.0, width + 5.0), self.rng.uniform(-5.0, height + 5.0)

    def put(self, place: tuple[float, float]) -> None:
        from imgui_bundle import imgui

        self.place = place
        imgui.get_io().add_mouse_pos_event(*place)

    def button(self, which: int, down: bool) -> None:
        from imgui_bundle import imgui

        imgui.get_io().add_mouse_button_event(which, down)

    def move(self) -> None:
        self.put(self.anywhere())

    def drag(self) -> None:
        which = self.rng.choices((0, 1, 2), (8, 1, 1))[0]
        modifier = self.rng.choices((None, "ctrl", "shift", "alt"), (6, 1, 1, 1))[0]
        start, goal = self.anywhere(), self.anywhere()
        count = self.rng.randrange(2, 12)
        self.put(start)
        self.steps.append(lambda: self.modifier(modifier, True))
        self.steps.append(lambda: self.button(which, True))
        for k in range(1, count + 1):
            share = k / count
            at = tuple(a + share * (b - a) for a, b in zip(start, goal, strict=True))
            self.steps.append(lambda at=at: self.put(at))  # type: ignore[misc]
        self.steps.append(lambda: self.button(which, False))
        self.steps.append(lambda: self.modifier(modifier, False))

    def modifier(self, name: str | None, down: bool) -> None:
        from imgui_bundle import imgui

        if name is not None:
            imgui.get_io().add_key_event(getattr(imgui.Key, f"mod_{name}"), down)

    def click(self) -> None:
        which = self.rng.choices((0, 1), (8, 1))[0]
        self.put(self.anywhere())
        for _ in range(self.rng.choices((1, 2), (4, 1))[0]):
            self.steps.append(lambda: self.button(which, True))
            self.steps.append(lambda: self.button(which, False))

    def wheel(self) -> None:
        from imgui_bundle import imgui

        self.put(self.anywhere())
        for _ in range(self.rng.randrange(1, 6)):
            turn = self.rng.choice((-1.0, 1.0))
            self.steps.append(lambda turn=turn: imgui.get_io().add_mouse_wheel_event(0.0, turn))  # type: ignore[misc]

    def key(self) -> None:
        from imgui_bundle import imgui

        names = "tab left_arrow right_arrow up_arrow down_arrow enter space escape page_down home"
        key = getattr(imgui.Key, self.rng.choice(names.split()))
        self.steps += [
            lambda: imgui.get_io().add_key_event(key, True),
            lambda: imgui.get_io().add_key_event(key, False),
        ]

    def type(self) -> None:
        from imgui_bundle import imgui

        for letter in self.rng.choices(TYPED, k=self.rng.randrange(1, 5)):
            self.steps.append(
                lambda letter=letter: imgui.get_io().add_input_character(ord(letter))  # type: ignore[misc]
            )

    def leave(self) -> None:
        """Leave what hides the panels, and dialogs, so that time is not spent there alone."""
        from imgui_bundle import imgui

        self.app.model.set_part("presentation", haploscopic=False)
        self.app.layout.hidden = False
        self.steps += [
            lambda: imgui.get_io().add_key_event(imgui.Key.escape, True),
            lambda: imgui.get_io().add_key_event(imgui.Key.escape, False),
        ]

    # --- what the menu does -------------------------------------------------------------------

    def action(self) -> None:
        from relgloss_view.viewer.shell.actions import ACTIONS

        action = self.rng.choice([a for a in ACTIONS if a.text != "Quit"])
        if action.possible(self.app):
            action.run(self.app)

    def panels(self) -> None:
        for panel in self.app.layout.panels:
            panel.visible = self.rng.random() < 0.7

    def undo(self) -> None:
        step = self.rng.choice((self.app.model.history.undo, self.app.model.history.redo))
        for _ in range(self.rng.randrange(1, 6)):
            self.steps.append(lambda: self.attempt(step))

    def resize(self) -> None:
        import glfw
        from imgui_bundle import hello_imgui

        library: Any = hello_imgui
        address = library.get_glfw_window_address()
        handle = ctypes.cast(address, ctypes.POINTER(glfw._GLFWwindow))
        width, height = (self.rng.randrange(0, side + 1) for side in LARGEST_WINDOW)
        if self.rng.random() < 0.5:  # most windows are of the usual size
            width, height = max(width, 1000), max(height, 700)
        glfw.set_window_size(handle, width, height)

    # --- the state ----------------------------------------------------------------------------

    def value(self, field: Any) -> Any:
        """A value of a declared field: an option, a switch, or a number of its range."""
        rng, meta = self.rng, field.metadata
        if "options" in meta:
            return rng.choice(meta["options"])
        if "range" in meta:
            if meta.get("optional") and rng.random() < 0.5:
                return None
            low, high = meta["range"].low, meta["range"].high
            usual = field.default if isinstance(field.default, (int, float)) else low
            number = rng.choice((low, high, usual, rng.uniform(low, high)))
            if rng.random() < 0.6:  # near what is usual
                number = min(max(usual * rng.uniform(0.5, 2.0), low), high)
            return round(number) if meta.get("whole") else number
        if isinstance(field.default, bool):
            return rng.random() < 0.5
        return field.default

    def entry(self, part: Any) -> dict[str, Any]:
        field = self.rng.choice(dataclasses.fields(part))
        if field.name == "life_size":
            return {}
        return {field.name: self.value(field)}

    def look(self) -> None:
        side = self.rng.choice(("reference", "test"))
        model = self.app.model
        for _ in range(self.rng.randrange(1, 8)):
            changes = self.entry(model.state.side(side).look)
            self.steps.append(
                lambda changes=changes: self.attempt_change(  # type: ignore[misc]
                    lambda: model.set_look(side, "slider", **changes)
                )
            )

    def setup(self) -> None:
        model, part = self.app.model, self.rng.choice(("shape", "lamp", "eye", "display"))
        changes = self.entry(model.state.part(part))
        self.attempt_change(lambda: model.set_part(part, **changes))

    def presentation(self) -> None:
        model = self.app.model
        changes = self.entry(model.state.presentation)
        self.attempt_change(lambda: model.set_part("presentation", **changes))

    def attempt_change(self, change: Callable[[], object]) -> None:
        def changed() -> None:
            change()

        self.attempt(changed)

    def sample(self) -> None:
        from relgloss_view.picture.scene.sample import Sample

        side = self.rng.choice(("reference", "test"))
        self.app.model.set_sample(side, Sample.built_in(self.rng.choice(self.samples)))

    def some_material(self) -> Any:
        """A material that no file has: any number of lobes, any model."""
        from relgloss_view.material.material import DIFFUSE_MODELS, Diffuse, Lobe, Material
        from relgloss_view.measure.bands import Bands

        rng = self.rng
        bands = Bands(tuple(float(w) for w in range(400, 701, rng.choice((10, 20, 50)))))
        albedo = tuple(rng.uniform(0.02, 0.9) for _ in range(bands.count))
        lobes = tuple(
            Lobe((rng.uniform(0.05, 2.0),), rng.uniform(0.5, 25.0), rng.uniform(1.3, 1.8))
            for _ in range(rng.randrange(3))
        )
        diffuse = Diffuse(rng.choice(DIFFUSE_MODELS), albedo, rng.uniform(0.0, 30.0))
        name = f"{rng.choice(('paper', '紙', 'Größe', 'бумага', 'χαρτί'))} {rng.randrange(10**6)}"
        return Material(name, "synthetic", bands, diffuse, lobes, synthetic=True)

    def material(self) -> None:
        from relgloss_view.picture.scene.sample import Sample

        side = self.rng.choice(("reference", "test"))
        self.app.model.set_sample(side, Sample(self.some_material()))

    # --- files --------------------------------------------------------------------------------

    def file(self, suffix: str) -> Path:
        self.files += 1
        return self.folder / f"file {self.files}{suffix}"

    def open_material(self) -> None:
        from relgloss_view.material.files import save_material

        path = self.file(".json")
        save_material(self.some_material(), path)
        self.app.dropped([str(path)])

    def open_scene(self) -> None:
        from relgloss_view.viewer.files.scene_saving import save_scene

        path = self.file(".toml")
        save_scene(str(path), self.app.model.state)
        self.app.dropped([str(path)])

    def open_table(self) -> None:
        """A small table of a Gaussian lobe over a diffuse base, which is fitted."""
        import math

        path = self.file(".csv")
        s, k = math.radians(self.rng.uniform(4.0, 12.0)), self.rng.uniform(0.2, 1.0)
        lines = ["# quantity: brdf", "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,550,600"]
        for theta_in in (15.0, 30.0, 45.0, 60.0):
            for theta_out in range(-70, 71, 5):
                alpha = math.radians((theta_out - theta_in) / 2.0)
                lobe = k * math.exp(-(alpha**2) / (2.0 * s**2))
                value = 0.2 + lobe / math.cos(math.radians(theta_in))
                phi = 180.0 if theta_out >= 0 else 0.0
                lines.append(f"{theta_in},0,{abs(theta_out)},{phi},{value:.5f},{value:.5f}")
        path.write_text("\n".join(lines) + "\n", encoding="ascii")
        self.app.dropped([str(path)])

    # --- packs --------------------------------------------------------------------------------

    def write_artwork(self, path: Path) -> None:
        """A picture of any size, of one colour with a box."""
        import numpy as np
        from PIL import Image

        rng = self.rng
        width, height = rng.randrange(1, 1500), rng.randrange(1, 1500)
        pixels = np.full((height, width, 3), rng.randrange(256), np.uint8)
        pixels[height // 4 :, width // 3 :] = [rng.randrange(256) for _ in range(3)]
        Image.fromarray(pixels).save(path, dpi=(rng.choice((72, 300)),) * 2)

    def open_artwork(self) -> None:
        self.art = self.file(".png")
        self.write_artwork(self.art)
        self.app.dropped([str(self.art)])

    def open_many(self) -> None:
        """Good, empty and broken files, a folder, and one that goes before it is read."""
        empty, broken, gone = self.file(".pdf"), self.file(".png"), self.file(".png")
        empty.touch()
        broken.write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(40))
        self.write_artwork(gone)
        self.app.dropped([str(path) for path in (empty, broken, gone, self.folder)])
        gone.unlink()

    def edit_artwork(self) -> None:
        """What another program does to the last artwork: another size, half of it, or none."""
        if self.art is None:
            return
        if self.art.exists() and self.rng.random() < 0.3:
            self.art.unlink()
        elif self.art.exists() and self.rng.random() < 0.3:
            data = self.art.read_bytes()
            self.art.write_bytes(data[: len(data) // 2])
        else:
            self.write_artwork(self.art)

    def finish(self) -> None:
        """Add, remove, move, mask or tune a finish of the test's pack."""
        from relgloss_view.pack.built_in import FINISHES
        from relgloss_view.viewer.files import pack_materials
        from relgloss_view.viewer.state import packs

        model, rng = self.app.model, self.rng
        pack = model.pack("test")
        if pack is None:
            return
        one = rng.choice(pack.finishes)
        model.choose_finish("test", one.name)
        model.masked = frozenset({one.name}) if rng.random() < 0.3 else frozenset()
        way = rng.randrange(5)
        if way == 0:
            source = rng.choice(list(FINISHES))
            made = packs.new_finish(pack, pack_materials.material(source), source)
            model.set_pack("test", packs.added(pack, made))
        elif way == 1:
            model.set_pack("test", packs.removed(pack, one.name))
        elif way == 2:
            model.set_pack("test", packs.moved(pack, one.name, rng.choice((-1, 1))))
        elif way == 3:
            masks = packs.mask_choices(pack, pack_materials.parts(pack.shape))
            model.set_finish("test", one.name, mask=rng.choice(masks))
        else:
            entries = {"k": rng.uniform(0.0, 3.0), "sigma_n_deg": rng.uniform(0.0, 3.0)}
            model.set_finish("test", one.name, "slider", **entries)

    def form(self) -> None:
        from relgloss_view.pack.shape import SHAPES
        from relgloss_view.viewer.state import packs

        model, pack = self.app.model, self.app.model.pack("test")
        if pack is None:
            return
        kind = self.rng.choice([name for name in SHAPES if name != "mesh"])
        shape = pack.shape.with_kind(kind)
        model.change(packs.with_pack(model.state, "test", packs.on_form(pack, shape)))

    def artwork(self) -> None:
        """Lay the artwork elsewhere, or take it off."""
        from relgloss_view.viewer.state import packs

        model, rng, pack = self.app.model, self.rng, self.app.model.pack("test")
        if pack is None:
            return
        moved = packs.nudged(pack.placement, rng.uniform(-50, 50), rng.uniform(-50, 50), None)
        moved = packs.scaled(packs.turned(moved, rng.uniform(-180, 180)), rng.uniform(0.5, 2.0))
        model.place_artwork("test", moved, "artwork by hand")
        model.moving_artwork = rng.random() < 0.5

    def drop_nothing(self) -> None:
        self.app.dropped([str(self.folder / "no such file.csv")])

    def export(self) -> None:
        from relgloss_view.viewer.files.picture_export import (
            FORMATS,
            PICTURES,
            ExportRequest,
            suffix_of,
            write,
        )

        kind = self.rng.choice(FORMATS)
        size = None
        if self.rng.random() < 0.5:
            size = self.rng.randrange(1, LARGEST_EXPORT), self.rng.randrange(1, LARGEST_EXPORT)
        path = self.folder / f"picture{suffix_of(kind)}"
        write(self.app.model, ExportRequest(self.rng.choice(PICTURES), kind, str(path), size))

    def view(self) -> None:
        self.app.files._write_view(str(self.folder / "view.png"))

    def preset(self) -> None:
        from relgloss_view.viewer.state import presets

        side = self.rng.choice(("reference", "test"))
        preset = self.rng.choice(presets.built_in())
        self.app.model.set_setting(side, preset.look.setting)


def targets_mb(renderer: Any) -> float:
    """Of all textures of a renderer's passes, MB."""
    passes = renderer.passes
    held = [*passes.targets._textures.values(), passes.silhouette.tiles.texture]
    held += [passes.silhouette.edges.texture]
    held += [texture for textures, _ in passes.reduction._steps for texture in textures]
    return sum(texture_bytes(texture) for texture in held if texture is not None) / 1e6


def texture_bytes(texture: Any) -> int:
    size = {"f1": 1, "f2": 2}.get(texture.dtype, 4)
    return int(texture.width * texture.height * texture.components * size)


def frames_mb() -> float:
    """Of the arrays that frames have fetched and keep, MB."""
    import numpy as np

    from relgloss_view.picture.frame import Frame

    total = 0
    for thing in gc.get_objects():
        if type(thing) is Frame:
            values = list(vars(thing).values())
            values += [v for value in values if isinstance(value, tuple) for v in value]
            for value in values:
                while isinstance(value, np.ndarray) and isinstance(value.base, np.ndarray):
                    value = value.base
                total += value.nbytes if isinstance(value, np.ndarray) else 0
    return total / 1e6


def font_texture_mb() -> float:
    from imgui_bundle import imgui

    data = imgui.get_io().fonts.tex_data
    return 0.0 if data is None else data.width * data.height * data.bytes_per_pixel / 1e6


if __name__ == "__main__":
    sys.exit(main())
