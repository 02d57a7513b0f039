"""Zemax BSDF: closed forms of its directions, the real file's own TIS, and damaged files."""

from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import read_measurement, zemax

REAL = Path(__file__).resolve().parents[3] / "shared/data/formats/planesymmetric_zemax.bsdf"
AZIMUTHS, RADIALS = (0, 90, 180), (0, 10, 40)


def text(values, spectral="Monochrome", kind="BRDF", rotations="1\n0", incidences="2\n20 60"):
    """A file of two incidences; values: of each incidence, or of X, Y and Z each."""
    head = (
        f"#made\nSource  Measured\nSymmetry  PlaneSymmetrical\nSpectralContent  {spectral}\n"
        f"ScatterType  {kind}\nSampleRotation  {rotations}\nAngleOfIncidence {incidences}\n"
        "ScatterAzimuth 3\n0\t90\t180\nScatterRadial 3\n0 10\n40\t\n\n"
    )
    names = ["Monochrome"] if spectral == "Monochrome" else [f"Tristimulus{c}" for c in "XYZ"]
    blocks = []
    for name, channel in zip(names, values, strict=True):
        rows = [
            "TIS 0.1\n" + "".join(" ".join(f"{x:.4E}" for x in row) + "\n" for row in one)
            for one in np.broadcast_to(channel, (2, 3, 3)).tolist()
        ]
        blocks.append(f"{name}\nDataBegin\n{''.join(rows)}DataEnd\n")
    return head + "".join(blocks)


def made(tmp_path, content):
    path = tmp_path / "a.bsdf"
    path.write_text(content)
    return path


def test_directions_and_values(tmp_path):
    """By the law of cosines on the sphere, with azimuth 0 from the mirror direction inwards."""
    values = 0.01 * np.arange(1.0, 19.0).reshape(2, 3, 3)
    values[:, :, 0] = values[:, :1, 0]  # one direction
    m = read_measurement(made(tmp_path, text([values])))
    rows = {}
    for k, incidence in enumerate((20, 60)):
        for j, azimuth in enumerate(AZIMUTHS):
            for n, radial in enumerate(RADIALS):
                if radial or not azimuth:
                    a, r = np.radians(incidence), np.radians(radial)
                    cosine = np.cos(a) * np.cos(r) + np.sin(a) * np.sin(r) * np.cos(
                        np.radians(azimuth)
                    )
                    key = (round(np.cos(a), 6), round(np.cos(r), 6), round(cosine, 6))
                    rows[key] = values[k, j, n]
    mirror = m.to_lamp * [-1.0, -1.0, 1.0]
    keys = np.stack(
        [m.to_lamp[:, 2], np.sum(mirror * m.to_receiver, axis=1), m.to_receiver[:, 2]], axis=1
    ).round(6)
    found = {
        tuple(key): x / np.pi for key, x in zip(keys.tolist(), m.radiance_factor[:, 1], strict=True)
    }
    assert found == pytest.approx(rows, rel=1e-9)
    # 60 + 40 degrees is below the horizon, and is left out.
    assert m.left_out() == {"below the horizon": 1}


def test_zeros_are_no_readings(tmp_path):
    values = np.full((2, 3, 3), 0.1)
    values[0, 1, 2] = 0.0
    m = read_measurement(made(tmp_path, text([values])))
    assert m.left_out() == {"missing": 1, "below the horizon": 1}
    assert any(w.startswith("1 zeros above the horizon") for w in m.warnings)


def test_tristimulus_values_are_a_colour(tmp_path):
    """White is white, and a red that sRGB holds comes back by the standard's own matrix."""
    white = np.array([0.9505, 1.0, 1.0890]) * 0.1
    red = 0.1 * np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722],
                          [0.0193, 0.1192, 0.9505]]) @ [0.8, 0.2, 0.1]  # fmt: skip
    for xyz, rgb in ((white, [0.1, 0.1, 0.1]), (red, [0.08, 0.02, 0.01])):
        m = read_measurement(made(tmp_path, text(list(xyz), "XYZ")))
        assert m.radiance_factor[m.kept][0] / np.pi == pytest.approx(rgb, abs=2e-4)
        assert any("D65" in w for w in m.warnings)


