"""When the machine, the terminal or the user's names get in the way: one line, the right status."""

from __future__ import annotations

import errno
import importlib
import json
import os
import shlex
import subprocess
import sys
import tempfile

import materials
import pytest

from relgloss_view import cli
from relgloss_view.base import temporaries
from relgloss_view.base.resources import asset
from relgloss_view.experiment.session.records import read_record
from relgloss_view.material.files import material_to_dict, save_material
from relgloss_view.material.material import Material

PAPER = str(asset("papers", "art-coated.csv"))
RELGLOSS = [sys.executable, "-m", "relgloss_view.cli"]
ROOT = os.path.dirname(os.path.dirname(cli.__file__))


def run(capsys, *words):
    status = cli.main([str(w) for w in words])
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def one_line(err):
    assert err.count("\n") == 1, err
    assert err.startswith("relgloss: ")
    assert "Traceback" not in err
    return err


def shell(line, cwd, **env):
    """A command line in a shell of its own: status, standard output, standard error."""
    done = subprocess.run(
        ["sh", "-c", line.replace("relgloss", shlex.join(RELGLOSS), 1)],
        cwd=cwd,
        env={**os.environ, "PYTHONPATH": ROOT, "PYTHONUNBUFFERED": "", **env},
        capture_output=True,
    )
    return done.returncode, done.stdout, done.stderr.decode("utf-8", "replace")


class TestStreams:
    @pytest.mark.parametrize(
        "words", ["doctor --help", "snapshot --sample uncoated --c 0.5 --size 64x64 -o a.png"]
    )
    @pytest.mark.parametrize("redirection", [">&-", ">/dev/full"])
    def test_standard_output_that_takes_nothing(self, tmp_path, words, redirection):
        status, _, err = shell(f"relgloss {words} {redirection}", tmp_path)
        assert status == 1
        assert "standard output" in one_line(err)

    @pytest.mark.parametrize(
        ("words", "status"), [("--help", 1), ("--version", 1), ("gloss uncoated", 1), ("gloss", 2)]
    )
    def test_full_disk_behind_standard_output(self, tmp_path, words, status):
        got, _, err = shell(f"relgloss {words} >/dev/full", tmp_path)
        assert got == status
        assert ("standard output: No space left on device" in err) == (status == 1)
        assert "Exception ignored" not in err

    def test_standard_error_never_changes_the_result(self, tmp_path):
        assert shell("relgloss --version 2>/dev/full", tmp_path)[0] == 0
        assert shell("relgloss gloss 2>/dev/full", tmp_path)[0] == 2
        assert shell("relgloss gloss gone.json 2>/dev/full", tmp_path)[0] == 1

    def test_broken_pipe_ends_printing_and_no_work(self, tmp_path):
        words = (
            "experiment simulate paper --set screen.width_px=64 --set screen.height_px=64 "
            "--set grid.sigma_n_deg=[0,2] --set grid.c_fraction=[0.5,1] --truth cells "
            "--observers 6 --echo -o s.sqlite"
        )
        line = f"({{ relgloss {words}; echo status $? >&2; }}) | head -n 1"
        _, out, err = shell(line, tmp_path)
        assert err == "status 0\n"
        assert out.count(b"\n") == 1
        assert len(read_record(tmp_path / "s.sqlite", tmp_path).answers) == 6 * 3 * 4

    @pytest.mark.parametrize(
        ("error", "says"),
        [
            (OSError(errno.ENOSPC, "No space left on device"), "No space left on device"),
            (PermissionError(errno.EACCES, "Permission denied", "a\x1b.tmp"), "a\\x1b.tmp: Perm"),
            (BrokenPipeError(errno.EPIPE, "Broken pipe"), "Broken pipe"),
            (TimeoutError(), "TimeoutError"),
        ],
    )
    def test_other_faults_are_not_those_of_a_stream(self, capsys, monkeypatch, error, says):
        def fail(args):
            raise error

        monkeypatch.setattr("relgloss_view.commands.doctor.run", fail)
        status, _, err = run(capsys, "doctor")
        assert status == 1
        assert says in one_line(err)
        assert "standard output" not in err

    def test_closed_standard_error_is_no_fault(self, tmp_path):
        status, out, _ = shell("relgloss snapshot --size 16x16 -o a.png 2>&-", tmp_path)
        assert status == 0
        assert b"a.png" in out

    def test_names_on_a_terminal_of_ascii(self, tmp_path):
        """A name that is not UTF-8, one that ASCII lacks, one with control characters."""
        material = Material(
            "Büttenpapier 紙\x1b[31m\nred " + 300 * "x",
            *(getattr(materials.flat(), n) for n in ("source", "bands", "diffuse", "specular")),
            synthetic=True,
        )
        save_material(material, tmp_path / "m.json")
        line = "relgloss snapshot --material m.json --size 16x16 -o \"$(printf 'a\\377.png')\""
        status, out, err = shell(line, tmp_path, PYTHONIOENCODING="ascii")
        assert status == 0, err
        assert out.count(b"\n") == 2  # the file, and its match
        assert b"\x1b" not in out
        assert b"(synthetic)" in out
        assert len(out) < 500
        assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("command", cli.COMMANDS)
