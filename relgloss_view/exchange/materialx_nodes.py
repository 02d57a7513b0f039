"""What a node graph of MaterialX comes to, where it is the same at each point of the surface.

Followed are names, constants, arithmetic, channels and conditions of MaterialX's standard library
(1.39, stdlib). Of a picture the mean is taken, and arithmetic goes on with the mean, which is exact
for sums and products with constants. Whatever else varies over the surface is named and not read.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.beside import path_beside
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_bytes
from relgloss_view.exchange.materialx_colour import SPACES, Space
from relgloss_view.exchange.materialx_operations import OPERATIONS, WIDTHS, by_type
from relgloss_view.exchange.picture_mean import picture_mean

MOST_HOPS = 64  #: from name to name; longer ways are loops
MOST_STEPS = 5000  #: of an input: nodes may share nodes, and so multiply
MOST_PICTURE_BYTES = 100 * 1024 * 1024  #: of all pictures together
LARGEST = 1e6  #: of any number that is read
MOST_NUMBERS = 4  #: of any type that a surface takes
PICTURES = ("image", "tiledimage", "gltf_image", "gltf_colorimage", "UsdUVTexture")
SEPARATED = ("separate2", "separate3", "separate4")
_CHANNELS = {name: k for names in ("rgba", "xyzw") for k, name in enumerate(names)}
#: Inputs by which picture nodes multiply, and what they add then. glTF's `scale` is of places.
_FACTORS = {
    "gltf_image": ("factor",),
    "gltf_colorimage": ("color", "geomcolor"),
    "UsdUVTexture": ("scale",),
}
_ADDENDS = {"UsdUVTexture": ("bias",)}
CIRCLE = "names that lead in a circle"


class NotKnownError(Exception):
    """Why an input has no value that holds everywhere, in words that follow 'comes from'."""


class Reached(NamedTuple):
    """What an input comes to."""

    numbers: Array  #: (N,), colours as linear sRGB
    pictures: tuple[str, ...] = ()  #: whose means are in it


@dataclass
class Nodes:
    """The nodes of a document; folder: of its pictures, None where none may be opened."""

    root: Element
    folder: Path | None = None
    #: Names of colour spaces that are not known here, which count as linear sRGB
    spaces: set[str] = field(default_factory=set)
    _parents: dict[int, Element] = field(default_factory=dict)
    _names: dict[int, dict[str, Element]] = field(default_factory=dict)
    _inputs: dict[int, dict[str, Element]] = field(default_factory=dict)
    _means: dict[tuple[str, Space | None], Array | InputError] = field(default_factory=dict)
    _used: int = 0
    _steps: int = 0

    def __post_init__(self) -> None:
        for parent in self.root.iter():
            self._parents |= {id(child): parent for child in parent}

    def of(self, element: Element) -> Reached:
        """What an input or an output comes to. Raises NotKnownError."""
        self._steps = 0
        return self._of(element, 0)

    def _of(self, element: Element, hops: int) -> Reached:
        self._steps += 1
        if hops > MOST_HOPS:
            raise NotKnownError(CIRCLE)
        if self._steps > MOST_STEPS:
            raise NotKnownError(f"more than {MOST_STEPS} nodes")
        if not connected(element):
            return Reached(self._literal(element))
        target, output = self._target(element)
        if target is None:
            raise NotKnownError("a node that is not in the file")
        if target.tag in ("input", "output"):
            return self._of(target, hops + 1)
        return self._node(target, output, hops + 1)

    def _target(self, element: Element) -> tuple[Element | None, str | None]:
        graph, node, face, output = (
            element.get(key) or None for key in ("nodegraph", "nodename", "interfacename", "output")
        )
        if graph is not None:
            inside = self._by_name(self.root).get(graph)
            return (None if inside is None else _output(inside, output)), None
        scope = self._scope(element)
        name = node or face or output
        for part in (scope, self.root):
            found = self._by_name(part).get(name or "")
            if found is not None and found is not element:
                return found, output
        return None, None

    def _scope(self, element: Element) -> Element:
        """The graph in which an element's names are looked up: around its node, or the document."""
        holder = self._parents.get(id(element), self.root)
        if holder.tag == "nodegraph":
            # An input of a graph is connected outside of it, an output inside.
            return holder if element.tag == "output" else self._parents.get(id(holder), self.root)
        return self._parents.get(id(holder), self.root)

    def _by_name(self, parent: Element) -> dict[str, Element]:
        if id(parent) not in self._names:
            self._names[id(parent)] = {e.get("name", ""): e for e in parent}
        return self._names[id(parent)]

    def _stated(self, node: Element, name: str) -> Element | None:
        """As input_of: a node that many steps lead to is looked through once."""
        if id(node) not in self._inputs:
            inputs = (e for e in reversed(node) if e.tag == "input")
            self._inputs[id(node)] = {e.get("name", ""): e for e in inputs}
        return self._inputs[id(node)].get(name)

    def _literal(self, element: Element) -> Array:
        numbers = numbers_of(element.get("value", ""))
        if numbers is None:
            raise NotKnownError(f"{printable(element.get('value'), 40)!r}, which is no number")
        values = np.array(numbers)
        if element.get("type") in ("color3", "color4") and len(values) >= 3:
            values[:3] = self.space(element).linear_srgb(values[:3])
        return values

    def space(self, element: Element) -> Space:
        """The colour space that an element states, or else what is around it."""
        name = self._inherited(element, "colorspace").lower()
        if name not in SPACES:
            self.spaces.add(name)
        return SPACES.get(name, SPACES[""])

    def _inherited(self, element: Element | None, key: str) -> str:
        while element is not None:
            value = element.get(key)
            if value is not None:
                return value
            element = self._parents.get(id(element))
        return ""

    def _node(self, node: Element, output: str | None, hops: int) -> Reached:
        if node.tag in PICTURES:
            return self._picture(node, output, hops)
        if node.tag in SEPARATED:
            return _part(self._input(node, "in", 0.0, hops), (output or "").removeprefix("out"))
        operation = OPERATIONS.get(node.tag)
        if operation is None:
            raise NotKnownError(f"a node {printable(node.tag, 40)!r}")
        given = [self._input(node, name, value, hops) for name, value in operation.inputs]
        pictures = _joined(*given)
        if operation.is_condition and pictures:
            raise NotKnownError(f"a node {node.tag!r} of a picture")
        text = {name: (self._stated(node, name), default) for name, default in operation.texts}
        words = [default if e is None else e.get("value", default) for e, default in text.values()]
        try:
            with np.errstate(all="ignore"):
                made = operation.make(*(one.numbers for one in given), *words)
        except (ValueError, IndexError, KeyError):
            raise NotKnownError(f"a node {node.tag!r} that does not fit its inputs") from None
        values = by_type(np.atleast_1d(made), node.get("type"))
        if not 1 <= len(values) <= MOST_NUMBERS:
            raise NotKnownError(f"a node {node.tag!r} that does not fit its inputs")
        if not np.all(np.isfinite(values)) or np.max(np.abs(values)) > LARGEST:
            raise NotKnownError(f"a node {node.tag!r} without a result")
        return Reached(values, pictures)

    def _input(self, node: Element, name: str, default: float | None, hops: int) -> Reached:
        element = self._stated(node, name)
        if element is not None:
            return self._of(element, hops)
        if default is None:
            raise NotKnownError(f"a node {printable(node.tag, 40)!r} without a value")
        return Reached(np.array([default]))

    def _picture(self, node: Element, output: str | None, hops: int) -> Reached:
        file = self._stated(node, "file")
        while file is not None and connected(file) and hops < MOST_HOPS:
            file, hops = self._target(file)[0], hops + 1
        name = "" if file is None else file.get("value", "")
        what = f"a node {node.tag!r}"
        if not name or file is None:
            raise NotKnownError(f"{what} without a picture")
        kind = node.get("type", "")
        is_colour = kind.startswith("color") or (kind == "multioutput" and output == "outcolor")
        shown = printable(name, 60)
        try:
            mean = self._mean(name, file, is_colour or output in ("rgb", "rgba"))
        except InputError:
            raise NotKnownError(
                f"{what}, whose picture {shown} is not beside the file as PNG, JPEG or WebP"
            ) from None
        for factor in _FACTORS.get(node.tag, ()):
            mean = mean * self._four(node, factor, 1.0, hops)
        for addend in _ADDENDS.get(node.tag, ()):
            mean = mean + self._four(node, addend, 0.0, hops)
        if output in _CHANNELS:
            return Reached(mean[[_CHANNELS[output]]], (shown,))
        count = 1 if output == "outa" else WIDTHS.get(kind, 3)
        return Reached(mean[3:] if output == "outa" else mean[:count], (shown,))

    def _four(self, node: Element, name: str, default: float, hops: int) -> Array:
        """(4,), by which a node changes its picture; a colour of three leaves alpha alone."""
        element = self._stated(node, name)
        if element is None:
            return np.full(4, default)
        numbers = self._of(element, hops + 1).numbers
        if len(numbers) == 3:
            return np.append(numbers, default)
        if len(numbers) not in (1, 4):
            raise NotKnownError(f"a node {node.tag!r} that does not fit its inputs")
        return np.resize(numbers, 4)

    def _mean(self, name: str, file: Element, is_colour: bool) -> Array:
        if self.folder is None:
            raise InputError("no folder")
        space = self.space(file) if is_colour else None
        name = (self._inherited(file, "fileprefix") + name).replace("\\", "/")
        if (name, space) not in self._means:
            try:
                self._means[name, space] = self._opened(name, self.folder, space)
            except InputError as error:  # which is not tried at each step that leads here
                self._means[name, space] = error
        mean = self._means[name, space]
        if isinstance(mean, InputError):
            raise mean
        return mean

    def _opened(self, name: str, folder: Path, space: Space | None) -> Array:
        left = max(MOST_PICTURE_BYTES - self._used, 0)
        data = read_bytes(path_beside(name, folder), left, "a picture")
        self._used += len(data)
        mean = picture_mean(data, None if space is None else space.curve)
        if space is not None:
            mean[:3] = space.from_primaries(mean[:3])
        return mean


