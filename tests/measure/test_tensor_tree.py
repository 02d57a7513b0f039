"""Tensor trees: trees that Radiance made from a closed form, the mapping, and hostile files."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.base.xml import read_xml
from relgloss_view.exchange.formats import ExportOptions, format_of
from relgloss_view.fitting.fit import fit_material
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers import read_measurement, tensor_tree
from relgloss_view.measure.readers.cell_middles import middles_of
from relgloss_view.measure.readers.shirley_chiu import coordinates, directions, to_disk, to_square
from relgloss_view.measure.readers.tensor_tree import Tree, read_tree, uv_of, xyz_of
from relgloss_view.pack.built_in import load_finish

#: A lobe of facet slope 0.1 over a Lambertian of albedo 0.1 pi, in Radiance's expression language.
SLOPE2 = 0.02
EXPRESSION = (
    "t2(hx,hy,hz)=(hx*hx+hy*hy)/(hz*hz);"
    f"bsdf(ix,iy,iz,ox,oy,oz)=0.1+2*exp(-t2(ix+ox,iy+oy,iz+oz)/{SLOPE2})"
)


def closed_form(i, o):
    h = i + o
    return 0.1 + 2.0 * np.exp(-(h[:, 0] ** 2 + h[:, 1] ** 2) / h[:, 2] ** 2 / SLOPE2)


@pytest.fixture(scope="module")
def of_radiance(tmp_path_factory):
    """A file of a tree of three dimensions that bsdf2ttree of Radiance makes of a closed form."""
    pyradiance = pytest.importorskip("pyradiance")
    bin_folder = Path(pyradiance.__file__).parent / "bin"
    folder = tmp_path_factory.mktemp("trees")

    def make(rank, fineness):
        command = [str(bin_folder / "bsdf2ttree"), f"-t{rank}", "-g", str(fineness), "-n", "64"]
        made = subprocess.run(
            [*command, "-forward", "+backward", "-e", EXPRESSION, "bsdf"],
            capture_output=True,
            check=True,
            env={"RAYPATH": str(bin_folder.parent / "lib"), "PATH": str(bin_folder)},
        )
        path = folder / f"tree{rank}.xml"
        path.write_bytes(made.stdout)
        return path

    return make


def tree_of(path, rank):
    root = read_xml(path, "a tree", most_bytes=10_000_000)
    return read_tree(next(root.iter("ScatteringData")).text, rank, "here")


def near_mirror(count, seed=0):
    rng = np.random.default_rng(seed)
    theta_i, phi_i = rng.uniform(0.0, 70.0, count), rng.uniform(0.0, 360.0, count)
    theta_r = np.clip(theta_i + rng.normal(0.0, 8.0, count), 0.0, 80.0)
    return spherical(theta_i, phi_i), spherical(theta_r, phi_i + 180.0 + rng.normal(0, 12, count))


class TestOfRadiance:
    #: A cell of bsdf2ttree may differ from its neighbour by a third before it is halved, so single
    #: values differ by that much and their median by a few percent; four dimensions are coarser.
    @pytest.mark.parametrize(("rank", "fineness", "median", "correlation"), [
        (3, 6, 0.06, 0.98),
        pytest.param(4, 5, 0.15, 0.92, marks=pytest.mark.slow),
    ])  # fmt: skip
    def test_holds_the_closed_form(self, of_radiance, rank, fineness, median, correlation):
        tree = tree_of(of_radiance(rank, fineness), rank)
        i, o = near_mirror(600)
        expected, values = closed_form(i, o), tree.at(coordinates(i, o, rank))
        assert np.median(np.abs(values - expected) / expected) < median
        assert np.corrcoef(values, expected)[0, 1] > correlation

    def test_a_wrong_azimuth_is_seen(self, of_radiance):
        """Negative control: with the lamp on the other side nothing agrees."""
        tree = tree_of(of_radiance(3, 6), 3)
        i, o = near_mirror(600)
        turned = i * np.array([-1.0, -1.0, 1.0])
        values = tree.at(coordinates(turned, o, 3))
        assert np.corrcoef(values, closed_form(i, o))[0, 1] < 0.5

    def test_is_read_and_fitted(self, of_radiance):
        measurement = read_measurement(of_radiance(3, 6))
        i, o = measurement.to_lamp, measurement.to_receiver
        expected = np.pi * closed_form(i, o)
        apart = np.abs(measurement.radiance_factor[:, 0] - expected) / expected
        assert np.median(apart) < 0.05  # at the middles of cells, a mean is the value
        material = fit_material(measurement)
        # The slope's variance is 2 s^2 (Beckmann): s = 5.7 degrees; cells of 64 widen it.
        assert material.specular[0].s_deg == pytest.approx(
            np.degrees(np.sqrt(SLOPE2 / 2.0)), rel=0.15
        )
        assert material.diffuse.albedo[0] == pytest.approx(0.1 * np.pi, rel=0.1)


class TestMiddles:
    def test_a_gaussian_flank(self):
        """Means of an even tree of a Gaussian, by its integral, against its values."""
        from scipy.special import erf

        level, s = 5, 0.06
        edge = np.linspace(0.0, 1.0, 2**level + 1)
        mean = np.diff(erf((edge - 0.5) / (np.sqrt(2.0) * s))) * np.sqrt(np.pi / 2.0) * s * 2**level
        # Along the second dimension alone, in the Morton order of a tree.
        leaves = np.arange(8**level)
        tree = Tree(3, np.full(8**level, level), np.ones(8**level))
        middle = tree.middles(leaves)
        place = np.round(middle[:, 1] * 2**level - 0.5).astype(int)
        tree = Tree(3, tree.levels, mean[place])
        some = leaves[(np.abs(middle[:, 1] - 0.5) < 2.5 * s) & (middle[:, 0] < 0.5)]
        true = np.exp(-0.5 * ((tree.middles(some)[:, 1] - 0.5) / s) ** 2)
        found = middles_of(tree, some)
        # Cells of half a standard deviation: the mean of cells is off by 4 % at the peak's side and
        # more on the flanks, the middle by the fourth order, (w / s)^4 / 1152 and a few of them.
        assert np.max(np.abs(tree.values[some] / true - 1.0)) > 0.03
        np.testing.assert_allclose(found.values, true, rtol=5e-3)
        assert np.all(found.uncertainty >= 0.0)

    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["cold-foil-silver", "cold-foil-gold", "cast-coated"])
    def test_gloss_of_a_narrow_highlight(self, name, tmp_path):
        """Out and read again: within 2 units, or within 1 % where a foil has hundreds."""
        material, path = load_finish(name), tmp_path / "tree.xml"
        format_of(path).write(material, path, ExportOptions())
        back = fit_material(read_measurement(path))
        assert back.fit.quality == "good"
        for angle in (20.0, 60.0, 75.0, 85.0):
            expected = specular_gloss(material, angle)
            allowed = max(2.0, 0.01 * expected)
            assert specular_gloss(back, angle) == pytest.approx(expected, abs=allowed)


class TestSquare:
    def test_is_its_own_inverse(self):
        u, v = np.random.default_rng(1).random((2, 2000))
        back = to_square(*to_disk(u, v))
        np.testing.assert_allclose(back, (u, v), atol=1e-14)

    def test_keeps_areas(self):
        """Half of the radius holds a quarter of the disk, and so of the square."""
        side = (np.arange(400) + 0.5) / 400
        u, v = np.meshgrid(side, side)
        x, y = to_disk(u.ravel(), v.ravel())
        assert np.mean(np.hypot(x, y) < 0.5) == pytest.approx(0.25, abs=2e-3)

    @pytest.mark.parametrize(
        ("x", "y", "square"),
        [(1, 0, (1, 0.5)), (0, 1, (0.5, 1)), (-1, 0, (0, 0.5)), (0, -1, (0.5, 0))],
    )
    def test_axes(self, x, y, square):
        """The axes of Radiance's disk2square.c."""
        found = to_square(np.array(float(x)), np.array(float(y)))
        np.testing.assert_allclose(found, square, atol=1e-15)

    @pytest.mark.parametrize("rank", [3, 4])
    def test_directions_and_coordinates(self, rank):
        places = np.random.default_rng(2).uniform(0.01, 0.99, (500, rank))
        if rank == 3:
            places[:, 0] *= 0.5
        found = coordinates(*directions(places), rank)
        np.testing.assert_allclose(found, places, atol=1e-6)


