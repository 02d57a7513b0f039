"""A proof in the window's state: whose settings show, what was changed, chains of replies."""

from __future__ import annotations

import dataclasses
import random

import pytest

from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.screen_words import screen_line
from relgloss_view.proof.screens import Screen
from relgloss_view.proof.settings import Settings
from relgloss_view.viewer.state import matching
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.proofs import (
    OpenProof,
    author_of,
    changed_parts,
    message_words,
    monitor_as_sent,
    settings_of,
    shown_message,
    standing_words,
    with_settings,
)
from relgloss_view.viewer.state.screens import Screen as Monitored
from relgloss_view.viewer.state.state import AS_DECLARED, State

CHAIN = 20


def moved(state, seed):
    """A state with another setting, eye and lamp on both sides; the same for the same seed."""
    draw = random.Random(seed)
    state = state.with_part("eye", azimuth_deg=draw.uniform(-60, 60), distance_m=draw.uniform(1, 3))
    state = state.with_part("lamp", azimuth_deg=draw.uniform(-90, 90), illuminant="D65")
    for side in ("reference", "test"):
        setting = Setting(draw.uniform(0.0, 5.0), c=draw.uniform(0.01, 1.0))
        state = state.with_setting(side, setting)
    return state


def chain(base, count):
    """A proof with a thread of so many messages, each with other settings and its own note."""
    first = Message(settings_of(base), "note 0", "author 0", "2026-11-27T08:00:00Z")
    proof = Proof({"title": "a can", "files": {}}, (first,))
    for k in range(1, count):
        settings = settings_of(moved(base, k))
        made = f"2026-11-27T08:{k:02d}:00Z"
        proof = proof.answered(Message(settings, f"note {k}", f"author {k}", made))
    return proof


@pytest.fixture(scope="module")
def opened():
    base = State.initial()
    proof = chain(base, CHAIN)
    return OpenProof("chain.html", "/unpacked", proof, base, ("not signed",) * CHAIN)


def test_settings_come_back_exactly():
    base = State.initial()
    for seed in range(20):
        state = moved(base, seed)
        stored = Settings.from_json(settings_of(state).as_json())
        assert with_settings(base, stored) == state
        assert with_settings(base, stored) != base


def test_a_lamp_of_the_proof_is_named_without_its_folder():
    base = State.initial().with_part("lamp", illuminant="/unpacked/lamp.csv")
    settings = settings_of(base, "/unpacked")
    assert settings.lamp.illuminant == "lamp.csv"
    assert with_settings(State.initial(), settings, "/unpacked") == base
    assert settings_of(base, "/elsewhere").lamp.illuminant == "/unpacked/lamp.csv"


def test_every_message_of_a_long_chain_shows_its_own_settings(opened):
    model = Model(State.initial())
    model.proof = opened
    for k in (*range(CHAIN), *reversed(range(CHAIN))):
        model.show_message(k)
        assert settings_of(model.state) == opened.proof.messages[k].settings
        assert shown_message(model.state, opened) == k
        assert opened.proof.messages[k].note == f"note {k}"
        assert standing_words(model.state, opened) == f"As sent by author {k}"
    assert model.history.can_undo


def test_showing_a_message_is_one_step_that_undo_takes_back(opened):
    model = Model(moved(opened.base, 99))
    model.proof = opened
    before = model.state
    model.show_message(3)
    assert model.state != before
    model.history.undo()
    assert model.state == before
    assert not model.history.can_undo


def test_a_change_of_ones_own_is_always_named(opened):
    sent = opened.newest
    assert shown_message(sent, opened) == CHAIN - 1
    slid = sent.with_setting("test", Setting(sent.test.look.sigma_n_deg, c=0.77))
    assert shown_message(slid, opened) is None
    assert standing_words(slid, opened) == "Changed by you"
    other = matching.with_sample(sent, "test", Sample.built_in("uncoated"))
    assert shown_message(other, opened) is None
    assert "the test's sample" in standing_words(other, opened)


def test_of_equal_messages_the_one_that_was_chosen_is_named():
    base = State.initial()
    first = Message(settings_of(base), author="A")
    proof = Proof({}, (first,)).answered(Message(settings_of(base), author="B"))
    opened = OpenProof("", "", proof, base, ("", ""))
    assert standing_words(base, opened) == "As sent by B"
    assert standing_words(base, opened, 0) == "As sent by A"


@pytest.mark.parametrize(
    ("change", "part"),
    [
        (lambda s: s.with_part("shape", diameter_m=0.5), "the form"),
        (lambda s: s.with_part("lamp", ambient=0.3), "size, strength or number of the lamps"),
        (lambda s: s.with_part("display", luminance_cd_m2=300.0), "the display"),
        (lambda s: s.with_look("reference", seed=7), "the reference's grain"),
        (lambda s: s.with_sample("reference", Sample.built_in("uncoated")), "the reference's"),
    ],
)
def test_what_a_reply_cannot_hold_is_named(change, part):
    base = State.initial()
    assert any(part in words for words in changed_parts(change(base), base))


def test_what_changes_neither_sample_nor_light_needs_no_new_proof():
    base = State.initial()
    state = moved(base, 1).with_part("presentation", compare="wipe", overlay="clipped")
    state = dataclasses.replace(state.with_look("test", quality="exact"), match=None)
    assert changed_parts(state, base) == ()


def test_words_of_a_message_name_what_moved(opened):
    first, second = message_words(opened.proof, 0), message_words(opened.proof, 1)
    assert first[0].startswith("Reference: graininess")
    assert len(first) == 2
    assert second[2:] == ("Object turned or moved", "Lamp's light: D65", "Lamp moved")


def test_a_hostile_name_stays_on_one_line():
    message = Message(opened_settings(), author="a\nb\x1b[31m" + "x" * 150)
    assert "\n" not in author_of(message)
    assert "\x1b" not in author_of(message)
    assert len(author_of(message)) <= 60


def opened_settings():
    return settings_of(State.initial())


PROFILE = "/usr/share/color/icc/colord/AdobeRGB1998.icc"


class TestMonitor:
    """What a message from the window holds of the monitor."""

    def test_nothing_is_made_up(self):
        assert monitor_as_sent(State.initial(), Monitored(), is_reply=False) is None

    def test_what_the_scene_declares_is_the_senders(self):
        state = State.initial().with_part("display", luminance_cd_m2=160.0, black_cd_m2=0.8)
        sent = monitor_as_sent(state, Monitored(), is_reply=False)
        assert sent["white_cd_m2"] == 160.0
        assert sent["black_least"] == pytest.approx(0.005)
        assert sent["black_most"] is None  # the light of the room is not known
        assert Screen.from_json(sent).as_json() == sent
        # A reply's scene has the designer's display, which is not the replier's.
        assert monitor_as_sent(state, Monitored(), is_reply=True) is None
        declared = state.with_part("presentation", screen=AS_DECLARED)
        assert monitor_as_sent(declared, Monitored(), is_reply=False) is None

    def test_the_profile_of_the_system_is_named(self):
        sent = monitor_as_sent(
            State.initial(), Monitored(PROFILE, "Adobe RGB (1998)"), is_reply=True
        )
        assert sent["name"] == "Adobe RGB (1998)"
        assert screen_line(sent).startswith("Adobe RGB (1998)")

    def test_a_screen_that_no_page_wrote_is_no_error(self):
        assert screen_line({"white_cd_m2": "<b>"}) == (
            "described in a way that this version does not read"
        )
        assert screen_line(None) == ""
