"""scripts/system-packages on a machine that has nothing, played by stand-ins."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "system-packages"


def asked_for(folder, purpose, *, apt_knows, python="python3"):
    """The packages that an ordinary user is told to install."""
    stand_ins = {
        "ldconfig": "exit 0",
        "id": "echo 1000",
        "apt-cache": f"exit {0 if apt_knows else 100}",
        "python3": "exit 1",
        "my-python": "exit 0",
        "glslangValidator": "exit 0",
    }
    for name, body in stand_ins.items():
        (folder / name).write_text(f"#!/bin/sh\n{body}\n")
        (folder / name).chmod(0o755)
    env = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "PYTHON": python}
    done = subprocess.run(
        ["sh", str(SCRIPT), purpose], env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    return done.stderr.splitlines()[-1].partition("--no-install-recommends ")[2].split()


@pytest.mark.parametrize(
    ("purpose", "apt_knows", "osmesa"),
    [("demo", True, False), ("test", True, True), ("test", False, False)],
)
def test_osmesa_is_for_tests_where_debian_has_it(tmp_path, purpose, apt_knows, osmesa):
    packages = asked_for(tmp_path, purpose, apt_knows=apt_knows)
    assert ("libosmesa6" in packages) == osmesa
    assert "libegl1" in packages


def test_the_python_that_make_uses_is_asked(tmp_path):
    assert "python3-venv" in asked_for(tmp_path, "demo", apt_knows=True)
    packages = asked_for(tmp_path, "demo", apt_knows=True, python=str(tmp_path / "my-python"))
    assert "python3-venv" not in packages
    makefile = (SCRIPT.parents[1] / "Makefile").read_text(encoding="utf-8")
    assert makefile.count("scripts/system-packages ") == makefile.count(
        'PYTHON="$(PYTHON)" scripts'
    )
