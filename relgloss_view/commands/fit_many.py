"""`relgloss fit` with several tables: one after the other, each with its own files and faults."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from relgloss_view.base.decoration import decoration
from relgloss_view.base.errors import InputError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.json_files import read_mark
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Column, Progress, table
from relgloss_view.base.writing import check_writable, make_folder
from relgloss_view.commands import table_places
from relgloss_view.commands.table_options import table_options

if TYPE_CHECKING:
    from relgloss_view.material.material import Material

FITTED, FAILED, NOT_FITTED = "fitted", "failed", "not fitted"
GLOSS_DEG = 60.0
LONGEST_WARNING = 90  #: characters of the first warning in the summary
COLUMNS = (
    Column("name", left=True),
    Column("geometries"),
    Column("bands"),
    Column("model", left=True),
    Column("lobe width"),
    Column("gloss 60"),
    Column("quality", left=True),
    Column("first warning", left=True),
)


@dataclass
class Outcome:
    """What became of one table."""

    place: str
    state: str = NOT_FITTED
    output: str | None = None
    report: str | None = None
    fault: str = ""
    row: tuple[str, ...] = ()  #: of the summary
    content: dict[str, Any] = field(default_factory=dict)  #: the material, for --json

    def as_json(self) -> dict[str, Any]:
        """As JSON holds it."""
        entry: dict[str, Any] = {"table": self.place, "status": self.state}
        if self.state == FAILED:
            entry["fault"] = self.fault
        if self.state == FITTED:
            entry |= {"output": self.output, "report": self.report, **self.content}
        return entry


def run(args: argparse.Namespace, tables: table_places.Tables, fit_options: dict[str, Any]) -> int:
    """Fit all tables and print a summary; 0 where every one is fitted, else 1.

    A table's fault is printed at once, and the others are fitted all the same. Where a signal ends
    the work, the summary lists what is done and what is not.
    """
    for option, name, ending in (("-o", args.output, ".json"), ("--report", args.report, ".png")):
        if name is not None:
            table_places.check_folder(option, name, ending)
    folders = dict.fromkeys(name for name in (args.output, args.report) if name is not None)
    new = [name for name in folders if not os.path.isdir(name)]
    for name in folders:
        make_folder(name)
        check_writable(os.path.join(name, "relgloss.json"))
    outcomes = [Outcome(place) for place in tables.places]
    table_places.report_passed_over(tables)
    stopped: KeyboardInterrupt | None = None
    try:
        _fit_all(args, outcomes, fit_options)
    except KeyboardInterrupt as error:
        stopped = error
    for name in new:
        with contextlib.suppress(OSError):  # it holds files
            os.rmdir(name)
    _print(args, tables, outcomes)
    if stopped is not None:
        rest = [o.place for o in outcomes if o.state == NOT_FITTED]
        listed = ", ".join(printable(place, 60) for place in rest[:10])
        more = f" and {len(rest) - 10} more" if len(rest) > 10 else ""
        print(f"not fitted: {listed}{more}", file=sys.stderr)
        raise stopped
    return int(any(outcome.state == FAILED for outcome in outcomes))


def _fit_all(
    args: argparse.Namespace, outcomes: list[Outcome], fit_options: dict[str, Any]
) -> None:
    places = [outcome.place for outcome in outcomes]
    stems = table_places.stems(places)
    for k, (outcome, stem) in enumerate(zip(outcomes, stems, strict=True)):
        checkpoint()
        try:
            output = table_places.output_of(args.output, stem, ".json", places)
            report = None
            if args.report is not None:
                report = table_places.output_of(args.report, stem, ".png", places)
            _check_ours(output)
            # The bar is cleared before a fault or a warning is printed.
            with Progress(f"fit {k + 1} of {len(places)}") as progress:
                _fit(args, outcome, output, report, _Share(progress, k, outcomes), fit_options)
        except Exception as error:
            outcome.state, outcome.fault = FAILED, table_places.fault_of(outcome.place, error)
            table_places.print_fault(outcome.fault)


@dataclass(frozen=True)
class _Share:
    """A ProgressReport of one table, as its share of all."""

    progress: Progress
    number: int
    outcomes: list[Outcome]

    def __call__(self, share: float, text: str = "") -> bool:
        name = os.path.basename(self.outcomes[self.number].place)
        total = (self.number + min(max(share, 0.0), 1.0)) / len(self.outcomes)
        return self.progress(total, f"{printable(name, 30)}: {text}")


def _fit(
    args: argparse.Namespace,
    outcome: Outcome,
    output: str,
    report: str | None,
    progress: _Share,
    fit_options: dict[str, Any],
) -> None:
    from relgloss_view.fitting import fit_material, write_fit_report
    from relgloss_view.material.files import material_to_dict, save_material
    from relgloss_view.measure.readers import read_measurement

    progress(0.0, "reading")
    measurement = read_measurement(outcome.place, **table_options(args))
    material = fit_material(measurement, progress=progress, **fit_options)
    save_material(material, output)
    outcome.state, outcome.output = FITTED, output
    outcome.row = _row(material, int(measurement.kept.sum()))
    if args.json:
        outcome.content = material_to_dict(material)
    if report is not None:
        with decoration(f"{report}: the report", f"{output} is written") as drawn:
            write_fit_report(material, measurement, report)
        outcome.report = report if drawn.done else None


def _check_ours(output: str) -> None:
    """InputError where a file of that name is no material: nobody has typed this name."""
    from relgloss_view.material.files import FORMAT

    if os.path.lexists(output) and read_mark(output).get("format") != FORMAT:
        raise InputError(
            f"{output}: exists and is no material of relgloss; choose another folder, or move "
            "that file away"
        )


def _row(material: Material, geometries: int) -> tuple[str, ...]:
    """The summary of a fitted material."""
    from relgloss_view.gloss.meter.meter import specular_gloss

    fit = material.fit
    assert fit is not None
    geometries = int(fit.residuals.get("samples", geometries))
    widths = [f"{lobe.s_deg:.3g}" for lobe in material.specular]
    first = printable(material.warnings[0], LONGEST_WARNING) if material.warnings else ""
    bands = "RGB" if material.bands.is_rgb else str(material.bands.count)
    return (
        printable(material.name, 40),
        str(geometries),
        bands,
        fit.chosen,
        ", ".join(widths) or "-",
        f"{specular_gloss(material, GLOSS_DEG):.1f}",
        str(fit.quality),
        first,
    )


def _with_file(outcome: Outcome) -> str:
    """The name of a material that another one has too, with its file."""
    return f"{outcome.row[0]} ({printable(os.path.basename(outcome.output or ''), 40)})"


def _print(args: argparse.Namespace, tables: table_places.Tables, outcomes: list[Outcome]) -> None:
    if args.json:
        content = {
            "output": args.output,
            "tables": [outcome.as_json() for outcome in outcomes],
            "passed_over": list(tables.passed_over),
        }
        print(json.dumps(content))
        return
    fitted = [outcome for outcome in outcomes if outcome.state == FITTED]
    if fitted:
        names = Counter(outcome.row[0] for outcome in fitted)
        rows = [
            (
                _with_file(outcome) if names[outcome.row[0]] > 1 else outcome.row[0],
                *outcome.row[1:],
            )
            for outcome in fitted
        ]
        print(table(COLUMNS, rows))
    for outcome in fitted:
        for path in (outcome.output, outcome.report):
            if path is not None:
                print(f"{printable(path)}: written")
    failed = sum(outcome.state == FAILED for outcome in outcomes)
    words = f"{len(fitted)} of {len(outcomes)} tables fitted"
    print(words + (f"; {failed} failed, each with a line above" if failed else ""))
