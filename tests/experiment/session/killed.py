"""A simulated study as a program that can be killed: prints each answer once it is stored.

Run: python killed.py FILE.sqlite DESIGN OBSERVERS. `expected` is what it stores when it is let be.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))

from cases import percepts, study

from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.observers.population import Population
from relgloss_view.experiment.observers.simulation import run_observers
from relgloss_view.experiment.session.store import Store
from relgloss_view.picture.scene.setting import Setting

SEED = 3
TRUTHS = (Setting(1.0, 0.5), Setting(2.0, 0.8))


def made(design):
    grid = Grid((0.0, 1.0, 2.0, 3.0), (0.25, 0.5, 1.0))
    return study(("matte-coated", "uncoated"), grid, design=design, ask_grain=True, seed=SEED)


def main(file, design, observers):
    chosen = made(design)

    def told(answer):
        trial = answer.trial
        print(
            answer.observer, trial.position, trial.sample, trial.setting, trial.repeat,
            answer.question, answer.category, flush=True,
        )  # fmt: skip

    with Store(file, chosen) as store:
        print("open", flush=True)
        run_observers(store, percepts(chosen, TRUTHS), Population(), observers, SEED, told)
    print("done", flush=True)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
