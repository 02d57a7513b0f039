"""What the numbers of a table mean, and how they become radiance factors."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.errors import InputError

Array = NDArray[np.float64]

RADIANCE_FACTOR = "radiance-factor"  #: pi f_r; 1 is the perfect diffuser
BRDF = "brdf"  #: f_r, 1/sr
BRDF_COS = "brdf-cos"  #: f_r cos(theta_r), 1/sr
QUANTITIES = (RADIANCE_FACTOR, BRDF, BRDF_COS)


def known(quantity: str, where: str) -> str:
    """Return the quantity in its canonical spelling; raises InputError, naming `where`."""
    canonical = quantity.strip().lower()
    if canonical not in QUANTITIES:
        raise InputError(
            f"{where}: unknown quantity {quantity.strip()[:40]!r}; "
            f"give one of {', '.join(QUANTITIES)}"
        )
    return canonical


def to_radiance_factor(values: Array, quantity: str, cos_r: Array) -> Array:
    """Turn readings into radiance factors pi f_r (CIE 15).

    values is (N, B) and cos_r (N,) the cosine of the receiver's polar angle. f_r cos(theta_r) says
    nothing about f_r where the receiver is not above the horizon: those rows become NaN.
    """
    if quantity == RADIANCE_FACTOR:
        return values
    if quantity == BRDF:
        return np.asarray(np.pi * values)
    above = cos_r > 0.0
    scale = np.full(cos_r.shape, np.nan)
    # A subnormal cosine would overflow; anything this close to the horizon is masked anyway.
    scale[above] = np.pi / np.maximum(cos_r[above], 1e-12)
    return np.asarray(values * scale[:, None])
