"""The truth: the same Frame in float64 numpy, band by band, with nothing folded or approximated."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.display.model import DisplayModel
from relgloss_view.material import brdf
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.body import Body, MaterialBody, PackBody
from relgloss_view.picture.frame import Extremes, Frame, Scaling, scene_warnings
from relgloss_view.picture.model import lights, shape, tone
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.grain import grain_normal
from relgloss_view.picture.model.light import front_white, lit_white
from relgloss_view.picture.model.lights import white_seen
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.sight import sight
from relgloss_view.picture.model.silhouette import coverage, edge_pixels, smoothed
from relgloss_view.picture.model.surface import surface_of
from relgloss_view.picture.model.view import Size, View, check_size
from relgloss_view.picture.peak import check_picture
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.stages import PART_PIXELS

CHUNK_VALUES = 4_000_000  #: pixels times bands that are held at once
#: Stages that are drawn when they are asked for, by what draws them.
DRAWN_TOGETHER = {
    "geometry": ("normal", "tilted_normal", "point_m"),
    "tone": ("split", "lab", "light", "flags"),
    "display": ("display",),
}


class ReferenceRenderer:
    """Draws the frames that the GPU is held against. Needs no OpenGL.

    `progress(share, text)` is called as rows are finished; large pictures take a while.
    """

    def __init__(self, progress: ProgressReport = no_progress) -> None:
        self._progress = progress

    def render(self, scene: Scene, look: Look, size: Size, *, factor: float = 1.0) -> Frame:
        """Draw a scene in float64; arguments and errors as Renderer.render."""
        view = View.of(scene, check_size(size))
        check_picture(size, backend="reference")
        samples = sample_count(scene, look, size)
        white, seen = self._white(scene, view, samples)
        if scene.lamp.y_n == "front":
            white = front_white(scene.setup, view)
        white = lit_white(white, scene.setup)
        drawn = as_drawn(scene, look)
        stages = ReferenceStages(drawn, look, view, samples)
        extremes, pixels = self._shade(stages, white)
        scaling = Scaling.of(look, extremes, factor=factor)
        stages.c = scaling.c
        return Frame(
            scene=scene,
            look=look,
            size=size,
            scaling=scaling,
            fetch=stages.fetch,
            device="float64 numpy",
            warnings=scene_warnings(scene, look, size, seen=seen, lit=white > 0.0),
            object_pixels=pixels,
            l_s_max=extremes.l_s_max,
        )

    def _white(self, scene: Scene, view: View, samples: int) -> tuple[float, bool]:
        """Largest of what the perfect diffuser shows in a pixel, and whether any shows it."""
        largest, seen = 0.0, False
        for rows in _row_chunks(view, bands=8):
            checkpoint()
            total, covered = np.zeros(1), np.zeros(1)
            for place in _places(samples):
                hit, _, _ = _meet(scene, view, rows, place)
                seen_white = white_seen(scene.setup, hit.point_m, hit.normal)
                total = total + np.where(hit.found, seen_white, 0.0)
                covered = covered + hit.found
            largest = max(largest, float(np.max(total / np.maximum(covered, 1.0))))
            seen = seen or bool(np.any(covered > 0.0))
        return largest, seen

    def _shade(self, stages: ReferenceStages, white: float) -> tuple[Extremes, int]:
        """Draw diffuse and specular; returns their extremes and how many pixels show the object."""
        scene, look, view = stages.scene, stages.look, stages.view
        body = stages.body
        places = _places(stages.samples)
        height = view.size[1]
        ambient = scene.lamp.ambient
        power = np.pi * (1.0 - ambient)
        extremes, pixels = Extremes.of_nothing(), 0
        for rows in _row_chunks(view, body.bands):
            self._progress(rows.start / height, f"row {rows.start} of {height}")
            diffuse_light, specular_light = stages.diffuse[rows], stages.specular[rows, :, :3]
            gloss_factor = stages.specular[rows, :, 3]
            covered = np.zeros(diffuse_light.shape[:2])
            for place in places:
                checkpoint()
                hit, o, n = _meet(scene, view, rows, place, look, body, stages.samples)
                smooth_n = n if look.noisy_lobes == "both" else hit.normal
                for light in lights.lit(scene.setup, hit.point_m) if white else ():
                    grain = brdf.facing(n, light.i, o)
                    smooth = grain if smooth_n is n else brdf.facing(smooth_n, light.i, o)
                    arriving = np.where(hit.found, power / (white * light.distance2), 0.0)
                    diffuse = body.diffuse(smooth)
                    specular = body.specular(grain, n, light, o)
                    lit_diffuse = arriving * np.maximum(smooth.mu_i, 0.0)
                    lit_specular = arriving * np.maximum(grain.mu_i, 0.0)
                    diffuse_light[..., :3] += lit_diffuse[..., None] * diffuse
                    specular_light += lit_specular[..., None] * specular
                if ambient > 0.0:
                    shown = body.ambient(np.sum(smooth_n * o, axis=-1), np.sum(n * o, axis=-1))
                    diffuse_light[..., :3] += ambient * np.where(hit.found[..., None], shown, 0.0)
                covered += hit.found
                if isinstance(body, PackBody):
                    gloss_factor += body.gloss_factor()
            diffuse_light[..., :3] /= np.maximum(covered, 1.0)[..., None]
            specular_light /= np.maximum(covered, 1.0)[..., None]
            gloss_factor /= np.maximum(covered, 1.0)
            diffuse_light[..., 3] = covered / len(places)
            drawn = covered > 0.0
            l_d, l_s = tone.split_lightness(
                diffuse_light[..., 1][drawn], specular_light[..., 1][drawn]
            )
            if np.any(drawn):
                found = Extremes.over(l_d, l_s * gloss_factor[drawn] if scene.pack else l_s)
                extremes = extremes.joined(found) if pixels else found
                pixels += int(np.sum(drawn))
        return extremes, pixels


def _meet(
    scene: Scene,
    view: View,
    rows: slice,
    place: tuple[float, float],
    look: Look | None = None,
    body: Body | None = None,
    samples: int = 1,
) -> tuple[shape.Hit, Array, Array]:
    """Hit, to eye, the grain's normal; a pack's body is put where the hits are."""
    seen = sight(
        scene.shape,
        view,
        *np.broadcast_arrays(
            np.arange(view.size[0]) + (place[0] - 0.5),
            np.arange(view.size[1])[rows, None] + (place[1] - 0.5),
        ),
    )
    hit, ray = seen.hit, seen.ray
    sigma_n_deg = None
    if isinstance(body, PackBody):
        assert scene.pack is not None
        body.put_at(surface_of(scene.pack, view, seen, samples))
        sigma_n_deg = body.sigma_n_deg()
    o = -ray / np.linalg.norm(ray, axis=-1, keepdims=True)
    n = hit.normal
    if look is not None:
        y, x = np.mgrid[rows, 0 : view.size[0]]
        n = grain_normal(scene, look, hit, o, np.stack([x, y], axis=-1), place, sigma_n_deg)
    return hit, o, n


class ReferenceStages:
    """The stages of a picture: diffuse and specular are held, the others drawn when asked for."""

    def __init__(self, scene: Scene, look: Look, view: View, samples: int) -> None:
        width, height = view.size
        self.scene, self.look, self.view, self.samples = scene, look, view, samples
        self.c = 1.0
        self.diffuse = np.zeros((height, width, 4))
        #: XYZ, and of packs the factor k of L_s*
        self.specular = np.zeros((height, width, 4))
        self.body: Body = (
            MaterialBody(scene) if scene.pack is None else PackBody(scene.pack, scene, look)
        )
        self._last: tuple[str, slice, dict[str, Array]] | None = None

    def fetch(self, stage: str, rows: slice | None = None) -> Array:
        """A stage, or some rows of it, (rows, W, ...)."""
        whole = slice(0, self.view.size[1])
        if stage in ("diffuse", "specular"):
            held: Array = getattr(self, stage)
            return held[rows or whole]
        if stage == "edges":
            return self._edges
        if stage == "counts":
            return self._counts
        if rows is not None:
            return self._drawn(stage, rows)
        parts = (self._drawn(stage, part) for part in self._parts())
        return np.concatenate(list(parts))

    @cached_property
    def _counts(self) -> Array:
        """How many pixels are clipped, and how many out of gamut."""
        total = np.zeros(2)
        for rows in self._parts():
            flags = self._drawn("flags", rows).astype(np.uint8)
            total += np.array([np.sum(flags & 1), np.sum(flags >> 1)])
        return total

    @cached_property
    def _edges(self) -> Array:
        return edge_pixels(coverage(self.scene.shape, self.view))

    def _parts(self) -> list[slice]:
        width, height = self.view.size
        step = max(1, PART_PIXELS // width)
        return [slice(first, min(first + step, height)) for first in range(0, height, step)]

    def _drawn(self, stage: str, rows: slice) -> Array:
        """Rows of a stage that is not held; what was drawn with it is kept until the next ones."""
        group = next(name for name, stages in DRAWN_TOGETHER.items() if stage in stages)
        if self._last is None or self._last[:2] != (group, rows):
            draw = {"geometry": self._geometry, "tone": self._tone, "display": self._display}
            self._last = group, rows, draw[group](rows)
        return self._last[2][stage]

    def _geometry(self, rows: slice) -> dict[str, Array]:
        """What the first sample of a pixel that meets the object sees, its centre tried first."""
        scene, look, view = self.scene, self.look, self.view
        covered = self.diffuse[rows][..., 3] > 0.0
        stages = {name: np.zeros((*covered.shape, 3)) for name in DRAWN_TOGETHER["geometry"]}
        open_ = np.ones(covered.shape, dtype=bool)
        for place in [(0.5, 0.5), *_places(self.samples)]:
            hit, _, n = _meet(scene, view, rows, place, look, self.body, self.samples)
            new = open_ & hit.found
            stages["normal"][new] = hit.normal[new]
            stages["tilted_normal"][new] = n[new]
            stages["point_m"][new] = hit.point_m[new]
            open_ &= ~hit.found
            if not np.any(open_ & covered):
                break
        return stages

    def _tone(self, rows: slice) -> dict[str, Array]:
        display = DisplayModel.of(self.scene.display)
        diffuse, specular = self.diffuse[rows], self.specular[rows]
        covered = diffuse[..., 3:]
        seen = covered > 0.0
        white = illuminant(self.scene.lamp.illuminant).white_xyz()
        split = tone.split_lab(diffuse[..., :3], specular[..., :3], white)
        if self.scene.pack is not None:
            split[..., 1] *= specular[..., 3]
        lab = tone.scaled_lab(split, self.c)
        shown, inside = tone.display_rgb(lab, display)
        light = np.where(
            seen,
            covered * shown + (1.0 - covered) * display.background_rgb,
            display.background_rgb,
        )
        flags = np.where(
            seen[..., 0],
            (lab[..., 0] > 100.0 + tone.CLIP_TOLERANCE)
            + 2 * ~inside
            + 4 * tone.cut_by_screen(shown, display),
            0,
        ).astype(np.uint8)
        return {
            "split": np.where(seen, split, (tone.OFF_OBJECT, 0.0, 0.0, 0.0)),
            "lab": np.where(seen, lab, 0.0),
            "light": np.concatenate([light, covered], axis=-1),
            "flags": flags[..., None],
        }

    def _display(self, rows: slice) -> dict[str, Array]:
        """What the display gets: smooth silhouettes and dither, where it asks for them."""
        display, height = self.scene.display, self.view.size[1]
        model = DisplayModel.of(display)
        # With the rows beside these, from which pixels at the silhouette may take their colour.
        more = slice(max(rows.start - 1, 0), min(rows.stop + 1, height))
        own = slice(rows.start - more.start, rows.stop - more.start)
        stages = self._tone(more)
        light, shows = stages["light"][..., :3], self.diffuse[more][..., 3] > 0.0
        if display.edges == "smooth" and self.samples == 1:
            edges = self._edges
            edges = edges[(edges[:, 1] >= more.start) & (edges[:, 1] < more.stop)]
            edges = edges - (0.0, float(more.start), 0.0)
            light, shows = smoothed(light, shows, edges, model.background_rgb)
        dithered = shows[own] if display.dither == "ordered" else None
        steps = tone.digital_steps(light[own], model, dithered, height - rows.stop)
        return {"display": np.concatenate([steps, 255.0 - stages["flags"][own]], axis=-1)}


def _places(samples: int) -> list[tuple[float, float]]:
    """Sample places inside a pixel, in the shader's order."""
    steps = [(k + 0.5) / samples for k in range(samples)]
    return [(x, y) for y in steps for x in steps]


def _row_chunks(view: View, bands: int) -> list[slice]:
    width, height = view.size
    rows = max(1, CHUNK_VALUES // (width * bands))
    return [slice(first, min(first + rows, height)) for first in range(0, height, rows)]
