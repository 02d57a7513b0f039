"""Every command, interrupted at random moments (scripts/interrupt.py); its control finds faults."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

import interrupt  # noqa: E402

linux = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="reads /proc")


@linux
@pytest.mark.slow
def test_no_signal_leaves_anything():
    words = [sys.executable, str(ROOT / "scripts" / "interrupt.py"), "--count", "102"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@linux
@pytest.mark.slow
def test_a_program_without_handlers_is_found_out():
    words = [sys.executable, str(ROOT / "scripts" / "interrupt.py"), "--handlers", "none"]
    words += ["--only", "snapshot png", "--only", "gloss", "--count", "24"]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 1, done.stdout + done.stderr
    assert "crash by SIG" in done.stdout


def test_what_is_whole(tmp_path):
    for name, half, full in (
        ("a.png", b"\x89PNG\r\n\x1a\n", b"\x89PNG\r\n\x1a\nIEND\xaeB`\x82"),
        ("a.json", b'{"a": ', b'{"a": 1}'),
        ("c.html", b"<html>", b"<html></html>\n"),
        ("a.csv", b"", b"a,b\n"),
        ("s.sqlite", b"SQLite format 3\0 and no more", None),
    ):
        path = tmp_path / name
        path.write_bytes(half)
        assert not interrupt.whole(path)
        if full is not None:
            path.write_bytes(full)
            assert interrupt.whole(path)
    folder = tmp_path / "stimuli"
    folder.mkdir()
    (folder / "a.json").write_text("{}")
    assert not interrupt.whole(folder)
    (folder / "manifest.json").write_text("{}")
    assert interrupt.whole(folder)