def test_interrupted_while_importing(capsys, monkeypatch, command):
    def interrupt(name):
        raise KeyboardInterrupt

    monkeypatch.setattr(importlib, "import_module", interrupt)
    status, _, err = run(capsys, command)
    assert status == 130
    assert "interrupted" in one_line(err)


@pytest.mark.parametrize(
    ("words", "remedy"),
    [
        (["fit", PAPER, "-o", "a.json"], "thin out the table"),
        (["snapshot", "-o", "a.png"], "--size"),
        (["doctor"], "close other programs"),
    ],
)
def test_out_of_memory(capsys, monkeypatch, tmp_path, words, remedy):
    def exhaust(args):
        raise MemoryError

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        importlib.import_module(f"relgloss_view.commands.{words[0]}"), "run", exhaust
    )
    status, _, err = run(capsys, *words)
    assert status == 1
    assert remedy in one_line(err)


@pytest.mark.parametrize("ours", [True, False])
def test_no_place_for_temporary_files(capsys, monkeypatch, ours):
    """Whoever asks for one, this program or a library: the line names TMPDIR, and no stream."""

    def ask(args):
        if ours:
            with temporaries.scratch_folder():
                pass
        tempfile.mkdtemp()

    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setattr(tempfile, "_candidate_tempdir_list", lambda: ["/nowhere"])
    monkeypatch.setattr(temporaries, "temporary_places", list)
    monkeypatch.setattr(importlib.import_module("relgloss_view.commands.doctor"), "run", ask)
    status, _, err = run(capsys, "doctor")
    assert status == 1
    assert "set TMPDIR" in one_line(err)
    assert "standard output" not in err


class TestOpenGL:
    def test_its_errors_are_status_3(self, capsys, monkeypatch, tmp_path):
        import moderngl

        def fail(*_):
            raise moderngl.Error("GLSL Compiler failed\n\nfragment_shader\n===\nbad")

        monkeypatch.setattr("relgloss_view.quality.backends.open_renderer", fail)
        status, _, err = run(capsys, "snapshot", "--size", "16x16", "-o", tmp_path / "a.png")
        assert status == 3
        assert "GLSL Compiler failed" in one_line(err)
        assert "relgloss doctor" in err
        assert list(tmp_path.iterdir()) == []

    def test_other_errors_stay_errors(self, monkeypatch, tmp_path):
        def fail(*_):
            raise ZeroDivisionError

        monkeypatch.setattr("relgloss_view.quality.backends.open_renderer", fail)
        with pytest.raises(ZeroDivisionError):
            cli.main(["snapshot", "-o", str(tmp_path / "a.png")])

    def test_doctor_survives_what_a_backend_raises(self, capsys, monkeypatch):
        from relgloss_view.commands import doctor
        from relgloss_view.quality import backends

        real = backends.open_renderer

        def fail(name, *rest):
            if name == "osmesa":
                raise SystemError("driver\nfell over")
            return real(name, *rest)

        monkeypatch.setattr(backends, "open_renderer", fail)
        monkeypatch.setattr(doctor, "_check", doctor._check_here)
        status, out, _ = run(capsys, "doctor", "--json")
        found = json.loads(out)["opengl"]
        assert status == 0
        assert found["egl"]["usable"]
        assert found["osmesa"] == {
            "usable": False,
            "fault": "osmesa: SystemError: driver\nfell over",
        }
        assert "osmesa: osmesa: SystemError: driver fell over" in run(capsys, "doctor")[1]


