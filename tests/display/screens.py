"""Screens that tests make up: profiles of known numbers in files, and Argyll's word on them."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
import pytest

from relgloss_view.display.icc_writing import adaptation_to_d50, profile_of_monitor
from relgloss_view.display.monitor import Curves, Monitor, with_black
from relgloss_view.display.tone_curve import ToneCurve
from relgloss_view.material.spectra import rgb_to_xyz_matrix, white_from_xy

D65 = (0.3127, 0.3290)
WIDE = ((0.70, 0.295), (0.17, 0.79), (0.14, 0.05))  #: sRGB lies within
GAMMAS = (1.8, 2.2, 2.6)
BLACK = np.array([0.0042, 0.0040, 0.0055])  #: XYZ relative to white, bluish


def screen(gammas=GAMMAS, black=BLACK, luminance=160.0, primaries=WIDE):
    """A monitor as readings give one: a curve a channel, and a black."""
    white = white_from_xy(D65)
    matrix = rgb_to_xyz_matrix(primaries, D65)
    xyz_from_rgb, floor = with_black(matrix * np.linalg.solve(matrix, white - black), black)
    curves = [ToneCurve(lambda d, gamma=gamma: d**gamma) for gamma in gammas]
    return Monitor(
        "made up", "readings", white, xyz_from_rgb, floor, Curves(tuple(curves)), luminance, True
    )


def shown(digital, gammas=GAMMAS, black=BLACK, primaries=WIDE):
    """XYZ (N, 3) of digital values by the closed form, white at Y = 1."""
    matrix, white = rgb_to_xyz_matrix(primaries, D65), white_from_xy(D65)
    light = np.asarray(digital) ** np.array(gammas)
    return black + light @ (matrix * np.linalg.solve(matrix, white - black)).T


def profile_file(folder, **numbers):
    """The profile of such a screen, in a file."""
    path = folder / "screen.icc"
    path.write_bytes(profile_of_monitor(screen(**numbers)))
    return str(path)


def to_d50(xyz, white):
    """XYZ under D50 of emitted XYZ (N, 3), as profiles have it."""
    return xyz @ adaptation_to_d50(white).T


def xicclu(path, values, *options):
    """What Argyll gives for values (N, 3), with six digits; its version 2.3 reads no ICC 4."""
    program = shutil.which("xicclu")
    if program is None:
        pytest.skip("xicclu is absent (argyll)")
    lines = "\n".join(" ".join(f"{v:.9f}" for v in row) for row in values)
    done = subprocess.run(
        [program, *options, str(path)],
        input=lines + "\n",
        capture_output=True,
        text=True,
        check=True,
    )
    rows = [line.split("->")[-1].split()[:3] for line in done.stdout.splitlines() if "->" in line]
    assert len(rows) == len(values), done.stdout + done.stderr
    return np.array(rows, dtype=float)
