"""Packs on the GPU against the float64 reference: forms, finishes, artwork, lamps."""

import dataclasses

import numpy as np
import pytest
from scans import scanned_pack

from relgloss_view import Look, Scene, load_sample
from relgloss_view.display.display import Display
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.built_in import load_finish
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.label import label_of
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu import printed
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.setup import Eye, FurtherLamp, Lamp, Setup

SIZE = (72, 64)
P999 = 0.05  #: dE2000


def artwork_of(shape, texels=256, transparent=False):
    """Coarse and fine print in colour, with two plates."""
    width, height = label_of(shape).size_m
    size = (texels, max(2, round(texels * height / width)))
    x, y = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    fine = ((x // 3 + y // 2) % 2 == 0) & (y < size[1] // 2)
    xyz = np.stack([0.15 + 0.5 * x / size[0], 0.1 + 0.6 * y / size[1], 0.3 + 0.0 * x], axis=-1)
    xyz = np.where(fine[..., None], 0.04, xyz)
    alpha = np.where(x % 64 < 24, 0.0, 1.0) if transparent else np.ones(x.shape)
    gloss = (((x // 16) + (y // 16)) % 3 == 0) * 255
    foil = (np.hypot(x - 0.5 * size[0], y - 0.4 * size[1]) < 0.08 * size[0]) * 255
    return Artwork(
        (xyz * alpha[..., None]).astype(np.float16),
        1e3 * width,
        1e3 * height,
        alpha=alpha.astype(np.float16) if transparent else None,
        plates={"Gloss": gloss.astype(np.uint8), "Foil": foil.astype(np.uint8)},
    )


def pack_of(kind, *, count=2, transparent=False, colour="lab", sizes=None, **placed):
    """A pack of so many finishes, 1 to 4."""
    shape = Shape(kind, **(sizes or {}))
    finishes = (
        Finish("ink", "ink", load_sample("matte-coated")),
        Finish("spot", "varnish", load_sample("art-coated"), "", "plate:Gloss", k=0.7),
        Finish("foil", "foil", load_finish("cold-foil-gold"), "", "plate:Foil", k=1.4),
        Finish("board", "stock", load_sample("uncoated"), "", "plate:Gloss", True, k=0.5),
    )
    finishes = (finishes[0], *finishes[4 - count + 1 :]) if count > 2 else finishes[:count]
    artwork = artwork_of(shape, transparent=transparent)
    return Pack("tried", shape, finishes, artwork, Placement(**placed), colour)


#: A bottle of its own outline, radii and heights in millimetres.
OUTLINE = ((0, 3), (20, 0), (30, 8), (30, 75), (33, 90), (33, 130), (28, 160), (14, 185), (13, 205))
PACKS = {
    "can": ({"kind": "can"}, Eye()),
    "can, turned": ({"kind": "can", "turn_deg": 20.0, "scale": 0.5}, Eye(4.3, 3.0)),
    "bottle": ({"kind": "bottle", "count": 4}, Eye(elevation_deg=20.0)),
    "bottle, outline": ({"kind": "bottle", "sizes": {"profile_mm": OUTLINE}}, Eye(-30.0, 5.0)),
    "carton": ({"kind": "carton", "count": 3}, Eye(35.0, 25.0)),
    "pouch": ({"kind": "pouch", "transparent": True}, Eye(-20.0, 10.0)),
    "scan": ({"kind": "mesh", "count": 3}, Eye(20.0, 15.0)),
    "cylinder": ({"kind": "cylinder"}, Eye(azimuth_deg=170.0)),
    "sphere": ({"kind": "sphere", "count": 4}, Eye()),
    "plane": ({"kind": "plane", "colour": "spectral"}, Eye(50.0, 20.0)),
    "box": ({"kind": "box", "offset_x_mm": 20.0}, Eye(30.0, 20.0)),
    "one finish": ({"kind": "pouch", "count": 1}, Eye()),
}
QUICK = ("can", "carton", "sphere", "plane")
#: Each picture has to draw its lamps and its form by itself.
LAMP = Lamp(azimuth_deg=30.0, elevation_deg=20.0, ambient=0.2)
FURTHER = (FurtherLamp(-40.0, 10.0, radius_m=0.1, share=0.4), FurtherLamp(5.0, 60.0, share=0.2))
#: With smooth edges a picture knows the pixels that the object covers in part.
SMOOTH = Display(edges="smooth")


def both(name, look, size, gpu):
    made, eye = PACKS[name]
    if made["kind"] == "mesh":
        made = {**made, "sizes": {"file": scanned_pack("mustard_bottle")}}
    pack = pack_of(**made)
    further = FURTHER if made.get("count", 2) > 2 else ()
    setup = Setup(pack.shape, LAMP, eye, SMOOTH, further_lamps=further)
    scene = Scene(pack.material, setup, pack=pack)
    return gpu.render(scene, look, size), ReferenceRenderer().render(scene, look, size)


def compared(drawn, truth):
    """dE2000 of the pixels that the object covers whole.

    Left out is where one surface hides another: a pixel whose centre lies on that outline may see
    either, by the last digit of a number.
    """
    inside = drawn.on_object & truth.on_object
    for frame in (drawn, truth):
        if frame.edges is not None:
            column, row, _ = frame.edges.T.astype(int)
            inside[row, column] = False
    nearer = np.linalg.norm(drawn.point_m - truth.point_m, axis=-1) < 1e-5
    assert np.mean(nearer[inside]) > 0.998
    inside &= nearer
    return delta_e_2000(drawn.lab[inside], truth.lab[inside]), inside


class TestPacksAgainstTheReference:
    @pytest.mark.parametrize("name", QUICK)
    def test_colours(self, name, renderer):
        look = Look(sigma_n_deg=0.0, c=0.8, samples=1)
        drawn, truth = both(name, look, SIZE, renderer)
        apart, inside = compared(drawn, truth)
        assert np.mean(inside) > 0.85 * np.mean(truth.on_object) > 0.0
        assert np.percentile(apart, 99.9) <= P999
        assert np.percentile(np.abs(drawn.gloss_factor - truth.gloss_factor)[inside], 99.9) < 1e-3

    def test_another_k_is_told_apart(self, renderer):
        """The negative control: a tenth of k is far above the limit."""
        pack = pack_of("can")
        other = pack.with_finish("spot", k=0.77)
        look = Look(sigma_n_deg=0.0, c=0.8, samples=1)
        drawn = renderer.render(Scene(pack.material, pack=other, lamp=LAMP), look, SIZE)
        lab = drawn.lab
        truth = ReferenceRenderer().render(Scene(pack.material, pack=pack, lamp=LAMP), look, SIZE)
        both_show = drawn.on_object & truth.on_object
        assert np.percentile(delta_e_2000(lab[both_show], truth.lab[both_show]), 99.9) > 2.0 * P999

    def test_several_samples_a_pixel(self, renderer):
        drawn, truth = both("can", Look(sigma_n_deg=0.0, c=0.8, samples=2), (48, 40), renderer)
        assert np.mean(np.abs(drawn.coverage - truth.coverage) < 1e-6) > 0.995
        whole = (drawn.coverage == 1.0) & (truth.coverage == 1.0)
        assert np.percentile(delta_e_2000(drawn.lab[whole], truth.lab[whole]), 99.0) <= P999

    @pytest.mark.parametrize("grain", ["screen", "surface"])
    def test_grain_of_each_finish(self, grain, renderer):
        pack = pack_of("can").with_finish("spot", sigma_n_deg=0.5)
        scene = Scene(pack.material, pack=pack, lamp=LAMP)
        look = Look(sigma_n_deg=2.0, c=0.8, samples=1, grain=grain)
        drawn = renderer.render(scene, look, SIZE)
        truth = ReferenceRenderer().render(scene, look, SIZE)
        inside = drawn.on_object & truth.on_object
        turned = np.linalg.norm(drawn.tilted_normal - truth.tilted_normal, axis=-1)[inside]
        # A point at the border of a cell may fall on either side of it.
        assert np.percentile(turned, 97.0) < 1e-3
        assert np.mean(np.linalg.norm(drawn.tilted_normal - drawn.normal, axis=-1)[inside]) > 0.005

    @pytest.mark.slow
    @pytest.mark.parametrize("name", PACKS)
    def test_colours_at_512(self, name, renderer):
        look = Look(sigma_n_deg=0.0, c=0.8, samples=1)
        drawn, truth = both(name, look, (512, 512), renderer)
        apart, inside = compared(drawn, truth)
        assert np.mean(inside) > 0.97 * np.mean(truth.on_object)
        assert np.percentile(apart, 99.9) <= P999


class TestWhatIsDrawnAgain:
    def test_k_and_sigma_draw_neither_triangles_nor_artwork(self, renderer):
        pack = pack_of("can")
        look = Look(sigma_n_deg=1.0, c=0.8, samples=1)

        def draw(pack, **changed):
            scene = Scene(pack.material, pack=pack, lamp=LAMP)
            return renderer.render(scene.placed(**changed), look, SIZE)

        draw(pack)
        surface, uploads = renderer.passes.surface, renderer.programs.uploads
        tiles, made = surface.drawn, uploads.made
        draw(pack.with_finish("spot", k=0.5))
        draw(pack.with_finish("spot", sigma_n_deg=0.3))
        draw(pack, lamp=Lamp(azimuth_deg=10.0))
        assert (surface.drawn, uploads.made) == (tiles, made)
        draw(pack, eye=Eye(azimuth_deg=5.0))
        assert (surface.drawn, uploads.made) == (tiles + 1, made)
        moved = dataclasses.replace(pack, placement=Placement(offset_x_mm=5.0))
        draw(moved)
        assert (surface.drawn, uploads.made) == (tiles + 2, made)


def test_artwork_too_large_for_the_device_is_drawn_coarser(renderer, monkeypatch):
    pack, look = pack_of("plane"), Look(sigma_n_deg=0.0, c=0.8, samples=1)
    scene = Scene(pack.material, pack=pack)
    whole = renderer.render(scene, look, SIZE)
    lab, shown = whole.lab, whole.on_object
    assert not any("resolution" in warning for warning in whole.warnings)
    monkeypatch.setattr(printed, "max_texture_size", lambda ctx: 50)
    renderer.programs.uploads.release()
    renderer.forget()
    coarse = renderer.render(scene, look, SIZE)
    assert any("1/8 of its resolution" in warning for warning in coarse.warnings)
    apart = delta_e_2000(coarse.lab, lab)[shown]
    assert 0.0 < np.mean(apart) < 20.0
    renderer.programs.uploads.release()
    renderer.forget()
