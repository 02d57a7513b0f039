import dataclasses

import materials
import numpy as np
import pytest
from pictures import assert_same_pixels

from relgloss_view.bench.speed import methods
from relgloss_view.display.model import DisplayModel
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.quality.proxy import HIGHLIGHT_LSTAR, Proxy
from relgloss_view.quality.sampling import _spans

SIZE = (192, 108)
#: Y_n and c that do not depend on which pixels are looked at, so that pixels can be compared.
FIXED = {"y_n": "front"}


def scene(sample="matte-coated", azimuth_deg=50.0, **shape):
    wide = {"diameter_m": 0.125, "height_m": 0.075, **shape}
    return Scene(
        load_sample(sample), shape=Shape(**wide), lamp=Lamp(azimuth_deg=azimuth_deg, **FIXED)
    )


def shown_lab(frame):
    """Lab of what the display shows, gamut mapping included."""
    display = DisplayModel.of(frame.scene.display)
    xyz = frame.light.astype(np.float64) @ display.xyz_from_rgb.T
    return tone.lab_from_xyz(xyz, display.white)


def at(proxy, stage):
    columns, rows = proxy._pixel.T
    return stage[rows, columns].astype(np.float64)


SCENES = {
    "cylinder": {},
    "sphere": {"kind": "sphere"},
    "plane": {"kind": "plane", "width_m": 0.1},
    "box": {"kind": "box", "width_m": 0.1},
}


@pytest.mark.parametrize("shape", list(SCENES))
def test_its_pixels_are_the_pictures(shape):
    """The same float64 arithmetic with spectra folded beforehand: 1e-9 is rounding."""
    drawn = scene(**SCENES[shape])
    if shape == "box":
        drawn = dataclasses.replace(drawn, eye=Eye(azimuth_deg=20.0, elevation_deg=15.0))
    look = Look(sigma_n_deg=1.5, c=0.4, grain="surface" if shape == "sphere" else "screen")
    frame = ReferenceRenderer().render(drawn, look, SIZE)
    proxy = Proxy(drawn, look, SIZE)
    assert not proxy.empty
    assert np.all(at(proxy, frame.on_object))
    np.testing.assert_allclose(proxy.exact.lab, at(proxy, shown_lab(frame)), atol=1e-7)
    assert np.sum(proxy.area) == pytest.approx(np.sum(frame.on_object), rel=0.02)


METHODS = [
    Method(diffuse="lambert"),
    Method(diffuse="qualitative"),
    Method(diffuse="eon"),
    Method(lobes=0),
    Method(lobes=1),
    Method(fresnel="schlick"),
    Method(fresnel="constant"),
    Method(shadowing="none"),
    Method(facets="beckmann"),
    Method(facets="ggx"),
    Method(noise="none"),
    Method(noise="mean"),
    Method(noise="specular"),
    Method(lamp="distant"),
    Method(gamut="clip"),
    Method(split="first pass"),
    Method(variant=(("writes", "xyz"),)),
    Method(variant=(("bands", 35),)),
    Method(variant=(("cube_root", "power"),)),
    Method(variant=(("cube_root", "table"),)),
    Method(lobes=1, diffuse="lambert", fresnel="schlick", shadowing="none", lamp="distant"),
]


@pytest.mark.parametrize(
    "method", METHODS, ids=lambda m: str(m.differences() or (m.variant, m.split))
)
@pytest.mark.parametrize("azimuth_deg", [50.0, 85.0])
def test_shaders_draw_what_the_method_says(renderer, method, azimuth_deg):
    """The GPU's variant against the float64 one: the same bound as for the whole model, 0.02."""
    drawn, look = scene("uncoated", azimuth_deg), Look(sigma_n_deg=1.5, c=0.4)
    frame = renderer.render(drawn, look, SIZE, method)
    proxy = Proxy(drawn, look, SIZE)
    expected = proxy.draw(method).lab
    error = delta_e_2000(at(proxy, shown_lab(frame)), expected)
    # A draw of the tilt may fall on the other side of a halving in float32, at the silhouette.
    assert np.quantile(error, 0.999) < 0.02
    assert frame.method == method


@pytest.mark.parametrize(
    "method",
    [m for m in METHODS if {*m.differences()} in ({"diffuse"}, {"fresnel"}, {"facets"})],
    ids=lambda m: str(m.differences()),
)
def test_a_method_is_told_from_the_whole_model(method):
    # Negative control of the test above: what is simplified there is far above its bound here.
    proxy = Proxy(scene("uncoated", 85.0), Look(c=0.4), SIZE)
    assert proxy.error(method).largest > 0.1


