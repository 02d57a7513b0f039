"""The way back: a material of our lobes that shows the picture of another program's surface."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx
from relgloss_view.exchange.loss import Surface
from relgloss_view.exchange.ways import Family, Unknown, Way, ways_to_show
from relgloss_view.material.described import DescribedRecord
from relgloss_view.material.material import (
    S_DEG_DRAWN,
    S_DEG_MAX,
    SIGMA_DEG_MAX,
    Diffuse,
    Lobe,
    Material,
)
from relgloss_view.measure.bands import RGB

S_PER_ALPHA = 1.0 / ggx.ALPHA_PER_S
LARGEST_STRENGTH = 30.0
#: Most of a body where a description has none, or alpha where that is more: what the tails of GGX
#: look like far from the mirror direction.
NO_BODY = 0.05
#: Least width of a lobe over the narrowest that is stated. The core of GGX is as wide as a Gaussian
#: of alpha / 2, which is 0.6 of S_PER_ALPHA: what is narrower is in no description. A picture under
#: a lamp without extent and gloss meters hardly see such a spike, but distinctness of image does.
LEAST_WIDTH = 0.5


def refit_lobes(
    surface: Surface,
    *,
    name: str,
    source: str,
    model: str,
    parameters: dict[str, Any],
    colour: Sequence[float],
    alphas: Sequence[float],
    f0: Sequence[float] | None = None,
    index: float = 1.5,
    not_carried: tuple[str, ...] = (),
) -> Material:
    """A described material in linear sRGB that shows a surface's picture.

    model, parameters, not_carried: for the DescribedRecord. colour: linear sRGB of the diffuse
    part, to start from. alphas: GGX widths of the lobes, the main one first; f0: of a metal, index:
    of a dielectric.
    """
    widths = [_width_deg(alpha) for alpha in alphas] or [10.0]
    best, material = _nearest(surface, _families(name, source, colour, widths, f0, index))
    least = max(S_DEG_DRAWN, LEAST_WIDTH * min(widths))
    if any(lobe.s_deg < least for lobe in material.specular):
        families = _families(name, source, colour, widths, f0, index, least)
        best, material = _nearest(surface, families)
    record = DescribedRecord(model, dict(parameters), not_carried, best.loss.as_json())
    return _with_record(material, record)


def _nearest(surface: Surface, families: tuple[Family, ...]) -> tuple[Way, Material]:
    best, *_ = ways_to_show(surface, families)
    assert isinstance(best.surface, Material)
    return best, best.surface


def _with_record(material: Material, record: DescribedRecord) -> Material:
    return Material(
        material.name,
        material.source,
        material.bands,
        material.diffuse,
        material.specular,
        described=record,
    )


def _families(
    name: str,
    source: str,
    colour: Sequence[float],
    widths: list[float],
    f0: Sequence[float] | None,
    index: float,
    low: float = S_DEG_DRAWN,
) -> tuple[Family, ...]:
    high = S_DEG_MAX
    # A metal has no body. Without this bound a mirror's search can end at a gray one.
    tails = max(NO_BODY, math.radians(max(widths)) / S_PER_ALPHA)
    body = (
        *(Unknown(min(max(v, 0.005), 0.99), 0.0, 1.0 if v > 0.0 else tails) for v in colour),
        Unknown(5.0, 0.0, SIGMA_DEG_MAX),
    )
    main = Unknown(math.log(widths[0]), math.log(low), math.log(high))
    wide_deg = widths[1] if len(widths) > 1 else min(2.5 * widths[0], 0.9 * high)
    wide = Unknown(math.log(wide_deg), math.log(low), math.log(high))
    strength = Unknown(1.0, 0.0, LARGEST_STRENGTH)
    weak = Unknown(0.2, 0.0, LARGEST_STRENGTH)
    metal: tuple[float, ...] = ()
    if f0 is None:
        own: tuple[Unknown, ...] = (Unknown(min(max(index, 1.05), 3.5), 1.01, 4.0),)
    else:
        own = ()  # a metal's colour is stated; its strength and width are searched for
        metal = tuple(min(max(float(v), 0.0), 1.0) for v in f0)

    def make(x: Array) -> Material:
        diffuse = Diffuse("eon", tuple(float(v) for v in x[:3]), float(x[3]))
        count = len(body) + len(own)
        kind = x[len(body) : count]
        lobes = []
        for k in range(count, len(x), 2):
            s_deg = min(max(float(np.exp(x[k])), low), high)
            if f0 is None:
                lobes.append(Lobe((float(x[k + 1]),), s_deg, float(kind[0])))
            else:
                lobes.append(Lobe((float(x[k + 1]),), s_deg, f0=metal))
        return Material(name, source, RGB, diffuse, tuple(lobes))

    def whiter(x: Array) -> Material:
        """Two metal lobes between the stated colour and white, as a coat reflects that is white."""
        made = make(x[:-2])
        lobes = tuple(
            Lobe(lobe.strength, lobe.s_deg, f0=tuple(v + float(t) * (1.0 - v) for v in metal))
            for lobe, t in zip(made.specular, x[-2:], strict=True)
        )
        return Material(name, source, RGB, made.diffuse, lobes)

    def as_stated(x: Array) -> Material:
        """With the widths that the surface states: those of a mirror cannot be searched for."""
        count = len(body) + len(own)
        pairs = [(np.log(s_deg), value) for s_deg, value in zip(widths, x[count:], strict=True)]
        return make(np.concatenate([x[:count], *pairs]))

    one = (*body, *own, main, strength)
    strengths = [strength for _ in widths]
    share = Unknown(0.0, 0.0, 1.0)
    coated = (
        (Family("two lobes, one whiter", (*one, wide, weak, share, share), whiter),)
        if f0 is not None and len(widths) > 1
        else ()
    )
    return (
        Family("one lobe", one, make),
        Family("two lobes", (*one, wide, weak), make),
        Family("lobes of the stated widths", (*body, *own, *strengths), as_stated),
        *coated,
    )


def _width_deg(alpha: float) -> float:
    return min(max(math.degrees(S_PER_ALPHA * alpha), 1.02 * S_DEG_DRAWN), 0.95 * S_DEG_MAX)
