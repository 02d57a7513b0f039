"""The two pictures of a state, drawn for the pane by the one renderer.

Each side has its own renderer, so that a slider of one side leaves the other alone, and a second
one for smaller pictures while something is dragged. All share one set of programs.
"""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.allocator import give_back
from relgloss_view.base.errors import RelglossError
from relgloss_view.material.material import Material
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.gpu.context import collect, max_texture_size
from relgloss_view.picture.gpu.overlays import draw_difference, draw_overlay
from relgloss_view.picture.gpu.programs import Key, Programs
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.targets import OVERLAY, TONE
from relgloss_view.picture.gpu.variant import Variant, tone_defines
from relgloss_view.picture.method import EXACT, Method
from relgloss_view.picture.model.drawn import as_drawn
from relgloss_view.picture.model.pixel_sampling import eye_grain_samples
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.pair import common_factor, held_factor
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.planner import WHOLE, MethodChooser
from relgloss_view.viewer.drawing.arrangement import Arrangement, as_shown
from relgloss_view.viewer.drawing.texture_uploads import TextureUploads
from relgloss_view.viewer.state.model import DrawnPass
from relgloss_view.viewer.state.state import DIFFERENCE, SIDES, State

#: All that the sliders of both sides can reach, warmed up, are 40 to 50.
MOST_PROGRAMS = 56
MOST_WARMED = 1000  #: variants that are remembered
SMALL_SAMPLES = 2  #: along each side of a pixel of a small picture: its highlights are thin
NOT_WARMED: frozenset[Key] = frozenset({()})  #: of no program
WORTH_GIVING_BACK = 4_000_000  #: bytes: less would take longer to give back than it is worth


@dataclass(frozen=True)
class SidePicture:
    """A side's picture on the device: the name of its framebuffer, its size, and its numbers."""

    framebuffer: int
    size: Size
    frame: Frame


@dataclass(frozen=True)
class DrawnPair:
    """The pictures by side, and why one of the others could not be drawn."""

    pictures: dict[str, SidePicture]
    faults: dict[str, str]
    factor: float = 1.0  #: of both c, so that neither picture clips


