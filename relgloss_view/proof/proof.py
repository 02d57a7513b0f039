"""Proof: what is sent, and the thread of messages about it, sealed by SHA-256.

The JSON of a proof is canonical (RFC 8785), and its SHA-256 is the proof's name. A reply keeps the
content and adds a message that names the proof it answers. So the JSON of every earlier proof of
the thread is inside: the same content with fewer messages. Whoever has the last one can check all.

    {"content": {...}, "format": "relgloss-proof", "messages": [{...}, ...], "version": 1}
"""

from __future__ import annotations

import dataclasses
import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import refuse, text
from relgloss_view.proof.settings import Settings

FORMAT, VERSION = "relgloss-proof", 1
MOST_NOTE, MOST_AUTHOR, MOST_PROGRAM = 20_000, 200, 100  #: characters
MOST_TITLE = 200  #: characters, of the content
ARTWORK_PX = 2048  #: of the longer side of an artwork that goes along, unless asked otherwise
MOST_MESSAGES = 500
MOST_SCREEN_BYTES = 20_000  #: of its canonical JSON
TIME = "%Y-%m-%dT%H:%M:%SZ"
_DIGEST = re.compile(r"[0-9a-f]{64}")


@dataclass(frozen=True)
class Message:
    """What one side hands to the other.

    settings: that they look at. note and author: plain text, of any language, '' for none.
    made: time in UTC, such as '2026-11-27T08:30:00Z'. program: that made it, with its version.
    parent: SHA-256 of the proof that this answers, hexadecimal; '' of the first.
    screen: what is known of the author's display (screens.py), or None.

    Raises InputError where a field is too long or of another kind.
    """

    settings: Settings
    note: str = ""
    author: str = ""
    made: str = ""
    program: str = ""
    parent: str = ""
    screen: Mapping[str, Any] | None = None

    def __post_init__(self) -> None:
        for name, most in TEXTS.items():
            if len(text(getattr(self, name), name)) > most:
                raise InputError(f"{name}: longer than {most} characters; shorten it")
        if self.made and not _is_time(self.made):
            refuse("made", "a time in UTC such as 2026-11-27T08:30:00Z, or nothing", self.made)
        if self.parent and not _DIGEST.fullmatch(self.parent):
            refuse("parent", "the SHA-256 of a proof (64 digits 0-9, a-f), or nothing", self.parent)
        if self.screen is None:
            return
        if not isinstance(self.screen, Mapping):
            refuse("screen", "an object or null", self.screen)
        if len(canonical(self.screen)) > MOST_SCREEN_BYTES:
            raise InputError(f"screen: longer than {MOST_SCREEN_BYTES} bytes; leave entries out")

    @classmethod
    def from_json(cls, content: object) -> Message:
        """Of a proof's JSON; InputError names the field that is wrong."""
        names = [f.name for f in dataclasses.fields(cls)]
        if not isinstance(content, Mapping) or set(content) != set(names):
            found = list(content) if isinstance(content, Mapping) else content
            refuse("entries", ", ".join(names), found)
        return cls(**{**content, "settings": Settings.from_json(content["settings"])})

    def as_json(self) -> dict[str, Any]:
        """As a proof's JSON holds it."""
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return {**fields, "settings": self.settings.as_json()}


TEXTS = {"note": MOST_NOTE, "author": MOST_AUTHOR, "made": 20, "program": MOST_PROGRAM} | {
    "parent": 64
}


def present_time() -> str:
    """The time now, as a message's `made` holds it."""
    return datetime.now(UTC).strftime(TIME)


def _is_time(made: str) -> bool:
    try:
        return datetime.strptime(made, TIME).strftime(TIME) == made
    except ValueError:
        return False


@dataclass(frozen=True)
class Signature:
    """An Ed25519 signature of the proof that ends with a message.

    message: its index. key: the public key, hexadecimal. signature: of the proof's digest as 32
    bytes, hexadecimal. Raises InputError for anything else.
    """

    message: int
    key: str
    signature: str

    def __post_init__(self) -> None:
        if type(self.message) is not int or not 0 <= self.message < MOST_MESSAGES:
            refuse("message", "the index of a message", self.message)
        for name, digits in (("key", 64), ("signature", 128)):
            value = getattr(self, name)
            if not (isinstance(value, str) and re.fullmatch(f"[0-9a-f]{{{digits}}}", value)):
                refuse(name, f"{digits} digits 0-9, a-f", value)


@dataclass(frozen=True)
class Proof:
    """A proof: its content, the thread, and who signed what.

    content: JSON of content.py. messages: the first is the designer's; the last is the newest.

    >>> from relgloss_view.picture.scene.setup import Eye
    >>> from relgloss_view.proof.settings import LampPlace, PictureSetting
    >>> sent = Settings(PictureSetting(0.0, 0.14), PictureSetting(2.0, 0.37), Eye(), LampPlace())
    >>> proof = Proof({"title": "Can"}, (Message(sent, note="Too strong?"),))
    >>> answer = proof.answered(Message(sent, note="A little."))
    >>> answer.digests[0] == answer.messages[1].parent == proof.digest
    True
    """

    content: Mapping[str, Any]
    messages: tuple[Message, ...]
    signatures: tuple[Signature, ...] = field(default=())

    @property
    def sent(self) -> Settings:
        """The settings of the newest message."""
        return self.messages[-1].settings

    @property
    def unsigned(self) -> int:
        """How many of the newest messages no signature is for, right or wrong."""
        return len(self.messages) - 1 - max((s.message for s in self.signatures), default=-1)

    @property
    def title(self) -> str:
        """What the proof is about."""
        return str(self.content.get("title", ""))

    @cached_property
    def digests(self) -> tuple[str, ...]:
        """SHA-256 of the thread's proofs, hexadecimal, one a message; the last names this proof."""
        return digests_of(self.as_json())

    @property
    def digest(self) -> str:
        """The proof's name."""
        return self.digests[-1]

    def as_json(self) -> dict[str, Any]:
        """What is sealed."""
        return {
            "content": self.content,
            "format": FORMAT,
            "messages": [message.as_json() for message in self.messages],
            "version": VERSION,
        }

    def answered(self, message: Message) -> Proof:
        """The reply with a message, which names this proof."""
        answer = dataclasses.replace(message, parent=self.digest)
        return Proof(self.content, (*self.messages, answer), self.signatures)


def digests_of(proof: Mapping[str, Any]) -> tuple[str, ...]:
    """SHA-256 of the proofs of a thread, hexadecimal, from the JSON of the last one.

    The JSON of all of them begins alike, which is hashed once.
    """
    begun = hashlib.sha256(b'{"content":' + canonical(proof["content"]))
    begun.update(b',"format":' + canonical(proof["format"]) + b',"messages":[')
    names = []
    for k, message in enumerate(proof["messages"]):
        begun.update((b"," if k else b"") + canonical(message))
        ended = begun.copy()
        ended.update(b'],"version":' + canonical(proof["version"]) + b"}")
        names.append(ended.hexdigest())
    return tuple(names)


def canonical(value: Any) -> bytes:
    """JSON as RFC 8785 writes it, UTF-8.

    >>> canonical({"b": 1.0, "a": "\\u20ac"})
    b'{"a":"\\xe2\\x82\\xac","b":1}'
    """
    import rfc8785

    return rfc8785.dumps(value)
