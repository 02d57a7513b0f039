"""What an analysis says, in sentences; for the terminal, the page and the plots."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.reading import printable
from relgloss_view.experiment.design.coordinates import coordinates, to_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import GRAIN, RATIO
from relgloss_view.experiment.report.answerers import also_right, path_words, people, silent, truths
from relgloss_view.experiment.report.chosen_setting import (
    ChosenSetting,
    Interval,
    chosen_setting,
    setting_chosen_by,
)
from relgloss_view.experiment.scaling.fine_grid import POINT_LIKE
from relgloss_view.experiment.session import losses
from relgloss_view.experiment.session.pool import Pool
from relgloss_view.experiment.verdict.analysis import JOINT, Analysis, SampleResult
from relgloss_view.experiment.verdict.full_grid import (
    ALIKE,
    BEST,
    BROAD,
    CHANCE,
    FEW,
    FEWEST_OBSERVERS,
    MIXED,
    RIDGE,
    TWO,
)
from relgloss_view.experiment.verdict.groups import Camp
from relgloss_view.experiment.verdict.screening import ObserverResult
from relgloss_view.picture.scene.setting import Setting, share_words

SHORT = {
    BEST: "best",
    RIDGE: "a curve is as good",
    BROAD: "many are as good",
    CHANCE: "may be chance",
    FEW: "too few observers",
    MIXED: "observers disagree",
    TWO: "two places",
    ALIKE: "answers alike",
}
BY = {RATIO: "by the ratio of gloss", GRAIN: "by the grain", JOINT: "by both together"}
MOST_NAMED = 7  #: settings, or sigma_N, that a sentence lists
SIMULATED = (
    "Simulated observers: these answers were computed, not given by people. They show how well the "
    "procedure finds a known truth, and nothing about real samples."
)
PARTLY_SIMULATED = (
    "Some of these observers are simulated: their answers were computed, not given by people. "
    "Results for real samples must leave them out."
)


def summary(analysis: Analysis) -> str:
    """The whole analysis as lines for a terminal."""
    pool = analysis.pool
    lines = [printable(pool.study.title), *_who(analysis), ""]
    for result in analysis.samples:
        lines.append(f"{label_of(result)}: {sentence(result, analysis)}")
        lines += [f"  {note}" for note in notes(result, analysis)]
        lines.append(f"  {agreement(result)}")
    lines += [f"{label}: {why}" for label, why in unscaled(analysis).items()]
    remarks = observer_remarks(analysis)
    if remarks:
        lines += ["", "observers to check:", *(f"  {line}" for line in remarks)]
    return "\n".join(lines)


def _who(analysis: Analysis) -> list[str]:
    pool = analysis.pool
    lines = [f"{people(pool)}; {sum(o.answers for o in analysis.observers)} answers"]
    lines += [f"  {line}" for line in files(pool)]
    lines += [f"  {line}" for line in displays(pool)]
    warning = simulated_words(pool)
    return lines if warning is None else [*lines, warning]


def files(pool: Pool) -> list[str]:
    """Each session file, in a line."""
    lines = []
    for record in pool.records:
        line = f"{path_words(record)}: {len(record.answers)} answers"
        line += f", {record.undone} taken back" if record.undone else ""
        line += "".join(f"; {words}" for words in losses.sentences(record.losses, record.path))
        lines.append(line)
    return lines


def displays(pool: Pool) -> list[str]:
    """Each display that answers were given on, in a line, and what to know of them."""
    named = pool.displays.displays
    words = ["unknown" if display is None else display.words for display in named]
    lines = [
        f"display {number}: {line}" if len(words) > 1 else f"display: {line}"
        for number, line in enumerate(words, 1)
    ]
    return [*lines, *pool.displays.notes]


def losses_words(pool: Pool) -> list[str]:
    """What each session file is known to lack, in a line that names it."""
    return [line for record in pool.records for line in losses.warnings(record.losses, record.path)]


def simulated_words(pool: Pool) -> str | None:
    """That observers are simulated, where some are."""
    if not pool.simulated:
        return None
    everybody = all(m.kind == "simulated" for m in pool.members)
    return SIMULATED if everybody else PARTLY_SIMULATED


def label_of(result: SampleResult) -> str:
    """The sample's label on one line."""
    return printable(result.label, 60)


def unscaled(analysis: Analysis) -> dict[str, str]:
    """Samples of which nothing can be told, by label, and why."""
    return {printable(label, 60): why for label, why in analysis.unscaled.items()}


def sentence(result: SampleResult, analysis: Analysis) -> str:
    """The verdict on a sample."""
    return _sentence(
        chosen_setting(result, analysis.pool.study.grid), result, analysis.pool.study.grid
    )


