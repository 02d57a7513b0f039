"""Proofs as the window's files: opened with the newest settings, refused, answered, made anew."""

from __future__ import annotations

import dataclasses
import os
import re
import threading
from pathlib import Path

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.proof.content import content_of
from relgloss_view.proof.keys import make_key
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.quality.backends import open_renderer
from relgloss_view.viewer.files import proof_files, proof_writing
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.files.proof_files import opened_proof, tidy, unpacked_folder, write_signed
from relgloss_view.viewer.files.proof_writing import ProofRequest, ProofWriting, written
from relgloss_view.viewer.files.same_picture import same_picture
from relgloss_view.viewer.state import matching
from relgloss_view.viewer.state.proofs import settings_of, shown_message
from relgloss_view.viewer.state.state import State
from relgloss_view.viewer.state.state_file import load_state

CHAIN = 20
LIMIT_S = 60.0


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("RELGLOSS_HOME", str(tmp_path / "home"))
    return tmp_path / "home"


@pytest.fixture(scope="module")
def made():
    """A proof of the initial pair, its pictures small."""
    state = State.initial()
    scene = SceneFile(
        state.test.sample, state.test.look, state.setup, state.reference.sample,
        state.reference.look, match=state.match,
    )  # fmt: skip
    with open_renderer() as renderer:
        content = content_of(scene, renderer, size=(64, 48), title="A green paper")
    message = Message(content.settings, "Is this enough?", "Maria", "2026-11-27T08:00:00Z")
    return Proof(content.content, (message,))


@pytest.fixture
def file(made, tmp_path):
    path = str(tmp_path / "paper.html")
    write_signed(made, path)
    return path


def moved(state, k):
    """A state with settings that belong to message k alone."""
    state = state.with_part("eye", azimuth_deg=float(k)).with_part("lamp", azimuth_deg=10.0 + k)
    return state.with_setting("test", Setting(0.1 * k, c=0.05 + 0.01 * k))


def test_a_proof_opens_with_the_settings_of_its_newest_message(file, made):
    job = OpenJob(file, lambda: None)
    assert job.wait(LIMIT_S)
    assert job.fault is None
    opened = job.result.proof
    assert settings_of(job.result.state, opened.folder) == made.sent
    assert shown_message(job.result.state, opened) == 0
    assert opened.signed == ("not signed",)
    assert job.result.state.match == State.initial().match
    # Its files stay where the session can name them.
    assert os.path.isfile(job.result.state.test.sample.file)


def test_a_changed_file_is_refused_in_one_line_that_names_the_change(file, tmp_path):
    text = Path(file).read_text(encoding="utf-8")
    changed = tmp_path / "changed.html"
    changed.write_text(text.replace('"Is this enough?"', '"Is this too much?"'), encoding="utf-8")
    job = OpenJob(changed, lambda: None)
    assert job.wait(LIMIT_S)
    assert job.result is None
    assert "note" in job.fault
    assert "\n" not in job.fault
    assert not (proof_files.state_folder() / "proofs").exists()


def test_a_page_that_is_no_proof_is_refused_as_one(tmp_path):
    page = tmp_path / "page.html"
    page.write_text("<!DOCTYPE html>\n<html><body>hello</body></html>", encoding="utf-8")
    job = OpenJob(page, lambda: None)
    assert job.wait(LIMIT_S)
    assert "not a proof" in job.fault


def test_twenty_answers_from_the_window_keep_every_setting_and_note(file, tmp_path):
    opened = opened_proof(file)
    for k in range(1, CHAIN):
        path = str(tmp_path / f"answer-{k}.html")
        request = ProofRequest(
            path, moved(opened.newest, k), f"note {k}", f"author {k}", answers=opened
        )
        assert request.is_reply
        written(request)
        opened = dataclasses.replace(opened_proof(path), base=opened.base)
    proof = opened_proof(path).proof
    assert len(proof.messages) == CHAIN
    assert [m.note for m in proof.messages[1:]] == [f"note {k}" for k in range(1, CHAIN)]
    for k, message in enumerate(proof.messages[1:], start=1):
        assert message.settings == settings_of(moved(opened.base, k), opened.folder)
        assert message.parent == proof.digests[k - 1]
        assert settings_of(opened.at(k), opened.folder) == message.settings


