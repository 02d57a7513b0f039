"""Tables out: MERL by its authors' formula, CSV back in, BSDF XML by Radiance's programs."""

from __future__ import annotations

import dataclasses
import html
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.exchange import bsdf_xml, csv_out, merl
from relgloss_view.exchange.channels import in_rgb, in_xyz
from relgloss_view.exchange.formats import ExportOptions, format_of
from relgloss_view.exchange.grow import collapsed, grow
from relgloss_view.exchange.klems_out import Patches, _patch_of, _projected
from relgloss_view.fitting.fit import fit_material
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.material import spectra
from relgloss_view.material.albedo import directional_albedo
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.gonio import spherical
from relgloss_view.measure.readers import read_measurement
from relgloss_view.measure.readers.klems import known_bases
from relgloss_view.measure.readers.shirley_chiu import coordinates
from relgloss_view.pack.built_in import FINISHES, PAPERS, load_finish

ANGLES = (20, 60, 75, 85)
#: What the issue asks of a round trip.
MOST_UNITS = 2.0
METALS = ("cold-foil-silver", "cold-foil-gold")
DIELECTRICS = tuple(name for name in (*PAPERS, *FINISHES) if name not in METALS)


def exported(what, path, **options):
    return format_of(path).write(what, path, ExportOptions(**options))


def units(material):
    return np.array([specular_gloss(material, angle) for angle in ANGLES])


def came_back(path, **how):
    return fit_material(read_measurement(path), **how)


def random_directions(count, seed=0, near=0.0):
    """Pairs of directions; near: a standard deviation about the mirror direction, degrees."""
    rng = np.random.default_rng(seed)
    theta_i, phi_i = rng.uniform(0.0, 75.0, count), rng.uniform(0.0, 360.0, count)
    if near:
        theta_r = np.clip(theta_i + rng.normal(0.0, near, count), 0.0, 80.0)
        phi_r = phi_i + 180.0 + rng.normal(0.0, near, count)
    else:
        theta_r, phi_r = rng.uniform(0.0, 75.0, count), rng.uniform(0.0, 360.0, count)
    return (theta_i, phi_i, theta_r, phi_r), spherical(theta_i, phi_i), spherical(theta_r, phi_r)


def matt():
    return load_finish("matt-varnish")


class TestFolded:
    @pytest.mark.parametrize("name", ["art-coated", "cold-foil-gold", "kraft"])
    def test_is_the_material_in_xyz(self, name):
        material = load_finish(name)
        _, i, o = random_directions(200, near=5.0)
        expected = sum(material.evaluate(i, o)) @ material.xyz_weights(spectra.illuminant("D65"))
        np.testing.assert_allclose(in_xyz(material).brdf(i, o), expected, rtol=1e-9)

    def test_rgb_of_rgb_is_itself(self):
        material = Material(
            "rgb", "by hand", RGB, Diffuse("lambert", (0.1, 0.5, 0.3)), (Lobe((1.0,), 5.0),)
        )
        _, i, o = random_directions(50, near=5.0)
        np.testing.assert_allclose(
            in_rgb(material).brdf(i, o), sum(material.evaluate(i, o)), rtol=1e-9
        )


