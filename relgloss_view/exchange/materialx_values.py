"""Values of a MaterialX shader's inputs: constants, and what their node graphs come to."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.xml import line_of
from relgloss_view.exchange.materialx_nodes import (
    Nodes,
    NotKnownError,
    connected,
    input_of,
    numbers_of,
)

#: Of the ends of a range, which colours of wider spaces and means of pictures may pass by rounding.
TOLERANCE = 1e-6
COLOUR_BEYOND = 1.0  #: how far a colour may lie outside of its range, to which it is then cut
LINKS = ("nodegraph", "nodename", "interfacename", "output")


@dataclass
class Values:
    """The inputs of one shader node.

    unread: by the name of an input, what it comes from that is not carried over; its default
    counts. means: by the name of an input, the pictures whose means are in it. cut: the names of
    inputs that lay outside of their range by calculation or by their colour space. asked: names of
    the inputs that were looked for.
    """

    shader: Element
    nodes: Nodes
    place: str
    unread: dict[str, str] = field(default_factory=dict)
    means: dict[str, tuple[str, ...]] = field(default_factory=dict)
    cut: dict[str, str] = field(default_factory=dict)
    asked: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, root: Element, shader: Element, place: str, folder: Path | None = None) -> Values:
        """The inputs of a shader of a document, whose pictures lie in `folder` and below."""
        return cls(shader, Nodes(root, folder), place)

    def stated(self) -> dict[str, Any]:
        """The literal values of the node's inputs and its links, as a digest of them needs."""
        values: dict[str, Any] = {}
        for element in self.shader:
            text = element.get("value")
            if element.tag != "input":
                continue
            name = element.get("name", "")
            if connected(element):
                values[name] = " ".join(element.get(key) or "" for key in LINKS)
            elif text is not None:
                numbers = numbers_of(text)
                single = numbers is not None and len(numbers) == 1
                values[name] = text if numbers is None else numbers[0] if single else numbers
        return values

    def has(self, name: str) -> bool:
        """Whether the document states an input in any way."""
        self.asked.add(name)
        return input_of(self.shader, name) is not None

    def not_asked(self) -> tuple[str, ...]:
        """The inputs of the node that nothing has looked for."""
        names = (e.get("name", "") for e in self.shader if e.tag == "input")
        return tuple(dict.fromkeys(name for name in names if name not in self.asked))

    def number(self, name: str, default: float, low: float, high: float) -> float:
        """An input of one number within a range; InputError outside."""
        return self.numbers(name, (default,), low, high)[0]

    def colour(
        self, name: str, default: tuple[float, float, float], high: float = 1.0
    ) -> tuple[float, float, float]:
        """An input of a colour as linear sRGB, each from 0 to `high`."""
        red, green, blue = self.numbers(name, default, 0.0, high)
        return red, green, blue

    def numbers(
        self, name: str, default: tuple[float, ...], low: float, high: float
    ) -> tuple[float, ...]:
        """An input of as many numbers as `default`, each within a range; colours as linear sRGB.

        What has no value of its own is noted in `unread`, and the default holds. What is
        calculated, and a colour outside of sRGB, is cut to the range and noted in `cut`. Raises
        InputError where a stated number lies outside of the range, or a colour far outside.
        """
        self.asked.add(name)
        element = input_of(self.shader, name)
        if element is None or (not connected(element) and element.get("value") is None):
            return default
        is_stated = not connected(element)
        if is_stated:
            self._check(name, element, len(default), low, high)
        try:
            reached = self.nodes.of(element)
        except NotKnownError as reason:
            self.unread[name] = str(reason)
            return default
        values = reached.numbers
        if len(values) not in (1, len(default)):
            self.unread[name] = f"{len(values)} numbers in place of {len(default)}"
            return default
        if reached.pictures:
            self.means[name] = reached.pictures
        values = np.broadcast_to(values, (len(default),))
        inside: Array = np.clip(values, low, high)
        if np.max(np.abs(inside - values)) > TOLERANCE:
            shown = ", ".join(f"{v:.3g}" for v in values)
            self.cut[name] = f"{shown}, cut to {low:g} to {high:g}"
        return tuple(float(v) for v in inside)

    def _check(self, name: str, element: Element, count: int, low: float, high: float) -> None:
        """Refuse a stated value that is no number, or lies outside of its range as it stands."""
        where = f"{self.place}: line {line_of(element)}: {name}"
        text = element.get("value", "")
        numbers = numbers_of(text)
        if numbers is None or len(numbers) not in (1, count):
            raise InputError(
                f"{where}: expected {'a number' if count == 1 else f'{count} numbers'}, found "
                f"{printable(text, 60)!r}"
            )
        # Colours of metals lie outside of sRGB in others' libraries: gold has a red of 1.06.
        beyond = COLOUR_BEYOND if count == 3 else 0.0
        if not all(low - beyond <= v <= high + beyond for v in numbers):
            raise InputError(f"{where}: expected {low:g} to {high:g}, found {printable(text, 60)}")