class TestDrivers:
    """A driver whose hardware is missing ends the process that tries it."""

    @pytest.fixture
    def crashing(self, monkeypatch):
        """Both contexts end the process that makes them."""
        from relgloss_view.base import child

        real = child.run_module
        outcomes = {"osmesa": child.Outcome(-11, "", ""), "egl": child.Outcome(-6, "", "")}

        def run_module(module, *words):
            return outcomes.get(words[-1]) or real(module, *words)

        monkeypatch.setattr(child, "run_module", run_module)
        return outcomes

    def test_doctor_reports_each_context(self, capsys, crashing):
        del crashing["egl"]
        status, out, _ = run(capsys, "doctor")
        assert status == 0
        assert "osmesa: the OpenGL driver crashed with signal 11 (SIGSEGV)" in out
        assert "pictures are drawn with egl" in out

    def test_a_picture_is_one_line_with_the_variable(self, capsys, monkeypatch, tmp_path, crashing):
        from relgloss_view.picture.gpu import probe

        monkeypatch.setattr(probe, "_crashes", {})
        monkeypatch.setenv("GALLIUM_DRIVER", "d3d12")
        status, _, err = run(capsys, "snapshot", "--size", "16x16", "-o", tmp_path / "a.png")
        assert status == 3
        assert "crashed with signal 6 (SIGABRT); unset GALLIUM_DRIVER=d3d12" in one_line(err)
        assert list(tmp_path.iterdir()) == []

    def test_nothing_is_tried_where_no_driver_is_named(self, monkeypatch, crashing):
        from relgloss_view.picture.gpu import probe

        for name in probe.chosen_by_hand():
            monkeypatch.delenv(name.partition("=")[0])
        monkeypatch.setattr(probe, "_crashes", {})
        probe.check("egl")
        monkeypatch.setenv("GALLIUM_DRIVER", "softpipe")
        monkeypatch.setenv("LP_NUM_THREADS", "0")
        probe.check("egl")
        assert probe._crashes == {}

    def test_a_child_that_ends_by_itself_and_one_that_does_not(self, monkeypatch):
        from relgloss_view.base import child

        assert child.run_module("relgloss_view.cli", "--version").crash == ""
        assert child.Outcome(-11, "", "").crash == "crashed with signal 11 (SIGSEGV)"
        monkeypatch.setattr(child, "LONGEST_S", 0.001)
        monkeypatch.setattr(child, "STEP_S", 0.001)  # a quick machine is done within a longer one
        assert "no answer" in child.run_module("relgloss_view.cli", "--version").crash


class TestTerminal:
    ESCAPES = "\x1b]0;evil\x07\x1b[31m\u202egnp"

    @pytest.mark.parametrize(
        "words",
        [
            ["snapshot", ESCAPES],
            ["snapshot", "--sample", ESCAPES, "-o", "a.png"],
            ["snapshot", f"--{ESCAPES}", "-o", "a.png"],
            ["snapshot", "-o", f"{ESCAPES[5:]}.png", "--size", "16x16"],
            ["snapshot", "-o", f"gone/{ESCAPES}.png", "--size", "16x16"],
            ["snapshot", "--set", f"look.{ESCAPES}=1", "-o", "a.png"],
            ["gloss", f"{ESCAPES}.json"],
            ["plan", "--material", f"{ESCAPES}.json"],
            ["experiment", "export", f"{ESCAPES}.sqlite", "-o", "a.csv"],
            [ESCAPES],
        ],
    )
    def test_no_word_of_a_command_line_reaches_it_raw(self, capsys, monkeypatch, tmp_path, words):
        monkeypatch.chdir(tmp_path)
        _, out, err = run(capsys, *words)
        assert out + err
        assert not set(out + err) & set("\x1b\x07\u202e")


