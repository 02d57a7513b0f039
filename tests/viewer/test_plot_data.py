"""What the plots show, against closed forms, published values and numpy's own counts."""

from __future__ import annotations

from dataclasses import replace

import materials
import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.material import brdf
from relgloss_view.material.material import Diffuse, FitRecord, Lobe, Material
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.gonio import direction, gcms_directions
from relgloss_view.measure.table import KEPT, NEGATIVE, SATURATED, Measurement
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.frame import Extremes, Frame, Scaling
from relgloss_view.picture.output.export import save_frame
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.viewer.plots import reflection
from relgloss_view.viewer.plots.caches import PerFrame, Recent, light_of
from relgloss_view.viewer.plots.lightness import BINS, Lightness
from relgloss_view.viewer.plots.readout import Stages, half_vector_deg

SIZE = (96, 80)
GLOSSY = Lobe((1.0,), 3.0)


class TestReflection:
    @pytest.mark.parametrize("lamp", ["HP5", "A"])
    @pytest.mark.parametrize("incidence", [0.0, 40.0, 85.0])
    def test_gray_lambert_is_rho_over_pi_under_every_lamp(self, lamp, incidence):
        cut = reflection.brdf_slice(materials.flat(0.4), lamp, incidence)
        np.testing.assert_allclose(cut.diffuse, 0.4 / np.pi, rtol=1e-9)
        np.testing.assert_allclose(reflection.radiance_factor(cut.total), 0.4, rtol=1e-9)
        assert not np.any(cut.specular)
        assert (cut.receiver_deg[0], cut.receiver_deg[-1]) == (-85.0, 85.0)
        assert np.all(np.diff(cut.receiver_deg) > 0.0)

    @pytest.mark.parametrize("incidence", [0.0, 30.0, 60.0])
    def test_lobe_peaks_at_the_mirror_direction_by_the_closed_form(self, incidence):
        """There delta is 0: f = k F(cos) / (4 cos^2) (1 + 4 s^2/3) / (2 pi s^2), and G is 1."""
        s = np.radians(0.5)
        cut = reflection.brdf_slice(materials.flat(0.2, (Lobe((0.8,), 0.5),)), "HP5", incidence)
        at = int(np.argmin(np.abs(cut.receiver_deg - incidence)))
        cos = np.cos(np.radians(incidence))
        q = np.sqrt(1.5**2 - 1.0 + cos**2)
        parallel = (cos * 2.25 - q) / (cos * 2.25 + q)
        fresnel = 0.5 * (parallel**2 + ((cos - q) / (cos + q)) ** 2)  # Fresnel's equations, Hecht
        peak = 0.8 * fresnel * (1.0 + 4.0 * s * s / 3.0) / (2.0 * np.pi * s * s * 4.0 * cos**2)
        assert cut.receiver_deg[at] == pytest.approx(incidence, abs=1e-9)
        assert cut.specular[at] == pytest.approx(peak, rel=1e-4)
        assert cut.specular[at] >= 0.98 * np.max(cut.specular)

    def test_luminance_is_y_of_the_spectrum(self):
        albedo = (0.1, 0.5, 0.3)
        material = Material("", "", RGB, Diffuse("lambert", albedo))
        cut = reflection.brdf_slice(material, "D65", 10.0)
        expected = np.dot(albedo, (0.2126, 0.7152, 0.0722))  # IEC 61966-2-1
        np.testing.assert_allclose(np.pi * cut.total, expected, atol=2e-4)

    def test_polar_radius_and_angle(self):
        along, across = reflection.to_polar(np.array([0.0, 90.0, -30.0]), np.array([2.0, 3.0, 4.0]))
        np.testing.assert_allclose(along, [2.0, 0.0, 4.0 * np.sqrt(3.0) / 2.0], atol=1e-12)
        np.testing.assert_allclose(across, [0.0, 3.0, -2.0], atol=1e-12)

    def test_albedo_of_lambert_and_of_a_smooth_interface(self):
        albedo = reflection.albedo_curve(materials.flat(0.35, (Lobe((0.7,), 0.1),)), "HP5")
        np.testing.assert_allclose(albedo.diffuse, 0.35, rtol=1e-3)
        upto = albedo.incidence_deg <= 60.0
        fresnel = brdf.fresnel_dielectric(np.cos(np.radians(albedo.incidence_deg[upto])), 1.5)
        np.testing.assert_allclose(albedo.specular[upto], 0.7 * fresnel, rtol=0.01)
        np.testing.assert_allclose(albedo.total, albedo.diffuse + albedo.specular)

    def test_a_lamp_that_is_none_is_refused(self):
        with pytest.raises(InputError):
            reflection.brdf_slice(materials.flat(), "no such lamp.csv", 10.0)

    def test_another_material_or_lamp_is_never_shown_the_old_curve(self):
        lobes, fit = (GLOSSY,), FitRecord(candidates=({"name": "x"},))
        spectrum = tuple(np.linspace(0.1, 0.9, 35))
        first = replace(materials.flat(0.5, lobes), diffuse=Diffuse("lambert", spectrum), fit=fit)
        second = replace(first, diffuse=Diffuse("lambert", tuple(reversed(spectrum))))

        def seen(material, lamp, incidence=10.0):
            cut = reflection.brdf_slice(material, lamp, incidence)
            return float(cut.diffuse[0]), float(reflection.albedo_curve(material, lamp).diffuse[0])

        of_first = seen(first, "HP5")
        assert seen(first, "A")[0] > of_first[0]  # incandescent light holds more red
        assert seen(second, "HP5")[0] != pytest.approx(of_first[0], rel=1e-3)
        assert seen(second, "HP5")[1] != pytest.approx(of_first[1], rel=1e-3)
        assert seen(first, "HP5") == of_first
        untried = materials.flat(0.123)
        assert reflection.albedo_curve(untried, "HP5", wait=False) is None
        for k in range(20):  # objects come and go, their ids come back
            albedo = 0.02 * (k + 1)
            assert seen(materials.flat(albedo), "HP5")[0] == pytest.approx(albedo / np.pi)

    def test_an_edited_lamp_file_is_not_shown_the_old_curve(self, tmp_path):
        spectrum = tuple(np.linspace(0.1, 0.9, 35))
        material = replace(materials.flat(), diffuse=Diffuse("lambert", spectrum))
        lamp = tmp_path / "lamp.csv"
        seen = []
        for red in (1, 10):
            lines = [f"{w},{red if w > 550 else 5:03d}" for w in range(380, 781, 5)]
            lamp.write_text("\n".join(lines) + "\n" * red)
            seen.append(float(reflection.brdf_slice(material, str(lamp), 10.0).diffuse[0]))
        assert seen[1] > 1.1 * seen[0]


