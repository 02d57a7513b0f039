"""Shows the window and the trials' pages in many sizes and languages, and reads their texts.

Run as a program, in a process of its own: ImGui's state is global. `read_all` is its other side.
"""

from __future__ import annotations

import contextlib
import json
import os
import subprocess
import sys
import time
from pathlib import Path

from relgloss_view.viewer.shell.layout import GLOSS, LIGHT

NAMES = {
    "German": "Glänzend gestrichener Karton, größere Körnung",
    "Japanese": "光沢紙・緑インキ（試作品）両面印刷",
    "Chinese": "高光铜版纸，绿色油墨，第二次打样",
    "Korean": "광택 코팅지 녹색 잉크 두 번째 시제품",
    "Russian": "Мелованная глянцевая бумага, зелёная краска",
}
#: Of a study in a language: title, consent, instructions, categories, label of the sample.
STUDIES = {
    "Japanese": (
        "光沢の比較実験",
        "この実験では、緑インキで印刷された紙の画像を二つずつ見ていただきます。左の画像が基準です。右の画像の光沢が、"
        "実物の光沢にどのくらい近いかを答えてください。\n\nいつでも理由を述べずに中止することができます。",
        "近いと思うほど小さい番号のキーを押してください。",
        ("とても近い", "近い", "やや遠い", "遠い"),
        NAMES["Japanese"],
    ),
    "German": (
        "Vergleich des Glanzes",
        "Sie sehen jeweils zwei Bilder eines grün bedruckten Papiers. Das linke ist die Vorlage. "
        "Beurteilen Sie, wie nahe der Glanz des rechten dem wirklichen kommt.\n\nSie können "
        "jederzeit und ohne Angabe von Gründen aufhören.",
        "Je näher, desto kleiner die Ziffer, die Sie drücken.",
        ("sehr nahe", "ziemlich nahe", "ziemlich weit", "Größenordnungen entfernt"),
        NAMES["German"],
    ),
    "Thai": ("ความมันวาว", "กระดาษ", "", ("ใกล้", "ไกล"), "paper"),
}
SETTLING = 4  #: frames until a layout rests
MOST_LOOKS = 100  #: at a screen on which something is being computed
LONGEST_S = 900.0


def read_all(cases: list[dict], folder: Path) -> dict[str, dict]:
    """Show cases in another process: what was found, by their names."""
    (folder / "home").mkdir()
    (folder / "cases.json").write_text(json.dumps(cases), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, __file__, str(folder)],
        capture_output=True,
        text=True,
        timeout=LONGEST_S,
        cwd=folder,
        env={**os.environ, "RELGLOSS_HOME": str(folder / "home"), "HOME": str(folder / "home")},
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-4000:]
    return json.loads((folder / "found.json").read_text(encoding="utf-8"))


# --- in the process of its own --------------------------------------------------------------------


class Shown:
    """A program whose window goes through steps, a generator that yields once a frame."""

    def __init__(self, program, steps):
        self.program, self._steps, self._make = program, None, steps
        self.window = None
        self.sizes: set[float] = set()  #: of the font, all that were used
        self.draw = lambda: None  #: more to draw in a frame

    def __getattr__(self, name):
        return getattr(self.program, name)

    def start(self, ctx, window):
        self.window = window
        self.program.start(ctx, window)
        self._steps = self._make(self)

    def frame(self):
        from imgui_bundle import imgui

        self.sizes.add(imgui.get_font_size())
        self.program.frame()
        self.draw()

    def after_frame(self, frame_s):
        self.program.after_frame(frame_s)
        if next(self._steps, None) is None:
            self.window.close()
        return True

    def resize(self, size):
        import glfw

        glfw.set_window_size(self.window.handle, *size)

    def read(self):
        import text_extents

        return text_extents.read(self.sizes)


@contextlib.contextmanager
def sizes_noted(shown):
    """Note each size that a font is pushed with: glyphs are looked up by it."""
    from imgui_bundle import imgui

    push = imgui.push_font

    def noted(font, size):
        shown.sizes.add(float(size))
        push(font, size)

    imgui.push_font = noted
    try:
        yield
    finally:
        imgui.push_font = push


def main(folder: Path) -> None:
    from relgloss_view.viewer.shell.window import Window

    sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]
    cases = json.loads((folder / "cases.json").read_text(encoding="utf-8"))
    found: dict[str, dict] = {}
    viewing = [case for case in cases if "study" not in case]
    if viewing:
        shown = Shown(_viewer(), lambda shown: _view(shown, viewing, found))
        with sizes_noted(shown):
            Window(shown, tuple(viewing[0]["size"]), headless=True).run()
    for case in cases:
        if "study" in case:
            _answer(case, found, folder)
    (folder / "found.json").write_text(json.dumps(found), encoding="utf-8")


def _viewer():
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.state.state import State

    return App(State.initial())


def _view(shown, cases, found):
    for case in cases:
        entry = found[case["name"]] = {"faults": [], "seen": [], "panels": []}
        name = NAMES[case.get("language", "German")]
        shown.resize(case["size"])
        yield True
        shown.window.set_font_scale(case.get("font", 1.0))
        _name_samples(shown.program.model, name)
        shown.program.layout.reset()
        yield from _frames(SETTLING)
        for screen in case["screens"]:
            yield from SCREENS[screen](shown, name, entry)


def _frames(count):
    for _ in range(count):
        yield True


def _name_samples(model, name):
    from dataclasses import replace

    from relgloss_view.picture.scene.sample import Sample, load_sample

    for side in ("reference", "test"):
        sample = Sample(replace(load_sample("art-coated"), name=name))
        model.change(model.state.with_sample(side, sample))


