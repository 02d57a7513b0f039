"""What there is to know of each observer: who answers at random is pointed out, never dropped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.experiment.design.study import RATIO
from relgloss_view.experiment.session.pool import Pool
from relgloss_view.experiment.verdict.agreement import Relation, relation_to_others

RELATED = 0.05  #: an observer whose answers are this likely by chance is pointed out
FEWEST_TO_TELL = 30  #: answers; from fewer a good observer can't be told from one by chance
QUICK_S = 0.4  #: a median response this short is pointed out


@dataclass(frozen=True)
class ObserverResult:
    """What there is to know of one observer."""

    name: str
    kind: str
    ended: bool
    answers: int
    median_response_s: float
    relation: Relation
    always_same: bool  #: whether every answer about the ratio is the same

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the reader is to be pointed at."""
        remarks = []
        if self.relation.correlation is None and self.answers > 2:
            remarks.append(
                "always the same answer" if self.always_same else "nobody to compare with"
            )
        elif self.answers < FEWEST_TO_TELL:
            remarks.append("too few answers to compare with chance")
        elif self.relation.p is not None and self.relation.p > RELATED:
            remarks.append(
                f"the answers may be by chance (p {self.relation.p:.2f}); they are left in"
            )
        if self.median_response_s < QUICK_S:
            remarks.append(f"answers within {self.median_response_s:.2f} s")
        if not self.ended:
            remarks.append("not finished")
        return tuple(remarks)


def observer_results(pool: Pool, seed: int) -> tuple[ObserverResult, ...]:
    """Everybody, with how their ratings follow those of the others over all samples."""
    settings = len(pool.study.grid)
    rows = [
        (number, answer.trial.sample * settings + answer.trial.setting, answer.category)
        for number, member in enumerate(pool.members)
        for answer in member.answers
        if answer.question == RATIO
    ]
    table = np.array(rows, dtype=np.int64).reshape(-1, 3)
    related = {
        r.observer: r for r in relation_to_others(table[:, 0], table[:, 1], table[:, 2], seed)
    }
    return tuple(
        ObserverResult(
            name=member.name,
            kind=member.kind,
            ended=member.ended,
            answers=len(member.answers),
            median_response_s=float(np.median([a.response_s for a in member.answers])),
            relation=related.get(number, Relation(number, None, None)),
            always_same=len({a.category for a in member.answers if a.question == RATIO}) == 1,
        )
        for number, member in enumerate(pool.members)
    )
