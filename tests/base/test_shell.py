"""A printed command, pasted into a shell, has the words that were meant."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

from relgloss_view.base.shell import command_line, operand, option

WORDS = [
    "plain", "with space", "it's", '"q"', "$HOME", "a;b", "", "-x", "é 紙", "two  spaces", " lead",
    "a\nb", "\x1b[31m", "tab\t", "back\\slash\n'", "bytes \udcff", "\u202eb", "~", "*",
]  # fmt: skip


@pytest.mark.skipif(not shutil.which("bash"), reason="needs bash")
@pytest.mark.parametrize("word", WORDS, ids=ascii)
def test_a_shell_reads_the_same_word(word):
    line = command_line(["printf", "<%s>", word])
    assert line.isprintable()
    assert " ".join(line.split()) == line  # as an error's message puts it
    done = subprocess.run(["bash", "-c", line], capture_output=True, check=True)
    assert done.stdout == os.fsencode(f"<{word}>")


def test_a_name_is_never_an_option():
    assert operand("-x.toml") == "./-x.toml"
    assert operand("/a/-x") == "/a/-x"
    assert option("--observer", "-x") == ["--observer=-x"]
    assert option("--observer", "x") == ["--observer", "x"]
