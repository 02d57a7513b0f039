"""The table of domains against the maps, computed afresh: inside the bound holds, beyond it breaks.

A limit may stop short of where its bound breaks by SLACK of itself: a table of round numbers is
easier to keep in mind, and the maps are of some refractive index and some albedo.
"""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest

from relgloss_view.base.resources import data_root
from relgloss_view.bench.stability import grain_errors, maps
from relgloss_view.material import approximations, brdf
from relgloss_view.material.material import Lobe
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.method import Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.quality import domains
from relgloss_view.quality.domains import DOMAINS, QUANTITIES, outside, survey

SLACK = 0.25
BEYOND = 1.0 + SLACK
#: Those of the figures, and angles that the boxes of the grain lead to.
SUBJECTS = (
    *(s for s in maps.SUBJECTS if s.key is not None),
    maps.grain("mean", 55.0),
    maps.grain("mean", 85.0),
    maps.grain("none", 85.0),
)
#: Widths and sigma_N for the grain, whose quadrature takes its time.
GRAIN_S_DEG = np.array([0.1, 1.0, 4.0, 8.0, 15.0, 20.0, 40.0])
GRAIN_SIGMA_N_DEG = np.array([0.02, 0.12, 0.5, 0.9, 1.0, 1.4, 2.0, 3.5, 4.0, 4.3, 9.0, 11.0])
#: Limits that stand at an end of what can be, not where the error does.
AT_AN_END = {
    (("facets", "gaussian"), "s_deg"),
    (("facets", "gaussian"), "incidence_deg"),
    (("facets", "beckmann"), "s_deg", "low"),
    (("c_max", "eq4"), "s_deg", "low"),
    (("targets", "float32"), "peak_y"),
}
#: Limits with a test of their own below.
BY_ITSELF = {"refractive_index", "left_out_y"}
#: ... and the diffuse part's limit of a grain that is not drawn on it.
OF_THE_DIFFUSE_PART = {(("noise", "none"), "sigma_n_deg"), (("noise", "specular"), "sigma_n_deg")}


def near(axis, limits, count):
    """Some values of a map's axis, and some about the limits that a domain sets it."""
    wanted = [limit * share for limit in limits for share in (0.9, 1.0, 1.02, 1.12, BEYOND)]
    low, high = axis.values[0], axis.values[-1]
    return np.unique([*axis.coarse(count), *(v for v in wanted if low <= v <= high)])


def cells(subject):
    """(x, y) of a subject: coarse, but fine about the limits of its domain."""
    if subject.page == "grain" and subject.name != "distant":
        s, sigma_n = np.meshgrid(GRAIN_S_DEG, GRAIN_SIGMA_N_DEG)
        ratio = (sigma_n / s).ravel()
        usable = ratio <= 5.0
        return s.ravel()[usable], ratio[usable]
    limits = {v for box in subject.domain.boxes for span in box.values() for v in span if v > 0.0}
    x, y = (near(axis, limits, 14) for axis in (subject.x, subject.y))
    return tuple(v.ravel() for v in np.meshgrid(x, y))


@pytest.fixture(scope="module")
def computed(_session_ctx):
    """x, y, error of a subject's cells, computed once, when first asked for."""
    known = {}

    def of(subject):
        if subject.name not in known:
            x, y = cells(subject)
            with np.errstate(all="ignore"):
                error = subject.error(_session_ctx, x, y)
            known[subject.name] = x, y, np.where(np.isfinite(error), error, np.inf)
        return known[subject.name]

    return of


@pytest.mark.parametrize("subject", SUBJECTS, ids=lambda s: s.name)
def test_inside_its_domain_a_choice_holds(computed, subject):
    x, y, error = computed(subject)
    inside = subject.inside(x, y)
    if not subject.domain.boxes:
        assert not np.any(inside)
        assert np.min(error) > subject.domain.bound
        return
    worst = int(np.argmax(np.where(inside, error, 0.0)))
    assert error[worst] <= subject.domain.bound or not inside[worst], (x[worst], y[worst])


@pytest.mark.slow
def test_inside_its_domain_a_choice_holds_on_the_whole_map(ctx):
    for made in maps.all_maps(ctx):
        if made.subject.domain is not None:
            worst = np.max(made.error[made.inside], initial=0.0)
            assert worst <= made.subject.domain.bound, made.subject.name


def _edges():
    for key, domain in DOMAINS.items():
        for k, box in enumerate(domain.boxes):
            for quantity, (low, _) in box.items():
                for end in ("low", "high") if low > 0.0 else ("high",):
                    untested = quantity in BY_ITSELF or (key, quantity) in OF_THE_DIFFUSE_PART
                    known = {(key, quantity), (key, quantity, end)} & AT_AN_END
                    if not untested and not known and key != ("c_max", "once"):
                        yield pytest.param(
                            key, k, quantity, end, id=f"{'-'.join(key)}-{k}-{quantity}-{end}"
                        )


