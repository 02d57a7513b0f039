"""The command as its users meet it: files, exit statuses, one-line faults, nothing half written."""

from __future__ import annotations

import io
import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import materials
import numpy as np
import pytest
from PIL import Image, ImageCms

from relgloss_view import cli
from relgloss_view.base.resources import asset
from relgloss_view.base.version import __version__
from relgloss_view.material.files import load_material, material_to_dict, save_material

OpenEXR = pytest.importorskip("OpenEXR")
PAPER = str(asset("papers", "art-coated.csv"))


def run(capsys, *words):
    """Exit status, standard output, standard error of a command line."""
    try:
        status = cli.main([str(w) for w in words])
    except SystemExit as end:  # argparse's usage errors
        status = int(end.code or 0)
    captured = capsys.readouterr()
    return status, captured.out, captured.err


def refused(capsys, tmp_path, *words, status=1):
    """The one line of a refused command that left the folder as it was."""
    before = sorted(p.name for p in tmp_path.iterdir())
    code, out, err = run(capsys, *words)
    assert code == status, err
    assert out == ""
    assert "Traceback" not in err
    assert sorted(p.name for p in tmp_path.iterdir()) == before
    if status == 1:
        assert err.startswith("relgloss: ")
        assert err.count("\n") == 1
    return err