@pytest.mark.parametrize("change", [
    lambda t: t.replace(" ", "\t"), lambda t: t.replace("\n", "\r\n"),
    lambda t: t.replace("DataEnd\n", ""), lambda t: t.upper(), lambda t: t.replace("TIS 0.1\n", ""),
    lambda t: t.replace("E-02", "E-02;"), lambda t: t.replace(".", ","),
])  # fmt: skip
def test_other_spellings(tmp_path, change):
    plain = text([np.full((2, 3, 3), 0.05)])
    m = read_measurement(made(tmp_path, change(plain)))
    assert m.radiance_factor[m.kept] == pytest.approx(0.05 * np.pi)


GOOD = text([np.full((2, 3, 3), 0.05)])


@pytest.mark.parametrize(("content", "message"), [
    (text([np.full((2, 3, 3), 0.05)], kind="BTDF"), "line 5: ScatterType BTDF"),
    (GOOD.replace("PlaneSymmetrical", "Round"), "line 3: Symmetry 'Round'; expected one of"),
    (GOOD[: len(GOOD) * 3 // 4], "the data end after"),
    (GOOD.replace("DataEnd", "0.1 0.1 0.1\nDataEnd"), "more numbers than the 18"),
    (GOOD.replace("5.0000E-02", "x", 1), "line 19: found 'x 5.0000E-02 5.0000E-02', expected"),
    (GOOD.replace("20 60", "20 95"), "AngleOfIncidence: expected angles from 0 to 90 degrees"),
    (GOOD.replace("2\n20 60", "200000000\n20 60"), "AngleOfIncidence"),
    (GOOD.replace("20 60", "20"), "AngleOfIncidence: 1 angles where 2 are declared"),
    (GOOD.replace("ScatterRadial 3\n0 10\n40\t\n", ""), "before scatterradial"),
    (text([0.1, 0.1, 0.1], "XYZ").split("TristimulusZ")[0], "Tristimulus Z are missing"),
], ids=range(10))  # fmt: skip
def test_damaged(tmp_path, content, message):
    with pytest.raises(InputError, match=message):
        read_measurement(made(tmp_path, content))


@pytest.mark.skipif(not REAL.exists(), reason="needs ../shared")
def test_real_file_gives_its_own_total_scatter():
    """The rows, integrated over their directions, give the TIS that the instrument wrote.

    They end at 80 degrees from the mirror direction, so a fifth may be lacking. With the azimuths
    counted the other way, more than half is.
    """
    written = [float(x.split()[1]) for x in REAL.read_text().splitlines() if x[:3] == "TIS"]
    m = read_measurement(REAL)
    azimuths, radials = np.arange(0, 181, 10), [0, 5, 10, 15, 20, 30, 40, 50, 60, 70, 80]
    brdf = np.full((13, 19, 11), np.nan)
    order = iter(m.radiance_factor[:, 1] / np.pi)
    for k in range(13):
        for j in range(19):
            for n in range(11):
                brdf[k, j, n] = next(order) if n or not j else brdf[k, 0, 0]

    def total(k, turn):
        a, r = np.meshgrid(azimuths, radials, indexing="ij")
        shape, incidence = a.size, 15.0 + 5.0 * k
        _, o = zemax.directions(
            np.zeros(shape), np.full(shape, incidence), (a + turn).ravel(), r.ravel()
        )
        light = np.nan_to_num(brdf[k]) * np.maximum(o[:, 2], 0.0).reshape(a.shape)
        rings = np.trapezoid(light, np.radians(azimuths), axis=0) * np.sin(np.radians(radials))
        return 2.0 * np.trapezoid(rings, np.radians(radials))

    ratios = [total(k, 0.0) / written[k] for k in range(13)]
    assert min(ratios) > 0.78
    assert max(ratios) < 1.02
    assert total(12, 180.0) / written[12] < 0.5
    assert m.left_out()["missing"] < 0.21 * len(m.reasons)


def test_a_quantity_replaces_the_brdf(tmp_path):
    path = made(tmp_path, text([0.25]))
    factor, insisted = read_measurement(path), read_measurement(path, quantity="Radiance factor")
    assert insisted.radiance_factor[0] == pytest.approx(factor.radiance_factor[0] / np.pi)
    assert not any("not used" in warning for warning in insisted.warnings)
    with pytest.raises(InputError, match="unknown quantity 'nits'"):
        read_measurement(path, quantity="nits")
