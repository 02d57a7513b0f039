"""Proofs as files of the window: told apart, checked, unpacked, written.

No OpenGL, no window library: a thread of OpenJob does it. A proof's scene is unpacked into a folder
beside the session, since the session names its files; folders that no session names any more are
removed after a while.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import shutil
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import read_beginning
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.writing import make_folder, whole_file
from relgloss_view.picture.scene.file_kinds import EXPECTED
from relgloss_view.proof.proof import Proof, canonical
from relgloss_view.viewer.state.places import config_folder, state_folder
from relgloss_view.viewer.state.proofs import OpenProof
from relgloss_view.viewer.state.session import session_file
from relgloss_view.viewer.state.state_file import load_state

PROOF = "proof"
PROOF_SUFFIXES = (".html",)
UNSIGNED = "not signed"
KEPT_S = 30 * 86400.0  #: for which an unpacked proof stays that no session names
_MARK = b"<!doctype html"
_temporary: list[tempfile.TemporaryDirectory[str]] = []  #: where there is no folder of the user's


def is_proof_file(path: str | os.PathLike[str]) -> bool:
    """Whether a file is an HTML page, or marked as a proof. InputError where it can't be read.

    A page that is no proof, and a proof with a damaged beginning, are then refused by their reader.
    """
    from relgloss_view.proof.read import HEAD_BYTES, is_marked

    head = read_beginning(path, HEAD_BYTES, EXPECTED)
    page = head.removeprefix(b"\xef\xbb\xbf").lower().startswith(_MARK)
    return page or is_marked(head)


def read(path: str) -> Proof:
    """The proof of a file. InputError, one line, names what was changed in a damaged one."""
    from relgloss_view.proof.read import read_proof

    return read_proof(path)


def signed_words(proof: Proof) -> tuple[str, ...]:
    """Who signed each message, one a message, as the user of this window knows the keys.

    Raises InputError where the table of known keys is damaged.
    """
    from relgloss_view.proof.keys import checked, known_keys

    try:
        folder = config_folder()
    except InputError:  # there is no home folder, so no key is known
        known = {}
    else:
        known = known_keys(folder)
    words: list[list[str]] = [[] for _ in proof.messages]
    for signature in checked(proof, known):
        words[signature.message].append(signature.words)
    return tuple("; ".join(one) or UNSIGNED for one in words)


def write_signed(proof: Proof, path: str, key: str = "") -> Proof:
    """Write a proof, whole or not at all, signed by a key's file where one is named.

    Returns it with its signature. Raises InputError.
    """
    from relgloss_view.proof.keys import read_private, signed
    from relgloss_view.proof.page.whole import page_of

    if key:
        proof = signed(proof, read_private(key))
    html = page_of(proof)
    with whole_file(path) as temporary:
        temporary.write_text(html, encoding="utf-8", newline="\n")
    return proof


def opened_proof(path: str, progress: ProgressReport = no_progress) -> OpenProof:
    """A proof, checked before anything of it is used, and its scene. InputError, one line."""
    progress(0.1, "checking that nothing was changed")
    proof = read(path)
    signed = signed_words(proof)
    progress(0.3, "unpacking")
    folder = unpacked_folder(proof)
    progress(0.5, "reading the scene")
    base = load_state(
        folder / "scene.toml", progress=lambda share, text: progress(0.5 + 0.5 * share, text)
    )
    return OpenProof(path, str(folder), proof, base, signed)


def unpacked_folder(proof: Proof) -> Path:
    """The folder with a proof's files, the same for all proofs of a thread."""
    from relgloss_view.proof.unpack import contents_of, unpacked

    contents = contents_of(proof.content.get("files"))
    name = hashlib.sha256(canonical(proof.content)).hexdigest()[:16]
    try:
        folder = make_folder(state_folder() / "proofs")
    except InputError:  # no home folder, or one that can't be written
        made = tempfile.TemporaryDirectory(prefix="relgloss-proof-")
        _temporary.append(made)
        folder = Path(made.name)
    tidy(folder, name)
    if not _holds(folder / name, contents):
        shutil.rmtree(folder / name, ignore_errors=True)
        unpacked(proof, folder / name)
    return folder / name


def _holds(folder: Path, contents: Mapping[str, bytes]) -> bool:
    """Whether a folder has these files, byte for byte: states that name them are still right."""
    try:
        return all((folder / name).read_bytes() == data for name, data in contents.items())
    except OSError:
        return False


def tidy(folder: Path, kept: str = "", now_s: float | None = None) -> None:
    """Remove unpacked proofs that are old and that the session does not name; raises nothing."""
    now_s = time.time() if now_s is None else now_s
    session = ""
    with contextlib.suppress(OSError, InputError):
        session = session_file().read_text(encoding="utf-8", errors="replace")
    with contextlib.suppress(OSError):
        for one in folder.iterdir():
            old = now_s - one.stat().st_mtime > KEPT_S
            if one.is_dir() and one.name != kept and old and one.name not in session:
                shutil.rmtree(one, ignore_errors=True)
