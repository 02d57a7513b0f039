"""A new material from readings, on a side of the window: it follows what is typed, and ends as one
step of undo or as none. No ImGui, no OpenGL.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.fitting.estimate.estimate import Estimate
from relgloss_view.material.material import Diffuse, Lobe, Material
from relgloss_view.material.recolour import colour_of
from relgloss_view.material.reflectance import CHROMA_MAX, LAB_LIGHTEST
from relgloss_view.measure.bands import RGB
from relgloss_view.measure.spectrum import ColourReading
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.viewer.files.background import Outcome, Worker
from relgloss_view.viewer.files.own_materials import keep_material
from relgloss_view.viewer.state import matching
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.readings_typed import ReadingsTyped, SpectrumRead
from relgloss_view.viewer.state.state import SIDES, Side, State

NAME = "new material"
#: One for each number of lobes that an estimate can have: what the shaders need to be ready for.
PROTOTYPES = tuple(
    Material(
        "", "", RGB, Diffuse("lambert", (0.5,) * 3), (Lobe((1.0,), 3.0), Lobe((0.1,), 9.0))[:n]
    )
    for n in (1, 2)
)
LONGEST_FAULT = 300  #: characters


class NewMaterial:
    """The readings of a material that is being made, its estimate, and its place in the pair.

    `each_frame` computes in a thread, the newest readings first, and puts the estimate on the side.
    Until `keep` or `cancel` the former sample can be brought back.
    """

    def __init__(self, model: Model, wake: Callable[[], None]) -> None:
        self.model = model
        self._wake = wake
        self.active = False
        self.side = "test"
        self.finish = ""  #: of the side's pack, whose material it is; empty for a sample
        self.name = NAME
        self.typed = ReadingsTyped()
        self.estimate: Estimate | None = None  #: the last good one
        self._fault = self._spectrum_fault = ""
        self.spectrum_file = self.spectrum_part = ""  #: that was chosen, read or not
        self._worker: Worker[ReadingsTyped, Estimate] = Worker(wake)
        self._reader: Worker[tuple[str, str], ColourReading] = Worker(wake)
        self._to_read: tuple[str, str] | None = None
        self._asked: ReadingsTyped | None = None  #: what the last estimate was or is computed from
        self._of: ReadingsTyped | None = None  #: what the last estimate fits
        self._placed: Sample | None = None  #: on the side, by this
        self._base: State | None = None  #: the state into which it was put
        self._made: State | None = None  #: the state that came of it
        self._former: Side | None = None  #: the side before
        self._kept_look = False  #: whether sliders have changed its look since
        self._steps = 0  #: of undo that this has made

    # --- what a panel does --------------------------------------------------------------------

    def begin(self, side: str) -> None:
        """Begin with empty readings and the colour of the side's sample."""
        if self.active:
            return
        self.active, self.name = True, NAME
        self._forget()
        self.estimate = self._of = self._asked = None
        self._fault = self._spectrum_fault = ""
        self.spectrum_file = self.spectrum_part = ""
        self._to_read = None
        self.side = side
        self.typed = ReadingsTyped(lab=_lab_of(self._choose(side)))

    def put_on(self, side: str) -> None:
        """Choose the side; the other one gets its former sample back."""
        if side == self.side:
            return
        self._restore()
        self.side = side
        present = self._choose(side)
        if self.estimate is not None:
            self._place(self.estimate)
        elif not any(self.typed.gloss):
            self.typed = dataclasses.replace(self.typed, lab=_lab_of(present))

    def _choose(self, side: str) -> Material:
        """Take the side's sample, or of a pack its active finish; returns the present material."""
        finish = self.model.active_finish(side)
        self.finish = "" if finish is None else finish.name
        return self.model.sample(side).material

    def rename(self, name: str) -> None:
        """Give it another name."""
        self.name = name
        if self.estimate is not None and self._is_there():
            self._place(self.estimate)

    def read_spectrum(self, file: str, part: str = "") -> None:
        """Take the colour from a file, which is read in a thread."""
        self.spectrum_file, self.spectrum_part = file, part
        self._spectrum_fault = ""
        self._to_read = (file, part)

    def without_spectrum(self) -> None:
        """Take the colour from the Lab fields again."""
        self.spectrum_file = self.spectrum_part = ""
        self._to_read, self._spectrum_fault = None, ""
        self.typed = dataclasses.replace(self.typed, spectrum=None)

    def cancel(self) -> None:
        """Bring the former sample back and end."""
        self._restore()
        self.active = False

    def keep(self, folder: Path) -> Path:
        """Write the material to a file of its own and end; InputError where it can't be written."""
        if not self.complete or self.estimate is None:
            raise InputError("the readings have no estimate yet")
        file = keep_material(self._named(self.estimate), folder)
        if not self._is_there():  # undone meanwhile
            self._place(self.estimate)
        self._put(Sample.from_file(str(file)))
        self.active = False
        self._forget()
        return file

    @property
    def fault(self) -> str:
        """What is wrong with what is typed or with the file, in one line; empty for nothing."""
        return self._spectrum_fault or self._fault

    @property
    def complete(self) -> bool:
        """Whether the last estimate is that of what is typed."""
        return self.estimate is not None and not self.fault and self._of == self.typed

    @property
    def waiting(self) -> bool:
        """Whether something is under way."""
        return self.active and (self._worker.busy or self._reader.busy)

    @property
    def ghosts(self) -> dict[str, Material]:
        """The dullest and the glossiest material, while they belong to the sample on the side.

        None of a finish: its highlight lies on the form of the pack, and among others.
        """
        if not self.active or self.estimate is None or self.finish or not self._is_there():
            return {}
        return {"dullest": self.estimate.dullest, "glossiest": self.estimate.glossiest}

    @property
    def about_to_show(self) -> tuple[tuple[str, Material], ...]:
        """Sides and materials for which shaders have to be ready before anything is typed."""
        of_sample = self.active and not self.finish
        return tuple((self.side, one) for one in PROTOTYPES) if of_sample else ()

    # --- in every frame -----------------------------------------------------------------------

    def each_frame(self) -> None:
        """Take what was computed, and begin with the newest of what is asked for."""
        outcome = self._worker.take()
        read = self._reader.take()
        if not self.active:
            return
        self._follow()
        if read is not None:
            self._take_spectrum(read)
        if self._to_read is not None and not self._reader.busy:
            self._read(*self._to_read)
        if outcome is not None and any(self.typed.gloss):
            self._take(outcome)
        if self._worker.busy or self.typed == self._asked:
            return
        self._asked = typed = self.typed
        if not any(text.strip() for text in typed.gloss):
            self._fault = ""
        else:
            self._worker.start(typed, typed.estimate)

    # --- how ----------------------------------------------------------------------------------

    def _read(self, file: str, part: str) -> None:
        self._to_read = None

        def read() -> ColourReading:
            from relgloss_view.measure.readers.spectrum import read_spectrum

            return read_spectrum(file, part=part or None)

        self._reader.start((file, part), read)

    def _take_spectrum(self, outcome: Outcome[tuple[str, str], ColourReading]) -> None:
        if outcome.key != (self.spectrum_file, self.spectrum_part):
            return  # another one was chosen meanwhile
        if outcome.value is None:
            self._spectrum_fault = _in_the_window(outcome.fault)
            return
        reading = outcome.value
        self.typed = dataclasses.replace(
            self.typed,
            spectrum=SpectrumRead(*outcome.key, reading),
            geometry=reading.geometry or self.typed.geometry,
        )

    def _take(self, outcome: Outcome[ReadingsTyped, Estimate]) -> None:
        if outcome.value is None:
            self._fault = printable(outcome.fault, LONGEST_FAULT)
            return
        self.estimate, self._of, self._fault = outcome.value, outcome.key, ""
        self._place(outcome.value)

    def _place(self, estimate: Estimate) -> None:
        self._put(Sample(self._named(estimate)))

    def _named(self, estimate: Estimate) -> Material:
        return dataclasses.replace(estimate.material, name=self.name.strip() or NAME)

    def _is_there(self) -> bool:
        """Whether the side has the sample that this has put there."""
        return self._placed is not None and self._has(self.side, self._placed)

    def _has(self, side: str, placed: Sample) -> bool:
        sample = self.model.state.side(side).sample
        if sample.pack is None:
            return sample is placed
        return any(
            one.name == self.finish and one.material is placed.material
            for one in sample.pack.finishes
        )

    def _with(self, state: State, sample: Sample) -> State:
        """The state with a sample on the side, or its material in the finish."""
        pack = state.side(self.side).sample.pack
        if self.finish and pack is not None and self.finish in [f.name for f in pack.finishes]:
            return matching.with_finish_sample(state, self.side, self.finish, sample)
        return matching.with_sample(state, self.side, sample, keep=self._kept_look)

    def _put(self, sample: Sample) -> None:
        """Put a sample on the side: as one step of undo, however often it is called."""
        model, history = self.model, self.model.history
        untouched = self._made is not None and model.state == self._made and not history.can_redo
        if untouched and self._base is not None:
            # From the same state each time, so that it is all the same in what order one types.
            history.amend(self._with(self._base, sample))
        else:
            self._kept_look = self._is_there()
            self._base = model.state
            if not self._kept_look:
                self._former, self._steps = model.state.side(self.side), 0
            model.change(self._with(model.state, sample))
            self._steps += 1
        self._placed, self._made = sample, model.state
        self._wake()

    def _follow(self) -> None:
        """Go with the sample to the other side, where the sides were swapped."""
        other = SIDES[1 - SIDES.index(self.side)]
        placed = self._placed
        if placed is not None and not self._is_there() and self._has(other, placed):
            self.side = other

    def _restore(self) -> None:
        """Bring the former sample and its look back, where this has put another in their place."""
        if self._former is not None and self._is_there():
            state, history = self.model.state, self.model.history
            if self._steps == 1 and state == self._made and history.can_undo:
                history.undo()
            else:  # other settings, which stay, were changed meanwhile
                share = matching.share_of_match(state, "test")
                former: dict[str, Any] = {self.side: self._former}
                restored = dataclasses.replace(state, **former)
                self.model.change(matching.rematched(restored, 1.0 if share is None else share))
        self._forget()

    def _forget(self) -> None:
        self._placed = self._base = self._made = self._former = None
        self._kept_look, self._steps = False, 0


def _lab_of(material: Material) -> tuple[float, float, float]:
    """The colour of a material, with the digits of its fields."""
    lightness, a, b = (round(float(value), 1) + 0.0 for value in colour_of(material))
    return (
        min(max(lightness, 0.0), LAB_LIGHTEST),
        min(max(a, -CHROMA_MAX), CHROMA_MAX),
        min(max(b, -CHROMA_MAX), CHROMA_MAX),
    )


def _in_the_window(fault: str) -> str:
    """A message about a file, without the options of the command line."""
    for option, word in ((" with --part", ""), ("--part", "its name"), ("--lab", "Lab")):
        fault = fault.replace(option, word)
    return printable(fault, LONGEST_FAULT)
