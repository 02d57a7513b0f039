"""Scene and look as the numbers that the shaders take."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from relgloss_view.display.model import DisplayModel
from relgloss_view.material import brdf
from relgloss_view.material.albedo_table import STEPS, diffuse_table, lobe_table
from relgloss_view.material.approximations import mean_lobe, plain_lobe
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.gpu.programs import Uniforms
from relgloss_view.picture.gpu.uploads import Uploads
from relgloss_view.picture.method import Method
from relgloss_view.picture.model.drawn import drawn_diffuse, drawn_facets, drawn_lobes, in_model
from relgloss_view.picture.model.grain import field_step
from relgloss_view.picture.model.grain_field import FIELD_TILE
from relgloss_view.picture.model.lights import lamps_of, share_of
from relgloss_view.picture.model.pixel_sampling import eye_grain_samples, grainiest
from relgloss_view.picture.model.view import Size, View
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import MOST_FURTHER_LAMPS

WHOLE: Uniforms = {"lowest_row": 0}  #: of rows.glsl, where a target holds the whole picture


def view_uniforms(scene: Scene, view: View, *, afar: bool) -> Uniforms:
    """Eye, lamp and object; from afar the eye and its frame are as view.glsl's AFAR has them."""
    eye_m, step = view.eye_m, 1.0
    if afar:
        step = -float(view.eye_m @ view.forward / (view.forward @ view.forward))
        eye_m = view.eye_m + step * view.forward
    return {
        **WHOLE,
        "eye_m": eye_m,
        "view_right": step * view.right,
        "view_up": step * view.up,
        "view_forward": step * view.forward,
        "pixel_step": view.pixel_step,
        "view_shift": view.shift,
        "size_px": view.size,
        "half_extent_m": scene.shape.half_extent_m(),
        **lamp_uniforms(scene),
    }


#: The numbers of the lamps, on which no point of the object depends.
LAMP_NAMES = ("lamp_m", "further_lamps", "lamp_radius2")


def lamp_uniforms(scene: Scene) -> Uniforms:
    """The lamps; of further ones and of discs only where there are any."""
    uniforms: dict[str, Any] = {"lamp_m": scene.lamp.position_m}
    main, *further = lamps_of(scene.setup)
    if further:
        places = np.zeros((MOST_FURTHER_LAMPS, 4))
        for k, lamp in enumerate(further):
            places[k] = (*lamp.position_m, share_of(lamp))
        uniforms["further_lamps"] = places
    if any(lamp.radius_m > 0.0 for lamp in (main, *further)):
        radius2 = np.zeros(1 + MOST_FURTHER_LAMPS)
        radius2[: 1 + len(further)] = [lamp.radius_m**2 for lamp in (main, *further)]
        uniforms["lamp_radius2"] = radius2
    return uniforms


def ambient_uniforms(scene: Scene, look: Look, method: Method) -> Uniforms:
    """The surround's light, and the table that ambient.glsl reads as (2 M, STEPS + 1, 4) numbers.

    Two rows for each of M materials: one, or those of a pack's finishes.

    Empty where the scene has no such light.
    """
    if scene.lamp.ambient == 0.0:
        return {}
    materials = [scene.material]
    if scene.pack is not None:
        materials = [in_model(finish.material, look) for finish in scene.pack.finishes]
    rows = np.zeros((2 * len(materials), STEPS + 1, 4), dtype=np.float32)
    for n, material in enumerate(materials):
        model = drawn_diffuse(material, method)
        rows[2 * n, :, :2] = np.stack(diffuse_table(model, material.diffuse.sigma), axis=-1)
        for k, lobe in enumerate(drawn_lobes(material, method)):
            for part, column in zip(lobe.parts(material.bands.count), (k, k + 2), strict=False):
                rows[2 * n + 1, :, column] = lobe_table(lobe.s, part.fresnel)
    return {"ambient": scene.lamp.ambient, "albedo_rows": rows}


def per_size(size: Size) -> Uniforms:
    """What reads the pixels of earlier passes (texel.glsl)."""
    return {"per_size": (1.0 / size[0], 1.0 / size[1])}


#: Of a variant that reads none of them; a linker may keep them all the same.
NO_GRAIN: Uniforms = {"sigma_n": 0.0, "grains_per_px": 1.0, "grain_m": 1.0, "seed": 0}


