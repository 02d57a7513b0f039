"""In what order an observer sees samples and stimuli: seeded, and balanced over observers.

Samples come one after another, since an object has to be put in place for each (Ishii et al., steps
3 to 6). Balanced orders are rows of Williams squares (Williams 1949), in which every stimulus comes
at every place and after every other one equally often; two observers in turn get a row and its
reverse, so that no stimulus is always early, however few observers there are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.experiment.design.study import Study

OF_SAMPLES, OF_STIMULI, OF_ROWS = 1, 2, 3  #: what a seed is for


@dataclass(frozen=True)
class Trial:
    """One stimulus before one observer."""

    position: int  #: in the observer's session, from 0
    sample: int  #: of the study
    setting: int  #: of the study's grid
    repeat: int


def planned_trials(study: Study, ordinal: int) -> tuple[Trial, ...]:
    """All trials of a full-grid study for the observer who came as number `ordinal`, from 0."""
    count = len(study.grid)
    trials: list[Trial] = []
    for sample in sample_order(study, ordinal):
        for repeat in range(study.procedure.repeats):
            for setting in _stimulus_order(study, ordinal, sample, repeat, count):
                trials.append(Trial(len(trials), sample, setting, repeat))
    return tuple(trials)


def sample_order(study: Study, ordinal: int) -> tuple[int, ...]:
    """The samples in the order in which an observer sees them."""
    count = len(study.samples)
    if study.procedure.order == "random":
        draw = _random(study, OF_SAMPLES, ordinal)
        return tuple(int(k) for k in draw.permutation(count))
    return _balanced(study, ordinal, count, (OF_SAMPLES,))


def _stimulus_order(
    study: Study, ordinal: int, sample: int, repeat: int, count: int
) -> tuple[int, ...]:
    if study.procedure.order == "random":
        draw = _random(study, OF_STIMULI, sample, repeat, ordinal)
        return tuple(int(k) for k in draw.permutation(count))
    return _balanced(study, ordinal, count, (OF_STIMULI, sample, repeat))


def _balanced(study: Study, ordinal: int, count: int, use: tuple[int, ...]) -> tuple[int, ...]:
    """A row of a Williams square whose rows and names are shuffled by the seed."""
    # A square of even size holds the reverse of each of its rows already.
    pairs = count // 2 if count % 2 == 0 else count
    cycle, place = divmod(ordinal, 2 * pairs) if pairs else (0, 0)
    rows = _random(study, OF_ROWS, *use, cycle).permutation(pairs)
    names = _random(study, *use).permutation(count)
    row = williams_row(count, int(rows[place // 2]) if pairs else 0)
    if place % 2:
        row = row[::-1]
    return tuple(int(names[k]) for k in row)


def williams_row(count: int, row: int) -> tuple[int, ...]:
    """Row `row` of the Williams square of `count` treatments (Williams 1949).

    0, 1, n-1, 2, n-2, ... and its shifts: with even n each treatment follows each other one once;
    with odd n it takes the rows and their reverses.
    """
    zigzag = [(k + 1) // 2 if k % 2 else -(k // 2) for k in range(count)]
    return tuple((step + row) % count for step in zigzag)


def _random(study: Study, *use: int) -> np.random.Generator:
    return np.random.default_rng([study.procedure.seed, *use])
