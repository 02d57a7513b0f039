"""Pool: the answers of all observers of one study, from one or several session files."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.experiment.design.study import Procedure, Study
from relgloss_view.experiment.session.losses import warnings
from relgloss_view.experiment.session.pooled_displays import PooledDisplays, pooled_displays
from relgloss_view.experiment.session.records import SIMULATED, Answer, Record, read_record
from relgloss_view.experiment.session.sitting import OF_THE_SCREEN
from relgloss_view.material.lamp_file import lamp_text
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.picture.scene.setup import Lamp

#: What of a study may differ between files that are pooled: how it was led, not what was judged.
MAY_DIFFER = ("title", "consent", "instructions", "adaptive")
MAY_DIFFER_IN_PROCEDURE = ("adaptation_min", "gap_s", "repeats", "order", "seed")


@dataclass(frozen=True)
class Answers:
    """Answers about one sample to one question. Arrays are (n,), one entry an answer."""

    observer: Ints  #: of the pool
    setting: Ints  #: of the grid
    category: Ints  #: 0 close upwards
    observers: int  #: in the pool
    settings: int  #: in the grid
    categories: int

    def counts(self) -> Array:
        """(observers, settings, categories): how often each was answered."""
        counts = np.zeros((self.observers, self.settings, self.categories))
        np.add.at(counts, (self.observer, self.setting, self.category), 1.0)
        return counts

    def ratings(self) -> Array:
        """(observers, settings): the mean category, NaN where an observer did not answer."""
        counts = self.counts()
        number = counts.sum(axis=-1)
        total = counts @ np.arange(self.categories)
        return np.where(number > 0.0, total / np.maximum(number, 1.0), np.nan)


@dataclass(frozen=True)
class Member:
    """An observer of the pool."""

    name: str  #: pseudonym; with the file's name where there are several files
    kind: str
    ended: bool
    answers: tuple[Answer, ...]  #: standing ones, by position


@dataclass(frozen=True)
class Pool:
    """One study and everybody who answered it."""

    study: Study
    members: tuple[Member, ...]
    records: tuple[Record, ...]
    displays: PooledDisplays = field(default_factory=PooledDisplays)

    @property
    def simulated(self) -> bool:
        """Whether anybody in it is simulated."""
        return any(m.kind == SIMULATED for m in self.members)

    def answers(self, sample: int, question: str) -> Answers:
        """The answers about a sample."""
        rows = [
            (number, answer.trial.setting, answer.category)
            for number, member in enumerate(self.members)
            for answer in member.answers
            if answer.trial.sample == sample and answer.question == question
        ]
        table = np.array(rows, dtype=np.int64).reshape(-1, 3)
        return Answers(
            table[:, 0], table[:, 1], table[:, 2],
            len(self.members), len(self.study.grid), len(self.study.categories),
        )  # fmt: skip


def read_pool(
    paths: Sequence[str | os.PathLike[str]], lamp_folder: Path, *, pool_displays: bool = False
) -> Pool:
    """Read session files of one study; InputError where they don't belong together.

    Observers of different files are different people, whatever their pseudonyms. pool_displays:
    whether answers on displays that differ by more than the limits are pooled all the same.
    """
    records: list[Record] = []
    for path in paths:
        for other in records:
            if os.path.exists(path) and os.path.samefile(path, other.path):
                raise InputError(f"{printable(path)}: given twice; give each session file once")
        record = read_record(Path(path), lamp_folder)
        for other in records:
            _check_no_copy(other, record)
        records.append(record)
        _check_same(records[0], record)
    members = []
    stems = {record.path.stem for record in records}
    for record in records:
        named = record.path.stem if len(stems) == len(records) else str(record.path)
        for observer in record.observers:
            own = tuple(a for a in record.answers if a.observer == observer.number)
            if not own:
                continue
            name = observer.name if len(records) == 1 else f"{named}: {observer.name}"
            members.append(Member(name, observer.kind, observer.ended, own))
    if not members:
        for record in records:
            for line in warnings(record.losses, record.path):
                raise InputError(f"{line} (it holds no answers)")
        raise InputError(f"{printable(paths[0])}: nobody has answered yet; run the study first")
    displays = pooled_displays(records, pool_all=pool_displays)
    return Pool(records[0].study, tuple(members), tuple(records), displays)


def _check_no_copy(first: Record, other: Record) -> None:
    """InputError where two files hold the same session: a copy would count people twice."""
    ours = {(o.name, o.begun_utc) for o in first.observers}
    for observer in other.observers:
        if (observer.name, observer.begun_utc) in ours:
            raise InputError(
                f"{printable(other.path)}: holds the session of {observer.name} that is in "
                f"{printable(first.path)} too; leave the copy out"
            )


def _check_same(first: Record, other: Record) -> None:
    """InputError where other answers are to other questions."""
    theirs_by_name = _judged_parts(other.study)
    for name, ours in _judged_parts(first.study).items():
        theirs = theirs_by_name[name]
        if name == "samples":
            ours, theirs = (
                [(s.label, s.sample.material, s.digest) for s in x] for x in (ours, theirs)
            )
        elif name == "procedure":
            standard = {n: getattr(Procedure(), n) for n in MAY_DIFFER_IN_PROCEDURE}
            ours, theirs = (dataclasses.replace(x, **standard) for x in (ours, theirs))
        elif name == "lamp":
            ours, theirs = (dataclasses.replace(x, illuminant=_lamp(x)) for x in (ours, theirs))
        elif name == "display" and _displays_known(first) and _displays_known(other):
            # What the observers looked at is compared by the records of their sittings.
            plain = {entry: getattr(Display(), entry) for entry in OF_THE_SCREEN}
            ours, theirs = (dataclasses.replace(x, **plain) for x in (ours, theirs))
        elif name == "reference":
            ours, theirs = ours.material, theirs.material
        if ours != theirs:
            raise InputError(
                f"{printable(other.path)}: its study has another {name.replace('_', ' ')} than "
                f"{printable(first.path)}; analyse them apart"
            )


def _displays_known(record: Record) -> bool:
    known = {run.id for run in record.runs if run.display is not None}
    return all(answer.run in known for answer in record.answers)


def _judged_parts(study: Study) -> dict[str, Any]:
    """What decides what is judged, by name; shape, lamp, eye and display each by itself."""
    names = [field.name for field in dataclasses.fields(Study)]
    parts = {name: getattr(study, name) for name in names if name not in (*MAY_DIFFER, "setup")}
    return parts | study.setup.parts() | {"further_lamps": study.setup.further_lamps}


def _lamp(lamp: Lamp) -> str:
    """What tells one lamp from another: its name, or what its table says, wherever that lies."""
    name = lamp.illuminant
    return name if is_lamp_name(name) else lamp_text(name)
