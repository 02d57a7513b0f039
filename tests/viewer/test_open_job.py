"""Opening dropped files: told by content, read and fitted in the background, cancelled cleanly."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import materials
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.fitting import fit_material
from relgloss_view.material.files import load_material, save_material
from relgloss_view.measure.readers import read_measurement
from relgloss_view.picture.scene.file_kinds import MATERIAL, MEASUREMENT, SCENE, kind_of
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files import open_job, own_materials, pack_files
from relgloss_view.viewer.files.fit_process import FitProcess
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.files.own_materials import keep_material, safe_name
from relgloss_view.viewer.state.matching import with_sample
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state, save_state

TABLE = asset("papers", "matte-coated.csv")
LIMIT_S = 60.0
#: A table that only its reader finds out to be none.
BROKEN = "# quantity: brdf\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,R,G,B\n1,2,3,4,x,0,0\n"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path / "home"))
    return tmp_path / "home"


def kept(home):
    """What lies in the folder of fitted materials, hidden files too."""
    folder = home / "data" / "materials"
    return sorted(p.name for p in folder.iterdir()) if folder.exists() else []


def opened(path, wake=lambda: None):
    job = OpenJob(path, wake)
    assert job.wait(LIMIT_S)
    assert job.done
    return job


def refused(path):
    with pytest.raises(InputError) as caught:
        kind_of(path)
    message = str(caught.value)
    assert "\n" not in message
    assert len(message) < 500
    assert opened(path).fault == message
    return message


def write(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


class Waker:
    """What a loop does when it is woken; the first calls may come before it has the job."""

    def __init__(self, share=2.0):
        self.job = None
        self.seen = []
        self.share = share
        self.reached = threading.Event()

    def __call__(self):
        if self.job is not None:
            self.seen.append((threading.current_thread().name, self.job.progress[0]))
            if self.job.progress[0] >= self.share:
                self.reached.set()


class TestKinds:
    def test_names_mean_nothing(self, tmp_path):
        save_state(tmp_path / "scene.csv", State.initial())
        save_material(materials.paper("art"), tmp_path / "material.toml")
        table = write(tmp_path / "table.json", TABLE.read_bytes())
        assert kind_of(tmp_path / "scene.csv") == SCENE
        assert kind_of(tmp_path / "material.toml") == MATERIAL
        assert kind_of(table) == MEASUREMENT

    def test_byte_order_marks_and_space(self, tmp_path):
        save_material(materials.paper("art"), tmp_path / "m")
        for name, data in (("m", (tmp_path / "m").read_bytes()), ("s", b"\r\n[look]\nseed = 1\n")):
            file = write(tmp_path / "x", b"\xef\xbb\xbf" + data)
            assert kind_of(file) == {"m": MATERIAL, "s": SCENE}[name]
            assert opened(file).result is not None

    def test_a_material_that_says_so_late(self, tmp_path):
        file = write(
            tmp_path / "m", b'{"x": "' + b" " * 9000 + b'", "format": "relgloss-material"}'
        )
        assert kind_of(file) == MATERIAL
        assert "version" in opened(file).fault

    def test_a_scene_with_a_mistake_is_a_scene(self, tmp_path):
        file = write(tmp_path / "s", "[lamp]\nazimuth_deg = fifty\n")
        assert kind_of(file) == SCENE
        fault = opened(file).fault
        assert "not TOML" in fault
        assert "line 2" in fault

    @pytest.mark.parametrize(
        ("content", "says"),
        [
            (b"", "empty"),
            (b" \n\t\n", "nothing but"),
            (b"# only\n# comments\n", "nothing but"),
            (b"\x00" * 100, "neither text nor"),
            (b"PK\x03\x04\x14\x00\x00\x00", "a packed archive"),
            (b"\xff\xfe[\x00l\x00", "found column '[l'"),
            (b"{}", "relgloss-material"),
            (b'[{"format": 1}]', "relgloss-material"),
            (b'[project]\nname = "x"\n', "[project]"),
            (b"x = 1\n", "[x]"),
            (b"Dear all,\nthis is a letter.\n", "neither scene nor table"),
            (b"a,b,c,d\n1,2,3,4\n", "the header"),
            (b"\xfe\xed\xfa\xce" * 300_000, "byte 0: neither"),
            (b"a,b\n" * 200_000 + b"\xff" * 400_000, "neither scene nor table"),
            (BROKEN.encode(), "line 3"),
        ],
    )
    def test_anything_else_is_one_line(self, tmp_path, content, says):
        assert says in refused(write(tmp_path / "x", content))

    def test_what_is_no_file(self, tmp_path):
        assert "a folder" in refused(tmp_path)
        assert "can't be read" in refused(tmp_path / "gone")
        os.mkfifo(tmp_path / "fifo")
        assert "not a regular file" in refused(tmp_path / "fifo")
        assert "not a regular file" in refused("/dev/zero")

    def test_a_sparse_giant_is_refused_from_its_beginning(self, tmp_path):
        with (tmp_path / "giant").open("wb") as file:
            file.truncate(2**40)
        assert "neither text nor" in refused(tmp_path / "giant")


class TestOpening:
    def test_a_scene_takes_the_place_of_everything(self, tmp_path):
        state = State.initial().with_look("test", seed=5).with_part("presentation", wipe=0.2)
        save_state(tmp_path / "s.toml", state)
        job = opened(tmp_path / "s.toml")
        assert job.fault is None
        assert job.result.applied(State.initial(), "reference") == state

    def test_a_material_goes_to_one_side(self, tmp_path, monkeypatch):
        save_material(materials.paper("art"), tmp_path / "m.json")
        monkeypatch.chdir(tmp_path)
        job = opened("m.json")
        expected = Sample(materials.paper("art"), file=str(tmp_path / "m.json"))
        assert job.result.sample == expected
        state = job.result.applied(State.initial(), "reference")
        assert state == with_sample(State.initial(), "reference", expected)
        assert state.reference.sample == expected

    @pytest.mark.slow
    def test_a_measurement_is_fitted_and_kept(self, home, tmp_path):
        waker = Waker()
        waker.job = job = OpenJob(TABLE, waker)
        assert job.wait(LIMIT_S)
        assert job.fault is None
        sample, measurement = job.result.sample, job.result.measurement
        assert kept(home) == [Path(sample.file).name]
        assert load_material(sample.file) == sample.material
        assert sample.table == str(TABLE) == measurement.file
        assert len(measurement.to_lamp) == len(read_measurement(TABLE).to_lamp)
        assert not job.result.warning
        # It can be saved and found again like any other.
        state = job.result.applied(State.initial(), "test")
        save_state(tmp_path / "s.toml", state)
        assert load_state(tmp_path / "s.toml") == state
        # Progress came from the job's own thread, forwards, and ended at one.
        assert {name for name, _ in waker.seen} == {"open"}
        fractions = [fraction for _, fraction in waker.seen]
        assert len(set(fractions)) > 5
        assert fractions == sorted(fractions)
        assert fractions[-1] == 1.0
        # The process gives what a fit here gives.
        here = fit_material(read_measurement(TABLE))
        assert (sample.material.diffuse, sample.material.specular) == (here.diffuse, here.specular)

    def test_a_fit_that_can_not_be_kept_is_shown(self, tmp_path, home):
        write(home, "a file where the folder should be")
        job = opened(TABLE)
        assert job.fault is None
        assert job.result.sample.file is None
        assert "not kept" in job.result.warning
        assert "\n" not in job.result.warning

    @pytest.mark.parametrize("error", [MemoryError(), ZeroDivisionError("x\ny"), OSError(5, "I/O")])
    def test_nothing_keeps_a_job_from_ending(self, monkeypatch, capsys, error):
        def fail(path):
            raise error

        monkeypatch.setattr(pack_files, "likely_kind", fail)
        job = opened(TABLE)
        assert job.result is None
        assert "matte-coated.csv" in job.fault
        assert "\n" not in job.fault


class TestCancelling:
    @pytest.fixture
    def slow(self, monkeypatch):
        """A fit that reports until it is cancelled, or finishes when it is let."""
        began, finish = threading.Event(), threading.Event()
        outcome = (load_material(asset("materials", "uncoated.json")), read_measurement(TABLE))

        class Slow:
            def __init__(self, path):
                assert path == str(TABLE)
                self.stopped = threading.Event()

            def run(self, progress):
                while not finish.is_set():
                    progress(0.5, "turning")
                    began.set()
                    if self.stopped.wait(0.002):
                        raise InputError("the fit ended before it was done")
                return outcome

            def stop(self):
                self.stopped.set()

        monkeypatch.setattr(open_job, "FitProcess", Slow)
        return began, finish

    def test_it_is_over_at_once_and_leaves_nothing(self, slow, home):
        began, _ = slow
        woken = threading.Event()
        job = OpenJob(TABLE, woken.set)
        assert began.wait(LIMIT_S)
        assert not job.done
        assert job.progress == (0.5, "turning")
        job.cancel()
        assert job.done
        assert job.cancelled
        assert woken.is_set()
        assert job.wait(LIMIT_S)
        assert (job.result, job.fault) == (None, None)
        assert kept(home) == []

    def test_the_real_fit_stops_too(self, home):
        waker = Waker(share=0.1)
        waker.job = job = OpenJob(TABLE, waker)
        assert waker.reached.wait(LIMIT_S)
        job.close(LIMIT_S)
        assert job.wait(0.0)
        assert (job.result, job.fault, job.cancelled) == (None, None, True)
        assert kept(home) == []

    def test_while_the_material_is_being_saved(self, slow, home, monkeypatch):
        _, finish = slow
        saving, go_on = threading.Event(), threading.Event()

        def keep(*args):
            saving.set()
            assert go_on.wait(LIMIT_S)
            return keep_material(*args)

        monkeypatch.setattr(open_job, "keep_material", keep)
        finish.set()
        job = OpenJob(TABLE, lambda: None)
        assert saving.wait(LIMIT_S)
        job.cancel()
        go_on.set()
        assert job.wait(LIMIT_S)
        assert job.result is None
        assert (home / "data" / "materials").is_dir()
        assert kept(home) == []

    def test_what_is_done_stays_done(self, slow, home):
        slow[1].set()
        job = opened(TABLE)
        job.cancel()
        assert not job.cancelled
        assert job.result is not None
        assert len(kept(home)) == 1

    def test_a_running_fit_does_not_keep_the_program(self, home):
        """Without close, too: the interpreter ends under the thread."""
        code = (
            "import sys, threading; from relgloss_view.viewer.files.open_job import OpenJob\n"
            "began = threading.Event(); job = OpenJob(sys.argv[1], began.set)\n"
            "began.wait(60); assert not job.done; print('left')"
        )
        done = run_python(code)
        assert (done.returncode, done.stdout, done.stderr) == (0, "left\n", "")
        assert kept(home) == []


class TestFitProcess:
    def test_this_process_loads_no_scipy(self):
        """It costs more than a picture does."""
        code = (
            "import sys; from relgloss_view.viewer.files.open_job import OpenJob\n"
            "job = OpenJob(sys.argv[1], lambda: None); job.wait(60); assert job.result, job.fault\n"
            "print('scipy' in sys.modules)"
        )
        done = run_python(code)
        assert (done.returncode, done.stdout, done.stderr) == (0, "False\n", "")

    def test_its_end_is_told(self):
        began = threading.Event()
        process = FitProcess(str(TABLE))
        caught = []

        def run():
            try:
                process.run(lambda *_: began.set())
            except InputError as error:
                caught.append(str(error))

        thread = threading.Thread(target=run)
        thread.start()
        assert began.wait(LIMIT_S)
        os.kill(
            process._child.process.pid, signal.SIGKILL
        )  # as a system does that is out of memory
        thread.join(LIMIT_S)
        assert "before it was done" in caught[0]
        process.stop()  # what has ended may be stopped

    def test_it_ends_with_the_window(self, tmp_path):
        """A window that was killed leaves no fit running."""
        code = (
            "import sys, threading; from relgloss_view.viewer.files.open_job import OpenJob\n"
            "began = threading.Event(); job = OpenJob(sys.argv[1], began.set); began.wait(60)\n"
            "print(job._fit._child.process.pid, flush=True); threading.Event().wait()"
        )
        window = subprocess.Popen([sys.executable, "-c", code, TABLE], stdout=subprocess.PIPE)
        child = int(window.stdout.readline())
        os.kill(child, 0)
        window.kill()
        window.wait(LIMIT_S)
        window.stdout.close()
        end = time.monotonic() + LIMIT_S
        while running(child):
            assert time.monotonic() < end
            time.sleep(0.01)

    def test_any_name_of_a_file(self, tmp_path):
        table = write(tmp_path / os.fsdecode(b"-two words\n\xff.csv"), BROKEN)
        assert "words \\udcff.csv: line 3" in opened(table).fault  # as a terminal can show it

    def test_no_process(self, monkeypatch):
        monkeypatch.setattr(sys, "executable", "/no/python")
        assert "no process can be made" in opened(TABLE).fault

    def test_modules_of_the_present_folder_do_not_matter(self, tmp_path, monkeypatch):
        """A dropped table's folder may hold anything; the fit imports what this program does."""
        write(tmp_path / "json.py", "raise SystemExit('wrong module')")
        write(tmp_path / "numpy.py", "raise SystemExit('wrong module')")
        monkeypatch.chdir(tmp_path)
        assert "line 3" in opened(write(tmp_path / "table.csv", BROKEN)).fault


