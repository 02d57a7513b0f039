"""How far a picture is from the truth: CIEDE2000 of what the display shows, and c_max."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.difference import delta_e_2000
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.quality.backends import FrameRenderer

HIGHLIGHT_LSTAR = 1.0  #: where the reference's L_s*, before scaling, is above this
FINEST_SAMPLES = 16  #: along a pixel's side, of the picture that supersampling tends to


@dataclass(frozen=True)
class Spread:
    """CIEDE2000 over some pixels."""

    mean: float
    p95: float
    max: float
    pixels: int

    @classmethod
    def of(cls, difference: Array) -> Spread | None:
        """None where there is no pixel."""
        if difference.size == 0:
            return None
        return cls(
            float(np.mean(difference)),
            float(np.percentile(difference, 95.0)),
            float(np.max(difference)),
            int(difference.size),
        )


@dataclass(frozen=True)
class Errors:
    """Of one picture; `c_max` is relative, None where either has no highlight."""

    object: Spread | None
    highlight: Spread | None
    c_max: float | None = None

    @property
    def worst_p95(self) -> float:
        """The larger of the two, for a narrow highlight hides in the object's 95 %."""
        return max((s.p95 for s in (self.object, self.highlight) if s is not None), default=0.0)

    def as_dict(self) -> dict[str, Any]:
        """For files."""
        return {**dataclasses.asdict(self), "worst_p95": self.worst_p95}


@dataclass(frozen=True)
class Truth:
    """What a scene looks like in float64, spectral, at c_max or 1, whichever is less."""

    scene: Scene
    look: Look  #: with the c that it is drawn with
    size: Size
    lab: Array  #: as shown
    c_max: float | None
    on_object: Mask
    highlight: Mask

    @classmethod
    def of(cls, scene: Scene, look: Look, size: Size) -> Truth:
        """Draw it; c follows from its c_max."""
        renderer = ReferenceRenderer()
        first = renderer.render(scene, look.at(Setting(look.sigma_n_deg)), size)
        look = look.at(Setting(look.sigma_n_deg, c=shown_c(first.c_max)))
        white = illuminant(scene.lamp.illuminant).white_xyz()
        diffuse, specular = (np.asarray(v, np.float64) for v in (first.diffuse, first.specular))
        lab = lab_of_light(scene, diffuse, specular, white, shown_c(first.c_max))
        return cls(
            scene=scene,
            look=look,
            size=size,
            lab=lab,
            c_max=first.c_max,
            on_object=first.on_object,
            highlight=first.on_object & (first.split[1] > HIGHLIGHT_LSTAR),
        )

    def errors(self, frame: Frame) -> Errors:
        """Of a frame of the same scene and size, as it is shown."""
        both = self.on_object & frame.on_object
        return dataclasses.replace(
            self.errors_of(shown_lab(frame), both), c_max=_relative(frame.c_max, self.c_max)
        )

    def errors_of(self, lab: Array, seen: Mask | None = None) -> Errors:
        """Of a picture given as shown Lab."""
        seen = self.on_object if seen is None else seen
        difference = delta_e_2000(self.lab, lab)
        return Errors(
            Spread.of(difference[seen]),
            Spread.of(difference[seen & self.highlight]),
        )


def shown_c(c_max: float | None) -> float:
    """As strong a highlight as the display holds, but no stronger than the real one."""
    return 1.0 if c_max is None else min(c_max, 1.0)


def shown_lab(frame: Frame) -> Array:
    """(H, W, 3), what the display shows, relative to its white."""
    display = DisplayModel.of(frame.scene.display)
    light = tone.as_shown(frame.light.astype(np.float64), display)
    return tone.lab_from_xyz(light @ display.xyz_from_rgb.T, display.white)


def lab_of_light(scene: Scene, diffuse: Array, specular: Array, white: Array, c: float) -> Array:
    """(H, W, 3), what the display shows of XYZ of both reflections, scaled by c."""
    display = DisplayModel.of(scene.display)
    lab = tone.scaled_lab(tone.split_lab(diffuse, specular, white), c)
    shown, _ = tone.display_rgb(lab, display)
    light = tone.as_shown(shown, display)
    return tone.lab_from_xyz(light @ display.xyz_from_rgb.T, display.white)


def mean_of_grains(renderer: FrameRenderer, truth: Truth, seeds: range) -> tuple[Errors, Truth]:
    """The truth with its grain averaged in linear light over many seeds.

    Also the errors between the halves of the seeds, which bound what the average is worth.
    """
    white = illuminant(truth.scene.lamp.illuminant).white_xyz()
    shape = (*truth.lab.shape[:2], 3)
    sums = [(np.zeros(shape), np.zeros(shape)) for _ in range(2)]
    for seed in seeds:
        look = dataclasses.replace(truth.look, seed=seed)
        frame = renderer.render(truth.scene, look, truth.size)
        diffuse, specular = sums[seed % 2]
        diffuse += frame.diffuse
        specular += frame.specular
    c = truth.look.c
    assert c is not None
    half = 0.5 * len(seeds)
    even, odd = (lab_of_light(truth.scene, d / half, s / half, white, c) for d, s in sums)
    (d0, s0), (d1, s1) = sums
    both = lab_of_light(truth.scene, 0.5 * (d0 + d1) / half, 0.5 * (s0 + s1) / half, white, c)
    apart = dataclasses.replace(truth, lab=even).errors_of(odd)
    return apart, dataclasses.replace(truth, lab=both)


def finely_sampled(renderer: FrameRenderer, truth: Truth) -> Truth:
    """The truth with its pixels averaged over their area, which more samples tend to."""
    look = dataclasses.replace(truth.look, samples=FINEST_SAMPLES)
    frame = renderer.render(truth.scene, look, truth.size)
    return dataclasses.replace(truth, lab=shown_lab(frame))


def _relative(found: float | None, true: float | None) -> float | None:
    if found is None or true is None:
        return None
    return found / true - 1.0
