"""Scene and look as the numbers that the shaders take."""

from __future__ import annotations

import numpy as np

from relgloss_view.material import brdf
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.picture.renderer.programs import Uniforms
from relgloss_view.picture.scene import Look, Scene
from relgloss_view.picture.tone import DisplayModel
from relgloss_view.picture.view import View


def view_uniforms(scene: Scene, view: View) -> Uniforms:
    """Eye, lamp and object."""
    return {
        "eye_m": view.eye_m,
        "view_right": view.right,
        "view_up": view.up,
        "view_forward": view.forward,
        "pixel_step": view.pixel_step,
        "view_shift": view.shift,
        "size_px": view.size,
        "half_extent_m": scene.shape.half_extent_m(),
        "lamp_m": scene.lamp.position_m,
    }


def grain_uniforms(look: Look) -> Uniforms:
    """The tilt of the normals and its cells."""
    return {
        "sigma_n": np.radians(look.sigma_n_deg),
        "grain_px": look.grain_px,
        "grain_m": look.grain_mm * 1e-3,
        "seed": look.seed,
    }


def material_uniforms(scene: Scene) -> Uniforms:
    """The material's spectra folded into XYZ under the scene's lamp, and its lobes' shapes."""
    material = scene.material
    weights = xyz_weights(material.bands, illuminant(scene.lamp.illuminant))
    strength, shape = np.zeros((2, 3)), np.zeros((2, 3))
    for k, lobe in enumerate(material.visible_lobes()):
        strength[k] = lobe.per_band(material.bands.count) @ weights
        shape[k] = (lobe.s, brdf.facet_amplitude(lobe.s), lobe.refractive_index)
    return {
        "albedo_xyz": np.asarray(material.diffuse.albedo) @ weights,
        "second_albedo_xyz": material.second_albedo() @ weights,
        "diffuse_sigma": material.diffuse.sigma,
        "lobe_strength_xyz": strength,
        "lobe_shape": shape,
    }


#: The perfect diffuser in place of the material.
PERFECT_DIFFUSER: Uniforms = {
    "albedo_xyz": (1.0, 1.0, 1.0),
    "second_albedo_xyz": (0.0, 0.0, 0.0),
}


def white_uniform(scene: Scene) -> Uniforms:
    """The white of the scene's lamp."""
    return {"white": illuminant(scene.lamp.illuminant).white_xyz()}


def display_uniforms(scene: Scene) -> Uniforms:
    """The display."""
    display = DisplayModel.of(scene.display)
    return {
        "display_white": display.white,
        "rgb_from_xyz": display.rgb_from_xyz.T,  # columns first
        "display_curve": display.curve,
        "background_light": display.background_light,
    }
