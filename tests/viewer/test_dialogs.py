"""The program's own file dialog, driven by its labels in a window without a display."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import driven
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.viewer.files import folders
from relgloss_view.viewer.panels.file_dialogs import native_available

ODD = "a\n  b\udcff.json"
OPEN, SAVE = "//Open file", "//Save scene as"


def entry(name):
    return f"{OPEN}/**/##{name}"


# --- scripts, run in the window's process ---------------------------------------------------------


def opens_by_double_click(hand, found):
    hand.app.files.open()
    hand.frames(3)
    dialog = hand.app.files.dialogs._own
    found["listed"] = [e.name for e in dialog._list().entries]
    hand.double_click(entry("sub\\/"))
    found["entered"] = os.path.basename(dialog.folder)
    hand.double_click(entry("matte ## 10.json"))
    found["open"] = hand.app.files.dialogs.open
    found["opened"] = hand.until(lambda: hand.model.state.test.sample.file is not None)
    found["file"] = hand.model.state.test.sample.file
    found["steps"] = len(hand.model.history._past)
    found["folder"] = os.path.basename(hand.app.files.dialogs.folder)


def goes_up_and_shows_more(hand, found):
    from imgui_bundle import imgui

    hand.app.files.open()
    hand.frames(3)
    dialog = hand.app.files.dialogs._own
    found["began"] = os.path.basename(dialog.folder)
    hand.click(f"{OPEN}/Up")
    found["up"] = dialog.folder == str(hand.folder)
    hand.click(f"{OPEN}/All files", f"{OPEN}/Hidden")
    found["listed"] = [e.name for e in dialog._list().entries]
    hand.click(f"{OPEN}/Home")
    found["home"] = dialog.folder == str(hand.folder / "home")
    hand.key(imgui.Key.escape)
    found["open"] = hand.app.files.dialogs.open


def chooses_by_keys(hand, found):
    from imgui_bundle import imgui

    hand.app.files.dialogs.folder = str(hand.folder / "sub")
    hand.app.files.open()
    hand.frames(4)
    dialog = hand.app.files.dialogs._own
    hand.key(imgui.Key.down_arrow)
    hand.key(imgui.Key.down_arrow)
    found["name"] = dialog.name.text
    hand.key(imgui.Key.up_arrow)
    found["name_above"] = dialog.name.text
    hand.key(imgui.Key.enter)
    found["open"] = hand.app.files.dialogs.open
    hand.until(lambda: "matte-2" in (hand.model.state.test.sample.file or ""))
    found["file"] = hand.model.state.test.sample.file


def opens_odd_names(hand, found):
    """A name that no text field can hold: not UTF-8, with a line break and two spaces."""
    from imgui_bundle import imgui

    hand.app.files.dialogs.folder = str(hand.folder / "odd")
    hand.app.files.open()
    hand.frames(4)
    hand.key(imgui.Key.down_arrow)
    found["shown"] = hand.app.files.dialogs._own.name.text
    hand.key(imgui.Key.enter)
    hand.until(lambda: "odd" in (hand.model.state.test.sample.file or ""))
    found["same"] = hand.model.state.test.sample.file == str(hand.folder / "odd" / ODD)
    hand.app.files.save_as()  # begins beside the scene
    hand.frames(3)
    # What was asked about one name is no longer asked when another is typed.
    hand.type(f"{SAVE}/##name", "taken.toml", enter=True)
    found["asked"] = hand.app.files.dialogs._own._message()
    hand.type(f"{SAVE}/##name", "other.toml")
    found["then"] = hand.app.files.dialogs._own._message()
    # Nor is the name lost on the way to another folder.
    hand.double_click(f"{SAVE}/**/##sub\\/")
    hand.click(f"{SAVE}/Up", f"{SAVE}/Home")
    found["on the way"] = hand.app.files.dialogs._own.name.text
    hand.click(f"{SAVE}/Cancel")


def tells_faults(hand, found):
    hand.app.files.open()
    hand.frames(3)
    dialog = hand.app.files.dialogs._own
    for name, typed in (
        ("missing", "nothing-of-that-name.toml"),
        ("empty", ""),
        ("pipe", "/dev/null/x"),
    ):
        hand.type(f"{OPEN}/##name", typed, enter=True)
        found[name] = dialog._message()
        assert hand.app.files.dialogs.open
    dialog.name.text = 300 * "x"  # typing it takes long
    hand.click(f"{OPEN}/Open")
    found["long"] = dialog._message()
    dialog.folder = str(hand.folder)  # a folder that is typed is gone into
    hand.type(f"{OPEN}/##name", "sub", enter=True)
    found["folder"] = os.path.basename(dialog.folder)
    hand.click(f"{OPEN}/Cancel")
    found["open"] = hand.app.files.dialogs.open
    found["said"] = hand.said()


def saves_and_asks_before_it_replaces(hand, found):
    files = hand.app.files
    files.dialogs.folder = str(hand.folder)
    files.save()
    hand.frames(3)
    hand.type(f"{SAVE}/##name", "taken", enter=True)
    found["asked"] = files.dialogs._own._message()
    hand.click(f"{SAVE}/Keep it")
    found["kept"] = (hand.folder / "taken.toml").read_text()
    hand.type(f"{SAVE}/##name", "nowhere/x.toml", enter=True)
    found["nowhere"] = files.dialogs._own._message()
    hand.type(f"{SAVE}/##name", "fresh")
    hand.click(f"{SAVE}/Save")
    found["fresh"] = (hand.folder / "fresh.toml").read_text()
    files.save_as()
    hand.frames(3)
    found["suggested"] = files.dialogs._own.name.text
    hand.type(f"{SAVE}/##name", "taken.toml", enter=True)
    hand.click(f"{SAVE}/Replace")
    found["replaced"] = (hand.folder / "taken.toml").read_text()
    files.save()  # now it knows where
    hand.frames(2)
    found["open"] = files.dialogs.open
    found["path"] = files.scene_path


def leaves_haploscopic_mode_to_be_seen(hand, found):
    hand.model.set_part("presentation", haploscopic=True)
    hand.frames(3)
    hand.app.files.open()
    hand.frames(3)
    found["seen"] = hand.there(f"{OPEN}/Cancel")
    # The same question again is the same dialog; another takes its place.
    first = hand.app.files.dialogs._own
    hand.app.files.open()
    hand.frames(2)
    found["same"] = hand.app.files.dialogs._own is first
    hand.app.files.save_as()
    hand.frames(3)
    found["other"] = hand.app.files.dialogs._own.question.title
    hand.click(f"{SAVE}/Cancel")
    found["open"] = hand.app.files.dialogs.open


def shows_progress_and_cancels(hand, found):
    from relgloss_view.viewer.shell import file_actions as files

    real, files.OpenJob = files.OpenJob, driven.FakeJob
    made = driven.FakeJob.made
    before = hand.model.state
    hand.app.files.open_path("/tables/first.csv")
    hand.app.files.open_path("/tables/second.csv")
    found["shown"] = hand.until(lambda: hand.there("//Opening/Cancel"))
    found["due"] = hand.app.files.due_s()
    hand.click("//Opening/Cancel")
    found["next"] = hand.until(lambda: len(made) == 2)
    found["jobs"] = [job.path for job in made]
    made[-1].end(fault="/tables/second.csv: no table")
    hand.until(lambda: hand.app.files._job is None)
    found["same"] = hand.model.state is before
    found["said"] = hand.said()[-2:]
    files.OpenJob = real


SCRIPTS = (
    opens_by_double_click,
    goes_up_and_shows_more,
    chooses_by_keys,
    tells_faults,
    saves_and_asks_before_it_replaces,
    leaves_haploscopic_mode_to_be_seen,
    shows_progress_and_cancels,
    opens_odd_names,
)


# --- tests ----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    import materials

    from relgloss_view.material.files import save_material

    folder = tmp_path_factory.mktemp("dialogs")
    (folder / "sub").mkdir()
    for name in ("matte-2.json", "matte ## 10.json"):
        save_material(materials.paper("matte"), folder / "sub" / name)
    (folder / "odd").mkdir()
    save_material(materials.paper("art"), folder / "odd" / ODD)
    (folder / "notes.odt").write_text("not to be listed at first")
    (folder / ".dot.toml").write_text("")
    (folder / "taken.toml").write_text("# held before\n")
    return folder


@pytest.fixture(scope="module")
def found(place):
    return driven.drive("test_dialogs", place)


def test_a_double_click_opens_a_file(found, place):
    got = found["opens_by_double_click"]
    assert got["listed"] == ["home", "odd", "sub", "run.json", "taken.toml"]
    assert got["entered"] == "sub"
    assert not got["open"]
    assert got["opened"]
    assert got["file"] == str(place / "sub" / "matte ## 10.json")
    assert got["steps"] == 1
    assert got["folder"] == "sub"


def test_it_begins_where_the_last_one_ended_and_finds_the_rest(found):
    got = found["goes_up_and_shows_more"]
    assert got["began"] == "sub"
    assert got["up"]
    assert {"notes.odt", ".dot.toml"} <= set(got["listed"])
    assert got["home"]
    assert not got["open"]


def test_keys_alone_choose_a_file(found, place):
    got = found["chooses_by_keys"]
    assert got["name"] == "matte-2.json"
    assert got["name_above"] == "matte ## 10.json"
    assert not got["open"]


def test_names_that_no_text_can_hold(found):
    got = found["opens_odd_names"]
    assert got["shown"] == "a b\\udcff.json"
    assert got["same"]
    assert got["asked"] == "taken.toml is already there. Replace it?"
    assert got["then"] == ""
    assert got["on the way"] == "other.toml"


def test_faults_are_one_line_in_the_dialog(found):
    got = found["tells_faults"]
    assert "No such file" in got["missing"]
    assert "too long" in got["long"]
    assert "type a name" in got["empty"]
    assert "Not a directory" in got["pipe"]
    for name in ("missing", "long", "empty", "pipe"):
        assert got[name].startswith("! ")
        assert "\n" not in got[name]
    assert got["folder"] == "sub"
    assert not got["open"]
    assert not any(fault for _, fault in got["said"])


def test_saving_asks_before_it_replaces(found, place):
    got = found["saves_and_asks_before_it_replaces"]
    assert got["asked"] == "taken.toml is already there. Replace it?"
    assert got["kept"] == "# held before\n"
    assert "no such folder" in got["nowhere"]
    assert "[sample]" in got["fresh"]
    assert got["suggested"] == "fresh.toml"
    assert got["replaced"] == got["fresh"]
    assert not got["open"]
    assert got["path"] == str(place / "taken.toml")


def test_a_dialog_is_seen_from_haploscopic_mode(found):
    got = found["leaves_haploscopic_mode_to_be_seen"]
    assert got["seen"]
    assert got["same"]
    assert got["other"] == "Save scene as"
    assert not got["open"]


def test_a_fit_can_be_cancelled_while_others_wait(found):
    got = found["shows_progress_and_cancels"]
    assert got["shown"]
    assert got["due"] == 0.1
    assert got["next"]
    assert got["jobs"] == ["/tables/first.csv", "/tables/second.csv"]
    assert got["same"]
    assert got["said"] == [["cancelled: first.csv", False], ["/tables/second.csv: no table", True]]


# --- without a window -----------------------------------------------------------------------------


def test_folders_come_first_and_numbers_count(tmp_path):
    for name in ("Sheet-10.toml", "sheet-2.TOML", "b.txt", ".hidden.toml", "10", "éa.toml"):
        (tmp_path / name).touch()
    for name in ("Zoo", "a10", "a9"):
        (tmp_path / name).mkdir()
    (tmp_path / "loop").symlink_to("loop")
    got = folders.listing(str(tmp_path))
    assert [e.name for e in got.entries] == [
        "a9", "a10", "Zoo", "10", "b.txt", "loop", "sheet-2.TOML", "Sheet-10.toml", "éa.toml",
    ]  # fmt: skip
    assert not got.cut
    some = folders.listing(str(tmp_path), (".toml",), hidden=True)
    assert {e.name for e in some.entries if not e.is_folder} == {
        ".hidden.toml", "sheet-2.TOML", "Sheet-10.toml", "éa.toml",
    }  # fmt: skip


def test_a_folder_with_very_much_in_it_is_cut(tmp_path, monkeypatch):
    monkeypatch.setattr(folders, "MOST_ENTRIES", 3)
    for k in range(4):
        (tmp_path / f"{k}").touch()
    got = folders.listing(str(tmp_path))
    assert got.cut
    assert len(got.entries) == 3


def test_folders_that_cannot_be_listed(tmp_path):
    for path in (str(tmp_path / "gone"), "nul\0", str(tmp_path / ("x" * 300))):
        with pytest.raises(InputError):
            folders.listing(path)


def test_a_name_field_gives_back_what_was_put_there():
    for name in ("plain.json", "two  spaces.json", "line\nbreak", "\udcff", " lead", 9000 * "x"):
        field = folders.NameField(name)
        field.text.encode("utf-8")
        assert field.value == name
        field.text += "x "
        assert field.value == field.text.strip()


def test_typed_names(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME", "/home/me")
    assert folders.meant("/a/b", "c.toml") == "/a/b/c.toml"
    assert folders.meant("/a/b", "../c.toml") == "/a/c.toml"
    assert folders.meant("/a/b", "/c.toml") == "/c.toml"
    assert folders.meant("/a/b", "~/c.toml") == "/home/me/c.toml"
    assert folders.with_suffix("/a/b.c", (".toml",)) == "/a/b.c.toml"
    assert folders.with_suffix("/a/b.TOML", (".toml",)) == "/a/b.TOML"
    assert folders.check_place(str(tmp_path / "new")) is False
    with pytest.raises(InputError, match="is a folder"):
        folders.check_place(str(tmp_path))


# --- the system's own dialog ----------------------------------------------------------------------

#: Asks as the window's loop does, and prints what came of it.
ASKS = """
import json, sys, time
from relgloss_view.viewer.panels.file_dialogs import FileDialogs, native_available
from relgloss_view.viewer.panels.own_dialog import Question
got, looks, asked = [], 0, FileDialogs()
asked.ask(Question("Save scene as", got.append, (".toml",), True, "pair.toml"))
due = asked.due_s()
while asked.open and asked._own is None:
    asked.show()
    looks += 1
    if looks == 3:
        open(sys.argv[1], "w").close()
    time.sleep(0.02)
