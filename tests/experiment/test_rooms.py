"""The rooms of the experiment: an answer passes them in one order, and imports point back."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

import relgloss_view.experiment

PACKAGE = Path(relgloss_view.experiment.__file__).parent
#: A room may import itself and those before it.
ROOMS = ("design", "session", "observers", "scaling", "verdict", "report")
MODULES = sorted(path for path in PACKAGE.rglob("*.py") if path.parent != PACKAGE)


def imported_rooms(text):
    """The rooms of the experiment that a module imports, anywhere in it."""
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    parts = [name.split(".") for name in names]
    return {p[2] for p in parts if p[:2] == ["relgloss_view", "experiment"] and len(p) > 2}


def wrong_way(room, text):
    """Rooms that a module of a room may not import."""
    return {other for other in imported_rooms(text) if ROOMS.index(other) > ROOMS.index(room)}


def test_every_module_is_in_a_room():
    assert {path.name for path in PACKAGE.glob("*.py")} == {"__init__.py"}
    assert {path.parent.name for path in MODULES} == set(ROOMS)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: str(p.relative_to(PACKAGE)))
def test_imports_point_back(path):
    assert not wrong_way(path.parent.name, path.read_text(encoding="utf-8"))


def test_a_wrong_import_is_seen():
    late = "def f():\n    from relgloss_view.experiment.report import figures\n"
    assert wrong_way("verdict", late) == {"report"}
    assert wrong_way("report", late) == set()
    assert wrong_way("design", "import relgloss_view.experiment.session.store") == {"session"}
    assert wrong_way("session", "from relgloss_view.experiment import scaling") == {"scaling"}
