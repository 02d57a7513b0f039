"""Unpack: the files of a proof in a folder, whoever wrote it, and the scene that they hold.

A proof may come from anyone. So no name leads out of the folder, no file of it names one outside,
and there is no more of it than any program would write.
"""

from __future__ import annotations

import base64
import contextlib
import dataclasses
import os
import re
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.toml import parse_toml
from relgloss_view.base.writing import whole_folder
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file
from relgloss_view.picture.scene.scene_writer import write_scene_file
from relgloss_view.proof.carry import SCENE, TEXTS, TYPES
from relgloss_view.proof.entries import LONGEST_FILE_NAME, MOST_FILES
from relgloss_view.proof.pair import Pair
from relgloss_view.proof.proof import Proof
from relgloss_view.proof.read import read_proof
from relgloss_view.proof.settings import Settings

MOST_BYTES = 64 << 20  #: of all files together
_PART = r"[a-z0-9][a-z0-9_-]{0,40}"
#: Lower case alone, so that no file system takes two names for one; no dot but that of the suffix.
_NAME = re.compile(rf"(?:{_PART}/)?{_PART}\.[a-z]{{2,4}}")
#: Names that Windows keeps for devices, whatever suffix they have.
_DEVICES = re.compile(r"(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:[./]|$)")
#: Of TOML files: entries that name a file or something built in.
_NAMING = frozenset(
    {"material", "table", "pack", "file", "illuminant", "lab_illuminant", "profile", "seen_on",
     "reference_seen_on", "test_seen_on", "artwork", "mask", "form", "name"}
)  # fmt: skip
_NOT_FILES = frozenset({"name"})  #: that any words may be
_OUTSIDE = re.compile(r"[/\\\0]|\.\.|^~|^[A-Za-z]:")
_OF_MASKS = ("plate:", "channel:", "part:")


@dataclass(frozen=True)
class Opened:
    """An unpacked proof. folder: where its files lie. scene_file: what they hold."""

    proof: Proof
    folder: Path
    scene_file: SceneFile

    def pair(self, settings: Settings | None = None) -> Pair:
        """The pair at settings, by default those of the newest message."""
        placed = self.placed(self.proof.sent if settings is None else settings)
        return Pair.of(self.scene_file).at(placed)

    def placed(self, settings: Settings) -> Settings:
        """Settings whose lamp, where it is a file of the proof, is named by its path."""
        name = settings.lamp.illuminant
        if name not in self.proof.content["files"]:
            # A file beside the reader's own work is none of the proof's.
            if _OUTSIDE.search(name) or not is_lamp_name(name):
                raise InputError(f"lamp {printable(name, 60)!r}: the proof has no such file")
            return settings
        place = dataclasses.replace(settings.lamp, illuminant=str(self.folder / name))
        return dataclasses.replace(settings, lamp=place)

    def scene_at(self, settings: Settings | None = None) -> SceneFile:
        """The scene with the settings of a message, as a scene file holds it."""
        pair = self.pair(settings)
        own = self.scene_file
        assert own.reference_look is not None
        at = pair.settings
        setup = at.in_setup(own.setup)
        return dataclasses.replace(
            own,
            setup=setup,
            look=own.look.with_entries(sigma_n_deg=at.test.sigma_n_deg, c=at.test.c),
            reference_look=own.reference_look.with_entries(
                sigma_n_deg=at.reference.sigma_n_deg, c=at.reference.c
            ),
        )


def answer_scene(message: int) -> str:
    """The name of the scene with a message's settings; messages are counted from 1.

    >>> answer_scene(2)
    'message-2.toml'
    """
    return f"message-{message}.toml"


def unpacked(
    proof: Proof,
    folder: str | Path,
    *,
    answers: bool = False,
    progress: ProgressReport = no_progress,
) -> SceneFile:
    """Write a proof's files into a new or an existing folder, whole or not at all; their scene.

    answers: beside scene.toml, which has the first message's settings, a scene of each answer
    (`answer_scene`). Raises InputError where a name leads out of the folder, a file names one
    outside, there is too much, or the files hold no pair.
    """
    contents = contents_of(proof.content.get("files"))
    target = Path(folder)
    for inner in sorted({name.partition("/")[0] for name in contents if "/" in name}):
        if (target / inner).exists():  # files take the place of files, folders do not
            raise InputError(
                f"{named(target)}: holds {named(inner)} of another proof; choose a new folder"
            )
    with whole_folder(target, SCENE) as staged:
        for name, data in contents.items():
            file = staged / name
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(data)
        read = _checked(read_scene_file(staged / SCENE, progress=progress))
        one = Opened(proof, staged, read)
        for k, message in enumerate(proof.messages[1:] if answers else (), 2):
            if answer_scene(k) not in contents:
                write_scene_file(staged / answer_scene(k), one.scene_at(message.settings))
    return _checked(read_scene_file(target / SCENE))