class TestMerl:
    """BRDFRead.cpp of the MERL database: lookup_brdf_val, with its rotations and index formulas."""

    @staticmethod
    def looked_up(bins, i, o):
        """As that program does, one pair of unit vectors at a time."""

        def rotated(vector, axis, angle):
            cos, sin = np.cos(angle), np.sin(angle)
            return (
                vector * cos
                + np.cross(axis, vector) * sin
                + axis * np.dot(axis, vector) * (1 - cos)
            )

        half = (i + o) / np.linalg.norm(i + o)
        theta_half, phi_half = np.arccos(half[2]), np.arctan2(half[1], half[0])
        turned = rotated(i, np.array([0.0, 0.0, 1.0]), -phi_half)
        diff = rotated(turned, np.array([0.0, 1.0, 0.0]), -theta_half)
        theta_diff, phi_diff = np.arccos(min(diff[2], 1.0)), np.arctan2(diff[1], diff[0])
        # theta_half_index, theta_diff_index, phi_diff_index
        half_index = int(np.sqrt(theta_half / (np.pi / 2.0) * 90.0 * 90.0))
        diff_index = int(theta_diff / (np.pi * 0.5) * 90.0)
        phi_index = int((phi_diff + np.pi if phi_diff < 0.0 else phi_diff) / np.pi * 360.0 / 2.0)
        index = min(phi_index, 179) + min(diff_index, 89) * 180 + min(half_index, 89) * 180 * 90
        count = 90 * 90 * 180
        return np.array([
            bins[index] * (1.00 / 1500.0),
            bins[index + count] * (1.15 / 1500.0),
            bins[index + 2 * count] * (1.66 / 1500.0),
        ])  # fmt: skip

    def test_by_the_published_formula(self, tmp_path):
        material, path = matt(), tmp_path / "matt.binary"
        exported(material, path)
        with path.open("rb") as file:
            assert np.fromfile(file, "<i4", 3).tolist() == [90, 90, 180]
            bins = np.fromfile(file, "<f8")
        _, i, o = random_directions(300, near=8.0)
        expected = in_rgb(material).brdf(i, o)
        found = np.array([self.looked_up(bins, *pair) for pair in zip(i, o, strict=True)])
        # Without interpolation a bin is off by half of its width: 0.5 degrees of theta_d, and at
        # theta_h = 6 degrees 0.25, which is 4 % of a lobe of 6.2 degrees.
        apart = np.abs(found - expected) / expected
        assert np.median(apart) < 0.02
        assert np.percentile(apart, 95) < 0.10
        swapped = np.abs(found[:, ::-1] - expected) / expected
        assert np.median(swapped) > np.median(apart)  # negative control: channels reversed

    def test_below_the_horizon_is_minus_one(self):
        bins = merl.table_of(matt()).bins
        assert np.all(bins[:, 89, 89, 0] == -1.0)
        assert np.all(bins[:, 0, 0] > 0.0)
        assert np.all((bins == -1.0) | (bins >= 0.0))

    @pytest.mark.parametrize("name", ["cast-coated"])
    def test_round_trip(self, tmp_path, name):
        material, path = load_finish(name), tmp_path / "a.binary"
        exported(material, path)
        assert np.max(np.abs(units(came_back(path)) - units(material))) < MOST_UNITS

    @pytest.mark.slow
    @pytest.mark.parametrize("name", DIELECTRICS)
    def test_round_trips(self, tmp_path, name):
        self.test_round_trip(tmp_path, name)

    @pytest.mark.slow
    @pytest.mark.parametrize("name", METALS)
    def test_a_metal_comes_back_as_one(self, tmp_path, name):
        """A foil has two lobes and reads hundreds of units: 3 % of them and 3 units."""
        material, path = load_finish(name), tmp_path / "a.binary"
        exported(material, path)
        found = units(came_back(path, model="metal"))
        np.testing.assert_allclose(found, units(material), rtol=0.03, atol=3.0)


class TestCsv:
    @pytest.mark.parametrize(("grid", "name"), [("gcms", "cast-coated"), ("in-plane", "kraft")])
    def test_round_trip(self, tmp_path, grid, name):
        material, path = load_finish(name), tmp_path / "a.csv"
        exported(material, path, grid=grid)
        measurement = read_measurement(path)
        assert measurement.bands == material.bands
        assert measurement.synthetic
        assert np.max(np.abs(units(fit_material(measurement)) - units(material))) < MOST_UNITS

    @pytest.mark.slow
    @pytest.mark.parametrize("grid", ["gcms", "in-plane", "in-plane:5"])
    @pytest.mark.parametrize("name", DIELECTRICS)
    def test_round_trips(self, tmp_path, grid, name):
        self.test_round_trip(tmp_path, grid, name)

    @pytest.mark.parametrize("grid", ["gcms", "in-plane", "in-plane:30"])
    def test_values_are_those_of_the_material(self, tmp_path, grid):
        material, path = load_finish("art-coated"), tmp_path / "a.csv"
        exported(material, path, grid=grid)
        measurement = read_measurement(path)
        factor = np.pi * sum(material.evaluate(measurement.to_lamp, measurement.to_receiver))
        np.testing.assert_allclose(measurement.radiance_factor, factor, rtol=1e-4)

    def test_own_directions(self, tmp_path):
        grid = tmp_path / "grid.csv"
        grid.write_text("theta_r_deg,phi_r_deg,theta_i_deg,phi_i_deg\n0,0,45,180\n45,0,45,180\n")
        material, path = load_finish("art-coated"), tmp_path / "a.csv"
        exported(material, path, grid=str(grid))
        rows = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        assert len(rows) == 3
        up, mirror = (float(row.split(",")[20]) for row in rows[1:])
        expected = (
            np.pi
            * sum(
                material.evaluate(spherical(45.0, 180.0)[None], spherical([0.0, 45.0], [0.0, 0.0]))
            )[:, 16]
        )
        np.testing.assert_allclose([up, mirror], expected, rtol=1e-5)

    @pytest.mark.parametrize(
        ("content", "message"),
        [
            ("a,b\n1,2\n", "expected the columns theta_i_deg"),
            ("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n", "0 directions"),
            ("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n95,0,0,0\n", "line 2, theta_i_deg"),
            ("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n1,x,0,0\n", "line 2, phi_i_deg"),
            ("theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg\n1,0,0\n", "line 2, phi_r_deg"),
            ("alpha_deg,beta_deg,gamma_deg\n90,90,90\n", "above the horizon"),
        ],
    )
    def test_wrong_directions(self, tmp_path, content, message):
        grid = tmp_path / "grid.csv"
        grid.write_text(content)
        with pytest.raises(InputError) as error:
            exported(matt(), tmp_path / "a.csv", grid=str(grid))
        assert message in str(error.value)
        assert "\n" not in str(error.value)
        assert not (tmp_path / "a.csv").exists()

    def test_a_name_of_controls_leaves_a_table_that_is_read(self, tmp_path):
        name = "a\x00\x1b[31m\x7f\n# quantity: brdf"
        table = tmp_path / "a.csv"
        csv_out.write(dataclasses.replace(matt(), name=name), table, ExportOptions())
        assert b"\x00" not in table.read_bytes()
        assert b"\x1b" not in table.read_bytes()
        assert read_measurement(table).quantity == "radiance-factor"

    @pytest.mark.parametrize("grid", ["in-plane:0", "in-plane:x", "in-plane:nan", "everywhere"])
    def test_wrong_grids(self, tmp_path, grid):
        with pytest.raises(InputError, match="expected"):
            exported(matt(), tmp_path / "a.csv", grid=grid)

    def test_a_lobe_between_the_directions_is_reported(self):
        varnish = load_finish("gloss-varnish")
        coarse = csv_out.grid_of(varnish, "in-plane:30")
        assert any("width of the lobe" in note for note in csv_out._notes(varnish, coarse))
        fine = csv_out.grid_of(varnish, "in-plane")
        assert csv_out._notes(varnish, fine) == ()


