"""What the lobes add to a colour that was measured 45/0, where the artwork's colours hold it."""

from __future__ import annotations

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material.material import Material
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.pack import MEASURED, Pack

_, AT_45_0 = MEASURED
#: Less than the steps of an 8-bit artwork: nothing is subtracted.
NOTHING = 1e-4


def lobe_at_45_0(material: Material) -> Array:
    """XYZ under D50 (3,), Y = 1 the perfect diffuser, of a material's lobes lit from 45 degrees.

    A reflectance factor, pi f_s: the instrument compares with the perfect diffuser (ISO 13655).
    """
    light = np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    up = np.array([0.0, 0.0, 1.0])
    _, specular = material.evaluate(light, up)
    lamp = illuminant("D50")
    weights = material.xyz_weights(lamp)
    return np.asarray(np.pi * specular @ weights)


def lobes_in_artwork(pack: Pack) -> Array | None:
    """(F, 3), the XYZ that each finish's lobes have in the artwork's colours; None where none has.

    The artwork's colours are those of the print's body by default, so that a matt varnish makes a
    black lighter, as it does in a press. Where the pack's colours were measured 45/0 on the
    finished surface, the lobes' part is inside them.
    """
    if pack.measured != AT_45_0 or pack.artwork is None:
        return None
    lobes = np.array([lobe_at_45_0(finish.material) for finish in pack.finishes])
    return lobes if np.max(lobes) > NOTHING else None
