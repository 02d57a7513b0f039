"""Scenes that reach every part of the engine, and states at random."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from materials import paper

from relgloss_view import Look, Scene
from relgloss_view.display.display import Display
from relgloss_view.material.material import Lobe
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.setup import Eye, FurtherLamp, Lamp, Setup
from relgloss_view.proof.settings import LampPlace, PictureSetting, Settings

MATTE, ART = paper("matte"), paper("art")
METAL = replace(ART, specular=(Lobe((0.8,), 3.0, f0=(0.9,)), Lobe((0.05,), 12.0)))
SMOOTH = Display(edges="smooth", dither="ordered")
TURNED = Eye(azimuth_deg=20.0, elevation_deg=15.0)


def look(**entries) -> Look:
    """A grainy look with a c of its own."""
    return Look(**{"sigma_n_deg": 2.0, "c": 0.3, **entries})


def cases() -> Iterator[tuple[str, Scene, Look]]:
    """Every branch of the model that a paper's page can need, one at a time."""
    far = Display(viewing_distance_m=1.5)
    yield "eye grain", Scene(MATTE), look(grain="eye")
    yield "fine eye grain", Scene(MATTE, display=far), look(grain="eye", grain_arcmin=0.3)
    yield "eye grain, tangent", Scene(MATTE), look(grain="eye", noise_law="tangent")
    yield "surface grain", Scene(MATTE), look(grain="surface", grain_mm=1.3)
    yield "coarse screen grain", Scene(ART), look(noise_law="tangent", grain_px=3)
    yield "noisy highlight only", Scene(ART), look(noisy_lobes="specular")
    for kind in ("sphere", "plane", "box"):
        scene = Scene(MATTE, shape=Shape(kind), eye=TURNED, lamp=Lamp(azimuth_deg=30.0))
        yield kind, scene, look(grain="surface")
    yield "cap", Scene(MATTE, eye=Eye(elevation_deg=40.0)), look()
    further = (FurtherLamp(), FurtherLamp(azimuth_deg=10.0, share=0.3, radius_m=0.1))
    yield "lamps", Scene(ART, Setup(further_lamps=further)), look()
    yield "disc", Scene(ART, lamp=Lamp(radius_m=0.1)), look()
    yield "ambient", Scene(ART, lamp=Lamp(ambient=0.3)), look()
    yield "metal", Scene(METAL), look()
    yield "samples", Scene(ART), look(samples=3)
    yield "needed samples", Scene(paper("cast"), eye=Eye(distance_m=2.0)), look(samples=None)
    yield "smooth edges", Scene(MATTE, eye=Eye(elevation_deg=20.0), display=SMOOTH), look()
    box = Scene(MATTE, shape=Shape("box"), eye=TURNED, display=replace(SMOOTH, gamut="clip"))
    yield "smooth box", box, look()
    wide = Eye(field_of_view_deg=120.0)
    yield "tiny", Scene(MATTE, shape=Shape("sphere"), eye=wide, display=SMOOTH), look()
    yield "white in front", Scene(ART, lamp=Lamp(y_n="front")), look()
    yield "afar", Scene(ART, eye=Eye(distance_m=100.0)), look()
    shifted = Eye(field_of_view_deg=6.0, shift_right=0.02, shift_up=-0.03)
    yield "shifted", Scene(ART, eye=shifted), look()
    yield "inside", Scene(ART, eye=Eye(distance_m=0.01, field_of_view_deg=40.0)), look()
    yield "unlit", Scene(ART, lamp=Lamp(azimuth_deg=180.0)), look()
    yield "no grain", Scene(ART), look(sigma_n_deg=0.0)
    yield "another model", Scene(ART), look(diffuse_model="eon")
    yield "clipped", Scene(ART), look(c=3.0)


CASES = {name: (scene, drawn) for name, scene, drawn in cases()}


def pair_of(scene: Scene, drawn: Look) -> dict[str, tuple[Scene, Look]]:
    """A pair whose test picture has another grain and another c."""
    return {"reference": (scene, drawn), "test": (scene, drawn.with_entries(c=0.1, seed=5))}


def random_states(count: int, seed: int) -> list[Settings]:
    """Views, lamps and settings that a hand on the sliders can reach."""
    rng = np.random.default_rng(seed)

    def setting() -> PictureSetting:
        sigma = 0.0 if rng.random() < 0.15 else float(rng.uniform(0.0, 6.0))
        return PictureSetting(sigma, float(10.0 ** rng.uniform(-2.0, 0.7)))

    states = []
    for _ in range(count):
        view = None if rng.random() < 0.6 else float(rng.uniform(2.0, 40.0))
        eye = Eye(
            azimuth_deg=float(rng.uniform(-180.0, 180.0)),
            elevation_deg=float(rng.uniform(-89.0, 89.0)),
            distance_m=float(10.0 ** rng.uniform(-0.9, 1.5)),
            field_of_view_deg=view,
            shift_right=float(rng.normal(0.0, 0.01)),
            shift_up=float(rng.normal(0.0, 0.01)),
        )
        lamp = LampPlace(
            azimuth_deg=float(np.clip(eye.azimuth_deg + rng.normal(0.0, 50.0), -180.0, 180.0)),
            elevation_deg=float(np.clip(eye.elevation_deg + rng.normal(0.0, 30.0), -90.0, 90.0)),
            distance_m=float(10.0 ** rng.uniform(-0.5, 0.7)),
            illuminant=str(rng.choice(["HP5", "D65", "D50", "A", "FL2", "FL11"])),
        )
        states.append(Settings(setting(), setting(), eye, lamp))
    return states
