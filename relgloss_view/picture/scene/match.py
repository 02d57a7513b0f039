"""Match: the contrast gloss of a reference and a test picture that keeps their ratio of gloss.

In lightness the highlight of a picture is c times that of the sample (Ishii et al., eq. 2). So what
a pair of pictures keeps in every view is the ratio of their c; the c_max of a view limits what can
be displayed, and is no unit of settings.
"""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.parameters import Checked, choice, parameter

MOST_C = 1e4  #: as of Look.c
#: Who found it: `relgloss match` and all that draws matched, an experiment, the paper's observers,
#: or a hand on the sliders.
MAKERS = ("match", "experiment", "paper", "hand")


@dataclass(frozen=True)
class Match(Checked):
    """Settings of a pair of pictures with the right ratio of gloss, and how they were found.

    reference_c, test_c: contrast gloss of the two pictures, 0 to 10,000.
    reference_sigma_n_deg, test_sigma_n_deg: their graininess, degrees, 0 to 10.
    gloss: the reading of the materials whose ratio is kept, such as 'gloss-75'.
    spread: the ratio of c at the pose with the largest to that with the smallest, 1 to 1,000,000; 1
    where one pose was looked at.
    made_by: one of MAKERS. Raises InputError where a value is out of its range.

    >>> Match(0.14, 0.38).ratio
    2.714285714285714
    """

    reference_c: float = parameter(1.0, 0.0, MOST_C, "", "contrast gloss of the reference picture")
    test_c: float = parameter(1.0, 0.0, MOST_C, "", "contrast gloss of the test picture")
    reference_sigma_n_deg: float = parameter(
        0.0, 0.0, 10.0, "deg", "graininess of the reference picture"
    )
    test_sigma_n_deg: float = parameter(0.0, 0.0, 10.0, "deg", "graininess of the test picture")
    gloss: str = choice(
        "gloss-75",
        ("gloss-20", "gloss-60", "gloss-75", "gloss-85", "contrast-gloss"),
        "the gloss of the materials whose ratio is kept",
    )
    spread: float = parameter(
        1.0, 1.0, 1e6, "", "largest over smallest c that the poses propose by themselves"
    )
    made_by: str = choice("match", MAKERS, "who found the settings")

    @property
    def ratio(self) -> float:
        """c of the test picture over that of the reference: what every view keeps."""
        return self.test_c / self.reference_c if self.reference_c > 0.0 else 0.0
