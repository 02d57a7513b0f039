"""The cheapest method whose error on a scene's proxy is inside a tolerance.

Stage by stage, those that save most first, the simplest choice is taken with which the picture as
a whole stays inside; so what is returned has been measured as it is. Only sums and cached numbers
go into it, no clock, so that the same scene has the same method everywhere.
"""

from __future__ import annotations

import dataclasses
import math
import time
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, parameter
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.method import EXACT, FIRST_PASS, Method
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.domains import outside
from relgloss_view.quality.proxy import Deviation, Proxy


@dataclass(frozen=True)
class Tolerance(Checked):
    """What a picture may differ by from the whole model's, CIEDE2000."""

    p95: float = parameter(0.5, 0.0, 100.0, "", "95th percentile, over object and highlight each")
    largest: float = parameter(2.0, 0.0, 100.0, "", "at any pixel")

    def holds(self, error: Deviation, of_p95: float = 1.0, of_largest: float = 1.0) -> bool:
        """Whether an error is inside these shares of it."""
        worst = max(error.object_p95, error.highlight_p95)
        return worst <= of_p95 * self.p95 and error.largest <= of_largest * self.largest


#: The choices of a stage, the simplest first, and what each saves of the time of a frame drawn
#: exactly, in per cent: a matte paper with grain on llvmpipe. The order of the stages is that of
#: what can be saved. The split in pass 1, which every scene takes, saves 17 more.
SAVINGS: dict[str, dict[str | int, float]] = {
    "noise": {"none": 7.0, "drawn": 0.0},
    "lobes": {0: 7.0, 1: 4.0, 2: 0.0},
    "diffuse": {"lambert": 7.0, "qualitative": 6.0, "eon": 3.0, "fitted": 0.0},
    "fresnel": {"constant": 4.0, "schlick": 2.0, "exact": 0.0},
    "gamut": {"clip": 1.0, "as asked": 0.0},
    "targets": {"float16": 1.0, "float32": 0.0},
    "shadowing": {"none": 1.0, "v-groove": 0.0},
    "lamp": {"distant": 1.0, "point": 0.0},
}


@dataclass(frozen=True)
class StageChoice:
    """What is drawn of a stage, and why nothing simpler is."""

    stage: str
    chosen: str | int
    saved_percent: float  #: of the time of a frame drawn exactly
    error: Deviation  #: of this choice alone
    simpler: str | int | None = None  #: the next simpler one
    simpler_error: Deviation | None = None  #: together with what was chosen before it
    reason: str = ""  #: why the simpler one is not drawn, where it is not for its error


@dataclass(frozen=True)
class Advice:
    """The method for a scene, with the error of the whole."""

    method: Method
    choices: tuple[StageChoice, ...]
    error: Deviation
    note: str = ""

    @property
    def saved_percent(self) -> float:
        """Of the time of a frame drawn exactly, by the savings that were measured one by one."""
        return min(sum(choice.saved_percent for choice in self.choices), 90.0)


#: Shares of the tolerance that a choice uses: percentiles of a thousand pixels are nearly those of
#: all, but the largest error of all may be well above the largest of those.
USED = (0.9, 0.4)
WEAK_LSTAR = 2.0  #: of a highlight whose c_max is far above 1, so that little moves it
REMEMBERED = 64  #: pictures with their advice
CHECK_SECONDS = 0.1  #: between two looks at a moving picture, each of a few milliseconds
NO_ERROR = Deviation(0.0, 0.0, 0.0)


DEFAULT_TOLERANCE = Tolerance()
#: What quality "auto" starts from: the whole model, its L* split in pass 1, which draws the same
#: within the rounding of float32 and costs less.
WHOLE = Method(split=FIRST_PASS)


#: A simplification that serves one finish may not serve the next.
PACK_NOTE = "a pack of several surfaces: everything is drawn exactly"
#: The thousand rays of a proxy cost more there than the picture itself.
MESH_NOTE = "a form made of triangles: everything is drawn exactly"


def _drawn_whole(scene: Scene) -> str:
    """Why no simplification is looked for, or nothing."""
    if scene.pack is not None:
        return PACK_NOTE
    return "" if scene.shape.kind in ANALYTIC else MESH_NOTE


def advise(
    scene: Scene, look: Look, size: Size, tolerance: Tolerance = DEFAULT_TOLERANCE
) -> Advice:
    """Choose a method; raises InputError where no c can show the picture, as drawing it does."""
    note = _drawn_whole(scene)
    if note:
        return Advice(WHOLE, (), NO_ERROR, note)
    proxy = Proxy(scene, look, size)
    note = _only_exact(proxy, size)
    if note:
        return Advice(WHOLE, (), NO_ERROR, note)
    method, choices = WHOLE, []
    for stage in SAVINGS:
        choice = _choose(proxy, method, stage, tolerance)
        if choice is not None:
            choices.append(choice)
            method = _with(method, stage, choice.chosen)
    return Advice(method, tuple(choices), proxy.error(method))