class TestMeasuredPoints:
    @staticmethod
    def measurement(**changes):
        alpha, beta, gamma = np.array(
            [(a, b, g) for a in (-30.0, 60.0) for b in range(-70, 71, 10) for g in (15.0, 30.0)]
        ).T
        to_lamp, to_receiver = gcms_directions(alpha, beta, gamma)
        factor = np.repeat((1.0 + beta / 100.0)[:, None], 3, axis=1)
        reasons = np.full(len(alpha), KEPT, dtype=object).astype(np.str_).astype("<U40")
        told = Measurement(
            "m", "synthetic", to_lamp, to_receiver, RGB, factor, reasons, np.arange(len(alpha))
        )
        return replace(told, **changes)

    def test_only_the_plane_of_incidence_and_only_near_the_angle(self):
        m = self.measurement()
        points = reflection.measured_points(m, "D65", 30.0)
        # alpha = -30 has the mirror side at positive beta; gamma = 30 leaves the plane, but for
        # the receiver in line with the lamp's plane.
        np.testing.assert_allclose(points.receiver_deg, np.arange(-70.0, 71.0, 10.0), atol=1e-5)
        np.testing.assert_allclose(np.pi * points.value, 1.0 + np.arange(-70, 71, 10) / 100.0)
        mirrored = reflection.measured_points(m, "D65", 60.0)  # alpha = +60: the other way round
        np.testing.assert_allclose(np.pi * mirrored.value, 1.0 - np.arange(-70, 71, 10) / 100.0)
        assert reflection.measured_points(m, "D65", 45.0) is None
        assert reflection.measured_incidences(m).tolist() == [30.0, 60.0]

    def test_what_is_left_out_is_not_shown(self):
        m = self.measurement()
        reasons = m.reasons.copy()
        reasons[:6] = SATURATED
        reasons[6] = NEGATIVE  # of a saturated colour in linear sRGB; its luminance is positive
        factor = m.radiance_factor.copy()
        factor[8] = np.nan
        shown = reflection.measured_points(
            replace(m, reasons=reasons, radiance_factor=factor), "D65", 30.0
        )
        expected = [-40.0, *np.arange(-20.0, 71.0, 10.0)]
        np.testing.assert_allclose(shown.receiver_deg, expected, atol=1e-5)

    def test_points_of_a_material_lie_on_its_slice(self):
        material = load_sample("matte-coated")
        angles = np.arange(-60.0, 61.0, 20.0)
        to_lamp = np.broadcast_to(direction(-40.0), (len(angles), 3))
        diffuse, specular = material.evaluate(to_lamp, direction(angles))
        m = replace(
            self.measurement(),
            bands=material.bands,
            to_lamp=to_lamp,
            to_receiver=direction(angles),
            radiance_factor=np.pi * (diffuse + specular),
            reasons=np.full(len(angles), KEPT, dtype="<U40"),
        )
        points = reflection.measured_points(m, "HP5", 40.0)
        cut = reflection.brdf_slice(material, "HP5", 40.0)
        on_curve = np.interp(points.receiver_deg, cut.receiver_deg, cut.total)
        np.testing.assert_allclose(points.value, on_curve, rtol=1e-6)

    def test_apertures_lower_the_peak_by_the_closed_form(self):
        """science.md section 3: [(1+(E/2s)^2)(1+(E/(2 s cos))^2)]^-1/2."""
        material = materials.flat(0.0, (Lobe((1.0,), 1.0),))
        sharp = reflection.brdf_slice(material, "HP5", 30.0)
        blurred = reflection.seen_through_apertures(material, "HP5", 30.0, (0.8, 0.6))
        ratio = np.max(blurred.value) / np.max(sharp.total)
        cos = np.cos(np.radians(30.0))
        expected = ((1 + 0.5**2) * (1 + (0.5 / cos) ** 2)) ** -0.5
        assert ratio == pytest.approx(expected, rel=0.01)
        assert reflection.seen_through_apertures(material, "HP5", 30.0, (0.0, 0.0)) is None


