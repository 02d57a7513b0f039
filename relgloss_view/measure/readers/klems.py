"""Angle bases of BSDF XML files: the patches of the hemisphere over which a BSDF is averaged.

A basis is a stack of rings between two polar angles, each cut into equal patches; the first patch
of a ring is centred at azimuth 0.

Sources: Klems 1994 (ASHRAE Transactions 100) and BSDF-v1.7.7.xsd of LBNL for the bases; Ward,
Radiance 6, for the bounds of those that a file need not define. (Radiance 4 and 5 had a
Half of 73 patches; its files define it.)
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from xml.etree.ElementTree import Element

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.xml import line_of

MOST_PATCHES = 500  #: of a basis; the finest in use has 145


@dataclass(frozen=True)
class Ring:
    """Patches between two polar angles, degrees."""

    lower: float
    upper: float
    count: int
    centre: float


@dataclass(frozen=True)
class Basis:
    """The patches of a hemisphere in the order of a matrix's rows or columns."""

    name: str
    rings: tuple[Ring, ...]

    @property
    def count(self) -> int:
        """Number of patches.

        >>> [basis.count for basis in known_bases().values()]
        [145, 77, 41]
        """
        return sum(ring.count for ring in self.rings)

    def centres(self) -> tuple[Array, Array]:
        """Polar angle and azimuth of the patches' centres, (count,) each, degrees."""
        theta = np.concatenate([np.full(ring.count, ring.centre) for ring in self.rings])
        phi = np.concatenate([360.0 * np.arange(ring.count) / ring.count for ring in self.rings])
        return theta, phi

    def at_horizon(self) -> Mask:
        """(count,), whether each patch reaches the horizon."""
        reach = [ring.upper > 90.0 - 1e-3 for ring in self.rings]
        return np.repeat(reach, [ring.count for ring in self.rings])

    def spread_deg(self) -> float:
        """Per-axis standard deviation of directions within a patch, degrees.

        Of a patch w wide it is w / sqrt(12), and of a disc of radius r it is r / 2. The root mean
        square over both axes and all patches that do not reach the horizon.

        >>> round(known_bases()["lbnl/klems full"].spread_deg(), 2)
        3.22
        """
        variance, count = 0.0, 0
        for ring in self.rings:
            if ring.upper > 90.0 - 1e-3 and len(self.rings) > 1:
                continue
            if ring.lower == 0.0 and ring.count == 1:
                of_one = (ring.upper / 2.0) ** 2
            else:
                across = math.sin(math.radians(ring.centre)) * 360.0 / ring.count
                of_one = ((ring.upper - ring.lower) ** 2 + across**2) / 24.0
            variance, count = variance + ring.count * of_one, count + ring.count
        return math.sqrt(variance / count)


def known_bases() -> dict[str, Basis]:
    """The bases that a file need not define, by their names in lower case."""
    rings = {
        "LBNL/Klems Full": (
            (0.0, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0),
            (1, 8, 16, 20, 24, 24, 24, 16, 12),
        ),
        "LBNL/Klems Half": (
            (0.0, 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90.0),
            (1, 8, 12, 16, 20, 12, 8),
        ),
        "LBNL/Klems Quarter": ((0.0, 9.0, 27.0, 45.0, 63.0, 90.0), (1, 8, 12, 12, 8)),
    }
    return {
        name.lower(): Basis(
            name,
            tuple(
                Ring(low, high, n, 0.5 * (low + high) if low else 0.0)
                for (low, high), n in zip(pairwise(bounds), counts, strict=True)
            ),
        )
        for name, (bounds, counts) in rings.items()
    }


def read_basis(element: Element, place: str) -> Basis:
    """The basis of an AngleBasis element. Raises InputError, which begins with `place`."""
    name = printable(element.findtext("AngleBasisName") or "", 60)
    rings: list[Ring] = []
    for block in element.iterfind("AngleBasisBlock"):
        where = f"{place}: line {line_of(block)}"
        bounds = block.find("ThetaBounds")
        if block.find("Phi") is not None or bounds is None:
            raise InputError(
                f"{where}: a patch of the angle basis {name!r} has no ThetaBounds; relgloss reads "
                "bases of rings (LBNL/Klems): export the BSDF in one of those"
            )
        lower = _number(bounds, "LowerTheta", where, rings[-1].upper if rings else 0.0)
        upper = _number(bounds, "UpperTheta", where)
        count = _number(block, "nPhis", where, 1.0)
        before = rings[-1].upper if rings else 0.0
        if not (abs(lower - before) < 1e-3 and lower < upper <= 90.0 + 1e-3):
            raise InputError(
                f"{where}: the ring from {lower:g} to {upper:g} deg does not continue that which "
                f"ends at {before:g} deg"
            )
        if count != int(count) or not 1 <= count <= MOST_PATCHES:
            raise InputError(f"{where}: nPhis {count:g}; expected 1 to {MOST_PATCHES}")
        middle = 0.0 if count == 1 and lower == 0.0 else 0.5 * (lower + upper)
        centre = _number(block, "Theta", where, middle)
        inside = lower <= centre <= upper and not (count == 1 and lower == 0.0)
        rings.append(Ring(lower, min(upper, 90.0), int(count), centre if inside else middle))
    basis = Basis(name, tuple(rings))
    if not 1 <= basis.count <= MOST_PATCHES:
        raise InputError(
            f"{place}: line {line_of(element)}: the angle basis {name!r} has {basis.count} "
            f"patches; expected 1 to {MOST_PATCHES}"
        )
    return basis


def _number(parent: Element, tag: str, where: str, default: float | None = None) -> float:
    text = parent.findtext(tag)
    if text is None and default is not None:
        return default
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{where}: {tag} {printable(text or '', 20)!r}; expected a number")
    return value