def _choose(proxy: Proxy, method: Method, stage: str, tolerance: Tolerance) -> StageChoice | None:
    """The simplest choice of a stage that stays inside; None where the scene has no such stage."""
    savings = SAVINGS[stage]
    present = getattr(method, stage)
    simpler: str | int | None = None
    simpler_error: Deviation | None = None
    reason = ""
    for name, saved in savings.items():
        if name == present:
            break
        tried = _with(method, stage, name)
        if _same(proxy, tried, method, stage):
            continue
        error = proxy.error(tried)
        if f"{stage} {name}" in outside(proxy.scene, proxy.look, tried):
            simpler, simpler_error, reason = name, error, "outside its declared domain"
            continue
        if _sets_c(proxy, stage):
            simpler, simpler_error, reason = name, error, "single pixels set c_max"
            continue
        if stage == "gamut" and proxy.leaves_gamut(tried):
            return StageChoice(
                stage, present, 0.0, NO_ERROR, reason="some colours may leave the gamut"
            )
        if tolerance.holds(error, *USED):
            alone = proxy.error(_with(WHOLE, stage, name))
            return StageChoice(
                stage=stage,
                chosen=name,
                saved_percent=saved,
                error=alone,
                simpler=simpler,
                simpler_error=simpler_error,
                reason=reason,
            )
        simpler, simpler_error, reason = name, error, ""
    if simpler is None:
        return None
    return StageChoice(
        stage=stage,
        chosen=present,
        saved_percent=0.0,
        error=NO_ERROR,
        simpler=simpler,
        simpler_error=simpler_error,
        reason=reason,
    )


def _only_exact(proxy: Proxy, size: Size) -> str:
    """Why nothing may be simplified, if so: what a picture hangs on is not on these pixels."""
    if proxy.empty:
        return "no pixel shows the object: nothing to simplify"
    if proxy.dark:
        return "hardly a pixel is lit: everything is drawn exactly"
    if not proxy.scene.setup.is_plain:
        return "the choices were tested under one point lamp: everything is drawn exactly"
    if sample_count(proxy.scene, proxy.look, size) > 1:
        return "several samples a pixel: everything is drawn exactly"
    weak = float(np.max(proxy.exact.l_s, initial=0.0)) < WEAK_LSTAR
    if weak and proxy.look.c is None and proxy.scene.material.visible_lobes():
        return "the highlight is weak, so that little moves c_max: everything is drawn exactly"
    return ""


def _sets_c(proxy: Proxy, stage: str) -> bool:
    """Whether a stage decides on single pixels that c follows from, where c is not given."""
    return proxy.look.c is None and stage == "noise"


def serves(proxy: Proxy, method: Method, size: Size, tolerance: Tolerance) -> bool:
    """Whether a method does for a picture: what `advise` holds its choices to, all at once."""
    if method == WHOLE:
        return True
    changed = method.differences()
    left = outside(proxy.scene, proxy.look, method)
    return (
        not _only_exact(proxy, size)
        and tolerance.holds(proxy.error(method))
        and not any(f"{stage} {name}" in left for stage, name in changed.items())
        and not any(_sets_c(proxy, stage) for stage in changed)
        and not ("gamut" in changed and proxy.leaves_gamut(method))
    )


def _with(method: Method, stage: str, name: str | int) -> Method:
    changed: dict[str, Any] = {stage: name}
    return dataclasses.replace(method, **changed)


def _same(proxy: Proxy, tried: Method, method: Method, stage: str) -> bool:
    """Whether a choice draws what is drawn anyway, because the scene has nothing of it."""
    scene, look = proxy.scene, proxy.look
    if stage == "gamut":
        return scene.display.gamut == "clip"
    if stage == "targets":
        return False
    return Variant.of(scene, look, 1, tried) == Variant.of(scene, look, 1, method)


class MethodChooser:
    """Methods for the pictures of one renderer, remembered by scene, look and size.

    While a hand moves something the choice is held, so that nothing flickers and nothing has to be
    compiled: where it no longer serves, everything is drawn exactly until the hand rests.
    """

    def __init__(
        self,
        tolerance: Tolerance = DEFAULT_TOLERANCE,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.tolerance = tolerance
        self.moving = False  #: a hand moves something
        self._clock = clock
        self._advice: OrderedDict[object, tuple[Advice, object]] = OrderedDict()
        self._held = WHOLE
        self._checked = -math.inf
        self._served: object = None  #: the picture that the held method was last found to serve

    def method(self, scene: Scene, look: Look, size: Size) -> Method:
        """The method for a picture."""
        if look.quality == "exact":
            return EXACT
        if _drawn_whole(scene):
            self._held = WHOLE
            return WHOLE
        try:
            if self.moving:
                return self._while_moving(scene, look, size)
            self._held = self.advice(scene, look, size).method
            self._served = scene, look, size
        except InputError:  # the drawing itself reports it
            self._held = WHOLE
        return self._held

    def advice(self, scene: Scene, look: Look, size: Size) -> Advice:
        """The method with its reasons; raises InputError as `advise` does."""
        if _drawn_whole(scene):
            return advise(scene, look, size, self.tolerance)
        lamp = illuminant(scene.lamp.illuminant)  # another one where its file was edited
        key = id(scene.material), id(lamp), scene.setup, look, size
        if key not in self._advice:
            # The key holds identities: kept with it, no other object can have them.
            advice = advise(scene, look, size, self.tolerance)
            self._advice[key] = advice, (scene.material, lamp)
            if len(self._advice) > REMEMBERED:
                self._advice.popitem(last=False)
        self._advice.move_to_end(key)
        return self._advice[key][0]

    def _while_moving(self, scene: Scene, look: Look, size: Size) -> Method:
        now = self._clock()
        picture = scene, look, size
        due = now - self._checked >= CHECK_SECONDS and picture != self._served
        if self._held != WHOLE and due:
            self._checked, self._served = now, picture
            if not serves(Proxy(scene, look, size), self._held, size, self.tolerance):
                self._held = WHOLE
        return self._held
