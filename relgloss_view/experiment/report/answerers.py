"""Who answered, in which file, and what is right for simulated observers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from relgloss_view.base.reading import printable
from relgloss_view.experiment.observers.kinds import KINDS
from relgloss_view.experiment.observers.truth import right_settings
from relgloss_view.experiment.session.pool import Member, Pool
from relgloss_view.experiment.session.records import PERSON, SIMULATED, Observer, Record
from relgloss_view.picture.scene.setting import Setting


def answerers(pool: Pool) -> Iterator[tuple[Record, Observer, Member]]:
    """Each member of the pool with its file and its place in it."""
    members = iter(pool.members)
    for record in pool.records:
        answered = {answer.observer for answer in record.answers}
        for observer in record.observers:
            if observer.number in answered:
                yield record, observer, next(members)


def silent(pool: Pool) -> list[str]:
    """Who came and has not answered anything, by name."""
    names = []
    for record in pool.records:
        answered = {answer.observer for answer in record.answers}
        names += [o.name for o in record.observers if o.number not in answered]
    return names


def made(pool: Pool) -> list[dict[str, object]]:
    """How each simulated observer was made, as its file tells."""
    return [
        {"file": path_words(record), "observer": observer.name, **details}
        for record in pool.records
        for observer, details in zip(record.observers, record.details, strict=True)
        if observer.kind == SIMULATED and isinstance(details, dict)
    ]


def truths(pool: Pool) -> dict[str, Setting]:
    """What is right for each sample, where it is the same for all simulated observers."""
    settings: dict[str, Setting | None] = {}
    for details in made(pool):
        stored = details.get("truths")
        if not isinstance(stored, dict):
            continue
        for sample in pool.study.samples:
            setting = _setting(stored.get(sample.label))
            same = settings.setdefault(sample.label, setting) == setting
            settings[sample.label] = setting if same else None
    return {label: setting for label, setting in settings.items() if setting is not None}


def also_right(pool: Pool, truth: Setting) -> tuple[Setting, ...]:
    """The settings that are as right as a truth, for the kind that all simulated observers are."""
    kinds = {details.get("kind") for details in made(pool)}
    kind = kinds.pop() if len(kinds) == 1 else None
    count = KINDS[kind].right_settings if isinstance(kind, str) and kind in KINDS else 1
    return right_settings(pool.study.grid, truth, count)[1:]


def _setting(pair: object) -> Setting | None:
    """A setting of what a file says; None where that is none."""
    if not isinstance(pair, list) or len(pair) != 2:
        return None
    if not all(isinstance(v, int | float) and math.isfinite(v) for v in pair):
        return None
    return Setting(float(pair[0]), float(pair[1]))


def people(pool: Pool) -> str:
    """How many of which kind answered, and how many of them have finished."""
    parts = []
    for kind, one, many in (
        (PERSON, "person", "persons"),
        (SIMULATED, "simulated observer", "simulated observers"),
    ):
        those = [m for m in pool.members if m.kind == kind]
        if those:
            finished = sum(m.ended for m in those)
            if len(those) == 1:
                parts.append(f"1 {one}, {'finished' if finished else 'not finished'}")
            else:
                all_ = "all" if finished == len(those) else finished
                parts.append(f"{len(those)} {many}, {all_} finished")
    return "; ".join(parts)


def path_words(record: Record) -> str:
    """A file's name as given, fit to print and to be written."""
    return printable(record.path, 300)
