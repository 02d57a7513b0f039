"""Starts Mitsuba's variants as programs of their own, and asks them for frames in turn."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import math
import os
import queue
import re
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.base.temporaries import scratch_file
from relgloss_view.bench.speed.scenes import ChartScene
from relgloss_view.picture.model.view import Size

#: Where systems keep LLVM's library.
LLVM_PLACES = (
    "/usr/lib/*-linux-gnu/libLLVM[-.]*",
    "/usr/lib/llvm-*/lib/libLLVM[-.]*",
    "/usr/lib64/libLLVM[-.]*",
    "/opt/homebrew/opt/llvm*/lib/libLLVM.dylib",
)
LLVM_VARIABLE = "DRJIT_LIBLLVM_PATH"
#: Aborts on some processors, so it is tried last.
LAST_RESORT = 15
LONGEST_WORDS = 60  #: characters of what a dead program said last
START_SECONDS, FRAME_SECONDS = 90.0, 60.0


class MitsubaPeer:
    """One variant, as a timed task. Raises RelglossError where it does not start or dies."""

    def __init__(
        self, variant: str, chart_scene: ChartScene, size: Size, llvm: str | None = None
    ) -> None:
        self.name = f"mitsuba {variant}"
        environment = dict(os.environ)
        if llvm is not None:
            environment[LLVM_VARIABLE] = llvm
        self._stack = contextlib.ExitStack()
        self._complaints = self._stack.enter_context(scratch_file())
        self._process = subprocess.Popen(
            program(variant),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._complaints,
            text=True,
            env=environment,
        )
        self._answers: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()
        try:
            self.facts = self._ask(json.dumps(scene_for_mitsuba(chart_scene, size)), START_SECONDS)
        except BaseException:
            self.release()
            raise

    def warm(self) -> None:
        """Draw once, for what the others have pushed out of the caches."""
        self.frame(-1)

    def frame(self, turn: int) -> float:
        """Draw; its own milliseconds."""
        return float(self._ask("draw", FRAME_SECONDS)["ms"])

    def release(self) -> None:
        """End the program."""
        self._process.kill()
        self._process.wait()
        self._stack.close()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                try:
                    pipe.close()
                except OSError:  # it holds what the dead program did not read
                    continue

    def _last_words(self) -> str:
        self._complaints.seek(0)
        said = self._complaints.read().decode("utf-8", "replace").strip().splitlines()
        return f" ({printable(said[-1].strip(), LONGEST_WORDS)})" if said else ""

    def _listen(self) -> None:
        assert self._process.stdout is not None
        try:
            for line in self._process.stdout:
                if line.startswith("{"):  # its libraries may talk too
                    self._answers.put(line)
        except ValueError:  # closed
            pass
        self._answers.put("")

    def _ask(self, line: str, seconds: float) -> dict[str, Any]:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(line + "\n")
            self._process.stdin.flush()
            answer = self._answers.get(timeout=seconds)
        except queue.Empty:
            raise RelglossError(f"no answer within {seconds:g} s") from None
        except OSError:
            answer = ""
        if not answer:
            raise RelglossError(f"it ended with status {self._process.wait()}{self._last_words()}")
        return dict(json.loads(answer))


def program(variant: str) -> list[str]:
    """The command that serves a variant's frames."""
    return [sys.executable, "-m", "relgloss_view.bench.peers.mitsuba_peer", variant]


def open_peer(variant: str, chart_scene: ChartScene, size: Size) -> MitsubaPeer:
    """A variant that draws; RelglossError says why there is none."""
    if importlib.util.find_spec("mitsuba") is None:
        raise RelglossError("mitsuba is not installed")
    if not variant.startswith("llvm"):
        return MitsubaPeer(variant, chart_scene, size)
    faults = []
    for library in llvm_libraries():
        try:
            return MitsubaPeer(variant, chart_scene, size, library)
        except RelglossError as error:
            faults.append(f"{Path(library).name}: {error}")
    raise RelglossError("; ".join(faults) or f"no LLVM library found; {LLVM_VARIABLE} names one")


def llvm_libraries() -> list[str]:
    """LLVM libraries, the newest first; the one that the environment names alone, if it does."""
    named = os.environ.get(LLVM_VARIABLE)
    if named:
        return [named]
    by_version: dict[int, str] = {}
    for place in LLVM_PLACES:
        root, pattern = place.split("/", 2)[1], place.split("/", 2)[2]
        for path in sorted(Path(f"/{root}").glob(pattern)):
            match = re.search(r"(?:LLVM[-.]|llvm-)(?:so\.)?(\d+)", str(path))
            if match is not None:
                by_version.setdefault(int(match[1]), str(path))
    order = sorted(by_version, key=lambda version: (version == LAST_RESORT, -version))
    return [by_version[version] for version in order]


def scene_for_mitsuba(chart_scene: ChartScene, size: Size) -> dict[str, Any]:
    """The numbers of a scene that Mitsuba's program takes."""
    scene = chart_scene.scene
    lobe = max(scene.material.specular, key=lambda lobe: max(lobe.strength))
    bands = scene.material.bands.centres_nm()
    return {
        "size": size,
        "eye_m": [float(v) for v in scene.eye.position_m],
        "lamp_m": [float(v) for v in scene.lamp.position_m],
        "field_of_view_deg": scene.eye.field_of_view_deg,
        "diameter_m": scene.shape.diameter_m,
        "height_m": scene.shape.height_m,
        "alpha": math.sqrt(2.0) * lobe.s,
        "refractive_index": lobe.refractive_index,
        "albedo": [
            [float(nm), value]
            for nm, value in zip(bands, scene.material.diffuse.albedo, strict=True)
        ],
    }
