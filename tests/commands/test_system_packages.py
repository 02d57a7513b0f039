"""scripts/system-packages on a machine that has nothing, played by stand-ins."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "scripts" / "system-packages"


#: What any machine has, and the script calls.
TOOLS = ("sh", "grep", "uname")
BROWSERS = {
    "chromium": "chromium",
    "chromedriver": "chromium-driver",
    "firefox-esr": "firefox-esr",
    "WebKitWebDriver": "webkit2gtk-driver",
}
COMMANDS = ("glslangValidator", "Xvfb", "xdotool", *BROWSERS)


def asked_for(folder, purpose, *, apt_knows, python="python3", commands=COMMANDS, fonts=None):
    """The packages that an ordinary user is told to install, where some commands are there."""
    stand_ins = {
        "ldconfig": "exit 0",
        "id": "echo 1000",
        "apt-cache": f"exit {0 if apt_knows else 100}",
        "python3": "exit 1",
        "my-python": "exit 0",
    } | dict.fromkeys(commands, "exit 0")
    for tool in TOOLS:
        (folder / tool).unlink(missing_ok=True)
        (folder / tool).symlink_to(shutil.which(tool))
    for name, body in stand_ins.items():
        (folder / name).write_text(f"#!/bin/sh\n{body}\n")
        (folder / name).chmod(0o755)
    env = {**os.environ, "PATH": str(folder), "PYTHON": python, "FONTS": str(fonts or folder)}
    done = subprocess.run(
        [str(folder / "sh"), str(SCRIPT), purpose],
        env=env,
        capture_output=True,
        text=True,
        check=False,
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


WINDOW = {"libglx-mesa0", "libxrandr2", "libxcursor1"}  # what only a window on a display needs


@pytest.mark.parametrize("purpose", ["demo", "test"])
def test_the_window_on_a_display_is_for_everybody(tmp_path, purpose):
    assert set(asked_for(tmp_path, purpose, apt_knows=True)) >= WINDOW


@pytest.mark.parametrize(
    ("command", "package"),
    [
        ("Xvfb", "xvfb"),
        ("xdotool", "xdotool"),
        ("glslangValidator", "glslang-tools"),
        *BROWSERS.items(),
    ],
)
def test_commands_of_tests_are_for_tests(tmp_path, command, package):
    others = tuple(name for name in COMMANDS if name != command)
    for purpose, there, asked in (
        ("test", others, True), ("test", COMMANDS, False), ("demo", others, False)
    ):  # fmt: skip
        folder = tmp_path / f"{purpose}-{asked}-{len(there)}"
        folder.mkdir()
        packages = asked_for(folder, purpose, apt_knows=True, commands=there)
        assert (package in packages) == asked, purpose


def test_a_font_for_chinese_japanese_and_korean_is_for_tests(tmp_path):
    font = tmp_path / "fonts" / "opentype" / "noto" / "NotoSansCJK-Regular.ttc"
    assert "fonts-noto-cjk" in asked_for(tmp_path, "test", apt_knows=True)
    assert "fonts-noto-cjk" not in asked_for(tmp_path, "demo", apt_knows=True)
    font.parent.mkdir(parents=True)
    font.touch()
    packages = asked_for(tmp_path, "test", apt_knows=True, fonts=tmp_path / "fonts")
    assert "fonts-noto-cjk" not in packages


def test_the_python_that_make_uses_is_asked(tmp_path):
    assert "python3-venv" in asked_for(tmp_path, "demo", apt_knows=True)
    packages = asked_for(tmp_path, "demo", apt_knows=True, python=str(tmp_path / "my-python"))
    assert "python3-venv" not in packages
    makefile = (SCRIPT.parents[1] / "Makefile").read_text(encoding="utf-8")
    assert makefile.count("scripts/system-packages ") == makefile.count(
        'PYTHON="$(PYTHON)" scripts'
    )


def test_the_font_of_the_page_is_for_tests(tmp_path):
    font = tmp_path / "fonts" / "truetype" / "dejavu" / "DejaVuSans.ttf"
    assert "fonts-dejavu-core" in asked_for(tmp_path, "test", apt_knows=True)
    assert "fonts-dejavu-core" not in asked_for(tmp_path, "demo", apt_knows=True)
    font.parent.mkdir(parents=True)
    font.touch()
    packages = asked_for(tmp_path, "test", apt_knows=True, fonts=tmp_path / "fonts")
    assert "fonts-dejavu-core" not in packages
