"""A report as one self-contained page of HTML: plots inside, numbers in tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

import numpy as np

from relgloss_view.base import pages
from relgloss_view.base.reading import printable
from relgloss_view.base.shell import command_line, operand
from relgloss_view.base.version import __version__
from relgloss_view.base.words import sentence_case
from relgloss_view.display.record import ORIGINS
from relgloss_view.experiment.report import sentences
from relgloss_view.experiment.report.answerers import path_words, people, silent
from relgloss_view.experiment.report.chosen_setting import (
    chosen_setting,
    scale_table,
    setting_chosen_by,
)
from relgloss_view.experiment.report.figures import DPI
from relgloss_view.experiment.report.glossary import terms
from relgloss_view.experiment.report.plots import OVERVIEW, Plot
from relgloss_view.experiment.report.results import counts_of
from relgloss_view.experiment.session.display_difference import difference
from relgloss_view.experiment.session.pool import Pool
from relgloss_view.experiment.verdict.analysis import Analysis, SampleResult

STYLE = """
main { max-width: 80rem; }
h1, h2 { overflow-wrap: anywhere; }
h2 { font-size: 1.1rem; font-weight: 600; margin: 2.2rem 0 .2rem; }
dd, li { max-width: 60rem; }
ul { margin: .3rem 0; padding-left: 1.2rem; }
.notice { background: #fff; color: #1b1f24; padding: .6rem .9rem; margin: .8rem 0; }
.plots { display: flex; flex-wrap: wrap; gap: 1rem; margin: .8rem 0; align-items: flex-start; }
.plots img { display: block; max-width: 100%; height: auto; }
.scroll { overflow-x: auto; }
table { margin: 0 0 1rem; }
th, td { padding: .2rem 1.1rem .2rem 0; vertical-align: top; }
.plots table { font-size: 13px; } .plots th, .plots td { padding-right: .8rem; }
th:first-child, td:first-child, .text { overflow-wrap: break-word; }
dt { font-weight: 600; margin-top: .5rem; } dd { margin: 0; }
@media print { body { background: #fff; color: #000; } .muted { color: #333; } }
"""
CSS_DPI = 96  #: an inch of a page
MOST_ROWS = 8  #: settings in a sample's table; scale.csv has all


def report_page(
    folder: Path,
    analysis: Analysis,
    plots: Mapping[str, Sequence[Plot]],
    scenes: Mapping[str, str],
    command: str | None = None,
) -> str:
    """The page as text; plots lie in the folder. `command` is the line that makes it again."""
    pool = analysis.pool
    title = printable(pool.study.title, 60)
    answers = sum(o.answers for o in analysis.observers)
    simulated = sentences.simulated_words(pool)
    parts = [
        "<main>",
        f"<h1>{escape(title)}</h1>",
        f'<p class="muted">{escape(people(pool))}; {answers} answers.</p>',
        "" if simulated is None else f'<p class="notice">{escape(simulated)}</p>',
        *(f'<p class="notice">{escape(line)}</p>' for line in sentences.losses_words(pool)),
        *(f'<p class="notice">{escape(line)}</p>' for line in pool.displays.beyond),
        _verdicts(analysis),
        _overview(folder),
        *(
            _sample(folder, result, analysis, plots[result.label], scenes.get(result.label))
            for result in analysis.samples
        ),
        _observers(analysis),
        displays_part(pool),
        "<h2>Glossary</h2>",
        "<dl>",
        *(f"<dt>{escape(term)}</dt><dd>{escape(said)}</dd>" for term, said in terms(analysis)),
        "</dl>",
        _made_with(analysis, command),
        "</main>",
    ]
    return pages.page(f"{title}: results", parts, STYLE)


def _overview(folder: Path) -> str:
    """The plot of all samples, where answers about any could be scaled and it could be drawn."""
    if not (folder / OVERVIEW).exists():
        return ""
    return f'<div class="plots">{_image(folder, OVERVIEW, "all samples: what was chosen")}</div>'


def _verdicts(analysis: Analysis) -> str:
    """What was found, a row a sample: the reason why anybody opens the page."""
    grid = analysis.pool.study.grid
    rows = []
    for result in analysis.samples:
        choice = chosen_setting(result, grid)
        named = choice.may_be_named
        rows.append(
            (
                sentences.label_of(result),
                sentences.SHORT[choice.status],
                sentences.not_told_apart(choice, grid),
                choice.setting.words if named else "-",
                "-" if choice.leads is None or not named else sentences.percent(choice.leads),
                sentences.between(choice) if named else "-",
                sentences.small(choice.p_chance),
            )
        )
    rows += [(label, why, *"-----") for label, why in sentences.unscaled(analysis).items()]
    adaptive = any(r.adaptive is not None for r in analysis.samples)
    heads = (
        "sample",
        "verdict",
        "not told apart from the best",
        "leading setting",
        "nearest in the posterior" if adaptive else "leads in resamplings",
        "between grid points (95 %)",
        "probability of chance" if adaptive else "p of chance",
    )
    return table(heads, rows, texts=(1, 2, 3, 5))


def _sample(
    folder: Path,
    result: SampleResult,
    analysis: Analysis,
    plots: Sequence[Plot],
    scene: str | None,
) -> str:
    notes = [*sentences.notes(result, analysis), sentences.agreement(result)]
    verdict = sentence_case(sentences.sentence(result, analysis))
    listed = "".join(f"<li>{escape(note)}</li>" for note in notes)
    opened = "No scene is written: nothing is declared best."
    if scene is not None:
        line = escape(command_line(["relgloss", "view", operand(scene)]))
        opened = f"The leading setting as a scene: <code>{line}</code>"
    return "\n".join(
        [
            f"<h2>{escape(sentences.label_of(result))}</h2>",
            f"<p><strong>{escape(verdict)}.</strong></p>",
            f"<ul>{listed}</ul>",
            f"<p>{opened}</p>",
            '<div class="plots">',
            *(_image(folder, plot.file, plot.shows) for plot in plots),
            f"<div>{_closest(result, analysis)}{_bounds(result, analysis)}</div></div>",
        ]
    )


def _closest(result: SampleResult, analysis: Analysis) -> str:
    """The settings with the largest scale values, by what decides."""
    grid = analysis.pool.study.grid
    question = result.decided_by
    values = scale_table(result, counts_of(analysis.pool, result.label), question)
    choice = setting_chosen_by(result, grid, question)
    judged = np.flatnonzero(np.isfinite(values.probit))
    order = judged[np.argsort(-values.probit[judged], kind="stable")]
    rows = []
    for k in order[:MOST_ROWS].tolist():
        ends = "-"
        if np.isfinite(values.low[k]):
            ends = f"{sentences.number(values.low[k])} to {sentences.number(values.high[k])}"
        rows.append(
            (
                grid.settings[k].words,
                sentences.number(values.probit[k]),
                ends,
                sentences.number(values.torgerson[k]),
                "-" if choice.shares is None else sentences.percent(float(choice.shares[k])),
                "-" if values.counts is None else f"{values.counts[k].sum():.0f}",
            )
        )
    heads = ("closest settings", "closeness", "95 %", "Torgerson", "leads", "answers")
    more = len(order) - MOST_ROWS
    left_out = f'<p class="muted">{more} more are in scale.csv.</p>' if more > 0 else ""
    return table(heads, rows) + left_out


def _bounds(result: SampleResult, analysis: Analysis) -> str:
    categories = [printable(c, 40) for c in analysis.pool.study.categories]
    rows = []
    for scale in result.scales:
        for k, bound in enumerate(scale.probit.bounds):
            ends = "-"
            if scale.bounds_interval is not None and np.isfinite(bound):
                low, high = -scale.bounds_interval[::-1, k]
                ends = f"{sentences.number(low)} to {sentences.number(high)}"
            between = f"{categories[k]} | {categories[k + 1]}"
            between = (
                f"{sentences.BY[scale.question]}: {between}" if len(result.scales) > 1 else between
            )
            torgerson = -scale.torgerson.bounds[k]
            rows.append((between, sentences.number(-bound), ends, sentences.number(torgerson)))
    return table(("bound between", "closeness", "95 %", "Torgerson"), rows)


def _observers(analysis: Analysis) -> str:
    rows = [
        (
            sentences.observer_name(o),
            o.kind,
            "yes" if o.ended else "no",
            str(o.answers),
            sentences.number(o.median_response_s),
            sentences.number(o.relation.correlation),
            sentences.number(o.relation.p),
            "; ".join(o.remarks) or "-",
        )
        for o in analysis.observers
    ]
    rows += [
        (printable(name, 120), "", "no", "0", "-", "-", "-", "no answers yet")
        for name in silent(analysis.pool)
    ]
    heads = (
        "observer", "kind", "finished", "answers", "median response, s", "follows the others",
        "p of chance", "to check",
    )  # fmt: skip
    kept = "The results contain everybody who answered."
    rows_as_table = table(heads, rows, texts=(1, 7))
    return f'<h2>Observers</h2>\n<p class="muted">{kept}</p>\n{rows_as_table}'


def displays_part(pool: Pool) -> str:
    """What the answers were given on: a display's gloss is its own."""
    displays = pool.displays
    rows = []
    first = next((d for d in displays.displays if d is not None), None)
    for number, display in enumerate(displays.displays, 1):
        shown = [s for s in displays.shown_on if displays.place_of(s.display) == number - 1]
        answers = str(sum(s.answers for s in shown))
        files = ", ".join(dict.fromkeys(printable(s.path, 300) for s in shown))
        if display is None or first is None:
            rows.append((str(number), "unknown", *"------", answers, files))
            continue
        apart = "-" if display is first else difference(first, display).words
        rows.append(
            (
                str(number),
                printable(display.name, 80),
                ORIGINS[display.origin],
                f"{display.luminance_cd_m2:.3g}" if display.luminance_known else "unknown",
                f"{display.black_cd_m2:.3g}" if display.black_known else "unknown",
                ", ".join(f"{v:.4f}" for v in display.white_xy),
                f"{display.reflected_cd_m2:.3g}",
                apart,
                answers,
                files,
            )
        )
    heads = (
        "display", "name", "from", "white, cd/m2", "black, cd/m2", "white x, y",
        "reflected, cd/m2", "differs from the first", "answers", "files",
    )  # fmt: skip
    notes = [line for line in displays.notes if line not in displays.beyond]
    return "\n".join(
        [
            "<h2>Displays</h2>",
            '<p class="muted">Perceived gloss belongs to a display, and so does the ratio R of two '
            "glosses. The settings are those for the displays below.</p>",
            *(f"<p>{escape(sentence_case(line))}.</p>" for line in notes),
            table(heads, rows, texts=(1, 2, 7, 9)),
        ]
    )


def _made_with(analysis: Analysis, command: str | None) -> str:
    rows = []
    for record in analysis.pool.records:
        devices = sorted({printable(run.device, 80) for run in record.runs})
        versions = sorted({printable(run.version, 20) for run in record.runs})
        rows.append(
            (
                path_words(record),
                str(len(record.answers)),
                str(record.undone),
                str(len(record.runs)),
                ", ".join(devices) or "-",
                ", ".join(versions) or "-",
                record.digest[:12],
            )
        )
    heads = ("file", "answers", "taken back", "runs", "devices", "relgloss", "study")
    options = analysis.options
    effects = "with" if options.observer_effects else "without"
    zeros = "clipped" if options.zero == "clip" else "left out"
    return "\n".join(
        [
            "<h2>Made with</h2>",
            f'<p class="muted">relgloss {escape(__version__)}; {options.draws} resamplings, seed '
            f"{options.seed}, {effects} observer effects; condition D with proportions of 0 and 1 "
            f"{zeros}. Every number is in results.json, the scale in scale.csv, every answer in "
            "answers.csv.</p>",
            "" if command is None else f"<p><code>{escape(command)}</code></p>",
            table(heads, rows, texts=(4, 5, 6)),
        ]
    )


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], texts: Sequence[int] = ()) -> str:
    """A table that scrolls where it is wider than the page; `texts` are columns of words."""
    return f'<div class="scroll">{pages.table(heads, rows, texts)}</div>'


def _image(folder: Path, name: str, shows: str) -> str:
    """A plot of the folder as part of the page, as large as it is on paper."""
    data = (folder / name).read_bytes()
    width = round(int.from_bytes(data[16:20], "big") * CSS_DPI / DPI)
    description = escape(shows, quote=True)
    return f'<img src="{pages.embedded_png(data)}" width="{width}" alt="{description}">'
