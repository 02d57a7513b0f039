"""Content: all of a pair of pictures that the other side needs, and the first message about it."""

from __future__ import annotations

import dataclasses
import json
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.display.display import Display
from relgloss_view.display.record import ASSUMED, DisplayRecord
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.proof.carry import carried, files_of, relative, size_of
from relgloss_view.proof.drawing import drawing_of
from relgloss_view.proof.entries import check_size
from relgloss_view.proof.grid import grid_of
from relgloss_view.proof.meter import finishes_of, meter_of
from relgloss_view.proof.pair import Pair
from relgloss_view.proof.pictures import stored
from relgloss_view.proof.proof import ARTWORK_PX, MOST_TITLE
from relgloss_view.proof.settings import SIDES, Settings
from relgloss_view.quality.backends import FrameRenderer

SIZE = (512, 512)  #: of the stored pictures and the check


@dataclass(frozen=True)
class Made:
    """The content of a new proof, with its settings.

    notes: what is not as in the scene, one sentence each. warnings: of the two pictures. sizes:
    bytes of each part in the proof's JSON.
    """

    content: dict[str, Any]
    settings: Settings
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()

    @property
    def sizes(self) -> dict[str, int]:
        """Bytes of each part of the content as JSON; of the files, those of each kind."""
        parts = {name: _json_bytes(value) for name, value in self.content.items()}
        del parts["files"]
        for name, file in self.content["files"].items():
            key = f"files: {name}"
            parts[key] = size_of(file)
        return parts


def content_of(
    scene: SceneFile,
    renderer: FrameRenderer,
    *,
    size: tuple[int, int] = SIZE,
    title: str = "",
    artwork_px: int = ARTWORK_PX,
    progress: ProgressReport = no_progress,
) -> Made:
    """The content of a proof of a pair, self-contained, drawn and checked at a size.

    scene: with a reference; both looks have c itself. title: '' takes the sample's name. Raises
    InputError where a file that the scene names can't be read.
    """
    check_size(list(size))
    with tempfile.TemporaryDirectory(prefix="relgloss-") as name:
        folder = Path(name)
        made = carried(scene, folder, artwork_px=artwork_px, progress=_part(progress, 0.0, 0.3))
        pair = Pair.of(made.scene)
        progress(0.3, "drawing")
        pictures = pair.drawn(renderer, size)
        progress(0.6, "compressing the pictures")
        coded, quality = stored({side: one.rgb for side, one in pictures.items()})
        progress(0.7, "reading gloss")
        content: dict[str, Any] = {
            "title": title or printable(pair.scenes["test"].name, MOST_TITLE),
            "names": {side: printable(pair.scenes[side].name, MOST_TITLE) for side in SIDES},
            "size_px": list(size),
            "files": files_of(folder),
            "meter": meter_of(pair),
            "display": display_words(scene.setup.display),
            "grid": grid_of(pictures),
            "pictures": coded,
            "picture_quality": quality,
        }
        finishes = finishes_of(pair)
        if finishes:
            content["meter_finishes"] = finishes
        if made.notes:
            content["notes"] = list(made.notes)
        progress(0.8, "preparing the page")
        content["drawing"] = drawing_within(pair, folder)
        settings = _named_within(pair.settings, folder)
    warnings = [f"{side}: {text}" for side, one in pictures.items() for text in one.warnings]
    return Made(content, settings, made.notes, tuple(dict.fromkeys(warnings)))


def display_words(display: Display) -> dict[str, Any]:
    """The display that a scene was made for, in numbers and words."""
    record = DisplayRecord.of(display, ASSUMED)
    values = {
        name: getattr(record, name)
        for name in (
            "name", "luminance_cd_m2", "luminance_known", "black_cd_m2", "black_known",
            "reflected_cd_m2",
        )
    }  # fmt: skip
    sentences = []
    unknown = []
    for name, known, value in (
        ("white", record.luminance_known, record.luminance_cd_m2),
        ("black", record.black_known, record.black_cd_m2),
    ):
        if known:
            sentences.append(f"Its {name} has {value:.3g} cd/m2.")
        else:
            unknown.append(name)
    if unknown:
        sentences.append(f"Nobody measured the luminance of its {' and '.join(unknown)}.")
    if record.reflected_cd_m2:
        sentences.append(f"The screen reflects {record.reflected_cd_m2:.3g} cd/m2 of the room.")
    return {
        **values,
        "white_xy": list(record.white_xy),
        "primaries_xy": [list(xy) for xy in record.primaries_xy],
        "words": record.name,
        "sentences": sentences,
    }


def drawing_within(pair: Pair, folder: Path) -> dict[str, Any]:
    """What the page draws with; a lamp that is a file has its name among the proof's files."""
    sides = {side: (pair.scenes[side], pair.looks[side]) for side in SIDES}
    made: dict[str, Any] = _renamed(drawing_of(sides), str(folder) + os.sep)
    return made


def _renamed(value: Any, start: str) -> Any:
    """Names of files without the folder that they lie in, keys and values alike."""
    if isinstance(value, Mapping):
        return {key.removeprefix(start): _renamed(one, start) for key, one in value.items()}
    if isinstance(value, list):
        return [_renamed(one, start) for one in value]
    return value.removeprefix(start) if isinstance(value, str) else value


def _named_within(settings: Settings, folder: Path) -> Settings:
    """Settings whose lamp, where it is a file, has its name among the proof's files."""
    lamp = settings.lamp.illuminant
    if is_lamp_name(lamp):
        return settings
    place = dataclasses.replace(settings.lamp, illuminant=relative(lamp, folder))
    return dataclasses.replace(settings, lamp=place)


def _part(progress: ProgressReport, first: float, last: float) -> ProgressReport:
    return lambda share, text: progress(first + (last - first) * share, text)


def _json_bytes(value: Any) -> int:
    return len(json.dumps(value, ensure_ascii=False, separators=(",", ":")).encode("utf-8"))
