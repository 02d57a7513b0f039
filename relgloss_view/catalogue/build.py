"""Building a catalogue: what has to be done, handed to an engine, kept, and written as one table.

Only what has changed is worked on. The store (store.py) has each item as soon as it is done; the
table and the materials are made of it at the end, so they never hold half of a build.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.reading import named, printable
from relgloss_view.base.shell import command_line
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.catalogue.columns import FAILED, TABLE_FILE
from relgloss_view.catalogue.engine import EngineOptions, Lost, Task, run
from relgloss_view.catalogue.folder import claimed, write_mark
from relgloss_view.catalogue.item import OF_LOOK, OF_MACHINE, Fitted, Item
from relgloss_view.catalogue.look import reference_of
from relgloss_view.catalogue.outcome import write_outcome
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.store import Store, key_of
from relgloss_view.catalogue.table import rows_in
from relgloss_view.catalogue.tree import Entry, Tree, is_catalogue, scan
from relgloss_view.catalogue.work import close_renderer, make_item
from relgloss_view.material.material import Quality

MOST_NAMED, LONGEST_PATH = 5, 400  #: of the files passed over
GOOD = str(Quality.GOOD)


@dataclass(frozen=True)
class BuildOptions:
    """How a build goes about its work; nothing of it changes a result.

    keep_going: work on the other files after a fault, and write the table with all faults. retry:
    work on files again that failed before and are unchanged. progress: shares from 0 to 1.
    """

    engine: EngineOptions = field(default_factory=lambda: EngineOptions(workers=1))
    keep_going: bool = False
    retry: bool = False
    progress: ProgressReport = no_progress


@dataclass
class Report:
    """What a build has done. Counts are of files; equal files that share work count as one."""

    rows: int = 0  #: files of the tree that are in the table
    done: int = 0  #: in the table, or kept for it where a fault has ended the build
    failed: int = 0
    worked: int = 0  #: read, and fitted where they are tables
    drawn_again: int = 0  #: metered, matched and drawn alone, because the reference has changed
    unchanged: int = 0
    removed: int = 0  #: materials of files that are no longer in the tree
    unread_folders: int = 0  #: whose files are in no row
    passed_over: int = 0  #: files that are no tables, materials or proofs
    doubtful: list[str] = field(default_factory=list)  #: of them, those named as tables are
    importable: list[str] = field(default_factory=list)  #: of them, materials of other programs
    qualities: dict[str, int] = field(default_factory=dict)  #: how many fits are good, poor ...
    faults: list[str] = field(default_factory=list)  #: PATH: what is wrong, sorted
    is_complete: bool = False  #: whether the table was written

    def as_json(self) -> dict[str, Any]:
        """The report as `--json` prints it."""
        return dict(vars(self))


def build(
    folder: str | os.PathLike[str],
    output: str | os.PathLike[str],
    recipe: Recipe | None = None,
    options: BuildOptions | None = None,
) -> Report:
    """Make or renew the catalogue of a tree.

    folder: the tree of tables, materials and proofs. output: the catalogue's folder, a new one, an
    empty one or a catalogue. A fault of a file ends the build, but for what is in hand, unless
    `keep_going`; the report's `is_complete` is False then, and the table stays as it was. What is
    done is kept in any case. Raises InputError where tree or catalogue can't be used.
    """
    recipe, options = recipe or Recipe(), options or BuildOptions()
    if not os.fspath(folder):
        raise InputError("an empty name; give the folder of samples, or . for this one")
    top = os.path.realpath(folder)
    reference_of(recipe)  # before anything is written
    if is_catalogue(top):
        raise InputError(f"{named(os.fspath(folder))}: is a catalogue; give the folder of samples")
    with claimed(output, top) as catalogue, contextlib.closing(_Renderer()):
        write_mark(catalogue)
        tree = scan(top, lambda count: options.progress(0.0, f"{count:,} files looked at"))
        if not tree.entries:
            _check_was_empty(folder, catalogue)
        return _Build(catalogue, tree, recipe, options).build()


def _check_was_empty(folder: str | os.PathLike[str], catalogue: Path) -> None:
    """InputError where a tree without a sample would empty a catalogue: a drive may be away."""
    count = rows_in(catalogue / TABLE_FILE)
    if count:
        raise InputError(
            f"{named(os.fspath(folder))}: holds no table, material or proof, and the catalogue has "
            f"{_counted(count, 'file')} of it; check that its drive is there, or remove the "
            "catalogue"
        )


class _Renderer:
    """This process's renderer, which is given back at the end."""

    def close(self) -> None:
        close_renderer()