class TestSnapshot:
    def test_png(self, capsys, tmp_path):
        path = tmp_path / "art.png"
        status, out, _ = run(
            capsys, "snapshot", "--sample", "art-coated", "--sigma-n", 1, "--c-fraction", 0.5,
            "--size", "64x48", "--seed", 3, "-o", path,
        )  # fmt: skip
        assert status == 0
        assert "art.png" in out
        with Image.open(path) as picture:
            assert picture.size == (64, 48)
            assert picture.mode == "RGB"
            profile = ImageCms.ImageCmsProfile(io.BytesIO(picture.info["icc_profile"]))
            assert "sRGB" in ImageCms.getProfileDescription(profile)
            numbers = json.loads(picture.info["Parameters"])
            command = picture.info["Command"]
            pixels = np.asarray(picture)
        assert numbers["sigma_n_deg"] == 1.0
        assert numbers["c"] == pytest.approx(0.5 * numbers["c_max"])
        assert "synthetic" in numbers["source"]
        assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 100
        # The command in the file draws the same picture.
        words = shlex.split(command)
        assert words[0] == "relgloss"
        path.rename(tmp_path / "first.png")
        assert run(capsys, *words[1:])[0] == 0
        with Image.open(path) as again:
            np.testing.assert_array_equal(np.asarray(again), pixels)

    def test_exr_holds_what_others_count_on(self, capsys, tmp_path):
        path = tmp_path / "art.exr"
        words = ("--sample", "art-coated", "--sigma-n", 2, "--c", 0.3, "--size", "64x48")
        assert run(capsys, "snapshot", *words, "-o", path)[0] == 0
        with OpenEXR.File(str(path), separate_channels=True) as file:
            header = dict(file.header())  # the file empties its own when it closes
            layers = {name: channel.pixels for name, channel in file.channels().items()}
        names = ["R", "G", "B", "A", "samples.Y", "Ld.Y", "Ls.Y"]
        names += ["Lab.L", "Lab.a_star", "Lab.b_star"]
        for layer in ("diffuse", "specular", "N", "Np", "P"):
            names += [f"{layer}.{axis}" for axis in "XYZ"]
        assert set(layers) == set(names)
        assert header["whiteLuminance"] == pytest.approx(110.0)
        assert header["c"] == pytest.approx(0.3)
        assert header["c_max"] < header["c_max_eq4"] * 1.01
        assert header["sigma_n_deg"] == pytest.approx(2.0)
        np.testing.assert_allclose(header["eye_m"], [0, 0, 0.6], atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(header["lamp_m"]), 1.0, rtol=1e-6)
        assert {"seed", "clip_count", "relgloss_version"} <= set(header)
        on = layers["samples.Y"] > 0
        lit = layers["Ld.Y"] + 0.3 * layers["Ls.Y"]
        np.testing.assert_allclose(layers["Lab.L"][on], lit[on], atol=2e-3)
        # Row 0 is the top: the upper rows see points with positive y.
        rows = np.where(on.any(axis=1))[0]
        assert layers["P.Y"][rows[0]][on[rows[0]]].mean() > 0.03
        # The lamp at 50 degrees lights the right side.
        assert layers["diffuse.Y"][:, 32:].mean() > 3 * layers["diffuse.Y"][:, :32].mean()
        unit = np.sqrt(sum(layers[f"Np.{axis}"] ** 2 for axis in "XYZ"))
        np.testing.assert_allclose(unit[on], 1.0, atol=1e-5)

    def test_reference_backend_draws_the_same(self, capsys, tmp_path):
        pictures = []
        for backend in ("auto", "reference"):
            path = tmp_path / f"{backend}.png"
            words = ("--sample", "uncoated", "--size", "48x48", "--backend", backend, "-o", path)
            assert run(capsys, "snapshot", *words)[0] == 0
            with Image.open(path) as picture:
                pictures.append(np.asarray(picture).astype(int))
        assert np.max(np.abs(pictures[0] - pictures[1])) <= 1

    def test_json_is_one_object(self, capsys, tmp_path):
        words = ("snapshot", "--size", "32x32", "--json", "-o", tmp_path / "a.png")
        status, out, err = run(capsys, *words)
        assert (status, err) == (0, "")
        numbers = json.loads(out)
        assert numbers["sample"].startswith("matte-coated")
        assert numbers["size"] == [32, 32]

    def test_scene_file_and_settings(self, capsys, tmp_path):
        save_material(materials.paper("cast"), tmp_path / "m.json")
        scene = tmp_path / "scene.toml"
        scene.write_text(
            '[sample]\nmaterial = "m.json"\n[lamp]\nazimuth_deg = 80\n[shape]\nkind = "sphere"\n'
            "[look]\nsigma_n_deg = 1.5\n"
        )
        words = ("snapshot", "--scene", scene, "--set", "lamp.distance_m=2", "--size", "32x32")
        status, out, err = run(capsys, *words, "--json", "-o", tmp_path / "a.exr")
        assert status == 0, err
        numbers = json.loads(out)
        assert numbers["sample"] == "cast"
        assert numbers["shape"]["kind"] == "sphere"
        assert numbers["sigma_n_deg"] == 1.5
        assert np.linalg.norm(numbers["lamp_m"]) == pytest.approx(2.0)
        assert numbers["lamp_m"][0] > 1.9

    def test_samples_of_a_narrow_highlight(self, capsys, tmp_path):
        words = ("snapshot", "--sample", "cast-coated", "--size", "48x48", "--json")
        numbers = {}
        for samples in ("1", "auto"):
            _, out, _ = run(capsys, *words, "--samples", samples, "-o", tmp_path / "a.png")
            numbers[samples] = json.loads(out)
        assert "narrow" in numbers["1"]["warnings"][0]
        assert not numbers["auto"]["warnings"]
        assert numbers["auto"]["samples"] > 1

    def test_matched_settings(self, capsys, tmp_path):
        words = ("snapshot", "--sample", "uncoated", "--published", "--size", "32x32", "--json")
        numbers = json.loads(run(capsys, *words, "-o", tmp_path / "a.png")[1])
        assert numbers["sigma_n_deg"] == 2.0
        assert numbers["c"] == pytest.approx(numbers["c_max"] / 6)

    def test_poor_fit_is_told_on_the_picture(self, capsys, tmp_path):
        content = material_to_dict(materials.paper("cast"))
        content["fit"] = {"quality": "poor", "warnings": ["no model describes this sample"]}
        (tmp_path / "m.json").write_text(json.dumps(content))
        words = ("snapshot", "--material", tmp_path / "m.json", "--size", "32x32")
        _, _, err = run(capsys, *words, "-o", tmp_path / "a.png")
        assert "warning: no model describes this sample" in err
        with Image.open(tmp_path / "a.png") as picture:
            numbers = json.loads(picture.info["Parameters"])
        assert numbers["fit_quality"] == "poor"
        assert numbers["warnings"][0] == "no model describes this sample"


BAD_SNAPSHOTS = [
    (["--size", "0x0"], "size 0x0"),
    (["--size", "100000x100000"], "size 100000x100000"),
    (["--sample", "glass"], "glass"),
    (["--material", "absent.json"], "absent.json"),
    (["--scene", "absent.toml"], "absent.toml"),
    (["--sigma-n", "-1"], "sigma_n_deg"),
    (["--sigma-n", "nan"], "sigma_n_deg"),
    (["--c", "-0.1"], "look.c"),
    (["--c-fraction", "inf"], "c_fraction"),
    (["--samples", "0"], "samples"),
    (["--seed", "-1"], "seed"),
    (["--set", "lamp.distance_m=0"], "lamp.distance_m"),
    (["--set", "lamp.colour=red"], "lamp.colour"),
    (["--set", "sun.azimuth=1"], "sun.azimuth"),
    (["--set", "shape.kind=teapot"], "shape.kind"),
    (["--set", "lamp.illuminant=nothing"], "nothing"),
    (["--set", "display.primaries_xy=3"], "display.primaries_xy"),
    (["--set", "display.white_xy=(0.3, 0)"], "display.white_xy"),
    (["--published", "--material", "m.json"], "--published"),
]


