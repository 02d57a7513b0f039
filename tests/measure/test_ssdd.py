"""SSDD: the specification's own examples, and directions as libbsdf computes them."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.bands import RGB, WIDE_RGB
from relgloss_view.measure.readers import read_measurement, ssdd

#: The two examples of libbsdf's doc/SsddFileFormatSpecification.md (version 0.2), word for word
#: but for comments that name PARAM3 and PARAM2.
LAMBERTIAN = """\
VERSION 0.2

DATA_TYPE brdf
COLOR_MODEL monochrome
PARAM_TYPE spherical_coordinate_system
PARAM0_LIST 0
PARAM2_LIST 0
PARAM3_LIST 0
DATA ascii
0.3183
"""
BLUISH = """\
VERSION 0.2

# Bluish diffuse BRDF
DATA_TYPE brdf
COLOR_MODEL rgb
PARAM_TYPE half_difference_coordinate_system
REDUCTION_TYPE bilateral_symmetry reciprocity
PARAM0_LIST 0 90
PARAM2_LIST 0 90
PARAM3_LIST 0 90
DATA ascii
# PARAM3: 0
# PARAM2: 0
0 0.0524275 0.159779
0 0.0524275 0.159779
# PARAM2: 90
0 0.0524275 0.159779
0 0.0524275 0.159779
# PARAM3: 90
# PARAM2: 0
0 0.0524275 0.159779
0 0.0524275 0.159779
# PARAM2: 90
0 0.0524275 0.159779
0 0.0524275 0.159779

# Orange diffuse BTDF in the CIE XYZ color space
DATA_TYPE btdf
COLOR_MODEL xyz
PARAM_TYPE specular_coordinate_system
REDUCTION_TYPE bilateral_symmetry
PARAM0_LIST 0 90
PARAM2_LIST 0 180
PARAM3_LIST 0 180
DATA ascii
0.106 0.082 0.011
0.106 0.082 0.011
0.106 0.082 0.011
0.106 0.082 0.011
0.106 0.082 0.011
0.106 0.082 0.011
0.106 0.082 0.011
0.106 0.082 0.011

# Simple specular reflectance
DATA_TYPE specular_reflectance
COLOR_MODEL spectrum
WAVELENGTH_LIST 400 450 500 550 600 650 700
PARAM0_LIST 0 90
DATA ascii
0.05 0.05 0.05 0.05 0.05 0.05 0.05
0.05 0.05 0.05 0.05 0.05 0.05 0.05
"""
#: A block with the optional properties and the values of the specification's tables of properties.
GCMS_4 = """\
VERSION 0.2
SOFTWARE BSDFProcessor-1.3.0
API libbsdf-1.0.0
DATE 2020-01-16
DATA_TYPE brdf
COLOR_MODEL spectrum
WAVELENGTH_LIST 400 500 600 700
PARAM_TYPE specular_coordinate_system
PARAM0_LIST 0 15 30
PARAM2_LIST 0 10 20
PARAM3_LIST 0 90 180 270 360
PARAM4_LIST 0 -5.06 -10.52
NAME metallic paint
SOURCE_TYPE measured
DEVICE GCMS-4
CREATION_DATE 2020-01-16
MEASUREMENT_DATE 2019-12-26
DATA <mode>
"""


def text_of(kind, lists, rows, model="monochrome", more=""):
    """A file of one BRDF."""
    names = (f"PARAM{k}_LIST {' '.join(map(str, v))}" for k, v in lists.items())
    head = f"VERSION 0.2\nDATA_TYPE brdf\nCOLOR_MODEL {model}\n{more}PARAM_TYPE {kind}\n"
    return head + "\n".join(names) + "\nDATA ascii\n" + "\n".join(map(str, rows)) + "\n"


@pytest.fixture
def read(tmp_path):
    path = tmp_path / "table.ssdd"

    def reader(content, **options):
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return read_measurement(path, **options)

    return reader


def test_the_specifications_examples(read):
    one = read(LAMBERTIAN)
    np.testing.assert_allclose(one.radiance_factor, [[0.3183 * np.pi] * 3])
    assert any("one channel (monochrome)" in w for w in one.warnings)

    bluish = read(BLUISH)
    assert bluish.bands == RGB
    np.testing.assert_allclose(
        bluish.radiance_factor / np.pi, np.tile([0, 0.0524275, 0.159779], (6, 1)), rtol=1e-12
    )
    # theta_d = 0 repeats one geometry at each azimuth; all of theta_h or theta_d = 90 are flat.
    assert bluish.kept.sum() == 1
    assert any("passed over: btdf, specular reflectance" in w for w in bluish.warnings)


@pytest.mark.parametrize("mode", ["ascii", "binary"])
def test_the_gcms_4_of_the_specification(read, mode):
    """Order of the table: index = i0 + n0 (i1 + n1 (i2 + n2 i3)), the specification's own line."""
    n0, n2, n3, channels = 3, 3, 5, 4
    values = np.zeros((n3, n2, 1, n0, channels), np.float32)
    for i3, i2, i0, c in np.ndindex(n3, n2, n0, channels):
        values[i3, i2, 0, i0, c] = 0.1 + (i0 + n0 * (i2 + n2 * i3)) / 100 + c / 1000
    values[:, 0] = values[0, 0]  # one geometry at all azimuths
    values[4] = values[0]  # 360 is 0
    rows = values.reshape(-1, channels)
    head = GCMS_4.replace("<mode>", mode).encode()
    table = "\n".join(" ".join(f"{x:.9g}" for x in row) for row in rows).encode()
    m = read(head + (rows.tobytes() if mode == "binary" else table) + b"\n")
    assert m.name == "metallic paint"
    assert "GCMS-4" in m.source
    assert "2019-12-26" in m.source
    assert not m.synthetic
    assert m.bands.wavelengths_nm == (400, 500, 600, 700)
    # 3 incidences; the pole once and 2 angles x 4 azimuths about it.
    assert len(m.reasons) == 3 * (1 + 2 * 4)
    assert m.radiance_factor[0] / np.pi == pytest.approx([0.1, 0.101, 0.102, 0.103], rel=1e-6)
    # i0 = 1, i2 = 1, i3 = 2: 15 degrees, 10 degrees from the mirror direction less the offset,
    # at azimuth 180, away from the normal.
    tilt = np.radians(15 - 5.06 + 10)
    place = np.argmin(
        np.linalg.norm(m.to_receiver - [-np.sin(tilt), 0, np.cos(tilt)], axis=1)
        + np.abs(m.to_lamp[:, 2] - np.cos(np.radians(15)))
    )
    np.testing.assert_allclose(m.to_receiver[place], [-np.sin(tilt), 0, np.cos(tilt)], atol=1e-9)
    expected = 0.1 + (1 + 3 * (1 + 3 * 2)) / 100
    assert m.radiance_factor[place, 0] / np.pi == pytest.approx(expected, rel=1e-6)


