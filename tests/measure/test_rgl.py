"""RGL files: closed forms, published spot values, and mitsuba's measured plug-in."""

from __future__ import annotations

import numpy as np
import pytest
from files import rgl_fields, tensor_file
from rgl_data import NAMES, rgl_file

from relgloss_view.base.errors import InputError
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.measure import table
from relgloss_view.measure.bands import RGB, WIDE_RGB
from relgloss_view.measure.gonio import spherical, tabulated_grid
from relgloss_view.measure.readers import read_measurement, rgl
from relgloss_view.measure.readers import tensor_file as tensor_file_reader

#: Green radiance factors of the data folder's README, as printed there.
SPOTS = {
    (45, 0): ("0.848", "0.697", "0.398", "0.040"),
    (0.5, 45): ("0.862", "0.701", "0.400", "0.040"),
    (45, 44.9): ("0.943", "9.311", "278.8", "13.10"),
    (60, 60): ("1.113", "30.01", "643.7", "13.82"),
    (20, 20): ("0.856", "4.334", "190.8", "14.08"),
    (60, 30): ("0.904", "0.736", "0.409", "0.143"),
    (75, 75): ("2.486", "377.2", "3466", "63.16"),
}


def hemisphere(rng, count):
    v = rng.normal(size=(count, 3))
    v /= np.linalg.norm(v, axis=1)[:, None]
    v[:, 2] = np.abs(v[:, 2])
    return v


@pytest.mark.parametrize("column", range(4), ids=NAMES)
def test_published_spot_values(column):
    brdf = rgl.load(rgl_file(NAMES[column]))
    for (incidence, viewing), row in SPOTS.items():
        printed = row[column]
        decimals = len(printed.partition(".")[2])
        value = np.pi * brdf.evaluate(spherical(incidence, 180), spherical(viewing, 0))[1]
        # Half a unit of the last printed digit, and the oracle's float32: up to 1e-4 on a peak.
        assert value == pytest.approx(float(printed), abs=0.5 * 10**-decimals, rel=1e-4)


@pytest.mark.parametrize("name", NAMES)
def test_against_mitsuba(name):
    mi = pytest.importorskip("mitsuba")
    path = rgl_file(name)
    mi.set_variant("scalar_rgb")
    plugin = mi.load_dict({"type": "measured", "filename": str(path)})
    rng = np.random.default_rng(7)
    i, o = hemisphere(rng, 1500), hemisphere(rng, 1500)
    # Two thirds around the mirror direction, where the lobe is.
    o[500:] = i[500:] * [-1, -1, 1] + 0.1 * rng.normal(size=(1000, 3))
    o /= np.linalg.norm(o, axis=1)[:, None]
    up = (i[:, 2] > 0.05) & (o[:, 2] > 0.05)
    i, o = i[up].astype(np.float32), o[up].astype(np.float32)

    context, surface = mi.BSDFContext(), mi.SurfaceInteraction3f()
    expected = []
    for a, b in zip(i.tolist(), o.tolist(), strict=True):
        surface.wi = mi.Vector3f(*a)
        expected.append(np.array(plugin.eval(context, surface, mi.Vector3f(*b))).ravel())
    expected = np.array(expected)
    found = rgl.load(path).evaluate(i, o) * o[:, 2:]

    # The oracle computes in float32: its half-vector is off by 1e-7, which a cell of the warped
    # grid in the lobe magnifies; 1e-3 of the brightest channel covers negative, near-zero ones.
    # Where nothing was measured both are exactly zero.
    scale = np.maximum(np.abs(expected), 1e-3 * np.abs(expected).max(axis=1, keepdims=True))
    dark = scale[:, 0] == 0.0
    np.testing.assert_array_equal(found[dark], 0.0)
    assert dark.mean() < 0.05
    scale[dark] = 1.0
    error = np.abs(found - expected) / scale
    assert np.quantile(error, 0.5) < 3e-6
    assert np.quantile(error, 0.99) < 2e-4
    assert error.max() < 5e-3
    # Negative control: the mirrored azimuth, an easy slip of the parameterisation, is seen.
    slip = rgl.load(path).evaluate(i, o * np.array([-1, -1, 1], np.float32)) * o[:, 2:]
    assert np.quantile(np.abs(slip - expected) / scale, 0.5) > 0.01


