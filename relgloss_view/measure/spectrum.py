"""ColourReading: the colour of a flat sample in one geometry, as a spectrophotometer reads it."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.arrays import Array
from relgloss_view.measure.bands import Bands

#: Geometries of spectrophotometers (CIE 15:2004, ISO 13655): lamp at 45 degrees and receiver along
#: the normal, or a sphere and a receiver at 8 degrees that sees the mirror direction or not.
AT_45_0, SPHERE_INCLUDED, SPHERE_EXCLUDED = "45-0", "d-8-sci", "d-8-sce"
GEOMETRIES = (AT_45_0, SPHERE_INCLUDED, SPHERE_EXCLUDED)


@dataclass(frozen=True)
class ColourReading:
    """The reflectance spectrum of a sample in one geometry."""

    name: str
    bands: Bands  #: spectral
    radiance_factor: Array  #: (B,), 1 is the perfect diffuser
    geometry: str | None = None  #: one of GEOMETRIES; None where the file does not state it
    notes: tuple[str, ...] = ()  #: what was passed over or converted
    file: str = ""  #: where it was read from