def _note(shown, name, entry, where, fields=()):
    """Read the screen when it rests: a number that has just come may move what is below it."""
    screen = shown.read()
    for _ in range(MOST_LOOKS):
        waits = any("eing computed" in text for text in screen.letters)
        if not waits and not screen.faults((name,), fields):
            break
        yield from _frames(SETTLING)
        screen = shown.read()
        if not waits and screen.faults((name,), fields):
            break  # it lasts
    entry["faults"] += [f"{where}: {fault}" for fault in screen.faults((name,), fields)]
    entry["seen"].append({"where": where, "letters": screen.letters})


def _panels(shown, name, entry):
    """Each panel in front, one of each place at a time; gloss and light may share a place."""
    layout = shown.program.layout
    places: dict[str, list[str]] = {}
    for panel in layout.panels:
        place = GLOSS if panel.place == LIGHT else panel.place
        places.setdefault(place, []).append(panel.title)
    for k in range(max(len(titles) for titles in places.values())):
        front = [titles[k] for titles in places.values() if k < len(titles)]
        for title in front:
            layout.focus(title)
            yield from _frames(3)
        yield from _frames(2)
        entry["panels"] += front
        yield from _note(shown, name, entry, " and ".join(front))


def _export(shown, name, entry):
    export = shown.program.files._export
    export.open()
    yield from _frames(2 * SETTLING)
    yield from _note(shown, name, entry, "export", (export.name.text,))
    export._open = False
    yield from _frames(2)


def _compared(shown, name, entry):
    """The pictures in each mode, with an overlay."""
    model = shown.program.model
    from relgloss_view.viewer.state.state import COMPARE_MODES

    for mode in COMPARE_MODES:
        model.set_part("presentation", compare=mode, overlay="lightness")
        yield from _frames(2)
        yield from _note(shown, name, entry, mode)
    model.set_part("presentation", compare=COMPARE_MODES[0], overlay="none")
    yield from _frames(1)


def _controls(shown, name, entry):
    """What has to be found: a cut text, and two on each other; and one that is whole."""
    from imgui_bundle import ImVec2, imgui

    def draw():
        flags = imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_saved_settings
        imgui.set_next_window_pos(ImVec2(100.0, 100.0))
        imgui.set_next_window_size(ImVec2(120.0, 120.0))
        imgui.begin("Control", None, flags)
        place = imgui.get_cursor_screen_pos()
        imgui.text_unformatted("A text that is wider than its window is")
        imgui.text_unformatted("whole text")
        painter = imgui.get_window_draw_list()
        ink = imgui.get_color_u32(imgui.Col_.text)
        painter.add_text(ImVec2(place.x, place.y + 60.0), ink, "one text")
        painter.add_text(ImVec2(place.x + 8.0, place.y + 64.0), ink, "another")
        imgui.end()

    shown.draw = draw
    yield from _frames(SETTLING)
    yield from _note(shown, name, entry, "control")
    shown.draw = lambda: None
    yield from _frames(2)


def _new_material(shown, name, entry):
    """A reading that leaves much open."""
    import dataclasses

    files = shown.program.files
    files.make_material()
    making = files.new_material
    making.typed = dataclasses.replace(making.typed, gloss=("", "45", "", ""))
    yield from _frames(2)
    while not making.complete:
        yield from _frames(1)
    yield from _frames(SETTLING)
    yield from _note(shown, name, entry, "new material", (making.name,))
    making.cancel()
    yield from _frames(2)


SCREENS = {
    "panels": _panels, "export": _export, "new": _new_material, "compared": _compared,
    "controls": _controls,
}  # fmt: skip


#: For all pages of a study: those of a busy machine take a few seconds.
PAGES_S = 60.0


def _answer(case, found, folder):
    """A study's first pages and its first pair of pictures, with the categories."""
    from relgloss_view.experiment.design.grid import Grid
    from relgloss_view.experiment.design.study import Procedure, Screen, Study, StudySample
    from relgloss_view.experiment.session.store import Store
    from relgloss_view.picture.scene.sample import Sample, load_sample
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.trials.app import Trials

    title, consent, instructions, categories, label = STUDIES[case["study"]]
    study = Study(
        samples=(StudySample(label, Sample(load_sample("uncoated"), name="uncoated")),),
        reference=Sample(load_sample("cast-coated"), name="cast-coated"),
        title=title,
        consent=consent,
        instructions=instructions or None,
        categories=categories,
        grid=Grid((0.0, 2.0), (0.5, 1.0)),
        procedure=Procedure(adaptation_min=0.0, gap_s=0.05),
        screen=Screen(64, 64, scale="always"),
    )
    entry = found[case["name"]] = {"faults": [], "seen": [], "pages": []}
    with Store(folder / f"{len(found)}.sqlite", study) as store:
        program = Trials(store, store.observer("O1"))
        shown = Shown(program, lambda shown: _pages(shown, label, entry))
        with sizes_noted(shown):
            Window(shown, tuple(case["size"]), headless=True).run()


def _pages(shown, label, entry):
    from relgloss_view.experiment.session.flow import Phase

    program = shown.program
    yield from _frames(SETTLING)
    end_s = time.monotonic() + PAGES_S  # a number of frames would be over before slow pictures come
    while time.monotonic() < end_s:
        page = "warning" if program.fault is not None else program.flow.phase.value
        waits = program.fault is None and program.flow.phase in (Phase.GAP, Phase.ADAPTATION)
        waits |= page == Phase.TRIAL.value and not program._standing
        if page not in entry["pages"] and not waits:
            yield from _frames(2)
            entry["pages"].append(page)
            yield from _note(shown, label, entry, page)
            if page == Phase.TRIAL.value:
                return
        program._act("retry" if page == "warning" else "confirm")
        yield True


if __name__ == "__main__":
    main(Path(sys.argv[1]))
