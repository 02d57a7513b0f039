"""Nodes of MaterialX's standard library that calculate, in numpy, with the defaults of 1.39."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array

#: Numbers of a type.
WIDTHS = {
    **dict.fromkeys(("float", "integer", "boolean"), 1),
    "vector2": 2,
    **dict.fromkeys(("color3", "vector3"), 3),
    **dict.fromkeys(("color4", "vector4"), 4),
}
_ACES_WEIGHTS = np.array([0.2722287, 0.6740818, 0.0536895])  #: stdlib's default of lumacoeffs


class Operation(NamedTuple):
    """A node: its inputs with their defaults (None: it must be stated), and what it makes of them.

    texts: inputs that are words, which `make` takes last. is_condition: of its inputs, which pick
    one of others, no mean is of use.
    """

    inputs: tuple[tuple[str, float | None], ...]
    make: Callable[..., Any]
    texts: tuple[tuple[str, str], ...] = ()
    is_condition: bool = False


def by_type(values: Array, kind: str | None) -> Array:
    """Values as a type holds them: a number becomes gray, a colour of four loses its alpha.

    >>> by_type(np.array([0.5]), "color4").tolist()
    [0.5, 0.5, 0.5, 1.0]
    """
    count = WIDTHS.get(kind or "", len(values))
    if len(values) == 1 and count > 1:
        gray = np.repeat(values, count)
        if kind == "color4":
            gray[3] = 1.0
        return gray
    if len(values) == 3 and count == 4:
        return np.append(values, 1.0)
    return values[:count]


def _remapped(x: Array, a: Array, b: Array, low: Array, high: Array) -> Array:
    return np.asarray(low + (x - a) * (high - low) / (b - a))


def _ranged(
    x: Array, a: Array, b: Array, gamma: Array, low: Array, high: Array, clamps: Array
) -> Array:
    share = (x - a) / (b - a)
    bent = np.sign(share) * np.abs(share) ** (1.0 / gamma)
    made = low + bent * (high - low)
    return np.clip(made, low, high) if clamps[0] > 0.5 else np.asarray(made)


def _smoothstep(x: Array, low: Array, high: Array) -> Array:
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def _luminance(x: Array) -> Array:
    light = np.repeat(x[:3] @ _ACES_WEIGHTS, 3)
    return np.append(light, x[3:])


def _saturated(x: Array, amount: Array) -> Array:
    gray = _luminance(x)
    return np.asarray(gray + amount * (x - gray))


def _swizzled(x: Array, channels: str) -> Array:
    if len(channels) > 4:
        raise ValueError("no type has more than four numbers")
    places = {"r": 0, "g": 1, "b": 2, "a": 3, "x": 0, "y": 1, "z": 2, "w": 3}
    values = [float(c) if c in "01" else float(x[places[c] if len(x) > 1 else 0]) for c in channels]
    return np.array(values)


def _two(first: float, second: float) -> tuple[tuple[str, float], ...]:
    return (("in1", first), ("in2", second))


def _compared(holds: Callable[[Array, Array], Any]) -> Operation:
    def make(a: Array, b: Array, first: Array, second: Array) -> Array:
        return first if bool(np.all(holds(a, b))) else second

    inputs = (("value1", 1.0), ("value2", 0.0), *_two(0.0, 0.0))
    return Operation(inputs, make, is_condition=True)


def _combined(count: int) -> Operation:
    inputs = tuple((f"in{k + 1}", 0.0) for k in range(count))
    return Operation(inputs, lambda *parts: np.concatenate(parts))


_IN = ("in", 0.0)
_RANGE = (("inlow", 0.0), ("inhigh", 1.0))
_OUT = (("outlow", 0.0), ("outhigh", 1.0))
OPERATIONS: dict[str, Operation] = {
    "constant": Operation((("value", None),), lambda x: x),
    **dict.fromkeys(("dot", "convert"), Operation((("in", None),), lambda x: x)),
    "add": Operation(_two(0.0, 0.0), np.add),
    "subtract": Operation(_two(0.0, 0.0), np.subtract),
    "multiply": Operation(_two(0.0, 1.0), np.multiply),
    "divide": Operation(_two(0.0, 1.0), np.divide),
    "power": Operation(_two(0.0, 1.0), np.power),
    "min": Operation(_two(0.0, 0.0), np.minimum),
    "max": Operation(_two(0.0, 0.0), np.maximum),
    "absval": Operation((_IN,), np.abs),
    "sqrt": Operation((_IN,), np.sqrt),
    "invert": Operation((_IN, ("amount", 1.0)), lambda x, amount: amount - x),
    "clamp": Operation((_IN, ("low", 0.0), ("high", 1.0)), np.clip),
    "remap": Operation((_IN, *_RANGE, *_OUT), _remapped),
    "range": Operation((_IN, *_RANGE, ("gamma", 1.0), *_OUT, ("doclamp", 0.0)), _ranged),
    "smoothstep": Operation((_IN, ("low", 0.0), ("high", 1.0)), _smoothstep),
    "contrast": Operation(
        (_IN, ("amount", 1.0), ("pivot", 0.5)),
        lambda x, amount, pivot: (x - pivot) * amount + pivot,
    ),
    "saturate": Operation((_IN, ("amount", 1.0)), _saturated),
    "luminance": Operation((_IN,), _luminance),
    "mix": Operation(
        (("bg", 0.0), ("fg", 0.0), ("mix", 0.0)), lambda bg, fg, share: bg + share * (fg - bg)
    ),
    "extract": Operation((_IN, ("index", 0.0)), lambda x, index: x[range(4)[int(index[0])]]),
    "swizzle": Operation((_IN,), _swizzled, (("channels", ""),)),
    "combine2": _combined(2),
    "combine3": _combined(3),
    "combine4": _combined(4),
    "ifgreater": _compared(np.greater),
    "ifgreatereq": _compared(np.greater_equal),
    "ifequal": _compared(np.equal),
}
