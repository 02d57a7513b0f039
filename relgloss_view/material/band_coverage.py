"""How well the bands of a table carry colour: what of the eye's sensitivity they leave to a guess.

Between bands a reflectance is interpolated, and beyond the outer ones it is constant. Both are safe
where bands are close and reach over the visible range. The limits here follow from the 24 patches
of ISO 17321-1 under D65: the worst patch is off by 0.8 dE2000 where 14 % of Z lies beyond the bands
(430 to 670 nm), by 1.9 with bands 40 nm apart, and by 4 with 50 nm.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.material.spectra import observer
from relgloss_view.measure.bands import Bands

WIDEST_NM = 50.0  #: between two bands that carry colour
HALF_BAND_NM = 10.0  #: of the widest bands of common instruments
GUESSED = 0.1  #: share of X, Y or Z that may lie beyond the bands, or in wider gaps


@lru_cache(maxsize=64)
def coverage_warnings(bands: Bands) -> tuple[str, ...]:
    """The warnings of bands that can't carry colour, with figures; none for linear sRGB.

    A share is that of X, Y or Z of the perfect diffuser under equal energy, whichever is largest.

    >>> coverage_warnings(Bands(tuple(range(400, 701, 10))))
    ()
    >>> print(coverage_warnings(Bands((600.0, 650.0, 700.0)))[0])  # doctest: +ELLIPSIS
    the bands (600 to 700 nm) leave out 100 % of Z and 76 % of Y: colour beyond them is a guess, ...
    """
    if bands.is_rgb:
        return ()
    centres = [float(v) for v in bands.centres_nm()]
    steps = [float(v) for v in np.diff(centres)]
    texts = []
    # A band stands for its half of the step to the next, as far as instruments' bands are wide.
    low = centres[0] - min(0.5 * steps[0], HALF_BAND_NM)
    high = centres[-1] + min(0.5 * steps[-1], HALF_BAND_NM)
    wavelengths = observer()[:, 0]
    outside = _shares((wavelengths < low) | (wavelengths > high))
    if np.max(outside) > GUESSED:
        texts.append(
            f"the bands ({centres[0]:g} to {centres[-1]:g} nm) leave out {_words(outside)}: colour "
            "beyond them is a guess, as if reflectance went on unchanged; measure from 400 to 700 "
            "nm or wider"
        )
    wide = [k for k in range(len(steps)) if steps[k] > WIDEST_NM]
    gaps = np.zeros(len(wavelengths), dtype=bool)
    for k in wide:
        gaps |= (wavelengths > centres[k]) & (wavelengths < centres[k + 1])
    between = _shares(gaps)
    if np.max(between) > GUESSED:
        widest = max(wide, key=lambda k: float(np.sum(_within(centres[k], centres[k + 1]))))
        texts.append(
            f"bands {steps[widest]:g} nm apart ({centres[widest]:g} and {centres[widest + 1]:g} "
            f"nm): gaps wider than {WIDEST_NM:g} nm hold {_words(between)}, so colour is a guess; "
            "measure bands 20 nm apart or closer"
        )
    return tuple(texts)


def _within(low: float, high: float) -> Array:
    """Shares of X, Y and Z between two wavelengths, (3,)."""
    wavelengths = observer()[:, 0]
    return _shares((wavelengths > low) & (wavelengths < high))


def _shares(chosen: Mask) -> Array:
    """Shares of X, Y and Z under equal energy at the chosen wavelengths of the observer, (3,)."""
    functions = observer()[:, 1:]
    return np.asarray(np.sum(functions[chosen], axis=0) / np.sum(functions, axis=0))


def _words(shares: Array) -> str:
    """The largest shares in words, such as '82 % of Y and 61 % of X'."""
    order = sorted(range(3), key=lambda k: -shares[k])[:2]
    named = [f"{100.0 * shares[k]:.0f} % of {'XYZ'[k]}" for k in order if shares[k] > 0.5 * GUESSED]
    return " and ".join(named)
