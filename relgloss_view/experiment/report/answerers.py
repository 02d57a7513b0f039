"""Who answered, in which file, and what simulated observers were told to be right."""

from __future__ import annotations

import math
from collections.abc import Iterator

from relgloss_view.base.reading import printable
from relgloss_view.experiment.session.pool import Member, Pool
from relgloss_view.experiment.session.records import PERSON, SIMULATED, Observer, Record
from relgloss_view.picture.scene.setting import Setting


def answerers(pool: Pool) -> Iterator[tuple[Record, Observer, Member]]:
    """Each member of the pool with its file and its place in it."""
    members = iter(pool.members)
    for record in pool.records:
        given = {answer.observer for answer in record.answers}
        for observer in record.observers:
            if observer.number in given:
                yield record, observer, next(members)


def silent(pool: Pool) -> list[str]:
    """Who came and has not answered anything, by name."""
    found = []
    for record in pool.records:
        given = {answer.observer for answer in record.answers}
        found += [o.name for o in record.observers if o.number not in given]
    return found


def made(pool: Pool) -> list[dict[str, object]]:
    """How each simulated observer was made, as its file tells."""
    return [
        {"file": path_words(record), "observer": observer.name, **details}
        for record in pool.records
        for observer, details in zip(record.observers, record.details, strict=True)
        if observer.kind == SIMULATED and isinstance(details, dict)
    ]


def truths(pool: Pool) -> dict[str, Setting]:
    """What is right for each sample, where all simulated observers were told the same."""
    found: dict[str, Setting | None] = {}
    for details in made(pool):
        told = details.get("truths")
        if not isinstance(told, dict):
            continue
        for sample in pool.study.samples:
            setting = _setting(told.get(sample.label))
            same = found.setdefault(sample.label, setting) == setting
            found[sample.label] = setting if same else None
    return {label: setting for label, setting in found.items() if setting is not None}


def _setting(pair: object) -> Setting | None:
    """A setting of what a file says; None where that is none."""
    if not isinstance(pair, list) or len(pair) != 2:
        return None
    if not all(isinstance(v, int | float) and math.isfinite(v) for v in pair):
        return None
    return Setting(float(pair[0]), float(pair[1]))


def people(pool: Pool) -> str:
    """How many of which kind answered, and how many of them are through."""
    told = []
    for kind, one, many in (
        (PERSON, "person", "persons"),
        (SIMULATED, "simulated observer", "simulated observers"),
    ):
        those = [m for m in pool.members if m.kind == kind]
        if those:
            through = sum(m.ended for m in those)
            if len(those) == 1:
                told.append(f"1 {one}, {'through' if through else 'not through'}")
            else:
                all_ = "all" if through == len(those) else through
                told.append(f"{len(those)} {many}, {all_} through")
    return "; ".join(told)


def path_words(record: Record) -> str:
    """A file's name as given, fit to print and to be written."""
    return printable(record.path, 300)