class PairRenderer:
    """Draws both sides of a state; what has not changed is not drawn again."""

    def __init__(self, ctx: Any) -> None:
        self.ctx = ctx
        self._programs = Programs(ctx, MOST_PROGRAMS)
        #: One for a side, so that what quality "auto" has chosen is held across both sizes.
        self._choosers = {side: MethodChooser() for side in SIDES}
        self._full = {side: self._renderer(side) for side in SIDES}
        self._draft = {side: self._renderer(side) for side in SIDES}
        self._warm = Renderer(ctx, self._programs, MethodChooser().method)
        #: One that quality "auto" does not simplify: its material is another one with each key, and
        #: each might be drawn by other programs.
        self.whole_side = ""
        self.awaited: dict[str, str] = {}  #: sides that are not drawn, and why
        #: The programs of each variant that was warmed up.
        self._warmed: dict[object, set[Key]] = {}
        self._reached: set[object] = set()  #: variants of the last state that was warmed up
        self._tried: set[object] = set()  #: those warmed up since other pictures have needed room
        self._methods: dict[str, Method] = {}  #: of the last picture of each side
        self._edged_view: object = None  #: shape, eye and size of the last one with smooth edges
        self._freed = 0  #: programs, when this last warmed up
        self._freed_bytes = 0  #: of targets, since free memory was last given back
        self.uploads = TextureUploads(ctx)
        self._factor = 1.0  #: of the last pair
        self._enlarged = False  #: whether the renderer that warms up has drawn something large
        limit = max_texture_size(ctx)
        self.largest: Size = (limit, limit)

    def _renderer(self, side: str) -> Renderer:
        def method(scene: Scene, look: Look, size: Size) -> Method:
            if side == self.whole_side and look.quality != "exact":
                return WHOLE
            return self._choosers[side].method(scene, look, size)

        return Renderer(self.ctx, self._programs, method)

    @property
    def drawn(self) -> dict[str, dict[str, int]]:
        """How often each pass was drawn so far, by side."""
        return {
            side: {
                name: count + self._draft[side].draws[name]
                for name, count in self._full[side].draws.items()
            }
            for side in SIDES
        }

    @property
    def compiled(self) -> int:
        """How many programs were compiled so far."""
        return self._programs.compiled

    def draw(
        self,
        state: State,
        arrangement: Arrangement,
        scale: float,
        pixel_pitch_m: float | None,
        *,
        moving: bool = False,
    ) -> DrawnPair:
        """Draw the pictures that the state asks for.

        scale: below 1 while something is dragged; the picture is then drawn that much smaller.
        moving: something is dragged, so that quality "auto" keeps to its choice.
        """
        size = _scaled(arrangement.size, scale)
        state = as_shown(state, size, _pitch(pixel_pitch_m, arrangement.size, size))
        state = self._edged(state, size, moving=moving)
        renderers = self._full if scale == 1.0 else self._draft
        for chooser in self._choosers.values():
            chooser.moving = moving
        pictures, faults = self._draw_sides(renderers, state, size, moving=moving)
        needed = _factor_of(state, pictures)
        factor = held_factor(needed, self._factor) if moving else needed
        if factor != self._factor:
            self._factor = factor
            pictures, faults = self._draw_sides(renderers, state, size, moving=moving)
        if _wants_difference(state) and len(pictures) == len(SIDES):
            first, second = (
                renderers[side].request(
                    state.scene(side),
                    state.side(side).look,
                    size,
                    pictures[side].frame.method,
                    self._factor,
                )
                for side in SIDES
            )
            try:
                draw_difference(
                    renderers["reference"],
                    renderers["test"],
                    (first, second),
                    state.presentation.difference_max,
                )
                name = renderers["test"].framebuffer_name(OVERLAY)
                pictures["test"] = SidePicture(name, size, pictures["test"].frame)
            except RelglossError as error:
                faults["test"] = str(error)
        return DrawnPair(pictures, faults, self._factor)

    def _draw_sides(
        self, renderers: dict[str, Renderer], state: State, size: Size, *, moving: bool
    ) -> tuple[dict[str, SidePicture], dict[str, str]]:
        """The pictures with the present factor; for another one only pass 2 is drawn again."""
        pictures: dict[str, SidePicture] = {}
        faults: dict[str, str] = {}
        for side in SIDES:  # the one that flip hides too: panels show its numbers
            if side in self.awaited:
                faults[side] = self.awaited[side]
                continue
            try:
                pictures[side] = self._draw_side(renderers[side], state, side, size)
            except RelglossError as error:
                faults[side] = str(error)
            if not (moving or _wants_difference(state)):
                # Before the other takes as much. Free pages go back at rest: that takes a while.
                self._freed_bytes += renderers[side].tidy()
        return pictures, faults

    def _edged(self, state: State, size: Size, *, moving: bool) -> State:
        """The state with silhouettes as sampled while the view moves.

        To find the pixels at the silhouette takes a third of a picture's time, once a view.
        """
        view = *(state.scene(side).shape for side in SIDES), state.setup.eye, size
        if moving and view != self._edged_view:
            return state.with_part("display", edges="sampled")
        self._edged_view = view
        return state

    def warm(self, state: State, more: Iterable[tuple[str, Material]] = ()) -> bool:
        """Compile what the sliders of a state can reach; returns whether anything was to do.

        more: sides, drawn whole, and materials that are about to be put there.
        """
        reachable: set[object] = set()
        missing: dict[tuple[object, Method], tuple[Scene, Look, Method]] = {}
        for side in SIDES:
            scene, look = state.scene(side), state.side(side).look
            wanted = [(scene, method) for method in self._reachable(side, look)]
            for material in (other for place, other in more if place == side):
                scene = Scene(material, state.setup)
                wanted += [(scene, method) for method in self._reachable(side, look)]
            for scene, method in wanted:
                variant = _variant(scene, look), method
                reachable.add(variant)
                if not self._programs.use(self._warmed.get(variant, NOT_WARMED)):
                    missing[variant] = scene, look, method
        if reachable != self._reached or self._programs.freed != self._freed:
            self._reached, self._freed = reachable, self._programs.freed
            self._tried.clear()
        for variant in missing:
            if variant in self._tried:  # where not all of them have room, this has an end
                continue
            self._warm.forget()  # or it would not ask for what it holds
            gone = contextlib.suppress(RelglossError)  # a file of the display
            with self._programs.noted() as asked, gone:
                self._warm.prepare(*missing[variant])
            self._warmed[variant] = asked
            self._tried.add(variant)
            self._freed = self._programs.freed
            return True
        if len(self._warmed) > MOST_WARMED:
            self._warmed.clear()
        return False

    def tidy(self) -> None:
        """Free what does not show and is drawn again where somebody asks; call it at rest.

        Those are the smaller pictures of a drag, and what numbers and overlays were made from.
        """
        freed = sum(renderer.tidy() for renderer in self._full.values())
        freed += sum(renderer.forget() for renderer in self._draft.values())
        if self._enlarged:
            self._enlarged = False
            freed += self._warm.forget()
        collect(self.ctx)
        self._freed_bytes += freed
        if self._freed_bytes > WORTH_GIVING_BACK:
            self._freed_bytes = 0
            give_back()

    def _reachable(self, side: str, look: Look) -> tuple[Method, ...]:
        """The methods that a drag can draw a side with: MethodChooser holds its choice."""
        if look.quality == "exact":
            return (EXACT,)
        if side == self.whole_side:
            return (WHOLE,)
        return tuple({WHOLE: None, self._methods.get(side, WHOLE): None})

    def render_at(self, state: State, side: str, size: Size) -> Frame:
        """A side's picture at any size; fetch its numbers before the next one is asked for."""
        self._enlarged = True
        if not _scales(state):
            return self._warm.render(state.scene(side), state.side(side).look, size)
        frames = (self._warm.render(state.scene(s), state.side(s).look, size) for s in SIDES)
        contrasts = [(frame.c, frame.c_max) for frame in frames]
        factor = common_factor(contrasts)
        return self._warm.render(state.scene(side), state.side(side).look, size, factor=factor)

    def render(self, scene: Scene, look: Look, size: Size, *, factor: float = 1.0) -> Frame:
        """Any scene at any size, apart from the window's pictures; see backends.FrameRenderer."""
        self._enlarged = True
        return self._warm.render(scene, look, size, factor=factor)

    def small(
        self, state: State, side: str, material: Material, size: Size, factor: float
    ) -> Frame:
        """A small picture of another material in a side's place, at its setting, drawn whole.

        Fetch its numbers before the next one is asked for.
        """
        look = state.side(side).look
        samples = max(look.samples or SMALL_SAMPLES, SMALL_SAMPLES)
        method = EXACT if look.quality == "exact" else WHOLE
        look = dataclasses.replace(look, samples=samples)
        return self._warm.render(Scene(material, state.setup), look, size, method, factor=factor)

    def with_uploads(
        self, pictures: dict[str, SidePicture], displayed: dict[str, Displayed]
    ) -> dict[str, SidePicture]:
        """The pictures, with those that were made in numpy in their sides' places."""
        return pictures | {
            side: dataclasses.replace(
                pictures[side], framebuffer=self.uploads.framebuffer(side, picture)
            )
            for side, picture in displayed.items()
        }

    def lost(self, is_texture: Callable[[int], bool]) -> bool:
        """Whether the device has refused something since this was last asked, or lost a texture.

        A deleted texture stays in its framebuffer: its picture shows, but can't be read.
        """
        if self.ctx.error != "GL_NO_ERROR":
            return True
        renderers = (*self._full.values(), *self._draft.values())
        names = [name for r in renderers for name in r.passes.targets.names()]
        return not all(is_texture(name) for name in (*names, *self.uploads.names()))

    def abandon(self) -> None:
        """Forget objects that may no longer be there."""
        with contextlib.suppress(Exception):  # whatever a lost object raises
            self.release()
        _ = self.ctx.error

    def release(self) -> None:
        """Free everything on the device."""
        for renderer in (*self._full.values(), *self._draft.values(), self._warm):
            renderer.release()
        self.uploads.release()
        self._programs.release()
        self._warmed.clear()
        self._tried.clear()

    def _draw_side(self, renderer: Renderer, state: State, side: str, size: Size) -> SidePicture:
        scene, look = state.scene(side), state.side(side).look
        frame = renderer.render(scene, look, size, factor=self._factor)
        self._methods[side] = frame.method
        overlay = state.presentation.overlay
        if overlay == "none" or state.presentation.haploscopic:
            return SidePicture(renderer.framebuffer_name(TONE), size, frame)
        draw_overlay(renderer, scene, look, size, overlay, frame.method)
        return SidePicture(renderer.framebuffer_name(OVERLAY), size, frame)


