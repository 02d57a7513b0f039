"""The display in front of the observer: given, the system's, the study's, or assumed."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.display.record import SYSTEM, DisplayRecord
from relgloss_view.experiment.session.records import Observer
from relgloss_view.experiment.session.sitting import Sitting, choose_sitting, remarks
from relgloss_view.experiment.session.store import Store
from relgloss_view.viewer.shell.window import Window


@dataclass(frozen=True)
class SittingHere:
    """A sitting, the line that names its display, and what the experimenter has to know of it."""

    sitting: Sitting
    remarks: tuple[str, ...]

    @property
    def words(self) -> str:
        """For the terminal."""
        return f"pictures are drawn for {self.sitting.record.words}"


def sitting_here(
    store: Store, observer: Observer, given: str | None, of_system: str | None
) -> SittingHere:
    """The display that an observer's pictures are drawn for from now on. Raises InputError.

    given: the file of --display. of_system: the file of the system's profile; one that can't be
    used is passed over with a remark.
    """
    study = store.study
    before = store.answered_displays(observer)
    last_given = store.last_given_display()
    system, lines = _system_record(store, of_system)
    usable = of_system if system is not None else None
    sitting = choose_sitting(study, given, usable, before, last_given)
    lines += remarks(sitting, before, system)
    return SittingHere(sitting, tuple(lines))


def _system_record(store: Store, of_system: str | None) -> tuple[DisplayRecord | None, list[str]]:
    if of_system is None:
        return None, []
    try:
        return Sitting.of_file(store.study, of_system, SYSTEM).record, []
    except InputError as error:
        return None, [f"the system's own profile can't be used: {error}"]


def system_display(window: Window) -> str | None:
    """The file of the system's own profile of the monitor that a window is on; None: none known."""
    return None
