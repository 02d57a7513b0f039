"""What a run was made on: processor, driver, versions."""

from __future__ import annotations

import datetime
import platform
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import moderngl

from relgloss_view.base.room import processors
from relgloss_view.base.version import __version__
from relgloss_view.picture.gpu.context import describe

LIBRARIES = ("moderngl", "numpy", "mitsuba", "drjit", "colour-science")


def machine(ctx: moderngl.Context) -> dict[str, Any]:
    """Everything that a time depends on, and nothing that tells whose machine it is."""
    return {
        "date": datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds"),
        "relgloss": __version__,
        "cpu": cpu_model(),
        "cores": processors(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "libraries": {name: _version(name) for name in LIBRARIES},
        "opengl": describe(ctx),
    }


def cpu_model() -> str:
    """The processor's name, where the system tells it."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    known = dict(_entry(line) for line in lines if ":" in line)
    name = known.get("model name") or platform.processor() or "unknown"
    if "model" in known and "cpu family" in known:
        name += f" (family {known['cpu family']}, model {known['model']})"
    return name


def _entry(line: str) -> tuple[str, str]:
    name, _, value = line.partition(":")
    return name.strip(), value.strip()


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
