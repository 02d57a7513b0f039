"""The robust separable solver: reweighted NNLS inside, damped Gauss-Newton outside, a scan before.

The loss is soft-L1 in the logarithmic residual r = log((m + e) / (f + e)), which is relative error
with the floor e: sum_nb w_nb rho(r). Its stationary points over the linear unknowns are those of a
least-squares problem with the weights w (rho'(r)/r) / (Lambda(m+e, f+e) (m+e)), Lambda being the
logarithmic mean, because r = (m - f) / Lambda; so the inner problem is solved by reweighting.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from relgloss_view.fitting import linear
from relgloss_view.fitting.model import (
    INDEX_RANGE,
    LOG_S_RANGE,
    SOFT_L1,
    T_MAX,
    Rung,
    Solution,
    State,
    influence,
    mean_loss,
)
from relgloss_view.fitting.samples import Samples
from relgloss_view.fitting.shapes import Geometry, diffuse_columns, index_slope, lobe_columns

Array = NDArray[np.float64]

STEP_LIMIT = {"l": 0.7, "n": 0.5}  #: of one step, by the first letter of the unknown


class Problem:
    """One rung on one set of samples at a running set of nonlinear unknowns."""

    def __init__(self, g: Geometry, samples: Samples, rung: Rung, alpha: float = SOFT_L1) -> None:
        self.g, self.samples, self.rung, self.alpha = g, samples, rung, alpha

    def columns(self, t: float, log_s: Array, n: Array) -> tuple[Array, Array]:
        """The band-free columns (N, C), values then derivatives, and their products (N, C*C)."""
        first, second, first_t, second_t = diffuse_columns(self.g, t)
        pairs = [lobe_columns(self.g, float(x), float(m)) for x, m in zip(log_s, n, strict=True)]
        parts = [first, second, *(p[0] for p in pairs), first_t, second_t, *(p[1] for p in pairs)]
        if self.rung.free_index and pairs:
            parts += [p[0] * index_slope(self.g, float(m)) for p, m in zip(pairs, n, strict=True)]
        return self._with_products(np.stack(parts, axis=1))

    @staticmethod
    def _with_products(columns: Array) -> tuple[Array, Array]:
        n, c = columns.shape
        return columns, (columns[:, :, None] * columns[:, None, :]).reshape(n, c * c)

    def model(self, columns: Array, kd: Array, ks: Array) -> Array:
        """Radiance factors from columns and linear unknowns."""
        return np.asarray(columns[:, : 2 + len(ks)] @ np.vstack([kd, kd * kd, ks]))

    # --- inside: the linear unknowns ------------------------------------------------------------

    def inner(self, columns: Array, kd: Array, ks: Array, rounds: int) -> tuple[Array, Array]:
        """Reweighted NNLS from the given linear unknowns."""
        used = 2 + self.rung.lobes
        values, products = self._with_products(columns[:, :used])
        for _ in range(rounds):
            model = self.model(columns, kd, ks)
            kd, ks = self._linear(values, products, self._inner_weight(model), kd)
        return kd, ks

    def first_guess(self, columns: Array, rounds: int) -> tuple[Array, Array]:
        """The linear unknowns from scratch: relative weights first, then reweighting."""
        samples = self.samples
        values, products = self._with_products(columns[:, : 2 + self.rung.lobes])
        weight = samples.weight / (samples.value + samples.floor) ** 2
        kd, ks = self._linear(values, products, weight, np.zeros(samples.bands))
        return self.inner(columns, kd, ks, rounds)

    def _inner_weight(self, model: Array) -> Array:
        samples = self.samples
        above, seen = model + samples.floor, samples.value + samples.floor
        residual = np.log(above / seen)
        near = np.abs(residual) < 1e-6
        mean = np.where(near, above, (above - seen) / np.where(near, 1.0, residual))
        slope = influence(residual, self.alpha)
        return np.asarray(samples.weight * slope / (mean * above))

    def _linear(self, v: Array, products: Array, weight: Array, kd: Array) -> tuple[Array, Array]:
        bands, used = self.samples.bands, v.shape[1]
        lobes = used - 2
        gram = (weight.T @ products).reshape(bands, used, used)
        right = (weight * self.samples.value).T @ v
        # The rho^2 term is linearised about the running albedo.
        to_local = np.zeros((bands, used, 1 + lobes))
        to_local[:, 0, 0], to_local[:, 1, 0] = 1.0, 2.0 * kd
        to_local[:, np.arange(2, used), np.arange(1, 1 + lobes)] = 1.0
        right = right + (kd * kd)[:, None] * gram[:, 1, :]
        a = np.einsum("bck,bcd,bdl->bkl", to_local, gram, to_local, optimize=True)
        r = np.einsum("bck,bc->bk", to_local, right)
        if lobes == 0 or self.rung.spectral:
            x = linear.nnls_blocks(a, r)
            return x[:, 0], x[:, 1:].T.copy()
        x0, y = linear.nnls_arrow(
            a[:, 0, 0], a[:, 0, 1:], a[:, 1:, 1:].sum(0), r[:, 0], r[:, 1:].sum(0)
        )
        return x0, np.repeat(y[:, None], bands, axis=1)

    # --- outside: Gauss-Newton on everything, the linear unknowns eliminated ---------------------

    def jacobian_map(self, state: State) -> tuple[Array, Array, list[str]]:
        """How columns combine into derivatives: own unknowns (B, C, K), shared ones (B, C, P)."""
        rung, bands, lobes = self.rung, self.samples.bands, self.rung.lobes
        count = 2 * (2 + lobes) + (lobes if rung.free_index else 0)
        own_lobes = lobes if rung.spectral else 0
        own = np.zeros((bands, count, 1 + own_lobes))
        own[:, 0, 0], own[:, 1, 0] = 1.0, 2.0 * state.kd
        own[:, np.arange(2, 2 + own_lobes), np.arange(1, 1 + own_lobes)] = 1.0
        shared, names = [], []
        slope = 2 + lobes
        if rung.rough:
            part = np.zeros((bands, count))
            part[:, slope], part[:, slope + 1] = state.kd, state.kd**2
            shared.append(part)
            names.append("t")
        for j in range(lobes):
            part = np.zeros((bands, count))
            part[:, slope + 2 + j] = state.ks[j]
            shared.append(part)
            names.append(f"log_s{j}")
        for j in range(lobes if rung.free_index else 0):
            part = np.zeros((bands, count))
            part[:, 2 * slope + j] = state.ks[j]
            shared.append(part)
            names.append(f"n{j}")
        if lobes and not rung.spectral:
            for j in range(lobes):
                part = np.zeros((bands, count))
                part[:, 2 + j] = 1.0
                shared.append(part)
                names.append(f"ks{j}")
        stacked = np.stack(shared, axis=2) if shared else np.zeros((bands, count, 0))
        return own, stacked, names

    def normal_equations(
        self, columns: Array, products: Array, state: State
    ) -> tuple[Array, Array, Array, Array, Array, list[str]]:
        """Blocks of the Gauss-Newton matrix and the gradient: own, cross, shared, and names."""
        samples = self.samples
        model = self.model(columns, state.kd, state.ks)
        above = model + samples.floor
        residual = np.log(above / (samples.value + samples.floor))
        slope = samples.weight * influence(residual, self.alpha)
        own, shared, names = self.jacobian_map(state)
        c = columns.shape[1]
        gram = ((slope / above**2).T @ products).reshape(samples.bands, c, c)
        gradient = (slope * residual / above).T @ columns
        gram_own = gram @ own
        h_oo = np.swapaxes(own, 1, 2) @ gram_own
        h_os = np.swapaxes(gram_own, 1, 2) @ shared
        h_ss = np.sum(np.swapaxes(shared, 1, 2) @ (gram @ shared), axis=0)
        g_o = np.einsum("bck,bc->bk", own, gradient)
        g_s = np.einsum("bcp,bc->p", shared, gradient)
        return h_oo, h_os, h_ss, g_o, g_s, names

    def refine(self, start: State, rounds: int = 30, tolerance: float = 1e-5) -> Solution:
        """Descend from `start` to the nearest optimum."""
        columns, products = self.columns(start.t, start.log_s, start.n)
        kd, ks = self.inner(columns, start.kd, start.ks, 1)
        state = replace(start, kd=kd, ks=ks)
        loss = mean_loss(self.samples, self.model(columns, kd, ks), self.alpha)
        damping, converged = 1e-4, False
        for _ in range(rounds):
            equations = self.normal_equations(columns, products, state)
            accepted = False
            for _ in range(6):
                trial = self._step(state, equations, damping)
                new_columns, new_products = self.columns(trial.t, trial.log_s, trial.n)
                kd, ks = self.inner(new_columns, trial.kd, trial.ks, 1)
                trial = replace(trial, kd=kd, ks=ks)
                new_loss = mean_loss(self.samples, self.model(new_columns, kd, ks), self.alpha)
                if new_loss <= loss:
                    accepted = True
                    break
                damping = max(damping * 10.0, 1e-3)
            if not accepted:
                converged = True
                break
            moved = abs(trial.t - state.t) + float(np.sum(np.abs(trial.log_s - state.log_s)))
            moved += float(np.sum(np.abs(trial.n - state.n)))
            gained = loss - new_loss
            state, loss, columns, products = trial, new_loss, new_columns, new_products
            damping = max(damping * 0.1, 1e-9)
            if moved < tolerance or gained < 1e-3 * tolerance * loss:
                converged = True
                break
        return Solution(state, loss, converged)

    def _step(
        self,
        state: State,
        equations: tuple[Array, Array, Array, Array, Array, list[str]],
        damping: float,
    ) -> State:
        h_oo, h_os, h_ss, g_o, g_s, names = equations
        bands, k = g_o.shape
        current = np.concatenate([state.kd[:, None], state.ks.T[:, : k - 1]], axis=1)
        held = (current <= 0.0) & (g_o > 0.0)
        keep = ~held
        a = h_oo * keep[:, :, None] * keep[:, None, :]
        diagonal = np.einsum("bkk->bk", a)
        ridge = damping * diagonal + np.where(diagonal > 0.0, 0.0, 1.0)
        a = a + ridge[:, :, None] * np.eye(k)
        b = h_os * keep[:, :, None]
        right = -g_o * keep
        low, high, value = self._bounds(state, names)
        free = ~(((value <= low) & (g_s > 0.0)) | ((value >= high) & (g_s < 0.0)))
        free &= np.diag(h_ss) > 0.0 if len(names) else free
        b = b * free
        solved = np.linalg.solve(a, np.concatenate([b, right[:, :, None]], axis=2))
        step = np.zeros(len(names))
        if np.any(free):
            schur = h_ss + damping * np.diag(np.diag(h_ss))
            schur = schur - np.einsum("bkp,bkq->pq", b, solved[:, :, :-1])
            reduced = -g_s - np.einsum("bkp,bk->p", b, solved[:, :, -1])
            index = np.flatnonzero(free)
            block = schur[np.ix_(index, index)]
            size = np.sqrt(np.maximum(np.diag(h_ss)[index], 1e-300))
            unit = block / size[:, None] / size
            step[index] = (
                np.linalg.lstsq(
                    unit + 1e-12 * np.eye(len(index)), reduced[index] / size, rcond=None
                )[0]
                / size
            )
        limit = np.array([STEP_LIMIT.get(name[0], np.inf) for name in names])
        step = np.clip(step, -limit, limit)
        own = solved[:, :, -1] - solved[:, :, :-1] @ step
        current = np.maximum(current + own, 0.0)
        moved = dict(zip(names, np.clip(value + step, low, high), strict=True))
        log_s = np.array([moved[f"log_s{j}"] for j in range(self.rung.lobes)])
        ks = current[:, 1:].T.copy()
        if self.rung.lobes and not self.rung.spectral:
            ks = np.array([np.full(bands, moved[f"ks{j}"]) for j in range(self.rung.lobes)])
        n = np.array([moved.get(f"n{j}", state.n[j]) for j in range(self.rung.lobes)])
        return State(float(moved.get("t", state.t)), log_s, n, current[:, 0], ks)

    def _bounds(self, state: State, names: list[str]) -> tuple[Array, Array, Array]:
        low, high, value = [], [], []
        for name in names:
            if name == "t":
                bound, now = (0.0, T_MAX), state.t
            elif name.startswith("n"):
                bound, now = INDEX_RANGE, float(state.n[int(name[1:])])
            elif name.startswith("log_s"):
                bound, now = LOG_S_RANGE, float(state.log_s[int(name[5:])])
            else:
                bound, now = (0.0, np.inf), float(state.ks[int(name[2:]), 0])
            low.append(bound[0])
            high.append(bound[1])
            value.append(now)
        return np.array(low), np.array(high), np.array(value)