@pytest.mark.parametrize(("key", "k", "quantity", "end"), list(_edges()))
def test_just_beyond_its_domain_it_breaks(computed, key, k, quantity, end):
    """One limit moved out by SLACK: some cell that comes in breaks the bound."""
    domain = DOMAINS[key]
    low, high = domain.boxes[k][quantity]
    span = (low / BEYOND, high) if end == "low" else (low, high * BEYOND)
    boxes = list(domain.boxes)
    boxes[k] = {**boxes[k], quantity: span}
    worst, entered = 0.0, 0
    for subject in (s for s in SUBJECTS if s.key == key):
        x, y, error = computed(subject)
        numbers = subject.numbers(x, y)
        grown = _holds(dataclasses.replace(domain, boxes=tuple(boxes)), numbers, len(x))
        coming = grown & ~_holds(domain, numbers, len(x))
        entered += int(np.sum(coming))
        worst = max(worst, float(np.max(error[coming], initial=0.0)))
    assert entered > 0, "no cell comes in: the test's grid is too coarse"
    assert worst > domain.bound, f"the largest error of {entered} cells is {worst:.3g}"


def _holds(domain, numbers, count):
    given = {name: np.broadcast_to(v, (count,)) for name, v in numbers.items()}
    anything = dict.fromkeys(QUANTITIES, (np.inf, -np.inf))
    rows = ({n: (float(v[j]), float(v[j])) for n, v in given.items()} for j in range(count))
    return np.array([domain.holds({**anything, **row}) for row in rows])


class TestByItself:
    """Limits that no map shows."""

    @pytest.mark.parametrize("value", ["schlick", "constant"])
    def test_index_of_the_fresnel_terms(self, value):
        domain = DOMAINS["fresnel", value]
        (box,) = domain.boxes
        low, high = box["refractive_index"]
        c = np.cos(np.radians(np.linspace(*box["incidence_deg"], 100)))

        def worst(n):
            exact = brdf.fresnel_dielectric(c, n)
            return np.max(np.abs(approximations.fresnel(value, c, n) / exact - 1.0))

        assert max(worst(n) for n in np.linspace(low, high, 30)) <= domain.bound
        assert worst(1.0 + (low - 1.0) / BEYOND**2) > domain.bound

    def test_grain_on_the_diffuse_part(self):
        for value in ("specular", "none"):
            domain = DOMAINS["noise", value]
            limit = max(box["sigma_n_deg"][1] for box in domain.boxes)
            _, rms = grain_errors.diffuse_grain_errors([limit, BEYOND * limit])
            assert rms[0] <= domain.bound < rms[1]
        limit = max(box["sigma_n_deg"][1] for box in DOMAINS["noise", "mean"].boxes)
        mean, _ = grain_errors.diffuse_grain_errors([limit])
        assert mean[0] <= DOMAINS["noise", "mean"].bound

    def test_c_max_of_the_smooth_surface(self):
        domain = DOMAINS["c_max", "once"]
        limit = domain.boxes[0]["grain_ratio"][1]
        within, beyond = grain_errors.once_error([limit, BEYOND * limit])
        assert within <= domain.bound < beyond

    def test_a_lobe_left_out(self):
        for value in ("0", "1"):
            domain = DOMAINS["lobes", value]
            limit = domain.boxes[0]["left_out_y"][1]
            shown = tone.lightness(np.array([limit, BEYOND * limit]))
            assert shown[0] <= domain.bound * (1.0 + 1e-9)
            assert shown[1] > domain.bound

    def test_every_choice_of_the_table_is_one_of_a_method(self):
        for axis, value in DOMAINS:
            kept = next(f for f in dataclasses.fields(Method) if f.name == axis)
            options = kept.metadata.get("options") or ("0", "1", "2")
            assert value in options
        named = {name for d in DOMAINS.values() for box in d.boxes for name in box}
        assert named <= set(QUANTITIES)


