"""--lab in the commands: pictures, scene files and printed commands of a sample in a colour."""

from __future__ import annotations

import re
import shlex

import numpy as np
import PIL.Image
import pytest

from relgloss_view.cli import main
from relgloss_view.material.recolour import Colour, colour_of
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import read_scene_file

SIZE = ("--size", "48x48")


def run(capsys, *words):
    status = main([str(word) for word in words])
    out, err = capsys.readouterr()
    return status, out, err


def pixels(file):
    return np.asarray(PIL.Image.open(file))


def test_lobes_are_untouched_and_the_diffuse_part_is_not(renderer):
    own = Sample.built_in("art-coated")
    made = own.in_colour(Colour((50, 60, 20)))
    look = Look(sigma_n_deg=0.5)
    specular, diffuse = [], []
    for sample in (own, made):
        frame = renderer.render(Scene(sample.material), look, (64, 64))
        specular.append(frame.specular.copy())
        diffuse.append(frame.diffuse.copy())
    np.testing.assert_array_equal(*specular)
    assert np.max(specular[0]) > 0.0
    assert np.max(np.abs(diffuse[0] - diffuse[1])) > 0.1  # the control: the colour is another


def test_the_command_in_a_picture_draws_it_again(capsys, tmp_path):
    first, again = tmp_path / "first.png", tmp_path / "again.png"
    words = ("snapshot", "--sample", "art-coated", *SIZE)
    status, out, _ = run(capsys, *words, "--lab", "50,60,20", "-o", first)
    assert status == 0
    assert "art-coated, colour Lab 50 60 20 (synthetic)" in out
    text = PIL.Image.open(first).text
    command = next(value for value in text.values() if value.startswith("relgloss snapshot"))
    assert "--lab 50,60,20" in command
    assert run(capsys, *shlex.split(command.replace(str(first), str(again)))[1:])[0] == 0
    np.testing.assert_array_equal(pixels(first), pixels(again))
    assert run(capsys, *words, "-o", again)[0] == 0
    assert np.any(pixels(first) != pixels(again))


def test_a_scene_file_holds_the_colour(capsys, tmp_path):
    scene, by_file, by_words = (tmp_path / name for name in ("s.toml", "a.png", "b.png"))
    assert run(capsys, "match", "art-coated", "--lab", "50,60,20", *SIZE, "--write", scene)[0] == 0
    content = read_scene_file(scene)
    assert content.sample.name == "art-coated"
    assert content.sample.colour == Colour((50, 60, 20))
    assert content.reference.colour is None
    np.testing.assert_allclose(colour_of(content.sample.material), (50, 60, 20), atol=1e-6)
    assert run(capsys, "snapshot", "--scene", scene, *SIZE, "-o", by_file)[0] == 0
    c = f"{content.look.c!r}"
    words = ("--sample", "art-coated", "--lab", "50,60,20", "--c", c, "--scene", scene)
    assert run(capsys, "snapshot", *words, *SIZE, "-o", by_words)[0] == 0
    np.testing.assert_array_equal(pixels(by_file), pixels(by_words))
    # another colour, and a sample in its own
    for changed, expected in (
        (("--lab", "30,0,0"), "art-coated, colour Lab 30 0 0"),
        (("--sample", "uncoated"), "uncoated, green ink"),
    ):
        status, out, _ = run(capsys, "snapshot", "--scene", scene, *changed, *SIZE, "-o", by_words)
        assert status == 0
        assert f"{expected} (" in out


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        ("lab = [50, 60]", r"sample\.lab: expected three numbers"),
        ('lab = "red"', r"sample\.lab: expected three numbers"),
        ("lab = [200, 0, 0]", r"sample\.lab.*L from 0 to 100"),
        ("lab = [98, 40, 0]", r"sample\.lab 98, 40, 0: .*L can be at most"),
        ('lab_illuminant = "A"', r"sample\.lab_illuminant: expected lab = \[L, a, b\] beside it"),
        ("lab = [50, 0, 0]\nlab_illuminant = 3", r"sample\.lab_illuminant: "),
        ('lab = [50, 0, 0]\nlab_illuminant = "none.csv"', "none.csv"),
    ],
)
def test_faulty_colours_are_one_line(tmp_path, capsys, entries, message):
    file = tmp_path / "s.toml"
    file.write_text(f'[sample]\nname = "art-coated"\n{entries}\n')
    status, _, err = run(capsys, "snapshot", "--scene", file, *SIZE, "-o", tmp_path / "a.png")
    assert status == 1
    assert err.count("\n") == 1
    assert re.search(message, err), err


def test_other_commands_take_it(capsys):
    words = ("--lab", "50,60,20")
    status, out, _ = run(capsys, "gloss", "art-coated", *words)
    assert status == 0
    assert out.startswith("art-coated, colour Lab 50 60 20")
    assert run(capsys, "plan", "--sample", "art-coated", *words, *SIZE)[0] == 0
    status, _, err = run(capsys, "gloss", "art-coated", "--lab", "98,40,0")
    assert status == 1
    assert "L can be at most" in err
    status, _, err = run(capsys, "gloss", "art-coated", "--lab", "98,40")
    assert status == 2
    assert "expected L,a,b such as 50,60,20" in err
