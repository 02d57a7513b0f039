"""`relgloss view` as its users meet it, in processes of its own without a display.

What a screenshot shows, what is written and where, and the one line and exit status of everything
that can't be done.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import materials
import numpy as np
import pytest
from PIL import Image

from relgloss_view import cli
from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material, material_to_dict, save_material
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.state.matching import with_sample
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import save_state

ROOT = Path(cli.__file__).parents[1]
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
LONGEST_S = 60.0
PNG_HEAD = b"\x89PNG"
#: A window that is quick to draw and has room for both pictures.
SMALL = ("--window", "560x360")


def view(folder, *words, command=("view",), **env):
    """Exit status, standard output and standard error of the command in a folder of its own.

    It has no display unless one is named; what it keeps is kept beside the folder.
    """
    environment = {k: v for k, v in os.environ.items() if k not in DISPLAYS}
    environment |= {"RELGLOSS_HOME": str(folder.parent / "kept"), "PYTHONPATH": str(ROOT), **env}
    done = subprocess.run(
        [sys.executable, "-m", "relgloss_view.cli", *command, *(str(w) for w in words)],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
    )
    return done.returncode, done.stdout, done.stderr


@pytest.fixture
def folder(tmp_path):
    made = tmp_path / "work"
    made.mkdir()
    return made


def entries(folder):
    """Every entry below a folder with its content."""
    return {
        str(p.relative_to(folder)): p.read_bytes() if p.is_file() else None
        for p in folder.rglob("*")
    }


def refused(folder, *words, status=1, by=None, **options):
    """The one line of a refused command, which left the folder as it was."""
    before = entries(folder)
    code, out, err = (by or view)(folder, *words, **options)
    assert code == status, err
    assert out == ""
    assert err.count("\n") == 1, err
    assert err.startswith("relgloss: ")
    assert "Traceback" not in err
    assert entries(folder) == before
    return err


def shot(folder, *words):
    """The screenshot of a small window with some files opened, (H, W, 3)."""
    status, _, err = view(folder, *words, *SMALL, "--screenshot", "w.png", "--frames", 4)
    assert (status, err) == (0, "")
    with Image.open(folder / "w.png") as picture:
        pixels = np.asarray(picture).astype(int)
    (folder / "w.png").unlink()
    return pixels


class TestScreenshot:
    def test_picture_appears_and_nothing_else(self, folder):
        status, out, err = view(folder, "--screenshot", "out.png", "--frames", 3)
        assert (status, err) == (0, "")
        assert "out.png" in out
        assert os.listdir(folder) == ["out.png"]
        assert not (folder.parent / "kept").exists()  # it neither reads nor leaves a session
        with Image.open(folder / "out.png") as picture:
            assert picture.size == (1280, 800)
            assert picture.mode == "RGB"
            assert "icc_profile" in picture.info
            pixels = np.asarray(picture).astype(int)
        # The green papers, and the gray panels around them.
        green = (pixels[..., 1] > 100) & (pixels[..., 1] > 2 * pixels[..., 0])
        assert green[:, :640].mean() > 0.05
        assert green[:, 400:950].mean() > 0.05
        assert green[:, 960:].sum() < 1000  # the swatch of the colour picker, a few em wide

    @pytest.mark.parametrize(
        ("asked", "got"), [("321x123", (321, 123)), ("0x0", (1, 1)), ("1x1", (1, 1))]
    )
    def test_size_of_the_window(self, folder, asked, got):
        words = ("--screenshot", "o.PNG", "--window", asked, "--frames", 2)
        status, _, err = view(folder, *words)
        assert status == 0
        clamped = asked == "0x0"
        assert err == ("warning: --window 0x0: clamped to 1x1\n" if clamped else "")
        with Image.open(folder / "o.PNG") as picture:
            assert picture.size == got

    @pytest.mark.slow
    def test_window_beyond_every_limit(self, folder):
        """One frame settles where things stand; the pictures come with the second."""
        words = ("--screenshot", "o.png", "--window", "20000x20000", "--frames", 1)
        status, out, err = view(folder, *words)
        assert status == 0
        side = _largest_side()
        assert err == f"warning: --window 20000x20000: clamped to {side}x{side}\n"
        assert out == "o.png: the window after 1 frame\n"
        head = (folder / "o.png").read_bytes()[:24]
        assert head.startswith(PNG_HEAD)
        assert [int.from_bytes(head[at : at + 4], "big") for at in (16, 20)] == [side, side]

    @pytest.mark.slow
    def test_replaces_a_file_of_that_name(self, folder):
        (folder / "w.png").write_text("old")
        words = ("--screenshot", "w.png", *SMALL, "--frames", 1)
        assert view(folder, *words)[0] == 0
        assert (folder / "w.png").read_bytes().startswith(PNG_HEAD)
        assert os.listdir(folder) == ["w.png"]

    @pytest.mark.slow
    @pytest.mark.slow
    def test_text_of_another_size(self, folder):
        plain, same, larger = (
            shot(folder, *words) for words in ((), ("--font-scale", 1), ("--font-scale", 1.5))
        )
        np.testing.assert_array_equal(panel_of(plain), panel_of(same))
        assert (panel_of(plain) != panel_of(larger)).any(axis=-1).mean() > 0.02


def _largest_side():
    from relgloss_view.viewer.shell.platform import held_size

    width, height = held_size((20000, 20000))
    assert width == height
    return width


def panel_of(pixels):
    """The menu and the controls; the status line, with the time of a frame, is left out."""
    return np.concatenate([pixels[:20].reshape(-1, 3), pixels[:300, 340:].reshape(-1, 3)])


def pictures_of(pixels):
    """Where both pictures are in a small window, below their captions: reference, test."""
    pane = pixels[80:260]
    return pane[:, :158], pane[:, 172:330]


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """The window with nothing opened."""
    folder = tmp_path_factory.mktemp("plain") / "work"
    folder.mkdir()
    return shot(folder)


class TestFiles:
    def test_material_is_the_test_picture(self, folder, plain):
        save_material(materials.flat(0.2), folder / "flat.json")
        first, second = pictures_of(shot(folder, "flat.json"))
        before = pictures_of(plain)
        np.testing.assert_array_equal(first, before[0])
        assert (second != before[1]).any(axis=-1).mean() > 0.2
        # The same thing opened another way: by a scene that names it.
        file = str(folder / "flat.json")
        state = with_sample(State.initial(), "test", Sample(load_material(file), file=file))
        save_state(folder / "flat.toml", state)
        again = pictures_of(shot(folder, "flat.toml"))
        np.testing.assert_array_equal(again[1], second)
        np.testing.assert_array_equal(again[0], first)

    def test_a_built_in_paper_by_its_name(self, folder, plain):
        first, second = pictures_of(shot(folder, "uncoated"))
        np.testing.assert_array_equal(first, pictures_of(plain)[0])
        assert (second != pictures_of(plain)[1]).any(axis=-1).mean() > 0.1

    @pytest.mark.slow
    def test_a_built_in_paper_by_a_scene(self, folder):
        state = with_sample(State.initial(), "test", Sample.built_in("uncoated"))
        save_state(folder / "uncoated.toml", state)
        by_name, by_scene = (
            pictures_of(shot(folder, name))[1] for name in ("uncoated", "uncoated.toml")
        )
        np.testing.assert_array_equal(by_name, by_scene)

    @pytest.mark.slow
    @pytest.mark.slow
    def test_two_materials_are_reference_and_test(self, folder, plain):
        save_material(materials.flat(0.2), folder / "a.json")
        save_material(materials.flat(0.6), folder / "b.json")
        one = pictures_of(shot(folder, "b.json"))
        both = pictures_of(shot(folder, "a.json", "b.json"))
        np.testing.assert_array_equal(both[1], one[1])
        assert (both[0] != one[0]).any(axis=-1).mean() > 0.2

    @pytest.mark.slow
    def test_measurement_is_fitted_first(self, folder, plain):
        """It looks as the material does that `relgloss fit` makes of it."""
        paper = str(asset("papers", "uncoated.csv"))
        status, _, err = view(folder, paper, "-o", "m.json", command=("fit",))
        assert status == 0, err
        by_table, by_material = (pictures_of(shot(folder, f))[1] for f in (paper, "m.json"))
        np.testing.assert_array_equal(by_table, by_material)
        assert (by_table != pictures_of(plain)[1]).any(axis=-1).mean() > 0.1
        assert os.listdir(folder) == ["m.json"]
        kept = list((folder.parent / "kept").rglob("*.json"))
        assert len(kept) == 1  # the fit, where the user's own things belong

    def test_scene_is_all_that_is_shown(self, folder, plain):
        (folder / "s.toml").write_text('[sample]\nname = "uncoated"\n[shape]\nkind = "sphere"\n')
        for got, before in zip(
            pictures_of(shot(folder, "s.toml")), pictures_of(plain), strict=True
        ):
            assert (got != before).any(axis=-1).mean() > 0.05

    @pytest.mark.slow
    @pytest.mark.slow
    def test_order_of_scene_and_sample_does_not_matter(self, folder):
        save_material(materials.flat(0.2), folder / "m.json")
        (folder / "s.toml").write_text('[sample]\nname = "uncoated"\n[shape]\nkind = "sphere"\n')
        one, other = shot(folder, "m.json", "s.toml"), shot(folder, "s.toml", "m.json")
        np.testing.assert_array_equal(pictures_of(one), pictures_of(other))


class TestBadInput:
    """Found out before anything of a window is loaded, so that this process can do it, too."""

    @pytest.fixture
    def here(self, capsys, monkeypatch, folder):
        def run(folder, *words):
            try:
                status = cli.main(["view", *words])
            except SystemExit as end:
                status = int(end.code or 0)
            captured = capsys.readouterr()
            return status, captured.out, captured.err

        monkeypatch.setenv("RELGLOSS_HOME", str(folder.parent / "kept"))
        monkeypatch.chdir(folder)
        # None can't be imported.
        monkeypatch.setitem(sys.modules, "relgloss_view.viewer.shell.window", None)
        return run

    @pytest.mark.parametrize(
        ("words", "says"),
        [
            (["--frames", "0"], "--frames 0: expected 1 to"),
            (["--frames", "-5"], "--frames -5: expected 1 to"),
            (["--frames", "9" * 40], "expected 1 to"),
            (["--font-scale", "0.49"], "--font-scale 0.49: expected 0.5 to 4"),
            (["--font-scale", "4.01"], "--font-scale 4.01"),
            (["--font-scale", "nan"], "--font-scale nan"),
            (["--font-scale=-inf"], "--font-scale -inf"),
            (["--screenshot", "o.jpg"], "--screenshot o.jpg: expected a name that ends in .png"),
            (["--screenshot", "png"], "--screenshot png: expected"),
            (["--screenshot", ""], "--screenshot '': expected"),
            (["--screenshot", "folder.png"], "folder.png: is a folder"),
            (["--screenshot", "pipe.png"], "pipe.png: is not a regular file"),
            (["--screenshot", "gone/o.png"], "gone"),
            (["--screenshot", "/dev/full/o.png"], "/dev/full"),
            (["gone.csv"], "gone.csv: can't be read"),
            (["folder.png"], "folder.png"),
            (["empty.csv"], "empty.csv: the file is empty"),
            (["a.json", "a.json", "a.json"], "3 samples given: expected at most 2"),
            (["s.toml", "s.toml"], "2 scenes given: expected at most 1"),
            (["a.json", "gone.toml"], "gone.toml: can't be read"),
        ],
        ids=lambda v: " ".join(v)[:30] if isinstance(v, list) else "",
    )
    def test_one_line(self, folder, here, words, says):
        (folder / "folder.png").mkdir()
        os.mkfifo(folder / "pipe.png")
        (folder / "empty.csv").write_text("")
        (folder / "s.toml").write_text("[lamp]\nazimuth_deg = 20\n")
        save_material(materials.flat(), folder / "a.json")
        assert says in refused(folder, "--screenshot", "o.png", *words, by=here)

    @pytest.mark.parametrize(
        ("name", "content"),
        [
            ("s.toml", "[lamp]\nazimuth_deg = 'left'\n"),
            ("s.toml", "[lamp]\nazimuth_deg = 1\nazimuth_deg = 2\n"),
            ("s.toml", '[sample]\nmaterial = "gone.json"\n'),
            ("m.json", "{"),
            ("m.json", "[]"),
            ("m.json", None),  # a lobe that nature has not
            ("t.csv", "alpha_deg,beta_deg,gamma_deg,390\n1,2,3\n"),
            ("t.bsdf", "\0\1\2"),
            ("t.binary", "\0" * 64),
            ("t.txt", "dear diary"),
        ],
    )
    def test_damaged_file(self, folder, here, name, content):
        if content is None:
            good = material_to_dict(materials.paper("cast"))
            good["specular"][0]["s_deg"] = 0
            content = json.dumps(good)
        (folder / name).write_text(content)
        assert name in refused(folder, name, "--screenshot", "o.png", by=here)

    def test_table_cut_short(self, folder, here):
        text = asset("papers", "uncoated.csv").read_text(encoding="utf-8")
        (folder / "t.csv").write_text(text[: len(text) // 2].rsplit(",", 20)[0])
        assert "t.csv" in refused(folder, "t.csv", "--screenshot", "o.png", by=here)

    @pytest.mark.parametrize(
        "words", [["--frames", "x"], ["--window", "12"], ["--font-scale", "big"], ["--colour"]]
    )
    def test_wrong_usage_is_status_2(self, folder, here, words):
        status, out, err = here(folder, "--screenshot", "o.png", *words)
        assert (status, out) == (2, "")
        assert "usage: relgloss" in err
        assert entries(folder) == {}


class TestNoWindow:
    def test_no_display(self, folder):
        err = refused(folder, status=3)
        assert "there is no display" in err
        assert "relgloss view --screenshot OUT.png" in err
        assert not (folder.parent / "kept").exists()

    @pytest.mark.slow
    def test_no_command_is_view(self, folder):
        assert refused(folder, command=(), status=3) == refused(folder, status=3)

    @pytest.mark.parametrize("display", [":987", "nonsense", "no.such.host.invalid:0"])
    def test_display_that_is_not_there(self, folder, display):
        err = refused(folder, status=3, DISPLAY=display)
        assert f"Failed to open display {display}" in err
        assert "--screenshot OUT.png" in err

    def test_no_opengl(self, folder, tmp_path):
        """No EGL vendor: not even a screenshot can be drawn."""
        nothing = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/dev/null"}
        err = refused(folder, "--screenshot", "o.png", status=3, **nothing)
        assert "OpenGL" in err
        assert len(err) < 500
