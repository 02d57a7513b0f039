"""Table: a screen whose channels do not add, by the look-up table of its profile, and back.

Backward, the forward table is inverted: a profile's own backward table maps colours that the screen
can't show, and holds 8 or 16 bits between coarse nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Ints
from relgloss_view.base.icc.profile import D50
from relgloss_view.material.cielab import lab_from_xyz

SAMPLES = 21  #: of each channel, evenly spaced, from which the search starts
ITERATIONS = 60
CHUNK = 1 << 16  #: colours that are searched at once
#: Half the distance of digital values by which the forward table's slope is taken.
STEP = 1e-6
SETTLED = 1e-9  #: of CIELAB or of digital values: a hundredth of a step of 16 bits is 1.5e-7
SLACK = 0.003  #: of digital values: about 0.3 in CIELAB, a third of what is just visible
MOST_BEYOND = 0.3  #: of digital values beyond 0 and 1
MOST_DAMPING = 1e6
ROUNDS = 2  #: of leaving plateaus, of more than one channel
HALVINGS = 14  #: of the way to a plateau's end, to a quarter of a step of 12 bits
FAR = 1e-3  #: CIELAB distance beyond which another start is tried
NEIGHBOURS = 8
FLAT = 1e-6  #: slope of CIELAB by a channel; usual ones are about 100


@dataclass(frozen=True, eq=False)
class Table:
    """A look-up table from digital values to light, and its inverse.

    forward: XYZ (N, 3) under D50 of digital values (N, 3), 0 to 1. rgb_from_connection: (3, 3),
    from those to linear RGB, where (1, 1, 1) is white. floor: (3,), as of Monitor.
    """

    forward: Callable[[Array], Array]
    rgb_from_connection: Array
    floor: Array
    kind: str = "table"

    def light(self, digital: Array) -> Array:
        """(N, 3) of digital values (N, 3), which are cut to 0 to 1; may be below 0 and above 1."""
        rgb = self.forward(np.clip(digital, 0.0, 1.0)) @ self.rgb_from_connection.T
        return np.asarray((rgb - self.floor) / (1.0 - self.floor))

    def digital(self, light: Array) -> Array:
        """(N, 3), 0 to 1, of light (N, 3): the nearest in CIELAB where none shows it."""
        return self.solved(light)[0]

    def reach(self, light: Array) -> Array:
        """(N,) whether digital values show light (N, 3): `run_on` stays within 0 to 1, by SLACK."""
        digital = self.run_on(light)
        return np.asarray(((digital >= -SLACK) & (digital <= 1.0 + SLACK)).all(axis=1))

    def solved(self, light: Array) -> tuple[Array, Array]:
        """Digital values (N, 3) of light (N, 3), and the CIELAB distance (N,) that is left.

        By damped least squares in CIELAB, where the tables of profiles are nearly straight, held
        to 0 to 1, from the sample of the table that is nearest (Levenberg 1944; Marquardt 1963;
        bounds by a set of held channels, Bertsekas 1982).
        """
        xyz = (self.floor + (1.0 - self.floor) * light) @ self._connection_from_rgb.T
        lab = lab_from_xyz(xyz, D50)
        digital, left = np.empty_like(lab), np.empty(len(lab))
        for start in range(0, len(lab), CHUNK):
            part = slice(start, start + CHUNK)
            digital[part], left[part] = self._solved(lab[part])
        return digital, left

    def cut(self, light: Array) -> Array:
        """(N, 3), 0 to 1, of light (N, 3): `run_on`, each channel cut by itself."""
        return np.clip(self.run_on(light), 0.0, 1.0)

    def run_on(self, light: Array) -> Array:
        """Digital values (N, 3) of light; of light that is not shown they run on beyond 0 and 1.

        They do straight on in CIELAB, by MOST_BEYOND at most, so that values between those of
        nodes can be interpolated.
        """
        digital, left = self.solved(light)
        far = left > 1e-6
        xyz = (self.floor + (1.0 - self.floor) * light[far]) @ self._connection_from_rgb.T
        off = lab_from_xyz(xyz, D50) - self._lab(digital[far])
        step = np.einsum("nij,nj->ni", np.linalg.pinv(self._slopes(digital[far])), off)
        digital[far] += np.clip(step, -MOST_BEYOND, MOST_BEYOND)
        return digital

    @cached_property
    def _connection_from_rgb(self) -> Array:
        return np.asarray(np.linalg.inv(self.rgb_from_connection), np.float64)

    @cached_property
    def _samples(self) -> tuple[Array, Any]:
        """Digital values (S, 3), and a tree of their CIELAB."""
        from scipy.spatial import cKDTree

        axis = np.linspace(0.0, 1.0, SAMPLES)
        digital = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
        return digital, cKDTree(self._lab(digital))

    def _lab(self, digital: Array) -> Array:
        return lab_from_xyz(self.forward(digital), D50)

    def _slopes(self, digital: Array) -> Array:
        """(N, 3, 3): of CIELAB (second axis) by digital values (third)."""
        slopes = np.empty((len(digital), 3, 3))
        for k in range(3):
            low, high = digital.copy(), digital.copy()
            low[:, k] = np.maximum(low[:, k] - STEP, 0.0)
            high[:, k] = np.minimum(high[:, k] + STEP, 1.0)
            width = (high[:, k] - low[:, k])[:, None]
            slopes[:, :, k] = (self._lab(high) - self._lab(low)) / width
        return slopes

    def _solved(self, target: Array) -> tuple[Array, Array]:
        starts, tree = self._samples
        digital = starts[tree.query(target)[1]]
        left = self._searched(target, digital)
        for _ in range(ROUNDS):
            stuck = np.flatnonzero(left > SETTLED)
            flat = np.abs(self._slopes(digital[stuck])).max(axis=1) < FLAT
            if not flat.any():
                break
            for k in range(3):
                for end in (0.0, 1.0):
                    self._leave_plateau(target, digital, left, stuck[flat[:, k]], k, end)
        self._start_elsewhere(target, digital, left)
        return digital, left

    def _leave_plateau(
        self, target: Array, digital: Array, left: Array, which: Ints, k: int, end: float
    ) -> None:
        """Search again from where channel k's plateau ends on the way to `end`, for `which`."""
        on, beyond = digital[which], digital[which]
        lab = self._lab(on)
        beyond[:, k] = end
        for _ in range(HALVINGS):
            middle = 0.5 * (on + beyond)
            same = np.abs(self._lab(middle) - lab).max(axis=1, keepdims=True) < SETTLED
            on, beyond = np.where(same, middle, on), np.where(same, beyond, middle)
        new_left = self._searched(target[which], beyond)
        better = new_left < left[which]
        digital[which[better]], left[which[better]] = beyond[better], new_left[better]

    def _start_elsewhere(self, target: Array, digital: Array, left: Array) -> None:
        """Search again from the sample, of those near by, that is farthest from what was found.

        Where steps of a table fold it, another of its parts may be nearer.
        """
        samples, tree = self._samples
        far = np.flatnonzero(left > FAR)
        if not len(far):
            return
        near = samples[tree.query(target[far], NEIGHBOURS)[1]]
        away = np.abs(near - digital[far, None]).max(axis=2).argmax(axis=1)
        again = near[np.arange(len(far)), away]
        new_left = self._searched(target[far], again)
        better = new_left < left[far]
        digital[far[better]], left[far[better]] = again[better], new_left[better]

    def _searched(self, target: Array, digital: Array) -> Array:
        """Bring digital values (N, 3) nearer to CIELAB values; the distance (N,) that is left."""
        off = self._lab(digital) - target
        square = np.sum(off * off, axis=1)
        active, damping = np.arange(len(target)), np.full(len(target), 1e-6)
        slopes = self._slopes(digital)
        for _ in range(ITERATIONS):
            at = digital[active]
            new = np.clip(at + _step(at, off[active], slopes, damping[active]), 0.0, 1.0)
            new_off = self._lab(new) - target[active]
            new_square = np.sum(new_off * new_off, axis=1)
            better = new_square < square[active]
            moved = np.abs(new - at).max(axis=1)
            index = active[better]
            digital[index], off[index] = new[better], new_off[better]
            square[index] = new_square[better]
            damping[active] = np.where(better, 0.1, 10.0) * damping[active]
            done = (square[active] < SETTLED**2) | (moved < SETTLED)
            done |= damping[active] > MOST_DAMPING
            slopes[better & ~done] = self._slopes(digital[active[better & ~done]])
            active, slopes = active[~done], slopes[~done]
            if not len(active):
                break
        return np.asarray(np.sqrt(square))


def _step(at: Array, off: Array, slopes: Array, damping: Array) -> Array:
    """Steps (N, 3) of digital values; channels at an end that would leave 0 to 1 are held."""
    gradient = np.einsum("nij,ni->nj", slopes, off)
    held = ((at <= 0.0) & (gradient > 0.0)) | ((at >= 1.0) & (gradient < 0.0))
    free = ~held
    normal = np.einsum("nij,nik->njk", slopes, slopes) * (free[:, :, None] & free[:, None, :])
    size = np.maximum(np.trace(normal, axis1=1, axis2=2), 1e-12)[:, None]
    diagonal = np.arange(3)
    normal[:, diagonal, diagonal] += np.where(held, size, damping[:, None] * size + 1e-300)
    return np.asarray(-np.linalg.solve(normal, (gradient * free)[:, :, None])[:, :, 0])
