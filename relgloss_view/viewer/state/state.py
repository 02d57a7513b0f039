"""State: everything that a user sets in the window, as one frozen value.

Undo, the session file and the decision what to draw again all work on it. No OpenGL, no window.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.parameters import Checked, choice, file_name, parameter, switch
from relgloss_view.display.display import Display
from relgloss_view.gloss.match import DEFAULT_REFERENCE, Reference, matched, own_sigma_n_deg
from relgloss_view.operators.registry import DEFAULT_OPERATOR, OPERATORS
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.model.lamp_placement import lit_for_gloss
from relgloss_view.picture.scene.look import Look, viewed_look
from relgloss_view.picture.scene.match import Match
from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE, Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Eye, Lamp, Setup
from relgloss_view.proof.settings import SIDES as SIDES

SIDE_BY_SIDE, WIPE, FLIP, DIFFERENCE = "side by side", "wipe", "flip", "difference"
COMPARE_MODES = (SIDE_BY_SIDE, WIPE, FLIP, DIFFERENCE)
OVERLAYS = ("none", *constants.OVERLAYS)
THIS_MONITOR, AS_DECLARED = "this monitor", "as the scene declares"
SCREENS = (THIS_MONITOR, AS_DECLARED)


@dataclass(frozen=True)
class Presentation(Checked):
    """How the two pictures are displayed; nothing of it changes the light in them."""

    compare: str = choice(
        SIDE_BY_SIDE, COMPARE_MODES, "how the two pictures are laid out", label="Comparison"
    )
    overlay: str = choice(
        "none", OVERLAYS, "information over the picture, or in its place", label="Overlay"
    )
    wipe: float = parameter(
        0.5,
        0.0,
        1.0,
        "",
        "share of the width that shows the reference",
        label="Position of the wipe",
    )
    flipped: bool = switch(
        False, "whether flip shows the test picture", label="Show the other picture"
    )
    difference_max: float = parameter(
        10.0,
        0.5,
        100.0,
        "dE2000",
        "the largest colour difference that the difference map shows",
        label="Difference scale (dE2000)",
    )
    haploscopic: bool = switch(
        False, "only the two pictures on a neutral surround, no text", label="Haploscopic"
    )
    mirror: bool = switch(False, "swap the pictures left and right and mirror each", label="Mirror")
    gap_px: float = parameter(
        24.0, 0.0, 2000.0, "px", "distance between the two pictures", label="Gap between pictures"
    )
    clip_highlights: bool = switch(
        False,
        "each picture keeps its own c, and highlights clip; else both are scaled alike",
        label="Let highlights clip",
    )
    life_size: bool = switch(
        False, "show the object at its physical size on this monitor", label="Life size"
    )
    reference_operator: str = choice(
        DEFAULT_OPERATOR, tuple(OPERATORS), "the reference's tones", label="Tone mapping (operator)"
    )
    test_operator: str = choice(
        DEFAULT_OPERATOR,
        tuple(OPERATORS),
        "the test picture's tones",
        label="Tone mapping (operator)",
    )
    screen: str = choice(
        THIS_MONITOR,
        SCREENS,
        "this monitor: by the profile that the system has for it, where there is one; as the scene "
        "declares: by the scene's own display, which files and copied commands always have",
        label="Show for",
        later=True,
    )
    reference_seen_on: str = file_name(
        "",
        "another display, whose picture of the reference is shown here: an ICC profile or a "
        "display file",
        label="Reference seen on",
    )
    test_seen_on: str = file_name(
        "",
        "another display, whose picture of the test is shown here: an ICC profile or a display "
        "file",
        label="Test seen on",
    )

    def seen_on(self, side: str) -> str:
        """The file of the display whose picture a side shows; "" for this one's."""
        file: str = getattr(self, f"{side}_seen_on")
        return file

    def operator(self, side: str) -> str:
        """The tone-mapping operator of a side, one of SIDES."""
        name: str = getattr(self, f"{side}_operator")
        return name


@dataclass(frozen=True)
class Side:
    """One of the two pictures: a sample and how it is to look."""

    sample: Sample
    look: Look


@dataclass(frozen=True)
class State:
    """Two sides under one lamp, seen by one eye."""

    reference: Side
    test: Side
    setup: Setup = Setup()
    presentation: Presentation = Presentation()
    match: Match | None = None  #: the unit of both c; None until there is one

    @classmethod
    def initial(cls) -> State:
        """The paper's reference beside the default sample, matched to it at its own graininess.

        Silhouettes are smooth and 8 bits dithered (Display.for_the_eye).

        The window draws what the scene needs, quality "auto"; files are drawn exactly by default.
        """
        reference = Reference.default()
        test = Sample.built_in(DEFAULT_SAMPLE)
        match = matched(reference, test.material, own_sigma_n_deg(test.name))
        look = viewed_look(quality="auto")
        return cls(
            Side(
                Sample.built_in(DEFAULT_REFERENCE),
                look.at(Setting(match.reference_sigma_n_deg, c=match.reference_c)),
            ),
            Side(test, look.at(Setting(match.test_sigma_n_deg, c=match.test_c))),
            Setup(display=Display().for_the_eye()),
            match=match,
        )

    def side(self, name: str) -> Side:
        """A side by its name, one of SIDES."""
        side: Side = getattr(self, name)
        return side

    def scene(self, name: str) -> Scene:
        """What a side's renderer draws, on the display that this side is seen on."""
        setup, seen_on = self.setup, self.presentation.seen_on(name)
        if seen_on != setup.display.seen_on:
            setup = setup.with_entries("display", seen_on=seen_on)
        return self.side(name).sample.scene(setup)

    def part(self, name: str) -> Shape | Lamp | Eye | Display | Presentation:
        """One part of the state: shape, lamp, eye, display or presentation."""
        owner = self if name == "presentation" else self.setup
        part: Shape | Lamp | Eye | Display | Presentation = getattr(owner, name)
        return part

    def with_part(self, name: str, **entries: Any) -> State:
        """The state with entries of one part changed: shape, lamp, eye, display, presentation."""
        if name == "presentation":
            changed = dataclasses.replace(self.presentation, **entries)
            return dataclasses.replace(self, presentation=changed)
        return dataclasses.replace(self, setup=self.setup.with_entries(name, **entries))

    def placed(self, **parts: Shape | Lamp | Eye | Display) -> State:
        """The state with whole parts of the setup replaced, as in `placed(eye=Eye())`."""
        return dataclasses.replace(self, setup=self.setup.placed(**parts))

    def lit_for_gloss(self) -> State:
        """The state whose lamp is turned so that a highlight is seen (model.lamp_placement).

        On flat forms that are seen straight on, the eye turns too.
        """
        lit = lit_for_gloss(self.scene("test").setup)  # of the test picture's form
        return self.placed(lamp=lit.lamp, eye=lit.eye)

    def with_look(self, name: str, **changes: Any) -> State:
        """The state with entries of a side's look changed."""
        side = self.side(name)
        look = dataclasses.replace(side.look, **changes)
        return self._with_side(name, dataclasses.replace(side, look=look))

    def with_setting(self, name: str, setting: Setting) -> State:
        """The state with another sigma_N and c on a side."""
        side = self.side(name)
        return self._with_side(name, dataclasses.replace(side, look=side.look.at(setting)))

    def with_sample(self, name: str, sample: Sample) -> State:
        """The state with another sample on a side; its look stays."""
        return self._with_side(name, dataclasses.replace(self.side(name), sample=sample))

    def _with_side(self, name: str, side: Side) -> State:
        changed: dict[str, Any] = {name: side}
        return dataclasses.replace(self, **changed)
