"""The numpy twins promise arrays of any leading shape: a block of inputs gives a block of results.

Each function is its own oracle here: what it gives for a list of inputs, tested elsewhere, it must
give for the same inputs arranged as a block.
"""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import brdf
from relgloss_view.picture.model import noise, shape, tone

#: No two axes are alike, and none is as long as a vector.
BLOCK = (2, 4, 5)
COUNT = 40
WHITE = np.array([1.0168, 1.0, 0.6761])
HALF = np.array([0.05, 0.04, 0.05])


def vectors(seed, low=-1.0, high=1.0, size=3):
    return np.random.default_rng(seed).uniform(low, high, (COUNT, size))


def unit(seed):
    v = np.random.default_rng(seed).normal(size=(COUNT, 3))
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def hashes(seed=1):
    return noise.cell_hash(np.random.default_rng(seed).integers(-99, 99, (COUNT, 3)), 5)


def displayed(gamut):
    model = DisplayModel.of(Display(gamut=gamut))
    return lambda lab: tone.display_rgb(lab, model)


def meeting(kind):
    eye = np.array([0.15, 0.2, 0.4])
    return lambda target: shape.meet(kind, eye, target - eye, HALF)


def cells_of(kind):
    def cells(target):
        hit = meeting(kind)(target)
        return shape.surface_cell(kind, hit, 0.003, HALF)

    return cells


SURE = 0.3 * unit(1)  # a point within reach of every shape
FUNCTIONS = {
    "facing": (brdf.facing, unit(1), unit(2), unit(3)),
    "pcg3d": (noise.pcg3d, hashes()),
    "cell_hash": (lambda c: noise.cell_hash(c, 3), np.arange(3 * COUNT).reshape(COUNT, 3) - 60),
    "uniforms": (noise.uniforms, hashes()),
    "gaussians": (noise.gaussians, vectors(2, 0.01, 0.99, 2)),
    "frame": (noise.frame, unit(4)),
    "tilt, paper": (lambda h: noise.tilt_angles("paper", h, 0.1), hashes()),
    "tilt, tangent": (lambda h: noise.tilt_angles("tangent", h, 0.1), hashes()),
    "tilted": (noise.tilted, unit(4), vectors(5, -0.3, 0.3, 2)),
    "noisy normal": (
        lambda n, o, h: noise.noisy_normal("paper", n, o, h, 0.5),
        unit(4),
        unit(6),
        hashes(),
    ),
    "lab": (lambda v: tone.lab_from_xyz(v, WHITE), vectors(7, 0.0, 1.0)),
    "xyz": (lambda v: tone.xyz_from_lab(v, WHITE), vectors(8, 0.0, 80.0)),
    "split": (lambda d, s: tone.split_lab(d, s, WHITE), vectors(7, 0, 1), vectors(8, 0, 1)),
    "scaled": (lambda v: tone.scaled_lab(v, 0.4), vectors(9, 0.0, 50.0, 4)),
    "false colour": (tone.false_colour, vectors(10, 0.0, 100.0)[:, 0]),
    "gamut": (lambda v: tone.in_gamut(v, DisplayModel.of(Display())), vectors(11, -0.1, 1.1)),
    "display, chroma": (displayed("chroma"), vectors(12, -20.0, 120.0)),
    "display, clip": (displayed("clip"), vectors(12, -20.0, 120.0)),
    **{f"meet {kind}": (meeting(kind), SURE) for kind in ("cylinder", "sphere", "plane", "box")},
    **{f"cell {kind}": (cells_of(kind), SURE) for kind in ("cylinder", "sphere", "plane", "box")},
}


def blocks(arrays):
    return [a.reshape(*BLOCK, *a.shape[1:]) for a in arrays]


@pytest.mark.parametrize("name", list(FUNCTIONS))
def test_a_block_is_its_rows(name):
    function, *inputs = FUNCTIONS[name]
    rows, block = function(*inputs), function(*blocks(inputs))
    if not isinstance(rows, tuple):
        rows, block = (rows,), (block,)
    for row, whole in zip(rows, block, strict=True):
        assert whole.shape == (*BLOCK, *row.shape[1:])
        np.testing.assert_array_equal(whole.reshape(row.shape), row)
