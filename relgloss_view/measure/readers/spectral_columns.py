"""Which columns of a table of samples hold a spectrum, in which geometry."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.measure.readers.aspecular import Aspecular, split_aspecular
from relgloss_view.measure.readers.headings import band_nm

FEWEST_BANDS = 4
HEADING_NM = (200.0, 2600.0)
LONGEST_HEADING = 60
_PREFIX = re.compile(r"^(reflectance|refl\w*|rsp|spectral_(pct|dec))[ _]*(?=\d|nm)", re.IGNORECASE)


@dataclass(frozen=True)
class SpectralColumns:
    """Spectra of each row: a geometry where the headings name it, wavelengths, column numbers."""

    spectra: tuple[tuple[Aspecular | None, Array, tuple[int, ...]], ...]

    @property
    def used(self) -> tuple[int, ...]:
        """The columns of all spectra, in order."""
        return tuple(sorted(k for _, _, columns in self.spectra for k in columns))


def spectral_columns(headings: Sequence[str]) -> SpectralColumns:
    """The spectra that a header declares; none where it names fewer than four wavelengths.

    Headings are wavelengths in the words of CGATS files and spreadsheets; several geometries may
    stand side by side. Wavelengths that do not increase are no spectrum.

    >>> layout = spectral_columns(["NAME", "NM_400", "NM_500", "NM_600", "NM_700"])
    >>> layout.used, layout.spectra[0][1].tolist()
    ((1, 2, 3, 4), [400.0, 500.0, 600.0, 700.0])
    >>> spectral_columns(["45as15 400", "45as15 500", "45as15 600", "45as15 700"]).spectra[0][0]
    Aspecular(lamp_deg=45.0, aspecular_deg=15.0, azimuth_deg=0.0)
    """
    groups: dict[Aspecular | None, list[tuple[int, float]]] = {}
    for k, heading in enumerate(headings):
        if len(heading) > LONGEST_HEADING or not any(c.isdigit() for c in heading):
            continue
        angle, rest = split_aspecular(heading)
        nm = band_nm(_PREFIX.sub("", rest))
        if nm is not None and HEADING_NM[0] <= nm <= HEADING_NM[1]:
            groups.setdefault(angle, []).append((k, nm))
    spectra = []
    for angle, columns in groups.items():
        centres = [v for _, v in columns]
        if len(centres) >= FEWEST_BANDS and all(a < b for a, b in itertools.pairwise(centres)):
            spectra.append((angle, np.array(centres), tuple(k for k, _ in columns)))
    return SpectralColumns(tuple(spectra))