class TestText:
    def test_order_of_children(self):
        """Bit d of a child's place is the upper half of dimension d."""
        tree = read_tree("{" + "".join(f"{{{k}}}" for k in range(8)) + "}", 3, "here")
        for k in range(8):
            place = np.array([[0.25 + 0.5 * ((k >> d) & 1) for d in range(3)]])
            assert tree.at(place) == [k]

    def test_order_of_a_grid(self):
        """In a grid the last dimension varies fastest."""
        tree = read_tree("{0 1 2 3 4 5 6 7}", 3, "here")
        assert tree.at(np.array([[0.1, 0.1, 0.9], [0.9, 0.1, 0.1]])).tolist() == [1.0, 4.0]

    def test_goes_out_and_in(self):
        rng = np.random.default_rng(5)
        levels, values = [], []

        def halve(level):
            if level < 4 and rng.random() < 0.5:
                for _ in range(8):
                    halve(level + 1)
            else:
                levels.append(level)
                values.append(float(f"{rng.random():.4g}"))

        for _ in range(8):
            halve(1)
        tree = Tree(3, np.array(levels), np.array(values))
        back = read_tree(tree.text(), 3, "here")
        places = rng.random((2000, 3))
        assert back.at(places).tolist() == tree.at(places).tolist()
        np.testing.assert_array_equal(tree.leaf_at(tree.middles(np.arange(len(levels)))),
                                      np.arange(len(levels)))  # fmt: skip

    def test_negative_values_are_zero(self):
        assert read_tree("{-1}", 3, "here").values.tolist() == [0.0]

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("", "ends within"),
            ("1 2", "expected {"),
            ("{1 2}", "a grid of 2 numbers"),
            ("{{1}{2}}", "fewer than 8"),
            ("{" + "{1}" * 9 + "}", "more than 8"),
            ("{{1}", "ends within"),
            ("{1}{2}", "after the end"),
            ("{}", "fewer"),
            ("{{1} 2 {3}}", "numbers between"),
            ("{nan}", "no number"),
            ("{1e300}", "above 1e"),
            ("{x}", "expected numbers"),
            ("{" * 5000, "nested more than 16"),
            ("{" * 17 + "1 2 3 4 5 6 7 8" + "}" * 17, "nested more than 16"),
        ],
    )
    def test_refuses(self, text, message):
        with pytest.raises(InputError, match=r"^here: ") as error:
            read_tree(text, 3, "here")
        assert message in str(error.value)
        assert "\n" not in str(error.value)

    def test_refuses_too_many_values(self, monkeypatch):
        monkeypatch.setattr(tensor_tree, "MOST_LEAVES", 7)
        with pytest.raises(InputError, match="more than 7 values"):
            read_tree("{0 1 2 3 4 5 6 7}", 3, "here")


