"""Study: everything that is fixed before the first observer sits down, as one frozen value.

Which samples are judged against which reference picture, at which settings, how the pictures are
drawn, and how an observer is led through it. Read from TOML by study_file.py.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, choice, parameter, switch, whole_number
from relgloss_view.base.reading import printable, refuse, text
from relgloss_view.display.display import Display
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.picture.model.view import check_size
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Setup

CATEGORIES = ("close", "slightly close", "fair", "slightly far", "far")  #: Ishii et al.
MOST_CATEGORIES = 9  #: one digit key each
LONGEST_CATEGORY, LONGEST_LABEL, LONGEST_TEXT = 40, 60, 8000  #: characters
MOST_SAMPLES = 24
FULL, ADAPTIVE = "full", "adaptive"
DESIGNS = (FULL, ADAPTIVE)
ORDERS = ("balanced", "random")
ON_DEMAND, ALWAYS, NEVER = "on demand", "always", "never"
STRIP_TIMES = (ON_DEMAND, ALWAYS, NEVER)
RATIO, GRAIN = "ratio", "grain"  #: the questions
QUESTIONS = {
    RATIO: "How close is the ratio of gloss between the pictures to that between the objects?",
    GRAIN: "How close is the grain of the picture to the grain of the object?",
}
CONSENT = (
    "You are about to judge pictures of printed papers. It takes as long as the operator has told "
    "you. You may stop at any time, without giving a reason. What is kept is a number for you, "
    "your answers and how long they took; nothing else about you."
)
#: Filled in with the study's own categories.
INSTRUCTIONS = (
    "Two objects stand before one eye, and two pictures before the other. The glossier object is "
    "the reference; its picture stands in the same place of every pair.\n\n"
    "See how many times glossier the reference object is than the object beside it. Then see the "
    "same for the two pictures. How close are these two ratios? Answer with the keys 1 ({first}) "
    "to {count} ({last}), or with the mouse. Backspace takes the last answer back, P makes a pause."
)
ASKED_OF_GRAIN = (
    "\n\nAfter each ratio you are asked how close the grain of the picture is to that of the "
    "object. Answer in the same way."
)


@dataclass(frozen=True)
class StudySample:
    """A sample that is judged; its label names it, unique in the study.

    digest: of a pack; of a material nothing. lost: why a pack can't be drawn again, where its files
    changed after the study was begun or are gone; the sample then has the base finish's material.
    """

    label: str
    sample: Sample
    digest: str = ""
    lost: str = ""


@dataclass(frozen=True)
class Procedure(Checked):
    """How observers are led through a study."""

    adaptation_min: float = parameter(
        10.0, 0.0, 120.0, "min", "in which an observer gets used to haploscopic vision"
    )
    gap_s: float = parameter(0.5, 0.0, 60.0, "s", "of surround alone between two trials")
    repeats: int = whole_number(1, 1, 20, "", "how often an observer sees each stimulus")
    order: str = choice("balanced", ORDERS, "of stimuli and samples, over observers or by chance")
    design: str = choice(FULL, DESIGNS, "every setting of the grid, or those that tell most")
    ask_grain: bool = switch(False, "whether the match of grain is asked for after each ratio")
    seed: int = whole_number(0, 0, 2**31 - 1, "", "of the order, and of adaptive choices")


@dataclass(frozen=True)
class Adaptive(Checked):
    """When an adaptive study has asked enough about a sample."""

    trials: int = whole_number(8, 1, 1000, "", "that an observer sees of a sample, at most")
    interval_steps: float = parameter(
        0.5, 0.01, 100.0, "steps", "of the grid: stops when both 95 % intervals are this narrow"
    )


@dataclass(frozen=True)
class Screen(Checked):
    """How the two pictures stand on the screen."""

    width_px: int = whole_number(512, 16, 8192, "px", "of each picture")
    height_px: int = whole_number(512, 16, 8192, "px", "of each picture")
    gap_px: float = parameter(24.0, 0.0, 2000.0, "px", "between the two pictures")
    mirror: bool = switch(False, "swap and mirror the pictures, for a mirror before the monitor")
    scale: str = choice(
        ON_DEMAND, STRIP_TIMES, "when the categories show below the pictures: as the mouse moves"
    )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of each picture, pixels."""
        return self.width_px, self.height_px


