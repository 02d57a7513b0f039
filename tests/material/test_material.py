"""Material: its parts refuse what a file would be refused for, and say what a picture must say."""

from __future__ import annotations

from dataclasses import replace

import materials
import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material.material import Diffuse, FitRecord, Lobe, Material, Quality
from relgloss_view.measure.bands import RGB, Bands

GRAY = (0.5, 0.5, 0.5)


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: Diffuse("phong", GRAY), "model: expected one of lambert"),
        (lambda: Diffuse("lambert", (0.5, -0.1, 0.5)), "albedo[1]: expected an albedo"),
        (lambda: Diffuse("lambert", (0.5, 4.1, 0.5)), "albedo[1]"),
        (lambda: Diffuse("lambert", (float("nan"),) * 3), "albedo[0]"),
        (lambda: Diffuse("lambert", 0.5), "albedo: expected a list"),
        (lambda: Diffuse("eon", GRAY, 57.4), "sigma_deg"),
        (lambda: Lobe((1.0,), 0.0), "s_deg: expected a lobe width above 0"),
        (lambda: Lobe((1.0,), 40.1), "s_deg"),
        (lambda: Lobe((1.0,), float("nan")), "s_deg"),
        (lambda: Lobe((1.0,), 1.0, 0.99), "refractive_index"),
        (lambda: Lobe((1.0,), 1.0, 10.1), "refractive_index"),
        (lambda: Lobe((-0.1,), 1.0), "strength[0]"),
        (lambda: Lobe((1.1e6,), 1.0), "strength[0]"),
        (lambda: FitRecord(quality="fine"), "quality"),
        (lambda: Bands((500.0,)), "wavelengths_nm: expected two or more"),
        (lambda: Bands((500.0, 400.0)), "wavelengths_nm"),
        (lambda: Bands((500.0, 500.4)), "wavelengths_nm[1]: expected wavelengths at least 0.5"),
        (lambda: Bands((99.0, 500.0)), "wavelengths_nm[0]"),
        (lambda: material(RGB, GRAY[:2]), "diffuse.albedo: expected 3 values"),
        (lambda: material(RGB, GRAY, (Lobe((1.0, 1.0), 1.0),)), "specular[0].strength"),
        (lambda: material(RGB, GRAY, (Lobe((1.0,), 1.0),) * 3), "specular: expected a list"),
        (lambda: Material("\ud800", "x", RGB, Diffuse("lambert", GRAY)), "name: expected a text"),
        (lambda: Material("x", 3, RGB, Diffuse("lambert", GRAY)), "source: expected a text"),
    ],
)
def test_parts_check_themselves(make, says):
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(says)
    assert "found" in str(caught.value)


def material(bands, albedo, specular=(), fit=None, source="measured"):
    return Material("x", source, bands, Diffuse("lambert", albedo), specular, fit)


def test_numbers_of_numpy_become_plain_ones():
    lobe = Lobe(np.float32([1, 2, 0.5]), np.float64(3.0), 2)
    assert lobe.strength == (1.0, 2.0, 0.5)
    assert {type(v) for v in (*lobe.strength, lobe.s_deg, lobe.refractive_index)} == {float}


@pytest.mark.parametrize(
    ("quality", "texts", "grounds", "count"),
    [
        ("good", (), 0, 0),
        ("poor", (), 0, 1),
        ("poor", ("dark",), 0, 2),
        ("poor", ("a poor lamp",), 0, 2),  # a word of a warning decides nothing
        ("poor", ("no model describes this sample",), 1, 1),
        ("unidentifiable", (), 0, 1),
        ("unidentifiable", ("s is unidentifiable, at most 1 deg",), 1, 1),
    ],
)
def test_a_doubtful_fit_always_has_a_warning(quality, texts, grounds, count):
    fit = FitRecord(quality=quality, warnings=texts, grounds=texts[:grounds])
    assert fit.quality is Quality(quality)
    warnings = material(RGB, GRAY, (), fit).warnings
    assert len(warnings) == count
    assert quality == "good" or any(
        word in " ".join(warnings) for word in (quality, "no model describes")
    )


def test_marks_are_fields():
    """What the source says does not matter to a material that a program makes."""
    plain = material(RGB, GRAY, source="synthetic, hypothetical: made up")
    assert not plain.synthetic
    assert not plain.hypothetical
    assert replace(plain, synthetic=True).synthetic
    assert materials.flat().synthetic
