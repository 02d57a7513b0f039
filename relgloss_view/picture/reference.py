"""The truth: the same Frame in float64 numpy, band by band, with nothing folded or approximated."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.material import brdf
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.frame import Extremes, Frame, Scaling, scene_warnings
from relgloss_view.picture.model import shape, tone
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.grain import grain_normal
from relgloss_view.picture.model.light import front_white, lit_white
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.silhouette import coverage, edge_pixels, smoothed
from relgloss_view.picture.model.view import Size, View, check_size, float32
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

CHUNK_VALUES = 4_000_000  #: pixels times bands that are held at once


class ReferenceRenderer:
    """Draws the frames that the GPU is held against. Needs no OpenGL.

    `progress(share, text)` is called as rows are finished; large pictures take a while.
    """

    def __init__(self, progress: ProgressReport = no_progress) -> None:
        self._progress = progress

    def render(self, scene: Scene, look: Look, size: Size, *, factor: float = 1.0) -> Frame:
        """Draw a scene in float64; arguments and errors as Renderer.render."""
        view = View.of(scene, check_size(size))
        samples = sample_count(scene, look, size)
        white, seen = self._white(scene, view, samples)
        if scene.lamp.y_n == "front":
            white = front_white(scene.setup, view)
        white = lit_white(white, scene.setup)
        stages = self._shade(as_drawn(scene, look), look, view, white, samples)
        drawn = stages["diffuse"][..., 3] > 0.0
        l_d, l_s = tone.split_lightness(
            stages["diffuse"][..., 1][drawn], stages["specular"][..., 1][drawn]
        )
        extremes = Extremes.over(l_d, l_s)
        scaling = Scaling.of(look, extremes, factor=factor)
        stages.update(_tone(scene, stages, scaling.c))
        stages.update(_display(scene, stages, view, samples))
        return Frame(
            scene=scene,
            look=look,
            size=size,
            scaling=scaling,
            fetch=lambda stage, rows=None: stages[stage][rows] if rows else stages[stage],
            device="float64 numpy",
            warnings=scene_warnings(scene, look, size, seen=seen, lit=white > 0.0),
            object_pixels=int(np.sum(drawn)),
            l_s_max=extremes.l_s_max,
        )

    def _white(self, scene: Scene, view: View, samples: int) -> tuple[float, bool]:
        """Largest of what the perfect diffuser shows in a pixel, and whether any shows it."""
        largest, seen = 0.0, False
        for rows in _row_chunks(view, bands=8):
            total, covered = np.zeros(1), np.zeros(1)
            for place in _places(samples):
                hit, _, i, _, distance2 = _meet(scene, view, rows, place)
                mu_i = np.maximum(np.sum(hit.normal * i, axis=-1), 0.0)
                total = total + np.where(hit.found, mu_i / distance2, 0.0)
                covered = covered + hit.found
            largest = max(largest, float(np.max(total / np.maximum(covered, 1.0))))
            seen = seen or bool(np.any(covered > 0.0))
        return largest, seen

    def _shade(
        self, scene: Scene, look: Look, view: View, white: float, samples: int
    ) -> dict[str, Array]:
        material = scene.material
        weights = material.xyz_weights(illuminant(scene.lamp.illuminant))
        width, height = view.size
        stages = {name: np.zeros((height, width, 4)) for name in ("diffuse", "specular")}
        stages.update(
            {n: np.zeros((height, width, 3)) for n in ("normal", "tilted_normal", "point_m")}
        )
        places = _places(samples)
        for rows in _row_chunks(view, material.bands.count):
            self._progress(rows.start / height, f"row {rows.start} of {height}")
            covered = np.zeros(stages["diffuse"][rows].shape[:2])
            for place in places:
                hit, o, i, n, distance2 = _meet(scene, view, rows, place, look)
                grain = brdf.facing(n, i, o)
                smooth = grain if look.noisy_lobes == "both" else brdf.facing(hit.normal, i, o)
                arriving = np.where(hit.found, np.pi / (white * distance2), 0.0) if white else 0.0
                diffuse = material.evaluate_facing(smooth)[0] @ weights
                specular = material.evaluate_facing(grain)[1] @ weights
                lit_diffuse = arriving * np.maximum(smooth.mu_i, 0.0)
                lit_specular = arriving * np.maximum(grain.mu_i, 0.0)
                stages["diffuse"][rows][..., :3] += lit_diffuse[..., None] * diffuse
                stages["specular"][rows][..., :3] += lit_specular[..., None] * specular
                covered += hit.found
            for name in ("diffuse", "specular"):
                stages[name][rows][..., :3] /= np.maximum(covered, 1.0)[..., None]
                stages[name][rows][..., 3] = covered / len(places)
            open_ = np.ones(covered.shape, dtype=bool)
            for place in [(0.5, 0.5), *places]:
                hit, _, _, n, _ = _meet(scene, view, rows, place, look)
                new = open_ & hit.found
                stages["normal"][rows][new] = hit.normal[new]
                stages["tilted_normal"][rows][new] = n[new]
                stages["point_m"][rows][new] = hit.point_m[new]
                open_ &= ~hit.found
                if not np.any(open_ & (covered > 0.0)):
                    break
        return stages


def _meet(
    scene: Scene, view: View, rows: slice, place: tuple[float, float], look: Look | None = None
) -> tuple[shape.Hit, Array, Array, Array, Array]:
    """Hit, to eye, to lamp, the grain's normal, squared distance to the lamp."""
    half_extent_m = float32(scene.shape.half_extent_m())
    ray = view.rays(rows, place)
    hit = shape.meet(scene.shape.kind, view.eye_m, ray, half_extent_m)
    to_lamp = float32(scene.lamp.position_m) - hit.point_m
    distance2 = np.maximum(np.sum(to_lamp * to_lamp, axis=-1), 1e-30)
    i = to_lamp / np.sqrt(distance2)[..., None]
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    n = hit.normal
    if look is not None:
        y, x = np.mgrid[rows, 0 : view.size[0]]
        n = grain_normal(scene, look, hit, o, np.stack([x, y], axis=-1), place)
    return hit, o, i, n, distance2


