"""Packs in float64: the artwork's Lab on screen, and finishes composed as by hand."""

from __future__ import annotations

import dataclasses

import materials
import numpy as np
import pytest

from relgloss_view import Look, Scene, open_renderer
from relgloss_view.base.icc.profile import D50
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import brdf
from relgloss_view.material.cielab import lab_from_xyz, xyz_from_lab
from relgloss_view.material.material import Diffuse, Lobe
from relgloss_view.material.spectra import (
    D65_XY,
    SRGB_PRIMARIES_XY,
    illuminant,
    rgb_to_xyz_matrix,
)
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack, Placement
from relgloss_view.pack.paint import paint_from_rgb, paint_matrix
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

LABS = [(60.0, 30.0, 20.0), (45.0, -25.0, 10.0), (80.0, 0.0, 40.0), (30.0, 10.0, -25.0)]
FLAT_ON = Lamp(azimuth_deg=0.0, elevation_deg=0.0)
MATT = materials.flat(0.5)
SHINY = materials.flat(0.5, (Lobe((0.3,), 8.0),))
SIZE = (48, 48)


def artwork_of(lab, plates=None, alpha=None, size=(8, 8), side_mm=60.0):
    xyz = np.broadcast_to(xyz_from_lab(np.array(lab), D50), (*size, 3))
    alpha = None if alpha is None else np.full(size, alpha, dtype=np.float16)
    xyz = (xyz if alpha is None else xyz * alpha[..., None]).astype(np.float16)
    return Artwork(xyz, side_mm, side_mm, alpha, plates or {})


def plane(side_m=0.06):
    return Shape("plane", width_m=side_m, height_m=side_m)


CENTRES = Look(samples=1)


def drawn(pack, look=CENTRES, lamp=FLAT_ON, size=SIZE, eye=Eye()):
    setup = Setup(pack.shape, lamp=lamp, eye=eye)
    with open_renderer("reference") as renderer:
        return renderer.render(Scene(pack.material, setup, pack=pack), look, size)


@pytest.mark.parametrize("lamp", ["HP5", "D65", "A"])
@pytest.mark.parametrize("lab", LABS)
def test_the_artworks_lab_is_on_the_screen(lamp, lab):
    """Of a body pixel that is fully lit and without highlight, in the display's own Lab."""
    pack = Pack("p", plane(), (Finish("ink", "ink", MATT),), artwork_of(lab))
    frame = drawn(pack, lamp=dataclasses.replace(FLAT_ON, illuminant=lamp))
    lit = np.unravel_index(np.argmax(frame.diffuse[..., 1]), SIZE[::-1])
    display = DisplayModel.of(frame.scene.display)
    shown = lab_from_xyz(frame.light[lit] @ display.xyz_from_rgb.T, display.white)
    assert not frame.out_of_gamut[lit]
    assert delta_e_2000(shown, np.array(lab)) < 0.05  # float16 holds XYZ to 0.05 %


def test_a_lamps_lines_shift_a_colour_whose_spectrum_is_invented():
    # Negative control, and why "lab" is the default: HP5 moves upsampled colours.
    inks = (Finish("ink", "ink", MATT),)
    pack = Pack("p", plane(), inks, artwork_of((45.0, -25.0, 10.0)), colour="spectral")
    frame = drawn(pack, lamp=dataclasses.replace(FLAT_ON, illuminant="HP5"))
    lit = np.unravel_index(np.argmax(frame.diffuse[..., 1]), SIZE[::-1])
    assert 1.0 < delta_e_2000(frame.lab[lit], np.array((45.0, -25.0, 10.0))) < 30.0


def test_upsampled_spectra_return_their_colour_under_d65():
    rgb = np.random.default_rng(1).uniform(0.0, 1.0, (50, 3))
    xyz = rgb @ (paint_matrix("spectral", illuminant("D65")) @ paint_from_rgb()).T
    back = xyz @ np.linalg.inv(rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)).T
    assert np.max(np.abs(back - rgb)) < 5e-4


@pytest.mark.parametrize("lamp", ["A", "D50", "HP5"])
def test_upsampled_spectra_are_colour_sciences(lamp):
    colour = pytest.importorskip("colour")
    rgb = np.array([0.2, 0.6, 0.1])
    spectrum = colour.recovery.RGB_to_sd_Mallett2019(rgb)
    light = colour.SDS_ILLUMINANTS[lamp].copy().align(spectrum.shape)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy()
    theirs = (
        colour.colorimetry.sd_to_XYZ_integration(spectrum, observer.align(spectrum.shape), light)
        / 100.0
    )
    ours = paint_matrix("spectral", illuminant(lamp)) @ paint_from_rgb() @ rgb
    assert np.allclose(ours, theirs, rtol=2e-3)
    by_white = paint_matrix("lab", illuminant(lamp)) @ paint_from_rgb() @ rgb
    assert not np.allclose(by_white, theirs, rtol=1e-2)


