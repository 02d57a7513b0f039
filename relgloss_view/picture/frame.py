"""Frame: one picture with every stage that led to it, its scaling and its warnings."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from warnings import warn

import numpy as np

from relgloss_view.base.arrays import AnyArray, Array, Floats
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.material.spectra import illuminant
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.model.highlight import shows_gloss
from relgloss_view.picture.model.light import light_warnings
from relgloss_view.picture.model.pixel_sampling import (
    MAX_SAMPLES,
    PIXELS_A_GRAIN,
    grainiest,
    pixels_a_grain,
    sample_count,
    samples_needed,
)
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import FULL_SHARE
from relgloss_view.picture.stages import Stages

#: Of a picture in which a sample's gloss can't be judged; the window has a button for the step.
NO_GLOSS = (
    "no gloss is visible in this view: no visible part of the object mirrors the lamp; turn the "
    "lamp to the highlight (--lamp auto)"
)

BLACK = (
    "the lamp lights nothing that the eye sees: the object is black; turn the lamp to the "
    "highlight (--lamp auto)"
)


@dataclass(frozen=True)
class Extremes:
    """Extremes over the object's pixels, from the reduction of pass 1; in L* but for the counts."""

    smallest_ratio: float  #: min of (100 - L_d) / L_s over the pixels
    l_d_max: float
    l_s_max: float
    brightest_l_d: float  #: of the brightest pixel
    brightest_l_s: float
    not_finite: int = 0  #: number of pixels

    @classmethod
    def of_nothing(cls) -> Extremes:
        """The extremes where no pixel shows the object."""
        return cls(1e30, 0.0, 0.0, 0.0, 0.0)

    @classmethod
    def over(cls, l_d: Array, l_s: Array) -> Extremes:
        """The extremes over pixels whose L_d* and L_s*, (N,), are at hand in float64."""
        if len(l_d) == 0:
            return cls.of_nothing()
        brightest = int(np.argmax(l_d + l_s))
        return cls(
            float(np.min(tone.largest_c(l_d, l_s))),
            float(np.max(l_d)),
            float(np.max(l_s)),
            float(l_d[brightest]),
            float(l_s[brightest]),
            int(np.sum(~np.isfinite(l_d + l_s))),
        )

    def joined(self, other: Extremes) -> Extremes:
        """The extremes over these pixels and others; of equally bright ones, these count."""
        brightest = self
        if other.brightest_l_d + other.brightest_l_s > self.brightest_l_d + self.brightest_l_s:
            brightest = other
        return Extremes(
            min(self.smallest_ratio, other.smallest_ratio),
            max(self.l_d_max, other.l_d_max),
            max(self.l_s_max, other.l_s_max),
            brightest.brightest_l_d,
            brightest.brightest_l_s,
            self.not_finite + other.not_finite,
        )


#: Highlights drawn this much too strong are called so; a few percent of their L_s* are not seen.
EXAGGERATED = 1.05