@pytest.mark.parametrize("jacobian", [0, 1])
def test_closed_form_of_an_unwarped_table(tmp_path, jacobian):
    # A uniform density warps nothing, so that the table is read at u = sqrt(2 theta_h / pi), and
    # bilinear interpolation reproduces a function that is linear in u and v.
    size = 8
    v, u = np.meshgrid(*2 * [np.linspace(0, 1, size)], indexing="ij")
    slices = np.array([1.0, 2.0, 3.0])[:, None, None, None]
    channel = np.array([1.0, 2.0, 4.0])[:, None, None]
    rgb = (slices * channel * (1 + u + 0.25 * v))[None].astype(np.float32)
    sigma, ndf = np.full((2, 4), 0.5, np.float32), np.full((2, 4), 3.0, np.float32)
    path = tmp_path / "t"
    path.write_bytes(
        tensor_file(
            rgl_fields(
                rgb=rgb, sigma=sigma, ndf=ndf, jacobian=np.array([jacobian], np.uint8),
                theta_i=np.array([0.0, 0.75, 1.5], np.float32),
            )
        )
    )  # fmt: skip
    brdf = rgl.load(path)
    rng = np.random.default_rng(3)
    i, o = hemisphere(rng, 200), hemisphere(rng, 200)
    half = (i + o) / np.linalg.norm(i + o, axis=1)[:, None]
    theta_i = np.arccos(i[:, 2])
    du = np.sqrt(np.arccos(half[:, 2]) * 2 / np.pi)
    phi = np.arctan2(half[:, 1], half[:, 0]) - np.arctan2(i[:, 1], i[:, 0])
    dv = np.mod((phi + np.pi) / (2 * np.pi), 1.0)
    level = 1 + np.minimum(theta_i, 1.5) / 0.75
    expected = (level * (1 + du + 0.25 * dv) / o[:, 2])[:, None] * [1, 2, 4]
    expected *= 3.0 / (4 * 0.5) if jacobian else 1.0
    # float32 nodes: 1e-7.
    np.testing.assert_allclose(brdf.evaluate(i, o), expected, rtol=1e-6)


def test_warp_carries_its_density_to_a_uniform_one():
    # The map's Jacobian is the density: compare with finite differences.
    from relgloss_view.measure.readers.unit_square import Warp, bilinear, find_slices

    rng = np.random.default_rng(2)
    warp = Warp.of(rng.uniform(0.2, 2.0, (2, 6, 5)))
    points = rng.uniform(0.02, 0.98, (400, 2))
    slices = find_slices(np.array([0.0, 1.0]), rng.uniform(0, 1, 400))
    # Central differences must not straddle a grid line: they are exact inside a patch only.
    h = 1e-6
    step_x, step_y = np.array([h, 0.0]), np.array([0.0, h])
    inside = np.all(np.abs(points * [4, 5] - np.rint(points * [4, 5])) > 1e-3, axis=1)
    dx = (warp.invert(points + step_x, slices) - warp.invert(points - step_x, slices)) / (2 * h)
    dy = (warp.invert(points + step_y, slices) - warp.invert(points - step_y, slices)) / (2 * h)
    jacobian = dx[:, 0] * dy[:, 1] - dx[:, 1] * dy[:, 0]
    # The density of the unit square counts patches, 4 x 5 of them.
    expected = bilinear(warp.density, points, slices) * 4 * 5
    np.testing.assert_allclose(jacobian[inside], expected[inside], rtol=1e-6)
    corners = warp.invert(np.array([[0.0, 0.0], [1.0, 1.0]]), find_slices(np.arange(2.0), [0, 1]))
    np.testing.assert_allclose(corners, [[0, 0], [1, 1]], atol=1e-12)


@pytest.mark.parametrize("name", NAMES)
def test_measurement_on_the_grid(name):
    path = rgl_file(name)
    m = read_measurement(path)
    assert len(m.reasons) == len(tabulated_grid())
    assert m.kept.mean() > 0.95
    outside = name in ("cg_sunflower", "vch_golden_yellow")
    assert m.bands == (WIDE_RGB if outside else RGB)
    assert m.name
    assert path.name in m.source
    assert (m.radiance_factor[m.kept] >= 0).all()
    np.testing.assert_array_equal(np.unique(m.group), np.arange(0, 71, 10))
    np.testing.assert_allclose(np.linalg.norm(m.to_lamp, axis=1), 1, rtol=1e-14)
    # The mirror geometry is where the scan says: at 60/60 the half-vector is the normal.
    k = np.flatnonzero((tabulated_grid() == [60, 60, 180]).all(axis=1))[0]
    np.testing.assert_allclose((m.to_lamp + m.to_receiver)[k, :2], 0, atol=1e-15)
    green = (m.radiance_factor[k] @ xyz(m.bands) @ np.linalg.inv(xyz(RGB)))[1]
    assert green == pytest.approx(float(SPOTS[60, 60][NAMES.index(name)]), rel=1e-3)
    assert any("outside sRGB" in w for w in m.warnings) == outside


