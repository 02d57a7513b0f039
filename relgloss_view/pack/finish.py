"""Finish: a named surface of a pack: a material for its lobes and a rule for its diffuse part."""

from __future__ import annotations

from dataclasses import dataclass

from relgloss_view.base.parameters import Checked, choice, parameter
from relgloss_view.base.reading import text
from relgloss_view.material.material import Material

#: ink: diffuse from the artwork, lobes from the material. varnish: its lobes replace those below,
#: the diffuse part stays what is below. foil: it replaces both. stock: the material as measured.
KINDS = ("ink", "varnish", "foil", "stock")
MAX_FINISHES = 8
MAX_K = 100.0


@dataclass(frozen=True)
class Finish(Checked):
    """A finish of a pack. At a point finishes have shares from their masks, which sum to 1.

    name: for people, unique in a pack. kind: one of KINDS. material: of its lobes, and of a stock's
    or foil's diffuse part. source: the name of a built-in finish or paper, or the material's file.
    mask: where it lies: '' of the first finish, which lies everywhere below the others; else
    'plate:NAME' or 'channel:NAME' of the artwork, 'part:NAME' of the form, 'artwork' (where the
    artwork prints), 'everywhere', or the file of a gray picture as large as the artwork (white: the
    finish lies there).
    invert: whether the mask says where it does not lie.
    sigma_n_deg: its graininess, degrees, 0 to 10; None follows the look's.
    k: factor of its L_s* beside the picture's c, 0 to 100. keeps_k: whether a hand or a file chose
    k, so that a match keeps it.

    Raises InputError where a value is out of its range.

    >>> from relgloss_view.pack.built_in import load_finish
    >>> gloss = load_finish("gloss-varnish")
    >>> Finish("spot gloss", "varnish", gloss, "gloss-varnish", "plate:Varnish").k
    1.0
    """

    name: str
    kind: str = choice("ink", KINDS, "what it replaces of the surface below", label="Kind")
    material: Material = None  # type: ignore[assignment]
    source: str = ""
    mask: str = ""
    invert: bool = False
    sigma_n_deg: float | None = parameter(
        None, 0.0, 10.0, "deg", "graininess of this finish", label="Graininess (sigma_N)"
    )
    k: float = parameter(
        1.0, 0.0, MAX_K, "", "factor of this finish's contrast gloss", label="Gloss factor (k)"
    )
    keeps_k: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        text(self.name, "finish.name")
