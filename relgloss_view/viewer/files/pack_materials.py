"""Materials and masks that finishes of the window's packs can have, by the names of lists."""

from __future__ import annotations

from functools import lru_cache

from relgloss_view.material.material import Material
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.sample import SAMPLES, load_sample

NEW = "gloss-varnish"  #: of a finish that is added


def names() -> tuple[str, ...]:
    """Built-in finishes and papers, in their order."""
    from relgloss_view.pack.built_in import FINISHES

    return (*FINISHES, *SAMPLES)


@lru_cache(maxsize=64)
def material(name: str) -> Material:
    """The material of a name of the list; InputError for any other."""
    from relgloss_view.pack.built_in import FINISHES, load_finish

    return load_finish(name) if name in FINISHES else load_sample(name)


def parts(shape: Shape) -> tuple[str, ...]:
    """The parts of a form; none where its mesh can't be read."""
    from relgloss_view.base.errors import InputError
    from relgloss_view.pack.label import label_of

    try:
        return label_of(shape).parts
    except InputError:
        return ()