@pytest.fixture
def frame(renderer):
    """A glossy cylinder with grain, its highlight above the middle, some pixels clipped."""
    scene = Scene(materials.flat(0.3, (GLOSSY,)), lamp=Lamp(elevation_deg=20.0))
    return renderer.render(scene, Look(sigma_n_deg=1.0, c_fraction=1.4), SIZE)


class TestLightness:
    def test_line_is_the_frames_own_split(self, frame):
        lightness = Lightness.of(frame)
        l_d, l_s = frame.split
        row = int(np.unravel_index(np.argmax(l_s), l_s.shape)[0])
        assert lightness.highlight_row == lightness.default_row == row
        assert row < SIZE[1] // 2 - 3
        for k in (row, 0, SIZE[1] - 1):
            line = lightness.line(k)
            np.testing.assert_array_equal(line.l_d, l_d[k])
            np.testing.assert_array_equal(line.l_s, l_s[k])
            np.testing.assert_array_equal(line.plain, l_d[k] + l_s[k])
            np.testing.assert_array_equal(line.on_object, frame.on_object[k])
        # The tone pass on the GPU has scaled the same way.
        np.testing.assert_allclose(
            lightness.line(row).scaled(frame.c)[frame.on_object[row]],
            frame.lab[row, :, 0][frame.on_object[row]],
            atol=2e-3,
        )
        assert lightness.line(10**6).row == SIZE[1] - 1

    @pytest.mark.parametrize(("y", "lstar"), [(0.1842, 50.0), (1.0, 100.0), (0.5, 76.0693)])
    def test_published_lightness(self, y, lstar):
        """CIE 1976 L*: middle gray of 18.42 % is 50, a half is 76.07 (CIE 15)."""
        flat = np.full((2, 3), y)
        made = Lightness(flat, 0.0 * flat, flat > 0.0, np.zeros(0), np.zeros(0), None)
        np.testing.assert_allclose(made.line(0).l_d, lstar, atol=0.005)
        assert made.default_row == 1

    @pytest.mark.parametrize("c", [0.0, 0.3, 1.0])
    def test_histogram_counts_as_numpy_does(self, frame, c):
        histogram = Lightness.of(frame).histogram(c)
        l_d, l_s = frame.split
        total = (l_d + c * l_s)[frame.on_object]
        counts, _ = np.histogram(total[total <= 100.0], bins=np.arange(0.0, 101.0))
        # Single precision may move a pixel across an edge.
        assert np.max(np.abs(np.cumsum(histogram.share * len(total) - counts))) <= 2.0
        assert histogram.pixels == len(total)
        assert histogram.clipped == pytest.approx(np.mean(total > 100.001), abs=1e-9)
        assert np.sum(histogram.share) + histogram.clipped == pytest.approx(1.0)
        assert len(histogram.share) == BINS

    def test_the_frames_clipped_pixels_are_the_histograms(self, frame):
        histogram = Lightness.of(frame).histogram(frame.c)
        count = int(np.sum(frame.clipped))
        assert count > 0
        assert histogram.clipped * histogram.pixels == pytest.approx(count, abs=1.0)

    def test_a_part_of_the_pixels_stands_for_all(self, frame):
        lightness = Lightness.of(frame)
        part, whole = lightness.histogram(0.5, 1500), lightness.histogram(0.5)
        assert part.pixels <= 1500 < whole.pixels
        assert np.sum(part.share) + part.clipped == pytest.approx(1.0)
        middles = np.arange(BINS) + 0.5
        assert part.share @ middles == pytest.approx(whole.share @ middles, abs=1.0)

    def test_nothing_specular_and_nothing_seen(self, renderer):
        dull = Lightness.of(renderer.render(Scene(materials.flat(0.3)), Look(), SIZE))
        assert dull.highlight_row is None
        assert dull.default_row == SIZE[1] // 2
        inside = Eye(distance_m=0.01)
        empty = Lightness.of(renderer.render(Scene(materials.flat(0.3), eye=inside), Look(), SIZE))
        histogram = empty.histogram(1.0)
        assert (histogram.pixels, histogram.clipped, np.sum(histogram.share)) == (0, 0.0, 0.0)