def _scales(state: State) -> bool:
    """Whether one factor scales both c: both are numbers, and highlights are not to clip."""
    absolute = all(state.side(side).look.c is not None for side in SIDES)
    return absolute and not state.presentation.clip_highlights


def _factor_of(state: State, pictures: dict[str, SidePicture]) -> float:
    """The common factor with which no picture clips."""
    if not _scales(state):
        return 1.0
    looks = {side: state.side(side).look for side in pictures}
    return common_factor(
        (look.c, pictures[side].frame.c_max) for side, look in looks.items() if look.c is not None
    )


def _variant(scene: Scene, look: Look) -> object:
    """What decides which programs a scene and a look can need."""
    tilted = dataclasses.replace(look, sigma_n_deg=1.0)
    sampled = eye_grain_samples(scene.display, tilted) > 1
    variant = Variant.of(as_drawn(scene, look), tilted)
    return variant, sampled, tuple(tone_defines(scene.display, "tone.frag").items())


def _wants_difference(state: State) -> bool:
    presentation = state.presentation
    return presentation.compare == DIFFERENCE and not presentation.haploscopic


def passes_since(
    before: dict[str, dict[str, int]], after: dict[str, dict[str, int]]
) -> list[DrawnPass]:
    """The passes that were drawn between two looks at PairRenderer.drawn."""
    return [
        DrawnPass(side, name)
        for side, counts in after.items()
        for name, count in counts.items()
        if count > before[side][name]
    ]


def _scaled(size: Size, scale: float) -> Size:
    return max(1, round(size[0] * scale)), max(1, round(size[1] * scale))


def _pitch(pixel_pitch_m: float | None, full: Size, drawn: Size) -> float | None:
    """Size of a drawn pixel on the monitor."""
    return pixel_pitch_m * full[1] / drawn[1] if pixel_pitch_m else None
