"""Flow: one observer's way through a study, phase by phase. No window, no pictures.

The window and the simulated observers drive the same Flow: it decides what shows, takes
what the observer does, and stores every answer before the next phase. A program that was killed
starts a new Flow, which resumes at the same trial.
"""

from __future__ import annotations

import dataclasses
import enum
from collections.abc import Callable
from dataclasses import dataclass

from relgloss_view.experiment.design.study import ADAPTIVE
from relgloss_view.experiment.design.trial_order import Trial, planned_trials
from relgloss_view.experiment.session.adaptive_choice import AdaptiveChoice
from relgloss_view.experiment.session.records import Observer
from relgloss_view.experiment.session.store import Store

#: Sooner than this after a stimulus no answer can be one to it: simple reactions take longer
#: (Luce 1986: about 0.18 s to light), so it is a key that bounced or was held.
EARLIEST_S = 0.15


class Phase(enum.Enum):
    """The phases of a session, by what the observer sees."""

    CONSENT = "consent"
    INSTRUCTIONS = "instructions"
    OBJECT = "object"  #: the experimenter puts the sample's object beside the reference object
    ADAPTATION = "adaptation"
    GAP = "gap"
    TRIAL = "trial"
    PAUSE = "pause"
    FINISHED = "finished"
    DECLINED = "declined"


@dataclass(frozen=True)
class Progress:
    """How far an observer is; for the experimenter."""

    observer: str
    answered: int  #: trials with all their answers
    total: int  #: trials planned, or the most that an adaptive study takes
    sample: str  #: label of the present one
    question: str


