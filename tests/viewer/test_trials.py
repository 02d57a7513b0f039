"""The window in which people answer, driven without a display: each screen and key, what the pixels
are, and what is in the session file afterwards."""

from __future__ import annotations

import contextlib
import ctypes
import dataclasses
import resource
import sqlite3
import time

import driven
import numpy as np
import pytest

from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile
from relgloss_view.display.record import OPTION
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.stimuli import digest_of, draw_reference, draw_stimulus
from relgloss_view.experiment.design.study import RATIO, Procedure, Screen, Study, StudySample
from relgloss_view.experiment.design.trial_order import planned_trials
from relgloss_view.experiment.session.flow import EARLIEST_S
from relgloss_view.experiment.session.records import read_record
from relgloss_view.experiment.session.sitting import Sitting
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.scene.sample import Sample, load_sample

SIZE = (640, 480)
OBSERVER = "O07"
GAP_S = 0.05
SLOW_S = EARLIEST_S + 0.05  #: what nobody answers sooner than
LONGEST_S = 120.0
PAGE, STRIP = "//##page", "//##strip"
PICTURE = 64


def small_study(screen=None, procedure=None, samples=("uncoated",), instructions=None):
    """Papers, one if not told, at four settings, in small pictures and without waiting."""
    return Study(
        samples=tuple(StudySample(name, Sample(load_sample(name), name=name)) for name in samples),
        instructions=instructions,
        reference=Sample(load_sample("cast-coated"), name="cast-coated"),
        grid=Grid((0.0, 2.0), (0.5, 1.0)),
        procedure=Procedure(**{"adaptation_min": 0.0, "gap_s": GAP_S} | (procedure or {})),
        screen=Screen(PICTURE, PICTURE, **(screen or {})),
    )


# --- scripts, run in the window's process ---------------------------------------------------------


@contextlib.contextmanager
def opened(folder, run):
    """The program on a session file, which is there already or is made."""
    from relgloss_view.experiment.session.store import Store
    from relgloss_view.viewer.trials.app import Trials

    told = []
    with Store(run.get("session", folder / "session.sqlite"), small_study(**run["study"])) as store:
        program = Trials(
            store,
            store.observer(OBSERVER),
            tell=lambda *told_: told.append(told_),
            display=run.get("display"),
            announce=told.append,
        )
        program.told = told
        yield program


def screen(hand):
    return hand.app.flow.phase.value


def wait(hand, condition):
    """Let frames pass, however many it takes, until something holds."""
    end = time.monotonic() + LONGEST_S
    while not condition():
        assert time.monotonic() < end, f"it does not come; the screen is {screen(hand)}"
        hand.frames(1)


def to_trial(hand):
    """Wait until pictures stand there, and for as long as nobody answers."""
    wait(hand, lambda: screen(hand) == "trial" and hand.app._standing)
    hand.frames(1)  # it is told once it stands there
    time.sleep(SLOW_S)
    hand.frames(1)


def press(hand, *names):
    """Press keys at once, by ImGui's names."""
    from imgui_bundle import imgui

    hand.key(sum(int(getattr(imgui.Key, name)) for name in names))


def page(hand):
    """Heading and buttons of the page that shows."""
    labels = [PAGE + "/" + label for label in LABELS if hand.there(f"{PAGE}/{label}")]
    return [label.removeprefix(PAGE + "/") for label in labels]


LABELS = (
    "I agree (Enter)", "I decline", "Continue (Enter)", "It is in place (Enter)",
    "Continue (Enter or Space)", "End (Enter)", "Take the last answer back (Backspace)",
    "Close (Enter)", "Go back (Enter)", "End (Ctrl+Q)",
)  # fmt: skip


def seen(hand):
    """The window's pixels, (H, W, 3)."""

    def read():
        window = hand.app._window
        width, height = window.size_now()
        data = window._screen.read(viewport=(0, 0, width, height), components=3, alignment=1)
        return np.frombuffer(data, np.uint8).reshape(height, width, 3)[::-1].copy()

    return hand.do(read)


