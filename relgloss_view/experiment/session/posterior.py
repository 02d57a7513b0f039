"""Where the right setting of a sample lies, given the answers of an adaptive study.

An observer judges how far a setting is from the one that is right for the sample. A posterior over
where that lies is kept on a grid, with an ordinal probit likelihood (Aitchison and Silvey 1957).
Nothing is assumed of pictures: how fast the judged distance grows along sigma_N and along log c,
and where the categories end, are unknowns with priors of their own, integrated out.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Array
from relgloss_view.experiment.design.coordinates import coordinates, from_steps
from relgloss_view.experiment.design.grid import Grid

PER_STEP = 4  #: points of the posterior a step of the grid
#: Judged distance per step of the grid, in units of the observers' noise, along each axis. The
#: least is that of a ridge.
SLOPES = (0.03, 0.3, 0.7, 1.2, 2.0, 3.5)
#: Where the first category ends, and how wide the others are, in the same unit.
FIRST_BOUNDS = (0.0, 0.6, 1.2, 2.0)
WIDTHS = (0.4, 0.8, 1.3, 2.0)
LAPSE = 0.03  #: share of answers that have nothing to do with the picture
INTERVAL = 0.95


@dataclass(frozen=True)
class Estimate:
    """What a posterior says of the right setting."""

    sigma_n_deg: float
    c_fraction: float
    sigma_n_interval_deg: tuple[float, float]  #: 95 %
    c_interval: tuple[float, float]
    width_steps: tuple[float, float]  #: of both intervals
    chance: float  #: probability that all answers are by chance
    answers: int


class Posterior:
    """Where the right setting of a sample lies, given answers."""

    def __init__(self, grid: Grid, categories: int) -> None:
        self._grid, self._categories = grid, categories
        self._settings = coordinates(grid)
        ends = self._settings[-1]
        axes = [np.linspace(0.0, end, PER_STEP * round(end) + 1) for end in ends]
        self.points: Array = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 2)
        self._shape = (len(axes[0]), len(axes[1]))
        self._slopes = np.array([(a, b) for a in SLOPES for b in SLOPES])
        steps = np.arange(categories - 1)
        self._bounds = np.array([t + w * steps for t in FIRST_BOUNDS for w in WIDTHS])
        shape = (len(self.points), len(self._slopes), len(self._bounds))
        self._log = np.zeros(shape, dtype=np.float32)
        self._counted: Counter[tuple[int, int]] = Counter()
        #: (points,), the likelihood summed over all else; made when it is asked for.
        self._joint: Array | None = None

    def update(self, answers: Sequence[tuple[int, int]]) -> None:
        """Take all answers so far, as (setting, category); those taken before are not again."""
        wanted = Counter(answers)
        if wanted == self._counted:
            return
        self._joint = None
        if wanted - self._counted == wanted or self._counted - wanted:
            self._log[:] = 0.0  # some were taken back
            self._counted.clear()
        for (setting, category), more in (wanted - self._counted).items():
            self._log += more * self._log_likelihood(setting, category)
        self._counted = wanted

    def _log_likelihood(self, setting: int, category: int) -> NDArray[np.float32]:
        from scipy.special import ndtr

        apart = (self.points - self._settings[setting]) ** 2
        distance = np.sqrt(apart @ (self._slopes**2).T).astype(np.float32)[:, :, None]
        bounds = self._bounds.astype(np.float32)
        below = ndtr(bounds[:, category] - distance) if category < bounds.shape[1] else 1.0
        above = ndtr(bounds[:, category - 1] - distance) if category > 0 else 0.0
        return np.asarray(
            np.log((1.0 - LAPSE) * (below - above) + LAPSE / self._categories), dtype=np.float32
        )

    def weights(self) -> Array:
        """Probability of each of `points`, all else integrated out."""
        joint = self._summed()
        return np.asarray(joint / joint.sum())

    def _summed(self) -> Array:
        if self._joint is None:
            self._joint = np.exp(self._log - self._log.max()).sum(axis=(1, 2), dtype=np.float64)
        return self._joint

    def table(self, weights: Array) -> Array:
        """Weights of `points` as (fine sigma_N, fine c)."""
        return weights.reshape(self._shape)

    def chance(self) -> float:
        """Probability that the answers are by chance, whatever the setting; a priori a half.

        The category of such an answer has probabilities of their own, all equally likely: a
        Dirichlet mixture in closed form. How settings were chosen does not matter.
        """
        from scipy.special import gammaln

        by_setting = float(self._log.max() + np.log(self._summed().sum() / self._log.size))
        counts = np.zeros(self._categories)
        for (_, category), n in self._counted.items():
            counts[category] += n
        k = self._categories
        by_chance = float(gammaln(k) - gammaln(k + counts.sum()) + np.sum(gammaln(1.0 + counts)))
        return float(1.0 / (1.0 + np.exp(np.clip(by_setting - by_chance, -500.0, 500.0))))

    def estimate(self) -> Estimate:
        """The posterior's mean and its 95 % intervals, along each axis."""
        weights = self.weights()
        mean = weights @ self.points
        table = self.table(weights)
        ends = []
        for axis, marginal in enumerate((table.sum(axis=1), table.sum(axis=0))):
            length = self._settings[-1][axis]
            ends.append(_interval(marginal, np.linspace(0.0, length, len(marginal))))
        corners = from_steps(self._grid, np.array([mean, *zip(*ends, strict=True)]))
        (sigma, c), low, high = corners
        return Estimate(
            sigma_n_deg=float(sigma),
            c_fraction=float(c),
            sigma_n_interval_deg=(float(low[0]), float(high[0])),
            c_interval=(float(low[1]), float(high[1])),
            width_steps=(ends[0][1] - ends[0][0], ends[1][1] - ends[1][0]),
            chance=self.chance(),
            answers=sum(self._counted.values()),
        )

    def draw(self, random: np.random.Generator) -> int:
        """A setting by Thompson sampling: the nearest to a point that the posterior draws."""
        point = self.points[random.choice(len(self.points), p=self.weights())]
        return int(np.argmin(np.sum((self._settings - point) ** 2, axis=1)))


def _interval(marginal: Array, places: Array) -> tuple[float, float]:
    """Ends of the shortest interval, so that it reaches an end of the grid where the peak is there.

    Each place represents what lies half a point around it.
    """
    if len(places) == 1:
        return float(places[0]), float(places[0])
    half = 0.5 * (places[1] - places[0])
    edges = np.concatenate([[places[0]], places[:-1] + half, [places[-1]]])
    reached = np.concatenate([[0.0], np.cumsum(marginal)])
    tails = np.linspace(0.0, 1.0 - INTERVAL, 51)
    low = np.interp(tails, reached, edges)
    high = np.interp(tails + INTERVAL, reached, edges)
    shortest = int(np.argmin(high - low))
    return float(low[shortest]), float(high[shortest])
