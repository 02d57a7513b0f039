"""On which displays the answers of a pool were given, and whether they are one study's."""

from __future__ import annotations

import dataclasses
import itertools
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.display.record import ASSUMED, DisplayRecord
from relgloss_view.experiment.session.display_difference import difference
from relgloss_view.experiment.session.records import SIMULATED, Record

MOST_DISPLAYS = 40  #: that are compared with each other
POOL_ALL = "--pool-displays"
MEND = f"analyse them apart, or pool them all the same with {POOL_ALL}"


@dataclass(frozen=True)
class ShownOn:
    """An observer's answers on one display; None where the file has no record of it."""

    path: Path
    observer: str
    display: DisplayRecord | None
    answers: int
    simulated: bool = False


@dataclass(frozen=True)
class PooledDisplays:
    """The displays of a pool. beyond: differences over the limits that are pooled all the same."""

    shown_on: tuple[ShownOn, ...] = ()
    beyond: tuple[str, ...] = ()

    @cached_property
    def displays(self) -> tuple[DisplayRecord | None, ...]:
        """Each display once, in the order in which answers have it; None for an unknown one."""
        return tuple(shown.display for shown in self.first_of_each)

    def _of_people(self) -> list[DisplayRecord | None]:
        return [s.display for s in self.shown_on if not s.simulated]

    def place_of(self, display: DisplayRecord | None) -> int | None:
        """The place of a display among `displays`, from 0; None where no answer has it."""
        return self._places.get(_identity(display))

    @cached_property
    def _places(self) -> dict[DisplayRecord | None, int]:
        return {_identity(display): at for at, display in enumerate(self.displays)}

    @cached_property
    def first_of_each(self) -> tuple[ShownOn, ...]:
        """The first answers on each of `displays`."""
        firsts: dict[DisplayRecord | None, ShownOn] = {}
        for shown in self.shown_on:
            firsts.setdefault(_identity(shown.display), shown)
        return tuple(firsts.values())

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader has to know of the displays, a sentence each."""
        lines = list(self.beyond)
        unknown = [s for s in self.shown_on if s.display is None]
        if unknown:
            files = ", ".join(dict.fromkeys(printable(s.path, 300) for s in unknown))
            lines.append(
                f"{files}: no record of the display, so that nothing shows whether these answers "
                "belong to the same display as others"
            )
        known = [s.display for s in self.shown_on if s.display is not None]
        if any(d is not None and d.origin == ASSUMED for d in self._of_people()):
            lines.append(
                "some displays were assumed to be sRGB: nobody has described them; give the next "
                "sitting's with --display"
            )
        if len(self.displays) > 1 and not all(d.luminance_known for d in known):
            lines.append("white luminances are not all known, and were compared where they are")
        return tuple(lines)


def displays_of(records: Iterable[Record]) -> tuple[ShownOn, ...]:
    """Each observer's displays, in the order of their answers."""
    rows: list[ShownOn] = []
    for record in records:
        by_run = {run.id: run.display for run in record.runs}
        answers = Counter((answer.observer, answer.run) for answer in record.answers)
        runs_of: dict[int, list[int]] = {}
        for number, run in sorted(answers):
            runs_of.setdefault(number, []).append(run)
        for observer in record.observers:
            own: dict[DisplayRecord | None, ShownOn] = {}
            for run in runs_of.get(observer.number, []):
                count, display = answers[observer.number, run], by_run.get(run)
                key = _identity(display)
                if key in own:
                    count += own[key].answers
                    display = own[key].display
                simulated = observer.kind == SIMULATED
                own[key] = ShownOn(record.path, observer.name, display, count, simulated)
            rows += own.values()
    return tuple(rows)


def pooled_displays(records: Sequence[Record], *, pool_all: bool) -> PooledDisplays:
    """The displays of some session files. pool_all: displays that differ too much are noted.

    Raises InputError otherwise, in a line that names both files, what differs and how to mend it.
    """
    made = PooledDisplays(displays_of(records))
    each = [shown for shown in made.first_of_each if shown.display is not None]
    if len(each) > MOST_DISPLAYS:
        raise InputError(
            f"{printable(each[-1].path)}: more than {MOST_DISPLAYS} different displays; "
            "analyse fewer files at once"
        )
    beyond = []
    for one, other in itertools.combinations(each, 2):
        first, second = one.display, other.display
        assert first is not None
        assert second is not None
        over = difference(first, second).beyond
        if over:
            line = f"{_who(one, other)}: {'; '.join(over)} ({first.words}; {second.words})"
            if not pool_all:
                raise InputError(f"{line}; {MEND}")
            beyond.append(f"{line}; pooled all the same, as {POOL_ALL} asks")
    return dataclasses.replace(made, beyond=tuple(beyond))


def _who(one: ShownOn, other: ShownOn) -> str:
    path, before = printable(other.path, 300), printable(one.path, 300)
    if one.path != other.path:
        return f"{path}: its display differs too much from that of {before}"
    if one.observer == other.observer:
        return f"{path}: {printable(one.observer, 40)} continued on a display that differs too much"
    names = f"{printable(one.observer, 40)} and {printable(other.observer, 40)}"
    return f"{path}: the displays of {names} differ too much"


def _identity(display: DisplayRecord | None) -> DisplayRecord | None:
    """A display wherever its description came from."""
    return None if display is None else dataclasses.replace(display, origin=ASSUMED, name="")
