"""Maximum likelihood conjoint measurement, additive: a probit fit of paired comparisons.

Of two surfaces that differ in two properties, one looks more so. The difference of what each level
of each property adds, plus normal noise of sd 1, decides (Ho, Landy and Maloney 2008; Knoblauch and
Maloney 2012, chapter 8). The first level of each adds 0.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from scipy.special import log_ndtr
from scipy.stats import norm


@dataclass(frozen=True)
class Conjoint:
    """What each level adds, from the first on, for both properties, and how well it fits."""

    first: np.ndarray
    second: np.ndarray
    covariance: np.ndarray  #: of first[1:], second[1:]
    log_likelihood: float


def fit_additive(response, first, second, levels):
    """Responses (n,) 0 or 1: the first surface is more so; first, second: (n, 2), levels from 0."""
    rows = np.arange(len(response))
    design = np.zeros((len(response), 2 * levels))
    for k, property_ in enumerate((first, second)):
        design[rows, k * levels + property_[:, 0]] += 1.0
        design[rows, k * levels + property_[:, 1]] -= 1.0
    design = np.delete(design, (0, levels), axis=1)
    signed = np.where(response == 1, 1.0, -1.0)[:, None] * design
    b = np.zeros(design.shape[1])
    for _ in range(100):
        # Newton; the log likelihood of the probit is concave (Pratt 1981).
        z = signed @ b
        mills = np.exp(norm.logpdf(z) - log_ndtr(z))
        hessian = signed.T @ ((mills * (mills + z))[:, None] * signed)
        step = np.linalg.solve(hessian, signed.T @ mills)
        b = b + step
        if np.max(np.abs(step)) < 1e-10:
            break
    else:
        raise AssertionError("no maximum")
    ends = np.split(b, 2)
    return Conjoint(
        np.r_[0.0, ends[0]],
        np.r_[0.0, ends[1]],
        np.linalg.inv(hessian),
        float(np.sum(log_ndtr(signed @ b))),
    )


def published(name):
    """resp (n,), gloss (n, 2), bumps (n, 2) of a data set; skips the test where it is absent."""
    default = Path(__file__).resolve().parents[4] / "shared" / "data" / "mlcm"
    path = Path(os.environ.get("RELGLOSS_MLCM_DIR", default)) / f"{name}.csv"
    if not path.is_file():
        pytest.skip(f"{path} is absent; RELGLOSS_MLCM_DIR names the folder of the MLCM data")
    table = np.loadtxt(path, delimiter=",", skiprows=1, dtype=int)
    return table[:, 0], table[:, 1:3] - 1, table[:, 3:5] - 1