def test_a_pack_of_one_bare_finish_is_the_material():
    material = materials.paper("matte")
    shape = Shape()
    look = Look(sigma_n_deg=2.0, grain="surface", samples=1)
    for kind in ("ink", "stock"):
        pack = Pack("p", shape, (Finish("only", kind, material),))
        frame = drawn(pack, look, Lamp())
        with open_renderer("reference") as renderer:
            plain = renderer.render(Scene(material, Setup(shape)), look, SIZE)
        assert np.allclose(frame.diffuse, plain.diffuse, rtol=1e-9, atol=1e-12)
        assert np.allclose(frame.specular, plain.specular, rtol=1e-9, atol=1e-12)
        assert frame.c == pytest.approx(plain.c)
        assert np.allclose(frame.split[1], plain.split[1])


def three_finishes(**of_varnish):
    plates = {
        "Varnish": np.full((8, 8), 102, dtype=np.uint8),
        "Foil": np.full((8, 8), 51, dtype=np.uint8),
    }
    foil = dataclasses.replace(materials.flat(0.1, (Lobe((0.8,), 5.0, f0=(0.7,)),)), name="foil")
    varnish = materials.flat(0.9, (Lobe((0.2,), 3.0),))
    ink = dataclasses.replace(SHINY, diffuse=Diffuse("oren-nayar", SHINY.diffuse.albedo, 20.0))
    finishes = (
        Finish("ink", "ink", ink, k=0.5, sigma_n_deg=1.0),
        Finish("varnish", "varnish", varnish, mask="plate:Varnish", **of_varnish),
        Finish("foil", "foil", foil, mask="plate:Foil", k=2.0, sigma_n_deg=3.0),
    )
    return Pack("p", plane(), finishes, artwork_of((60.0, 30.0, 20.0), plates, alpha=0.75))


def test_three_finishes_at_a_point_by_hand():
    """f = sum of w_f f_f: foil 0.2 on top, varnish 0.4 of what is left, ink the rest of the lobes;
    the foil replaces the diffuse part below it, the varnish leaves it."""
    pack = three_finishes(k=1.5)
    pack = dataclasses.replace(
        pack, finishes=tuple(dataclasses.replace(f, sigma_n_deg=0.0) for f in pack.finishes)
    )
    lamp = Lamp(azimuth_deg=30.0, elevation_deg=10.0, distance_m=0.5)
    frame = drawn(pack, Look(samples=1), lamp)
    row, column = 25, 22
    varnished = np.round(0.8 * 0.4 * 255.0) / 255.0  # as textures hold it
    w = {"foil": 0.2, "varnish": varnished, "ink": 0.8 - varnished}
    point, normal = frame.point_m[row, column], np.array([0.0, 0.0, 1.0])
    way = lamp.position_m - point
    i = way / np.linalg.norm(way)
    o = frame.scene.eye.position_m - point
    f = brdf.facing(normal, i, o / np.linalg.norm(o))
    every = frame.point_m[frame.on_object]
    lengths = np.linalg.norm(lamp.position_m - every, axis=-1)
    white = np.max((lamp.position_m - every)[:, 2] / lengths**3)
    arriving = np.pi * i[2] / (white * np.dot(way, way))
    light = illuminant(lamp.illuminant)
    specular = sum(
        w[one.name] * one.material.evaluate_facing(f)[1] @ one.material.xyz_weights(light)
        for one in pack.finishes
    )
    assert np.allclose(frame.specular[row, column], arriving * specular, rtol=1e-5)

    first, second = brdf.oren_nayar(f, np.radians(20.0))
    printed = 0.75 * xyz_from_lab(np.array((60.0, 30.0, 20.0)), D50)
    gray = 0.25 * light.white_xyz()
    linear = np.linalg.solve(paint_from_rgb(), printed / 0.75)
    scale = light.white_xyz() / D50
    albedo = printed * scale + gray * 0.5
    squared = 0.75 * (paint_from_rgb() @ linear**2) * scale + gray * 0.25
    foil = 0.1 / np.pi * light.white_xyz()
    diffuse = 0.8 * (first * albedo + second * squared) + 0.2 * foil
    assert np.allclose(frame.diffuse[row, column], arriving * diffuse, rtol=2e-3)

    k = w["foil"] * 2.0 + w["varnish"] * 1.5 + w["ink"] * 0.5
    assert frame.gloss_factor[row, column] == pytest.approx(k, abs=1e-6)
    l_d, l_s = frame.split
    assert frame.lab[row, column, 0] == pytest.approx(
        l_d[row, column] + frame.c * l_s[row, column], abs=1e-9
    )
    assert np.max((l_d + frame.c_max * l_s)[frame.on_object]) == pytest.approx(100.0)


