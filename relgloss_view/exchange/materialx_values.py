"""Values of a MaterialX shader's inputs: constants, and what constant nodes behind names hold."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.xml import line_of
from relgloss_view.material.cielab import srgb_decoded
from relgloss_view.material.spectra import D65_XY, SRGB_PRIMARIES_XY, rgb_to_xyz_matrix

MOST_HOPS = 32  #: from name to name; longer ways are loops
CONSTANTS = ("constant", "dot", "convert")  #: nodes that hand on a value
LARGEST = 1e6  #: of any number that is read
#: Linear colour spaces of MaterialX 1.39 by name; ACEScg has a white of its own, which counts as
#: D65 here.
_ACESCG = ((0.713, 0.293), (0.165, 0.830), (0.128, 0.044))
_PRIMARIES = {"acescg": _ACESCG, "lin_ap1": _ACESCG}
PLAIN = ("", "none", "lin_rec709", "lin_srgb", "lin_rec709_scene")
ENCODED = ("srgb_texture", "srgb_rec709_scene", "srgb_rec709_display")


@dataclass
class Values:
    """The inputs of one shader node.

    unread: by the name of an input, what it comes from that is not carried over.
    """

    shader: Element
    scopes: tuple[dict[str, Element], ...]  #: nodes by name: of the shader's graph, of the document
    place: str
    colour_space: str
    unread: dict[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, root: Element, shader: Element, place: str) -> Values:
        """The inputs of a shader of a document."""
        parent = next((e for e in root if any(child is shader for child in e)), None)
        scopes = [_by_name(e) for e in (parent, root) if e is not None]
        space = shader.get("colorspace") or root.get("colorspace") or ""
        return cls(shader, tuple(scopes), place, space)

    def stated(self) -> dict[str, Any]:
        """The literal values of the node's inputs, as a digest of them needs."""
        values: dict[str, Any] = {}
        for element in self.shader:
            text = element.get("value")
            if element.tag == "input" and text is not None:
                numbers = _numbers(text)
                single = numbers is not None and len(numbers) == 1
                values[element.get("name", "")] = (
                    text if numbers is None else numbers[0] if single else numbers
                )
        return values

    def has(self, name: str) -> bool:
        """Whether the document states an input in any way."""
        return input_of(self.shader, name) is not None

    def number(self, name: str, default: float, low: float, high: float) -> float:
        """An input of one number within a range; InputError outside."""
        return self.numbers(name, (default,), 1, low, high)[0]

    def colour(
        self, name: str, default: tuple[float, float, float], high: float = 1.0
    ) -> tuple[float, float, float]:
        """An input of a colour as linear sRGB, each from 0 to `high`."""
        red, green, blue = self.numbers(name, default, 3, 0.0, high)
        return red, green, blue

    def numbers(
        self, name: str, default: tuple[float, ...], count: int, low: float, high: float
    ) -> tuple[float, ...]:
        """An input of `count` numbers, each within a range, as linear sRGB where there are three.

        What comes from elsewhere is noted in `unread`, and the default holds. Raises InputError
        outside of the range.
        """
        element = input_of(self.shader, name)
        if element is None:
            return default
        where = f"{self.place}: line {line_of(element)}: {name}"
        holder = self._followed(element)
        if isinstance(holder, str):
            self.unread[name] = holder
            return default
        numbers = _numbers(holder.get("value", ""))
        if numbers is None or len(numbers) not in (1, count):
            raise InputError(
                f"{where}: expected {'a number' if count == 1 else f'{count} numbers'}, found "
                f"{printable(holder.get('value'), 60)!r}"
            )
        numbers = numbers * (count // len(numbers))
        if count == 3:
            numbers = self._linear(name, holder, numbers)
        if not all(low <= v <= high for v in numbers):
            raise InputError(
                f"{where}: expected {low:g} to {high:g}, found {printable(holder.get('value'), 60)}"
            )
        return numbers

    def _linear(self, name: str, holder: Element, numbers: tuple[float, ...]) -> tuple[float, ...]:
        """A colour of the document as linear sRGB; what falls outside of it is cut at 0."""
        space = (holder.get("colorspace") or self.colour_space).lower()
        if space in PLAIN:
            return numbers
        if space in ENCODED:
            return tuple(float(v) for v in srgb_decoded(numbers))
        if space in _PRIMARIES:
            there = rgb_to_xyz_matrix(_PRIMARIES[space], D65_XY)
            back = rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)
            linear: Array = np.linalg.solve(back, there @ np.array(numbers))
            return tuple(float(v) for v in np.maximum(linear, 0.0))
        self.unread[f"colour space of {name}"] = f"{printable(space, 40)}, read as linear sRGB"
        return numbers

    def _followed(self, element: Element) -> Element | str:
        """The element that holds an input's value; or in words, what it comes from."""
        scopes = self.scopes
        for _ in range(MOST_HOPS):
            if element.get("value") is not None:
                return element
            graph, node, face = (
                element.get(key) for key in ("nodegraph", "nodename", "interfacename")
            )
            target: Element | None = None
            if graph is not None:
                target = self.scopes[-1].get(graph)
                if target is not None:
                    scopes = (_by_name(target), self.scopes[-1])
                    target = _output(target, element.get("output"))
            elif node is not None:
                target = next((scope[node] for scope in scopes if node in scope), None)
            elif face is not None:
                target = next((scope[face] for scope in scopes if face in scope), None)
            if target is None:
                return "a node that is not in the file"
            if target.tag in ("input", "output"):
                element = target
                continue
            if target.tag not in CONSTANTS:
                return f"a node {printable(target.tag, 40)!r}"
            inside = input_of(target, "value")
            inside = input_of(target, "in") if inside is None else inside
            if inside is None:
                return f"a node {printable(target.tag, 40)!r} without a value"
            element = inside
        return "names that lead in a circle"


def _by_name(parent: Element) -> dict[str, Element]:
    return {e.get("name", ""): e for e in parent}


def _output(graph: Element, name: str | None) -> Element | None:
    outputs = [e for e in graph if e.tag == "output"]
    if name is None:
        return outputs[0] if len(outputs) == 1 else None
    return next((e for e in outputs if e.get("name") == name), None)


def input_of(node: Element, name: str) -> Element | None:
    """The input of a name that a node states; None without one."""
    return next((e for e in node if e.tag == "input" and e.get("name") == name), None)


def _numbers(text: str) -> tuple[float, ...] | None:
    """Numbers of a text that commas part; None where it is none, or one is beyond every use."""
    words = text.split(",")
    if len(words) > 4:
        return None
    try:
        numbers = tuple(float(word) for word in words)
    except ValueError:
        return None
    return numbers if all(math.isfinite(v) and abs(v) <= LARGEST for v in numbers) else None
