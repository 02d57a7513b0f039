"""Proof: what is sent, and the thread of messages about it, sealed by SHA-256.

The JSON of a proof is canonical (RFC 8785), and its SHA-256 is the proof's name. A reply keeps the
content and adds a message that names the proof it answers. So the JSON of every earlier proof of
the thread is inside: the same content with fewer messages. Whoever has the last one can check all.

    {"content": {...}, "format": "relgloss-proof", "messages": [{...}, ...], "version": 1}
"""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from relgloss_view.proof.settings import Settings

FORMAT, VERSION = "relgloss-proof", 1


@dataclass(frozen=True)
class Message:
    """What one side hands to the other.

    settings: that they look at. note and author: plain text, of any language, '' for none.
    made: time in UTC, such as '2026-11-27T08:30:00Z'. program: that made it, with its version.
    parent: SHA-256 of the proof that this answers, hexadecimal; '' of the first.
    screen: what is known of the author's display (screens.py), or None.
    """

    settings: Settings
    note: str = ""
    author: str = ""
    made: str = ""
    program: str = ""
    parent: str = ""
    screen: Mapping[str, Any] | None = None

    def as_json(self) -> dict[str, Any]:
        """As a proof's JSON holds it."""
        fields = {f.name: getattr(self, f.name) for f in dataclasses.fields(self)}
        return {**fields, "settings": self.settings.as_json()}


@dataclass(frozen=True)
class Signature:
    """An Ed25519 signature of the proof that ends with a message.

    message: its index. key: the public key, hexadecimal. signature: of the proof's digest as 32
    bytes, hexadecimal.
    """

    message: int
    key: str
    signature: str


@dataclass(frozen=True)
class Proof:
    """A proof: its content, the thread, and who signed what.

    content: JSON of content.py. messages: the first is the designer's; the last is the newest.
    """

    content: Mapping[str, Any]
    messages: tuple[Message, ...]
    signatures: tuple[Signature, ...] = field(default=())

    @property
    def sent(self) -> Settings:
        """The settings of the newest message."""
        return self.messages[-1].settings

    @property
    def title(self) -> str:
        """What the proof is about."""
        return str(self.content.get("title", ""))

    @cached_property
    def digests(self) -> tuple[str, ...]:
        """SHA-256 of the thread's proofs, hexadecimal, one a message; the last names this proof.

        The JSON of all of them begins alike, which is hashed once.
        """
        begun = hashlib.sha256(b'{"content":' + canonical(self.content))
        begun.update(b',"format":' + canonical(FORMAT) + b',"messages":[')
        names = []
        for k, message in enumerate(self.messages):
            begun.update((b"," if k else b"") + canonical(message.as_json()))
            ended = begun.copy()
            ended.update(b'],"version":%d}' % VERSION)
            names.append(ended.hexdigest())
        return tuple(names)

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


def canonical(value: Any) -> bytes:
    """JSON as RFC 8785 writes it, UTF-8.

    >>> canonical({"b": 1.0, "a": "\\u20ac"})
    b'{"a":"\\xe2\\x82\\xac","b":1}'
    """
    import rfc8785

    return rfc8785.dumps(value)
