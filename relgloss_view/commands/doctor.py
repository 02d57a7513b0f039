"""`relgloss doctor`: the libraries and OpenGL contexts of this machine, and their limits."""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import shutil
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from relgloss_view.base import fonts
from relgloss_view.base.errors import GLUnavailableError, RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, table
from relgloss_view.base.version import __version__

LIBRARIES = (
    "moderngl",
    "glfw",
    "numpy",
    "scipy",
    "imgui-bundle",
    "colour-science",
    "Pillow",
    "OpenEXR",
    "matplotlib",
)


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "doctor",
        description="Check the libraries, the fonts and the OpenGL contexts of this machine. A "
        "picture drawn on each context is compared with the float64 reference.",
        epilog="example: relgloss doctor --json",
    )
    parser.add_argument("--json", action="store_true", help="Print the findings as JSON")
    parser.set_defaults(run=run)


@dataclass(frozen=True)
class ContextCheck:
    """An OpenGL context that was tried: what it is and how exact its picture is, or its fault."""

    description: Mapping[str, Any] = field(default_factory=dict)  #: renderer, version, limits
    largest_error_lab: float = math.nan  #: against the float64 reference, CIELAB distance
    fault: str = ""

    @property
    def usable(self) -> bool:
        """Whether a picture could be drawn on it."""
        return not self.fault

    def as_json(self) -> dict[str, Any]:
        """The check as JSON holds it."""
        if not self.usable:
            return {"usable": False, "fault": self.fault}
        return {
            "usable": True,
            **self.description,
            "largest_error_lab": self.largest_error_lab,
        }


@dataclass(frozen=True)
class Findings:
    """The state of this machine, as far as it matters for drawing."""

    libraries: Mapping[str, str | None]  #: versions; None for a missing library
    contexts: Mapping[str, ContextCheck]  #: by backend, in the order of preference
    bytes_per_pixel: float  #: of the device's memory that every picture takes
    further_bytes: Mapping[str, float]  #: a pixel, by what else a picture may hold
    font_paths: tuple[str, ...]  #: of the fonts that names are drawn with
    missing_scripts: Mapping[str, str]  #: that none of them has, each with what mends it
    ghostscript: str | None = None  #: the program that renders artwork in PDF
    monitor: str | None = None  #: the profile that the system has for the first monitor, by name
    monitor_reason: str = ""  #: why there is none, or why it can't be used

    @property
    def chosen(self) -> str | None:
        """The backend that draws pictures; None where none can."""
        return next((name for name, check in self.contexts.items() if check.usable), None)

    def as_json(self) -> dict[str, Any]:
        """The findings as JSON holds them."""
        return {
            "relgloss": __version__,
            "python": platform.python_version(),
            "platform": platform.platform(),
            "libraries": dict(self.libraries),
            "opengl": {name: check.as_json() for name, check in self.contexts.items()},
            "chosen": self.chosen,
            "ghostscript": self.ghostscript,
            "display": {"profile": self.monitor, "reason": self.monitor_reason},
            "fonts": {"files": list(self.font_paths), "missing": list(self.missing_scripts)},
            "memory": {
                "bytes_per_pixel": self.bytes_per_pixel,
                "where_asked_for": dict(self.further_bytes),
            },
        }


def run(args: argparse.Namespace) -> int:
    """Check and report; exit status 3 where no OpenGL context is usable."""
    findings = _findings()
    if args.json:
        print(json.dumps(findings.as_json()))
    else:
        _print(findings)
    return GLUnavailableError.exit_status if findings.chosen is None else 0


def _findings() -> Findings:
    from relgloss_view.pack.artwork.ghostscript import PROGRAMS
    from relgloss_view.picture.gpu.memory import ON_DEMAND, bytes_per_pixel

    least = bytes_per_pixel()
    return Findings(
        {name: _version(name) for name in LIBRARIES},
        {name: _check(name) for name in ("egl", "osmesa")},
        least,
        {name: bytes_per_pixel((name,)) - least for name in ON_DEMAND},
        tuple(file.path for file in fonts.font_files()),
        fonts.missing_scripts(),
        next((found for name in PROGRAMS if (found := shutil.which(name))), None),
        *_monitor(),
    )


