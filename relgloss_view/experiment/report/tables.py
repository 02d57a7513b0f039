"""An analysis as CSV tables: the scale, setting by setting, and every answer."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from relgloss_view.base.csv_files import write_csv
from relgloss_view.base.writing import PRIVATE
from relgloss_view.experiment.report.answerers import answerers, path_words
from relgloss_view.experiment.report.chosen_setting import scale_table, setting_chosen_by
from relgloss_view.experiment.report.results import counts_of
from relgloss_view.experiment.session.pool import Pool
from relgloss_view.experiment.verdict.analysis import Analysis

SCALE, ANSWERS = "scale.csv", "answers.csv"
#: Then one column a category, numbered from 1, close.
SCALE_COLUMNS = (
    "sample", "question", "sigma_n_deg", "c_fraction", "probit", "low", "high", "torgerson",
    "wins", "as_good", "n",
)  # fmt: skip
ANSWER_COLUMNS = (
    "file", "observer", "kind", "position", "sample", "sigma_n_deg", "c_fraction", "repeat",
    "question", "category", "category_name", "response_s", "display", "display_name",
)  # fmt: skip
CsvRow = Sequence[object]


def write_tables(folder: Path, analysis: Analysis) -> None:
    """scale.csv and answers.csv."""
    categories = analysis.pool.study.categories
    named = [f"{k} {name}" for k, name in enumerate(categories, start=1)]
    write_csv(folder / SCALE, (*SCALE_COLUMNS, *named), _scale_rows(analysis))
    (folder / ANSWERS).touch(PRIVATE)  # people's answers are for the owner of the file alone
    write_csv(folder / ANSWERS, ANSWER_COLUMNS, answer_rows(analysis.pool))


def answer_rows(pool: Pool) -> Iterable[CsvRow]:
    """Every standing answer; positions and repeats from 0, categories from 1, as the keys are.

    Displays are numbered from 1, as in the report; the name of an unknown one is empty.
    """
    study = pool.study
    settings = study.grid.settings
    for record, observer, member in answerers(pool):
        runs = {answer.run for answer in member.answers}
        shown_on = {
            run.id: (
                1 + (pool.displays.place_of(run.display) or 0),
                "" if run.display is None else run.display.name,
            )
            for run in record.runs
            if run.id in runs
        }
        for answer in member.answers:
            trial = answer.trial
            setting = settings[trial.setting]
            yield (
                path_words(record),
                observer.name,
                observer.kind,
                trial.position,
                study.samples[trial.sample].label,
                setting.sigma_n_deg,
                setting.c_fraction,
                trial.repeat,
                answer.question,
                answer.category + 1,
                study.categories[answer.category],
                answer.response_s,
                *shown_on.get(answer.run, ("", "")),
            )


def _scale_rows(analysis: Analysis) -> Iterable[CsvRow]:
    grid = analysis.pool.study.grid
    categories = len(analysis.pool.study.categories)
    for result in analysis.samples:
        counts = counts_of(analysis.pool, result.label)
        for question in result.verdicts:
            choice = setting_chosen_by(result, grid, question)
            values = scale_table(result, counts, question)
            for k, setting in enumerate(grid.settings):
                row: list[object] = [""] * (1 + categories)
                if values.counts is not None:
                    of_setting = [int(n) for n in values.counts[k]]
                    row = [sum(of_setting), *of_setting]
                yield (
                    result.label,
                    question,
                    setting.sigma_n_deg,
                    setting.c_fraction,
                    _number(values.probit[k]),
                    _number(values.low[k]),
                    _number(values.high[k]),
                    _number(values.torgerson[k]),
                    "" if choice.shares is None else _number(choice.shares[k]),
                    int(choice.as_good[k]),
                    *row,
                )


def _number(value: float) -> object:
    return float(f"{value:.10g}") if np.isfinite(value) else ""