def xyz(bands):
    return xyz_weights(bands, illuminant("D65"))


@pytest.mark.parametrize("name", NAMES)
def test_no_colour_is_cut(name):
    """XYZ of the samples is that of the file, negative channels of sRGB included."""
    path = rgl_file(name)
    m = read_measurement(path)
    stored = np.pi * rgl.load(path).evaluate(m.to_lamp, m.to_receiver)
    kept, expected = m.kept, stored @ xyz(RGB)
    found = m.radiance_factor[kept] @ xyz(m.bands)
    np.testing.assert_allclose(found, expected[kept], rtol=2e-4, atol=1e-9)
    # Negative control: cut to zero, the saturated colours are others.
    cut = np.maximum(stored, 0.0) @ xyz(RGB)
    moved = np.max(np.abs(cut - expected)[kept] / expected[kept])
    assert (moved > 0.05) == bool(np.any(stored[kept] < 0.0))


def test_unseen_and_negative_samples_are_masked(tmp_path):
    path = tmp_path / "t.csv"  # the name does not decide
    rgb = np.full((1, 3, 3, 8, 8), 0.5, np.float32)
    rgb[..., 4:] = 0.0  # half-vectors far from the normal
    path.write_bytes(tensor_file(rgl_fields(rgb=rgb)))
    m = read_measurement(path)
    assert set(m.left_out()) == {table.MISSING}
    assert m.kept.any()
    rgb[..., 4:] = -0.5
    path.write_bytes(tensor_file(rgl_fields(rgb=rgb)))
    assert table.NEGATIVE in read_measurement(path).left_out()


def test_below_the_horizon_is_dark(tmp_path):
    path = tmp_path / "t"
    path.write_bytes(tensor_file(rgl_fields()))
    brdf = rgl.load(path)
    up, down, flat = [0, 0, 1.0], [0, 0, -1.0], [1.0, 0, 0]
    for i, o in [(up, down), (down, up), (flat, up), (up, flat), (down, down)]:
        np.testing.assert_array_equal(brdf.evaluate(i, o), 0.0)
    assert (brdf.evaluate(up, up) > 0).all()


def test_arguments_that_mean_nothing_are_named(tmp_path):
    path = tmp_path / "t"
    path.write_bytes(tensor_file(rgl_fields()))
    assert read_measurement(path, quantity="brdf").warnings == ()
    warnings = read_measurement(path, quantity="brdf-cos", gamma_s_deg=0).warnings
    assert len(warnings) == 2
    assert "--quantity" in warnings[0]
    assert "--gamma-s-deg" in warnings[1]


def spectral_fields(size=8, wavelengths=(400.0, 500.0, 600.0), **changes):
    """The fields of a spectral file whose table is 0.1 for the first wavelength, 0.2, ..."""
    count = len(wavelengths)
    values = 0.1 * np.arange(1, count + 1, dtype=np.float32)[None, None, :, None, None]
    made: dict[str, object] = {
        "rgb": None,
        "wavelengths": np.array(wavelengths, np.float32),
        "spectra": np.broadcast_to(values, (1, 3, count, size, size)).astype(np.float32),
    }
    return rgl_fields(size, **(made | changes))


def test_a_spectral_file_gives_the_bands_that_an_eye_sees(tmp_path):
    path = tmp_path / "made_spec.bsdf"
    path.write_bytes(tensor_file(spectral_fields()))
    m = read_measurement(path)
    assert m.bands.wavelengths_nm == (400, 500, 600)
    assert m.tabulated
    path.write_bytes(tensor_file(rgl_fields()))
    rgb = read_measurement(path)  # the same warp, 0.5 throughout
    np.testing.assert_array_equal(m.kept, rgb.kept)
    ratio = m.radiance_factor[m.kept] / rgb.radiance_factor[m.kept]
    np.testing.assert_allclose(ratio, np.tile([0.2, 0.4, 0.6], (m.kept.sum(), 1)), rtol=1e-6)

    nm = np.linspace(360.0, 1000.0, 195)
    path.write_bytes(tensor_file(spectral_fields(4, nm)))
    m = read_measurement(path)
    kept = np.array(m.bands.wavelengths_nm)
    assert 380 <= kept.min() < 386
    assert 774 < kept.max() <= 780
    assert np.diff(kept).min() >= 5
    assert set(kept) <= set(np.float32(nm).astype(float))
    assert any(f"{len(kept)} of 195 wavelengths" in w for w in m.warnings)