def rows(hand):
    """Standing answers in the file: position, question, category."""
    answers = hand.do(lambda: hand.app.store.answers(hand.app.observer))
    return [[a.trial.position, a.question, a.category] for a in answers]


def trial(hand):
    at = hand.app.flow.trial
    return [at.position, at.sample, at.setting]


def park(hand):
    """Put the mouse where it covers nothing, and let the categories go."""
    hand.ctx.mouse_move_to_pos((2.0, 2.0))
    hand.app._strip.hide()
    hand.frames(2)


def leads_to_the_first_trial(hand, found):
    hand.frames(3)
    found["consent"] = [screen(hand), page(hand)]
    press(hand, "_1")
    press(hand, "space")
    found["still"] = screen(hand)
    hand.click(f"{PAGE}/I agree (Enter)")
    hand.frames(2)
    found["instructions"] = [screen(hand), page(hand)]
    press(hand, "enter")
    found["object"] = [screen(hand), page(hand)]
    plain = seen(hand)
    press(hand, "keypad_enter")
    found["gap"] = screen(hand)
    surround = seen(hand)
    found["surround"] = [int(surround.min()), int(surround.max())]
    found["words on the page"] = int(np.count_nonzero(np.any(plain != surround, axis=-1)))
    to_trial(hand)
    found["trial"] = trial(hand)


def shows_the_pictures_themselves(hand, found):
    park(hand)
    np.save(hand.folder / "trial.npy", seen(hand))
    found["trial"] = trial(hand)


def answers_by_key(hand, found):
    before = trial(hand)
    flow = hand.app.flow
    press(hand, "mod_ctrl", "_2")
    press(hand, "_6")
    press(hand, "escape")
    found["not answers"] = rows(hand)
    answered = {}
    answer = flow.answer

    def timed(category):
        began = time.thread_time()  # what it does; a busy disk or machine is not its doing
        done = answer(category)
        answered[category] = time.thread_time() - began
        return done

    flow.answer = timed
    press(hand, "_2")
    flow.answer = answer
    found["took_s"] = answered[1]
    found["rows"] = rows(hand)
    found["went on"] = [before, trial(hand)]
    wait(hand, lambda: screen(hand) == "trial" and hand.app._standing)
    wait(hand, lambda: flow._shown_s is not None)
    clock = flow._clock
    flow._clock = lambda: flow._shown_s + 0.9 * EARLIEST_S  # sooner than anybody sees
    press(hand, "_4")
    flow._clock = clock
    found["too soon"] = rows(hand)


def takes_the_last_answer_back(hand, found):
    to_trial(hand)
    press(hand, "backspace")
    found["rows"] = rows(hand)
    to_trial(hand)
    found["trial"] = trial(hand)
    press(hand, "keypad3")
    found["again"] = rows(hand)


def answers_by_mouse(hand, found):
    from relgloss_view.viewer.trials import category_strip

    to_trial(hand)
    park(hand)
    bare = seen(hand)
    found["at rest"] = hand.there(f"{STRIP}/5")
    hand.ctx.mouse_move_to_pos((200.0, 100.0))
    hand.ctx.mouse_move_to_pos((210.0, 100.0))
    hand.frames(2)
    found["moving"] = hand.there(f"{STRIP}/5")
    shown = seen(hand)
    changed = np.flatnonzero(np.any(shown != bare, axis=(1, 2)))
    pictures = np.flatnonzero(np.any(bare != bare[0, 0], axis=(1, 2)))
    pointer = 40  # pixels, at most, of the engine's own pointer
    found["below"] = bool(changed[changed > 100 + pointer].min() > pictures.max())
    found["colours"] = int(np.ptp(shown[pictures.max() + 1 :].astype(int), axis=-1).max())
    rest, category_strip.REST_S = category_strip.REST_S, 0.05
    wait(hand, lambda: hand.app._strip.alpha == 0.0)
    hand.frames(2)
    found["gone"] = not hand.there(f"{STRIP}/5")
    category_strip.REST_S = rest
    hand.ctx.mouse_move_to_pos((220.0, 130.0))
    hand.ctx.mouse_move_to_pos((230.0, 130.0))
    hand.frames(1)
    hand.click(f"{STRIP}/5")
    found["rows"] = rows(hand)
    park(hand)


