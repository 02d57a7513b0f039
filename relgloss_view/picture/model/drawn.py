"""The models and lobes of a material that a look and a method select for drawing."""

from __future__ import annotations

import dataclasses

from relgloss_view.material.material import Lobe, Material
from relgloss_view.picture import method
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene


def as_drawn(scene: Scene, look: Look) -> Scene:
    """The scene with the diffuse model that the look forces, if it forces one."""
    material = in_model(scene.material, look)
    if material is scene.material or scene.pack is not None:  # a pack's finishes: see in_model
        return scene
    return dataclasses.replace(scene, material=material)


def in_model(material: Material, look: Look) -> Material:
    """The material with the diffuse model that the look forces, if it forces one."""
    diffuse = material.diffuse
    if look.diffuse_model in ("fitted", diffuse.model):
        return material
    return dataclasses.replace(
        material, diffuse=dataclasses.replace(diffuse, model=look.diffuse_model)
    )


def drawn_diffuse(material: Material, chosen: method.Method) -> str:
    """The model that draws the diffuse part."""
    model = material.diffuse.model if chosen.diffuse == "fitted" else chosen.diffuse
    return "lambert" if material.diffuse.sigma_deg == 0.0 else model


def drawn_lobes(material: Material, chosen: method.Method) -> tuple[Lobe, ...]:
    """The lobes that are drawn: those that reflect anything, the strongest of them."""
    lobes = material.visible_lobes()
    strongest = sorted(range(len(lobes)), key=lambda k: -max(lobes[k].height))[: chosen.lobes]
    return tuple(lobe for k, lobe in enumerate(lobes) if k in strongest)


def drawn_facets(look: Look, chosen: method.Method) -> str:
    """The facets' distribution; where a method draws the mean of the grain, the averaged one."""
    blurred = chosen.noise == "mean" and look.sigma_n_deg > 0.0
    return "mean-gaussian" if blurred and chosen.facets == "gaussian" else chosen.facets