SPECTRAL_FAULTS = {
    "order": ({"wavelengths": np.array([400, 600, 500], np.float32)}, "does not increase"),
    "unseen": ({"wavelengths": np.array([900, 950, 990], np.float32)}, "has 0 from 380 to 780"),
    "counts": ({"spectra": np.ones((1, 3, 2, 8, 8), np.float32)}, "expected 1x3x3xNxN"),
    "shape": ({"spectra": np.ones((3, 8), np.float32)}, "field 'spectra' has shape 3x8"),
    "missing": ({"spectra": None}, "field 'spectra' is missing"),
    "not finite": (
        {"spectra": np.full((1, 3, 3, 8, 8), np.inf, np.float32)},
        "holds a NaN or an infinity",
    ),
}


@pytest.mark.parametrize("fault", SPECTRAL_FAULTS)
def test_a_spectral_file_at_fault_is_one_line(tmp_path, fault):
    changes, words = SPECTRAL_FAULTS[fault]
    path = tmp_path / "made_spec.bsdf"
    path.write_bytes(tensor_file(spectral_fields(**changes)))
    with pytest.raises(InputError) as caught:
        read_measurement(path)
    assert words in str(caught.value)


@pytest.mark.parametrize("name", NAMES[1:3])
def test_spectra_against_mitsuba(name, tmp_path):
    """The measured file's own table under a made spectrum, as mitsuba's plug-in evaluates it."""
    mi = pytest.importorskip("mitsuba")
    fields, _ = tensor_file_reader.read(rgl_file(name), (*rgl.FIELDS, "rgb", "luminance", "phi_i"))
    nm = np.array([400.0, 450.0, 520.0, 600.0, 690.0], np.float32)
    mix = np.array([[0, 0, 1], [0.1, 0.2, 0.9], [0, 1, 0], [0.8, 0.2, 0], [1, 0, 0]], np.float32)
    mixed = np.einsum("wc,atcij->atwij", mix, np.abs(fields.pop("rgb")))
    path = tmp_path / "mixed_spec.bsdf"
    path.write_bytes(tensor_file(fields | {"wavelengths": nm, "spectra": mixed}))

    mi.set_variant("scalar_spectral")
    plugin = mi.load_dict({"type": "measured", "filename": str(path)})
    rng = np.random.default_rng(3)
    i, o = hemisphere(rng, 200), hemisphere(rng, 200)
    o[80:] = i[80:] * [-1, -1, 1] + 0.1 * rng.normal(size=(120, 3))
    o /= np.linalg.norm(o, axis=1)[:, None]
    up = (i[:, 2] > 0.05) & (o[:, 2] > 0.05)
    i, o = i[up].astype(np.float32), o[up].astype(np.float32)
    context, surface = mi.BSDFContext(), mi.SurfaceInteraction3f()
    surface.wavelengths = nm[:4].tolist()  # four at once; the last one's row is not looked at
    expected = []
    for a, b in zip(i.tolist(), o.tolist(), strict=True):
        surface.wi = mi.Vector3f(*a)
        expected.append(np.array(plugin.eval(context, surface, mi.Vector3f(*b))).ravel())
    expected = np.array(expected)
    brdf = rgl.load(path)
    np.testing.assert_array_equal(brdf.wavelengths_nm, nm)
    found = (brdf.evaluate(i, o) * o[:, 2:])[:, :4]
    scale = np.maximum(np.abs(expected), 1e-3 * np.abs(expected).max(axis=1, keepdims=True))
    lit = scale[:, 0] > 0.0
    assert lit.mean() > 0.9
    error = np.abs(found - expected)[lit] / scale[lit]
    assert np.quantile(error, 0.5) < 5e-6
    assert error.max() < 5e-3
    # Negative control: bands in another order are seen.
    assert np.median(np.abs(found[:, ::-1] - expected)[lit] / scale[lit]) > 0.05
