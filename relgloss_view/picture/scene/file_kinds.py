"""The kind of a file - scene, material, measurement, pack - from its content, never its name."""

from __future__ import annotations

import os
import re
from pathlib import Path

from relgloss_view.base.decoding import first_byte_of_no_text
from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import (
    HEAD_BYTES,
    foreign_format,
    refuse_foreign,
    refuse_foreign_json,
)
from relgloss_view.base.reading import printable, read_beginning
from relgloss_view.base.toml import parse_toml
from relgloss_view.material.files import FORMAT
from relgloss_view.material.files import MAX_BYTES as MAX_MATERIAL_BYTES
from relgloss_view.measure.readers import FORMATS, read_measurement
from relgloss_view.measure.readers.header import MOST_TITLES
from relgloss_view.pack.kinds import ARTWORK, PACK, kind_of_pack, pack_path
from relgloss_view.picture.scene.scene_file import (
    FURTHER_LAMP,
    PACK_TABLES,
    PAIR_TABLES,
    TABLES,
)
from relgloss_view.picture.scene.scene_file import MAX_BYTES as MAX_SCENE_BYTES

SCENE, MATERIAL, MEASUREMENT = "scene", "material", "measurement"
OF_PACKS = (PACK, ARTWORK)
EXPECTED = (
    "a scene (TOML), a proof (HTML), a material (JSON) or a measurement (CSV, .bsdf, .binary)"
)
PROOF = b'<meta name="relgloss-proof" content="'  #: of the room above, which reads it
FEWEST_DELIMITERS = 3  #: three angles and a band
_SCENE_TABLES = ("sample", *TABLES, FURTHER_LAMP, *PAIR_TABLES, *PACK_TABLES)
#: A line that only a scene has, so that a scene with a mistake is reported as a scene.
_SCENE_LINE = re.compile(rf"^[ \t]*\[{{1,2}}({'|'.join(_SCENE_TABLES)})(\.look)?\]", re.MULTILINE)


def kind_of(path: str | os.PathLike[str]) -> str:
    """SCENE, MATERIAL, MEASUREMENT, PACK or ARTWORK; InputError, one line, for anything else.

    A measurement is read to the end, because a fault may be in its last row.
    """
    kind = likely_kind(path)
    if kind == MEASUREMENT:
        read_measurement(Path(path))
    return kind


def likely_kind(path: str | os.PathLike[str]) -> str:
    """The kind of a file from its beginning; InputError for what is none of the kinds.

    Whatever is neither scene nor material counts as a measurement; its reader reports the faults.
    """
    file = Path(pack_path(path))
    head = read_beginning(file, HEAD_BYTES, EXPECTED)
    of_pack = kind_of_pack(file)
    if of_pack is not None:
        return of_pack
    if not head:
        raise InputError(f"{file}: the file is empty; give {EXPECTED}")
    if b"\x00" in head:  # a binary format, or UTF-16: the reader decides
        return MEASUREMENT
    if PROOF in head:
        raise InputError(
            f"{file}: this is a proof; open it with `relgloss view`, or write the scene that is "
            "inside into a folder with `relgloss proof show --files`"
        )
    foreign = foreign_format(head)
    if foreign is not None and foreign.key in FORMATS:
        return MEASUREMENT
    refuse_foreign(head, file)
    text = head.lstrip(b"\xef\xbb\xbf \t\r\n")
    if text.startswith((b"{", b"[{")):
        _check_material(file)
        return MATERIAL
    if _is_scene(file):
        return SCENE
    _check_table(file)
    return MEASUREMENT


def _check_material(file: Path) -> None:
    """InputError where a JSON file is too large for a material or lacks its format entry."""
    data = read_beginning(file, MAX_MATERIAL_BYTES + 1, EXPECTED)
    if len(data) <= MAX_MATERIAL_BYTES and FORMAT.encode() in data:
        return
    refuse_foreign_json(data, file)
    raise InputError(
        f"{file}: this looks like JSON, but not like a material, which holds "
        f'"format": "{FORMAT}"; give {EXPECTED}'
    )


def _is_scene(file: Path) -> bool:
    """Whether a text file is a scene; InputError for TOML that has nothing of one."""
    data = read_beginning(file, MAX_SCENE_BYTES + 1, EXPECTED)
    if len(data) > MAX_SCENE_BYTES:
        at = first_byte_of_no_text(data)
        if at is not None:
            raise InputError(
                f"{file}: byte {at}: neither UTF-8 text nor a known binary format; give {EXPECTED}"
            )
        return False
    try:
        text = data.decode("utf-8-sig")
        content = parse_toml(text)
    except UnicodeDecodeError:
        return False
    except InputError:
        return _SCENE_LINE.search(text) is not None
    if not content:
        raise InputError(f"{file}: nothing but space and comments; give {EXPECTED}")
    if not set(content) & set(_SCENE_TABLES):
        raise InputError(
            f"{file}: this is TOML, but no scene: found [{printable(next(iter(content)), 40)}], "
            f"expected tables of {', '.join(_SCENE_TABLES)}"
        )
    return True


def _check_table(file: Path) -> None:
    """InputError where none of the first lines that are no comments can be a table's header."""
    looked_at = 0
    head = read_beginning(file, MAX_SCENE_BYTES, EXPECTED)
    for line in head.lstrip(b"\xef\xbb\xbf").splitlines():
        if not line.strip() or line.lstrip(b'" \t').startswith(b"#"):
            continue
        if max(line.count(delimiter) for delimiter in b",;\t|") >= FEWEST_DELIMITERS:
            return
        # Columns set apart by spaces alone have at least one number in a row.
        words = line.split()
        if len(words) > FEWEST_DELIMITERS and any(c in b"0123456789" for c in line):
            return
        looked_at += 1
        if looked_at > MOST_TITLES:
            break
    if looked_at:
        raise InputError(f"{file}: a text, but neither scene nor table; give {EXPECTED}")
