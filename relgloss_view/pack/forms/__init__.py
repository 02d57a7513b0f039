"""Forms: the triangles of cans, bottles, cartons, pouches and meshes."""

from __future__ import annotations

import functools

from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.shape import ANALYTIC, Shape

KEPT = 16  #: meshes in memory


def mesh_of(shape: Shape) -> Mesh | None:
    """The triangles of a form; None for the analytic ones, which are met by rays.

    The same object for an equal shape, of a mesh file as long as the file is the same. Raises
    InputError where a mesh file or a profile can't be used.

    >>> mesh_of(Shape("sphere")) is None
    True
    >>> mesh = mesh_of(Shape("can"))
    >>> mesh.parts, (2.0 * mesh.half_extent_m).round(6).tolist()
    (('base', 'body', 'neck', 'lid'), [0.066, 0.115, 0.066])
    """
    if shape.kind in ANALYTIC:
        return None
    if shape.kind == "mesh":
        from relgloss_view.pack.forms.mesh_files import read_mesh

        return read_mesh(shape.file, shape.unit)
    return _made(shape)


@functools.lru_cache(maxsize=KEPT)
def _made(shape: Shape) -> Mesh:
    from relgloss_view.pack.forms import vessels
    from relgloss_view.pack.forms.carton import carton
    from relgloss_view.pack.forms.pouch import pouch

    makers = {"can": vessels.can, "bottle": vessels.bottle, "carton": carton, "pouch": pouch}
    return makers[shape.kind](shape)
