"""ALTA's data: directions as its own params::to_cartesian gives them."""

from __future__ import annotations

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.measure.readers import read_measurement

#: What ALTA's params::to_cartesian (core/params.cpp, commit 1af3876) gives, V and then L, printed
#: to nine decimals by those lines compiled on their own, with Eigen's rotations written out.
ALTA = {
    "RUSIN_TH_TD_PD .2 .5 .7": (
        (0.533724333, 0.308854412, 0.787240299), (-0.185026853, -0.308854412, 0.932938377)),
    "RUSIN_TH_PH_TD_PD .2 .3 .5 .7": (
        (0.418613611, 0.452786215, 0.787240299), (-0.085490184, -0.349739063, 0.932938377)),
    "ISOTROPIC_TL_TV_PROJ_DPHI .3 .4 .5": (
        (0.373221561, 0.466526951, 0.801909141), (0.295520207, 0.0, 0.955336489)),
    "SCHLICK_TL_TK_PROJ_DPHI .5 .1 .2": (
        (0.639719964, 0.320588852, 0.698556480), (0.479425539, 0.0, 0.877582562)),
    "ISOTROPIC_TV_TL_DPHI .3 .5 .7": (
        (0.295520207, 0.0, 0.955336489), (0.366684878, 0.308854412, 0.877582562)),
    "SPHERICAL_TL_PL_TV_PV .3 .4 .5 .7": (
        (0.366684878, 0.308854412, 0.877582562), (0.272192135, 0.115080989, 0.955336489)),
    "CARTESIAN .6 0 .8 0 0 1": ((0.6, 0.0, 0.8), (0.0, 0.0, 1.0)),
}  # fmt: skip
#: ALTA's two ways disagree here on which of the two is L. from_cartesian, which makes the files,
#: has B = (L - V) / 2; its to_cartesian gives L and V the other way round. A BRDF is reciprocal.
SWAPPED = {
    "STARK_3D .2 .4 .6": (
        (0.524651886, 0.222106305, 0.821832822), (-0.124651886, -0.222106305, 0.967021560)),
    "NEUMANN_3D .2 .4 .6": (
        (0.530134246, 0.225856989, 0.817279818), (-0.130134246, -0.225856989, 0.965429282)),
}  # fmt: skip


@pytest.fixture
def read(tmp_path):
    path = tmp_path / "felt.alta"

    def reader(text, **options):
        path.write_text(text, encoding="utf-8")
        return read_measurement(path, **options)

    return reader


def file_of(case, out="RGB_COLOR", values="0.1 0.2 0.3", more=""):
    name, *numbers = case.split()
    dim = f"#DIM {len(numbers)} {len(values.split())}"
    head = f"# a sample\n{dim}\n#PARAM_IN  {name}\n#PARAM_OUT {out}\n{more}"
    return head + "\t".join(numbers + values.split()) + "\t\n"


@pytest.mark.parametrize("case", ALTA | SWAPPED)
def test_directions_are_altas(read, case):
    m = read(file_of(case))
    viewer, lamp = ALTA.get(case) or SWAPPED[case][::-1]
    np.testing.assert_allclose(m.to_lamp[0], lamp, atol=2e-9)
    np.testing.assert_allclose(m.to_receiver[0], viewer, atol=2e-9)
    np.testing.assert_allclose(m.radiance_factor[0] / np.pi, [0.1, 0.2, 0.3])


def test_values(read):
    case = "SPHERICAL_TL_PL_TV_PV .3 .4 .5 .7"
    gray = read(file_of(case, "INV_STERADIAN", "0.5"))
    np.testing.assert_allclose(gray.radiance_factor[0] / np.pi, 0.5)
    cosine = read(file_of(case, "INV_STERADIAN_COSINE_FACTOR", "0.5"))
    np.testing.assert_allclose(cosine.radiance_factor[0] / np.pi, 0.5 / np.cos(0.5))
    xyz = read(file_of(case, "XYZ_COLOR", "0.2851 0.3 0.3267"))
    np.testing.assert_allclose(xyz.radiance_factor / np.pi, 0.3, atol=2e-4)
    # '#VS 2': the ends of an interval follow the values of a row.
    bars = file_of(case, "INV_STERADIAN", "0.5 0.4 0.6", "#VS 2\n").replace("#DIM 4 3", "#DIM 4 1")
    m = read(bars)
    np.testing.assert_allclose(m.radiance_factor[0] / np.pi, 0.5)
    assert any("intervals" in w for w in m.warnings)
    # No such direction: outside the hemisphere of the coordinates.
    outside = file_of("STARK_3D .9 .9 0") + ".2\t.4\t.6\t.1\t.2\t.3\n"
    assert read(outside).left_out() == {"below the horizon": 1}


BAD = {
    # The first lines of ALTA's own data/pink-felt-1d.alta: the half-vector alone.
    "half-vector": (
        "# Disclaimer\n#DIM 1 3\n#PARAM_IN  COS_TH\n#PARAM_OUT RGB_COLOR\n"
        "0.999984567305837\t0.109704419970512\t0.0794405192136765\t0.0616232864558697\t\n",
        "'#PARAM_IN COS_TH' do not give both directions",
    ),
    "two": (file_of("STARK_2D .1 .2"), "STARK_2D"),
    "unknown": (file_of("UNKNOWN_INPUT .1 .2 .3"), "UNKNOWN_INPUT"),
    "dimension": (file_of("RUSIN_TH_TD_PD .1 .2"), "has 3 numbers a row"),
    "energy": (file_of("RUSIN_TH_TD_PD .1 .2 .3", "ENERGY", "1"), "ENERGY"),
    "channels": (file_of("RUSIN_TH_TD_PD .1 .2 .3", "RGB_COLOR", "1 2"), "2 values of RGB_COLOR"),
    "no dimension": ("#DIM x\n#PARAM_IN CARTESIAN\n1 2 3\n", "#DIM x"),
    "length": (file_of("CARTESIAN 3 0 4 0 0 1"), "length 5"),
    "binary": ("#DIM 3 3\n#PARAM_IN RUSIN_TH_TD_PD\n#FORMAT binary\n\0\0", "binary data file"),
}


@pytest.mark.parametrize("fault", BAD)
def test_one_line_names_the_fault(read, fault):
    text, words = BAD[fault]
    with pytest.raises(InputError) as caught:
        read(text)
    assert words in str(caught.value)


def test_what_other_writers_vary(read):
    text = file_of("SPHERICAL_TL_PL_TV_PV .3 .4 .5 .7")
    plain = read(text)
    for other in (text.replace("\n", "\r"), text.lower(), text + "end\n"):
        np.testing.assert_array_equal(read(other).radiance_factor, plain.radiance_factor)
        np.testing.assert_array_equal(read(other).to_lamp, plain.to_lamp)
