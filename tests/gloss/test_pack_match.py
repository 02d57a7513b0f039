"""The finishes of a pack: matched one by one, in one picture."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from relgloss_view import Look, Scene, load_sample
from relgloss_view.base.errors import InputError
from relgloss_view.gloss.match import Reference, full_c, match_setups, matched
from relgloss_view.gloss.meter.meter import specular_gloss
from relgloss_view.gloss.pack_match import match_pack
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.material.material import Lobe
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.plain_finish import plain_finishes
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.pixel_sampling import samples_needed
from relgloss_view.picture.scene.setup import Lamp, Setup

DARK, LIGHT = 0.05, 0.4  #: Y of the artwork's upper and lower half
PAPERS = ("cast-coated", "art-coated", "matte-coated", "uncoated")


def finish(name, kind, paper, **entries):
    return Finish(name, kind, load_sample(paper), paper, **{"sigma_n_deg": 0.0, **entries})


def pack(base="matte-coated", spot="art-coated", **entries):
    """Ink, and a spot varnish over the dark upper half of an artwork that goes around."""
    xyz = np.full((64, 64, 3), LIGHT, dtype=np.float16)
    xyz[:32] = DARK
    mask = np.zeros((64, 64), dtype=np.uint8)
    mask[:32] = 255
    varnish = finish("spot", "varnish", spot, mask="spot.png", **entries)
    return Pack(
        "two finishes",
        Shape(),
        (finish("ink", "ink", base), varnish),
        Artwork(xyz, 1e3 * np.pi * Shape().diameter_m, 100.0),
        masks={"spot.png": mask},
    )


@pytest.fixture(scope="module")
def cast():
    """The reference of matches: cast-coated."""
    return Reference.default()


def test_luminance_is_that_of_the_artwork_where_the_finish_lies():
    ink, spot = plain_finishes(pack(), "D50")
    assert ink.luminance == pytest.approx(LIGHT, rel=1e-3)  # its lobes show below the mask only
    assert spot.luminance == pytest.approx(DARK, rel=1e-3)
    assert spot.material.specular == load_sample("art-coated").specular
    body = load_sample("matte-coated").diffuse  # of the ink below
    assert (spot.material.diffuse.model, spot.material.diffuse.sigma) == (body.model, body.sigma)
    again = plain_finishes(pack().with_finish("spot", k=2.0), "D50")
    assert again[0].luminance == ink.luminance


def test_the_same_material_serves_as_long_as_nothing_below_changes():
    one = pack()
    other = one.with_finish("spot", k=2.0, sigma_n_deg=1.0)
    before, after = plain_finishes(one, "D50"), plain_finishes(other, "D50")
    assert [a.material is b.material for a, b in zip(before, after, strict=True)] == [True, True]


@pytest.mark.parametrize("paper", ["matte-coated", "uncoated"])
def test_a_pack_of_one_finish_has_the_samples_own_match(cast, paper):
    single = Pack("one", Shape(), (finish("paper", "stock", paper, sigma_n_deg=None),))
    found = match_pack(cast, single)
    assert found.c == matched(cast, load_sample(paper), 2.0).test_c
    assert (found.pack.base.k, found.pack.base.sigma_n_deg) == (1.0, 2.0)
    assert match_pack(cast, single, 0.5).anchor.sigma_n_deg == 0.5


def displayed(renderer, found, setup, k=None, samples=4, size=(160, 160)):
    """What each finish's highlight adds to L* at its brightest pixel, in a picture of its own."""
    values = []
    for plain, own in zip(plain_finishes(found.pack, "D50"), found.finishes, strict=True):
        frame = renderer.render(Scene(plain.material, setup), Look(c=1.0, samples=samples), size)
        l_s = frame.split[1][frame.coverage >= 1.0]
        values.append(float(l_s.max()) * found.c * (own.k if k is None else k))
    return np.array(values)


