"""Quantities that a table may hold, and their conversion to radiance factors."""

from __future__ import annotations

import re

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable

RADIANCE_FACTOR = "radiance-factor"  #: pi f_r; 1 is the perfect diffuser
BRDF = "brdf"  #: f_r, 1/sr
BRDF_COS = "brdf-cos"  #: f_r cos(theta_r), 1/sr
RADIANCE_FACTOR_PERCENT = "radiance-factor-percent"  #: 100 pi f_r; 100 is the perfect diffuser
QUANTITIES = (RADIANCE_FACTOR, BRDF, BRDF_COS, RADIANCE_FACTOR_PERCENT)
#: Other words for them: CIE 17.4 (reflectance factor), Nicodemus 1977 (BRF), ASTM E2387 (CCBRDF).
_SYNONYMS = {
    "reflectance-factor": RADIANCE_FACTOR,
    "bidirectional-reflectance-factor": RADIANCE_FACTOR,
    "brf": RADIANCE_FACTOR,
    "percent": RADIANCE_FACTOR_PERCENT,
    "reflectance-factor-percent": RADIANCE_FACTOR_PERCENT,
    "brdfcos": BRDF_COS,
    "ccbrdf": BRDF_COS,
    "cosine-corrected-brdf": BRDF_COS,
}
_UNITS = re.compile(r"[\[(]?\s*(1\s*/\s*sr|sr\s*\^?\s*-1|dimensionless|-)\s*[\])]?$")


def canonical_quantity(quantity: str, where: str) -> str:
    """The quantity in its canonical spelling; InputError, naming `where`, for any other word.

    >>> canonical_quantity(" BRDF-cos ", "--quantity"), canonical_quantity("BRDF [1/sr]", "")
    ('brdf-cos', 'brdf')
    >>> canonical_quantity("Radiance factor (%)", "")
    'radiance-factor-percent'
    """
    words = " ".join(quantity.split())[:100].strip('"').lower()
    words = re.sub(r"[\[(]?\s*(\bin\s+)?(%|\bpercent)\s*[\])]?$", " percent", words)
    words = re.sub(r"[\s_*-]+", "-", _UNITS.sub("", words).strip()).strip("-")
    canonical = _SYNONYMS.get(words, words)
    if canonical not in QUANTITIES:
        raise InputError(
            f"{where}: unknown quantity {printable(quantity, 40)!r}; "
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
    if quantity == RADIANCE_FACTOR_PERCENT:
        return np.asarray(values / 100.0)
    if quantity == BRDF:
        return np.asarray(np.pi * values)
    above = cos_r > 0.0
    scale = np.full(cos_r.shape, np.nan)
    # A subnormal cosine would overflow; anything this close to the horizon is masked anyway.
    scale[above] = np.pi / np.maximum(cos_r[above], 1e-12)
    return np.asarray(values * scale[:, None])
