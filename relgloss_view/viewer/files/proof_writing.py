"""Writing a proof from the window: a new one, or a reply to the one that is open. No ImGui.

A new proof is drawn, checked and compressed by `relgloss proof make` in a process of its own, so
that the window draws meanwhile; a cancelled one leaves no file. A reply keeps all that was sent and
adds a message, which takes no time.
"""

from __future__ import annotations

import dataclasses
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from relgloss_view.base import child, followed
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.version import PROGRAM
from relgloss_view.proof.proof import (
    MOST_AUTHOR,
    MOST_NOTE,
    MOST_TITLE,
    Message,
    Proof,
    present_time,
)
from relgloss_view.viewer.files.background import Worker
from relgloss_view.viewer.files.proof_files import read, signed_words, write_signed
from relgloss_view.viewer.files.scene_saving import save_scene
from relgloss_view.viewer.state.proofs import (
    OpenProof,
    changed_parts,
    monitor_as_sent,
    settings_of,
)
from relgloss_view.viewer.state.screens import Screen as Monitored
from relgloss_view.viewer.state.state import State

LONGEST_S = 1800.0
LONGEST_FAULT = 300
CANCELLED = "cancelled"
LONGEST_TEXT = {"title": MOST_TITLE, "author": MOST_AUTHOR, "note": MOST_NOTE}  #: characters


@dataclass(frozen=True)
class ProofRequest:
    """A proof to write.

    state: what it shows. answers: the open proof that it answers, or None. key: file of the key
    that signs it, '' for none. title: '' takes the sample's name; a reply keeps its title. monitor:
    that the window lies on. make: gives the state in the background, in the place of `state`.
    """

    path: str
    state: State
    note: str = ""
    author: str = ""
    title: str = ""
    key: str = ""
    answers: OpenProof | None = None
    monitor: Monitored = field(default_factory=Monitored)
    make: Callable[[], State] | None = None

    @property
    def beyond(self) -> tuple[str, ...]:
        """What a reply can't hold, so that this has to be a new proof; see changed_parts."""
        return () if self.answers is None else changed_parts(self.state, self.answers.base)

    @property
    def is_reply(self) -> bool:
        """Whether it adds a message to a proof that keeps its content."""
        return self.answers is not None and not self.beyond


@dataclass(frozen=True)
class OtherPair:
    """A pair that is not the window's, to be written as a proof.

    name: of the sample, the proof's title. words: what the proof will show, one sentence. make:
    gives the pair, in the background.
    """

    name: str
    words: str
    note: str
    make: Callable[[], State]


@dataclass(frozen=True)
class WrittenProof:
    """A proof that was written: its file, what it holds, its size in bytes."""

    path: str
    proof: Proof
    size: int

    @property
    def words(self) -> str:
        """A message for the status line."""
        folder, name = os.path.split(self.path)
        return f"saved {name}, {self.size / 1000:.0f} kB, to {folder}; send this one file"

    def opened(self, request: ProofRequest) -> OpenProof:
        """The reply in the place of the open proof that it answers."""
        assert request.answers is not None
        signed = signed_words(self.proof)
        return dataclasses.replace(request.answers, path=self.path, proof=self.proof, signed=signed)


class ProofWriting:
    """Writes one proof at a time in the background; `wake` is called when one ends."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._worker: Worker[ProofRequest, WrittenProof] = Worker(wake)
        self._cancelled = threading.Event()

    @property
    def busy(self) -> bool:
        """Whether a proof is being written, or has ended and was not taken yet."""
        return self._worker.busy

    def start(self, request: ProofRequest) -> None:
        """Begin to write a proof."""
        self._cancelled = cancelled = threading.Event()
        self._worker.start(request, lambda: written(request, cancelled))

    def cancel(self) -> None:
        """Stop; nothing is left."""
        self._cancelled.set()

    def take(self) -> tuple[ProofRequest, WrittenProof | None, str] | None:
        """What has ended since this was last asked: the request, the file, or why there is none."""
        ended = self._worker.take()
        return None if ended is None else (ended.key, ended.value, ended.fault)


def written(request: ProofRequest, cancelled: threading.Event | None = None) -> WrittenProof:
    """Write a proof, whole or not at all. Raises InputError."""
    cancelled = cancelled or threading.Event()
    if request.make is not None:
        request = dataclasses.replace(request, state=request.make(), make=None)
    answers = request.answers
    if answers is not None and request.is_reply:
        proof = answers.proof.answered(_message(request, answers.folder))
    else:
        proof = _new(request, cancelled)
    if cancelled.is_set():
        raise InputError(CANCELLED)
    proof = write_signed(proof, request.path, request.key)
    return WrittenProof(request.path, proof, os.path.getsize(request.path))


def _message(request: ProofRequest, folder: str = "") -> Message:
    return Message(
        settings_of(request.state, folder), request.note, request.author, present_time(), PROGRAM,
        screen=monitor_as_sent(request.state, request.monitor, is_reply=True),
    )  # fmt: skip


def _new(request: ProofRequest, cancelled: threading.Event) -> Proof:
    """A new proof of the state; it names the proof that it answers, if any, as its parent."""
    with tempfile.TemporaryDirectory(prefix="relgloss-") as name:
        scene, file = Path(name) / "scene.toml", Path(name) / "proof.html"
        save_scene(scene, request.state)
        words = ["proof", "make", str(scene), "-o", str(file)]
        words += ["--title", request.title] if request.title else []
        _run(words, cancelled)
        proof = read(str(file))
    answered = request.answers is not None
    parent = "" if request.answers is None else request.answers.proof.digest
    first = dataclasses.replace(
        proof.messages[0], note=request.note, author=request.author, parent=parent,
        screen=monitor_as_sent(request.state, request.monitor, is_reply=answered),
    )  # fmt: skip
    return Proof(proof.content, (first,))


def _run(words: list[str], cancelled: threading.Event) -> None:
    """Run a command of this program in a process. InputError with its line where it fails."""
    path = os.pathsep.join(filter(None, (str(child.PACKAGE_FOLDER), os.environ.get("PYTHONPATH"))))
    try:
        process = child.Child(
            [sys.executable, "-m", followed.__name__, "relgloss_view.cli", *words],
            followed=True,
            env={**os.environ, "PYTHONPATH": path},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
    except (OSError, ValueError) as error:
        raise InputError(f"no process can be made to draw the proof ({error})") from error

    def step() -> None:
        if cancelled.is_set():
            raise InputError(CANCELLED)

    outcome = process.outcome(LONGEST_S, step)
    if outcome.status != 0:
        lines = [line for line in outcome.err.splitlines() if line.strip()]
        reason = outcome.crash or (lines[-1] if lines else f"exit status {outcome.status}")
        raise InputError(f"the proof was not made: {printable(reason, LONGEST_FAULT)}")
