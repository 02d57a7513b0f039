"""What the window in which people answer is made of, without a window."""

from __future__ import annotations

import dataclasses
import struct
from types import SimpleNamespace

import numpy as np
import pytest
from PIL import ImageCms

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.experiment.design.study_file import load_study
from relgloss_view.experiment.session.flow import Flow, Phase, Progress
from relgloss_view.experiment.session.store import Store
from relgloss_view.viewer.drawing.arrangement import centred
from relgloss_view.viewer.drawing.canvas import surround_gray
from relgloss_view.viewer.state.state import Presentation
from relgloss_view.viewer.trials import category_strip, ink, keys, pages, placement
from relgloss_view.viewer.trials.device import read_profile
from relgloss_view.viewer.trials.experimenter_line import ExperimenterLine, continues
from relgloss_view.viewer.trials.ink import Ink
from relgloss_view.viewer.trials.placement import Below, needed_below


def srgb_light(value):
    """IEC 61966-2-1, written out as WCAG 2 has it."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def contrast(one, other):
    """WCAG 2's contrast ratio."""
    low, high = sorted(srgb_light(value) + 0.05 for value in (one, other))
    return high / low


class TestInk:
    @pytest.mark.parametrize("lstar", [0.0, 20.0, 40.0, 50.0, 60.0, 80.0, 100.0])
    def test_contrasts_to_the_surround(self, lstar):
        display = Display(background_lstar=lstar)
        surround, *others = surround_gray(display)
        assert others == [surround, surround]
        inks = Ink.on(display)
        for red, green, blue in dataclasses.astuple(inks):
            assert red == green == blue
        grays = Ink(*(red for red, _, _ in dataclasses.astuple(inks)))
        assert contrast(grays.text, surround) > 4.5  # WCAG 2, level AA
        assert contrast(grays.quiet, surround) == pytest.approx(ink.QUIET, abs=0.05)
        assert contrast(grays.faint, surround) == pytest.approx(ink.FAINT, abs=0.03)
        # What is written on a field is legible however it is lit.
        for field in (grays.field, grays.hovered):
            assert contrast(grays.text, field) > 3.0
        order = [surround, grays.field, grays.hovered, grays.pressed, grays.faint, grays.quiet]
        assert sorted(order, reverse=grays.text < surround) == order

    def test_another_display(self):
        gamma = Display(transfer="gain-offset-gamma", gamma=1.8)
        text, quiet, surround = Ink.on(gamma).text, Ink.on(gamma).quiet, surround_gray(gamma)
        assert 0.0 <= text[0] < quiet[0] < surround[0]


class TestKeys:
    def chords(self, written):
        names = {ord(key): sign for key, sign in written.items()}
        return keys.digit_chords(5, lambda key, scancode: names.get(key))

    def test_row_and_keypad_with_and_without_shift(self):
        from imgui_bundle import imgui

        first = self.chords({"1": "1"})[0]
        shift = int(imgui.Key.mod_shift)
        wanted = (int(imgui.Key._1), int(imgui.Key.keypad1))
        assert set(first) == {*wanted, *(shift | key for key in wanted)}

    def test_french_keyboard(self):
        """There the row writes signs without Shift, and ImGui calls the fourth key apostrophe."""
        from imgui_bundle import imgui

        got = self.chords({"1": "&", "2": "é", "3": '"', "4": "'", "5": "("})
        assert int(imgui.Key.apostrophe) in got[3]
        assert [len(chords) for chords in got] == [4, 4, 4, 6, 4]
        everything = [chord for chords in got for chord in chords]
        assert len(set(everything)) == len(everything)


class TestPlaces:
    def test_pictures_are_centred_pixel_upon_pixel(self):
        shown = Presentation(haploscopic=True, gap_px=24.0)
        got = centred((1280, 800), (512, 500), shown)
        assert got.complete
        assert got.gap_px == 24
        assert got.rects == {"reference": (116, 150, 512, 500), "test": (652, 150, 512, 500)}
        mirrored = centred((1280, 800), (512, 500), Presentation(mirror=True, gap_px=24.0))
        assert mirrored.rects["test"] == got.rects["reference"]

    def test_no_room(self):
        shown = Presentation(gap_px=24.0)
        assert centred((1048, 512), (512, 512), shown) is not None
        assert centred((1047, 512), (512, 512), shown) is None
        assert centred((1048, 511), (512, 512), shown) is None

    @pytest.mark.parametrize("question", [False, True])
    @pytest.mark.parametrize("text_px", [13.0, 21.0, 40.0])
    def test_words_below_cover_neither_pictures_nor_each_other(self, question, text_px):
        margin, strip = placement.MARGIN * text_px, category_strip.FIELD_HEIGHT * text_px
        for free in range(0, 500, 3):
            got = Below.of(700.0, 700.0 + free, text_px, question=question)
            ends = 700.0 + free
            if got.strip is not None:
                assert got.strip >= 700.0 + margin
                assert got.strip + strip <= ends
                ends = got.strip
            if got.question is not None:
                assert got.question >= 700.0 + margin
                assert got.question + text_px <= ends
            assert question or got.question is None

    @pytest.mark.parametrize("question", [False, True])
    @pytest.mark.parametrize("strip", [False, True])
    def test_what_must_show_has_the_room_that_is_asked_for(self, question, strip):
        free = needed_below(20.0, question=question, strip=strip)
        got = Below.of(0.0, free, 20.0, question=question)
        assert (got.question is not None) == question
        assert got.strip is not None or not strip


