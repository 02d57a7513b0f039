"""`relgloss experiment export`: the answers of a study as a table, and its stimuli as pictures."""

from __future__ import annotations

import argparse
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import together, whole_file, whole_folder
from relgloss_view.commands.output_folder import own_folder, stimuli_files
from relgloss_view.quality.backends import BACKENDS

if TYPE_CHECKING:
    from relgloss_view.display.record import DisplayRecord
    from relgloss_view.experiment.design.study import Study
    from relgloss_view.experiment.session.pool import Pool

FORMAT, VERSION = "relgloss-stimuli", 1
MANIFEST = "manifest.json"


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "export",
        help="the answers as a table, and the stimuli as pictures",
        description="Write every answer of session files as one table (CSV or JSON), or draw the "
        "study's stimuli again and compare each with what the observers saw.",
        epilog="example: relgloss experiment export monday.sqlite -o answers.csv",
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="Session files of one study")
    parser.add_argument(
        "-o", "--output", metavar="OUT.csv|OUT.json", help="File for the table of answers"
    )
    parser.add_argument("--stimuli", metavar="FOLDER", help="Folder for the stimuli, as PNG")
    parser.add_argument(
        "--backend", choices=BACKENDS, default="auto", help="Renderer of the pictures"
    )
    parser.add_argument(
        "--json", action="store_true", help="Print a list of the written files as JSON"
    )
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Write what was asked for."""
    from relgloss_view.experiment.session.losses import warnings
    from relgloss_view.experiment.session.pool import read_pool

    if args.output is None and args.stimuli is None:
        args.wrong_usage("give -o OUT.csv, --stimuli FOLDER, or both")
    table = None if args.output is None else Path(args.output)
    if table is not None and table.suffix.lower() not in (".csv", ".json"):
        raise InputError(f"{printable(table)}: expected a name that ends in .csv or .json")
    for file in args.files:
        if table is not None and table.exists() and os.path.exists(file) and table.samefile(file):
            raise InputError(f"{printable(table)}: is a session file; give the table another name")
    folder = None
    if args.stimuli is not None:
        folder = own_folder(args.stimuli, {MANIFEST: FORMAT}, "experiment export", alone=True)
    with scratch_folder() as lamps:
        pool = read_pool(args.files, lamps, pool_displays=True)  # a table analyses nothing
        for record in pool.records:
            for line in warnings(record.losses, record.path):
                warn(line)
        for line in pool.displays.beyond:
            warn(line)
        written: dict[str, Any] = {}
        with together():
            if table is not None:
                written["answers"] = _write_answers(table, pool)
            if folder is not None:
                written["stimuli"] = _draw_stimuli(folder, pool, args.backend, lamps)
    if args.json:
        print(json.dumps({"files": args.files, **written}))
        return 0
    if table is not None:
        print(f"{printable(table)}: {written['answers']} answers")
    if folder is not None:
        print(f"{printable(folder)}: {_words(written['stimuli'])}")
    return 0


def _write_answers(path: Path, pool: Pool) -> int:
    from relgloss_view.base.csv_files import write_csv
    from relgloss_view.experiment.report.tables import ANSWER_COLUMNS, answer_rows

    rows = list(answer_rows(pool))
    with whole_file(path, private=True) as temporary:
        if path.suffix.lower() == ".csv":
            write_csv(temporary, ANSWER_COLUMNS, rows)
        else:
            answers = [dict(zip(ANSWER_COLUMNS, row, strict=True)) for row in rows]
            temporary.write_text(json.dumps(answers, indent=1) + "\n", encoding="utf-8")
    return len(rows)


def _draw_stimuli(folder: Path, pool: Pool, backend: str, scratch: Path) -> list[dict[str, Any]]:
    """Draw the reference and every setting of every sample; what the manifest says of each.

    They are drawn for each display that observers saw them on: digital values are a display's own.
    """
    from relgloss_view.experiment.design.stimuli import (
        digest_of,
        draw_reference,
        draw_stimulus,
        frame_record,
    )
    from relgloss_view.experiment.report.file_names import file_names
    from relgloss_view.picture.output.writers import Writers
    from relgloss_view.quality.backends import open_renderer

    pool.study.check_drawn_again()
    displays = pool.displays.displays
    studies = _studies_on(pool, scratch)
    digests: dict[tuple[int, int | None, int | None], set[str]] = {}
    for record in pool.records:
        shown_on = {run.id: run.display for run in record.runs}
        for picture in record.pictures:
            place = pool.displays.place_of(shown_on.get(picture.run))
            if place is not None:
                key = (place, picture.sample, picture.setting)
                digests.setdefault(key, set()).add(picture.sha256)
    names = file_names([sample.label for sample in pool.study.samples])
    of_study: list[tuple[int | None, int | None]] = [(None, None)]
    of_study += [(k, j) for k in range(len(names)) for j in range(len(pool.study.grid))]
    wanted = [(display, *pair) for display in range(len(studies)) for pair in of_study]
    stimuli = []
    with (
        open_renderer(backend) as renderer,
        Progress("export") as progress,
        whole_folder(folder, MANIFEST, lambda old: stimuli_files(old, MANIFEST)) as temporary,
        Writers() as writers,
    ):
        for number, (display, sample, setting) in enumerate(wanted):
            study, suffix = studies[display], f"-display{display + 1}" if display else ""
            if sample is None or setting is None:
                frame, name = draw_reference(renderer, study), f"reference{suffix}.png"
            else:
                frame = draw_stimulus(renderer, study, sample, setting)
                at = study.grid.settings[setting]
                name = f"{names[sample]}-{setting:03d}{suffix}.png"
                progress(number / len(wanted), f"{study.samples[sample].label}, {at.words}")
            digest = digest_of(frame)
            digests_then = digests.get((display, sample, setting))
            writers.save(frame, temporary / name, "")
            stimuli.append(
                {
                    "file": name,
                    "sample": None if sample is None else study.samples[sample].label,
                    "setting": setting,
                    "display": display,
                    **frame_record(frame),
                    "sha256": digest,
                    "as_shown": None if digests_then is None else digests_then == {digest},
                }
            )
        manifest = {
            "format": FORMAT, "version": VERSION, "relgloss_version": __version__,
            "device": frame.device, "displays": [_display_words(d) for d in displays],
            "stimuli": stimuli,
        }  # fmt: skip
        text = json.dumps(manifest, indent=1) + "\n"
        (temporary / MANIFEST).write_text(text, encoding="utf-8")
    return stimuli


def _studies_on(pool: Pool, scratch: Path) -> list[Study]:
    """The study on each display of the pool; InputError where a display's file is not kept."""
    from relgloss_view.experiment.session.sitting import display_of_record

    by_path = {record.path: record for record in pool.records}
    studies = []
    for shown in pool.displays.first_of_each:
        kept = by_path[shown.path]
        if shown.display is None:  # of an earlier version, which drew for the study's display
            studies.append(kept.study)
            continue
        display = display_of_record(kept.study, shown.display, kept.display_files, scratch)
        if display is None:
            raise InputError(
                f"{printable(shown.path)}: the file of the display "
                f"{printable(shown.display.name, 60)!r} is not in it, so that its pictures can't "
                "be drawn again"
            )
        studies.append(kept.study.shown_on(display))
    return studies


def _display_words(record: DisplayRecord | None) -> dict[str, str] | None:
    if record is None:
        return None
    return {"name": record.name, "origin": record.origin, "digest": record.digest}


def _words(stimuli: list[dict[str, Any]]) -> str:
    drawn = f"{len(stimuli)} pictures"
    compared = [s for s in stimuli if s["as_shown"] is not None]
    other = [s["file"] for s in compared if not s["as_shown"]]
    if not compared:
        return f"{drawn}; nobody has seen them in a window, so there is nothing to compare"
    same = f"{len(compared) - len(other)} of {len(compared)} that were shown are the same"
    return f"{drawn}; {same}, bit by bit" + (f" (not: {', '.join(other[:5])})" if other else "")
