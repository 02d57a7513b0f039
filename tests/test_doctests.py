"""The examples in the docstrings run, and every public function and class has one."""

from __future__ import annotations

import doctest
import importlib
import inspect
from pathlib import Path

import pytest

import relgloss_view

PACKAGE = Path(relgloss_view.__file__).parent
#: An exception's message may be cut with "...".
FLAGS = doctest.ELLIPSIS
FEWEST_EXAMPLES = 100


def modules_with_examples():
    for path in sorted(PACKAGE.rglob("*.py")):
        if ">>> " in path.read_text(encoding="utf-8"):
            parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
            yield ".".join(parts).removesuffix(".__init__")


MODULES = list(modules_with_examples())


def examples_of(module):
    return [found for found in doctest.DocTestFinder().find(module) if found.examples]


def run(tests):
    """Failures, attempts and the report of some examples."""
    runner, lines = doctest.DocTestRunner(optionflags=FLAGS, verbose=False), []
    for test in tests:
        runner.run(test, out=lines.append)
    done = runner.summarize(verbose=False)
    return done.failed, done.attempted, "".join(lines)


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # where examples write their files
    failed, attempted, report = run(examples_of(importlib.import_module(name)))
    assert attempted > 0
    assert failed == 0, report


def test_examples_are_many():
    modules = [importlib.import_module(name) for name in MODULES]
    assert sum(len(t.examples) for m in modules for t in examples_of(m)) >= FEWEST_EXAMPLES


#: Those that carry a docstring: OPERATORS, SAMPLES and the version are plain values.
PUBLIC = [
    name
    for name in relgloss_view.__all__
    if inspect.isclass(value := getattr(relgloss_view, name)) or inspect.isfunction(value)
]


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_value_has_an_example(name):
    value = getattr(relgloss_view, name)
    found = examples_of(importlib.import_module(value.__module__))
    assert f"{value.__module__}.{name}" in [test.name for test in found]
    # It opens with a whole sentence: what it is.
    assert inspect.getdoc(value).split("\n\n")[0].endswith(".")


@pytest.mark.parametrize(
    ("text", "failed"),
    [(">>> 1 + 1\n2\n", 0), (">>> 1 + 1\n3\n", 1), (">>> 1 / 0\n", 1), (">>> int('4')\n5\n", 1)],
)
def test_a_broken_example_is_seen(text, failed):
    test = doctest.DocTestParser().get_doctest(text, {}, "control", None, 0)
    assert run([test])[:2] == (failed, 1)
