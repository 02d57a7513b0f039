"""A proof read from its page: bounded, whole, and every field checked before it is used."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, read_beginning, read_bytes, refuse, text
from relgloss_view.base.words import listed
from relgloss_view.proof.entries import LONGEST_FILE_NAME, MOST_FILES, check_entries
from relgloss_view.proof.page.parts import MARK, SEAL, Page
from relgloss_view.proof.proof import (
    FORMAT,
    MOST_MESSAGES,
    MOST_TITLE,
    VERSION,
    Message,
    Proof,
    Signature,
    canonical,
)
from relgloss_view.proof.settings import SIDES

EXPECTED = "a proof (HTML, from `relgloss proof make`)"
MAX_BYTES = 64 * 1024 * 1024
HEAD_BYTES = 2048  #: within which a proof is marked as one
MOST_NAMED = 6  #: changed parts that a message lists
AGAIN = "ask the sender for the file again, and send it as an attachment or in a ZIP"
#: What has to be in content, and its kind.
CONTENT: dict[str, type[Any]] = {
    "title": str,
    "size_px": list,
    "files": dict,
    "pictures": dict,
    "grid": dict,
    "drawing": dict,
}
_FILE_NAME = re.compile(r"[^/\\\0]+(/[^/\\\0]+)*")


def is_proof(path: str | os.PathLike[str]) -> bool:
    """Whether a file is marked as a proof, whatever its name; InputError where it can't be read."""
    return is_marked(read_beginning(path, HEAD_BYTES, EXPECTED))


def is_marked(head: bytes) -> bool:
    """Whether a file that begins so is a proof: one of its two marks is enough."""
    return any(mark.encode() in head for mark in (MARK, SEAL))


def read_page(path: str | os.PathLike[str]) -> Page:
    """The page of a proof, changed or not. Raises InputError for what is no proof's page."""
    data = read_bytes(path, MAX_BYTES, EXPECTED)
    if not is_marked(data[:HEAD_BYTES]):
        raise InputError(f"{named(path)}: not a proof; give {EXPECTED}")
    # A byte that is no UTF-8 becomes characters that no page holds, so that the seal finds it; one
    # that stands for it in a browser may be the page's own.
    return Page(data.decode("utf-8", errors="backslashreplace"))


def read_proof(path: str | os.PathLike[str]) -> Proof:
    """The proof of a page, with all its messages and the SHA-256 of each.

    path: an HTML file of `relgloss proof make`, of the window or of a browser that answered. Raises
    InputError, one line that names the file, where it is no proof or anything of it was changed.

    >>> from pathlib import Path
    >>> _ = Path("note.html").write_text("<p>hello</p>")
    >>> read_proof("note.html")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: note.html: not a proof; give a proof (HTML, from ...
    """
    page = read_page(path)
    try:
        return proof_of(page)
    except InputError as error:
        raise InputError(f"{named(path)}: {error}") from error


def proof_of(page: Page) -> Proof:
    """The proof of a page that was read; InputError without the file's name."""
    check_version(page)
    if page.changes:
        raise InputError(f"{changed_words(page.changes)}; {AGAIN}")
    proof = Proof(*_checked(page.block("proof")), signatures=_signatures(page.block("signatures")))
    for k, signature in enumerate(proof.signatures):
        if signature.message >= len(proof.messages):
            refuse(
                f"signatures[{k}].message",
                f"one of the {len(proof.messages)} messages, counted from 0",
                signature.message,
            )
    for k, message in enumerate(proof.messages[1:], start=1):
        if message.parent != proof.digests[k - 1]:
            refuse(
                f"messages[{k}].parent", f"{proof.digests[k - 1]}, what it answers", message.parent
            )
    return proof


def check_version(page: Page) -> None:
    """InputError where a newer program has made the page; passes where that can't be known."""
    try:
        version = page.block("proof")["version"]
    except (InputError, KeyError, TypeError):
        return
    if type(version) is int and version > VERSION:
        raise InputError(
            f"made by a newer program (version {version} of the format, this one reads {VERSION}); "
            "update relgloss"
        )


def changed_words(changes: tuple[str, ...]) -> str:
    """One clause that names what was changed.

    >>> changed_words(("messages/3/note", "static"))
    "changed after it was made: message 3's note and the page's static words"
    """
    names = [part_words(name) for name in changes[:MOST_NAMED]]
    if len(changes) > MOST_NAMED:
        names.append(f"{len(changes) - MOST_NAMED} further parts")
    return f"changed after it was made: {listed(names)}"


