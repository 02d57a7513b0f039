"""Built-in finishes: invented materials of packs, as files in assets/finishes."""

from __future__ import annotations

from functools import lru_cache

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material
from relgloss_view.material.material import Material

#: Built-in finishes in order of gloss within each kind, with the kind that each usually is.
FINISHES = {
    "gloss-varnish": "varnish",
    "satin-varnish": "varnish",
    "matt-varnish": "varnish",
    "soft-touch": "varnish",
    "cold-foil-silver": "foil",
    "cold-foil-gold": "foil",
    "bare-board": "stock",
    "uncoated-label": "stock",
    "kraft": "stock",
}
#: The sample papers, whose materials serve as finishes too.
PAPERS = ("cast-coated", "art-coated", "matte-coated", "uncoated")


@lru_cache(maxsize=len(FINISHES) + len(PAPERS))
def load_finish(name: str) -> Material:
    """The material of a built-in finish or of a sample paper; InputError for any other name.

    name: of FINISHES or PAPERS. All of them are synthetic.

    >>> load_finish("soft-touch").name
    'soft-touch varnish'
    """
    if name in FINISHES:
        return load_material(asset("finishes", f"{name}.json"))
    if name in PAPERS:
        return load_material(asset("materials", f"{name}.json"))
    raise InputError(
        f"material {printable(name, 60)!r}: expected a material file (JSON), or one of "
        f"{', '.join((*FINISHES, *PAPERS))}"
    )
