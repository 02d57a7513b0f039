"""The display in front of the observer: given, the system's, the study's, or assumed."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.display.kept_file import KeptFile
from relgloss_view.display.record import SYSTEM
from relgloss_view.display.system.watch import answer_once
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
    store: Store,
    observer: Observer,
    given: str | None,
    of_system: KeptFile | None = None,
    fault: str = "",
) -> SittingHere:
    """The display that an observer's pictures are drawn for from now on. Raises InputError.

    given: the file of --display. of_system: the system's profile; one that can't be used is passed
    over with a remark. fault: why the system's can't even be taken.
    """
    study = store.study
    before = store.answered_displays(observer)
    last_given = store.last_given_display()
    lines: list[str] = []
    system, file = None, None
    if of_system is not None:
        try:
            file = store.put(of_system)
            system = Sitting.of_file(study, file, SYSTEM).record
        except InputError as error:
            fault = str(error)
    lines += [f"the system's own profile can't be used: {fault}"] if fault else []
    usable = file if system is not None else None
    sitting = choose_sitting(study, given, usable, before, last_given)
    lines += remarks(sitting, before, system)
    return SittingHere(sitting, tuple(lines))


def system_display(window: Window) -> tuple[KeptFile | None, str]:
    """The system's own profile of the window's monitor, None without one.

    And why one that the system has can't be taken; "" otherwise.
    """
    if window.headless:
        return None, ""
    answer = answer_once(window.monitor_place(), window.system)
    if answer.profile is None:
        return None, answer.reason if answer.fault else ""
    return KeptFile(answer.profile.name, answer.profile.data), ""
