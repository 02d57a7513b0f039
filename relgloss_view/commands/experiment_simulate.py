"""`relgloss experiment simulate`: simulated observers with a known truth, the whole way."""

from __future__ import annotations

import argparse
import dataclasses
import json
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import number, printable
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.commands.study_options import add_study_options, study_from
from relgloss_view.quality.backends import BACKENDS

if TYPE_CHECKING:
    from relgloss_view.experiment.design.study import Study
    from relgloss_view.experiment.observers.population import Population
    from relgloss_view.experiment.verdict.recovery import Recovery, RecoveryShares
    from relgloss_view.picture.scene.setting import Setting

OBSERVERS = 15  #: as in the paper
MOST_OBSERVERS, MOST_STUDIES = 1000, 10_000
PROOF_DRAWS = 200
MOST_GRAIN_WEIGHT = 100.0
ALL = "all"  #: kinds of observers
NUMBER = re.compile(r"[0-9]+(\.[0-9]*)?|\.[0-9]+")
TRUTH = re.compile(r"(.+)=([0-9.]+),([0-9.]+(?:/[0-9.]+)?)", re.DOTALL)


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "simulate",
        help="simulated observers with a known truth answer a study",
        description="Lead simulated observers through a study by the code that leads people, "
        "without a window. They see the pictures as drawn, and each sample has a right setting. An "
        "existing session file is continued. --studies N runs and analyses N studies of each kind "
        "of observers and prints how often they found the truth.",
        epilog="example: relgloss experiment simulate paper -o trial.sqlite",
    )
    add_study_options(parser)
    parser.add_argument("-o", "--output", metavar="FILE.sqlite", help="Session file")
    parser.add_argument(
        "--observers",
        metavar="N",
        type=int,
        default=OBSERVERS,
        help=f"Number of observers (default {OBSERVERS})",
    )
    parser.add_argument(
        "--seed", metavar="N", type=int, default=0, help="Seed of the observers (default 0)"
    )
    parser.add_argument(
        "--truth",
        metavar="SAMPLE=SIGMA_N,C|published|cells|anywhere",
        action="append",
        default=[],
        help="Right setting of a sample, c as a share of c_max; or the choice for all samples: "
        "published (default), or by chance from the grid (cells) or its range (anywhere)",
    )
    add_population_options(parser)
    parser.add_argument(
        "--studies", metavar="N", type=int, help="Number of studies to run and analyse"
    )
    parser.add_argument(
        "--draws",
        metavar="N",
        type=int,
        default=PROOF_DRAWS,
        help=f"Number of resamplings in each of the --studies (default {PROOF_DRAWS})",
    )
    parser.add_argument(
        "--echo", action="store_true", help="Print each answer as soon as it is stored"
    )
    parser.add_argument(
        "--backend", choices=BACKENDS, default="auto", help="Renderer of the pictures"
    )
    parser.add_argument("--json", action="store_true", help="Print the result as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def add_population_options(parser: argparse.ArgumentParser) -> None:
    """Declare how simulated observers are made; every entry of Population is an option.

    The weight of grain is one too; it belongs to what they see (percept.py).
    """
    from relgloss_view.experiment.observers.kinds import KINDS
    from relgloss_view.experiment.observers.population import Population

    who = parser.add_argument_group("the observers")
    who.add_argument(
        "--kind",
        metavar="KIND",
        default=Population.kind,
        choices=(*KINDS, ALL),
        help="; ".join(f"{name}: {kind.meaning}" for name, kind in KINDS.items())
        + f"; {ALL}: one kind after another, with --studies (default {Population.kind})",
    )
    who.add_argument(
        "--grain-weight",
        metavar="X",
        type=float,
        help="What a grain as high as its highlight adds to log gloss; below 0 it lowers it. "
        "Nobody measured it: without this option both signs are taken, for observers in turn or, "
        "with --studies, in studies of their own",
    )
    for field in dataclasses.fields(Population):
        if field.name == "kind":
            continue
        option = f"--{field.name.replace('_', '-')}"
        meaning = f"{field.metadata['range'].meaning} (default {field.default:g})"
        who.add_argument(option, metavar="X", type=float, default=field.default, help=meaning)


def run(args: argparse.Namespace) -> int:
    """Simulate one study into a file, or many to see how often they find their truth."""
    _check(args)
    study = study_from(args)
    return _proof(args, study) if args.studies is not None else _session(args, study)


def _check(args: argparse.Namespace) -> None:
    from relgloss_view.experiment.verdict.analysis import MOST_DRAWS

    if (args.output is None) == (args.studies is None):
        args.wrong_usage("give either -o FILE.sqlite or --studies N")
    if args.kind == ALL and args.studies is None:
        args.wrong_usage(f"--kind {ALL} needs --studies N: a session has one kind of observers")
    if args.grain_weight is not None:
        number(
            args.grain_weight,
            "--grain-weight",
            f"{-MOST_GRAIN_WEIGHT:g} to {MOST_GRAIN_WEIGHT:g}",
            -MOST_GRAIN_WEIGHT,
            MOST_GRAIN_WEIGHT,
        )
    limits = (
        ("--observers", args.observers, 1, MOST_OBSERVERS),
        ("--studies", args.studies, 1, MOST_STUDIES),
        ("--draws", args.draws, 2, MOST_DRAWS),
        ("--seed", args.seed, 0, 2**31 - 1),
    )
    for option, value, low, high in limits:
        if value is not None and not low <= value <= high:
            raise InputError(f"{option} {value}: expected {low} to {high}")


def _population(args: argparse.Namespace, kind: str) -> Population:
    from relgloss_view.experiment.observers.population import Population

    values = {f.name: getattr(args, f.name) for f in dataclasses.fields(Population)}
    return Population(**{**values, "kind": kind})


def _grain_weights(args: argparse.Namespace, population: Population) -> tuple[float, ...]:
    """Those of the command line, or both signs; none where no picture is seen."""
    from relgloss_view.experiment.observers.kinds import PICTURE
    from relgloss_view.experiment.observers.percept import BOTH_SIGNS

    if population.of_kind.depends_on != PICTURE:
        return ()
    return BOTH_SIGNS if args.grain_weight is None else (args.grain_weight,)


def _truths(args: argparse.Namespace) -> tuple[str, dict[str, Setting]]:
    """The truths of the command line: how they are chosen, and those that are stated."""
    from relgloss_view.experiment.design.grid import share_of
    from relgloss_view.experiment.observers.truth import CHOICES, PUBLISHED
    from relgloss_view.picture.scene.setting import Setting

    choice, stated = PUBLISHED, {}
    for word in args.truth:
        match = TRUTH.fullmatch(word)
        if word in CHOICES:
            choice = word
        elif match is None or not NUMBER.fullmatch(match[2]):
            raise InputError(
                f"--truth {printable(word, 60)}: expected SAMPLE=SIGMA_N,C such as "
                f"matte-coated=2.0,2/6, or {', '.join(CHOICES)}"
            )
        else:
            stated[match[1]] = Setting(float(match[2]), share_of(match[3], f"--truth {word}"))
    return choice, stated


def _session(args: argparse.Namespace, study: Study) -> int:
    from relgloss_view.experiment.observers.percept import see_study, unseen
    from relgloss_view.experiment.observers.simulation import StoredAnswer, run_observers
    from relgloss_view.experiment.observers.truth import right_settings, truths_of
    from relgloss_view.experiment.report.results import setting_numbers
    from relgloss_view.experiment.session.losses import warnings
    from relgloss_view.experiment.session.store import Store
    from relgloss_view.quality.backends import open_renderer

    population = _population(args, args.kind)
    weights = _grain_weights(args, population)
    choice, stated = _truths(args)
    truths = truths_of(study, choice, stated, args.seed)

    def echo(answer: StoredAnswer) -> None:
        trial = answer.trial
        print(
            answer.observer, trial.position, trial.sample, trial.setting, answer.question,
            answer.category, flush=True,
        )  # fmt: skip

    # Without an OpenGL context no file is made.
    with (
        open_renderer(args.backend) as renderer,
        Store(args.output, study) as store,
        Progress("simulate") as progress,
    ):
        if weights:
            percepts = see_study(renderer, study, truths, weights, progress)
        else:
            percepts = unseen(study, truths)
        for line in warnings(store.losses, args.output):
            warn(line)
        silent = (lambda answer: None) if not args.echo else echo
        run_observers(store, percepts, population, args.observers, args.seed, silent, progress)
        answers, observers = len(store.answers()), len(store.observers())
    result = {
        "file": args.output,
        "observers": observers,
        "answers": answers,
        "kind": args.kind,
        "grain_weights": weights,
        "truths": {
            sample.label: setting_numbers(truth)
            for sample, truth in zip(study.samples, truths, strict=True)
        },
    }
    if args.json:
        print(json.dumps(result))
    else:
        count = population.of_kind.right_settings
        right = "; ".join(
            f"{printable(sample.label)} "
            + " and ".join(one.words for one in right_settings(study.grid, truth, count))
            for sample, truth in zip(study.samples, truths, strict=True)
        )
        print(f"{printable(args.output)}: {answers} answers of {observers} simulated observers")
        print(f"right for them: {right}")
        if len(weights) > 1:
            signs = ", ".join(f"{w:+g}" for w in weights)
            print(f"grain raises gloss for some of them and lowers it for others ({signs}): nobody "
                  "measured it; --grain-weight sets one for all")  # fmt: skip
    return 0


@dataclasses.dataclass(frozen=True)
class _Table:
    """What studies of one kind of observers found."""

    kind: str
    grain_weight: float | None  #: None where no picture is seen
    recoveries: list[Recovery]

    @property
    def words(self) -> str:
        """Which observers."""
        if self.grain_weight is None:
            return self.kind
        return f"{self.kind}, grain weight {self.grain_weight:+g}"


def _proof(args: argparse.Namespace, study: Study) -> int:
    from relgloss_view.experiment.observers.kinds import KINDS
    from relgloss_view.experiment.report.results import recovery_numbers
    from relgloss_view.experiment.verdict.recovery import run_studies
    from relgloss_view.quality.backends import open_renderer

    kinds = tuple(KINDS) if args.kind == ALL else (args.kind,)
    populations = [_population(args, kind) for kind in kinds]
    cases = [(p, w) for p in populations for w in _grain_weights(args, p) or (None,)]
    choice, stated = _truths(args)
    tables = []
    with Progress("simulate") as progress, open_renderer(args.backend) as renderer:
        for done, (population, weight) in enumerate(cases):

            def report(share: float, text: str, done: int = done) -> None:
                progress((done + share) / len(cases), text)

            recoveries = run_studies(
                renderer, study, args.studies, args.observers, population, truth=choice,
                stated=stated, grain_weights=() if weight is None else (weight,),
                draws=args.draws, seed=args.seed, progress=report,
            )  # fmt: skip
            tables.append(_Table(population.kind, weight, recoveries))
    if args.json:
        # Studies of different tables are different studies.
        together = recovery_numbers(
            [
                dataclasses.replace(r, study=k * args.studies + r.study)
                for k, table in enumerate(tables)
                for r in table.recoveries
            ]
        )
        by_kind = [
            {
                "kind": table.kind,
                "grain_weight": table.grain_weight,
                "one_best": KINDS[table.kind].one_best,
                **recovery_numbers(table.recoveries),
            }
            for table in tables
        ]
        print(json.dumps({**together, "tables": by_kind} if len(tables) > 1 else by_kind[0]))
    else:
        print(_words(tables, args))
    return 0


def _words(tables: Sequence[_Table], args: argparse.Namespace) -> str:
    """All tables: by sample for one kind of observers, one line each for several."""
    from relgloss_view.experiment.verdict.recovery import recovery_shares, shares_by_sample

    lines = []
    if args.kind == ALL:
        shares = {table.words: recovery_shares(table.recoveries) for table in tables}
        lines += [f"{args.studies} studies of {args.observers} observers of each kind", ""]
        lines += _rows("observers", shares)
    else:
        for table in tables:
            by_sample = shares_by_sample(table.recoveries)
            everything = recovery_shares(table.recoveries)
            nothing = 100 * everything.nothing_declared
            lines += [f"{args.studies} studies of {args.observers} observers, {table.words}", ""]
            lines += _rows("sample", {**by_sample, "all": everything})
            lines += [f"studies in which no sample has a declared best: {nothing:.0f} %", ""]
    lines += [
        "",
        "exact, +-1: the leading setting is the one nearest to the truth, or beside it",
        "in set: what is right is among the settings not significantly worse than the best",
        "sigma_N in, c in: how often the 95 % interval of the optimum holds the truth",
    ]
    return "\n".join(lines)


def _rows(head: str, shares: Mapping[str, RecoveryShares]) -> list[str]:
    heads = ("answers", "exact", "+-1", "in set", "median error", "sigma_N in", "c in", "declared")
    lines = [f"{head:<28}" + "".join(f"{h:>13}" for h in heads)]
    for name, row in shares.items():
        cells = (
            f"{row.answers:.0f}",
            _percent(row.exact),
            _percent(row.near),
            _percent(row.in_set),
            f"{row.median_error_steps:.2f} steps",
            _percent(row.sigma_n_inside),
            _percent(row.c_inside),
            _percent(row.status.get("best", 0) / row.cases),
        )
        lines.append(f"{printable(name, 28):<28}" + "".join(f"{cell:>13}" for cell in cells))
    return lines


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.0f} %"
