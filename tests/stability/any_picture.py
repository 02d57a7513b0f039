"""Scenes, looks and methods that hypothesis makes: every entry anywhere in its declared range."""

from __future__ import annotations

import dataclasses

from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.material.material import (
    ALBEDO_MAX,
    INDEX_RANGE,
    S_DEG_MAX,
    SIGMA_DEG_MAX,
    STRENGTH_MAX,
    Diffuse,
    Lobe,
    Material,
)
from relgloss_view.material.spectra import SHIPPED_ILLUMINANTS
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.method import Method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

#: Few bands: what a picture does depends on them by three sums alone.
BANDS = (RGB, Bands(tuple(float(w) for w in range(400, 701, 50))))
SIZES = ((1, 1), (2, 3), (33, 17), (24, 40))


def values(f):
    """A strategy for one field by what it declares; small and large numbers as often."""
    meta = f.metadata
    if "options" in meta:
        made = st.sampled_from(meta["options"])
    elif "range" in meta:
        low, high = meta["range"].low, meta["range"].high
        made = st.integers(low, high) if meta.get("whole") else numbers(low, high, f.default)
    elif f.name == "illuminant":
        made = st.sampled_from((*SHIPPED_ILLUMINANTS, "FL11"))
    else:
        made = st.just(f.default)
    return made | st.none() if meta.get("optional") else made


def numbers(low, high, usual=None):
    """Anywhere in a range, at its ends, at an exponent of it, or as usual."""
    made = st.floats(low, high) | st.sampled_from((low, high))
    if high > 1e3 * max(abs(low), 1e-30):
        made = made | st.integers(-12, 12).map(lambda k: min(max(10.0**k, low), high))
    return made if usual is None else made | st.just(usual)


def parts(kind, **fixed):
    """A strategy for a frozen dataclass; combinations that it refuses are left out."""
    named = {f.name: values(f) for f in dataclasses.fields(kind)} | fixed
    return st.fixed_dictionaries(named).map(lambda v: _made(kind, v)).filter(bool)


def _made(kind, entries):
    try:
        made = kind(**entries)
        # A black may contradict a white that only a setup assumes.
        return Setup(display=made).display if kind is Display else made
    except InputError:
        return None


@st.composite
def materials(draw):
    bands = draw(st.sampled_from(BANDS))
    spectrum = st.lists(numbers(0.0, ALBEDO_MAX, 0.3), min_size=bands.count, max_size=bands.count)
    diffuse = Diffuse(
        draw(st.sampled_from(("lambert", "oren-nayar", "eon"))),
        tuple(draw(spectrum)),
        draw(numbers(0.0, SIGMA_DEG_MAX, 6.0)),
    )
    low = 5e-324 if draw(st.booleans()) else 0.05
    lobes = st.builds(
        Lobe,
        st.tuples(numbers(0.0, STRENGTH_MAX, 1.0)),
        numbers(low, S_DEG_MAX, 5.0),
        numbers(*INDEX_RANGE, 1.5),
    )
    specular = tuple(draw(st.lists(lobes, max_size=2)))
    return Material("any", "synthetic", bands, diffuse, specular, synthetic=True)


def scenes():
    display = Display(transfer="gain-offset-gamma", gain=0.98, offset=0.02, gamma=2.3, flare=0.003)
    return st.builds(
        Scene,
        materials(),
        shape=parts(Shape),
        lamp=parts(Lamp),
        eye=parts(Eye),
        display=st.just(Display()) | st.just(display) | parts(Display),
    )


def looks():
    return parts(Look, samples=st.sampled_from((1, 1, 1, 3, None)))


def methods():
    """All exact, or every axis by chance."""
    return st.just(Method()) | parts(Method)