@pytest.fixture(scope="module")
def here(cast):
    """A match in one pose alone, and the pose."""
    setup = match_setups()[1]
    return match_pack(Reference.of(cast.sample, setup=setup), pack()), setup


class TestRatio:
    """Of displayed gloss c k L_s*, against the readings of a gloss meter."""

    def test_in_its_pose(self, here, renderer):
        found, setup = here
        real = specular_gloss(load_sample("art-coated"), 75.0)
        real /= specular_gloss(load_sample("matte-coated"), 75.0)
        ink, spot = displayed(renderer, found, setup)
        assert spot / ink == pytest.approx(real, rel=0.03)
        # One c for both shows what the materials do in this pose, which is far off.
        ink, spot = displayed(renderer, found, setup, k=1.0)
        assert spot / ink == pytest.approx(real / found.finishes[1].k, rel=0.03)
        assert abs(spot / ink / real - 1.0) > 0.2

    def test_in_one_picture(self, here, cast, reference):
        """Both finishes on one cylinder, drawn in float64: the spot above, the ink below."""
        found, setup = here
        real = found.finishes[1].reading / found.finishes[0].reading

        def ratio(drawn):
            scene = Scene(drawn.material, setup, pack=drawn)
            frame = reference.render(scene, Look(c=found.c, samples=2), (96, 96))
            whole, l_s = frame.coverage >= 1.0, frame.split[1]
            rows = np.arange(96)[:, None]  # those about the border show a mixture
            return l_s[whole & (rows < 46)].max() / l_s[whole & (rows > 50)].max()

        assert ratio(found.pack) == pytest.approx(real, rel=0.03)
        assert abs(ratio(pack()) / real - 1.0) > 0.1  # every k is 1

    def test_in_the_view_of_one_picture(self, cast, reference):
        """k of the view holds where the mean over the poses does not; c is no view's."""
        setup = match_setups()[3]
        mean, view = (
            match_pack(cast, pack("uncoated", "matte-coated"), 0.0, s) for s in (None, setup)
        )
        assert view.c == mean.c
        real = mean.finishes[1].reading / mean.finishes[0].reading

        def ratio(drawn):
            scene = Scene(drawn.material, setup, pack=drawn)
            frame = reference.render(scene, Look(sigma_n_deg=0.0, c=view.c), (96, 96))
            whole, l_s = frame.coverage >= 1.0, frame.split[1]
            rows = np.arange(96)[:, None]
            return l_s[whole & (rows < 46)].max() / l_s[whole & (rows > 50)].max()

        assert ratio(view.pack) == pytest.approx(real, rel=0.03)
        assert view.finishes[1].shown == pytest.approx(view.finishes[1].ratio)
        assert [f.in_view for f in view.finishes] == [True, True]
        assert not view.warnings
        assert abs(ratio(mean.pack) / real - 1.0) > 0.2  # the negative control

    @pytest.mark.parametrize(("azimuth_deg", "said"), [(16.0, "spot"), (120.0, "ink")])
    def test_without_a_highlight_in_the_view(self, cast, azimuth_deg, said):
        """A plane, whose mirror direction is elsewhere: only a broad lobe shows in it, or none."""
        flat = dataclasses.replace(pack("uncoated", "cast-coated"), shape=Shape("plane"))
        setup = Setup(Shape("plane"), Lamp(azimuth_deg))
        mean, view = (match_pack(cast, flat, 0.0, s) for s in (None, setup))
        assert view.finishes[1].k == mean.finishes[1].k
        (text,) = view.warnings
        assert text.startswith(f"finish {said!r}: its highlight is not seen in this view")

    def test_to_the_reference(self, here, cast, renderer):
        found, setup = here
        frame = renderer.render(
            Scene(cast.sample.material, setup), Look(c=1.0, samples=8), (512, 512)
        )
        peak = cast.c * float(frame.split[1][frame.coverage >= 1.0].max())
        ink, _ = displayed(renderer, found, setup)
        assert ink / peak == pytest.approx(found.finishes[0].ratio, rel=0.05)

    @pytest.mark.slow
    @pytest.mark.parametrize("base", PAPERS[1:])
    @pytest.mark.parametrize("spot", PAPERS[:3])
    def test_as_the_mean_over_the_poses(self, cast, renderer, base, spot):
        found = match_pack(cast, pack(base, spot))
        real = found.finishes[1].reading / found.finishes[0].reading
        ratios = [
            np.divide(*displayed(renderer, found, s, samples=8, size=(512, 512))[::-1])
            for s in match_setups()
        ]
        assert np.exp(np.mean(np.log(ratios))) == pytest.approx(real, rel=0.03)


