"""An analysis as numbers: one JSON object. Format in docs/files.md."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.version import __version__
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.report.answerers import made, path_words, silent, truths
from relgloss_view.experiment.report.chosen_setting import (
    ChosenSetting,
    Interval,
    chosen_setting,
    scale_table,
    setting_chosen_by,
)
from relgloss_view.experiment.report.sentences import notes, sentence, unscaled
from relgloss_view.experiment.scaling.bootstrap import ScaleValues
from relgloss_view.experiment.session.display_difference import difference
from relgloss_view.experiment.session.pool import Pool
from relgloss_view.experiment.session.pooled_displays import PooledDisplays
from relgloss_view.experiment.session.records import Record, Run
from relgloss_view.experiment.verdict.analysis import JOINT, Analysis, SampleResult
from relgloss_view.experiment.verdict.recovery import (
    Recovery,
    recovery_shares,
    shares_by_sample,
)
from relgloss_view.picture.scene.setting import Setting

FORMAT, VERSION = "relgloss-experiment-results", 1


def as_numbers(analysis: Analysis) -> dict[str, Any]:
    """Everything that was found, in JSON's own types; None where there is no number."""
    pool = analysis.pool
    study = pool.study
    content = {
        "format": FORMAT,
        "version": VERSION,
        "relgloss_version": __version__,
        "study": {
            "title": study.title,
            "samples": [s.label for s in study.samples],
            "grid": dataclasses.asdict(study.grid),
            "categories": study.categories,
            "questions": study.questions,
            "procedure": dataclasses.asdict(study.procedure),
            "screen": dataclasses.asdict(study.screen),
        },
        "analysis": {
            "draws": analysis.options.draws,
            "seed": analysis.options.seed,
            "observer_effects": analysis.options.observer_effects,
            "zero": analysis.options.zero,
            "level": analysis.level,
        },
        "simulated": pool.simulated,
        "truths": {label: setting_numbers(truth) for label, truth in truths(pool).items()} or None,
        "simulated_observers": made(pool),
        "files": [_file(record) for record in pool.records],
        "displays": display_numbers(pool.displays),
        "display_notes": pool.displays.notes,
        "observers": [
            {**dataclasses.asdict(o), "relation": _relation(o.relation), "told": o.remarks}
            for o in analysis.observers
        ],
        "without_answers": silent(pool),
        "untold": unscaled(analysis),
        "samples": [_sample(result, analysis) for result in analysis.samples],
    }
    plain: dict[str, Any] = plain_json(content)
    return plain


def recovery_numbers(recoveries: Sequence[Recovery]) -> dict[str, Any]:
    """What simulated studies recovered, in JSON's own types."""
    by_sample = shares_by_sample(recoveries)
    return {
        "all": dataclasses.asdict(recovery_shares(recoveries)),
        "samples": {label: dataclasses.asdict(shares) for label, shares in by_sample.items()},
        "studies": [
            {
                **dataclasses.asdict(r),
                "truth": setting_numbers(r.truth),
                "leading": setting_numbers(r.leading),
            }
            for r in recoveries
        ],
    }


def plain_json(value: Any) -> Any:
    """A value in JSON's own types; NaN and infinities are None."""
    if isinstance(value, Mapping):
        return {str(key): plain_json(v) for key, v in value.items()}
    if isinstance(value, np.ndarray):
        return plain_json(value.tolist())
    if isinstance(value, list | tuple):
        return [plain_json(v) for v in value]
    if isinstance(value, np.generic):
        return plain_json(value.item())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def counts_of(pool: Pool, label: str) -> dict[str, Array]:
    """Answers about a sample by question: (J, K), how often each setting got each category."""
    number = [s.label for s in pool.study.samples].index(label)
    return {q: pool.answers(number, q).counts().sum(axis=0) for q in pool.study.questions}


def _file(record: Record) -> dict[str, Any]:
    return {
        "file": path_words(record),
        "study_digest": record.digest,
        "relgloss_version": record.version,
        "observers": len(record.observers),
        "answers": len(record.answers),
        "taken_back": record.undone,
        "losses": [dataclasses.asdict(loss) for loss in record.losses],
        "runs": [_run(run) for run in record.runs],
    }


def _run(run: Run) -> dict[str, Any]:
    """A run, with its display by name and digest: `displays` has the rest."""
    own = {name: value for name, value in vars(run).items() if name != "display"}
    display = run.display
    named = None if display is None else {k: getattr(display, k) for k in ("name", "digest")}
    return {**own, "display": named}


