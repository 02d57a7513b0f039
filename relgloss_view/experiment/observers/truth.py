"""What is right for each sample in a simulated study: published, given, or drawn by chance."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.experiment.design.coordinates import from_steps, grid_steps, to_steps
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.study import Study
from relgloss_view.picture.scene.sample import SAMPLES
from relgloss_view.picture.scene.setting import Setting

PUBLISHED, CELLS, ANYWHERE = "published", "cells", "anywhere"
CHOICES = (PUBLISHED, CELLS, ANYWHERE)
OF_TRUTHS = 7  #: what a seed is for; see order.py


def truths_of(
    study: Study, choice: str, stated: Mapping[str, Setting], seed: int
) -> tuple[Setting, ...]:
    """The right setting of each sample; those that are `given` by label count first.

    published: what the paper's observers chose for a built-in paper, the grid's middle for other
    samples. cells: a setting of the grid, by chance. anywhere: a point of its range, by chance.
    InputError for a label that is no sample's and a truth outside the grid's range.
    """
    labels = [sample.label for sample in study.samples]
    for label in stated:
        if label not in labels:
            raise InputError(
                f"--truth {printable(label, 60)!r}: no such sample; expected {', '.join(labels)}"
            )
    random = np.random.default_rng([seed, OF_TRUTHS])
    truths = []
    for sample in study.samples:
        settings = study.grid.settings
        if choice == CELLS:
            chosen = settings[int(random.integers(len(settings)))]
        elif choice == ANYWHERE:
            ends = np.array(to_steps(study.grid, settings[-1].sigma_n_deg, settings[-1].c_fraction))
            ((sigma, c),) = from_steps(study.grid, (ends * random.random(2))[None])
            chosen = Setting(float(sigma), float(c))
        elif sample.sample.name is not None:
            matched = SAMPLES[sample.sample.name]
            chosen = Setting(matched.sigma_n_deg, matched.c_fraction)
        else:
            rows, columns = study.grid.shape
            chosen = settings[(rows // 2) * columns + columns // 2]
        truths.append(stated.get(sample.label, chosen))
        _check_inside(study, sample.label, truths[-1])
    return tuple(truths)


def right_settings(grid: Grid, truth: Setting, count: int) -> tuple[Setting, ...]:
    """A truth and, of two that are equally right, the other one.

    That lies half of the grid away along both axes, towards the farther end, so that it is in the
    grid and never beside the first.
    """
    if count == 1:
        return (truth,)
    axes = (grid.sigma_n_deg, grid.c_fraction)
    far = []
    for values, at in zip(axes, grid_steps(grid, truth.sigma_n_deg, truth.c_fraction), strict=True):
        half = (len(values) - 1) / 2.0
        step = at + half if at < half else at - half
        far.append(float(np.interp(step, np.arange(len(values)), values)))
    return truth, Setting(*far)


def _check_inside(study: Study, label: str, setting: Setting) -> None:
    grid = study.grid
    inside = (
        grid.sigma_n_deg[0] <= setting.sigma_n_deg <= grid.sigma_n_deg[-1]
        and grid.c_fraction[0] - 1e-9 <= setting.c_fraction <= grid.c_fraction[-1] + 1e-9
    )
    if not inside:
        raise InputError(
            f"--truth {printable(label, 60)}: {setting.words} is outside the study's grid, so that "
            f"no analysis could find it; give another, such as --truth {CELLS}"
        )