class _Build:
    """One build of a catalogue that is claimed."""

    def __init__(self, catalogue: Path, tree: Tree, recipe: Recipe, options: BuildOptions) -> None:
        self.catalogue, self.tree, self.recipe, self.options = catalogue, tree, recipe, options
        self.store = Store(catalogue)
        self.report = Report(rows=len(tree.entries), passed_over=tree.passed_over)
        self.report.doubtful = list(tree.doubtful)
        self.report.importable = list(tree.importable)
        self.report.unread_folders = len(tree.faults)
        self.keys: dict[str, str] = {}  #: record by path
        self._groups: dict[str, list[Entry]] = {}  #: entries by record
        self._stopped = False
        self._finished = 0
        self._began = 0.0  #: seconds of a clock, for the progress alone

    def build(self) -> Report:
        """Do what is to be done, and write the outcome."""
        self._note_faults(self.tree.faults)
        whole, look_only = self._plan()
        self._total = len(whole) + len(look_only)
        self._began = time.monotonic()
        if not self._stopped and self._total:
            run(self._tasks(whole, look_only), self._done, self.options.engine)
        self.report.faults.sort()
        self.report.failed = len(self.report.faults) - len(self.tree.faults)
        if not self._stopped:
            self._write()
        return self.report

    def _plan(self) -> tuple[list[str], list[str]]:
        """The records that are to be made, and those of which only the second half is."""
        whole: list[str] = []
        look_only: list[str] = []
        for entry in self.tree.entries:
            if entry.fault:
                self._note_faults([f"{entry.path}: {entry.fault}"])
                continue
            key = self.keys[entry.path] = key_of(entry, self.recipe)
            self._groups.setdefault(key, []).append(entry)
        for number, (key, entries) in enumerate(self._groups.items()):
            checkpoint()
            self.options.progress(0.0, f"{number + 1:,} of {len(self._groups):,} items compared")
            kept = self.store.kept(key)
            if kept is None or kept.failed_in == OF_MACHINE or (
                kept.failed_in and self.options.retry
            ):  # fmt: skip
                whole.append(key)
            elif kept.is_current(self.recipe):
                self.report.unchanged += 1
                if kept.failed_in:
                    self._note_failed(entries, self.store.item(key))
                else:
                    self.report.done += len(entries)
            else:
                look_only.append(key)
        return whole, look_only

    def _tasks(self, whole: list[str], look_only: list[str]) -> Iterator[Task]:
        """The work, made shortly before it is done."""
        for key in whole:
            if self._stopped:
                return
            yield self._task(key, None)
        for key in look_only:
            if self._stopped:
                return
            item = self.store.item(key)
            yield self._task(key, None if item is None else item.fitted)

    def _task(self, key: str, fitted: Fitted | None) -> Task:
        first = self._groups[key][0]
        if fitted is None:
            self.report.worked += 1
        else:
            self.report.drawn_again += 1
        arguments = (first.file, first.path, first.kind, first.sha256, self.recipe, fitted)
        sort = first.kind if fitted is None else OF_LOOK
        return Task(key, first.path, make_item, arguments, sort)

    def _done(self, task: Task, result: Item | Lost) -> None:
        """Keep a result, whichever comes first."""
        entries = self._groups[task.key]
        if isinstance(result, Lost):
            first = entries[0]
            row = {"path": first.path, "kind": first.kind, "sha256": first.sha256,
                   "status": FAILED, "fault": result.fault}  # fmt: skip
            result = Item(row, failed_in=OF_MACHINE)
        self.store.put(task.key, result, self.recipe)
        if result.failed:
            self._note_failed(entries, result)
        else:
            self.report.done += len(entries)
        self._finished += 1
        failed = len(self.report.faults)
        words = f"{self._finished:,} of {self._total:,}" + (f", {failed} failed" if failed else "")
        words += _left_words(time.monotonic() - self._began, self._finished / self._total)
        self.options.progress(self._finished / self._total, f"{words}: {printable(task.name, 40)}")

    def _note_failed(self, entries: list[Entry], item: Item | None) -> None:
        fault = "" if item is None else item.row.get("fault")
        self._note_faults([f"{entry.path}: {fault}" for entry in entries])

    def _note_faults(self, faults: list[str] | tuple[str, ...]) -> None:
        self.report.faults += faults
        self._stopped = self._stopped or (bool(faults) and not self.options.keep_going)

    def _write(self) -> None:
        """Table and materials of the whole tree; what is of no use any more goes."""
        written = write_outcome(
            self.catalogue, self.tree.entries, self.keys, self.store, self.recipe,
            self.options.progress,
        )  # fmt: skip
        if not self.tree.faults and not any(entry.fault for entry in self.tree.entries):
            self.store.tidy(self._groups.keys())  # else files that are away for a day are made anew
        self.report.removed = written.removed
        self.report.done = written.done
        self.report.qualities = dict(sorted(written.qualities.items()))
        self.report.is_complete = True


