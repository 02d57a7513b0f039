"""The scenes of the chart: four papers, two lamps, an object that fills most of the frame."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.model import shape
from relgloss_view.picture.model.view import Size, View, check_size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup

AZIMUTHS_DEG = (50.0, 110.0)
COVERAGE = 0.64  #: share of the frame that the object is made to fill
LEAST_COVERAGE = 0.60
HEIGHT_M = 0.09
ASPECTS = (0.25, 4.0)  #: of pictures that a cylinder can fill
TRIED_WIDTH_PX = 320
GRAINY_DEG = 1.0  #: sigma_N, at least, where the grain is what is compared


@dataclass(frozen=True)
class ChartScene:
    """A scene of the chart, and the look it is drawn with; its c is the reference's."""

    name: str
    paper: str
    scene: Scene
    look: Look

    def grainy(self) -> ChartScene:
        """The same with grain, where it has too little to compare ways to draw it."""
        look = dataclasses.replace(self.look, sigma_n_deg=max(self.look.sigma_n_deg, GRAINY_DEG))
        return dataclasses.replace(self, look=look)


def chart_scenes(size: Size) -> tuple[ChartScene, ...]:
    """All scenes, for pictures of a size: sigma_N is the one matched for each paper."""
    form = filling_shape(size)
    eye = filling_eye(form, size)
    return tuple(
        ChartScene(
            f"{paper} az{azimuth:g}",
            paper,
            Scene(load_sample(paper), Setup(form, Lamp(azimuth_deg=azimuth), eye)),
            Look(sigma_n_deg=matched.sigma_n_deg),
        )
        for paper, matched in SAMPLES.items()
        for azimuth in AZIMUTHS_DEG
    )


def filling_shape(size: Size) -> Shape:
    """A cylinder of about the picture's proportions."""
    width, height = check_size(size)
    low, high = ASPECTS
    if not low <= width / height <= high:
        raise InputError(
            f"size {width}x{height}: expected a width of {low:g} to {high:g} times the height"
        )
    return Shape(diameter_m=HEIGHT_M * width / height, height_m=HEIGHT_M)


def filling_eye(form: Shape, size: Size) -> Eye:
    """An eye whose angle of view makes the cylinder fill the frame."""
    width, height = size
    tried = (TRIED_WIDTH_PX, max(1, round(TRIED_WIDTH_PX * height / width)))
    filled = _coverage(form, Eye(), tried)
    tangent = 0.5 * tried[1] * View.of(_bare(form, Eye()), tried).pixel_step
    tangent *= math.sqrt(filled / COVERAGE)
    eye = Eye(field_of_view_deg=math.degrees(2.0 * math.atan(tangent)))
    found = _coverage(form, eye, tried)
    if found < LEAST_COVERAGE:
        raise AssertionError(f"the object fills {found:.2f} of {width}x{height}")
    return eye


def _coverage(form: Shape, eye: Eye, size: Size) -> float:
    view = View.of(_bare(form, eye), size)
    rays = view.rays(slice(0, size[1]))
    return float(np.mean(shape.meet(form.kind, view.eye_m, rays, form.half_extent_m()).found))


def _bare(form: Shape, eye: Eye) -> Scene:
    return Scene(load_sample(next(iter(SAMPLES))), shape=form, eye=eye)