def display_numbers(displays: PooledDisplays) -> list[dict[str, Any] | None]:
    """Each display of a pool with its difference from the first; None for an unknown one."""
    first = next((d for d in displays.displays if d is not None), None)
    rows: list[dict[str, Any] | None] = []
    for number, display in enumerate(displays.displays):
        if display is None or first is None:
            rows.append(None)
            continue
        shown = [s for s in displays.shown_on if displays.place_of(s.display) == number]
        apart = dataclasses.asdict(difference(first, display))
        rows.append(
            {
                **display.to_dict(),
                "answers": sum(s.answers for s in shown),
                "from_the_first": apart,
            }
        )
    return rows


def _relation(relation: Any) -> dict[str, Any]:
    return {"correlation": relation.correlation, "p": relation.p}


def setting_numbers(setting: Setting) -> dict[str, float]:
    """A setting of a grid."""
    return {"sigma_n_deg": setting.sigma_n_deg, "c_fraction": setting.c_fraction}


def _sample(result: SampleResult, analysis: Analysis) -> dict[str, Any]:
    grid = analysis.pool.study.grid
    counts = counts_of(analysis.pool, result.label)
    choice = chosen_setting(result, grid)
    return {
        "label": result.label,
        "answers": result.answers,
        "observers": result.observers,
        "decided_by": "posterior" if choice.adaptive else result.decided_by,
        **_choice(choice, grid),
        "words": sentence(result, analysis),
        "notes": notes(result, analysis),
        "krippendorff_alpha": result.alpha,
        "kendall_w": result.w,
        "adaptive": _adaptive(result),
        "questions": {
            question: _question(result, grid, counts, question) for question in result.verdicts
        },
    }


def _choice(choice: ChosenSetting, grid: Grid) -> dict[str, Any]:
    best = {
        **setting_numbers(choice.at),
        "sigma_n_interval_deg": _ends(choice.sigma_n_interval_deg),
        "c_interval": _ends(choice.c_interval),
    }
    return {
        "status": choice.status,
        "declared": choice.status == "best",
        "p_chance": choice.p_chance,
        "leading": setting_numbers(choice.setting),
        "leads_share": choice.leads,
        "optimum": best,
        "as_good": [setting_numbers(grid.settings[k]) for k in np.flatnonzero(choice.as_good)],
        "shape": None if choice.shape is None else dataclasses.asdict(choice.shape),
        "edges": choice.edges,
        "groups": _groups(choice),
        "places": None
        if choice.places is None
        else [setting_numbers(grid.settings[k]) for k in choice.places],
        "most_frequent_answer_share": choice.alike,
    }


def _groups(choice: ChosenSetting) -> dict[str, Any] | None:
    """Two groups that disagree; observers by their place in "observers"."""
    if choice.groups is None:
        return None
    camps = [dataclasses.asdict(camp) for camp in choice.groups.camps]
    return {"p": choice.groups.p, "groups": camps}


def _ends(ends: Interval | None) -> list[float] | None:
    return None if ends is None else list(ends)


def _adaptive(result: SampleResult) -> dict[str, Any] | None:
    if result.adaptive is None:
        return None
    return {
        "estimate": dataclasses.asdict(result.adaptive.estimate),
        "posterior": result.adaptive.posterior,
    }


def _question(
    result: SampleResult, grid: Grid, counts: dict[str, Array], question: str
) -> dict[str, Any]:
    choice = setting_chosen_by(result, grid, question)
    values = scale_table(result, counts, question)
    settings = []
    for k, setting in enumerate(grid.settings):
        row = None if values.counts is None else values.counts[k]
        settings.append(
            {
                **setting_numbers(setting),
                "probit": values.probit[k],
                "low": values.low[k],
                "high": values.high[k],
                "torgerson": values.torgerson[k],
                "wins": None if choice.shares is None else choice.shares[k],
                "as_good": choice.as_good[k],
                "answers": None if row is None else int(row.sum()),
                "counts": None if row is None else [int(n) for n in row],
            }
        )
    content = {**_choice(choice, grid), "settings": settings}
    if question != JOINT:
        scale = next(s for s in result.scales if s.question == question)
        content |= _fit(scale)
    return content


def _fit(scale: ScaleValues) -> dict[str, Any]:
    """Bounds lie along distance: a setting as far as a bound is called nearer half of the time."""
    low = high = None
    if scale.bounds_interval is not None:
        low, high = scale.bounds_interval
    return {
        "bounds": {
            "probit": scale.probit.bounds,
            "low": low,
            "high": high,
            "torgerson": scale.torgerson.bounds,
        },
        "log_likelihood": scale.probit.log_likelihood,
        "converged": scale.probit.converged,
        "observer_effects": scale.probit.observers,
    }