def test_the_reference_cancels_between_finishes(cast):
    other = Reference.of(SampleLook("r", load_sample("uncoated"), Look(sigma_n_deg=2.0)))
    ks = [match_pack(r, pack()).finishes[1].k for r in (cast, other)]
    assert ks[0] == pytest.approx(ks[1], rel=1e-12)
    assert ks[0] < 1.0  # it shines more than the ink beside it, and the highlight is brighter yet


def test_a_chosen_k_is_kept(cast):
    free, kept = (match_pack(cast, pack(k=3.0, keeps_k=kept)) for kept in (False, True))
    assert kept.finishes[1].k == 3.0 != free.finishes[1].k
    assert kept.c == free.c
    assert free.finishes[1].shown == pytest.approx(free.finishes[1].ratio)
    factor = 3.0 / free.finishes[1].k
    assert kept.finishes[1].shown == pytest.approx(factor * free.finishes[1].ratio)


def test_c_is_that_of_the_first_finish_that_is_seen(cast):
    """A base below a varnish that lies everywhere shows no lobe of its own."""
    covered = pack()
    over = finish("over", "varnish", "uncoated", mask="everywhere")
    spot = covered.finishes[1]
    covered = dataclasses.replace(covered, finishes=(covered.base, over, spot))
    found = match_pack(cast, covered)
    assert found.anchor.name == "over"
    assert [f.k for f in found.finishes][1] == 1.0
    assert [w for w in found.warnings if "lies nowhere" in w] == [found.warnings[0]]
    assert found.glossiest.name == "spot"


def test_without_a_highlight_c_is_the_references(cast):
    flat = dataclasses.replace(load_sample("uncoated"), specular=())
    bare = Pack("bare", Shape(), (Finish("bare", "stock", flat, k=7.0),))
    found = match_pack(cast, bare)
    assert (found.c, found.finishes[0].k) == (cast.c, 1.0)
    assert "no highlight" in found.warnings[0]


def test_a_pack_is_no_reference():
    with pytest.raises(InputError, match="can't be the reference"):
        Reference.of(SampleLook("p", pack().material, Look(), pack()))


def test_a_pack_is_ranked_by_its_glossiest_finish():
    one = pack()
    sample = SampleLook("p", one.material, Look(), one)
    assert sample.judged_material is one.finishes[1].material
    sigma = [s for _, s in sample.parts(match_setups()[0])]
    assert sigma == [0.0, 0.0]
    assert full_c(sample.judged_material) > 0.0


def test_warnings_name_the_finish():
    paper = load_sample("uncoated")
    narrow = dataclasses.replace(paper, specular=(Lobe((1.0,), 0.01),))
    one = pack()
    spot = dataclasses.replace(one.finishes[1], material=narrow)
    scene = Scene(one.material, pack=dataclasses.replace(one, finishes=(one.base, spot)))
    (text,) = scene.warnings
    assert text.startswith("finish 'spot': specular[0].s_deg")
    assert Scene(narrow).warnings == narrow.warnings
    # The narrowest lobe of any finish decides how many samples a pixel needs.
    assert samples_needed(scene, (128, 128)) == samples_needed(Scene(narrow), (128, 128)) > 1
    assert samples_needed(Scene(one.material), (128, 128)) == 1