def check_bsdf(path):
    """What Radiance's checkBSDF prints, and the numbers of its reflection: total, reciprocity."""
    pyradiance = pytest.importorskip("pyradiance")
    program = Path(pyradiance.__file__).parent / "bin" / "checkBSDF"
    done = subprocess.run([str(program), str(path)], capture_output=True, text=True, check=True)
    rows = [
        line.split("\t") for line in done.stdout.splitlines() if line.startswith("Interior Refl")
    ]
    lambertian = [float(word) for word in rows[0][1].split()]
    total = float(next(word for word in rows[0] if word.strip().endswith("%")).strip(" %"))
    reciprocity = [float(word) for word in " ".join(rows[1][1:]).split()]
    return done.stderr, lambertian, total, reciprocity


@pytest.fixture(scope="module")
def matt_tree(tmp_path_factory):
    path = tmp_path_factory.mktemp("tree") / "matt.xml"
    return path, exported(matt(), path)


class TestTensorTree:
    def test_radiance_checks_it(self, matt_tree):
        material = matt()
        errors, lambertian, total, _ = check_bsdf(matt_tree[0])
        assert errors == ""
        # The Lambertian part that Radiance takes off is the lowest value of all cells.
        _, i, o = random_directions(20_000)
        lowest = 100.0 * np.pi * float(np.min(in_xyz(material).brdf(i, o)[:, 1]))
        assert lambertian[1] == pytest.approx(lowest, rel=0.04)
        y = material.xyz_weights(spectra.illuminant("D65"))[:, 1]
        # No more light than the material itself sends at the most grazing step of 1/32.
        most = directional_albedo(material, [70.0, 75.0, 80.0, 82.0])
        assert total < 105.0 * float(np.max(sum(most) @ y))

    def test_radiance_evaluates_it_alike(self, matt_tree):
        """pyradiance's query at random directions: the luminance of our own tree and material."""
        pyradiance = pytest.importorskip("pyradiance")
        material = matt()
        data = pyradiance.bsdf.load_file(str(matt_tree[0]))
        angles, i, o = random_directions(200, near=6.0)
        found = np.array(
            [pyradiance.bsdf.query(data, *map(float, four))[1] for four in np.array(angles).T]
        )
        tree, _, _ = bsdf_xml.trees_of(material)
        # Four digits a value, and Radiance takes the Lambertian part off and adds it in floats.
        np.testing.assert_allclose(found, tree.at(coordinates(i, o, 3)), rtol=2e-3)
        expected = in_xyz(material).brdf(i, o)[:, 1]
        assert np.median(np.abs(found - expected) / expected) < 0.05

    def test_round_trip(self, matt_tree):
        material = came_back(matt_tree[0])
        assert np.max(np.abs(units(material) - units(matt()))) < MOST_UNITS
        body, own = np.mean(material.diffuse.albedo), np.mean(matt().diffuse.albedo)
        assert body == pytest.approx(own, rel=0.05)

    @pytest.mark.slow
    @pytest.mark.parametrize("name", DIELECTRICS)
    def test_round_trips(self, tmp_path, name):
        path = tmp_path / "a.xml"
        result = exported(load_finish(name), path)
        errors, *_ = check_bsdf(path)
        assert errors == ""
        assert np.max(np.abs(units(came_back(path)) - units(load_finish(name)))) < MOST_UNITS
        # What the file states of itself; at 85 degrees cells of one sine are widest in angle.
        assert result.losses[load_finish(name).name].largest_gloss_units < 1.5 * MOST_UNITS

    def test_the_loss_is_in_the_file(self, matt_tree):
        path, result = matt_tree
        head = html.unescape(path.read_text()[:2000])
        assert all(line in head for line in result.lines)
        ElementTree.parse(path)

    def test_hostile_names(self, tmp_path):
        name = "a --> <b> & \x07 ]]>"
        material = Material(name, "by hand", RGB, Diffuse("lambert", (0.5, 0.5, 0.5)))
        path = tmp_path / "a.xml"
        exported(material, path)
        root = ElementTree.parse(path).getroot()
        names = [e.text for e in root.iter() if e.tag.endswith("}Name")]
        assert names[0].startswith("a --> <b> &")

    def test_a_narrow_lobe_is_found_and_bounded(self):
        """A lobe that falls between all places of the first cells is cut finely all the same."""
        narrow = Material("n", "by hand", RGB, Diffuse("lambert", (0.1,) * 3), (Lobe((1.0,), 0.4),))
        folded = in_xyz(narrow)
        grown = grow(lambda i, o: folded.brdf(i, o)[:, 1:2], 8, 12_000)
        assert 6_000 < len(grown.levels) <= 12_000
        tree = grown.tree(0)
        theta = np.arange(5.0, 75.0, 2.3)
        i, o = spherical(theta, np.full_like(theta, 180.0)), spherical(theta, 0.0 * theta)
        assert tree.levels[tree.leaf_at(coordinates(i, o, 3))].min() >= 7

    def test_leaves_fill_the_cube(self):
        folded = in_xyz(matt())
        grown = grow(lambda i, o: folded.brdf(i, o)[:, 1:2], 7, 100_000)
        assert np.sum(0.125 ** grown.levels.astype(float)) == pytest.approx(1.0, abs=1e-12)
        levels, values = collapsed(
            grown.levels, grown.values[:, 0], np.ones(len(grown.levels)), 9e9
        )
        assert levels.tolist() == [0]
        assert values[0] == pytest.approx(
            np.sum(0.125 ** grown.levels.astype(float) * grown.values[:, 0]), rel=1e-9
        )