def test_half_floats_are_near_and_refused_where_they_overflow(renderer):
    from relgloss_view.base.errors import InputError

    drawn, look = scene("matte-coated"), Look(c=0.4)
    method = Method(targets="float16")
    frame = renderer.render(drawn, look, SIZE, method)
    exact = Renderer(renderer.ctx, renderer.programs).render(drawn, look, SIZE)
    on = exact.on_object
    error = np.abs(frame.lab.astype(np.float64) - exact.lab)[on]
    # Eleven bits: half a unit of 1/16 at L* from 64 to 128, and c times that of L_s*.
    assert 1e-3 < np.max(error) < 0.1
    sharp = dataclasses.replace(drawn.material.specular[0], s_deg=0.05, strength=(50.0,))
    bright = dataclasses.replace(
        drawn, material=dataclasses.replace(drawn.material, specular=(sharp,))
    )
    with pytest.raises(InputError, match="float16"):
        renderer.render(bright, look, SIZE, method)
    assert renderer.render(bright, look, SIZE).c == 0.4


def test_c_max_by_eq4_and_without_grain(renderer):
    drawn, look = scene("uncoated"), Look(sigma_n_deg=2.0)
    exact = renderer.render(drawn, look, SIZE)
    eq4 = renderer.render(drawn, look, SIZE, Method(c_max="eq4"))
    assert eq4.c_max == exact.scaling.c_max_eq4
    once = renderer.render(drawn, look, SIZE, Method(c_max="once"))
    smooth = renderer.render(drawn, dataclasses.replace(look, sigma_n_deg=0.0), SIZE)
    assert once.c_max == smooth.c_max
    assert once.c_max != exact.c_max
    sparse = renderer.render(drawn, look, SIZE, Method(c_max="sparse"))
    assert sparse.c_max == pytest.approx(exact.c_max, rel=0.05)
    assert sparse.c_max >= exact.c_max  # the smallest of fewer


@pytest.mark.parametrize("sample", list(SAMPLES))
def test_its_error_is_that_of_the_picture(renderer, sample):
    """Percentiles of a thousand weighted pixels against those of all: a tenth, or a JND's tenth.

    c is given: without shadowing the grain of a single pixel at the silhouette may set c_max, which
    no sample of the pixels finds; its declared domain keeps the planner from choosing it.
    """
    size = (640, 360)
    matched = SAMPLES[sample]
    drawn = dataclasses.replace(scene(sample, 110.0), lamp=Lamp(azimuth_deg=110.0))
    look = Look(sigma_n_deg=matched.sigma_n_deg, c=0.2)
    frame = renderer.render(drawn, look, size)
    exact, on = shown_lab(frame), frame.on_object
    highlight = frame.split[1] > HIGHLIGHT_LSTAR
    proxy = Proxy(drawn, look, size)
    for method in (Method(fresnel="schlick"), Method(diffuse="lambert"), Method(shadowing="none")):
        other = shown_lab(renderer.render(drawn, look, size, method))
        difference = delta_e_2000(exact, other)
        error = proxy.error(method)
        assert error.object_p95 == pytest.approx(np.percentile(difference[on], 95), 0.1, 0.1)
        found = np.percentile(difference[highlight & on], 95)
        assert error.highlight_p95 == pytest.approx(found, 0.1, 0.1)


def test_the_narrowest_highlight_is_found():
    """A mirror's highlight of a few pixels: the proxy sees as bright a top as the picture does."""
    drawn, look, size = scene("cast-coated"), Look(c=0.01), (480, 270)
    drawn = dataclasses.replace(drawn, lamp=Lamp(azimuth_deg=73.0))
    top = np.max(ReferenceRenderer().render(drawn, look, size).split[1])
    proxy = Proxy(drawn, look, size)
    assert np.max(proxy.exact.l_s) == pytest.approx(top, rel=0.03)
    # Negative control: an even grid of as many pixels does not see it.
    even = ReferenceRenderer().render(drawn, look, (48, 27)).split[1]
    assert np.max(even) < 0.97 * top


def test_spans_share_a_line():
    places = np.array([[2.0, 2.0, 5.0, 9.0]])
    # Pixels 2, 5 and 9 of twelve: edges halfway between their centres, 4.0 and 7.5.
    np.testing.assert_allclose(_spans(places, 0.0, 12.0), [[0.0, 4.0, 3.5, 4.5]])