def part_words(name: str) -> str:
    """A part's name as `Page.changes` has it, for people."""
    kind, _, rest = name.partition("/")
    if kind == "messages":
        number, _, entry = rest.partition("/")
        return f"message {number}'s {entry}"
    if kind == "shaders" and rest:
        return f"the shader {rest}"
    if kind == "content":
        part, _, entry = rest.partition("/")
        if entry:
            return (
                f"the stored picture of the {entry}" if part == "pictures" else f"the file {entry}"
            )
        return f"the proof's {part}"
    return PART_WORDS.get(name, name)


PART_WORDS = {
    "head": "the page's head",
    "style": "the page's style",
    "static": "the page's static words",
    "proof": "the proof itself",
    "signatures": "the signatures",
    "shaders": "the shaders",
    "words": "the page's table of words",
    "parts": "the list of parts",
    "script": "the page's program",
    "page": "the page's markup",
    "seal": "the seal",
    "name": "the proof's digest in the page's head",
    "lines": "the ends of its lines, as some mail programs and editors do",
    "mark": "the file's beginning, where an editor has added a byte order mark",
}


def _checked(content: object) -> tuple[Mapping[str, Any], tuple[Message, ...]]:
    """What is sealed, as content and messages; InputError names the place."""
    if not isinstance(content, dict) or content.get("format") != FORMAT:
        found = content.get("format") if isinstance(content, dict) else content
        refuse("format", f'"{FORMAT}"', found)
    if set(content) != {"content", "format", "messages", "version"}:
        refuse("proof", "content, format, messages and version", list(content))
    if type(content["version"]) is not int or content["version"] != VERSION:
        refuse("version", str(VERSION), content["version"])
    listed_messages = content["messages"]
    if not isinstance(listed_messages, list) or not 0 < len(listed_messages) <= MOST_MESSAGES:
        count = len(listed_messages) if isinstance(listed_messages, list) else listed_messages
        refuse("messages", f"1 to {MOST_MESSAGES} messages", count)
    messages = []
    for k, values in enumerate(listed_messages):
        try:
            message = Message.from_json(values)
        except InputError as error:
            raise InputError(f"messages[{k}].{error}") from error
        if canonical(message.as_json()) != canonical(values):
            raise InputError(
                f"messages[{k}].settings: expected every entry, written as this program does"
            )
        messages.append(message)
    check_content(content["content"])
    return content["content"], tuple(messages)


def check_content(content: object) -> None:
    """InputError where content lacks a part, or one is of another kind or beyond its bounds."""
    if not isinstance(content, dict):
        refuse("content", "an object", content)
    for name, kind in CONTENT.items():
        if not isinstance(content.get(name), kind):
            words = "a text" if kind is str else "a list" if kind is list else "an object"
            refuse(f"content.{name}", words, content.get(name))
    if len(text(content["title"], "content.title")) > MOST_TITLE:
        raise InputError(f"content.title: longer than {MOST_TITLE} characters; shorten it")
    check_entries(content)
    if set(content["pictures"]) != set(SIDES):
        refuse("content.pictures", " and ".join(SIDES), list(content["pictures"]))
    files = content["files"]
    if "scene.toml" not in files or len(files) > MOST_FILES:
        refuse("content.files", f"scene.toml and at most {MOST_FILES} files", list(files))
    for name, value in files.items():
        _check_file(name, value)


def _check_file(name: str, value: object) -> None:
    place = f"content.files[{name[:60]!r}]"
    steps = name.split("/")
    if (
        len(name) > LONGEST_FILE_NAME
        or not _FILE_NAME.fullmatch(text(name, place))
        or any(step in (".", "..") for step in steps)
        or ":" in steps[0]
    ):
        refuse(place, "the name of a file within the proof's own folder", name)
    held = value if isinstance(value, dict) else {}
    texts = all(isinstance(entry, str) for entry in held.values())
    if not texts or set(held) not in ({"text"}, {"base64", "type"}):
        refuse(place, '{"text": ...} or {"base64": ..., "type": ...}', list(held) or value)


def _signatures(values: object) -> tuple[Signature, ...]:
    if not isinstance(values, list) or len(values) > MOST_MESSAGES:
        refuse("signatures", f"a list of at most {MOST_MESSAGES}", values)
    signatures = []
    for k, value in enumerate(values):
        place = f"signatures[{k}]"
        if not isinstance(value, dict) or set(value) != {"message", "key", "signature"}:
            refuse(place, "message, key and signature", value)
        try:
            signatures.append(Signature(**value))
        except InputError as error:
            raise InputError(f"{place}.{error}") from error
    return tuple(signatures)