def document(
    structure="TensorTree3", wavelength="Visible", basis="LBNL/Shirley-Chiu", data="{0.1}"
):
    return (
        "<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>"
        f"{structure}</IncidentDataStructure></DataDefinition><WavelengthData><Wavelength>"
        f"{wavelength}</Wavelength><WavelengthDataBlock><WavelengthDataDirection>Reflection Front"
        f"</WavelengthDataDirection><AngleBasis>{basis}</AngleBasis><ScatteringData>{data}"
        "</ScatteringData></WavelengthDataBlock></WavelengthData></Layer></Optical></WindowElement>"
    )


class TestFile:
    def test_a_lambertian(self, tmp_path):
        path = tmp_path / "gray.xml"
        path.write_text(document())
        measurement = read_measurement(path)
        np.testing.assert_allclose(measurement.radiance_factor[measurement.kept], 0.1 * np.pi)

    @pytest.mark.parametrize(
        ("wrong", "message"),
        [
            ({"structure": "TensorTree5"}, "TensorTree4"),
            ({"basis": "LBNL/Klems Full"}, "Shirley-Chiu"),
            ({"wavelength": "Solar"}, "Visible"),
            ({"data": "{0.1"}, "ends within"),
        ],
    )
    def test_refuses_in_one_line(self, tmp_path, wrong, message):
        path = tmp_path / "wrong.xml"
        path.write_text(document(**wrong))
        with pytest.raises(InputError) as error:
            read_measurement(path)
        assert message in str(error.value)
        assert "\n" not in str(error.value)


def test_chromaticities_come_back():
    xyz = np.random.default_rng(3).uniform(0.1, 1.0, (20, 3))
    np.testing.assert_allclose(xyz_of(xyz[:, 1], *uv_of(xyz)), xyz, rtol=1e-12)
