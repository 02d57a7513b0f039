"""`relgloss experiment simulate`: simulated observers with a known truth, the whole way."""

from __future__ import annotations

import argparse
import dataclasses
import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.commands.study_options import add_study_options, study_from
from relgloss_view.quality.backends import BACKENDS

if TYPE_CHECKING:
    from relgloss_view.experiment.design.study import Study
    from relgloss_view.experiment.observers.population import Population
    from relgloss_view.experiment.verdict.recovery import Recovery
    from relgloss_view.picture.scene.setting import Setting

OBSERVERS = 15  #: as in the paper
MOST_OBSERVERS, MOST_STUDIES = 1000, 10_000
PROOF_DRAWS = 200
NUMBER = re.compile(r"[0-9]+(\.[0-9]*)?|\.[0-9]+")
TRUTH = re.compile(r"(.+)=([0-9.]+),([0-9.]+(?:/[0-9.]+)?)", re.DOTALL)


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "simulate",
        help="simulated observers with a known truth answer a study",
        description="Lead simulated observers through a study by the code that leads people, "
        "without a window. They see the pictures as drawn, and each sample has a right setting. An "
        "existing session file is continued. --studies N runs and analyses N studies and reports "
        "how often they found the truth.",
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
    """Declare how simulated observers are made; every entry of Population is an option."""
    from relgloss_view.experiment.observers.population import Population

    who = parser.add_argument_group("the observers")
    for field in dataclasses.fields(Population):
        option = f"--{field.name.replace('_', '-')}"
        options = field.metadata.get("options")
        if options is not None:
            who.add_argument(option, choices=options, default=field.default,
                             help=field.metadata["meaning"])  # fmt: skip
        else:
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
    limits = (
        ("--observers", args.observers, 1, MOST_OBSERVERS),
        ("--studies", args.studies, 1, MOST_STUDIES),
        ("--draws", args.draws, 2, MOST_DRAWS),
        ("--seed", args.seed, 0, 2**31 - 1),
    )
    for option, value, low, high in limits:
        if value is not None and not low <= value <= high:
            raise InputError(f"{option} {value}: expected {low} to {high}")


def _population(args: argparse.Namespace) -> Population:
    from relgloss_view.experiment.observers.population import Population

    return Population(**{f.name: getattr(args, f.name) for f in dataclasses.fields(Population)})


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
    from relgloss_view.experiment.observers.percept import see_study
    from relgloss_view.experiment.observers.simulation import StoredAnswer, run_observers
    from relgloss_view.experiment.observers.truth import truths_of
    from relgloss_view.experiment.report.results import setting_numbers
    from relgloss_view.experiment.session.store import Store
    from relgloss_view.quality.backends import open_renderer

    population = _population(args)
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
        percepts = see_study(renderer, study, truths, progress)
        silent = (lambda answer: None) if not args.echo else echo
        run_observers(store, percepts, population, args.observers, args.seed, silent, progress)
        answers, observers = len(store.answers()), len(store.observers())
    result = {
        "file": args.output,
        "observers": observers,
        "answers": answers,
        "truths": {
            sample.label: setting_numbers(truth)
            for sample, truth in zip(study.samples, truths, strict=True)
        },
    }
    if args.json:
        print(json.dumps(result))
    else:
        right = "; ".join(
            f"{printable(s.label)} {t.words}" for s, t in zip(study.samples, truths, strict=True)
        )
        print(f"{printable(args.output)}: {answers} answers of {observers} simulated observers")
        print(f"right for them: {right}")
    return 0


def _proof(args: argparse.Namespace, study: Study) -> int:
    from relgloss_view.experiment.report.results import recovery_numbers
    from relgloss_view.experiment.verdict.recovery import run_studies
    from relgloss_view.quality.backends import open_renderer

    population = _population(args)
    choice, stated = _truths(args)
    with Progress("simulate") as progress, open_renderer(args.backend) as renderer:
        recoveries = run_studies(
            renderer, study, args.studies, args.observers, population, truth=choice, stated=stated,
            draws=args.draws, seed=args.seed, progress=progress,
        )  # fmt: skip
    print(json.dumps(recovery_numbers(recoveries)) if args.json else _table(recoveries, args))
    return 0


def _table(recoveries: Sequence[Recovery], args: argparse.Namespace) -> str:
    from relgloss_view.experiment.verdict.recovery import recovery_shares, shares_by_sample

    everything = recovery_shares(recoveries)
    heads = ("sample", "answers", "exact", "+-1", "median error", "sigma_N in", "c in", "declared")
    lines = [
        f"{args.studies} studies of {args.observers} observers, {args.kind}",
        "",
        f"{heads[0]:<20}" + "".join(f"{h:>14}" for h in heads[1:]),
    ]
    for name, shares in {**shares_by_sample(recoveries), "all": everything}.items():
        declared = shares.status.get("best", 0) / shares.cases
        cells = (
            f"{shares.answers:.0f}",
            f"{100 * shares.exact:.0f} %",
            f"{100 * shares.near:.0f} %",
            f"{shares.median_error_steps:.2f} steps",
            _percent(shares.sigma_n_inside),
            _percent(shares.c_inside),
            f"{100 * declared:.0f} %",
        )
        lines.append(f"{printable(name, 20):<20}" + "".join(f"{cell:>14}" for cell in cells))
    nothing = 100 * everything.nothing_declared
    lines += [
        "",
        "exact, +-1: the leading setting is the one nearest to the truth, or beside it",
        "sigma_N in, c in: how often the 95 % interval of the optimum holds the truth",
        f"studies in which no sample has a declared best: {nothing:.0f} %",
    ]
    return "\n".join(lines)


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.0f} %"