def grain_uniforms(scene: Scene, look: Look, size: Size) -> Uniforms:
    """The tilt of the normals and its cells, or what the field of its tilts follows from."""
    look = grainiest(scene, look)
    if look.grain == "eye":
        width, height = field_size(scene, look, size)
        return {
            **NO_GRAIN,
            "sigma_n": np.radians(look.sigma_n_deg),
            "seed": look.seed,
            "field_step": field_step(scene.display, look),
            "grain_samples": eye_grain_samples(scene.display, look),
            "per_field": (1.0 / width, 1.0 / height),
        }
    return {
        "sigma_n": np.radians(look.sigma_n_deg),
        "grains_per_px": 1.0 / look.grain_px,
        "grain_m": look.grain_mm * 1e-3,
        "seed": look.seed,
    }


def field_size(scene: Scene, look: Look, size: Size) -> Size:
    """Texels of the field of tilts: one for each draw of the grain, as far as they don't repeat."""
    look = grainiest(scene, look)
    samples = eye_grain_samples(scene.display, look)
    width, height = (min(samples * side, FIELD_TILE) for side in size)
    return width, height


NO_LOBE = (1.0, 0.0, 1.5, 0.0)  #: reflects nothing, where one is drawn all the same


def material_uniforms(scene: Scene, look: Look, method: Method) -> Uniforms:
    """The shapes of the material's reflections: what its weights follow from."""
    material = scene.material
    shape = np.tile(NO_LOBE, (2, 1))
    blurred = drawn_facets(look, method) == "mean-gaussian"
    for k, lobe in enumerate(drawn_lobes(material, method)):
        shape[k] = (
            mean_lobe(lobe.s, lobe.refractive_index, math.radians(look.sigma_n_deg), look.noise_law)
            if blurred
            else plain_lobe(lobe.s, lobe.refractive_index)
        )
    model = drawn_diffuse(material, method)
    return {
        "diffuse_terms": brdf.diffuse_terms(model, material.diffuse.sigma),
        "lobe_shape": shape,
    }


def colour_uniforms(scene: Scene, method: Method) -> Uniforms:
    """The material's spectra, folded into XYZ under the scene's lamp and band by band."""
    material, lamp = scene.material, illuminant(scene.lamp.illuminant)
    weights = material.xyz_weights(lamp)
    albedo = np.asarray(material.diffuse.albedo)
    second = brdf.second_albedo(drawn_diffuse(material, method), albedo, material.diffuse.sigma)
    strength, grazing = np.zeros((2, material.bands.count)), np.zeros(2)
    for k, lobe in enumerate(drawn_lobes(material, method)):
        strength[k], *white = (part.spectrum for part in lobe.parts(material.bands.count))
        grazing[k] = white[0][0] if white else 0.0
    return {
        "per_white": 1.0 / lamp.white_xyz(),
        "albedo_xyz": albedo @ weights,
        "second_albedo_xyz": second @ weights,
        "lobe_strength_xyz": strength @ weights,
        "grazing_strength": grazing,  # of a metal's white part
        "lamp_white": lamp.white_xyz(),
        "band_weights": weights,
        "band_reflectance": np.stack([albedo, second, *strength], axis=-1),
    }


def white_uniform(scene: Scene) -> Uniforms:
    """The white of the scene's lamp."""
    return {"white": illuminant(scene.lamp.illuminant).white_xyz()}


def display_uniforms(scene: Scene, uploads: Uploads) -> Uniforms:
    """The display, and the screen that shows it: the display itself, unless another one is seen."""
    display = DisplayModel.of(scene.display)
    screen = display.screen or display
    between = np.eye(3) if display.screen_from_rgb is None else display.screen_from_rgb
    uniforms: dict[str, Any] = {
        "display_white": display.white,
        "rgb_from_xyz": display.rgb_from_xyz.T,  # columns first
        "display_lowest": display.lowest,
        "background_rgb": display.background_rgb,
        "screen_from_rgb": between.T,
        "screen_floor": screen.floor,
        "screen_per_range": 1.0 / (1.0 - screen.floor),
        "screen_darkest": screen.darkest,
        "display_curve": screen.curve,
    }
    if screen.emission is not None and screen.transfer == "curves":
        uniforms["transfer_curves"] = uploads.curves(screen.emission)
    return uniforms
