"""Polarised BRDFs: mitsuba's measured_polarized plug-in, hand-computed values, hostile files."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from files import CODES, tensor_file

from relgloss_view.base.errors import InputError
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers import pbsdf, read_measurement
from relgloss_view.measure.readers import tensor_file as container
from relgloss_view.measure.readers.recognised import is_table

CODES.setdefault("u2", 3)
NM = np.array([450, 500, 550, 600, 650], np.uint16)


def fields(shape=(9, 5, 7), seed=0, **changes):
    """A made file: axes of uneven steps, matrices of random numbers."""
    rng = np.random.default_rng(seed)
    phi, diff, half = shape
    made = {
        "phi_d": np.linspace(-np.pi, np.pi, phi, dtype=np.float32)[None],
        "theta_d": (np.linspace(0.0, 1.0, diff) ** 1.2 * 0.5 * np.pi)[None].astype(np.float32),
        "theta_h": (np.linspace(0.0, 1.0, half) ** 2 * 0.5 * np.pi)[None].astype(np.float32),
        "wvls": NM,
        "M": rng.uniform(0.05, 0.3, (*shape, len(NM), 4, 4)).astype(np.float32),
    }
    made.update(changes)
    return {name: value for name, value in made.items() if value is not None}


def written(tmp_path, content, name="made.pbsdf"):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else tensor_file(content))
    return path


def test_against_mitsuba(tmp_path):
    """The plug-in at random directions; M[0, 0] is what it shows without polarisation."""
    mi = pytest.importorskip("mitsuba")
    path = written(tmp_path, fields())
    brdf = pbsdf.load(path)
    mi.set_variant("scalar_rgb")
    rng = np.random.default_rng(3)
    i, o = rng.normal(size=(2, 300, 3))
    i[:, 2], o[:, 2] = np.abs(i[:, 2]) + 0.1, np.abs(o[:, 2]) + 0.1
    o[150:] = i[150:] * [-1, -1, 1] + 0.1 * rng.normal(size=(150, 3))
    i, o = (v / np.linalg.norm(v, axis=1)[:, None] for v in (i, o))
    up = (i[:, 2] > 0.05) & (o[:, 2] > 0.05)
    i, o = i[up].astype(np.float32), o[up].astype(np.float32)
    found = brdf.evaluate(i, o) * o[:, 2:]
    for band in (0, 3):
        plugin = mi.load_dict(
            {
                "type": "measured_polarized",
                "filename": str(path),
                "wavelength": float(NM[band]),
            }
        )
        context, surface = mi.BSDFContext(), mi.SurfaceInteraction3f()
        # The plug-in's frame is that of `wo`, from which the light comes.
        expected, swapped = [], []
        for a, b in zip(i.tolist(), o.tolist(), strict=True):
            surface.wi = mi.Vector3f(*b)
            value = np.array(plugin.eval(context, surface, mi.Vector3f(*a))).ravel()[0]
            expected.append(value / a[2] * b[2])
            surface.wi = mi.Vector3f(*a)
            swapped.append(np.array(plugin.eval(context, surface, mi.Vector3f(*b))).ravel()[0])
        error = np.abs(found[:, band] - expected) / np.array(expected)
        # The plug-in's arc cosine of a float32 is off by up to 3e-4 rad at the pole, where the
        # finest cell, 0.04 rad wide, changes by up to its own value; elsewhere by 1e-6.
        assert np.median(error) < 1e-6
        assert np.max(error) < 8e-3
        # These random numbers are not reciprocal: lamp and eye exchanged would show.
        assert np.median(np.abs(found[:, band] - swapped) / np.array(swapped)) > 0.05


def test_nodes_and_between_by_hand(tmp_path):
    """Mirror directions lie on the axis theta_h = 0, where theta_d is the incidence."""
    made = fields(shape=(1, 3, 2))
    made["phi_d"] = np.zeros((1, 1), np.float32)
    made["theta_d"] = np.radians([[0.0, 40.0, 80.0]]).astype(np.float32)
    made["M"][:] = 99.0
    made["M"][0, :, 0, :, 0, 0] = [[0.1] * 5, [0.2] * 5, [0.6] * 5]
    brdf = pbsdf.load(written(tmp_path, made))
    for incidence, value in ((0.0, 0.1), (40.0, 0.2), (60.0, 0.4), (85.0, 0.6)):
        mirror = brdf.evaluate(spherical(incidence, 180.0), spherical(incidence, 0.0))
        assert mirror == pytest.approx([value] * 5, abs=1e-5)
    made["M"][0, 1, 0, 2, 0, 0] = np.nan  # a node without a measurement spoils its cells alone
    brdf = pbsdf.load(written(tmp_path, made))
    at = [brdf.evaluate(spherical(t, 180.0), spherical(t, 0.0)) for t in (20.0, 60.0, 85.0)]
    assert [np.isnan(v).tolist() for v in at] == [
        [False, False, True, False, False],
        [False, False, True, False, False],
        [False] * 5,
    ]


def test_a_file_is_a_table_by_wavelength(tmp_path):
    made = fields()
    made["M"][:] = 0.0
    made["M"][..., 0, 0] = np.array([0.05, 0.1, 0.15, 0.2, 0.25]) / np.pi
    path = written(tmp_path, made)
    assert is_table(path)
    measured = read_measurement(path)
    assert measured.format == "a polarised .pbsdf"
    assert measured.bands.wavelengths_nm == (450.0, 500.0, 550.0, 600.0, 650.0)
    kept = measured.radiance_factor[measured.kept]
    assert kept == pytest.approx(np.tile([0.05, 0.1, 0.15, 0.2, 0.25], (len(kept), 1)), rel=1e-6)
    assert any("unpolarised light" in warning for warning in measured.warnings)


def test_a_large_file_is_read_in_parts(tmp_path, monkeypatch):
    path = written(tmp_path, fields())
    whole = container.read_element(path, "M", (0, 0), 10_000_000)
    monkeypatch.setattr(container, "PART_BYTES", 1000)  # 15 matrices of 64 bytes
    assert np.array_equal(container.read_element(path, "M", (0, 0), 10_000_000), whole)
    assert np.array_equal(whole, fields()["M"][..., 0, 0])
    other = container.read_element(path, "M", (2, 1), 10_000_000)
    assert np.array_equal(other, fields()["M"][..., 2, 1])


FAULTS = {
    "degrees": ({"theta_h": np.array([[0.0, 45.0, 90.0]], np.float32)}, "expected radians"),
    "order": ({"theta_d": np.array([[0.5, 0.1]], np.float32)}, "'theta_d' does not increase"),
    "not finite": ({"phi_d": np.array([[0.0, np.nan]], np.float32)}, "'phi_d' does not increase"),
    "square axis": ({"phi_d": np.zeros((2, 2), np.float32)}, "has shape 2x2, expected 1xN"),
    "no wavelengths": ({"wvls": None}, "field 'wvls' is missing"),
    "metres": ({"wvls": np.array([4e-7, 5e-7], np.float32)}, "wavelengths in nm"),
    "another shape": ({"theta_h": np.array([[0.0, 1.0]], np.float32)}, "9x5x2x5x4x4"),
    "integers": ({"M": np.ones((9, 5, 7, 5, 4, 4), np.uint8)}, "in floating point"),
    "flat": ({"M": np.ones(3, np.float32)}, "field 'M' has shape 3"),
    "huge": ({"M": np.full((9, 5, 7, 5, 4, 4), 1e30, np.float32)}, "which no BRDF reaches"),
    "empty": ({"M": np.full((9, 5, 7, 5, 4, 4), np.nan, np.float32)}, "none of the"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_file_at_fault_is_one_line(tmp_path, fault):
    changes, words = FAULTS[fault]
    path = written(tmp_path, fields(**changes))
    with pytest.raises(InputError) as caught:
        read_measurement(path)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert path.name in str(caught.value)


def test_a_file_that_is_cut_off_is_one_line(tmp_path):
    data = tensor_file(fields())
    for size in (40, 200, len(data) - 1):
        with pytest.raises(InputError, match=r"cut\.pbsdf"):
            read_measurement(written(tmp_path, data[:size], "cut.pbsdf"))


def test_a_claim_beyond_what_is_read_takes_no_memory(tmp_path):
    """A sparse file of 700 MB, whose matrices are more than are read."""
    path = tmp_path / "large.pbsdf"
    made = fields()
    made["M"] = np.zeros((1, 1, 1, 1, 1, 1), np.uint8)
    data = bytearray(tensor_file(made))
    at = data.index(b"\x01\x00M") + 3
    count = 43_750_000
    shape = struct.pack("<6Q", count, 1, 1, 1, 4, 4)
    data[at : at + 11] = struct.pack("<HBQ", 6, CODES["u1"], len(data))
    data[at + 11 : at + 11 + len(shape)] = shape
    with path.open("wb") as file:
        file.write(data)
        file.truncate(len(data) + 16 * count)
    with pytest.raises(InputError, match="numbers, at most 40000000 are read"):
        read_measurement(path)