class TestReadout:
    def test_it_reads_what_the_file_holds(self, frame, tmp_path):
        """OpenEXR's own reader returns the layers that the readout's numbers are made of."""
        import OpenEXR

        save_frame(frame, tmp_path / "frame.exr")
        with OpenEXR.File(str(tmp_path / "frame.exr"), separate_channels=True) as file:
            layers = {name: channel.pixels for name, channel in file.channels().items()}
        stages = Stages.of(frame)
        y_n = frame.y_n_cd_m2
        _, column = np.unravel_index(np.argmax(layers["specular.Y"]), SIZE[::-1])
        row = SIZE[1] // 2
        got = stages.read(int(column), row)
        assert got.on_object
        at = row, int(column)
        assert got.diffuse_cd_m2 == pytest.approx(y_n * layers["diffuse.Y"][at], rel=1e-6)
        assert got.specular_cd_m2 == pytest.approx(y_n * layers["specular.Y"][at], rel=1e-6)
        total = [layers[f"diffuse.{k}"][at] + layers[f"specular.{k}"][at] for k in "XYZ"]
        np.testing.assert_allclose(got.xyz, total, rtol=1e-6)
        assert (got.l_d, got.l_s) == pytest.approx((layers["Ld.Y"][at], layers["Ls.Y"][at]))
        np.testing.assert_allclose(
            got.lab, [layers[f"Lab.{k}"][at] for k in ("L", "a_star", "b_star")]
        )
        assert got.lab[0] == pytest.approx(got.l_d + frame.c * got.l_s, abs=2e-3)
        assert got.display_rgb == tuple(int(v) for v in frame.display[at])
        n, p, lamp, eye = (
            np.array([layers[f"N.{k}"][at] for k in "XYZ"], dtype=float),
            np.array([layers[f"P.{k}"][at] for k in "XYZ"], dtype=float),
            frame.scene.lamp.position_m,
            frame.scene.eye.position_m,
        )
        h = sum((q - p) / np.linalg.norm(q - p) for q in (lamp, eye))
        angle = np.degrees(np.arccos(n @ h / np.linalg.norm(h)))
        assert got.half_deg == pytest.approx(angle, abs=0.05)
        assert got.half_tilted_deg != pytest.approx(got.half_deg, abs=1e-6)  # the grain tilts it

    def test_flags_are_the_frames(self, frame):
        stages = Stages.of(frame)
        for mask, name in ((frame.clipped, "clipped"), (frame.on_object, "on_object")):
            for wanted in (True, False):
                row, column = np.argwhere(mask == wanted)[0]
                assert getattr(stages.read(int(column), int(row)), name) is wanted

    def test_out_of_gamut(self, renderer):
        """Pure green of a wide gamut can't be shown on sRGB; a gray can."""
        green = Material("", "", RGB, Diffuse("lambert", (0.0, 0.5, 0.0)))
        scene = Scene(green, shape=Shape("plane"), lamp=Lamp(azimuth_deg=0.0))
        narrow = replace(
            scene, display=Display(primaries_xy=((0.5, 0.35), (0.32, 0.45), (0.2, 0.2)))
        )
        middle = SIZE[0] // 2, SIZE[1] // 2
        assert Stages.of(renderer.render(narrow, Look(), SIZE)).read(*middle).out_of_gamut
        gray = replace(narrow, material=materials.flat(0.3))
        assert not Stages.of(renderer.render(gray, Look(), SIZE)).read(*middle).out_of_gamut

    def test_beyond_the_picture_and_off_the_object(self, frame):
        stages = Stages.of(frame)
        for place in ((-1, 0), (0, -1), (SIZE[0], 0), (0, SIZE[1])):
            assert stages.read(*place) is None
        corner = stages.read(0, 0)
        assert not corner.on_object
        assert corner.half_deg is None
        assert corner.display_rgb == tuple(int(v) for v in frame.display[0, 0])

    @pytest.mark.parametrize("azimuth", [0.0, 40.0, -80.0])
    def test_half_vector_of_a_plane_seen_head_on(self, renderer, azimuth):
        """At the plane's middle the half-vector lies halfway between eye (0) and lamp."""
        scene = Scene(materials.flat(), shape=Shape("plane"), lamp=Lamp(azimuth_deg=azimuth))
        odd = (65, 65)  # a pixel's centre lies at the middle
        got = Stages.of(renderer.render(scene, Look(), odd)).read(32, 32)
        assert got.half_deg == pytest.approx(abs(azimuth) / 2.0, abs=1e-3)
        assert got.half_tilted_deg == pytest.approx(got.half_deg, abs=1e-4)

    def test_half_vector_by_hand(self):
        """Lamp and eye at 45 degrees to either side; the normal tilted by 10 across them."""
        lamp, eye = np.array([1.0, 0.0, 1.0]), np.array([-2.0, 0.0, 2.0])
        tilted = np.array([0.0, np.sin(np.radians(10.0)), np.cos(np.radians(10.0))])
        assert half_vector_deg(tilted, np.zeros(3), lamp, eye) == pytest.approx(10.0)
        assert half_vector_deg(np.zeros(3), np.zeros(3), lamp, eye) is None
        assert half_vector_deg(tilted, np.zeros(3), lamp, -lamp) is None
        assert half_vector_deg(tilted, lamp, lamp, eye) is None

    def test_some_rows_read_as_all_do(self, frame):
        whole = Stages.of(frame)
        width, height = frame.size
        for row in (0, 7, height // 2, height - 1):
            some = Stages.of(frame, range(row - 6, row + 6))
            assert some.on_object.shape[0] < height / 2
            for column in (0, width // 2, width - 1):
                assert some.read(column, row) == whole.read(column, row)
                for name in ("rgb", "lstar", "inside"):
                    parts = (getattr(s.patch(column, row), name) for s in (some, whole))
                    np.testing.assert_array_equal(*parts)
            assert some.read(0, height + 3) is None
        assert Stages.of(frame, range(20, 30)).read(width // 2, 2) is None

    def test_patch_is_the_picture_around(self, frame):
        stages = Stages.of(frame)
        patch = stages.patch(40, 30)
        np.testing.assert_array_equal(patch.rgb, frame.display[26:35, 36:45])
        assert np.all(patch.inside)
        assert patch.lstar[4, 4] == min(100.0, frame.lab[30, 40, 0])
        corner = stages.patch(0, SIZE[1] - 1)
        assert np.sum(corner.inside) == 25
        assert corner.inside[4, 4]
        assert corner.lstar[4, 4] == frame.scene.display.background_lstar
        np.testing.assert_array_equal(corner.rgb[:5, 4:], frame.display[-5:, :5])


def made_up(scene, look, counter, c=None):
    """A frame whose stages count how often they are fetched."""

    def fetch(stage, rows=slice(4)):
        counter.append(stage)
        return np.full((4, 6, 4), 0.5, dtype=np.float32)[rows]

    scaling = Scaling.of(replace(look, c=c), Extremes(0.5, 40.0, 60.0, 40.0, 60.0))
    return Frame(scene, replace(look, c=c), (6, 4), scaling, fetch, "none")


class TestPerFrame:
    @pytest.fixture
    def scene(self):
        return Scene(materials.flat(0.3, (GLOSSY,)))

    def test_a_frame_is_fetched_once(self, scene):
        fetched, memory = [], PerFrame(Lightness.of, light_of)
        frame = made_up(scene, Look(), fetched)
        first, fresh = memory.get(frame, dragging=False)
        assert fresh
        count = len(fetched)
        assert count > 0
        again, fresh = memory.get(frame, dragging=True)
        assert again is first
        assert fresh
        assert len(fetched) == count

    def test_a_drag_fetches_nothing_and_its_end_brings_the_truth(self, scene):
        """Never stale once the hand lets go, whatever changed; and old values say they are."""
        fetched, memory = [], PerFrame(Lightness.of, light_of)
        old, _ = memory.get(made_up(scene, Look(), []), dragging=False)
        for k in range(1, 4):
            moved = made_up(replace(scene, lamp=Lamp(azimuth_deg=10.0 * k)), Look(), fetched)
            assert memory.get(moved, dragging=True) == (old, False)
            assert memory.get(moved, dragging=True) == (old, False)
        assert not fetched
        new, fresh = memory.get(moved, dragging=False)
        assert fresh
        assert new is not old
        assert fetched

    @pytest.mark.parametrize("keyed", [True, False])
    def test_c_and_the_display_leave_the_light_as_it_is(self, scene, keyed):
        fetched = []
        memory = PerFrame(Lightness.of, light_of) if keyed else PerFrame(Lightness.of)
        value, _ = memory.get(made_up(scene, Look(), []), dragging=False)
        for c in (0.1, 0.2):
            assert memory.get(made_up(scene, Look(), fetched, c), dragging=True) == (value, keyed)
        gray = replace(scene, display=Display(background_lstar=20.0))
        assert memory.get(made_up(gray, Look(), fetched), dragging=True) == (value, keyed)
        assert not fetched
        # Let go: what depends on c too is made again, in either case.
        assert memory.get(made_up(gray, Look(), fetched), dragging=False)[0] is not value

    @pytest.mark.parametrize(
        "changes",
        [
            {"look": Look(sigma_n_deg=1.0)},
            {"look": Look(seed=3)},
            {"scene": {"lamp": Lamp(luminance_cd_m2=50.0)}},
            {"scene": {"material": materials.flat(0.4, (GLOSSY,))}},
            {"scene": {"eye": Eye(distance_m=1.0)}},
        ],
    )
    def test_everything_else_counts(self, scene, changes):
        memory = PerFrame(Lightness.of, light_of)
        memory.get(made_up(scene, Look(), []), dragging=False)
        other = made_up(replace(scene, **changes.get("scene", {})), changes.get("look", Look()), [])
        assert memory.get(other, dragging=True)[1] is False

    def test_no_frame_no_value(self, scene):
        memory = PerFrame(Lightness.of, light_of)
        assert memory.get(None, dragging=False) == (None, False)
        frame = made_up(scene, Look(), [])
        assert memory.get(frame, dragging=True) == (None, False)  # nothing yet, and no fetching
        assert memory.get(frame, dragging=False)[1]
        assert memory.get(None, dragging=False) == (None, False)
        assert memory.get(frame, dragging=True) == (None, False)

    def test_a_failure_leaves_nothing_behind(self, scene):
        def fails(_frame):
            raise InputError("gone")

        memory = PerFrame(fails)
        frame = made_up(scene, Look(), [])
        for _ in range(2):
            with pytest.raises(InputError):
                memory.get(frame, dragging=False)


def test_recent_keeps_the_last_few_by_identity():
    recent, made = Recent(2), []

    def ask(source, key):
        return recent.get(source, key, lambda: made.append(key) or len(made))

    a, b = [1], [1]  # equal, and not the same
    assert [ask(a, "k"), ask(a, "k"), ask(b, "k"), ask(a, "other")] == [1, 1, 2, 3]
    assert ask(a, "k") == 4  # pushed out


def test_plots_load_no_heavy_library():
    import subprocess
    import sys

    code = (
        "import sys\n"
        "from relgloss_view.viewer.plots import lightness, readout, reflection\n"
        "from relgloss_view.viewer.panels import fit, lightness, pixel, reflection\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.split(".")[0] for name in done.stdout.split()}
    assert not loaded & {"scipy", "matplotlib", "colour", "moderngl", "OpenEXR", "PIL"}
    assert "relgloss_view.fitting" not in done.stdout