@dataclass(frozen=True)
class Scaling:
    """The scaling of L_s* in a picture; c_max is None where no pixel shows a highlight."""

    c: float
    c_max: float | None
    c_max_eq4: float | None  #: the paper's approximation, at the brightest pixel
    warnings: tuple[str, ...] = ()
    factor: float = 1.0  #: c is the look's times this, so that a pair of pictures is scaled alike

    @classmethod
    def of(
        cls, look: Look, extremes: Extremes, *, eq4: bool = False, factor: float = 1.0
    ) -> Scaling:
        """The scaling from the look's setting and the exact c_max of the picture.

        c_max is the largest c that keeps L_d* + c L_s* at most 100 in every pixel (Ishii et al.,
        eq. 4, evaluated at every pixel). eq4: take it at the brightest pixel alone, as the paper
        does. factor: of a look's own c, from picture.pair. Raises InputError where the look asks
        for c_max and the diffuse part alone exceeds L* = 100.
        """
        if extremes.not_finite:
            raise InputError(
                f"{extremes.not_finite} pixels are not finite: the material's lobe is too strong "
                "for float32; lower its strength or widen s_deg"
            )
        if extremes.l_d_max > 100.0 + tone.CLIP_TOLERANCE:
            text = (
                f"the diffuse part alone reaches L* = {extremes.l_d_max:.1f}, so no c keeps the "
                "picture displayable; check the albedo and the quantity of its measurement, and "
                "whether the lamp only grazes the object"
            )
            if look.c is None:
                raise InputError(f"c_max: {text}; --c VALUE draws it clipped")
            return cls(look.c * factor, None, None, (text,), factor)
        if extremes.l_s_max < tone.NO_LOBE_LSTAR:
            ignored = look.setting.c_fraction != FULL_SHARE
            notes = ("no pixel shows a highlight: c_max has no value, and c is 1",)
            c = 1.0 if look.c is None else look.c * factor
            return cls(c, None, None, notes if ignored else (), factor)
        at_brightest = (100.0 - extremes.brightest_l_d) / max(extremes.brightest_l_s, 1e-6)
        c_max = max(at_brightest if eq4 else extremes.smallest_ratio, 0.0)
        c = look.setting.scaling(c_max) * (1.0 if look.c is None else factor)
        warnings = []
        if c > EXAGGERATED:
            warnings.append(f"c = {c:.3g} is above 1: the picture exaggerates the contrast gloss")
        if c > c_max * (1.0 + 1e-9):
            warnings.append(f"c = {c:.3g} is above c_max = {c_max:.3g}: highlights are clipped")
        return cls(c, c_max, at_brightest, tuple(warnings), factor)


def scene_warnings(
    scene: Scene, look: Look, size: tuple[int, int], *, seen: bool, lit: bool
) -> tuple[str, ...]:
    """Warnings of a picture that is empty or black, or whose highlight or grain is undersampled.

    seen: some pixel shows the object. lit: the lamp lights some of it.
    """
    if scene.shape.contains(scene.eye.position_m):
        return ("the eye is inside the object: nothing is seen",)
    if not seen:
        return ("nothing of the object falls on a pixel's sample: the picture is empty",)
    if not lit and scene.lamp.ambient == 0.0:
        return (BLACK,)
    warnings = list(illuminant(scene.lamp.illuminant).notes)
    warnings += light_warnings(scene.setup, lit=lit)
    needed = samples_needed(scene, size)
    if sample_count(scene, look, size) < needed:
        warnings.append(
            "the highlight is about as narrow as a pixel or narrower, so its brightness depends on "
            f"where pixels fall: --samples {needed} keeps its energy"
        )
    return (*warnings, *_grain_warnings(scene, look, size))


def _grain_warnings(scene: Scene, look: Look, size: tuple[int, int]) -> tuple[str, ...]:
    """The warning of grain that is smaller than a pixel."""
    look = grainiest(scene, look)
    pixels = pixels_a_grain(scene, look, size)
    if look.sigma_n_deg == 0.0 or pixels <= PIXELS_A_GRAIN:
        return ()
    needed = min(MAX_SAMPLES, math.ceil(pixels))
    averaged = sample_count(scene, look, size)
    if look.grain == "eye":
        text = (
            f"a pixel of this display is {pixels:.2g} times as large as the grain, so the picture "
            "shows less grain than a finer display would: come nearer "
            "(display.viewing_distance_m), or raise --grain-arcmin"
        )
    elif averaged < needed:
        text = (
            f"a pixel sees {pixels:.2g} grains a side and shows one of them, so the grain looks "
            f"coarser than it is: --samples {needed} averages them"
        )
    else:
        return ()
    if pixels > MAX_SAMPLES:
        text += (
            f"; {MAX_SAMPLES} samples a side don't reach every grain of a pixel, so some grain is "
            "left where a pixel would show none"
        )
    return (text,)