def _sentence(choice: ChosenSetting, result: SampleResult, grid: Grid) -> str:
    leading = choice.setting.words
    if choice.status == CHANCE:
        name = "probability" if choice.adaptive else "p"
        return (
            "no setting is declared best: the answers may be by chance "
            f"({name} {choice.p_chance:.2g})"
        )
    if choice.status == ALIKE:
        return (
            f"no setting is declared best: {percent(choice.alike)} of the answers are the same, "
            "too few differ to show where the best setting lies"
        )
    if choice.status == MIXED:
        assert choice.groups is not None
        camps = " and ".join(_camp(camp, grid) for camp in choice.groups.camps)
        return (
            "no setting is declared best: two groups of observers disagree "
            f"(p of one group {small(choice.groups.p)}): {camps}"
        )
    if choice.status == TWO:
        assert choice.places is not None
        first, second = (grid.settings[k].words for k in choice.places)
        return (
            "no setting is declared best: two places apart from each other are judged close, "
            f"near {first} and near {second}"
        )
    if choice.status == FEW:
        return f"leading {leading}; {_few(result)}{_between(choice)}"
    if choice.status == RIDGE:
        return (
            f"a curve of settings is as good: {_curve(choice, grid)}; leading {leading}"
            f"{_leads(choice)}"
        )
    if choice.status == BROAD:
        share = float(np.mean(choice.as_good)) if choice.shape is None else choice.shape.share
        return (
            f"no setting is clearly best: {percent(share)} of the grid is as good as the leading "
            f"{leading}{_leads(choice)}"
        )
    if np.sum(choice.as_good) > 1:
        return (
            f"best among settings not told apart: {_as_good(choice, grid)}; leading {leading}"
            f"{_leads(choice)}{_between(choice)}"
        )
    return f"best {leading}{_leads(choice)}{_between(choice)}"


def _camp(camp: Camp, grid: Grid) -> str:
    """A group of observers, and what it finds close."""
    x, y = to_steps(grid, camp.sigma_n_deg, camp.c_fraction)
    nearest = int(np.argmin(np.sum((coordinates(grid) - (x, y)) ** 2, axis=1)))
    words = grid.settings[nearest].words
    if camp.kind != POINT_LIKE:
        return f"{len(camp.observers)} find many settings as close as {words}"
    return f"{len(camp.observers)} find {words} closest"


def not_told_apart(choice: ChosenSetting, grid: Grid) -> str:
    """The settings that answers do not tell from the best: what is honest to report first."""
    return _as_good(choice, grid) if choice.may_be_named else "-"


def _few(result: SampleResult) -> str:
    if result.observers == 1:
        return "one observer shows nothing about other people"
    if result.observers < FEWEST_OBSERVERS:
        return f"{result.observers} observers are too few to show how sure this is"
    return "the observers were not resampled, so that nothing shows how sure this is"


def _leads(choice: ChosenSetting) -> str:
    if choice.leads is None:
        return ""
    if choice.adaptive:
        return f"; nearest in {percent(choice.leads)} of the posterior"
    return f"; leads in {percent(choice.leads)} of resamplings"


def _between(choice: ChosenSetting) -> str:
    return f"; between grid points {between(choice)}"


def between(choice: ChosenSetting) -> str:
    """The best between grid points, with its intervals."""
    sigma = f"{choice.at.sigma_n_deg:.2f} deg{interval(choice.sigma_n_interval_deg)}"
    return f"{sigma}, {choice.at.c_fraction:.2f} c_max{interval(choice.c_interval)}"


def interval(ends: Interval | None) -> str:
    """An interval in brackets, or nothing."""
    return "" if ends is None else f" ({ends[0]:.2f} to {ends[1]:.2f})"


def percent(share: float) -> str:
    """A share in percent; never '100 %' of what is less, nor '0 %' of what is more."""
    if 0.99 < share < 1.0:
        return "over 99 %"
    if 0.0 < share < 0.01:
        return "under 1 %"
    return f"{100.0 * share:.0f} %"


def _as_good(choice: ChosenSetting, grid: Grid) -> str:
    """The settings that are as good as the leading one, itself first."""
    others = [k for k in np.flatnonzero(choice.as_good).tolist() if k != choice.leading]
    names = [grid.settings[k].words for k in (choice.leading, *others)]
    more = len(names) - MOST_NAMED
    return "; ".join(names[:MOST_NAMED]) + (f"; and {more} more" if more > 0 else "")


def _curve(choice: ChosenSetting, grid: Grid) -> str:
    """The settings that are as good: for each sigma_N from which c to which."""
    ranges = []
    for sigma, good in zip(grid.sigma_n_deg, choice.as_good.reshape(grid.shape), strict=True):
        columns = np.flatnonzero(good).tolist()
        starts = [k for k in columns if k - 1 not in columns]
        ends = [k for k in columns if k + 1 not in columns]
        runs = [
            share_words(grid.c_fraction[a])
            + (f" to {share_words(grid.c_fraction[b])}" if b > a else "")
            for a, b in zip(starts, ends, strict=True)
        ]
        if runs:
            ranges.append(f"{sigma:g} deg, {' and '.join(runs)} c_max")
    more = len(ranges) - MOST_NAMED
    return "; ".join(ranges[:MOST_NAMED]) + (f"; {more} sigma_N more" if more > 0 else "")


