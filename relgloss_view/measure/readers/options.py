"""How a caller wants a measured file to be read: what replaces, or completes, its declarations."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.measure.quantity import BRDF, canonical_quantity


@dataclass(frozen=True)
class ReadOptions:
    """The facts that a caller gives about a file. None: what the file declares.

    >>> ReadOptions(gamma_s_deg=0.0).unused("gamma_s_deg")
    ('--gamma-s-deg is not used: the format has no tilt of the sample',)
    """

    quantity: str | None = None  #: one of quantity.QUANTITIES
    gamma_s_deg: float | None = None  #: tilt at which a GCMS table sees the mirror, degrees
    angle_unit: str | None = None  #: 'degrees' or 'radians'
    mirror: str | None = None  #: 'opposite' or 'same-side' of the lamp
    #: Name or number, from 1, of the sample or surface that is wanted of a file that holds several
    part: str | None = None

    def quantity_or(self, declared: str) -> str:
        """The caller's quantity in its canonical spelling, or what the file declares.

        Raises InputError for a word that is no quantity.

        >>> ReadOptions().quantity_or("brdf"), ReadOptions("BRDF cos").quantity_or("brdf")
        ('brdf', 'brdf-cos')
        """
        if self.quantity is None:
            return declared
        return canonical_quantity(self.quantity, "--quantity")

    def unused(self, *names: str) -> tuple[str, ...]:
        """A warning for each of some options that is given, though the format has no use for it.

        A quantity of 'brdf' is what formats of BRDFs hold, and is no reason for a warning.
        """
        reasons = {
            "quantity": "the format holds BRDFs in 1/sr",
            "gamma_s_deg": "the format has no tilt of the sample",
            "angle_unit": "the format fixes the unit of its angles",
            "mirror": "the format fixes its mirror direction",
            "part": "the file holds one sample",
        }
        warnings = []
        for name in names:
            value = getattr(self, name)
            is_brdf = name == "quantity" and value is not None
            if value is None or (is_brdf and canonical_quantity(value, "--quantity") == BRDF):
                continue
            option = "--" + name.replace("_", "-")
            warnings.append(f"{option} is not used: {reasons[name]}")
        return tuple(warnings)