class TestBadInput:
    @pytest.mark.parametrize(("words", "place"), BAD_SNAPSHOTS, ids=lambda v: str(v)[:30])
    def test_snapshot(self, capsys, tmp_path, monkeypatch, words, place):
        monkeypatch.chdir(tmp_path)
        save_material(materials.paper("cast"), tmp_path / "m.json")
        assert place in refused(capsys, tmp_path, "snapshot", *words, "-o", tmp_path / "a.png")

    @pytest.mark.parametrize(
        ("key", "value"), [("s_deg", 0), ("refractive_index", 0.99), ("strength", -1)]
    )
    def test_material_that_nature_has_not(self, capsys, tmp_path, key, value):
        content = material_to_dict(materials.paper("cast"))
        content["specular"][0][key] = value
        file = tmp_path / "m.json"
        file.write_text(json.dumps(content))
        err = refused(capsys, tmp_path, "snapshot", "--material", file, "-o", tmp_path / "a.png")
        assert f"m.json: specular[0].{key}" in err
        assert "expected" in err

    @pytest.mark.parametrize("target", ["no/such/folder/a.png", ".", "a.jpg", "a"])
    def test_unwritable_output(self, capsys, tmp_path, monkeypatch, target):
        monkeypatch.chdir(tmp_path)
        refused(capsys, tmp_path, "snapshot", "--size", "16x16", "-o", target)

    def test_full_disk(self, capsys):
        assert run(capsys, "snapshot", "--size", "16x16", "-o", "/dev/full/a.png")[0] == 1

    @pytest.mark.parametrize(
        "text",
        [
            "x", "[lamp]\nazimuth_deg = true\n", "[lamp]\nazimut = 1\n", "[sun]\n", "sample = 3\n",
            "[look]\nc = 1\nc_fraction = 1\n", "[look]\nsamples = 2.5\n",
            "[lamp]\nilluminant = 3\n", "[eye]\ndistance_m = nan\n",
            '[sample]\nname = "x"\n', '[sample]\nmaterial = "../gone.json"\n',
            "[display]\nprimaries_xy = [[0.1, 0.1], [0.2, 0.2], [0.3, 0.3]]\n",
        ],
    )  # fmt: skip
    def test_scene_files(self, capsys, tmp_path, text):
        file = tmp_path / "s.toml"
        file.write_text(text)
        err = refused(capsys, tmp_path, "snapshot", "--scene", file, "-o", tmp_path / "a.png")
        assert "s.toml" in err

    @pytest.mark.parametrize(
        "words",
        [
            ["nonsense"], ["snapshot"], ["snapshot", "-o", "a.png", "--size", "12"],
            ["snapshot", "-o", "a.png", "--c", "1", "--c-fraction", "1"],
            ["snapshot", "-o", "a.png", "--backend", "vulkan"], ["fit"], ["fit", "a.csv"],
        ],
    )  # fmt: skip
    def test_wrong_usage_is_status_2(self, capsys, tmp_path, monkeypatch, words):
        monkeypatch.chdir(tmp_path)
        assert "usage: relgloss" in refused(capsys, tmp_path, *words, status=2)


