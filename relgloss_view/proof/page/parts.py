"""The parts of a proof's page, and which of them was changed. Twin: js/canonical.js.

A page is one text that is written in one way: markers stand between its parts, in this order. Its
block `parts` holds the first 16 digits of the SHA-256 of each part, and of each entry of what is
sealed, so that a change can be named; that nothing was changed is what the seal shows.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import parse_json
from relgloss_view.proof.proof import canonical, digests_of

#: Marks a file as a proof, within its first bytes; the content is the proof's name.
MARK = '<meta name="relgloss-proof" content="'
SEAL = '<meta name="relgloss-seal" content="'
PROGRAM = '<meta name="generator" content="'
UNSEALED = "0" * 64
BLOCKS = ("proof", "signatures", "shaders", "words", "parts")  #: of JSON, in their order
PARTS = ("head", "style", "static", *BLOCKS, "script")
END = "</script>"
#: What ends each of PARTS; nothing follows the last one.
MARKERS = (
    "<style>",
    "</style></head><body>\n",
    *(
        ("" if name == BLOCKS[0] else END) + f'\n<script type="application/json" id="{name}">'
        for name in BLOCKS
    ),
    f"{END}\n<script>",
    f"{END}</body></html>",
)
DIGITS = 16
#: Entries of content with entries of their own, which a user knows by name.
DIVIDED = ("files", "pictures")
MOST_VALUES = 1_000_000
_SEALED = re.compile(re.escape(SEAL) + r"([0-9a-f]{64})\"")
_MARKED = re.compile(re.escape(MARK) + r"([0-9a-f]{64})\"")
_MADE_BY = re.compile(re.escape(PROGRAM) + r"([^\"&<>]{1,60})\"")
FROM_EXACT = 2**53  #: whole numbers from here on are what JavaScript's are: floats


def seal_of(html: str) -> str:
    """SHA-256 of a page's text as it is; of one with zeros in its seal's place, its seal."""
    return hashlib.sha256(html.encode("utf-8")).hexdigest()


def split(html: str) -> dict[str, str]:
    """The texts of PARTS; InputError, which names the part behind which a marker is missing.

    Both hexadecimal numbers of the head are zeros in it.
    """
    texts, position = {}, 0
    for name, marker in zip(PARTS, MARKERS, strict=True):
        end = html.find(marker, position)
        if end < 0:
            raise InputError(f"{name}: its end is missing, expected {marker.strip()}")
        texts[name] = html[position:end]
        position = end + len(marker)
    if html[position:]:
        raise InputError("script: the page goes on behind its end")
    for pattern in (_MARKED, _SEALED):
        found = pattern.search(texts["head"])
        if found is not None:
            start, end = found.span(1)
            texts["head"] = texts["head"][:start] + UNSEALED + texts["head"][end:]
    return texts


def loosely(html: str) -> dict[str, str]:
    """The texts of PARTS, as far as they are there, of a page whose markup was changed.

    For a browser extension that adds markup of its own. Head and static words are not among them.
    """
    begins = {name: f'<script type="application/json" id="{name}">' for name in BLOCKS}
    begins |= {"style": "<style>", "script": "\n<script>"}
    texts = {}
    for name, begin in begins.items():
        start = html.find(begin) + len(begin)
        end = html.find("</style>" if name == "style" else END, start)
        if start >= len(begin) and end >= 0:
            texts[name] = html[start:end]
    return texts


def joined(texts: Mapping[str, str], digest: str) -> str:
    """The page of PARTS, named and sealed; `parts` is renewed."""
    texts = dict(texts)
    texts["parts"] = script_json(manifest(texts))
    html = "".join(texts[name] + marker for name, marker in zip(PARTS, MARKERS, strict=True))
    html = html.replace(MARK + UNSEALED, MARK + digest, 1)
    return html.replace(SEAL + UNSEALED, SEAL + seal_of(html), 1)


def manifest(texts: Mapping[str, str]) -> dict[str, str]:
    """What the block `parts` holds: 16 digits a part, and those of the others as its own entry."""
    names, _ = _hashes(texts)
    return {**names, "parts": short(canonical(names))}


def _hashes(texts: Mapping[str, str]) -> tuple[dict[str, str], list[str]]:
    """16 digits a part, and the blocks of several parts that aren't written as this program does.

    Those that are no JSON of a proof have no entries.
    """
    names, wrong = {}, []
    for name in PARTS:
        if name in texts and name not in ("proof", "shaders", "parts"):
            names[name] = short(texts[name].encode("utf-8"))
    for block, divide in (("shaders", _shaders), ("proof", entries_of)):
        try:
            values = load(texts[block])
            names |= {name: short(canonical(value)) for name, value in divide(values)}
            whole = script_json(values) == texts[block]
        except (InputError, AttributeError, KeyError, TypeError, ValueError):
            whole = False
        if not whole:
            wrong.append(block)
    return names, wrong


def _shaders(files: Mapping[str, Any]) -> list[tuple[str, Any]]:
    return [(f"shaders/{name}", text) for name, text in files.items()]


def entries_of(proof: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """The named entries of what is sealed: of content, and of each message, counted from 1."""
    found: list[tuple[str, Any]] = []
    for name, value in proof["content"].items():
        if name in DIVIDED and isinstance(value, dict):
            found += [(f"content/{name}/{key}", entry) for key, entry in value.items()]
        else:
            found.append((f"content/{name}", value))
    for k, message in enumerate(proof["messages"]):
        found += [(f"messages/{k + 1}/{name}", value) for name, value in message.items()]
    return found


def _is_written(block: str) -> bool:
    """Whether a block's text is the one way to write its values."""
    try:
        return script_json(load(block)) == block
    except (InputError, AttributeError, KeyError, TypeError, ValueError):
        return False