class Frame(Stages):
    """A picture with all its stages, each fetched on first use and then kept.

    A renderer makes it. Arrays are (H, W, ...), row 0 the top. XYZ is relative to Y_n: Y = 1 is
    the perfect diffuser. A notebook shows the picture with its colour profile.

    >>> from relgloss_view import Look, Scene, load_sample, open_renderer
    >>> look = Look(sigma_n_deg=2.0, c_fraction=0.5, samples=1)
    >>> with open_renderer("reference") as renderer:
    ...     frame = renderer.render(Scene(load_sample("art-coated")), look, (24, 24))
    ...     l_d, l_s = frame.split
    >>> bool(abs(frame.c - 0.5 * frame.c_max) < 1e-12)
    True
    >>> scaled = l_d + frame.c * l_s  # eq. 2; the whole of c_max would reach L* = 100
    >>> bool(scaled.max() < 100.0), frame.clip_count
    (True, 0)
    """

    def __init__(
        self,
        scene: Scene,
        look: Look,
        size: tuple[int, int],
        scaling: Scaling,
        fetch: Callable[..., AnyArray],
        device: str,
        warnings: tuple[str, ...] = (),
        method: Method = EXACT,
        object_pixels: int = 0,
        l_s_max: float = 0.0,
    ) -> None:
        self.scene = scene
        self.look = look
        self.size = size
        self.scaling = scaling
        self.device = device
        self.method = method
        self.object_pixels = object_pixels  #: number of pixels that show any of the object
        self.l_s_max = l_s_max  #: largest L_s* of a pixel
        self._fetch = fetch
        self._scene_warnings = warnings

    def __repr__(self) -> str:
        c_max = "none" if self.c_max is None else f"{self.c_max:.4g}"
        count = len(self.warnings)
        warned = f", {count} warning{'' if count == 1 else 's'}" if count else ""
        return (
            f"<Frame of {printable(self.scene.name, 60)!r}: "
            f"{self.size[0]} x {self.size[1]} pixels, sigma_N {self.look.sigma_n_deg:g} deg, "
            f"c {self.c:.4g}, c_max {c_max}{warned}>"
        )

    def _repr_png_(self) -> bytes | None:
        """The picture that a notebook shows, as a PNG with its colour profile.

        Where the renderer was closed before the picture was fetched, it warns and returns None, so
        that the notebook shows the text.
        """
        from relgloss_view.picture.output.png import png_bytes

        try:
            return png_bytes(self)
        except RelglossError as error:
            warn(str(error), stacklevel=2)
            return None

    @cached_property
    def lacks_gloss(self) -> bool:
        """Whether the sample has gloss, and this view of it shows none."""
        shining = [part for part in self.scene.parts(self.look) if part[0].visible_lobes()]
        if self.object_pixels == 0 or not shining:
            return False
        return not any(
            shows_gloss(material, sigma_n_deg, self.scene.setup, self.size, self.l_s_max)
            for material, sigma_n_deg in shining
        )

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What is wrong or doubtful with the material, the scene or c, one sentence each."""
        scene = self._scene_warnings
        unseen = (NO_GLOSS,) if BLACK not in scene and self.lacks_gloss else ()
        return (*self.scene.warnings, *scene, *unseen, *self.scaling.warnings)

    @property
    def y_n_cd_m2(self) -> float:
        """Luminance of the perfect diffuser in the object's place."""
        return self.scene.lamp.luminance_cd_m2

    @property
    def c(self) -> float:
        """The scaling of L_s* in this picture."""
        return self.scaling.c

    @property
    def c_max(self) -> float | None:
        """Largest c that keeps every pixel displayable; None where no pixel shows a highlight."""
        return self.scaling.c_max

    @cached_property
    def white_xyz(self) -> Array:
        """White of the scene's lamp, Y = 1."""
        return illuminant(self.scene.lamp.illuminant).white_xyz()

    @cached_property
    def _counts(self) -> Floats:
        return self._fetch("counts")

    @property
    def clip_count(self) -> int:
        """Number of clipped pixels."""
        return int(self._counts[0])

    @property
    def out_of_gamut_count(self) -> int:
        """Number of pixels out of gamut."""
        return int(self._counts[1])

    @cached_property
    def edges(self) -> Array | None:
        """(N, 3), column, row and share of the pixels that the object covers in part.

        None where silhouettes are as sampled, or several samples a pixel have shares of their own.
        """
        several = sample_count(self.scene, self.look, self.size) > 1
        if self.scene.display.edges != "smooth" or several:
            return None
        return np.asarray(self._fetch("edges"), dtype=np.float64)

    def fetch(self, stage: str, rows: slice) -> AnyArray:
        """Some rows of a stage as the renderer has it, not kept; for picture.stages.Part."""
        return self._fetch(stage, rows)

    def _stage(self, name: str) -> AnyArray:
        return self._fetch(name)