def test_a_signed_answer_is_by_an_unknown_key(file, tmp_path):
    make_key(tmp_path / "key.pem")
    opened = opened_proof(file)
    path = str(tmp_path / "answer.html")
    request = ProofRequest(path, opened.newest, "Yes", key=str(tmp_path / "key.pem"),
                           answers=opened)  # fmt: skip
    done = written(request)
    signed = opened_proof(path).signed
    assert signed[0] == "not signed"
    assert signed[1].startswith("signed by an unknown key ")
    assert done.opened(request).signed == signed


def test_what_a_reply_cannot_hold_becomes_a_new_proof_that_names_its_parent(
    file, tmp_path, monkeypatch, made
):
    opened = opened_proof(file)
    state = matching.with_sample(opened.newest, "test", Sample.built_in("uncoated"))
    request = ProofRequest(str(tmp_path / "other.html"), state, "Softer?", "Jo", answers=opened)
    assert not request.is_reply

    def made_here(words, cancelled):
        # What the command does is tested with the command; here it is what it is asked for.
        scene, output = words[2], words[4]
        assert load_state(scene).test.sample.name == "uncoated"
        write_signed(made, output)

    monkeypatch.setattr(proof_writing, "_run", made_here)
    written(request)
    proof = opened_proof(str(tmp_path / "other.html")).proof
    assert len(proof.messages) == 1
    assert proof.messages[0].parent == opened.proof.digest
    assert (proof.messages[0].note, proof.messages[0].author) == ("Softer?", "Jo")


@pytest.mark.slow
def test_the_window_makes_a_new_proof_of_what_it_shows(tmp_path):
    state = moved(State.initial(), 3)
    path = tmp_path / "new.html"
    written(ProofRequest(str(path), state, "A note", "Jo", "A title"))
    opened = opened_proof(str(path))
    assert settings_of(opened.base) == settings_of(state)
    assert (opened.proof.title, opened.proof.messages[0].note) == ("A title", "A note")
    assert opened.proof.messages[0].parent == ""
    lost = state.with_part("display", profile="/gone.icc")
    with pytest.raises(InputError, match="the proof was not made"):
        written(ProofRequest(str(path), lost))
    assert opened_proof(str(path)).proof == opened.proof


def test_a_failed_or_cancelled_proof_leaves_nothing(file, tmp_path):
    opened = opened_proof(file)
    path = tmp_path / "answer.html"
    path.write_text("before", encoding="utf-8")
    cancelled = threading.Event()
    cancelled.set()
    with pytest.raises(InputError, match="cancelled"):
        written(ProofRequest(str(path), opened.newest, answers=opened), cancelled)
    with pytest.raises(InputError, match=re.escape("missing.pem")):
        written(ProofRequest(str(path), opened.newest, key=str(tmp_path / "missing.pem"),
                             answers=opened))  # fmt: skip
    assert path.read_text(encoding="utf-8") == "before"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["answer.html", "home", "paper.html"]


def test_writing_in_the_background_reports_its_end(file, tmp_path):
    opened = opened_proof(file)
    ended = threading.Event()
    writing = ProofWriting(ended.set)
    path = str(tmp_path / "answer.html")
    writing.start(ProofRequest(path, opened.newest, "Yes", answers=opened))
    assert writing.busy
    assert ended.wait(LIMIT_S)
    _, done, fault = writing.take()
    assert fault == ""
    assert done.proof.messages[-1].note == "Yes"
    assert "send this one file" in done.words
    assert not writing.busy


def test_the_grid_tells_this_picture_from_another(file):
    opened = opened_proof(file)
    with open_renderer() as renderer:
        assert same_picture(opened, renderer).same
        other = dataclasses.replace(
            opened, base=matching.with_sample(opened.base, "test", Sample.built_in("uncoated"))
        )
        found = same_picture(other, renderer)
    assert not found.same
    assert found.largest > 1.0  # another colour of ink


def test_unpacked_proofs_go_when_no_session_names_them(made):
    folder = unpacked_folder(made)
    parent = folder.parent
    for name in ("old", "named"):
        (parent / name).mkdir()
        os.utime(parent / name, (0.0, 0.0))
    session = proof_files.session_file()
    session.parent.mkdir(parents=True, exist_ok=True)
    session.write_text(f'material = "{parent}/named/materials/test.json"', encoding="utf-8")
    tidy(parent, folder.name)
    assert sorted(p.name for p in parent.iterdir()) == sorted([folder.name, "named"])
