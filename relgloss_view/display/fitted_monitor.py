"""A monitor of a fitted model: the numbers that a display file holds, and their curves."""

from __future__ import annotations

import os

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.display.candidates import Fitted, gain_offset_gamma
from relgloss_view.display.monitor import Curves, Monitor, Numbers, with_black
from relgloss_view.display.readings import Readings
from relgloss_view.display.tone_curve import ToneCurve

SAMPLES = 257  #: of a monotone curve, evenly over its digital values
DARK = 0.02  #: digital values up to here count as black, from 1 minus it as white


def curves_of(numbers: Numbers) -> Curves:
    """The curves of the three channels."""
    made = [
        _gain_offset_gamma(numbers.offset[k], numbers.gamma[k])
        if numbers.kind == "gain-offset-gamma"
        else _sampled(numbers.samples[k])
        for k in range(3)
    ]
    return Curves((made[0], made[1], made[2]))


def _gain_offset_gamma(offset: float, gamma: float) -> ToneCurve:
    return ToneCurve(lambda digital: gain_offset_gamma(digital, offset, gamma))


def _sampled(samples: tuple[float, ...]) -> ToneCurve:
    values = np.array(samples)
    at = np.linspace(0.0, 1.0, len(values))
    return ToneCurve(lambda digital: np.interp(digital, at, values))


def monitor_of_numbers(
    numbers: Numbers,
    name: str,
    luminance_cd_m2: float | None,
    black_known: bool,
    notes: tuple[str, ...] = (),
) -> Monitor:
    """The monitor of a model's numbers; white follows from them."""
    matrix = np.array(numbers.xyz_from_rgb)
    white = matrix.sum(axis=1)
    return Monitor(
        name,
        "readings",
        white,
        matrix,
        np.array(numbers.floor),
        curves_of(numbers),
        luminance_cd_m2,
        black_known,
        notes,
        fitted=numbers,
    )


def numbers_of(model: Fitted) -> Numbers:
    """The numbers of a fitted candidate, relative to its white."""
    white = float(model.white[1])
    xyz_from_rgb, floor = with_black(model.matrix / white, model.black / white)
    matrix = tuple(_three(row) for row in xyz_from_rgb)
    if model.shape.bent is None:
        offset, gamma = _three(model.shape.offset), _three(model.shape.gamma)
        return Numbers("gain-offset-gamma", matrix, _three(floor), offset, gamma)
    digital = np.linspace(0.0, 1.0, SAMPLES)
    light = model.shape.light(np.repeat(digital[:, None], 3, axis=1))
    light = np.maximum.accumulate(light.round(9), axis=0)
    samples = tuple(tuple(float(v) for v in light[:, k]) for k in range(3))
    return Numbers("curves", matrix, _three(floor), samples=samples)


def monitor_of_fit(model: Fitted, readings: Readings) -> Monitor:
    """The monitor of a fitted candidate."""
    dark = bool(np.any(np.all(readings.rgb <= DARK, axis=1)))
    luminance = float(model.white[1]) if readings.absolute else None
    name = os.path.basename(readings.source)
    return monitor_of_numbers(numbers_of(model), name, luminance, dark, readings.notes)


def _three(values: Array) -> tuple[float, float, float]:
    a, b, c = (float(v) for v in values)
    return a, b, c
