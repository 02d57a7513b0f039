"""Quantities that a table may hold, and their conversion to radiance factors."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError

RADIANCE_FACTOR = "radiance-factor"  #: pi f_r; 1 is the perfect diffuser
BRDF = "brdf"  #: f_r, 1/sr
BRDF_COS = "brdf-cos"  #: f_r cos(theta_r), 1/sr
QUANTITIES = (RADIANCE_FACTOR, BRDF, BRDF_COS)


def canonical_quantity(quantity: str, where: str) -> str:
    """The quantity in its canonical spelling; InputError, naming `where`, for any other word.

    >>> canonical_quantity(" BRDF-cos ", "--quantity")
    'brdf-cos'
    """
    canonical = quantity.strip().lower()
    if canonical not in QUANTITIES:
        raise InputError(
            f"{where}: unknown quantity {quantity.strip()[:40]!r}; "
            f"give one of {', '.join(QUANTITIES)}"
        )
    return canonical


def to_radiance_factor(values: Array, quantity: str, cos_r: Array) -> Array:
    """Convert readings to radiance factors pi f_r (CIE 15), (N, B).

    values: (N, B), in the unit of the quantity. quantity: one of QUANTITIES. cos_r: (N,), cosine
    of the receiver's polar angle. Rows of f_r cos(theta_r) become NaN where the receiver is not
    above the horizon, because the cosine can't be divided out there.

    >>> to_radiance_factor(np.array([[0.25]]), "brdf", np.array([0.5])).round(4).tolist()
    [[0.7854]]
    >>> to_radiance_factor(np.array([[0.25]]), "brdf-cos", np.array([0.5])).round(4).tolist()
    [[1.5708]]
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
