"""A decoration that fails is one warning, unless it is asked to show the fault."""

from __future__ import annotations

import subprocess
import sys

import pytest

from relgloss_view.base.decoration import RAISE, VARIABLE, decoration, fault_line
from relgloss_view.base.errors import InputError
from relgloss_view.base.figures import drawing, new_figure, save_figure
from relgloss_view.base.interruptions import Interrupted

FAULTS = {
    "a fault of relgloss": ValueError("1 \x1b[31m\nsecond line " + 5000 * "x"),
    "without a message": RuntimeError(),
    "close other programs": MemoryError(),
    "`relgloss doctor`": ModuleNotFoundError("No module named 'matplotlib'"),
    "make room": OSError(28, "No space left on device"),
    "choose another place": InputError("rep.png: can't be written; choose another place"),
}


@pytest.mark.usefixtures("forgiving")
@pytest.mark.parametrize(("words", "error"), FAULTS.items(), ids=[*FAULTS])
def test_a_failure_is_one_line_that_names_what_is_kept(capsys, words, error):
    with decoration("rep.png: the report", "fit.json is written") as drawn:
        raise error
    assert not drawn.done
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("warning: rep.png: the report was not drawn; fit.json is written. ")
    assert words in err
    assert "\x1b" not in err
    assert len(err) < 400
    if not isinstance(error, InputError):
        assert type(error).__name__ in err


def test_the_tests_see_the_fault_itself(capsys):
    """What conftest.py sets, so that no mistake is swallowed in a test."""
    with pytest.raises(ValueError, match="seen"), decoration("a", "b"):
        raise ValueError("seen")
    assert capsys.readouterr().err == ""


def test_a_process_of_a_test_fails_too():
    """Control: without the variable the same process ends well."""
    code = (
        "from relgloss_view.base.decoration import decoration\n"
        "with decoration('a', 'b'): raise ValueError('seen')"
    )
    failed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert failed.returncode == 1
    assert "ValueError: seen" in failed.stderr
    environment = {VARIABLE: "other", "PYTHONPATH": ":".join(sys.path)}
    went_on = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment)
    assert went_on.returncode == 0


@pytest.mark.usefixtures("forgiving")
@pytest.mark.parametrize("end", [KeyboardInterrupt(), Interrupted(15), SystemExit(2)], ids=repr)
def test_an_interruption_goes_on(end, tmp_path):
    with pytest.raises(type(end)), decoration("a", "b"):
        raise end


@pytest.mark.usefixtures("forgiving")
def test_no_file_stays_in_part(tmp_path):
    part, gone, other = (tmp_path / name for name in ("part.png", "gone.svg", "other.json"))
    other.write_text("{}")
    with decoration("part.png", "other.json is written", files=[part, gone]):
        part.write_bytes(b"\x89PNG")
        raise OSError(28, "No space left on device")
    assert list(tmp_path.iterdir()) == [other]
    with decoration("part.png", "other.json is written", files=[part]) as drawn:
        part.write_bytes(b"\x89PNG")
    assert drawn.done
    assert part.exists()


def test_a_line_for_the_window_raises_likewise(monkeypatch):
    with pytest.raises(ZeroDivisionError):
        fault_line(ZeroDivisionError("x"))
    monkeypatch.delenv(VARIABLE)
    line = fault_line(ZeroDivisionError("x"))
    assert line.startswith("ZeroDivisionError: x; ")
    assert f"{VARIABLE}={RAISE}" in line


class TestFigures:
    """Plots do not depend on the settings of whoever runs the program."""

    @staticmethod
    def plot(path):
        with drawing():
            figure = new_figure(2.0, 1.0, dpi=50)
            axes = figure.add_subplot()
            axes.set_title("a$b$_^{ \\frac \u7d19 \U0001f4a9")
            axes.plot([0, 1], [0, 1], label="$x_1$")
            axes.legend()
            save_figure(figure, path)
        return path.read_bytes()

    def test_settings_of_matplotlib_change_nothing(self, tmp_path):
        import matplotlib

        plain = self.plot(tmp_path / "a.png")
        with matplotlib.rc_context({"text.usetex": True, "lines.linewidth": 9.0, "font.size": 30}):
            assert self.plot(tmp_path / "b.png") == plain
            assert matplotlib.rcParams["lines.linewidth"] == 9.0
        with drawing({"lines.linewidth": 9.0}):  # control: one that is asked for does
            assert matplotlib.rcParams["lines.linewidth"] == 9.0

    def test_no_environment_stops_them_or_makes_noise(self, tmp_path):
        code = (
            "import sys; from pathlib import Path\n"
            "from relgloss_view.base.figures import *\n"
            "with drawing():\n"
            "    figure = new_figure(2, 1, dpi=50); figure.text(0.1, 0.5, 'x')\n"
            "    save_figure(figure, sys.argv[1])"
        )
        gone = "/dev/null/nowhere"
        environment = {"MPLBACKEND": "nonsense", "MPLCONFIGDIR": gone, "HOME": gone}
        done = subprocess.run(
            [sys.executable, "-c", code, str(tmp_path / "a.png")],
            capture_output=True,
            text=True,
            env={"PYTHONPATH": ":".join(sys.path), "PATH": "/usr/bin:/bin", **environment},
        )
        assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        assert (tmp_path / "a.png").stat().st_size > 200