own = None if asked._own is None else asked._own._message()
print(json.dumps([native_available(), due, got, looks, asked.folder, own]))
"""


@pytest.fixture
def helper(tmp_path, monkeypatch):
    """A stand-in for zenity that answers what it is told to, once it was looked at three times."""

    def ask(answer):
        program, looked = tmp_path / "zenity", tmp_path / "looked"
        looked.unlink(missing_ok=True)
        program.write_text(
            f"#!/bin/sh\nuntil [ -e '{looked}' ]; do sleep 0.01; done\nprintf '%s\\n' '{answer}'\n"
        )
        program.chmod(0o755)
        environment = {**os.environ, "DISPLAY": ":99", "PATH": f"{tmp_path}:{os.environ['PATH']}"}
        environment.pop("RELGLOSS_DIALOG", None)
        words = [sys.executable, "-c", ASKS, str(looked)]
        done = subprocess.run(
            words, env=environment, capture_output=True, text=True, timeout=120, check=True
        )
        return json.loads(done.stdout)

    return ask


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="zenity is Linux's")
class TestNative:
    def test_it_is_polled_and_never_waited_for(self, helper, tmp_path):
        there, due, got, looks, folder, own = helper(tmp_path / "new scene")
        assert there
        assert due == 0.1
        assert got == [str(tmp_path / "new scene.toml")]
        assert looks > 3  # waited for, it would never end
        assert folder == str(tmp_path)
        assert own is None

    def test_cancelled(self, helper):
        assert helper("")[2] == []

    def test_a_name_that_becomes_another_is_asked_about(self, helper, tmp_path):
        (tmp_path / "old.toml").write_text("")
        _, _, got, _, _, own = helper(tmp_path / "old")
        assert got == []
        assert own == "old.toml is already there. Replace it?"

    def test_not_without_a_display_or_a_helper(self, monkeypatch, tmp_path):
        for name in ("DISPLAY", "WAYLAND_DISPLAY", "RELGLOSS_DIALOG"):
            monkeypatch.delenv(name, raising=False)
        assert not native_available()
        monkeypatch.setenv("DISPLAY", ":99")
        monkeypatch.setenv("PATH", str(tmp_path))
        assert not native_available()
        (tmp_path / "kdialog").write_text("#!/bin/sh\n")
        (tmp_path / "kdialog").chmod(0o755)
        assert native_available()
        monkeypatch.setenv("RELGLOSS_DIALOG", "own")
        assert not native_available()
