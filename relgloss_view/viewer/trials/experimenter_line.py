"""What the experimenter reads: whose session it is, and its progress while Tab is held."""

from __future__ import annotations

import statistics
from collections.abc import Callable

from relgloss_view.base.reading import printable
from relgloss_view.experiment.session.flow import Flow, Phase, trials_answered
from relgloss_view.experiment.session.records import Observer
from relgloss_view.experiment.session.store import Store

FEWEST = 3  #: times between answers from which the time left is estimated
RECENT = 40  #: times that count: observers get faster

#: Phases in which the observer judges; the line names the others.
_JUDGING = (Phase.GAP, Phase.TRIAL)

Tell = Callable[[float, str], object]  #: share done, 0 to 1, and a line of text


def continues(store: Store, observer: Observer) -> str:
    """Whose session goes on, before somebody else answers in it; empty where one begins.

    One who has agreed but not answered goes on too: the next person has to be asked anew.
    """
    answered, total = trials_answered(store, observer)
    if not (answered or observer.consented):
        return ""
    return (
        f"{printable(observer.name)} continues: {answered} of {total} are judged. Somebody else? "
        "Close the window (Ctrl+Q) and start with --new."
    )


class ExperimenterLine:
    """How far the observer is, and how long it may still take."""

    def __init__(self, flow: Flow, clock: Callable[[], float], tell: Tell) -> None:
        self._flow, self._clock, self._tell = flow, clock, tell
        self._took_s: list[float] = []
        self._last_s: float | None = None
        self._text = ""
        self._named: Phase | None = None  #: the phase that the line names
        self.answered = 0  #: trials with all their answers
        self.total = 0
        self.refresh()

    @property
    def text(self) -> str:
        """The line, and what the experimenter can do now."""
        adapting = self._flow.phase is Phase.ADAPTATION
        return f"{self._text}; Ctrl+Enter ends the adaptation" if adapting else self._text

    def note_answer(self) -> None:
        """An answer was kept."""
        now_s = self._clock()
        if self._last_s is not None:
            self._took_s.append(now_s - self._last_s)
        self._last_s = now_s
        self.refresh()

    def note_break(self) -> None:
        """Something else than answering takes its time: a pause, the next object."""
        self._last_s = None

    def follow(self) -> None:
        """Report a phase that the line does not name yet. Raises InputError."""
        if self._named is not _of_note(self._flow.phase):
            self.refresh()

    def refresh(self) -> None:
        """Read how far the observer is and report it. Raises InputError."""
        at = self._flow.progress()
        self._named = _of_note(self._flow.phase)
        self.answered, self.total = at.answered, at.total
        parts = [f"{printable(at.observer)}: {at.answered} of {at.total}"]
        if self._named is not None:
            parts.append(self._named.value)
        if self._flow.trial is not None:
            parts += [printable(at.sample), at.question]
        minutes = self._minutes_left(at.total - at.answered)
        if minutes is not None:
            parts.append(f"about {minutes} min left")
        self._text = ", ".join(parts)
        self._tell(at.answered / max(at.total, 1), self._text)

    def _minutes_left(self, trials: int) -> int | None:
        """By the median of the times between answers: pauses for thought don't count for much."""
        if len(self._took_s) < FEWEST:
            return None
        questions = trials * len(self._flow.study.questions)
        return round(questions * statistics.median(self._took_s[-RECENT:]) / 60.0)


def _of_note(phase: Phase) -> Phase | None:
    return None if phase in _JUDGING else phase