def connected(element: Element) -> bool:
    """Whether an input takes its value from elsewhere, which counts before its own."""
    return any(element.get(key) for key in ("nodegraph", "nodename", "interfacename")) or bool(
        element.get("output")
    )


def input_of(node: Element, name: str) -> Element | None:
    """The input of a name that a node states; None without one."""
    return next((e for e in node if e.tag == "input" and e.get("name") == name), None)


def numbers_of(text: str) -> tuple[float, ...] | None:
    """Numbers of a text that commas part; None where it is none, or one is beyond every use.

    >>> numbers_of("0.5, 1"), numbers_of("true"), numbers_of("nan")
    ((0.5, 1.0), (1.0,), None)
    """
    words = text.split(",")
    if len(words) > 4:
        return None
    if text.strip() in ("true", "false"):
        return (float(text.strip() == "true"),)
    try:
        numbers = tuple(float(word) for word in words)
    except ValueError:
        return None
    return numbers if all(math.isfinite(v) and abs(v) <= LARGEST for v in numbers) else None


def _output(graph: Element, name: str | None) -> Element | None:
    outputs = [e for e in graph if e.tag == "output"]
    if name is None:
        return outputs[0] if len(outputs) == 1 else None
    return next((e for e in outputs if e.get("name") == name), None)


def _part(whole: Reached, channel: str) -> Reached:
    number = _CHANNELS.get(channel)
    if number is None or number >= len(whole.numbers):
        raise NotKnownError(f"a channel {printable(channel, 10)!r} that is not there")
    return Reached(whole.numbers[[number]], whole.pictures)


def _joined(*parts: Reached) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for part in parts for name in part.pictures))
