"""Measurement: readings in the sample's frame, and the reasons to leave some of them out."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.arrays import Array, Ints, Mask
from relgloss_view.base.notebook import html_table, span
from relgloss_view.base.reading import printable
from relgloss_view.measure.bands import Bands

#: Why a sample is not used. The empty string marks one that is.
KEPT = ""
NEGATIVE = "negative"
MISSING = "missing"
SATURATED = "saturated"
OCCLUDED = "lamp and receiver within 8 degrees"
GRAZING = "within 3 degrees of the horizon"
BELOW = "below the horizon"


def source_is_synthetic(source: str) -> bool:
    """Whether the source of a file that has no field for it marks the sample as synthetic.

    It does where it begins with that word: "synthetic (made up)", not "card on synthetic leather".
    """
    return source.strip().lower().startswith("synthetic")


@dataclass(frozen=True)
class Measurement:
    """Reflectance of one flat sample over directions and bands.

    Directions are unit vectors in the sample frame (normal +z) that point away from the sample.
    `read_measurement` makes one from a file; `fit_material` fits a material to it.

    >>> from relgloss_view import read_measurement
    >>> from relgloss_view.base.resources import asset
    >>> paper = read_measurement(asset("papers", "art-coated.csv"))
    >>> paper.radiance_factor.shape, int(paper.kept.sum())
    ((997, 35), 931)
    >>> paper.left_out()
    {'lamp and receiver within 8 degrees': 66}
    """

    name: str
    source: str  #: file, instrument
    to_lamp: Array  #: (N, 3) unit vectors
    to_receiver: Array  #: (N, 3) unit vectors
    bands: Bands
    radiance_factor: Array  #: (N, B), pi times the BRDF; may hold NaN where the sample is left out
    reasons: NDArray[np.object_]  #: (N,), KEPT or why the sample is left out
    #: (N,), samples that share a plane or a setting of the lamp; validation leaves whole groups out
    group: Ints
    #: (e_i, e_o): per-axis angular standard deviations of lamp and receiver apertures, degrees
    aperture_sd_deg: tuple[float, float] = (0.0, 0.0)
    gamma_s_deg: float | None = None  #: tilt at which a GCMS table sees the mirror direction
    warnings: tuple[str, ...] = ()
    file: str = ""  #: where it was read from
    format: str = ""  #: the file's, with its article, such as 'a GCMS-style table'
    quantity: str = (
        ""  #: what the file holds, one of quantity.QUANTITIES; '' where nothing states it
    )
    synthetic: bool = False  #: computed from invented parameters, not measured
    #: Resampled by those who publish it: its directions are exact, no instrument's
    tabulated: bool = False
    #: Whether rows are in the order in which they were read, as instruments write text tables; the
    #: order of other formats is that of their angles
    in_time_order: bool = True
    #: (N,), how many rows of a larger table each row stands for (measure.thinning); None: itself
    stands_for: Array | None = None

    @property
    def place(self) -> str:
        """The file, or the name where there is none; messages begin with it."""
        return self.file or self.name

    @property
    def kept(self) -> Mask:
        """(N,), True for the samples that are used."""
        return np.asarray(self.reasons == KEPT)

    def left_out(self) -> dict[str, int]:
        """Number of samples left out, by reason."""
        return dict(Counter(str(r) for r in self.reasons if r != KEPT))

    def __repr__(self) -> str:
        return (
            f"<Measurement {printable(self.name, 60)!r}: {int(self.kept.sum())} of "
            f"{len(self.reasons)} samples used, {self.bands.words}, "
            f"radiance factor {span(self.radiance_factor[self.kept])}>"
        )

    def _repr_html_(self) -> str:
        """The table that a notebook shows."""
        used = self.kept
        lamp, receiver = (
            np.degrees(np.arccos(np.clip(d[used, 2], -1.0, 1.0)))
            for d in (self.to_lamp, self.to_receiver)
        )
        rows = [
            ("source", self.source),
            *([("file", self.file)] if self.file else []),
            ("samples used", f"{int(used.sum())} of {len(used)}"),
            *((f"left out: {reason}", str(n)) for reason, n in self.left_out().items()),
            ("bands", self.bands.words),
            ("quantity", "radiance factor, pi times the BRDF; 1 is the perfect diffuser"),
            ("range of used samples", span(self.radiance_factor[used])),
            ("lamp, from the normal", span(lamp, "deg")),
            ("receiver, from the normal", span(receiver, "deg")),
            ("apertures, lamp and receiver", "sd {:g} and {:g} deg".format(*self.aperture_sd_deg)),
        ]
        if self.gamma_s_deg is not None:
            rows.append(("tilt that sees the mirror", f"{self.gamma_s_deg:g} deg"))
        return html_table(f"Measurement: {self.name}", rows, self.warnings)