def notes(result: SampleResult, analysis: Analysis) -> list[str]:
    """What has to be known beside the verdict on a sample."""
    study = analysis.pool.study
    choice = chosen_setting(result, study.grid)
    if not choice.may_be_named:
        lines = []
        if choice.status == MIXED and choice.groups is not None:
            members = analysis.pool.members
            for number, camp in enumerate(choice.groups.camps, 1):
                names = ", ".join(printable(members[k].name, 40) for k in camp.observers)
                lines.append(f"group {number}: {names}")
            lines.append("one scale for both groups does not hold: analyse the groups apart")
        elif choice.status == TWO:
            lines.append("the optimum of one place for all answers would lie between the two")
        elif choice.status == ALIKE:
            lines.append("settings nearer to the right one, in a finer grid, may separate")
        return [*lines, *_by_question(result, study.grid), *_truth(result, analysis)]
    lines = []
    if choice.status == RIDGE and len(result.scales) == 1:
        lines.append("the ratio alone can't decide: ask for grain too (procedure.ask_grain)")
    elif choice.status in (RIDGE, BROAD):
        lines.append("more observers or repeats would narrow it down")
    if result.observers == 1 and choice.status != FEW:
        lines.append(_few(result))
    if study.procedure.ask_grain and result.adaptive is not None:
        lines.append("the answers about grain take no part in an adaptive verdict")
    elif study.procedure.ask_grain and JOINT not in result.verdicts:
        lines.append("by the ratio alone: the answers about grain are missing or all the same")
    if choice.edges:
        lines.append(_edge_words(choice, study.grid))
    return [*lines, *_by_question(result, study.grid), *_truth(result, analysis)]


def _edge_words(choice: ChosenSetting, grid: Grid) -> str:
    """That the leading setting lies on an edge, and whether there is anything beyond."""
    ends = {
        "smallest sigma_N": grid.sigma_n_deg[0] == 0.0 and "there is no less grain",
        "smallest c": grid.c_fraction[0] == 0.0 and "there is no less gloss",
        "largest c": grid.c_fraction[-1] >= 1.0 and "beyond c_max the display clips",
    }
    beyond = "a wider grid may find better"
    edges = [f"{edge} ({ends.get(edge) or beyond})" for edge in choice.edges]
    return f"lies on the grid's edge: {', '.join(edges)}"


def _by_question(result: SampleResult, grid: Grid) -> list[str]:
    """Where two questions were asked: what each alone would choose."""
    if result.adaptive is not None or len(result.verdicts) == 1:
        return []
    lines = []
    for question in result.verdicts:
        if question != result.decided_by:
            choice = setting_chosen_by(result, grid, question)
            lines.append(f"{BY[question]} alone: {_sentence(choice, result, grid)}")
    return lines


def _truth(result: SampleResult, analysis: Analysis) -> list[str]:
    truth = truths(analysis.pool).get(result.label)
    if truth is None:
        return []
    right = (truth, *also_right(analysis.pool, truth))
    words = ", and as right ".join(setting_words(setting) for setting in right)
    return [f"right for the simulated observers: {words}"]


def setting_words(setting: Setting) -> str:
    """Any setting, rounded."""
    return Setting(round(setting.sigma_n_deg, 3), setting.c_fraction).words


def agreement(result: SampleResult) -> str:
    """How far the observers of a sample agree."""
    observers = "observer" if result.observers == 1 else "observers"
    number_of = f"{result.answers} answers, {result.observers} {observers}"
    coefficients = []
    if result.alpha is not None:
        coefficients.append(f"Krippendorff's alpha {number(result.alpha)}")
    if result.w is not None:
        coefficients.append(f"Kendall's W {number(result.w)}")
    return f"{number_of}; agreement: {', '.join(coefficients)}" if coefficients else number_of


def number(value: float | None, digits: int = 2) -> str:
    """A number of a table; a dash where there is none."""
    if value is None or not np.isfinite(value):
        return "-"
    written = f"{value:.{digits}f}"
    return written.lstrip("-") if float(written) == 0.0 else written


def small(p: float) -> str:
    """A probability; how small exactly says nothing below a thousandth."""
    return "< 0.001" if p < 0.001 else f"{p:.2g}"


def observer_remarks(analysis: Analysis) -> list[str]:
    """Everybody there is something to say of, and those who have not answered at all."""
    lines = [f"{observer_name(o)}: {'; '.join(o.remarks)}" for o in analysis.observers if o.remarks]
    return lines + [f"{printable(n, 80)}: no answers yet" for n in silent(analysis.pool)]


def observer_name(observer: ObserverResult) -> str:
    """A pseudonym on one line, with the file's name where there are several."""
    return printable(observer.name, 120)
