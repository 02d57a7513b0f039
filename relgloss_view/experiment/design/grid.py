"""The settings that observers judge: a grid of grain sigma_N and contrast gloss c.

The paper's (Ishii et al., "Reproducing Images with Various Glossiness"): sigma_N from 0 to 3
degrees by 0.5, c from c_max/6 to c_max by c_max/6.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass
from fractions import Fraction

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import number, refuse
from relgloss_view.picture.scene.setting import Setting

SIGMA_N_DEG = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0)
C_SIXTHS = (1, 2, 3, 4, 5, 6)
MOST_SETTINGS = 400  #: an observer's day has an end, and so has a fit of as many means


@dataclass(frozen=True)
class Grid:
    """All pairs of some sigma_N and some c, each ascending; c changes fastest."""

    sigma_n_deg: tuple[float, ...] = SIGMA_N_DEG
    c_fraction: tuple[float, ...] = tuple(k / 6 for k in C_SIXTHS)

    def __post_init__(self) -> None:
        for name, high in (("sigma_n_deg", 10.0), ("c_fraction", 10.0)):
            values = getattr(self, name)
            if not values:
                raise InputError(f"grid.{name}: expected at least one value, found none")
            checked = tuple(
                number(value, f"grid.{name}[{k}]", f"0 to {high:g}", 0.0, high)
                for k, value in enumerate(values)
            )
            for before, after in itertools.pairwise(checked):
                if after - before < 1e-6:
                    refuse(f"grid.{name}", "ascending values, none twice", list(checked))
            object.__setattr__(self, name, checked)
        if len(self) > MOST_SETTINGS:
            raise InputError(f"grid: expected at most {MOST_SETTINGS} settings, found {len(self)}")

    def __len__(self) -> int:
        return len(self.sigma_n_deg) * len(self.c_fraction)

    @property
    def shape(self) -> tuple[int, int]:
        """How many sigma_N, how many c."""
        return len(self.sigma_n_deg), len(self.c_fraction)

    @property
    def settings(self) -> tuple[Setting, ...]:
        """All of them, c changing fastest."""
        return tuple(Setting(s, c) for s in self.sigma_n_deg for c in self.c_fraction)


def share_of(value: object, place: str) -> float:
    """A share of c_max from a number or a text such as '5/6'; InputError otherwise."""
    expected = "a share of c_max, 0 to 10, such as 0.5 or '3/6'"
    if isinstance(value, str):
        if not re.fullmatch(
            r"[0-9]{1,6}(\.[0-9]{1,9})?|[0-9]{1,6}/0*[1-9][0-9]{0,5}", value.strip()
        ):
            refuse(place, expected, value)
        value = float(Fraction(value.strip()))
    return number(value, place, expected, 0.0, 10.0)
