"""`relgloss doctor`: the OpenGL in use, its limits, what is missing and how to get it."""

from __future__ import annotations

import argparse
import json
import platform
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from relgloss_view.base.errors import GLUnavailableError, RelglossError
from relgloss_view.base.reading import printable
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
        description="Check the libraries and the OpenGL contexts of this machine. A picture drawn "
        "on each context is compared with the float64 reference.",
        epilog="example: relgloss doctor --json",
    )
    parser.add_argument("--json", action="store_true", help="Print the findings as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Look, report; exit status 3 where no OpenGL context is usable."""
    findings: dict[str, Any] = {
        "relgloss": __version__,
        "python": platform.python_version(),
        "platform": platform.platform(),
        "libraries": {name: _version(name) for name in LIBRARIES},
        "opengl": {name: _try_backend(name) for name in ("egl", "osmesa")},
    }
    usable = [name for name, found in findings["opengl"].items() if found["usable"]]
    findings["chosen"] = usable[0] if usable else None
    findings["memory"] = _memory()
    if args.json:
        print(json.dumps(findings))
    else:
        _print(findings)
    return 0 if usable else GLUnavailableError.exit_status


def _memory() -> dict[str, Any]:
    """What a picture takes of the device's memory, for each of its pixels."""
    from relgloss_view.picture.gpu.memory import ON_DEMAND, bytes_per_pixel

    least = bytes_per_pixel()
    return {
        "bytes_per_pixel": least,
        "where_asked_for": {name: bytes_per_pixel((name,)) - least for name in ON_DEMAND},
    }


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def _try_backend(name: str) -> dict[str, Any]:
    """What a backend can do, or why it can't: whatever it raises, the report goes on."""
    try:
        return _draw_on(name)
    except RelglossError as error:
        return {"usable": False, "fault": str(error)}
    except Exception as error:
        return {"usable": False, "fault": f"{name}: {type(error).__name__}: {error}"}


def _draw_on(name: str) -> dict[str, Any]:
    """Make a context, draw the default sample small, and hold it against the reference."""
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
        found = describe(renderer.ctx)
        lab = renderer.render(scene, look, size).lab.astype(np.float64)
    truth = ReferenceRenderer().render(scene, look, size).lab
    worst = float(np.max(np.linalg.norm(lab - truth, axis=-1)))
    # A grain may fall into the neighbouring cell on other arithmetic; a wrong picture is far off.
    return {"usable": True, **found, "largest_error_lab": worst}


def _print(findings: dict[str, Any]) -> None:
    print(f"relgloss {findings['relgloss']}, Python {findings['python']}, {findings['platform']}")
    for name, number in findings["libraries"].items():
        print(f"  {name:16} {number or 'missing: pip install ' + name}")
    for name, found in findings["opengl"].items():
        if found["usable"]:
            print(
                f"{name}: {found['renderer']}, {found['version']}, pictures up to "
                f"{found['max_texture_size']} pixels a side, largest error against float64 "
                f"{found['largest_error_lab']:.2g} in CIELAB"
            )
        else:
            print(f"{name}: {printable(found['fault'], 500)}")
    memory = findings["memory"]
    more = ", ".join(f"{count:g} for {name}" for name, count in memory["where_asked_for"].items())
    least = memory["bytes_per_pixel"]
    print(f"memory of the device: {least:.1f} bytes a pixel; where asked for, {more}")
    if findings["chosen"]:
        print(f"pictures are drawn with {findings['chosen']}")
    else:
        print("no usable OpenGL; `relgloss snapshot --backend reference` still draws")
