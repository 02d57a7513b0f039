"""Functions of PDF that turn the tint of a spot colour into another colour space.

Source: ISO 32000-2:2020, 7.10 (types 0, 2, 3 and 4).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from relgloss_view.pack.artwork.pdf_streams import stream_bytes

MOST_STEPS = 20_000  #: operators that a calculator function runs, and deepest stack below
_DEEPEST = 200
_MOST_PARTS = 500
_MOST_BYTES = 1 << 24


def evaluate(function: Any, inputs: Sequence[float], depth: int = 0) -> list[float]:
    """The outputs of a function object of pikepdf. Raises ValueError where it is no function."""
    if depth > 8:
        raise ValueError("functions nested too deeply")
    kind = int(function["/FunctionType"])
    domain = [float(v) for v in function["/Domain"]]
    if len(domain) != 2 * len(inputs):
        raise ValueError("a function of other inputs")
    x = [_clip(v, domain[2 * k], domain[2 * k + 1]) for k, v in enumerate(inputs)]
    if kind == 0:
        out = _sampled(function, x, domain)
    elif kind == 2:
        low = [float(v) for v in function.get("/C0", [0.0])]
        high = [float(v) for v in function.get("/C1", [1.0])]
        share = x[0] ** float(function["/N"])
        out = [a + share * (b - a) for a, b in zip(low, high, strict=True)]
    elif kind == 3:
        out = _stitched(function, x[0], domain, depth)
    elif kind == 4:
        out = _calculated(stream_bytes(function, _MOST_BYTES), x)
    else:
        raise ValueError("a function of an unknown type")
    limits = [float(v) for v in function["/Range"]] if "/Range" in function else []
    if limits:
        out = [_clip(v, limits[2 * k], limits[2 * k + 1]) for k, v in enumerate(out)]
    if not all(math.isfinite(v) for v in out):
        raise ValueError("a function without finite values")
    return out


def _clip(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


def _mapped(x: float, a: float, b: float, low: float, high: float) -> float:
    return low if a == b else low + (x - a) * (high - low) / (b - a)


def _sampled(function: Any, x: list[float], domain: list[float]) -> list[float]:
    sizes = [int(v) for v in function["/Size"]]
    bits = int(function["/BitsPerSample"])
    limits = [float(v) for v in function["/Range"]]
    outputs = len(limits) // 2
    total = math.prod(sizes) * outputs
    if len(sizes) != len(x) or min(sizes) < 1 or total > 1 << 22 or len(x) > 8:
        raise ValueError("a table of samples of the wrong size")
    data = stream_bytes(function, _MOST_BYTES)
    if len(data) * 8 < total * bits or bits not in (1, 2, 4, 8, 12, 16, 24, 32):
        raise ValueError("a table of samples that is cut off")
    encode = [float(v) for v in function.get("/Encode", [])]
    encode = encode or [v for s in sizes for v in (0.0, s - 1.0)]
    decode = [float(v) for v in function.get("/Decode", [])] or limits
    at, parts = [], []
    for k, size in enumerate(sizes):
        place = _mapped(x[k], *domain[2 * k : 2 * k + 2], *encode[2 * k : 2 * k + 2])
        place = _clip(place, 0.0, size - 1.0)
        at.append(min(int(place), max(size - 2, 0)))
        parts.append(place - at[-1])

    def sample(index: int) -> float:
        first = index * bits
        part = data[first // 8 : (first + bits + 7) // 8]
        value = int.from_bytes(part, "big") >> (-(first + bits) % 8)
        return float(value & ((1 << bits) - 1)) / float((1 << bits) - 1)

    out = [0.0] * outputs
    for corner in range(1 << len(sizes)):
        weight, index, stride = 1.0, 0, 1
        for k, size in enumerate(sizes):
            high = corner >> k & 1
            weight *= parts[k] if high else 1.0 - parts[k]
            index += min(at[k] + high, size - 1) * stride
            stride *= size
        if weight > 0.0:
            for j in range(outputs):
                out[j] += weight * sample(index * outputs + j)
    return [_mapped(v, 0.0, 1.0, *decode[2 * j : 2 * j + 2]) for j, v in enumerate(out)]


def _stitched(function: Any, x: float, domain: list[float], depth: int) -> list[float]:
    parts = list(function["/Functions"])
    bounds = [float(v) for v in function["/Bounds"]]
    encode = [float(v) for v in function["/Encode"]]
    if not 1 <= len(parts) <= _MOST_PARTS or len(bounds) != len(parts) - 1:
        raise ValueError("functions stitched at the wrong places")
    k = sum(x >= b for b in bounds)
    edges = [domain[0], *bounds, domain[1]]
    inner = _mapped(x, edges[k], edges[k + 1], *encode[2 * k : 2 * k + 2])
    return evaluate(parts[k], [inner], depth + 1)


def _calculated(program: bytes, inputs: list[float]) -> list[float]:
    text = b"".join(line.split(b"%")[0] + b" " for line in program[: 1 << 18].splitlines())
    words = text.replace(b"{", b" { ").replace(b"}", b" } ").split()
    body, end = _block(words, 1, 0)
    if words[:1] != [b"{"] or end > len(words):
        raise ValueError("a calculator function without braces")
    stack: list[Any] = list(inputs)
    _run(body, stack, [0])
    return [float(v) for v in stack]


def _block(words: list[bytes], at: int, depth: int) -> tuple[list[Any], int]:
    body: list[Any] = []
    if depth > 32:
        raise ValueError("a calculator function nested too deeply")
    while at < len(words):
        word = words[at]
        at += 1
        if word == b"}":
            return body, at
        if word == b"{":
            inner, at = _block(words, at, depth + 1)
            body.append(inner)
            continue
        try:
            body.append(float(word) if b"." in word or b"e" in word.lower() else int(word))
        except ValueError:
            body.append(word.decode("latin-1"))
    raise ValueError("a calculator function without an end")


def _truncated(a: Any, b: Any) -> int:
    return int(math.copysign(abs(int(a)) // abs(int(b)), a * b)) if a and b else 0


_TWO: dict[str, Any] = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b if b else 0.0, "idiv": _truncated,
    "mod": lambda a, b: math.fmod(a, b) if b else 0, "exp": lambda a, b: _power(a, b),
    "atan": lambda a, b: math.degrees(math.atan2(a, b)) % 360.0,
    "eq": lambda a, b: a == b, "ne": lambda a, b: a != b, "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b, "lt": lambda a, b: a < b, "le": lambda a, b: a <= b,
    "and": lambda a, b: a & b, "or": lambda a, b: a | b, "xor": lambda a, b: a ^ b,
    "bitshift": lambda a, b: a << min(b, 31) if b >= 0 else a >> min(-b, 31),
}  # fmt: skip
_ONE: dict[str, Any] = {
    "neg": lambda a: -a, "abs": abs, "ceiling": math.ceil, "floor": math.floor,
    "round": lambda a: math.floor(a + 0.5), "truncate": math.trunc, "cvi": math.trunc,
    "cvr": float, "sqrt": lambda a: math.sqrt(max(a, 0.0)),
    "sin": lambda a: math.sin(math.radians(a)), "cos": lambda a: math.cos(math.radians(a)),
    "ln": lambda a: math.log(a) if a > 0 else 0.0,
    "log": lambda a: math.log10(a) if a > 0 else 0.0,
    "not": lambda a: (not a) if isinstance(a, bool) else ~a,
}  # fmt: skip


def _power(a: float, b: float) -> float:
    try:
        value = a**b
    except (OverflowError, ZeroDivisionError):
        return 0.0
    return value if isinstance(value, int | float) else 0.0


def _run(body: list[Any], stack: list[Any], steps: list[int]) -> None:
    k = 0
    while k < len(body):
        word = body[k]
        k += 1
        steps[0] += 1
        if steps[0] > MOST_STEPS or len(stack) > _DEEPEST:
            raise ValueError("a calculator function that takes too long")
        if not isinstance(word, str):
            stack.append(word)
        elif word in _TWO:
            b, a = stack.pop(), stack.pop()
            stack.append(_TWO[word](a, b))
        elif word in _ONE:
            stack.append(_ONE[word](stack.pop()))
        elif word in ("true", "false"):
            stack.append(word == "true")
        elif word == "pop":
            stack.pop()
        elif word == "exch":
            stack[-1], stack[-2] = stack[-2], stack[-1]
        elif word == "dup":
            stack.append(stack[-1])
        elif word == "copy":
            n = int(stack.pop())
            if not 0 <= n <= len(stack):
                raise ValueError("a calculator function that copies too much")
            stack += stack[len(stack) - n :]
        elif word == "index":
            stack.append(stack[-1 - int(stack.pop())])
        elif word == "roll":
            by, n = int(stack.pop()), int(stack.pop())
            if not 0 < n <= len(stack):
                raise ValueError("a calculator function that rolls too much")
            top = stack[-n:]
            by %= n
            stack[-n:] = top[n - by :] + top[: n - by]
        elif word == "if":
            block = stack.pop()
            if stack.pop():
                _run(block, stack, steps)
        elif word == "ifelse":
            other, block = stack.pop(), stack.pop()
            _run(block if stack.pop() else other, stack, steps)
        else:
            raise ValueError("an unknown operator in a calculator function")
