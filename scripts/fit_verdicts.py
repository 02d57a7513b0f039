"""Are the fit's verdicts true? Tables with a known truth are fitted, with a named fault or none.

python scripts/fit_verdicts.py --count 60 --sound 20
python scripts/fit_verdicts.py --count 500 --sound 200 --workers 8 --json verdicts.json
python scripts/fit_verdicts.py --coverage 100

The classes are explained in docs/verdicts.md.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from relgloss_view.bench.verdicts import coverage, judging, run
from relgloss_view.bench.verdicts.faults import FAULTS


def main() -> int:
    """Run what is asked for; 1 where a "good" was false."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    add = parser.add_argument
    add("--count", type=int, default=0, metavar="N", help="Number of tables with a fault")
    add("--sound", type=int, default=0, metavar="N", help="Number of tables without a fault")
    add("--coverage", type=int, default=0, metavar="N", help="Number of tables for standard errors")
    add("--kind", action="append", metavar="NAME", help="Fault to try; may be repeated")
    add("--only", type=int, metavar="INDEX", help="Try the table of this index alone, in full")
    add("--seed", type=int, default=1, metavar="N", help="Seed of all draws (default 1)")
    add("--workers", type=int, default=1, metavar="N", help="Number of processes (default 1)")
    add("--json", metavar="FILE", help="File for all numbers")
    add("--keep", metavar="FOLDER", help="Folder for the tables whose verdict was false")
    add("--details", action="store_true", help="Print each table whose verdict was false")
    args = parser.parse_args()
    unknown = set(args.kind or ()) - {f.name for f in FAULTS} - {judging.SOUND}
    if unknown:
        names = ", ".join(f.name for f in FAULTS)
        parser.error(f"unknown fault {', '.join(sorted(unknown))}; expected one of {names}")
    if args.keep:
        Path(args.keep).mkdir(parents=True, exist_ok=True)

    def done(count: int, of: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{count} of {of}", end="" if count < of else "\n", file=sys.stderr)

    numbers: dict[str, object] = {}
    outcomes = []
    if args.only is not None:
        tasks = [(kind, args.only) for kind in args.kind or [judging.SOUND]]
    else:
        tasks = run.tasks(args.count, args.sound, args.kind)
    if tasks:
        outcomes = run.run(args.seed, tasks, args.workers, args.keep, done)
        classes = judging.CLASSES if args.only is not None else SHOWN if args.details else ()
        print("\n".join([*run.details(outcomes, classes), run.summary(outcomes)]))
        numbers |= run.as_json(args.seed, outcomes)
    if args.coverage:
        trials = run.in_parallel(
            coverage.trial, [(args.seed, k) for k in range(args.coverage)], args.workers, done
        )
        print(coverage.summary(trials))
        numbers["coverage"] = coverage.as_json(trials)
    if args.json:
        Path(args.json).write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    return int(any(o.outcome == judging.FALSE_GOOD for o in outcomes))


SHOWN = (judging.FALSE_GOOD, judging.FALSE_POOR, judging.CRASHED)

if __name__ == "__main__":
    sys.exit(main())