class TestFit:
    @pytest.mark.parametrize(
        ("words", "says"),
        [
            (["t.csv", "-o", "a.txt"], "-o a.txt: expected a name that ends in .json"),
            (["t.csv", "-o", ""], "-o '': expected a name"),
            (["t.csv", "-o", "a.json", "--report", ""], "--report '': expected a name"),
            (["", "-o", "a.json"], "TABLE '': expected the name of a table"),
            (["t.json", "-o", "./t.json"], "the same file as TABLE"),
            (["link.json", "-o", "t.json"], "the same file as TABLE"),
            (["t.csv", "-o", "alias.json", "--report", "r.png"], "the same file as -o"),
            (["m.json", "-o", "a.json"], "a material, not a measurement"),
            (["nul\0.csv", "-o", "a.json"], "null"),
        ],
    )
    def test_places(self, capsys, monkeypatch, tmp_path, words, says):
        monkeypatch.chdir(tmp_path)
        for name in ("t.csv", "t.json"):
            (tmp_path / name).write_text("kept")
        (tmp_path / "link.json").symlink_to("t.json")
        (tmp_path / "alias.json").symlink_to("r.png")
        save_material(materials.flat(), tmp_path / "m.json")
        before = {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.exists()}
        status, out, err = run(capsys, "fit", *words)
        assert (status, out) == (1, "")
        assert says in one_line(err)
        assert {p.name: p.read_bytes() for p in tmp_path.iterdir() if p.exists()} == before

    def test_device_as_an_output(self, capsys, monkeypatch, tmp_path):
        monkeypatch.chdir(tmp_path)
        os.mkfifo("pipe.png")
        words = ("fit", PAPER, "-o", "a.json", "--report", "pipe.png")
        status, _, err = run(capsys, *words)
        assert status == 1
        assert "pipe.png: is not a regular file; choose another place" in one_line(err)
        assert os.listdir() == ["pipe.png"]


class TestSnapshot:
    def test_digits_of_a_size_are_plain(self, capsys, tmp_path):
        words = ("snapshot", "--size", "٣٢x32", "-o", tmp_path / "a.png")
        status, _, err = run(capsys, *words)
        assert status == 2
        assert "512x512" in err

    def test_measured_samples_are_not_called_synthetic(self, capsys, tmp_path):
        content = material_to_dict(materials.flat()) | {"source": "measured on synthetic leather"}
        (tmp_path / "m.json").write_text(json.dumps(content))
        words = ("snapshot", "--size", "16x16", "-o", tmp_path / "a.png")
        assert "(synthetic)" in run(capsys, *words)[1]
        assert "(synthetic)" not in run(capsys, *words, "--material", tmp_path / "m.json")[1]

    @pytest.mark.parametrize("setting", ["lamp.azimuth_deg=0x" + "f" * 400, "shape.kind={[]: 1}"])
    def test_strange_settings(self, capsys, tmp_path, setting):
        words = ("snapshot", "--set", setting, "-o", tmp_path / "a.png")
        status, _, err = run(capsys, *words)
        assert status == 1
        assert len(one_line(err)) < 1100


@pytest.mark.parametrize("name", ["bytes\udcff.exr", "bytes\udcff/a.exr", "bytes\udcff.png"])
def test_names_that_are_not_utf_8(capsys, monkeypatch, tmp_path, name):
    monkeypatch.chdir(tmp_path)
    os.mkdir("bytes\udcff")
    assert run(capsys, "snapshot", "--size", "16x16", "-o", name)[0] == 0
    assert os.path.getsize(name) > 100
    assert sum(len(files) for _, _, files in os.walk(tmp_path)) == 1
