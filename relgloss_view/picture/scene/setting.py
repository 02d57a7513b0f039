"""Setting: the graininess sigma_N and the contrast gloss c, which people judge.

The one way to state c: a value, or a share of c_max, the most that the display shows in a picture
(Ishii et al., eq. 4). Without either, the share is 1.
"""

from __future__ import annotations

from dataclasses import dataclass

FULL_SHARE = 1.0  #: c = c_max


@dataclass(frozen=True)
class Setting:
    """sigma_N and c of a picture.

    sigma_n_deg: standard deviation of the normal's tilt, degrees, 0 to 10.
    c_fraction: c as a share of the picture's own c_max, 0 to 10.
    c: the factor of L_s* itself, 0 to 10,000; None uses the share.

    The settings that the paper's observers chose are in SAMPLES. Source: Ishii et al., eqs. 2 to 4.

    >>> Setting(2.0, 2 / 6).words
    '2 deg, 2/6 c_max'
    >>> Setting(c=0.4).words
    '0 deg, c 0.4'
    """

    sigma_n_deg: float = 0.0
    c_fraction: float = FULL_SHARE
    c: float | None = None

    def scaling(self, c_max: float) -> float:
        """c in a picture with this c_max.

        >>> Setting(c_fraction=0.5).scaling(0.8), Setting(c=0.3).scaling(0.8)
        (0.4, 0.3)
        """
        return self.c_fraction * c_max if self.c is None else self.c

    @property
    def words(self) -> str:
        """The setting as people read it, such as '2 deg, 2/6 c_max'."""
        share = f"{share_words(self.c_fraction)} c_max"
        return f"{self.sigma_n_deg:.3g} deg, {share if self.c is None else f'c {self.c:.4g}'}"


def share_words(fraction: float) -> str:
    """A share of c_max as people read it: in sixths where it is a whole number of them.

    >>> share_words(5 / 6), share_words(0.4)
    ('5/6', '0.4')
    """
    sixths = 6.0 * fraction
    if abs(sixths - round(sixths)) < 1e-6:
        return f"{round(sixths)}/6"
    return f"{fraction:.3g}"