class TestFit:
    def test_table_to_picture(self, capsys, tmp_path):
        material, report = tmp_path / "art.json", tmp_path / "art.png"
        status, out, _ = run(capsys, "fit", PAPER, "-o", material, "--report", report)
        assert status == 0
        assert "art.json" in out
        assert load_material(material).fit.quality == "good"
        with Image.open(report) as picture:
            assert min(picture.size) > 600
        picture = tmp_path / "picture.png"
        words = ("snapshot", "--material", material, "--size", "32x32", "-o", picture)
        assert run(capsys, *words)[0] == 0

    def test_json(self, capsys, tmp_path):
        status, out, _ = run(
            capsys, "fit", PAPER, "-o", tmp_path / "a.json", "--model", "lobe", "--json"
        )
        content = json.loads(out)
        assert status == 0
        assert content["fit"]["chosen"] == "lobe"
        assert len(content["specular"]) == 1

    @pytest.mark.parametrize(
        ("words", "place"),
        [
            (["--refractive-index", "0.9"], "--refractive-index"),
            (["--refractive-index", "nan"], "--refractive-index"),
            (["--aperture-sd-deg", "-1", "0"], "--aperture-sd-deg"),
            (["--seed", "-1"], "--seed"),
            (["--report", "r.pdf"], "r.pdf"),
            (["--report", "gone/r.png"], "gone"),
        ],
    )
    def test_bad_options(self, capsys, tmp_path, monkeypatch, words, place):
        monkeypatch.chdir(tmp_path)
        err = refused(capsys, tmp_path, "fit", PAPER, *words, "-o", tmp_path / "a.json")
        assert place in err

    def test_broken_table_leaves_no_material(self, capsys, tmp_path):
        lines = Path(PAPER).read_text(encoding="utf-8").splitlines()
        lines[100] = lines[100].replace(",", ",nan,", 1).rsplit(",", 1)[0]
        table = tmp_path / "broken.csv"
        table.write_text("\n".join(lines))
        err = refused(capsys, tmp_path, "fit", table, "-o", tmp_path / "a.json")
        assert "broken.csv" in err
        assert "101" in err


class TestGrid:
    def test_stimuli_sheet_and_manifest(self, capsys, tmp_path):
        from relgloss_view.gloss.match import Reference, matched_point
        from relgloss_view.picture.scene.sample import load_sample

        folder, art = tmp_path / "stimuli", load_sample("art-coated")
        words = ("grid", "--sample", "art-coated", "--size", "40x40", "-o", folder)
        assert run(capsys, *words)[0] == 0
        manifest = json.loads((folder / "manifest.json").read_text())
        assert len(manifest["stimuli"]) == 42
        assert {s["sigma_n_deg"] for s in manifest["stimuli"]} == {0, 0.5, 1, 1.5, 2, 2.5, 3}
        for stimulus in manifest["stimuli"]:
            assert stimulus["c"] == pytest.approx(stimulus["c_sixths"] / 6 * stimulus["c_max"])
            wanted = matched_point(Reference.default(), art, stimulus["sigma_n_deg"]).c
            assert stimulus["of_match"] == pytest.approx(stimulus["c"] / wanted)
        assert manifest["reference"] == "cast-coated"
        assert len(list(folder.glob("sigma_*.png"))) == 42
        assert len(list(folder.iterdir())) == 44
        assert (manifest["format"], manifest["version"]) == ("relgloss-grid", 1)
        assert manifest["relgloss_version"] == __version__
        with Image.open(folder / "contact-sheet.png") as sheet:
            assert re.search(r"c_max [0-9.]+", sheet.info["Title"])
        assert (folder / "contact-sheet.png").is_file()
        # A stimulus is what its command draws.
        one = folder / manifest["stimuli"][20]["file"]
        with Image.open(one) as picture:
            command, pixels = picture.info["Command"], np.asarray(picture)
        words = shlex.split(command)[1:]
        words[words.index("-o") + 1] = str(tmp_path / "again.png")
        assert run(capsys, *words)[0] == 0
        with Image.open(tmp_path / "again.png") as again:
            np.testing.assert_array_equal(np.asarray(again), pixels)

    def test_again_into_the_same_folder(self, capsys, tmp_path):
        folder = tmp_path / "stimuli"
        words = ("grid", "--size", "16x16", "-o", folder)
        assert run(capsys, *words)[0] == 0
        (folder / "notes.txt").write_text("mine")
        first = (folder / "manifest.json").read_text()
        assert run(capsys, *words, "--sample", "uncoated")[0] == 0
        assert (folder / "manifest.json").read_text() != first
        assert (folder / "notes.txt").read_text() == "mine"
        assert len(list(folder.iterdir())) == 45

    @pytest.mark.parametrize("exists", [False, True])
    @pytest.mark.parametrize("frames", [0, 7])
    def test_what_is_not_finished_leaves_nothing(
        self, capsys, tmp_path, monkeypatch, exists, frames
    ):
        from relgloss_view.picture.output.writers import Writers

        folder = tmp_path / "deep" / "stimuli"
        if exists:
            folder.mkdir(parents=True)
            (folder / "manifest.json").write_text('{"format": "relgloss-grid"}')
        before = sorted(tmp_path.rglob("*"))
        real, drawn = Writers.save, []

        def interrupt(*args, **options):
            if len(drawn) == frames:
                raise KeyboardInterrupt
            drawn.append(args)
            real(*args, **options)

        monkeypatch.setattr(Writers, "save", interrupt)
        status, _, err = run(capsys, "grid", "--size", "16x16", "-o", folder)
        assert status == 130
        assert err == "relgloss: interrupted; no file is left half written\n"
        assert sorted(tmp_path.rglob("*")) == before

    @pytest.mark.parametrize("text", ['{"name": "a web app"}', "[]", "x", "[" * 9999])
    def test_somebody_elses_manifest(self, capsys, tmp_path, text):
        (tmp_path / "manifest.json").write_text(text)
        err = refused(capsys, tmp_path, "grid", "--size", "16x16", "-o", tmp_path)
        assert "choose a new folder, or move this one away" in err
        assert (tmp_path / "manifest.json").read_text() == text
        assert "empty name" in refused(capsys, tmp_path, "grid", "--size", "16x16", "-o", "")

    def test_file_in_the_way(self, capsys, tmp_path):
        (tmp_path / "taken").write_text("mine")
        refused(capsys, tmp_path, "grid", "--size", "16x16", "-o", tmp_path / "taken")
        assert (tmp_path / "taken").read_text() == "mine"