def short(data: bytes) -> str:
    """The first 16 digits of a SHA-256."""
    return hashlib.sha256(data).hexdigest()[:DIGITS]


def script_json(value: Any) -> str:
    """JSON that no HTML ends early: the same values, `<` written as an escape."""
    return canonical(value).decode("utf-8").replace("<", "\\u003c")


def load(text: str) -> Any:
    """The values of a block; InputError for what is no JSON of a proof.

    Keys that come twice, NaN and infinities are refused.
    """
    return parse_json(
        text, MOST_VALUES, object_pairs_hook=_object, parse_constant=_constant, parse_int=_whole
    )


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) != len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise ValueError(f"{json.dumps(twice)} comes twice; expected each name once")
    return values


def _constant(text: str) -> Any:
    raise ValueError(f"{text}: expected a finite number")


def _whole(text: str) -> int | float:
    value = int(text)
    return value if abs(value) < FROM_EXACT else float(text)


@dataclass(frozen=True)
class Page:
    """A proof's page as it was read.

    html: its text. Nothing of it is to be trusted before `changes` is empty.
    """

    html: str

    @cached_property
    def seal(self) -> str:
        """The seal that the page states; '' where it has none."""
        found = _SEALED.search(self.html)
        return found[1] if found else ""

    @cached_property
    def named(self) -> str:
        """The digest that the page states; '' where it has none."""
        found = _MARKED.search(self.html)
        return found[1] if found else ""

    @cached_property
    def program(self) -> str:
        """The program that the page names as its maker, such as 'relgloss 0.2.0'; '' where none."""
        found = _MADE_BY.search(self.texts.get("head", ""))
        return found[1] if found else ""

    @cached_property
    def is_sealed(self) -> bool:
        """Whether the seal is that of the whole text."""
        return bool(self.seal) and (
            seal_of(self.html.replace(SEAL + self.seal, SEAL + UNSEALED, 1)) == self.seal
        )

    @cached_property
    def texts(self) -> dict[str, str]:
        """The texts of PARTS; where the page's markup was changed, those that are there."""
        try:
            return split(self.html)
        except InputError:
            return loosely(self.html)

    def block(self, name: str) -> Any:
        """The values of a block of JSON. Raises InputError, which names the block."""
        try:
            return load(self.texts[name])
        except KeyError:
            raise InputError(f"{name}: the page has no such block") from None
        except InputError as error:
            raise InputError(f"{name}: {error}") from error

    @cached_property
    def digest(self) -> str:
        """The digest of what the page holds; '' where that is not readable."""
        try:
            return digests_of(self.block("proof"))[-1]
        except (InputError, KeyError, TypeError, IndexError, ValueError, AttributeError):
            return ""

    @cached_property
    def holds_proof(self) -> bool:
        """Whether what is sealed is what the page's name says."""
        return bool(self.named) and self.digest == self.named

    @cached_property
    def _unwritten(self) -> tuple[str, ...]:
        """Blocks that aren't written as this format does, whoever sealed them.

        A `<` in them would be markup in a browser, and no JSON.
        """
        try:
            texts = split(self.html)
        except InputError:
            return ("page",)
        names = [name for name in BLOCKS if not _is_written(texts[name])]
        if not names and texts["parts"] != script_json(manifest(texts)):
            names = ["parts"]
        return tuple(names)

    @cached_property
    def changes(self) -> tuple[str, ...]:
        """The names of changed parts, as `manifest` has them; empty where nothing was changed."""
        if self.is_sealed and self.holds_proof:
            return self._unwritten
        for name, mended in (("lines", self.html.replace("\r\n", "\n")),
                             ("mark", self.html.removeprefix("\ufeff"))):  # fmt: skip
            if mended != self.html and Page(mended).is_sealed:
                return (name,)
        texts = self.texts
        try:
            noted = load(texts["parts"])
            own = noted.pop("parts")
            if (
                short(canonical(noted)) != own
                or script_json({**noted, "parts": own}) != (texts["parts"])
            ):
                return ("parts",)
        except (InputError, AttributeError, KeyError, ValueError):
            return ("parts",)
        broken = "head" not in texts
        if broken:
            noted = {k: v for k, v in noted.items() if k not in ("head", "static")}
        now, wrong = _hashes(texts)
        named = [name for name in noted if noted[name] != now.get(name)]
        named = named or [name for name in now if name not in noted]
        for block, begins in (("shaders", ("shaders/",)), ("proof", ("content/", "messages/"))):
            if block in wrong and not any(name.startswith(begins) for name in now):
                named = [name for name in named if not name.startswith(begins)]
        if named or wrong or broken:
            return (*named, *wrong, *(["page"] if broken else []))
        return ("seal",) if self.holds_proof else ("name",)