@dataclass(frozen=True)
class Study:
    """A subjective evaluation by relative gloss (Ishii et al., steps 1 to 6)."""

    samples: tuple[StudySample, ...]
    reference: Sample
    reference_look: Look = Look(c_fraction=1.0)
    title: str = "Relative gloss"
    grid: Grid = Grid()
    categories: tuple[str, ...] = CATEGORIES
    consent: str = CONSENT
    instructions: str | None = None  #: None: what `guide` says by itself
    procedure: Procedure = Procedure()
    adaptive: Adaptive = Adaptive()
    screen: Screen = Screen()
    setup: Setup = Setup()
    look: Look = Look()  #: of the test pictures; its sigma_N and c are the grid's

    def __post_init__(self) -> None:
        _check_text(self.title, "title", LONGEST_LABEL)
        _check_text(self.consent, "consent", LONGEST_TEXT, empty=True)
        if self.instructions is not None:
            _check_text(self.instructions, "instructions", LONGEST_TEXT, empty=True)
        _check_categories(self.categories)
        check_size(self.screen.size)
        if not self.samples:
            raise InputError("samples: expected at least one sample to judge, found none")
        if len(self.samples) > MOST_SAMPLES:
            refuse("samples", f"at most {MOST_SAMPLES} samples", len(self.samples))
        labels = [sample.label for sample in self.samples]
        for k, label in enumerate(labels):
            _check_text(label, f"samples[{k}].label", LONGEST_LABEL)
            if label in labels[:k]:
                raise InputError(
                    f"samples[{k}].label: {label!r} is another sample's; give each its own label"
                )
        # All of them can be drawn: a fault shows before an observer does.
        for setting in (self.grid.settings[0], self.grid.settings[-1]):
            self.look.at(setting)

    @property
    def guide(self) -> str:
        """The instructions that an observer reads; empty where the study says so."""
        if self.instructions is not None:
            return self.instructions
        first, last = self.categories[0], self.categories[-1]
        text = INSTRUCTIONS.format(first=first, last=last, count=len(self.categories))
        return text + (ASKED_OF_GRAIN if self.procedure.ask_grain else "")

    @property
    def questions(self) -> tuple[str, ...]:
        """What is asked about each stimulus, in this order."""
        return (RATIO, GRAIN) if self.procedure.ask_grain else (RATIO,)

    def scene(self, sample: int) -> Scene:
        """What the test pictures of a sample show; InputError where that can't be drawn again."""
        _check_kept(self.samples[sample])
        return self._scene(self.samples[sample].sample)

    def check_drawn_again(self) -> None:
        """InputError where a sample can't be drawn as it was when the study began."""
        for sample in self.samples:
            _check_kept(sample)

    def reference_scene(self) -> Scene:
        """What the reference picture shows."""
        return self._scene(self.reference)

    def test_look(self, setting: Setting) -> Look:
        """How a test picture is to look."""
        return self.look.at(setting)

    def _scene(self, sample: Sample) -> Scene:
        return sample.scene(self.setup)

    def shown_on(self, display: Display) -> Study:
        """The study with its pictures drawn for another display."""
        return dataclasses.replace(self, setup=dataclasses.replace(self.setup, display=display))

    def with_procedure(self, **changes: object) -> Study:
        """The study with entries of its procedure changed."""
        procedure = dataclasses.replace(self.procedure, **changes)  # type: ignore[arg-type]
        return dataclasses.replace(self, procedure=procedure)


def _check_kept(sample: StudySample) -> None:
    if sample.lost:
        raise InputError(f"sample {printable(sample.label, 60)!r}: {sample.lost}")


def _check_text(value: object, place: str, limit: int, *, empty: bool = False) -> None:
    written = text(value, place)
    if len(written) > limit or not (empty or written.strip()):
        refuse(place, f"a text of {0 if empty else 1} to {limit} characters", written)


def _check_categories(categories: tuple[str, ...]) -> None:
    if not 2 <= len(categories) <= MOST_CATEGORIES:
        refuse("categories", f"2 to {MOST_CATEGORIES} names, from close to far", list(categories))
    for k, name in enumerate(categories):
        _check_text(name, f"categories[{k}]", LONGEST_CATEGORY)
        if name in categories[:k]:
            raise InputError(f"categories[{k}]: {name!r} is there twice; give each its own name")
