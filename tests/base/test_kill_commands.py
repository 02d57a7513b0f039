"""Whole commands, killed before some of the calls that change a folder; a mixture is found out."""

from __future__ import annotations

import subprocess
import sys

import kill_commands
import pytest

linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="forks, and folders swap")


@linux
@pytest.mark.slow
@pytest.mark.parametrize(
    ("sent", "commands"), [("KILL", ["match", "analyse"]), ("TERM", ["export"])]
)
def test_a_killed_command_leaves_old_or_new_files(sent, commands):
    words = [sys.executable, kill_commands.__file__, *commands, "--signal", sent, "--step", "60"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(": 0 faults") == len(commands)


@pytest.mark.parametrize(("texts", "faults"), [("aa", 0), ("bb", 0), ("ab", 1)])
def test_a_mixture_is_found_out(tmp_path, texts, faults):
    trees = []
    for both in ("aa", "bb", texts):
        for name, text in zip(("one", "other"), both, strict=True):
            (tmp_path / name).write_text(text)
        trees.append(kill_commands.tree(tmp_path))
    case = kill_commands.Case([], [], at_once=True)
    before, after, _ = trees
    found = kill_commands.found("name", 1, "after", case, True, tmp_path, before, after)
    assert found == faults
