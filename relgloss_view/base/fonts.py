"""Fonts for names in any script: which files there are, what they hold, what no font here can show.

Plain Latin text keeps the font of whoever draws it. What that one lacks comes from the next of
`font_files()`: DejaVu Sans, which matplotlib brings (Latin, Greek, Cyrillic, letters of Arabic and
Hebrew), the files that RELGLOSS_FONTS names, and the system's fonts for Chinese, Japanese, Korean.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import sys
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base import child, font_tables
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import check_regular, printable

VARIABLE = "RELGLOSS_FONTS"
EXPECTED = "a font file (.ttf, .otf or .ttc)"
CJK_PACKAGE = "fonts-noto-cjk"  #: of Debian: Chinese, Japanese and Korean in one file
LANGUAGES = ("ja", "zh-cn", "zh-tw", "ko")  #: whose fonts are asked for
LISTED = 6  #: characters that a warning lists
LONGEST_ASK_S = 5.0  #: for fontconfig, which may have to build its cache first

#: Where a font for Chinese, Japanese and Korean is looked for if fontconfig finds none. Only the
#: paths of Debian are tested.
KNOWN_PATHS = {
    "linux": (
        "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc",
        "/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc",
        "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
        "/usr/share/fonts/truetype/wqy/wqy-zenhei.ttc",
    ),
    "darwin": (
        "/System/Library/Fonts/Supplemental/Arial Unicode.ttf",
        "/Library/Fonts/Arial Unicode.ttf",
    ),
    "win32": (
        r"C:\Windows\Fonts\YuGothM.ttc",
        r"C:\Windows\Fonts\msyh.ttc",
        r"C:\Windows\Fonts\malgun.ttf",
    ),
}
#: Scripts that names are written in, each by letters that a font for it has.
SCRIPTS = {
    "Latin": "äßøŁőĞ",
    "Greek": "γυαλί",
    "Cyrillic": "бумага",
    "Japanese": "光沢紙かなカナ",
    "Chinese": "铜版纸光澤",
    "Korean": "광택지",
}
_EAST_ASIAN = (
    "CJK ",
    "HIRAGANA ",
    "KATAKANA ",
    "HANGUL ",
    "BOPOMOFO ",
    "IDEOGRAPHIC ",
    "FULLWIDTH ",
)


@dataclass(frozen=True)
class FontFile:
    """One face of a font file; `index` counts the faces of a collection (.ttc) from 0."""

    path: str
    index: int = 0

    @property
    def characters(self) -> frozenset[int]:
        """The code points that it has a glyph for. Raises InputError where it is no font."""
        return _characters(self)

    @property
    def height_em(self) -> float:
        """From its highest to its lowest letter: ascender minus descender, in sizes of its em."""
        return _height_em(self)


@functools.cache
def font_files() -> tuple[FontFile, ...]:
    """The fonts that stand in for glyphs which an ordinary font lacks, the first before the others.

    Raises InputError where RELGLOSS_FONTS names a file that is no font.
    """
    files = [FontFile(str(path)) for path in (dejavu(),) if path is not None]
    for name in os.environ.get(VARIABLE, "").split(os.pathsep):
        if name:
            file = FontFile(str(check_regular(name, f"{EXPECTED} in {VARIABLE}")))
            _ = file.characters, file.height_em  # whatever draws with it would fail without a word
            files.append(file)
    files += _of_the_system()
    return tuple(dict.fromkeys(files))


def dejavu() -> Path | None:
    """DejaVu Sans (a free licence), as matplotlib ships it; matplotlib itself is not imported."""
    found = importlib.util.find_spec("matplotlib")
    if found is None or found.submodule_search_locations is None:
        return None  # `relgloss doctor` reports that it is missing
    path = Path(found.submodule_search_locations[0], "mpl-data", "fonts", "ttf", "DejaVuSans.ttf")
    return path if path.is_file() else None


def missing(text: str) -> str:
    """The characters of a text that no font here has, each once, in their order."""
    if text.isascii():
        return ""
    candidates = [c for c in dict.fromkeys(text) if _visible(c)]
    for file in font_files():
        if not candidates:
            break
        candidates = [c for c in candidates if ord(c) not in file.characters]
    return "".join(candidates)


def missing_scripts() -> dict[str, str]:
    """Those of SCRIPTS that no font here has, each with the step that mends it."""
    return {name: _remedy(gone) for name, text in SCRIPTS.items() if (gone := missing(text))}


def right_to_left(text: str) -> bool:
    """Whether a text holds letters that are written from right to left, as Arabic and Hebrew."""
    return any(unicodedata.bidirectional(c) in ("R", "AL") for c in text)


def runs(text: str, fonts: Sequence[frozenset[int]]) -> list[tuple[int, str]]:
    """A text in parts that one font can draw: the number of the font, and the part.

    fonts: the characters of each, in the order of preference. What none has goes to the first.
    White space and marks stay with what is before them.
    """
    parts: list[tuple[int, str]] = []
    for c in text:
        able = [k for k, characters in enumerate(fonts) if ord(c) in characters]
        present = parts[-1][0] if parts else None
        if present is not None and (not _visible(c) or unicodedata.combining(c)):
            chosen = present
        else:
            chosen = able[0] if able else 0
        if chosen == present:
            parts[-1] = (chosen, parts[-1][1] + c)
        else:
            parts.append((chosen, c))
    return parts


def warnings(texts: Mapping[str, str], *, shaped: bool = False) -> list[str]:
    """Lines for the operator about texts that can't be read as they are drawn; none where all can.

    texts: by what they are, as in "the consent text". shaped: whether what draws them joins and
    orders the letters of Arabic and Hebrew, which the window does not.
    """
    lines = []
    lost = {name: gone for name, text in texts.items() if (gone := missing(text))}
    if lost:
        characters = "".join(dict.fromkeys("".join(lost.values())))
        listed = ", ".join(f"{c} (U+{ord(c):04X})" for c in characters[:LISTED])
        more = len(characters) - LISTED
        listed += f" and {more} more" if more > 0 else ""
        lines.append(
            f"no font here has {listed} of {_named(lost)}: replacement signs show instead; "
            f"{_remedy(characters)}"
        )
    turned = [name for name, text in texts.items() if right_to_left(text)]
    if turned and not shaped:
        lines.append(
            f"{_named(turned)}: the window writes Arabic and Hebrew letters unjoined and from left "
            "to right; use another script"
        )
    return lines


def _named(names: Sequence[str] | Mapping[str, str]) -> str:
    shown = [printable(name, 60) for name in names]
    return ", ".join(shown[:3]) + (f" and {len(shown) - 3} more texts" if len(shown) > 3 else "")


def _remedy(characters: str) -> str:
    other = f"set {VARIABLE} to a font file that has them"
    if any(unicodedata.name(c, "").startswith(_EAST_ASIAN) for c in characters):
        return f"`apt install {CJK_PACKAGE}` brings the letters on Debian, or {other}"
    return other


def _visible(character: str) -> bool:
    """Whether a character needs a glyph: no space, control or selector of a variant does."""
    selector = 0xFE00 <= ord(character) <= 0xFE0F
    return unicodedata.category(character) not in ("Cc", "Cf", "Zs", "Zl", "Zp") and not selector


def _of_the_system() -> list[FontFile]:
    """The system's fonts for each of LANGUAGES, without those that can't be read."""
    asked = [_by_fontconfig(language) for language in _languages()]
    files = [file for file in asked if file is not None]
    if not files:
        files = [FontFile(p) for p in KNOWN_PATHS.get(sys.platform, ()) if Path(p).is_file()]
    readable: dict[str, FontFile] = {}
    for file in files:
        try:
            _ = file.height_em
        except InputError:
            continue
        # The faces of a collection hold the same letters, each in another country's forms.
        readable.setdefault(file.path, file)
    return list(readable.values())


def _languages() -> list[str]:
    """LANGUAGES, the user's own first: its forms of the letters are those that show."""
    names = (os.environ.get(name, "") for name in ("LC_ALL", "LC_CTYPE", "LANG"))
    own = next((name for name in names if name), "").partition(".")[0].replace("_", "-").lower()
    return sorted(LANGUAGES, key=lambda language: not own.startswith(language))


def _by_fontconfig(language: str) -> FontFile | None:
    """The font that fontconfig chooses for a language; None where none has its letters."""
    ask = ("fc-match", "-f", "%{file}\n%{index}\n%{lang}", f"sans:lang={language}")
    try:
        answer = child.run(ask, LONGEST_ASK_S)
        if answer.status != 0:
            return None
        path, index, languages = answer.out.split("\n")
        if language not in languages.lower().split("|") or not Path(path).is_file():
            return None
        return FontFile(path, int(index) & 0xFFFF)  # above it is the instance of a variable font
    except (OSError, ValueError):
        return None


@functools.cache
def _characters(file: FontFile) -> frozenset[int]:
    return font_tables.characters(file.path, file.index, EXPECTED)


@functools.cache
def _height_em(file: FontFile) -> float:
    return font_tables.height_em(file.path, file.index, EXPECTED)