def run_python(code):
    words = [sys.executable, "-c", code, str(TABLE)]
    return subprocess.run(words, capture_output=True, text=True, timeout=LIMIT_S)


def running(pid):
    """Whether a process runs; one that has ended and waits to be asked about does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


class TestOwnMaterials:
    @pytest.mark.parametrize(
        ("name", "safe"),
        [
            ("Art paper 115 g/m2", "Art-paper-115-g-m2"),
            ("../../etc/passwd", "etc-passwd"),
            ("光沢紙 é", "光沢紙-é"),
            ("-o=x", "o-x"),
            (".hidden", "hidden"),
            ("a\nb\0c", "a-b-c"),
            ("", "material"),
            ("***", "material"),
            ("🎨", "material"),
            ("x" * 300, "x" * 40),
        ],
    )
    def test_safe_names(self, tmp_path, name, safe):
        assert safe_name(name) == safe
        file = write(tmp_path / f"{safe}-1.json", "mine")
        material = load_material(asset("materials", "uncoated.json"))
        named = dataclasses.replace(material, name=name)
        made = keep_material(named, tmp_path)
        assert made == tmp_path / f"{safe}-2.json"
        assert load_material(made) == named
        assert file.read_text() == "mine"
        assert len(list(tmp_path.iterdir())) == 2

    def test_many_at_once_each_get_their_own(self, tmp_path):
        material = load_material(asset("materials", "uncoated.json"))
        made = []
        threads = [
            threading.Thread(target=lambda: made.append(keep_material(material, tmp_path)))
            for _ in range(12)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(LIMIT_S)
        assert len(set(made)) == 12
        assert sorted(tmp_path.iterdir()) == sorted(made)
        assert all(load_material(file) == material for file in made)

    def test_failures_leave_nothing(self, tmp_path, monkeypatch):
        material = load_material(asset("materials", "uncoated.json"))
        write(tmp_path / "file", "")
        with pytest.raises(InputError, match="can't be written"):
            keep_material(material, tmp_path / "file" / "folder")

        def full(self, *args, **kwargs):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(Path, "write_text", full)
        with pytest.raises(InputError, match="No space left"):
            keep_material(material, tmp_path / "new")
        monkeypatch.undo()

        def broken(source, target):
            raise OSError(5, "Input/output error")

        monkeypatch.setattr(own_materials, "move_new", broken)
        with pytest.raises(InputError, match="Input/output error"):
            keep_material(material, tmp_path / "new")
        assert list((tmp_path / "new").iterdir()) == []