def _tone(scene: Scene, stages: dict[str, Array], c: float) -> dict[str, Array]:
    display = tone.DisplayModel.of(scene.display)
    diffuse, specular = stages["diffuse"], stages["specular"]
    covered = diffuse[..., 3:]
    seen = covered > 0.0
    white = illuminant(scene.lamp.illuminant).white_xyz()
    split = tone.split_lab(diffuse[..., :3], specular[..., :3], white)
    lab = tone.scaled_lab(split, c)
    shown, inside = tone.display_rgb(lab, display)
    light = np.where(
        seen,
        covered * shown + (1.0 - covered) * display.background_light,
        display.background_light,
    )
    flags = np.where(
        seen[..., 0], (lab[..., 0] > 100.0 + tone.CLIP_TOLERANCE) + 2 * ~inside, 0
    ).astype(np.uint8)
    return {
        "split": np.where(seen, split, (tone.OFF_OBJECT, 0.0, 0.0, 0.0)),
        "lab": np.where(seen, lab, 0.0),
        "counts": np.array([np.sum(flags & 1), np.sum(flags >> 1)]),
        "light": np.concatenate([light, covered], axis=-1),
        "flags": flags[..., None],
    }


def _display(scene: Scene, stages: dict[str, Array], view: View, samples: int) -> dict[str, Array]:
    """What the display gets: smooth silhouettes and dither, where it asks for them."""
    model, light = tone.DisplayModel.of(scene.display), stages["light"][..., :3]
    shows = stages["diffuse"][..., 3] > 0.0
    more: dict[str, Array] = {}
    if scene.display.edges == "smooth" and samples == 1:
        more["edges"] = edge_pixels(coverage(scene.shape, view))
        light, shows = smoothed(light, shows, more["edges"], model.background_light)
    steps = tone.digital_steps(light, model, shows if scene.display.dither == "ordered" else None)
    return more | {"display": np.concatenate([steps, 255.0 - stages["flags"]], axis=-1)}


def _places(samples: int) -> list[tuple[float, float]]:
    """Sample places inside a pixel, in the shader's order."""
    steps = [(k + 0.5) / samples for k in range(samples)]
    return [(x, y) for y in steps for x in steps]


def _row_chunks(view: View, bands: int) -> list[slice]:
    width, height = view.size
    rows = max(1, CHUNK_VALUES // (width * bands))
    return [slice(first, min(first + rows, height)) for first in range(0, height, rows)]