class TestOutside:
    def test_what_is_exact_is_never_outside(self):
        for name in materials.PAPERS:
            for azimuth_deg in (20.0, 110.0, 170.0):
                scene = Scene(materials.paper(name), lamp=Lamp(azimuth_deg=azimuth_deg))
                assert outside(scene, Look(sigma_n_deg=2.0), Method()) == ()

    def test_fresnel_depends_on_the_lamp(self):
        method = Method(fresnel="schlick")
        for azimuth_deg, expected in ((40.0, ()), (110.0, ("fresnel schlick",))):
            scene = Scene(load_sample("art-coated"), lamp=Lamp(azimuth_deg=azimuth_deg))
            assert outside(scene, Look(), method) == expected

    def test_what_a_scene_does_not_have_is_never_outside(self):
        everything = Method(
            fresnel="constant",
            shadowing="none",
            facets="ggx",
            diffuse="lambert",
            noise="none",
            c_max="eq4",
        )
        flat = Scene(materials.flat(0.5), lamp=Lamp(azimuth_deg=150.0))
        assert outside(flat, Look(), everything) == ()
        rough = Scene(materials.paper("uncoated"), lamp=Lamp(azimuth_deg=150.0))
        assert set(outside(rough, Look(sigma_n_deg=2.0), everything)) == {
            *("fresnel constant", "shadowing none", "facets ggx", "diffuse lambert"),
            *("noise none", "c_max eq4"),
        }

    def test_without_a_lobe_only_the_diffuse_part_counts(self):
        """A matt surface sees little of what would shift or blur a highlight."""
        flat = Scene(materials.flat(0.5), lamp=Lamp(distance_m=5.0))
        for method in (Method(noise="none"), Method(lamp="distant")):
            assert outside(flat, Look(sigma_n_deg=2.0), method) == ()
        near = dataclasses.replace(flat, lamp=Lamp(distance_m=0.5))
        assert outside(near, Look(), Method(lamp="distant")) == ("lamp distant",)
        assert outside(flat, Look(sigma_n_deg=5.0), Method(noise="none")) == ("noise none",)
        shiny = dataclasses.replace(flat, material=materials.paper("cast"))
        assert outside(shiny, Look(), Method(lamp="distant")) == ("lamp distant",)
        assert outside(shiny, Look(sigma_n_deg=2.0), Method(noise="none")) == ("noise none",)

    def test_a_lobe_that_shows_nowhere_does_not_count(self):
        weak = Lobe((1e-4,), 35.0)
        scene = Scene(materials.flat(0.3, (Lobe((1.0,), 2.0), weak)))
        assert survey(scene, Look(), Method())["s_deg"] == pytest.approx((2.0, 2.0))
        assert outside(scene, Look(), Method(lobes=1)) == ()
        plain = dataclasses.replace(weak, strength=(1.0,))
        scene = Scene(materials.flat(0.3, (Lobe((1.0,), 2.0), plain)))
        assert survey(scene, Look(), Method())["s_deg"] == pytest.approx((2.0, 35.0))
        assert outside(scene, Look(), Method(lobes=1)) == ("lobes 1",)

    @pytest.mark.parametrize("kind", ["cylinder", "sphere", "plane", "box"])
    def test_the_survey_is_what_a_picture_shows(self, renderer, kind):
        """The half angle over the pixels, and the brightest of them from above."""
        scene = Scene(materials.paper("matte"), shape=Shape(kind), lamp=Lamp(azimuth_deg=40.0))
        found = survey(scene, Look(), Method())
        frame = renderer.render(scene, Look(c=0.1), (200, 200))
        point = frame.point_m.astype(np.float64)
        i, o = (place - point for place in (scene.lamp.position_m, scene.eye.position_m))
        i, o = (v / np.linalg.norm(v, axis=-1, keepdims=True) for v in (i, o))
        half = np.degrees(np.arccos(np.clip(0.5 * np.linalg.norm(i + o, axis=-1), 0.0, 1.0)))
        half = half[frame.on_object & (frame.diffuse[..., 1] > 0.0)]
        # The survey's rays are 24 to a side: an eighth of a degree here from one to the next.
        np.testing.assert_allclose(found["incidence_deg"], (half.min(), half.max()), atol=0.3)
        # From above; half as much again at most where the highlight's own normal is not there.
        brightest = float(np.max(frame.specular[..., 1]))
        assert brightest <= found["peak_y"][1] * 1.02
        if kind in ("cylinder", "sphere"):
            assert found["peak_y"][1] < 1.5 * brightest

    @pytest.mark.parametrize("eye", [Eye(distance_m=0.02), Eye(field_of_view_deg=1.0, shift_up=9)])
    def test_nothing_seen_is_nothing_wrong(self, eye):
        """Where no ray meets the object nothing is measured, and nothing fails."""
        scene = Scene(materials.paper("cast"), eye=eye)
        found = survey(scene, Look(), Method())
        assert found["peak_y"] == (0.0, 0.0)
        assert outside(scene, Look(), Method()) == ()

    def test_it_is_quick(self):
        """The planner asks for it at every move of a slider: a survey is 576 rays."""
        assert domains.SURVEY[0] * domains.SURVEY[1] < 3000


def row(key, domain):
    """A domain as docs/stability.md tells it."""
    boxes = [
        ", ".join(
            f"{name} {low:g} to {high:.3g}" if low else f"{name} to {high:.5g}"
            for name, (low, high) in box.items()
        )
        for box in domain.boxes
    ]
    where = "; or ".join(boxes) or "nowhere"
    return f"| {' '.join(key)} | {domain.bound:g} {domain.error} | {where} |"


@pytest.mark.parametrize("key", list(DOMAINS), ids="-".join)
def test_the_document_tells_the_table(key):
    text = (data_root() / "docs" / "stability.md").read_text(encoding="utf-8")
    assert row(key, DOMAINS[key]) in text