def test_each_finish_has_its_own_graininess():
    """The tilts' spread is the shares' mean of the finishes' sigma_N."""
    pack = three_finishes(sigma_n_deg=2.0)
    frame = drawn(pack, Look(sigma_n_deg=0.0, noise_law="tangent", samples=1), size=(96, 96))
    seen = frame.on_object
    cosine = np.sum(frame.normal * frame.tilted_normal, axis=-1)[seen]
    tilt_deg = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    expected = 0.2 * 3.0 + 0.32 * 2.0 + 0.48 * 1.0
    assert np.sqrt(np.mean(tilt_deg**2) / 2.0) == pytest.approx(expected, rel=0.05)


def test_a_finish_covers_its_part():
    """The neck of a can in foil, the body in the artwork's colour, whatever lies above the ink."""
    foil = materials.flat(0.05)
    pack = Pack(
        "p",
        Shape("can"),
        (Finish("ink", "ink", MATT), Finish("neck", "stock", foil, mask="part:neck")),
        artwork_of((60.0, 30.0, 20.0), side_mm=300.0),
    )
    frame = drawn(pack, lamp=FLAT_ON, size=(64, 64))
    seen = frame.on_object & (frame.diffuse[..., 1] > 0.02)
    height = frame.point_m[..., 1]
    a_b = frame.lab[..., 1:]
    neck, body = seen & (height > 0.046) & (height < 0.05), seen & (np.abs(height) < 0.03)
    assert np.sum(neck) > 5
    assert np.sum(body) > 100
    assert np.max(np.abs(a_b[neck])) < 0.1
    assert np.min(a_b[body][:, 0]) > 5.0


def test_no_seam_where_the_artwork_is_as_wide_as_the_girth():
    """From behind: a pattern that goes around continues over the label's end."""
    shape = Shape()
    girth_mm = 1e3 * np.pi * shape.diameter_m
    wave = 0.4 + 0.3 * np.cos(4.0 * np.pi * (np.arange(256) + 0.5) / 256)
    xyz = np.broadcast_to((wave[:, None] * D50)[None], (4, 256, 3)).astype(np.float16)

    def ripple(width_mm):
        artwork = Artwork(xyz, width_mm, 100.0)
        pack = Pack("p", shape, (Finish("ink", "ink", materials.flat(0.02)),), artwork)
        eye, lamp = Eye(azimuth_deg=180.0), Lamp(azimuth_deg=180.0, elevation_deg=0.0)
        row = drawn(pack, eye=eye, lamp=lamp, size=(64, 32)).diffuse[16, :, 1]
        return np.max(np.abs(np.diff(row[row > 0.05], n=2)))

    assert ripple(0.9990 * girth_mm) < 0.5 * ripple(0.97 * girth_mm)


def test_a_placement_moves_turns_and_scales():
    """A dot of the artwork lies where the placement puts it, by millimetres on the label."""
    xyz = np.full((61, 61, 3), 1.0) * D50
    xyz[30 - 20, 30 + 10] = 0.0  # 10 mm right of the artwork's centre and 20 mm up
    artwork = Artwork(xyz.astype(np.float16), 61.0, 61.0)
    place = Placement(offset_x_mm=4.0, offset_y_mm=-3.0, turn_deg=90.0, scale=0.5)
    pack = Pack("p", plane(0.09), (Finish("ink", "ink", MATT),), artwork, place)
    frame = drawn(pack, size=(256, 256))
    dark = frame.on_object & (np.abs(frame.point_m) < 0.012).all(axis=-1)
    at = np.unravel_index(np.argmin(np.where(dark, frame.diffuse[..., 1], 9.0)), (256, 256))
    # Turned counter-clockwise, 10 right and 20 up become 20 left and 10 up.
    assert np.allclose(frame.point_m[at][:2] * 1e3, (4.0 - 10.0, -3.0 + 5.0), atol=0.5)