def _left_words(elapsed_s: float, share: float) -> str:
    """How long the rest may take, once the beginning counts for little.

    >>> _left_words(60.0, 0.25), _left_words(7200.0, 0.5), _left_words(4.0, 0.25)
    (', 3 min left', ', 2.0 h left', '')
    """
    left_s = elapsed_s * (1.0 - share) / share
    if elapsed_s < 20.0 or left_s < 60.0:
        return ""
    return (
        f", {left_s / 60.0:.0f} min left" if left_s < 5400.0 else f", {left_s / 3600.0:.1f} h left"
    )


def words_of(report: Report, output: str) -> list[str]:
    """A report as lines for people."""
    lines = []
    if report.is_complete:
        lines.append(
            f"{_counted(report.rows, 'file')}: {report.done:,} done, {report.failed:,} failed"
        )
        lines += _fits_words(report, output)
    work = [
        (report.worked, "new or changed"),
        (report.drawn_again, "only metered and drawn again"),
        (report.unchanged, "unchanged"),
    ]
    lines.append("; ".join(f"{count:,} {words}" for count, words in work))
    if report.removed:
        lines.append(f"{_counted(report.removed, 'material')} of files that are gone: removed")
    if report.unread_folders:
        lines.append(
            f"{_counted(report.unread_folders, 'folder')} not read; what was made of files in "
            "them is kept for a later build"
        )
    if report.passed_over:
        words = _counted(report.passed_over, "file")
        lines.append(f"{words} passed over: no table, material or proof")
        lines += _listed(
            "is one of these a table? `relgloss measure FILE` prints what is wrong:",
            report.doubtful,
        )
        lines += _listed(
            "materials of other programs; `relgloss import FILE -o MATERIAL.json` reads them:",
            report.importable,
        )
    if report.is_complete:
        lines.append(f"{printable(os.path.join(output, TABLE_FILE))}: written")
    return lines


def _fits_words(report: Report, output: str) -> list[str]:
    """How good the fits are, and how to see those that are not."""
    if not report.qualities:
        return []
    line = "fits: " + ", ".join(
        f"{count:,} {quality}" for quality, count in report.qualities.items()
    )
    if set(report.qualities) - {GOOD}:
        search = command_line(["relgloss", "catalogue", "search", output, "quality is not good"])
        line += f"; gloss and pictures of the others may be wrong: {search}"
    return [line]


def _listed(heading: str, paths: list[str]) -> list[str]:
    """A heading and files below it, a line each; nothing without files."""
    if not paths:
        return []
    lines = [f"  {printable(path, LONGEST_PATH)}" for path in paths[:MOST_NAMED]]
    more = len(paths) - MOST_NAMED
    return [heading, *lines, *([f"  and {more:,} more"] if more > 0 else [])]


def _counted(count: int, noun: str) -> str:
    return f"{count:,} {noun}{'' if count == 1 else 's'}"