#: Vectors to lamp and receiver that libbsdf's toXyz gives for PARAM0 to PARAM3 (degrees):
#: HalfDifferenceCoordinateSystem.h (commit 2b5b243) and SpecularCoordinateSystem.h (0e0a7df),
#: compiled on their own with Eigen's Rotation2D written out, and printed to nine decimals.
LIBBSDF = [
    ("half_difference", (20, 30, 40, 50), None, (0.316940594, 0.751564758, 0.578531826),
     (0.136861273, -0.489562128, 0.861160795)),
    ("half_difference", (10, 0, 25, 120), None, (-0.050720175, 0.365998151, 0.929232381),
     (0.365477566, -0.365998151, 0.855845490)),
    ("specular", (40, 0, 15, 60), None, (0.642787610, 0.0, 0.766044443),
     (-0.521751707, 0.224143868, 0.823124949)),
    ("specular", (30, 70, 20, 110), -5, (0.171010072, 0.469846310, 0.866025404),
     (-0.474098526, -0.362882373, 0.802213794)),
    ("specular", (40, 0, 10, 0), None, (0.642787610, 0.0, 0.766044443), (-0.5, 0.0, 0.866025404)),
]  # fmt: skip


@pytest.mark.parametrize("case", LIBBSDF, ids=str)
def test_directions_are_libbsdfs(read, case):
    kind, angles, offset, lamp, receiver = case
    lists = {k: [angle] for k, angle in enumerate(angles)}
    if offset is not None:
        lists[4] = [offset]
    m = read(text_of(f"{kind}_coordinate_system", lists, [0.1]))
    np.testing.assert_allclose(m.to_lamp[0], lamp, atol=2e-9)
    np.testing.assert_allclose(m.to_receiver[0], receiver, atol=2e-9)


def test_the_mirror_direction_is_opposite(read):
    lists = {0: [0, 30, 60], 2: [0, 30, 60], 3: [0, 90, 180, 270]}
    rows = [
        9 if phi == 180 and i == o and i else 0.1 for phi in lists[3] for o in lists[2]
        for i in lists[0]
    ]  # fmt: skip
    m = read(text_of("spherical_coordinate_system", lists, rows))
    bright = m.radiance_factor[:, 0] > 5
    assert bright.sum() == 2
    np.testing.assert_allclose(m.to_receiver[bright], m.to_lamp[bright] * [-1, -1, 1], atol=1e-12)


def test_colour_models(read):
    lists = {0: [0], 2: [0, 10], 3: [0]}
    xyz = read(text_of("spherical_coordinate_system", lists, ["0.2851 0.3 0.3267"] * 2, "xyz"))
    # D65's XYZ is a gray (IEC 61966-2-1 gives the matrix with four decimals).
    np.testing.assert_allclose(xyz.radiance_factor / np.pi, 0.3, atol=2e-4)
    red = read(text_of("spherical_coordinate_system", lists, ["0.3 -0.02 0.01"] * 2, "rgb"))
    assert red.bands == WIDE_RGB
    assert red.kept.all()
    generated = text_of("spherical_coordinate_system", lists, [0.1, 0.1])
    assert not read(generated).synthetic
    assert read(generated.replace("DATA a", "SOURCE_TYPE generated\nDATA a")).synthetic


