"""What the words of a report mean, a sentence each."""

from __future__ import annotations

from relgloss_view.experiment.verdict.analysis import JOINT, Analysis


def terms(analysis: Analysis) -> list[tuple[str, str]]:
    """Those that the report of this analysis uses."""
    adaptive = any(r.adaptive is not None for r in analysis.samples)
    both = any(JOINT in r.verdicts for r in analysis.samples)
    entries = [
        (
            "c, c_max, sigma_N",
            "c scales the gloss of the picture and is given as a share of the largest that the "
            "display can show, c_max; sigma_N is the grain: the standard deviation of the tilt of "
            "the surface normal, in degrees.",
        ),
        (
            "display",
            "Perceived gloss belongs to a display, and so does R, the ratio of gloss between two "
            "objects or their pictures: a screen with less luminance or a lighter black shows less "
            "gloss. These settings hold for the displays that are listed, and for displays like "
            "them.",
        ),
        (
            "closeness",
            "How close observers find a setting's ratio of gloss to that of the objects; larger is "
            "closer, 0 is the mean of all settings. The unit is the dispersion: the standard "
            "deviation of one judgment.",
        ),
        (
            "bound",
            "The closeness at which half of the answers fall into the closer of two categories.",
        ),
        (
            "probit, Torgerson",
            "Two estimates of the same scale. Probit: maximum likelihood of the ordinal probit "
            "model, which the verdicts follow. Torgerson: least squares under his condition D "
            "(settings and bounds all share one dispersion), as in the paper; settings that "
            "everybody put into the same end category are drawn in.",
        ),
        (
            "95 %",
            "Of what the results would be with other observers of the same kind: the observers are "
            "drawn again with replacement, whole sessions at a time.",
        ),
        (
            "leads",
            "The share of those resamplings in which a setting has the largest closeness.",
        ),
        (
            "not told apart, not significantly worse",
            "Settings that are not worse than the leading one at 95 %, over all comparisons "
            "together. The right one is nearly always among them; the leading one need not be it.",
        ),
        (
            "observers disagree",
            "The answers separate the observers into two groups, and the groups agree on no one "
            "setting. A scale over all observers then shows what neither group sees.",
        ),
        (
            "two places",
            "Two places of the grid are judged close, with worse settings between them.",
        ),
        (
            "answers alike",
            "Nearly all answers are the same, so that too few differ to be told from chance.",
        ),
        (
            "between grid points",
            "The optimum of a smooth fit to all answers: one right place in the grid, and "
            "a closeness that falls off from it. Nobody has judged that setting itself.",
        ),
        (
            "a curve is as good",
            "The ratio of gloss alone is one number, sigma_N and c are two: settings along a curve "
            "may have the same ratio. The grain, asked for too, separates them.",
        ),
        (
            "p of chance",
            "The probability of answers that differ as much between settings where no setting "
            f"differs; above {analysis.level:.2g} no setting is declared best.",
        ),
        (
            "alpha, W",
            "Agreement of the observers. Krippendorff's alpha: 1 is full agreement, 0 what chance "
            "gives. Kendall's W: 1 is the same order by everybody, 0 no agreement.",
        ),
        (
            "follows the others",
            "Spearman's correlation of an observer's answers with the mean of all others'.",
        ),
    ]
    if both:
        entries.append(
            (
                "by both together",
                "The sum of the closeness by the ratio of gloss and by the grain; it decides.",
            )
        )
    if adaptive:
        entries.append(
            (
                "posterior",
                "In an adaptive study: how probable it is, given all answers, that the right "
                "setting lies in a place. Verdict, estimate and their 95 % come from it; it takes "
                "all answers as those of one observer.",
            )
        )
    return entries