def _monitor() -> tuple[str | None, str]:
    """The name of the profile of the first monitor and where it is from, or why there is none."""
    from relgloss_view.display.icc_monitor import monitor_of_profile
    from relgloss_view.display.system.watch import MACOS, WAYLAND, WINDOWS, X11, answer_once

    system = {"win32": WINDOWS, "darwin": MACOS}.get(sys.platform, X11)
    if system == X11 and not os.environ.get("DISPLAY"):
        if not os.environ.get("WAYLAND_DISPLAY"):
            return None, "there is no display here"
        system = WAYLAND
    answer = answer_once(None, system)
    if answer.profile is None:
        return None, answer.reason
    try:
        monitor = monitor_of_profile(answer.profile.data, answer.profile.name)
    except ValueError as error:
        return None, f"{answer.profile.source}: {error}"
    return f"{monitor.name} ({answer.profile.source})", ""


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _check(name: str) -> ContextCheck:
    """Draw on a backend in a process of its own: a driver without its hardware ends the process."""
    from relgloss_view.base.child import run_module

    outcome = run_module(__name__, name)
    if outcome.crash:
        from relgloss_view.picture.gpu.probe import chosen_by_hand

        named = chosen_by_hand()
        remedy = f"; unset {', '.join(named)}" if named else ""
        return ContextCheck(fault=f"{name}: the OpenGL driver {outcome.crash}{remedy}")
    try:
        content = json.loads(outcome.out.splitlines()[-1])
        return ContextCheck(
            content["description"], content["largest_error_lab"], str(content["fault"])
        )
    except (ValueError, LookupError, TypeError):
        return ContextCheck(fault=f"{name}: no answer ({printable(outcome.err[-200:])})")


def _check_here(name: str) -> ContextCheck:
    """Draw on a backend; whatever it raises becomes its fault, so that the report is complete."""
    try:
        return _draw_on(name)
    except RelglossError as error:
        return ContextCheck(fault=str(error))
    except Exception as error:
        return ContextCheck(fault=f"{name}: {type(error).__name__}: {error}")


def _draw_on(name: str) -> ContextCheck:
    """Make a context, draw the default sample small, and compare it with the reference."""
    import numpy as np

    from relgloss_view.picture.gpu.context import describe
    from relgloss_view.picture.gpu.renderer import Renderer
    from relgloss_view.picture.reference import ReferenceRenderer
    from relgloss_view.picture.scene.look import Look
    from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, load_sample
    from relgloss_view.picture.scene.scene import Scene
    from relgloss_view.quality.backends import open_renderer

    scene, look, size = Scene(load_sample(DEFAULT_SAMPLE)), Look(sigma_n_deg=1.0), (96, 96)
    with open_renderer(name) as renderer:
        assert isinstance(renderer, Renderer)
        description = describe(renderer.ctx)
        lab = renderer.render(scene, look, size).lab.astype(np.float64)
    truth = ReferenceRenderer().render(scene, look, size).lab
    # A grain may fall into the neighbouring cell on other arithmetic; a wrong picture is far off.
    worst = float(np.max(np.linalg.norm(lab - truth, axis=-1)))
    return ContextCheck(description, worst)


def _print(findings: Findings) -> None:
    print(f"relgloss {__version__}, Python {platform.python_version()}, {platform.platform()}")
    rows = [
        (name, number or f"missing: pip install {name}")
        for name, number in findings.libraries.items()
    ]
    print(table((Column("", 15, left=True), Column("", left=True)), rows, indent="  "))
    able = ", ".join(name for name in fonts.SCRIPTS if name not in findings.missing_scripts)
    print(f"fonts: names in {able}, by {', '.join(map(printable, findings.font_paths))}")
    for remedy in dict.fromkeys(findings.missing_scripts.values()):
        lost = ", ".join(k for k, v in findings.missing_scripts.items() if v == remedy)
        print(f"fonts: no font has the letters of {lost}; {remedy}")
    for name, check in findings.contexts.items():
        if check.usable:
            about = check.description
            print(
                f"{name}: {about['renderer']}, {about['version']}, pictures up to "
                f"{about['max_texture_size']} pixels a side, largest error against float64 "
                f"{check.largest_error_lab:.2g} in CIELAB"
            )
        else:
            print(f"{name}: {printable(check.fault, 500)}")
    more = ", ".join(f"{count:g} for {name}" for name, count in findings.further_bytes.items())
    print(
        f"memory of the device: {findings.bytes_per_pixel:.1f} bytes a pixel; where asked for, "
        f"{more}"
    )
    print(
        f"artwork in PDF: {printable(findings.ghostscript)}"
        if findings.ghostscript is not None
        else "artwork in PDF: Ghostscript is not installed (Debian: apt install ghostscript); "
        "pictures are read without it"
    )
    print(
        f"profile of the monitor: {printable(findings.monitor)}"
        if findings.monitor is not None
        else f"profile of the monitor: none ({printable(findings.monitor_reason)}); "
        "docs/prepare-your-monitor.md shows how to get one"
    )
    if findings.chosen is not None:
        print(f"pictures are drawn with {findings.chosen}")
    else:
        print("no usable OpenGL; `relgloss snapshot --backend reference` still draws")


if __name__ == "__main__":  # a child of `_check`
    from relgloss_view.picture.gpu.probe import trust

    trust(sys.argv[1])
    print(json.dumps(asdict(_check_here(sys.argv[1]))), flush=True)