def test_large_tables_are_thinned_evenly(read, monkeypatch):
    monkeypatch.setattr(ssdd, "MOST_SAMPLES", 60)
    lists = {0: [0, 20, 40], 2: [0, 10, 30], 3: list(range(0, 360, 10))}
    rows = [
        f"{0.1 + i / 1000 + o / 100 + (phi / 1e5 if o else 0)}"
        for phi in lists[3] for o in lists[2] for i in lists[0]
    ]  # fmt: skip
    m = read(text_of("spherical_coordinate_system", lists, rows))
    assert any("3 x 1 x 3 x 36 directions; 3 x 1 x 3 x 6 of them" in w for w in m.warnings)
    theta_i, theta_o = (np.degrees(np.arccos(v[:, 2])) for v in (m.to_lamp, m.to_receiver))
    phi = np.degrees(np.arctan2(m.to_receiver[:, 1], m.to_receiver[:, 0])) % 360
    expected = 0.1 + theta_i / 1000 + theta_o / 100 + np.where(theta_o > 1, phi / 1e5, 0)
    np.testing.assert_allclose(m.radiance_factor[:, 0] / np.pi, expected, rtol=1e-9)


HALF = "half_difference_coordinate_system"
BAD = {
    "no brdf": (LAMBERTIAN.replace("E brdf", "E btdf"), "holds no BRDF but btdf"),
    "distorted": (LAMBERTIAN.replace("spherical", "distorted_spherical"), "PARAM_TYPE"),
    "a word": (LAMBERTIAN.replace("0.3183", "x"), "expected 1 number"),
    "two numbers": (LAMBERTIAN.replace("0.3183", "1 2"), "expected 1 number"),
    "cut off": (LAMBERTIAN.replace("T 0\nPARAM3", "T 0 10\nPARAM3"), "cut off"),
    "cut off in binary": (LAMBERTIAN.replace("ascii", "binary")[:-4], "cut off"),
    "beyond": (LAMBERTIAN.replace("M0_LIST 0", "M0_LIST 100"), "PARAM0_LIST spans 100"),
    "decreasing": (LAMBERTIAN.replace("M0_LIST 0", "M0_LIST 10 5"), "does not increase"),
    "a comma": (LAMBERTIAN.replace("M0_LIST 0", "M0_LIST 0,5"), "PARAM0_LIST"),
    "no list": (LAMBERTIAN.replace("PARAM3", "PARAM9"), "PARAM3_LIST of the brdf is missing"),
    "infinite": (LAMBERTIAN.replace("0.3183", "inf"), "damaged"),
    "huge claim": (
        text_of(HALF, {0: range(90), 2: range(90), 3: range(360), 1: range(360)}, [1]),
        "thin out",
    ),
    "no wavelengths": (LAMBERTIAN.replace("monochrome", "spectrum"), "WAVELENGTH_LIST"),
    "offsets": (
        text_of("specular_coordinate_system", {0: [0, 9], 2: [0], 3: [0], 4: [1]}, [1, 1]),
        "PARAM4_LIST has 1 offsets for 2",
    ),
    "twice": (LAMBERTIAN + LAMBERTIAN.replace("VERSION 0.2\n", ""), "two of one DATA_TYPE"),
    "below only": (LAMBERTIAN.replace("M2_LIST 0", "M2_LIST 90"), "none of the 1 samples"),
}  # fmt: skip


@pytest.mark.parametrize("fault", BAD)
def test_one_line_names_the_fault(read, fault):
    content, words = BAD[fault]
    with pytest.raises(InputError) as caught:
        read(content)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


OTHER_WRITERS = {
    "carriage returns": LAMBERTIAN.replace("\n", "\r"),
    "indented": LAMBERTIAN.replace("\n", "\n  "),
    "tabs": LAMBERTIAN.replace(" ", "\t"),
    "lower case": LAMBERTIAN.lower(),
    "colons": LAMBERTIAN.replace("_TYPE ", "_TYPE: ").replace("VERSION ", "VERSION: "),
    "remarks": LAMBERTIAN.replace("brdf", "brdf # of a card"),
    "another order": LAMBERTIAN.replace("DATA_TYPE brdf\nCOLOR_MODEL monochrome",
                                        "COLOR_MODEL monochrome\nDATA_TYPE brdf"),
    "byte order mark": "\ufeff" + LAMBERTIAN,
    "utf-16": LAMBERTIAN.encode("utf-16"),
}  # fmt: skip


@pytest.mark.parametrize("form", OTHER_WRITERS)
def test_what_other_writers_vary(tmp_path, form):
    content = OTHER_WRITERS[form]
    path = tmp_path / "x"  # recognised by its content, before a row is parsed
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    m = read_measurement(path)
    assert m.format.startswith("an SSDD file")
    np.testing.assert_allclose(m.radiance_factor, np.pi * 0.3183)