@contextmanager
def opened(proof: Proof, *, progress: ProgressReport = no_progress) -> Iterator[Opened]:
    """A proof unpacked into a temporary folder, for the length of a block."""
    contents = contents_of(proof.content.get("files"))
    with tempfile.TemporaryDirectory(prefix="relgloss-proof-") as name:
        folder = Path(name)
        for file, data in contents.items():
            (folder / file).parent.mkdir(exist_ok=True)
            (folder / file).write_bytes(data)
        try:
            scene = _checked(read_scene_file(folder / SCENE, progress=progress))
            yield Opened(proof, folder, scene)
        except InputError as error:  # lamps are read when they are needed
            raise InputError(str(error).replace(f"{folder}/", "the proof's ")) from error


@contextmanager
def open_proof(
    path: str | os.PathLike[str], *, progress: ProgressReport = no_progress
) -> Iterator[Opened]:
    """A proof's file, unpacked into a temporary folder for the length of a block.

    `opened.proof` is what `read_proof` gives. `opened.pair()` has the scenes and looks of the
    newest message, `opened.pair(opened.proof.messages[0].settings)` those of the first one, and
    `opened.pair().drawn(renderer, size)` both pictures as the page draws them, scaled alike.

    Raises InputError, one line that names the file, where anything of it was changed since it was
    made, or its files hold no pair.

    >>> with open_proof("gone.html") as opened:
    ...     pass
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: gone.html: can't be read ...
    """
    proof = read_proof(path)
    with contextlib.ExitStack() as stack:
        try:
            one = stack.enter_context(opened(proof, progress=progress))
        except InputError as error:
            raise InputError(f"{named(path)}: {error}") from error
        yield one


def contents_of(files: object) -> dict[str, bytes]:
    """The bytes of a proof's files by name, all of them checked. Raises InputError.

    >>> contents_of({"scene.toml": {"text": "[look]"}})
    {'scene.toml': b'[look]'}
    """
    if not isinstance(files, Mapping) or SCENE not in files:
        raise InputError(f"the proof's files: expected {SCENE} among them")
    if len(files) > MOST_FILES:
        raise InputError(f"the proof's files: expected at most {MOST_FILES}, found {len(files)}")
    left = MOST_BYTES
    contents: dict[str, bytes] = {}
    for name, file in files.items():
        check_name(name)
        data = _data(name, file, left)
        left -= len(data)
        contents[name] = data
    for name, data in contents.items():
        if name.endswith(".toml"):
            _check_names_within(name, data, contents)
    return contents


def check_name(name: object) -> None:
    """InputError for a file's name that this program would not write."""
    if (
        not isinstance(name, str)
        or len(name) > LONGEST_FILE_NAME
        or not _NAME.fullmatch(name)
        or _DEVICES.search(name)
        or _DEVICES.match(name.rpartition("/")[2])
        or Path(name).suffix not in (*TEXTS, *TYPES)
    ):
        raise InputError(
            f"the proof's file {printable(name, 60)!r}: a name that no proof has; ask for the "
            "proof again"
        )


def _data(name: str, file: object, most: int) -> bytes:
    """The bytes of a file; InputError where there are too many, or none can be decoded."""
    if not isinstance(file, Mapping):
        _refuse(name, "a text or base64")
    coded, written = file.get("base64"), file.get("text")
    if isinstance(written, str) and set(file) == {"text"}:
        data = written.encode("utf-8", "surrogatepass")
    elif isinstance(coded, str) and set(file) <= {"base64", "type"}:
        if len(coded) > 4 * most // 3 + 4:
            _refuse(name, f"at most {MOST_BYTES >> 20} MB together")
        try:
            data = base64.b64decode(coded, validate=True)
        except ValueError:
            _refuse(name, "base64")
    else:
        _refuse(name, "a text or base64")
    if len(data) > most:
        _refuse(name, f"at most {MOST_BYTES >> 20} MB together")
    return data


def _check_names_within(name: str, data: bytes, files: Mapping[str, bytes]) -> None:
    """InputError where a TOML file names a file that is not the proof's own."""
    try:
        tables = parse_toml(data.decode("utf-8"))
    except (UnicodeDecodeError, InputError) as error:
        raise InputError(f"the proof's {name}: {printable(error)}") from error
    beside = Path(name).parent

    def check(key: str, value: object) -> None:
        if isinstance(value, Mapping):
            for inner, one in value.items():
                check(str(inner), one)
        elif isinstance(value, list):
            for one in value:
                check(key, one)
        elif isinstance(value, str) and key in _NAMING - _NOT_FILES:
            if key == "mask" and value.startswith(_OF_MASKS):
                return
            plain = value.removeprefix("./")
            if (beside / plain).as_posix() in files or not _OUTSIDE.search(value):
                return
            raise InputError(
                f"the proof's {name}: {key} names {printable(value, 60)!r}, which is no file of "
                "the proof; ask for the proof again"
            )

    check("", tables)


def _checked(scene: SceneFile) -> SceneFile:
    if scene.reference is None or scene.reference_look is None:
        raise InputError(f"the proof's {SCENE}: expected a reference and its look")
    if scene.look.c is None or scene.reference_look.c is None:
        raise InputError(f"the proof's {SCENE}: expected c itself on both sides")
    for sample in (scene.sample, scene.reference):
        if sample.pack is not None and not sample.pack.file:
            raise InputError(f"the proof's {SCENE}: expected a pack in a file of its own")
    return scene


def _refuse(name: str, expected: str) -> NoReturn:
    raise InputError(f"the proof's file {printable(name, 60)!r}: expected {expected}")
