"""The only reader of shaders/: includes, constants, and errors with file and line."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.resources import data_root
from relgloss_view.picture.gpu.constants import definitions

#: A number of the whole picture; longer arrays than two stay with the fragments.
_UNIFORM = re.compile(r"^uniform\s+((?:float|int|uint|[iu]?vec[234]|mat3))\s+(\w+)(\[[12]\])?\s*;")
VERTEX = "fill.vert"
#: The vertex stages of what covers less than the picture.
OWN_VERTEX = {"coverage.frag": "tiles.vert", "edge.frag": "edge.vert", "mesh.frag": "mesh.vert"}
OWN_VERTEX["mesh_places.frag"] = "mesh_places.vert"
HANDED_ON = "all_"  #: before the name of a number that the vertex stage hands on
_INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"\s*$')
#: Mesa writes 0:12(3): error; NVIDIA 0(12) : error; others ERROR: 0:12:
_PLACE = re.compile(r"\b(\d+)(?::|\()(\d+)\)?")


class ShaderError(RelglossError):
    """A shader that can't be composed or compiled; the message names file and line."""


class ShaderSource:
    """One stage with its includes resolved: the file `name`, or `source` under that name.

    `text` goes to the compiler; `explain` turns the compiler's log into file names and lines.

    A fragment's uniforms come to it as flat inputs, and `vertex` is the stage that hands them on:
    a software driver reads a uniform again in each pixel by some 25 instructions, an input by one.
    """

    def __init__(
        self, name: str, defines: Mapping[str, int | str] | None = None, source: str | None = None
    ) -> None:
        self.name = name
        self._defines = defines
        self.files: list[str] = []
        body = self._resolve(name, trail=(), source=source)
        head, _, rest = body.partition("\n")
        if not head.startswith("#version"):
            raise ShaderError(f"{name}: line 1: a stage begins with #version")
        lines = [f"#define {key} {value}" for key, value in sorted((defines or {}).items())]
        lines = [*definitions(), *lines]
        self._handed_on: list[tuple[str, str, str]] = []  #: type, name, array
        rest = "\n".join(self._handed(line) for line in rest.split("\n"))
        self.text = "\n".join([head, *lines, "#line 2 0", rest]) + "\n"

    @property
    def vertex(self) -> str:
        """The vertex stage that goes with this fragment stage."""
        declared = [
            f"uniform {kind} {HANDED_ON}{name}{array}; flat out {kind} {name}{array};"
            for kind, name, array in self._handed_on
        ]
        assigned = [f"{name} = {HANDED_ON}{name};" for _, name, _ in self._handed_on]
        own = OWN_VERTEX.get(self.name)
        text = _read(VERTEX, ()) if own is None else ShaderSource(own, self._defines).text
        text = text.replace("//@declare", "\n".join(declared))
        return text.replace("//@hand-on", "\n".join(assigned))

    def _handed(self, line: str) -> str:
        match = _UNIFORM.match(line)
        if match is None or not self.name.endswith(".frag"):
            return line
        kind, name, array = match[1], match[2], match[3] or ""
        self._handed_on.append((kind, name, array))
        return f"flat in {kind} {name}{array};{line[match.end() :]}"

    def _resolve(self, name: str, trail: tuple[str, ...], source: str | None = None) -> str:
        if name in trail:
            raise ShaderError(f"{name}: includes itself by way of {' > '.join(trail)}")
        if source is None:
            source = _read(name, trail)
        index = len(self.files)
        self.files.append(name)
        lines: list[str] = []
        for number, line in enumerate(source.splitlines(), 1):
            match = _INCLUDE.match(line)
            if match is None:
                lines.append(line)
            elif match[1] in self.files and match[1] not in trail:
                lines.append("")
            else:
                lines.append(f"#line 1 {len(self.files)}")
                lines.append(self._resolve(match[1], (*trail, name)))
                lines.append(f"#line {number + 1} {index}")
        return "\n".join(lines)

    def explain(self, log: str) -> str:
        """The compiler's log with file names in the place of source numbers."""

        def place(match: re.Match[str]) -> str:
            index = int(match[1])
            file = self.files[index] if index < len(self.files) else self.name
            return f"{file}:{match[2]}"

        lines = [
            line.strip() for line in log.splitlines() if re.search("error|warning", line, re.I)
        ]
        return "; ".join(_PLACE.sub(place, line, count=1) for line in lines) or log.strip()


def _read(name: str, trail: tuple[str, ...]) -> str:
    try:
        return (shader_folder() / name).read_text(encoding="utf-8")
    except OSError as error:
        wanted_by = f" (included by {trail[-1]})" if trail else ""
        raise ShaderError(f"{name}{wanted_by}: no such shader file") from error


def stage_text(name: str) -> str:
    """A shader file as it is written, for those who write something into it."""
    return _read(name, ())


def shader_folder() -> Path:
    """The folder that holds the shader files."""
    return data_root() / "shaders"