class TestDoctor:
    def test_json(self, capsys):
        status, out, _ = run(capsys, "doctor", "--json")
        assert status == 0
        findings = json.loads(out)
        assert findings["chosen"] in ("egl", "osmesa")
        found = findings["opengl"][findings["chosen"]]
        assert found["usable"]
        assert found["largest_error_lab"] < 0.1
        assert any("DejaVuSans" in path for path in findings["fonts"]["files"])

    def test_scripts_without_a_font_and_what_mends_it(self, capsys, monkeypatch):
        from relgloss_view.base import fonts

        monkeypatch.setattr(fonts, "_of_the_system", list)
        fonts.font_files.cache_clear()
        try:
            lost = json.loads(run(capsys, "doctor", "--json")[1])["fonts"]["missing"]
            text = run(capsys, "doctor")[1]
        finally:
            fonts.font_files.cache_clear()
        assert lost == ["Japanese", "Chinese", "Korean"]
        assert "fonts: names in Latin, Greek, Cyrillic, by " in text
        assert "apt install fonts-noto-cjk" in text

    def test_without_opengl_it_says_so(self, tmp_path):
        """In a process of its own that finds no EGL vendor and no OSMesa: status 3, one line."""
        env = {
            **os.environ,
            "__EGL_VENDOR_LIBRARY_FILENAMES": "/dev/null",
            "GALLIUM_DRIVER": "none",
        }
        env["LIBGL_DRIVERS_PATH"] = str(tmp_path)
        script = (
            "import sys, glfw; glfw.create_window = lambda *a: None\n"
            "from relgloss_view.cli import main; sys.exit(main(sys.argv[1:]))"
        )
        words = ["snapshot", "--size", "16x16", "-o", "a.png"]
        done = subprocess.run(
            [sys.executable, "-c", script, *words],
            env=env,
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 3, done.stderr
        assert "no OpenGL 3.3 context" in done.stderr
        assert "apt-get install" in done.stderr
        assert "Traceback" not in done.stderr
        assert list(tmp_path.iterdir()) == []


def test_a_working_folder_that_is_gone(capsys, tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    assert cli.main(["gloss", "art-coated"]) == 1
    told = capsys.readouterr().err
    monkeypatch.chdir(tmp_path)
    assert told.count("\n") == 1
    assert "the working folder can't be used (No such file or directory); change to" in told


def test_a_library_that_is_broken_is_one_line(capsys, tmp_path, monkeypatch):
    fault = ImportError("no PIL", name="PIL")
    monkeypatch.setattr(cli, "_run", lambda words: (_ for _ in ()).throw(fault))
    assert cli.main(["snapshot"]) == 1
    told = capsys.readouterr().err
    assert told == (
        "relgloss: a library can't be loaded (no PIL); install relgloss again: "
        "`relgloss doctor` lists what is missing\n"
    )
    # The control: a mistake of the program is not blamed on the installation.
    fault = ImportError("cannot import name", name="relgloss_view.cli")
    with pytest.raises(ImportError):
        cli.main(["snapshot"])


def test_interrupted(capsys, tmp_path, monkeypatch):
    from relgloss_view.picture.output import export

    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(export, "save_png", interrupt)
    status, _, err = run(capsys, "snapshot", "--size", "16x16", "-o", tmp_path / "a.png")
    assert status == 130
    assert "interrupted" in err
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("command", cli.COMMANDS)
def test_help_has_an_example(capsys, command):
    status, out, _ = run(capsys, command, "--help")
    assert status == 0
    assert f"example: relgloss {command}" in " ".join(out.split())