def test_exact_is_no_error():
    proxy = Proxy(scene(), Look(sigma_n_deg=2.0), SIZE)
    assert dataclasses.astuple(proxy.error(EXACT)) == (0.0, 0.0, 0.0)


def test_nothing_seen_is_empty():
    away = dataclasses.replace(scene(), eye=Eye(shift_right=50.0))
    assert Proxy(away, Look(), SIZE).empty


def test_what_a_scene_has_not_may_be_drawn_and_shows_nothing(renderer):
    smooth, look = Scene(materials.flat(0.4), shape=Shape(diameter_m=0.125, height_m=0.075)), Look()
    method, _ = methods.everything(smooth, look, SIZE)
    drawn = renderer.render(smooth, look, SIZE, method)
    everything = drawn.display.copy()
    assert_same_pixels(everything, renderer.render(smooth, look, SIZE).display)


@pytest.mark.parametrize(
    ("shape", "lamp", "sample"),
    [
        ({"kind": "plane", "width_m": 0.046}, (20.4, -15.8), "art-coated"),
        ({"diameter_m": 0.022}, (15.6, -12.2), "cast-coated"),
        ({"diameter_m": 0.02294}, (56.7345, -12.6241), "cast-coated"),
    ],
)
def test_a_highlight_on_the_last_row_is_seen(renderer, shape, lamp, sample):
    """c_max is set there: within 2 %, where a row missed made it 20 % and more."""
    drawn = Scene(load_sample(sample), shape=Shape(**shape), lamp=Lamp(*lamp))
    size = (320, 180)
    frame = renderer.render(drawn, Look(), size)
    _, c = Proxy(drawn, Look(), size)._scaled(*Proxy(drawn, Look(), size)._light(EXACT), EXACT)
    assert c == pytest.approx(frame.c, rel=0.02)


def test_a_frame_is_of_its_own_method(renderer):
    drawn, look = scene(), Look(sigma_n_deg=2.0)
    first = renderer.render(drawn, look, SIZE, Method(noise="none"))
    other = renderer.render(drawn, look, SIZE)
    _ = first.display  # draws it again
    again = renderer.render(drawn, look, SIZE, Method(noise="none"))
    assert again.method == first.method != other.method
    assert_same_pixels(again.display, first.display)


def test_normals_are_those_that_are_drawn(renderer):
    frame = renderer.render(scene(), Look(sigma_n_deg=3.0), SIZE, Method(noise="none"))
    np.testing.assert_array_equal(frame.tilted_normal, frame.normal)


def test_grain_that_mirrors_the_lamp_may_leave_the_gamut():
    proxy = Proxy(scene(), Look(sigma_n_deg=2.0, c=1.0), (256, 144))
    assert proxy.leaves_gamut(EXACT)
    # Negative control: a c that leaves even a mirroring grain dim.
    assert not Proxy(scene(), Look(sigma_n_deg=2.0, c=0.01), (256, 144)).leaves_gamut(EXACT)


@pytest.mark.parametrize("size", [(61, 47), (65, 49), (33, 18)])
def test_pixels_of_the_object_are_counted(renderer, size):
    plane = Scene(load_sample("matte-coated"), shape=Shape("plane", width_m=1.0, height_m=1.0))
    for drawn in (plane, dataclasses.replace(plane, eye=Eye(field_of_view_deg=5.0))):
        frame = renderer.render(drawn, Look(), size)
        assert frame.object_pixels == np.sum(frame.on_object) > 0


def test_c_alone_draws_the_tone_pass_alone_by_every_c_max(renderer):
    for c_max in ("exact", "sparse", "eq4", "once"):
        method = Method(c_max=c_max)
        renderer.render(scene(), Look(sigma_n_deg=2.0, c_fraction=0.5), SIZE, method)
        shades = renderer.draws["shade"]
        renderer.render(scene(), Look(sigma_n_deg=2.0, c_fraction=0.6), SIZE, method)
        assert renderer.draws["shade"] == shades, c_max


def test_a_lamp_on_the_surface_lights_the_rest(renderer):
    # One pixel may be the lamp's own point; the others are drawn.
    lamp = Lamp(azimuth_deg=0.0, distance_m=0.04)
    touched = Scene(load_sample("matte-coated"), shape=Shape("sphere", diameter_m=0.08), lamp=lamp)
    frame = renderer.render(touched, Look(c=1.0), (65, 65))
    assert np.all(np.isfinite(frame.lab))
