"""Bands that carry colour, held against what the patches of ISO 17321-1 lose through them."""

from __future__ import annotations

import materials
import numpy as np
import pytest

from relgloss_view.material import spectra
from relgloss_view.material.band_coverage import coverage_warnings
from relgloss_view.material.material import Diffuse, Material
from relgloss_view.measure.bands import RGB, Bands
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000

colour = pytest.importorskip("colour")
FINE = np.arange(380.0, 781.0, 5.0)


def steps(low, high, step):
    return tuple(float(v) for v in np.arange(low, high + 0.1, step))


#: Bands and whether they warn.
TABLES = [
    (steps(400, 700, 10), False),
    (steps(380, 780, 5), False),
    (steps(390, 730, 10), False),
    (steps(420, 680, 20), False),
    (steps(400, 700, 50), False),
    ((600.0, 650.0, 700.0), True),
    ((640.0, 640.5), True),
    ((380.0, 500.0, 501.0, 502.0, 780.0), True),
    ((450.0, 550.0, 650.0), True),
    (steps(450, 650, 10), True),
    ((*steps(400, 560, 10), 700.0), True),
    ((1000.0, 2000.0), True),
]


def worst_patch(bands):
    """Largest dE2000 of the patches seen through the bands, under D65."""
    patches = np.array(
        [
            patch.copy().align(colour.SpectralShape(380, 780, 5)).values
            for patch in colour.SDS_COLOURCHECKERS["ISO 17321-1"].values()
        ]
    )
    lamp = spectra.illuminant("D65")

    def lab(places):
        seen = np.array([np.interp(places, FINE, patch) for patch in patches])
        xyz = seen @ spectra.xyz_weights(Bands(tuple(places)), lamp)
        return tone.lab_from_xyz(np.maximum(xyz, 0.0), lamp.white_xyz())

    return float(np.max(delta_e_2000(lab(np.array(bands)), lab(FINE))))


@pytest.mark.parametrize(("bands", "warns"), TABLES)
def test_bands_that_lose_colour_warn(bands, warns):
    texts = coverage_warnings(Bands(bands))
    assert bool(texts) == warns
    assert all("%" in text and " nm" in text for text in texts)
    lost = worst_patch(bands)
    assert lost > 1.5 if warns else lost < 4.5


def test_figures_are_those_of_the_observer():
    """CIE 1931 has 76 % of Y below 590 nm, where bands of 600 to 700 nm begin to see."""
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    y = observer.values[:, 1]
    share = (
        100.0 * np.sum(y[(observer.wavelengths < 590) | (observer.wavelengths > 710)]) / np.sum(y)
    )
    assert f"{share:.0f} % of Y" in coverage_warnings(Bands((600.0, 650.0, 700.0)))[0]


def test_a_picture_carries_the_warning():
    assert coverage_warnings(RGB) == ()
    assert materials.paper("art").warnings == ()
    bands = Bands((600.0, 650.0, 700.0))
    red = Material("red", "synthetic", bands, Diffuse("lambert", (0.5, 0.5, 0.5)))
    assert red.warnings == coverage_warnings(bands)