class Flow:
    """The state of a session; `phase` is what shows, methods are what the observer does.

    Calls that do not fit the present phase change nothing and return False.
    """

    def __init__(
        self, store: Store, observer: Observer, run: int, clock: Callable[[], float]
    ) -> None:
        self.store, self.observer, self.run = store, observer, run
        self.study = store.study
        self._clock = clock
        self._adaptive = self.study.procedure.design == ADAPTIVE
        self._chooser = AdaptiveChoice(self.study)
        if not self._adaptive and not store.trials(observer):
            store.plan(observer, planned_trials(self.study, observer.number))
        self.trial: Trial | None = None
        self.question = self.study.questions[0]
        self._placed: int | None = None  #: the sample whose object is in place
        self._adapted = False
        self._until_s = 0.0
        self._shown_s: float | None = None
        self._behind: tuple[Trial | None] | None = None
        self._find_trial()
        if self.trial is None:
            self.phase = Phase.FINISHED
        else:
            self.phase = Phase.INSTRUCTIONS if observer.consented else Phase.CONSENT

    # --- what the observer and the experimenter do --------------------------------------------

    def confirm(self) -> bool:
        """Agree, have read, have placed the object, resume after a pause."""
        if self.phase is Phase.CONSENT:
            self.store.consent(self.observer)
            self.observer = dataclasses.replace(self.observer, consented=True)
            self.phase = Phase.INSTRUCTIONS
        elif self.phase is Phase.INSTRUCTIONS:
            self.phase = Phase.OBJECT
        elif self.phase is Phase.OBJECT:
            assert self.trial is not None
            self._placed = self.trial.sample
            self._adapt()
        elif self.phase is Phase.PAUSE:
            self.store.note(self.run, "resumed")
            self._adapt()
        else:
            return False
        return True

    def decline(self) -> bool:
        """Not agree: nothing is asked, and nothing but the refusal is kept."""
        if self.phase is not Phase.CONSENT:
            return False
        self.store.note(self.run, "declined")
        self.store.end(self.observer)  # now: who is killed here does not come back either
        self.phase = Phase.DECLINED
        return True

    def skip_adaptation(self) -> bool:
        """End the adaptation early; it is kept how early."""
        if self.phase is not Phase.ADAPTATION:
            return False
        self.store.note(self.run, "adaptation cut short", f"{self.left_s():.0f} s left")
        self._adapted = True
        self._wait()
        return True

    def answer(self, category: int) -> bool:
        """Judge the stimulus, 0 close upwards. It is on the disk when this returns True."""
        now_s = self._clock()
        if self.phase is not Phase.TRIAL or self._shown_s is None or self.trial is None:
            return False
        if self.behind:
            return False
        response_s = now_s - self._shown_s
        if response_s < EARLIEST_S or not 0 <= category < len(self.study.categories):
            return False
        self.store.answer(self.observer, self.trial, self.question, category, response_s, self.run)
        self._go_on(self.trial)
        return True

    def undo(self) -> bool:
        """Take the last answer back; its stimulus comes again."""
        if self.phase not in (Phase.TRIAL, Phase.GAP, Phase.OBJECT, Phase.FINISHED):
            return False
        if self.observer.ended or self.behind:
            return False
        if self.store.undo(self.observer, self.run, drop_unanswered=self._adaptive) is None:
            return False
        self._go_on(self.trial)
        return True

    def pause(self) -> bool:
        """Show nothing until confirm; the stimulus is shown anew after it."""
        if self.phase not in (Phase.TRIAL, Phase.GAP):
            return False
        self.store.note(self.run, "paused")
        self.phase = Phase.PAUSE
        return True

    # --- what the window reports --------------------------------------------------------------

    def tick(self) -> None:
        """Let time pass: end the adaptation and gaps, look again for a trial that was missing."""
        if self._behind is not None:
            self._go_on(*self._behind)
        if self.phase is Phase.ADAPTATION and self.left_s() <= 0.0:
            self.store.note(self.run, "adapted")
            self._adapted = True
            self._wait()
        if self.phase is Phase.GAP and self.left_s() <= 0.0:
            self._shown_s = None
            self.phase = Phase.TRIAL

    def shown(self) -> None:
        """The stimulus is on the screen: response times count from the first such call."""
        if self.phase is Phase.TRIAL and self._shown_s is None:
            self._shown_s = self._clock()

    def hidden(self) -> None:
        """Something else shows in its place: times count anew from the next shown()."""
        self._shown_s = None

    @property
    def behind(self) -> bool:
        """Whether an answer was kept or taken back, but what comes next could not be found yet."""
        return self._behind is not None

    def left_s(self) -> float:
        """Seconds until the adaptation or the gap ends."""
        return max(self._until_s - self._clock(), 0.0)

    def end(self) -> None:
        """The program ends; what was answered is kept anyway."""
        if self.phase is Phase.FINISHED and not self.observer.ended:
            self.store.end(self.observer)
        self.store.end_run(self.run)

    def progress(self) -> Progress:
        """How far the observer is."""
        sample = "" if self.trial is None else self.study.samples[self.trial.sample].label
        answered, total = trials_answered(self.store, self.observer)
        return Progress(self.observer.name, answered, total, sample, self.question)

    # --- the way -------------------------------------------------------------------------------

    def _go_on(self, before: Trial | None) -> None:
        """Find what comes next and show it. Where that fails, tick tries again."""
        self._behind = (before,)
        self._find_trial()
        self._behind = None
        self._after(before)

    def _find_trial(self) -> None:
        """The first trial with a question that has no answer; adaptive ones are chosen here."""
        open_trial = _first_open(self.store, self.observer)
        if open_trial is not None:
            self.trial, self.question = open_trial
            return
        self.trial, self.question = None, self.study.questions[0]
        if self._adaptive:
            chosen = self._chooser.next(self.observer.number, self.store.answers())
            if chosen is not None:
                self.store.plan(self.observer, [chosen])
                self.trial = chosen

    def _after(self, before: Trial | None) -> None:
        """The phase after an answer, or after one was taken back."""
        if self.trial is None:
            self.phase = Phase.FINISHED
        elif self.trial.sample != self._placed:
            self.phase = Phase.OBJECT
        elif before is not None and before.position == self.trial.position:
            self.phase, self._shown_s = Phase.TRIAL, None  # the next question about it
        else:
            self._wait()

    def _adapt(self) -> None:
        if self._adapted or self.study.procedure.adaptation_min == 0.0:
            self._wait()
            return
        self._until_s = self._clock() + 60.0 * self.study.procedure.adaptation_min
        self.phase = Phase.ADAPTATION

    def _wait(self) -> None:
        self._until_s = self._clock() + self.study.procedure.gap_s
        self.phase = Phase.GAP
        self.tick()


def trials_answered(store: Store, observer: Observer) -> tuple[int, int]:
    """How many trials have all their answers, and of how many; an adaptive study may take fewer."""
    study = store.study
    if study.procedure.design == ADAPTIVE:
        total = len(study.samples) * study.adaptive.trials
    else:
        total = len(store.trials(observer))
    return len(store.answers(observer)) // len(study.questions), total


def nothing_left(store: Store, observer: Observer) -> bool:
    """Whether an observer has answered, and all that is asked. Plans no trial."""
    if not store.answers(observer) or _first_open(store, observer) is not None:
        return False
    if store.study.procedure.design != ADAPTIVE:
        return True
    return AdaptiveChoice(store.study).next(observer.number, store.answers()) is None


def _first_open(store: Store, observer: Observer) -> tuple[Trial, str] | None:
    """The first planned trial with a question that has no answer, and that question."""
    answered = {(a.trial.position, a.question) for a in store.answers(observer)}
    for trial in store.trials(observer):
        for question in store.study.questions:
            if (trial.position, question) not in answered:
                return trial, question
    return None