class TestKlems:
    def test_energy_and_reciprocity(self, tmp_path):
        path = tmp_path / "matt.xml"
        result = exported(matt(), path, basis="klems")
        errors, lambertian, _, reciprocity = check_bsdf(path)
        assert errors == ""
        assert reciprocity[1] < 0.5  # average, percent
        assert lambertian[1] > 50.0
        assert any("lost: every highlight" in line for line in result.lines)
        assert not result.is_small

    def test_albedo_is_that_of_the_material(self):
        """The light of the patches is the directional albedo, however narrow the lobe."""
        material = load_finish("gloss-varnish")
        patches = Patches.of(material)
        albedo = _projected(patches.basis) @ patches.matrices[1]
        centres, _ = patches.basis.centres()
        weights = material.xyz_weights(spectra.illuminant("D65"))[:, 1]
        for ring in (10.0, 40.0, 60.0):
            own = albedo[np.isclose(centres, ring)]
            inside = np.linspace(ring - 4.0, ring + 4.0, 5)
            expected = float(np.mean(sum(directional_albedo(material, inside)) @ weights))
            np.testing.assert_allclose(own, expected, rtol=0.01)

    def test_patches_are_those_of_the_centres(self):
        basis = known_bases()["lbnl/klems full"]
        theta, phi = basis.centres()
        found = _patch_of(basis, spherical(theta, phi), np.cos(np.radians(theta)))
        assert found.tolist() == list(range(145))

    def test_is_read_with_its_body(self, tmp_path):
        path = tmp_path / "matt.xml"
        exported(matt(), path, basis="klems")
        measurement = read_measurement(path)
        assert measurement.synthetic
        lit = np.minimum(measurement.to_lamp[:, 2], measurement.to_receiver[:, 2]) > 0.5
        body = np.median(measurement.radiance_factor[measurement.kept & lit])
        assert body == pytest.approx(np.mean(matt().diffuse.albedo), rel=0.1)

    def test_an_unknown_basis(self, tmp_path):
        with pytest.raises(InputError, match="tensor-tree"):
            exported(matt(), tmp_path / "a.xml", basis="half")
