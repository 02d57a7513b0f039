"""How far two displays differ, and from where on their answers are not one study's.

Gloss belongs to a display: less luminance and less range lower it (Chen et al., SIGGRAPH Asia
2023). The limits are shares of what the paper's grid can separate: a step of c, c_max/6, moves
the highlight by 6.4 to 7.5 L* on the paper's three samples, and the smallest ratio between two
settings of c is 6/5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from relgloss_view.display.record import BLACK, WHITE, DisplayRecord
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000

#: Mean over the fixed colours, each relative to its own display's white: less than a third of a
#: step of c in L*.
MOST_MEAN_DE2000 = 2.0
#: Of luminances of white. CIECAM02 (Moroney et al. 2002) makes a white that is 1.25 times as
#: luminous 1.047 times as bright: a quarter of the smallest ratio between settings.
MOST_LUMINANCE_RATIO = 1.25
#: Of the L* of black, relative to white: less than a third of a step of c in L*.
MOST_BLACK_LSTAR = 2.0
SAME_DE2000 = 0.01  #: below this no digit of a record differs that means anything


@dataclass(frozen=True)
class DisplayDifference:
    """What differs between two displays; None where it is not known of both."""

    mean_de2000: float
    largest_de2000: float
    luminance_ratio: float | None  #: of the brighter white to the other, 1 or more
    black_lstar: float | None  #: from the darker black to the other, relative to white
    contrasts: tuple[float, float] | None  #: white over black, of the first and the second

    @property
    def same(self) -> bool:
        """Whether nothing differs."""
        return (
            self.largest_de2000 < SAME_DE2000
            and (self.luminance_ratio or 1.0) < 1.0 + 1e-4
            and (self.black_lstar or 0.0) < SAME_DE2000
        )

    @property
    def beyond(self) -> tuple[str, ...]:
        """What is beyond its limit, each with both numbers; empty where nothing is."""
        words = []
        if self.mean_de2000 > MOST_MEAN_DE2000:
            words.append(f"mean dE2000 {self.mean_de2000:.2g}, limit {MOST_MEAN_DE2000:g}")
        if (self.luminance_ratio or 1.0) > MOST_LUMINANCE_RATIO:
            words.append(
                f"ratio of white luminances {self.luminance_ratio:.3g}, "
                f"limit {MOST_LUMINANCE_RATIO:g}"
            )
        if (self.black_lstar or 0.0) > MOST_BLACK_LSTAR:
            words.append(
                f"black differs by {self.black_lstar:.2g} L*, limit {MOST_BLACK_LSTAR:g}"
                + ("" if self.contrasts is None else f" ({_contrast_words(self.contrasts)})")
            )
        return tuple(words)

    @property
    def words(self) -> str:
        """All of it, in one line."""
        parts = [f"mean dE2000 {self.mean_de2000:.2g}, largest {self.largest_de2000:.2g}"]
        if self.luminance_ratio is None:
            parts.append("white luminances not both known")
        else:
            parts.append(f"ratio of white luminances {self.luminance_ratio:.3g}")
        if self.black_lstar is None:
            parts.append("blacks not both known")
        else:
            parts.append(f"black differs by {self.black_lstar:.2g} L*")
        return ", ".join(parts)


def difference(first: DisplayRecord, second: DisplayRecord) -> DisplayDifference:
    """Compare two displays by what each emits for the same digital values."""
    a, b = _lab(first), _lab(second)
    apart = delta_e_2000(a, b)
    ratio = black = contrasts = None
    if first.luminance_known and second.luminance_known:
        ratio = first.luminance_cd_m2 / second.luminance_cd_m2
        ratio = max(ratio, 1.0 / ratio)
    if first.black_known and second.black_known:
        black = float(abs(a[BLACK, 0] - b[BLACK, 0]))
        dark = [record.table[BLACK, 1] for record in (first, second)]
        if min(dark) > 0.0:
            contrasts = (float(1.0 / dark[0]), float(1.0 / dark[1]))
    return DisplayDifference(float(np.mean(apart)), float(np.max(apart)), ratio, black, contrasts)


def _lab(record: DisplayRecord) -> np.ndarray:
    return lab_from_xyz(record.table, record.table[WHITE])


def _contrast_words(contrasts: tuple[float, float]) -> str:
    return " and ".join(f"{contrast:.3g}:1" for contrast in contrasts)
