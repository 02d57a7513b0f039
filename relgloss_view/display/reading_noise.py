"""How unsure readings of a display are, estimated from what a model leaves of them.

The variance of a reading has four parts: an amount of the instrument's own, the same for every
patch; a share of the reading; a share of the patch's light, by which an instrument's three filters
disturb each other, so that the Z of a yellow is unsure too; and digital values that are not quite
what was asked for (dither, a display that is not steady), which count by the slope of the curves.
Weights follow from it (generalised least squares; Carroll and Ruppert 1988), so that neither dark
patches nor bright ones rule a fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.candidates import Fitted

#: The smallest amount, of white's Y, and the smallest share that any instrument is trusted to.
FLOOR, FEWEST = 2e-5, 2e-3
LEAST_UNSTEADY = 2e-3  #: half a step of 8 bits; less than that is none
STEP = 1e-3  #: of digital values, for slopes
TAIL = 5.0  #: degrees of freedom of the t distribution


@dataclass(frozen=True)
class Noise:
    """Standard deviations.

    amount: of white's Y. share: of a reading. mixed: of the mean of X, Y, Z. digital: of digital
    values.

    >>> Noise().share
    0.01
    """

    amount: float = 1e-4
    share: float = 0.01
    mixed: float = 0.0
    digital: float = 0.0

    def whitening(self, model: Fitted, digital: Array) -> Array:
        """(N, 3, 3): makes the three residuals of a patch independent with variance 1."""
        lower = np.linalg.cholesky(self.covariance(model, digital))
        return np.linalg.inv(lower)

    def covariance(self, model: Fitted, digital: Array) -> Array:
        """(N, 3, 3), in the squared unit of the readings."""
        return _covariance(self, *_parts(model, digital))


def estimate_noise(model: Fitted, digital: Array, xyz: Array, before: Noise | None = None) -> Noise:
    """The noise that makes the residuals of a model likeliest, by a multivariate t distribution.

    Misread patches count little in it (Lange, Little and Taylor 1989).
    before: the noise that the model was fitted with.
    """
    from scipy.optimize import minimize

    off = xyz - model.xyz(digital, before.digital if before else 0.0)
    parts = _parts(model, digital)

    def cost(x: Array) -> float:
        noise = _noise_of(x)
        covariance = _covariance(noise, *parts)
        z2 = np.einsum("ni,ni->n", off, np.linalg.solve(covariance, off[:, :, None])[:, :, 0])
        spread = np.linalg.slogdet(covariance)[1]
        return float(np.sum((TAIL + 3.0) * np.log1p(z2 / TAIL) + spread))

    best = None
    for first in ((-7.0, -4.6, -5.5, -9.0), (-7.0, -7.0, -7.0, -4.4)):
        found = minimize(cost, first, method="Nelder-Mead", options={"maxiter": 250, "fatol": 0.05})
        if best is None or found.fun < best.fun:
            best = found
    assert best is not None
    return _noise_of(best.x)


def standardised(
    model: Fitted, digital: Array, xyz: Array, whitening: Array, unsteady: float
) -> Array:
    """(N,), squared distance of each reading from the model in standard deviations; chi2(3)."""
    z = np.einsum("nij,nj->ni", whitening, xyz - model.xyz(digital, unsteady))
    return np.asarray(np.sum(z * z, axis=1))


def _noise_of(x: Array) -> Noise:
    amount, share, mixed, digital = np.exp(np.clip(x, -20.0, 0.0))
    unsteady = float(digital) if digital >= LEAST_UNSTEADY else 0.0
    return Noise(max(float(amount), FLOOR), max(float(share), FEWEST), float(mixed), unsteady)


def _parts(model: Fitted, digital: Array) -> tuple[float, Array, Array]:
    """White's Y, the readings that the model expects (N, 3), their slopes (N, 3 of XYZ, 3)."""
    high, low = np.minimum(digital + STEP, 1.0), np.maximum(digital - STEP, 0.0)
    slope = (model.shape.light(high) - model.shape.light(low)) / (high - low)
    white = float(model.black[1] + model.matrix[1].sum())
    return white, model.xyz(digital), model.matrix[None] * slope[:, None, :]


def _covariance(noise: Noise, white: float, expected: Array, slopes: Array) -> Array:
    total = noise.digital**2 * np.einsum("nik,njk->nij", slopes, slopes)
    mixed = noise.mixed * expected.mean(axis=1, keepdims=True)
    own = (noise.amount * white) ** 2 + (noise.share * expected) ** 2 + mixed**2
    total[:, range(3), range(3)] += own
    return np.asarray(total)