class TestExperimenterLine:
    def test_the_time_left_is_by_the_median(self):
        told = []
        flow = SimpleNamespace(
            study=SimpleNamespace(questions=("ratio",)), trial=object(), phase=Phase.TRIAL
        )
        now_s = [0.0]
        answered = [0]
        flow.progress = lambda: Progress("O01", answered[0], 100, "matte", "ratio")
        line = ExperimenterLine(flow, lambda: now_s[0], lambda *words: told.append(words))
        assert told == [(0.0, "O01: 0 of 100, matte, ratio")]
        for took_s in (5.0, 6.0, 6.0, 600.0, 7.0):
            now_s[0] += took_s
            answered[0] += 1
            line.note_answer()
        assert told[-1] == (0.05, "O01: 5 of 100, matte, ratio, about 10 min left")
        line.note_break()
        now_s[0] += 3600.0
        line.note_answer()
        assert line.text.endswith("about 10 min left")
        flow.phase = Phase.ADAPTATION
        assert line.text.endswith("; Ctrl+Enter ends the adaptation")

    def test_tells_what_stands_on_the_screen_once(self):
        told = []
        flow = SimpleNamespace(
            study=SimpleNamespace(questions=("ratio",)), trial=object(), phase=Phase.CONSENT
        )
        flow.progress = lambda: Progress("O01", 0, 100, "matte", "ratio")
        line = ExperimenterLine(flow, lambda: 0.0, lambda share, text: told.append(text))
        for phase in (Phase.CONSENT, Phase.ADAPTATION, Phase.GAP, Phase.TRIAL, Phase.GAP):
            flow.phase = phase
            line.follow()
            line.follow()
        assert told == [
            "O01: 0 of 100, consent, matte, ratio",
            "O01: 0 of 100, adaptation, matte, ratio",
            "O01: 0 of 100, matte, ratio",
        ]


class TestFirstPage:
    def flow(self, store):
        observer = store.observer("O01")
        return Flow(store, observer, store.begin_run(observer, "device", {}), lambda: 0.0)

    def test_says_whose_session_goes_on(self, tmp_path):
        with Store(tmp_path / "s.sqlite", load_study("paper")) as store:
            assert continues(store, store.observer("O01")) == ""
            flow = self.flow(store)
            assert continues(store, flow.observer) == ""
            flow.confirm()  # who comes next has not agreed
            told = continues(store, store.observer("O01"))
            assert told == (
                "O01 continues: 0 of 126 are judged. Somebody else? Close the window (Ctrl+Q) and "
                "start with --new."
            )
            store.answer(flow.observer, flow.trial, "ratio", 1, 0.5, flow.run)
            told = continues(store, store.observer("O01"))
            assert told.startswith("O01 continues: 1 of 126 are judged.")
            page = pages.page_of(self.flow(store), answered=True, note=told)
            assert (page.text, page.note) == (store.study.guide, told)

    def test_of_one_who_has_judged_all(self):
        flow = SimpleNamespace(study=None, phase=Phase.FINISHED)
        assert pages.page_of(flow, answered=True, note="O01 goes on").note == "O01 goes on"


class TestProfile:
    def profile(self, kind):
        from PIL import ImageCms

        return ImageCms.ImageCmsProfile(ImageCms.createProfile(kind)).tobytes()

    def test_is_read_whole(self, tmp_path):
        file = tmp_path / "display.icc"
        file.write_bytes(self.profile("sRGB"))
        got = read_profile(file)
        assert got.data == file.read_bytes()
        assert "sRGB" in got.description

    def test_faults(self, tmp_path):
        text, lab = tmp_path / "text.icc", tmp_path / "lab.icc"
        text.write_bytes(bytes(np.arange(200, dtype=np.uint8)))
        lab.write_bytes(self.profile("LAB"))
        for file, words in (
            (text, "not an ICC profile"),
            (lab, "a profile of Lab, expected RGB"),
            (tmp_path / "none.icc", "can't be read"),
            (tmp_path, "this is a folder"),
        ):
            with pytest.raises(InputError, match=words) as caught:
                read_profile(file)
            assert "ICC profile" in str(caught.value)


class TestProfilesOfAnyText:
    """Text that is not what a profile declares: others write such files."""

    @pytest.fixture
    def data(self):
        return bytearray(ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes())

    def test_a_colour_space_that_is_no_text(self, data, tmp_path):
        data[16] = 0x9A
        (tmp_path / "a.icc").write_bytes(data)
        with pytest.raises(InputError, match=r"a\.icc: a profile of .*expected RGB") as caught:
            read_profile(tmp_path / "a.icc")
        assert str(caught.value).isprintable()

    @pytest.mark.parametrize("byte", [0x9A, 0xE9, 0xFF, 0x00, 0x1B])
    def test_a_description_in_other_than_ascii(self, data, tmp_path, byte):
        """As version 2 profiles have it: one byte a character, of whatever code page."""
        at = struct.unpack(">I", data[data.index(b"desc") + 4 :][:4])[0]
        words = bytes([byte]) * 5 + b"\0"
        data[at : at + 12 + len(words)] = b"desc\0\0\0\0" + struct.pack(">I", len(words)) + words
        (tmp_path / "a.icc").write_bytes(data)
        assert read_profile(tmp_path / "a.icc").description.isprintable()

    def test_any_bytes_are_read_or_refused(self, data, tmp_path):
        random = np.random.default_rng(5)
        outcomes = set()
        for _ in range(300):
            changed = bytearray(data)
            for at in random.integers(0, 0x160, 6):
                changed[at] = random.integers(256)
            (tmp_path / "a.icc").write_bytes(changed)
            try:
                assert read_profile(tmp_path / "a.icc").description.isprintable()
                outcomes.add("read")
            except InputError as error:
                assert str(error).isprintable()
                outcomes.add("refused")
        assert outcomes == {"read", "refused"}