def pauses(hand, found):
    to_trial(hand)
    before = trial(hand)
    press(hand, "p")
    found["pause"] = [screen(hand), page(hand)]
    press(hand, "_1")
    found["rows"] = rows(hand)
    press(hand, "space")
    to_trial(hand)
    found["same"] = trial(hand) == before


def tells_the_operator_alone(hand, found):
    from imgui_bundle import imgui

    to_trial(hand)
    park(hand)
    before = seen(hand)
    hand.ctx.key_down(imgui.Key.tab)
    hand.frames(2)
    held = seen(hand)
    hand.ctx.key_up(imgui.Key.tab)
    hand.frames(2)
    lines = np.flatnonzero(np.any(held != before, axis=(1, 2)))
    found["lines"] = [int(lines.min()), int(lines.max())]
    found["after"] = bool(np.array_equal(seen(hand), before))
    found["told"] = hand.app.told[-1]


def says_what_was_not_stored(hand, found):
    """The process may write no page of the log, as on a disk that is full."""
    to_trial(hand)
    before, at = rows(hand), trial(hand)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, limits[1]))
    try:
        press(hand, "_1")
        found["page"] = [hand.app.fault.heading, page(hand)]
        found["screen"] = screen(hand)
        park(hand)
        found["pictures"] = len(np.unique(seen(hand)[SIZE[1] // 2 + 100 :].reshape(-1, 3), axis=0))
        press(hand, "_1")
        found["no key goes through"] = hand.app.fault is not None
        press(hand, "enter")
        found["back"] = [hand.app.fault is None, trial(hand) == at]
        to_trial(hand)
        press(hand, "_1")
        found["again"] = hand.app.fault is not None
        found["failed"] = hand.app.failed
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    found["not stored"] = rows(hand) == before
    time.sleep(0.5)  # which is not the observer's time
    began = time.perf_counter()
    press(hand, "enter")
    to_trial(hand)
    press(hand, "_1")
    found["mended"] = [hand.app.fault is None, hand.app.failed]
    found["row"] = [row for row in rows(hand) if row not in before]
    last = hand.do(lambda: hand.app.store.answers(hand.app.observer)[-1])
    found["response_s"] = [last.response_s, time.perf_counter() - began]


def survives_lost_objects(hand, found):
    import glfw

    to_trial(hand)
    park(hand)
    before = seen(hand)
    pictures = hand.app._pair._pictures

    def destroy():
        pointer = ctypes.cast(glfw.get_proc_address("glDeleteTextures"), ctypes.c_void_p).value
        delete = ctypes.CFUNCTYPE(None, ctypes.c_int, ctypes.POINTER(ctypes.c_uint))(pointer)
        for renderer in pictures._full.values():
            delete(1, ctypes.byref(ctypes.c_uint(renderer.texture("display").glo)))

    hand.do(destroy)
    hand.frames(4)
    found["rebuilt"] = hand.app._pair._pictures is not pictures
    found["identical"] = bool(np.array_equal(seen(hand), before))
    found["error"] = hand.do(lambda: pictures.ctx.error)


def takes_every_size(hand, found):
    import glfw

    from relgloss_view.viewer.trials import placement

    to_trial(hand)
    park(hand)
    before = seen(hand)
    handle = hand.app._window.handle
    needed = placement.needed(hand.app.store.study, SIZE)
    found["needed"] = [*needed]
    for size in ((1, 1), (0, 0), (300, 20), (20, 300), (needed[0] - 1, 200), (2000, 90)):
        hand.do(lambda size=size: glfw.set_window_size(handle, *size))
        hand.frames(3)
        found[f"{size[0]}x{size[1]}"] = hand.app._standing
    hand.do(lambda: glfw.set_window_size(handle, 400, PICTURE - 1))
    hand.frames(3)
    press(hand, "_1")
    found["too small to answer"] = len(rows(hand))
    hand.app.flow._wait()  # a gap that nothing ends while the pictures have no room
    time.sleep(2 * GAP_S)
    hand.frames(2)
    found["rests"] = [screen(hand), hand.app.wait_s()]
    hand.do(lambda: glfw.set_window_size(handle, *SIZE))
    to_trial(hand)
    found["as before"] = bool(np.array_equal(seen(hand), before))
    found["rows"] = len(rows(hand))


def pages_of(hand):
    """Heading and note of what is drawn in a frame."""
    from relgloss_view.viewer.trials import pages

    show, drawn = pages.show, []

    def seen_too(page, *more, **named):
        drawn.append([page.heading, page.note])
        return show(page, *more, **named)

    pages.show = seen_too
    hand.frames(2)
    pages.show = show
    return drawn[-1]


def one_press_takes_one_answer_back(hand, found):
    hand.frames(2)
    press(hand, "enter")
    found["begins"] = pages_of(hand)
    press(hand, "enter")
    for _ in range(4):
        to_trial(hand)
        press(hand, "_2")
    press(hand, "enter")
    to_trial(hand)
    found["at"] = trial(hand)
    press(hand, "backspace")
    found["first"] = [screen(hand), [row[0] for row in rows(hand)]]
    press(hand, "backspace")
    found["second"] = [screen(hand), [row[0] for row in rows(hand)]]
    press(hand, "enter")
    to_trial(hand)
    found["then"] = trial(hand)[0]


def a_key_is_for_what_stood_there(hand, found):
    """Pages that come in the frame of a key which they take too."""
    from relgloss_view.experiment.session.flow import Phase as Shown
    from relgloss_view.viewer.trials import keys

    flow = hand.app.flow
    tick = flow.tick
    for name, chords, comes in (
        ("enter", keys.ENTER, Shown.OBJECT),
        ("space", keys.SPACE, Shown.PAUSE),
    ):
        to_trial(hand)

        def comes_now(chords=chords, comes=comes):
            tick()
            if keys.pressed(chords):
                flow.tick = tick  # once
                flow.phase = comes

        flow.tick = comes_now
        press(hand, name)
        found[name] = screen(hand)
        press(hand, name)
        if comes is Shown.OBJECT:  # it does not take Space
            press(hand, "enter")
    to_trial(hand)
    found["goes on"] = screen(hand)


def says_whose_session_goes_on(hand, found):
    hand.frames(2)
    found["first"] = [screen(hand), *pages_of(hand)]
    press(hand, "enter")
    found["then"] = [screen(hand), *pages_of(hand)]


def goes_on_and_ends(hand, found):
    closed = []
    hand.app._window.close = lambda: closed.append(True)
    hand.frames(2)
    found["first"] = [screen(hand), trial(hand), rows(hand)]
    found["note"] = pages_of(hand)
    press(hand, "enter")
    found["object"] = page(hand)
    press(hand, "enter")
    while screen(hand) != "finished":
        to_trial(hand)
        press(hand, "_5")
    found["finished"] = page(hand)
    found["last page"] = pages_of(hand)
    rows_then = rows(hand)
    press(hand, "backspace")
    to_trial(hand)
    found["taken back"] = len(rows_then) - len(rows(hand))
    press(hand, "_1")
    found["last"] = rows(hand)[-1]
    found["closed"] = bool(closed)
    press(hand, "enter")
    found["then closed"] = bool(closed)
    closed.clear()
    press(hand, "mod_ctrl", "q")
    found["by Ctrl+Q"] = bool(closed)
    del hand.app._window.close


def adapts(hand, found):
    hand.frames(2)
    for _ in range(3):
        press(hand, "enter")
    found["screen"] = screen(hand)
    empty = without_pointer(seen(hand))
    found["colours"] = int(np.ptp(empty.astype(int), axis=-1).max())
    # A line of a few digits, and nothing else.
    inked = np.argwhere(np.any(empty != 119, axis=-1))
    found["countdown"] = np.ptp(inked, axis=0).tolist()
    press(hand, "enter")
    press(hand, "_1")
    found["still"] = screen(hand)
    press(hand, "mod_ctrl", "enter")
    to_trial(hand)
    found["skipped"] = screen(hand)


def asks_for_the_grain_too(hand, found):
    park(hand)
    first = seen(hand)
    np.save(hand.folder / "mirrored.npy", first)
    found["trial"] = trial(hand)
    found["always"] = hand.there(f"{STRIP}/1")
    hand.click(f"{STRIP}/2")
    found["question"] = hand.app.flow.question
    to_trial(hand)
    park(hand)
    second = seen(hand)
    np.save(hand.folder / "grain.npy", second)
    hand.click(f"{STRIP}/4")
    found["rows"] = rows(hand)
    to_trial(hand)
    press(hand, "backspace")
    found["undone"] = [rows(hand), trial(hand), hand.app.flow.question]
    to_trial(hand)


def declines(hand, found):
    hand.frames(2)
    hand.click(f"{PAGE}/I decline")
    hand.frames(2)
    found["declined"] = [screen(hand), page(hand)]


def shows_that_the_display_has_changed(hand, found):
    hand.frames(2)
    fault = hand.app.fault
    found["first"] = [fault.heading, fault.text, page(hand)]
    press(hand, "_1")
    found["still"] = hand.app.fault is fault
    press(hand, "enter")
    found["then"] = [hand.app.fault is None, screen(hand)]
    press(hand, "enter")
    press(hand, "enter")
    to_trial(hand)
    park(hand)
    found["corner"] = seen(hand)[2, 2].tolist()
    found["announced"] = [line for line in hand.app.told if isinstance(line, str)]


SESSIONS = {
    "display": [shows_that_the_display_has_changed],
    "walk": [
        leads_to_the_first_trial,
        shows_the_pictures_themselves,
        answers_by_key,
        takes_the_last_answer_back,
        answers_by_mouse,
        pauses,
        tells_the_operator_alone,
        survives_lost_objects,
        takes_every_size,
        says_what_was_not_stored,
    ],
    "resume": [goes_on_and_ends],
    "two": [one_press_takes_one_answer_back, a_key_is_for_what_stood_there],
    "again": [says_whose_session_goes_on],
    "mirror": [adapts, asks_for_the_grain_too],
    "decline": [declines],
}
SCRIPTS = [script for scripts in SESSIONS.values() for script in scripts]
MIRROR = {
    "screen": {"mirror": True, "scale": "always"},
    "procedure": {"ask_grain": True, "adaptation_min": 1.0},
}

#: Two papers, and no page of instructions.
TWO = {"samples": ["uncoated", "matte-coated"], "instructions": ""}


# --- the other side -------------------------------------------------------------------------------


def driven_session(name, folder, **more):
    names = [script.__name__ for script in SESSIONS[name]]
    return driven.drive("test_trials", folder, size=SIZE, scripts=names, **{"study": {}} | more)


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    folder = tmp_path_factory.mktemp("walk")
    return driven_session("walk", folder), folder


@pytest.fixture(scope="module")
def resumed(walk, tmp_path_factory):
    session = walk[1] / "session.sqlite"
    found = driven_session("resume", tmp_path_factory.mktemp("resume"), session=str(session))
    return found["goes_on_and_ends"], session


@pytest.fixture(scope="module")
def mirror(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mirror")
    return driven_session("mirror", folder, study=MIRROR), folder


@pytest.fixture(scope="module")
def two(tmp_path_factory):
    folder = tmp_path_factory.mktemp("two")
    return driven_session("two", folder, study=TWO), folder


def query(session, text):
    with contextlib.closing(sqlite3.connect(session)) as connection:
        return connection.execute(text).fetchall()


def test_from_consent_to_the_first_trial(walk):
    got = walk[0]["leads_to_the_first_trial"]
    assert got["consent"] == ["consent", ["I agree (Enter)", "I decline"]]
    assert got["still"] == "consent"
    assert got["instructions"] == ["instructions", ["Continue (Enter)"]]
    assert got["object"] == ["object", ["It is in place (Enter)"]]
    assert got["words on the page"] > 100
    assert got["gap"] == "gap"
    assert got["surround"] == [119, 119]  # sRGB of L* 50
    first = planned_trials(small_study(), 0)[0]
    assert got["trial"] == [0, 0, first.setting]


def expected(renderer, study, at):
    """The window's pixels as the renderer of the files draws them; nothing else stands there."""
    pictures = [draw_reference(renderer, study).display.copy()]
    pictures.append(draw_stimulus(renderer, study, at[1], at[2]).display.copy())
    if study.screen.mirror:
        pictures = [picture[:, ::-1] for picture in reversed(pictures)]
    gap = int(study.screen.gap_px)
    window = np.full((SIZE[1], SIZE[0], 3), 119, np.uint8)
    left, top = (SIZE[0] - 2 * PICTURE - gap) // 2, (SIZE[1] - PICTURE) // 2
    for k, picture in enumerate(pictures):
        x = left + k * (PICTURE + gap)
        window[top : top + PICTURE, x : x + PICTURE] = picture
    return window


def without_pointer(pixels):
    """The test engine draws a pointer of its own, here in the upper left corner."""
    pixels = pixels.copy()
    pixels[:40, :40] = 119
    return pixels


def test_the_window_is_the_two_pictures_and_nothing_else(walk, renderer):
    found, folder = walk
    at = found["shows_the_pictures_themselves"]["trial"]
    got = without_pointer(np.load(folder / "trial.npy"))
    study = small_study()
    np.testing.assert_array_equal(got, expected(renderer, study, at))
    for other in range(len(study.grid)):  # the control: another setting is told from it
        if other != at[2]:
            off = np.any(got != expected(renderer, study, [0, 0, other]), axis=-1)
            assert np.count_nonzero(off) > 100


def test_mirrored_pictures(mirror, renderer):
    found, folder = mirror
    at = found["asks_for_the_grain_too"]["trial"]
    study = small_study(**MIRROR)
    wanted = expected(renderer, study, at)
    low = SIZE[1] // 2 + PICTURE // 2  # of the pictures; the categories stand below
    for name in ("mirrored", "grain"):
        got = without_pointer(np.load(folder / f"{name}.npy"))
        np.testing.assert_array_equal(got[:low], wanted[:low])
        assert np.any(got[low:] != wanted[low:])
    plain = dataclasses.replace(study, screen=dataclasses.replace(study.screen, mirror=False))
    assert np.any(expected(renderer, plain, at)[:low] != wanted[:low])


def test_keys_answer(walk):
    got = walk[0]["answers_by_key"]
    assert got["not answers"] == []
    assert got["rows"] == [[0, "ratio", 1]]
    before, after = got["went on"]
    assert [before[0], after[0]] == [0, 1]
    assert got["too soon"] == got["rows"]
    assert got["took_s"] < 1.0


def test_undo(walk):
    got = walk[0]["takes_the_last_answer_back"]
    assert got["rows"] == []
    assert got["trial"][0] == 0
    assert got["again"] == [[0, "ratio", 2]]


def test_the_mouse_answers_while_it_moves(walk):
    got = walk[0]["answers_by_mouse"]
    assert (got["at rest"], got["moving"], got["gone"]) == (False, True, True)
    assert got["below"]
    assert got["colours"] == 0
    assert got["rows"] == [[0, "ratio", 2], [1, "ratio", 4]]


def test_pause(walk):
    got = walk[0]["pauses"]
    assert got["pause"] == ["pause", ["Continue (Enter or Space)"]]
    assert len(got["rows"]) == 2
    assert got["same"]


def test_the_operator_sees_the_progress_while_tab_is_held(walk):
    got = walk[0]["tells_the_operator_alone"]
    assert got["lines"][0] > SIZE[1] - 30
    assert got["after"]
    share, text = got["told"]
    assert share == pytest.approx(2 / 4)
    assert text.startswith(f"{OBSERVER}: 2 of 4, uncoated, ratio")


def test_an_answer_that_is_not_stored_is_not_acknowledged(walk):
    got = walk[0]["says_what_was_not_stored"]
    assert got["page"] == ["This answer was NOT stored", ["Go back (Enter)", "End (Ctrl+Q)"]]
    assert got["screen"] == "trial"
    assert got["no key goes through"]
    assert got["back"] == [True, True]
    assert got["again"]
    assert got["failed"].startswith("This answer was NOT stored: ")
    assert "session.sqlite: can't be read or written" in got["failed"]
    assert got["not stored"]
    assert got["mended"] == [True, ""]
    assert got["row"] == [[2, "ratio", 0]]
    response_s, most_s = got["response_s"]
    assert EARLIEST_S <= response_s <= most_s  # counted from when the pictures came back


def test_lost_objects_are_made_again(walk):
    got = walk[0]["survives_lost_objects"]
    assert got == {"rebuilt": True, "identical": True, "error": "GL_NO_ERROR"}


def test_every_size_of_the_window(walk):
    got = walk[0]["takes_every_size"]
    assert got["needed"] == [2 * PICTURE + 24, PICTURE]
    assert got["2000x90"]
    assert not any(got[size] for size in ("1x1", "0x0", "300x20", "20x300", "151x200"))
    assert got["too small to answer"] == got["rows"] == 2
    assert got["rests"] == ["gap", None]
    assert got["as before"]


def test_a_session_goes_on_and_ends(resumed):
    got, session = resumed
    screen_, at, rows_ = got["first"]
    assert screen_ == "instructions"  # agreed to already
    assert at[0] == len(rows_) == 3
    assert got["note"][1] == (
        f"{OBSERVER} continues: 3 of 4 are judged. Somebody else? Close the window (Ctrl+Q) and "
        "start with --new."
    )
    assert got["last page"] == ["Thank you", ""]  # told once
    assert got["object"] == ["It is in place (Enter)", "Take the last answer back (Backspace)"]
    assert got["finished"] == ["End (Enter)", "Take the last answer back (Backspace)"]
    assert got["taken back"] == 1
    assert got["last"] == [3, "ratio", 0]
    assert (got["closed"], got["then closed"], got["by Ctrl+Q"]) == (False, True, True)
    # Both runs ended by themselves, and the observer is through.
    assert query(session, "SELECT count(*), count(ended_utc) FROM run") == [(2, 2)]
    assert query(session, "SELECT name, ended_utc IS NULL FROM observer") == [(OBSERVER, 0)]


def test_one_press_takes_one_answer_back(two):
    """Also where the page of the sample before comes with it, which takes the same key."""
    got = two[0]["one_press_takes_one_answer_back"]
    assert got["at"][0] == 4
    assert got["first"] == ["object", [0, 1, 2]]
    assert got["second"] == ["object", [0, 1]]
    assert got["then"] == 2


def test_a_key_is_for_what_stood_there(two):
    got = two[0]["a_key_is_for_what_stood_there"]
    assert got == {"enter": "object", "space": "pause", "goes on": "trial"}


def test_the_first_page_says_whose_session_goes_on(two, tmp_path):
    """Also where the study has no instructions to show."""
    found, folder = two
    assert found["one_press_takes_one_answer_back"]["begins"][1] == "The experimenter does this."
    session = str(folder / "session.sqlite")
    got = driven_session("again", tmp_path, study=TWO, session=session)
    first, then = got["says_whose_session_goes_on"].values()
    assert first[:2] == ["instructions", "Relative gloss"]
    assert first[2].startswith(f"{OBSERVER} continues: 2 of 8 are judged. Somebody else? ")
    assert then[0] == "object"
    assert then[2] == "The experimenter does this."


def test_what_was_shown_is_kept(resumed, renderer):
    _, session = resumed
    study = small_study()
    got = {(s, k): d for s, k, d in query(session, "SELECT sample, setting, sha256 FROM picture")}
    wanted = {(None, None): digest_of(draw_reference(renderer, study))}
    for setting in range(len(study.grid)):
        wanted[0, setting] = digest_of(draw_stimulus(renderer, study, 0, setting))
    assert got == wanted


def test_another_display_is_shown_before_continuing(tmp_path, renderer):
    """The page, then pictures and surround that are drawn for it, and kept with its record."""
    wide = Display(transfer="gain-offset-gamma", gamma=1.8)  # its L* 50 is another digital value
    for name, display in (("before", Display()), ("now", wide)):
        (tmp_path / f"{name}.icc").write_bytes(matrix_profile(display))
    session = tmp_path / "session.sqlite"
    study = small_study()
    with Store(session, study) as store:
        observer = store.observer(OBSERVER)
        sitting = Sitting.of_file(study, str(tmp_path / "before.icc"), OPTION)
        run = store.begin_run(observer, "d", {}, sitting=sitting)
        store.consent(observer)
        store.plan(observer, planned_trials(study, observer.number))
        store.answer(observer, store.trials(observer)[0], RATIO, 0, 1.0, run)
    found = driven_session(
        "display", tmp_path, session=str(session), display=str(tmp_path / "now.icc")
    )["shows_that_the_display_has_changed"]
    heading, text, buttons = found["first"]
    assert heading == "Please check the display"
    assert text.startswith("The display has changed since the last sitting, from ")
    assert buttons == ["End (Ctrl+Q)"]
    assert found["still"]
    assert found["then"] == [True, "instructions"]
    assert found["announced"][0].startswith("pictures are drawn for ")
    lightness_50 = round(255.0 * 0.18418651851 ** (1.0 / 1.8))
    assert np.max(np.abs(np.array(found["corner"]) - lightness_50)) <= 1
    record = read_record(session, tmp_path)
    assert [r.display.origin for r in record.runs] == [OPTION] * 2
    on_wide = study.shown_on(Display(profile=str(tmp_path / "now.icc")))
    reference = next(p for p in record.pictures if p.sample is None)
    assert reference.sha256 == digest_of(draw_reference(renderer, on_wide))
    assert reference.sha256 != digest_of(draw_reference(renderer, study))


def test_adaptation_can_be_cut_short(mirror):
    found, folder = mirror
    got = found["adapts"]
    assert got["screen"] == got["still"] == "adaptation"
    assert got["colours"] == 0
    tall, wide = got["countdown"]
    assert 4 <= tall <= 16
    assert wide <= 40
    assert got["skipped"] == "trial"
    events = query(folder / "session.sqlite", "SELECT kind, detail FROM event ORDER BY id")
    assert events[0][0] == "adaptation cut short"
    assert events[0][1].endswith("s left")


def test_the_second_question(mirror):
    got = mirror[0]["asks_for_the_grain_too"]
    position, setting = got["trial"][0], got["trial"]
    assert got["always"]
    assert got["question"] == "grain"
    assert got["rows"] == [[position, "ratio", 1], [position, "grain", 3]]
    assert got["undone"] == [[[position, "ratio", 1]], setting, "grain"]


def test_who_declines_is_asked_nothing(tmp_path):
    got = driven_session("decline", tmp_path)["declines"]
    assert got["declined"] == ["declined", ["Close (Enter)"]]
    session = tmp_path / "session.sqlite"
    assert query(session, "SELECT count(*) FROM answer") == [(0,)]
    assert query(session, "SELECT consented_utc, ended_utc IS NULL FROM observer") == [(None, 0)]
    assert query(session, "SELECT kind FROM event") == [("declined",)]
