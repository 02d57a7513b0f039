"""Whether an observer can read a study: each of its texts against the fonts of this machine."""

from __future__ import annotations

from relgloss_view.base import fonts
from relgloss_view.experiment.design.study import Study


def warnings(study: Study) -> list[str]:
    """Lines for the operator, before the experiment begins; none where every letter can be drawn.

    Raises InputError where RELGLOSS_FONTS names a file that is no font.
    """
    return fonts.warnings(texts(study))


def texts(study: Study) -> dict[str, str]:
    """What an observer reads, by what it is."""
    named = {
        "the consent text": study.consent,
        "the instructions": study.guide,
        "the title": study.title,
        "the categories": " ".join(study.categories),
    }
    for k, sample in enumerate(study.samples, start=1):
        named[f"the label of sample {k}"] = sample.label
    return named
