"""Small faults for mutation testing: every place of a Python or GLSL text where one can be put.

A fault (mutation) replaces one stretch of the text: an operator, a constant, a condition, a call, a
term or a statement. Left alone are docstrings, annotations, decorators, error messages and what is
raised. A comparison is turned round, never moved from `<` to `<=`: on measured numbers that differs
only where both sides agree in the last bit; whole numbers are moved by one instead.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass

#: Constants up to this size are thresholds or guards of a division: they become 1,000 times larger,
#: since a tenth more changes nothing that anybody could see.
GUARD = 1e-3
#: Constants above this size stand for infinity; they become 1.
HUGE = 1e9


@dataclass(frozen=True)
class Mutation:
    """One fault: the stretch from `start` to `end` (characters) becomes `new`."""

    line: int
    start: int
    end: int
    old: str
    new: str

    def applied(self, text: str) -> str:
        """The text with the fault in it."""
        return text[: self.start] + self.new + text[self.end :]

    def __str__(self) -> str:
        """The change in one line, shortened where it is long."""
        old, new = (" ".join(side.split()) or "(nothing)" for side in (self.old, self.new))
        return f"{_shortened(old)} -> {_shortened(new)}"


def mutations(text: str, suffix: str) -> list[list[Mutation]]:
    """The faults of a text, grouped by the place they change, for '.py' or '.glsl'."""
    places: dict[tuple[int, int], list[Mutation]] = {}
    for one in _python(text) if suffix == ".py" else _glsl(text):
        if one.old != one.new:
            places.setdefault((one.start, one.end), []).append(one)
    return [places[key] for key in sorted(places)]


def _shortened(text: str) -> str:
    return text if len(text) <= 70 else f"{text[:45]} ... {text[-20:]}"


def _other_numbers(value: float) -> list[float]:
    """What a floating-point constant becomes."""
    if value in (0.0, 1.0):
        return [1.0 - value]
    if abs(value) >= HUGE:
        return [1.0]
    return [value * 1000.0] if abs(value) <= GUARD else [value * 1.1]


# --- Python ---------------------------------------------------------------------------------------

_ARITHMETIC: dict[type[ast.operator], ast.operator] = {
    ast.Add: ast.Sub(), ast.Sub: ast.Add(), ast.Mult: ast.Div(), ast.Div: ast.Mult(),
    ast.FloorDiv: ast.Div(), ast.Mod: ast.Mult(), ast.Pow: ast.Mult(), ast.BitAnd: ast.BitOr(),
    ast.BitOr: ast.BitAnd(), ast.BitXor: ast.BitOr(), ast.LShift: ast.RShift(),
    ast.RShift: ast.LShift(),
}  # fmt: skip
_COMPARISONS: dict[type[ast.cmpop], ast.cmpop] = {
    ast.Lt: ast.GtE(), ast.GtE: ast.Lt(), ast.Gt: ast.LtE(), ast.LtE: ast.Gt(), ast.Eq: ast.NotEq(),
    ast.NotEq: ast.Eq(), ast.Is: ast.IsNot(), ast.IsNot: ast.Is(), ast.In: ast.NotIn(),
    ast.NotIn: ast.In(),
}  # fmt: skip
_PAIRS = (
    ("min", "max"), ("minimum", "maximum"), ("sin", "cos"), ("argmin", "argmax"),
    ("nanmin", "nanmax"), ("any", "all"), ("zeros", "ones"), ("zeros_like", "ones_like"),
    ("floor", "ceil"), ("radians", "degrees"), ("flatnonzero", "argsort"), ("sum", "mean"),
)  # fmt: skip
_SWAPPED = {a: b for pair in _PAIRS for a, b in (pair, pair[::-1])}
#: Calls of which only the first argument is left.
_REMOVED = {
    "abs", "clip", "sqrt", "cbrt", "square", "max", "min", "maximum", "minimum", "floor",
    "cumsum", "nan_to_num", "sorted", "exp", "log",
}  # fmt: skip


def _python(text: str) -> Iterator[Mutation]:
    lines = text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line))

    def offset(line: int, column: int) -> int:
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())

    finder = _Finder()
    finder.visit(ast.parse(text))
    for node, new in finder.faults:
        start = offset(node.lineno, node.col_offset)
        end = offset(node.end_lineno or node.lineno, node.end_col_offset or 0)
        yield Mutation(node.lineno, start, end, text[start:end], new)


class _Finder(ast.NodeVisitor):
    """Collects nodes and the text that each may become."""

    def __init__(self) -> None:
        self.faults: list[tuple[ast.expr | ast.stmt, str]] = []

    def _becomes(self, node: ast.expr, new: ast.expr) -> None:
        self.faults.append((node, f"({ast.unparse(new)})"))

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Defaults and body; neither decorators nor annotations."""
        for value in (*node.args.defaults, *(d for d in node.args.kw_defaults if d)):
            self.visit(value)
        for statement in node.body:
            self.visit(statement)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        """The body alone."""
        for statement in node.body:
            self.visit(statement)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        """The value alone."""
        if node.value is not None:
            self.visit(node.value)

    def visit_Expr(self, node: ast.Expr) -> None:
        """Docstrings are left alone; a call may be left out."""
        if not isinstance(node.value, ast.Constant):
            self.faults.append((node, "pass"))
            self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:
        """What is raised is a message."""

    def visit_Assert(self, node: ast.Assert) -> None:
        """Assertions here serve the type checker."""

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Messages."""

    def visit_keyword(self, node: ast.keyword) -> None:
        """`strict` of a zip finds errors of a programmer, which the rest has not."""
        if node.arg != "strict":
            self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        """Numbers and truth values; no text."""
        if isinstance(node.value, bool):
            self.faults.append((node, str(not node.value)))
        elif isinstance(node.value, int):
            for other in {node.value + 1, abs(node.value - 1)} - {node.value}:
                self.faults.append((node, str(other)))
        elif isinstance(node.value, float):
            for number in _other_numbers(node.value):
                self.faults.append((node, repr(number)))

    def visit_BinOp(self, node: ast.BinOp) -> None:
        """Another operator, or one of the terms alone."""
        other = _ARITHMETIC.get(type(node.op))
        if other is not None:
            self._becomes(node, ast.BinOp(node.left, other, node.right))
            self._becomes(node, node.left)
            if isinstance(node.op, ast.Add | ast.Mult):
                self._becomes(node, node.right)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        """Without its sign or negation."""
        self._becomes(node, node.operand)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        """The opposite comparison."""
        if len(node.ops) == 1:
            other = _COMPARISONS[type(node.ops[0])]
            self._becomes(node, ast.Compare(node.left, [other], node.comparators))
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        """'or' for 'and', and without one of the conditions."""
        other = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        self._becomes(node, ast.BoolOp(other, node.values))
        for k in range(len(node.values)):
            rest = node.values[:k] + node.values[k + 1 :]
            self._becomes(node, rest[0] if len(rest) == 1 else ast.BoolOp(node.op, rest))
        self.generic_visit(node)

    def _negated(self, test: ast.expr) -> None:
        if not isinstance(test, ast.Compare):  # that has its own opposite
            self._becomes(test, ast.UnaryOp(ast.Not(), test))

    def visit_If(self, node: ast.If) -> None:
        """The opposite condition."""
        self._negated(node.test)
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        """The opposite condition."""
        self._negated(node.test)
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        """Another function, or the argument alone; the choices of `where` the other way round."""
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
        name = node.func.id if isinstance(node.func, ast.Name) else name
        if name in _SWAPPED:
            func: ast.expr = ast.Name(_SWAPPED[name])
            if isinstance(node.func, ast.Attribute):
                func = ast.Attribute(node.func.value, _SWAPPED[name])
            self._becomes(node, ast.Call(func, node.args, node.keywords))
        if name in _REMOVED and node.args and not isinstance(node.args[0], ast.Starred):
            self._becomes(node, node.args[0])
        if name == "where" and len(node.args) == 3:
            test, yes, no = node.args
            self._becomes(node, ast.Call(node.func, [test, no, yes], node.keywords))
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        """Another operator, or no statement."""
        self.faults.append((node, "pass"))
        other = _ARITHMETIC.get(type(node.op))
        if other is not None:
            new = ast.AugAssign(node.target, other, node.value)
            self.faults.append((node, ast.unparse(new)))
        self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> None:
        """No statement, where it changes a part of something."""
        if all(isinstance(target, ast.Subscript) for target in node.targets):
            self.faults.append((node, "pass"))
        self.generic_visit(node)

    def visit_Break(self, node: ast.Break) -> None:
        """The loop goes on."""
        self.faults.append((node, "continue"))

    def visit_Continue(self, node: ast.Continue) -> None:
        """The loop ends."""
        self.faults.append((node, "break"))


# --- GLSL -----------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"(?P<skip>//[^\n]*|/\*.*?\*/|^[ \t]*\#[^\n]*|\s+)"
    r"|(?P<float>(?:\d+\.\d*|\.\d+)(?:[eE][-+]?\d+)?|\d+[eE][-+]?\d+)"
    r"|(?P<int>0x[0-9A-Fa-f]+u?|\d+u?)|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<mark><<|>>|&&|\|\||[-+*/^|&]=|[<>=!]=|.)",
    re.DOTALL | re.MULTILINE,
)
_MARKS = {
    "+": "-", "-": "+", "*": "/", "/": "*", "<": ">=", ">=": "<", ">": "<=", "<=": ">",
    "==": "!=", "!=": "==", "&&": "||", "||": "&&", "<<": ">>", ">>": "<<", "+=": "-=",
    "-=": "+=", "*=": "/=", "/=": "*=", "^=": "|=", "^": "|",
}  # fmt: skip
_GLSL_SWAPPED = {
    "min": "max", "max": "min", "sin": "cos", "cos": "sin", "floor": "ceil", "ceil": "floor",
    "lessThanEqual": "greaterThanEqual", "greaterThanEqual": "lessThanEqual",
}  # fmt: skip
_GLSL_REMOVED = {"abs", "sqrt", "clamp", "min", "max", "floor", "normalize", "exp", "log"}
_SWIZZLES = {"x": "y", "y": "x", "z": "x", "w": "x"}


def _glsl(text: str) -> Iterator[Mutation]:
    tokens = [m for m in _TOKEN.finditer(text) if m.lastgroup != "skip"]

    def fault(start: int, end: int, new: str) -> Mutation:
        return Mutation(text.count("\n", 0, start) + 1, start, end, text[start:end], new)

    def closing(opening: int) -> int:
        depth = 0
        for k in range(opening, len(tokens)):
            depth += {"(": 1, ")": -1}.get(tokens[k][0], 0)
            if depth == 0:
                return k
        raise ValueError("a bracket is not closed")

    def argument_end(opening: int) -> int:
        """The token behind the first argument."""
        depth = 0
        for k in range(opening, len(tokens)):
            depth += {"(": 1, ")": -1}.get(tokens[k][0], 0)
            if depth == 0 or (depth == 1 and tokens[k][0] == ","):
                return k
        raise ValueError("a bracket is not closed")

    def statement_end(k: int) -> int | None:
        """The semicolon behind a statement; None in the head of a loop."""
        depth = 0
        while tokens[k][0] != ";" and depth >= 0:
            depth += {"(": 1, ")": -1}.get(tokens[k][0], 0)
            k += 1
        return k if depth == 0 else None

    begin = 0  # of the statement
    for k, token in enumerate(tokens):
        kind, word, (start, end) = token.lastgroup, token[0], token.span()
        before = tokens[k - 1] if k else None
        after = tokens[k + 1][0] if k + 1 < len(tokens) else ""
        if kind == "float":
            for number in _other_numbers(float(word)):
                yield fault(start, end, repr(number))
        elif kind == "int":
            value, unsigned = int(word.rstrip("u"), 0), "u" if word.endswith("u") else ""
            for other in {value + 1, abs(value - 1)} - {value}:
                yield fault(start, end, f"{other}{unsigned}")
        elif kind == "name":
            if word in _GLSL_SWAPPED and after == "(":
                yield fault(start, end, _GLSL_SWAPPED[word])
            if word in _GLSL_REMOVED and after == "(":
                first = text[tokens[k + 1].end() : tokens[argument_end(k + 1)].start()]
                yield fault(start, tokens[closing(k + 1)].end(), f"({first})")
            if word == "if":
                opening = tokens[k + 1]
                test = text[opening.start() : tokens[closing(k + 1)].end()]
                yield fault(opening.start(), tokens[closing(k + 1)].end(), f"(!{test})")
            if word in _SWIZZLES and before is not None and before[0] == ".":
                yield fault(start, end, _SWIZZLES[word])
        elif word in _MARKS or word == "!":
            value_before = before is not None and (
                before.lastgroup in ("float", "int")
                or before[0] in (")", "]")
                or (before.lastgroup == "name" and before[0] != "return")
            )
            if word == "!" or (word == "-" and not value_before):
                yield fault(start, end, "")
            elif word in _MARKS and value_before:
                yield fault(start, end, _MARKS[word])
            if len(word) == 2 and word[1] == "=" and word[0] in "+-*/^":
                stop = statement_end(k)
                if stop is not None:
                    yield fault(tokens[begin].start(), tokens[stop].start(), "")
        if word in (";", "{", "}"):
            begin = k + 1
