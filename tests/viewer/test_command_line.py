"""The command for a side's picture: the real parser reads back the very same picture."""

from __future__ import annotations

import ast
import os
import shlex
import subprocess
import sys
from pathlib import Path

import materials
import pytest
import states
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.cli import _parser
from relgloss_view.commands.scene_options import scene_from
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.state.command_line import snapshot_command
from relgloss_view.viewer.state.state import SIDES, State


@pytest.fixture(scope="module")
def any_state(tmp_path_factory):
    folder = tmp_path_factory.mktemp("it's a place")
    return states.states(states.write_materials(folder / "m"), states.write_lamps(folder))


def words_of(command):
    """The words that a shell makes of a command; $'...' of control characters is bash's."""
    code = f"{shlex.quote(sys.executable)} -c 'import sys; print(ascii(sys.argv[1:]))'"
    done = subprocess.run(
        ["bash", "-c", f"{code} {command}"], capture_output=True, text=True, check=True
    )
    return ast.literal_eval(done.stdout)


def drawn_by(command):
    """What the command draws, and where it would write that."""
    words = words_of(command)
    assert words[0] == "relgloss"
    args = _parser(words[1:]).parse_args(words[1:])
    return scene_from(args), args.output


@settings(max_examples=100, deadline=None)
@given(
    data=st.data(),
    size=st.tuples(st.integers(1, 4000), st.integers(1, 4000)),
    side=st.sampled_from(SIDES),
    output=st.sampled_from(["a.png", "/tmp/two words.exr", "-o.png", "--c=1.png", "n\new 'x'.png"]),
)
def test_the_command_draws_the_same(any_state, data, size, side, output):
    state = data.draw(any_state)
    command = snapshot_command(state, side, size, output)
    expected = (state.scene(side), state.side(side).look, size)
    assert drawn_by(command) == (expected, output)
    words = words_of(command)[1:]
    assert _parser(words).parse_args(words).operator == state.presentation.operator(side)


def test_it_is_short_where_nothing_was_changed():
    command = snapshot_command(State.initial(), "test", (300, 200), "a.png")
    assert command == (
        "relgloss snapshot --sample matte-coated --edges smooth --dither ordered --sigma-n 2.0 "
        f"--c {State.initial().match.test_c} "
        "--grain-kind eye --grain-arcmin 1.5 --seed 0 --samples 1 --quality auto --size 300x200 "
        "-o a.png"
    )


def test_gain_and_offset_that_agree_only_together():
    """Neither may be set alone where the other stands at its default or a scene file's value."""
    state = State.initial().with_part("display", gain=0.3, offset=-0.2)
    command = snapshot_command(state, "test", (8, 8), "a.png")
    assert drawn_by(command)[0][0].display == state.setup.display
    swapped = command.replace("display.gain=0.3", "X").replace("display.offset=-0.2", "Y")
    swapped = swapped.replace("X", "display.offset=-0.2").replace("Y", "display.gain=0.3")
    assert swapped != command
    assert drawn_by(swapped)[0][0].display == state.setup.display


def test_a_relative_file_is_named_in_full(tmp_path, monkeypatch):
    (sample, *_) = states.write_materials(tmp_path)
    lamp = states.write_lamps(tmp_path)[0]
    monkeypatch.chdir(tmp_path)
    state = State.initial().with_sample("test", Sample(sample.material, file="plain.json"))
    state = state.with_part("lamp", illuminant="lamp.csv")
    command = snapshot_command(state, "test", (8, 8), "a.png")
    monkeypatch.chdir("/")
    scene = drawn_by(command)[0][0]
    assert scene.material == sample.material
    assert scene.lamp.illuminant == lamp


def test_a_shell_reads_it_as_the_parser_does(tmp_path):
    for sample in states.write_materials(tmp_path):
        state = State.initial().with_sample("test", sample)
        command = snapshot_command(state, "test", (8, 8), "-a b.png")
        assert drawn_by(command)[0][0].material == sample.material
        if command.isprintable() and "$'" not in command:
            assert words_of(command) == shlex.split(command)


class TestRefused:
    def test_a_sample_in_no_file(self):
        state = State.initial().with_sample("test", Sample(materials.paper("art")))
        with pytest.raises(InputError, match="save its material first"):
            snapshot_command(state, "test", (8, 8), "a.png")
        snapshot_command(state, "reference", (8, 8), "a.png")

    def test_a_sample_whose_file_is_gone(self, tmp_path):
        (sample, *_) = states.write_materials(tmp_path)
        Path(sample.file).unlink()
        with pytest.raises(InputError, match="is gone"):
            snapshot_command(State.initial().with_sample("test", sample), "test", (8, 8), "a.png")

    def test_names_that_are_not_utf8(self, tmp_path):
        file = tmp_path / os.fsdecode(b"\xff.json")
        file.write_text("{}")
        state = State.initial().with_sample("test", Sample(materials.paper("art"), file=str(file)))
        for refused in (
            (state, "test", (8, 8), "a.png"),
            (State.initial(), "test", (8, 8), "\udcff.png"),
            (State.initial().with_part("lamp", illuminant="\udcff.csv"), "test", (8, 8), "a.png"),
        ):
            with pytest.raises(InputError, match="rename") as caught:
                snapshot_command(*refused)
            str(caught.value).encode("utf-8")
