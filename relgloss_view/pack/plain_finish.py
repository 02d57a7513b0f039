"""Plain finishes: each finish of a pack as one material, over what typically lies below it.

A varnish has no diffuse part of its own and an ink has that of the artwork. But L_s* is a
difference of lightness, so a highlight adds less to a light print than to a dark one. A plain
finish has the lobes of the finish and the mean diffuse luminance of the artwork where it lies.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material.material import ALBEDO_MAX, Diffuse, Material
from relgloss_view.material.spectra import Illuminant, illuminant
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.layers import Layers, layers_of
from relgloss_view.pack.pack import Pack

MOST_TEXELS = 1 << 18  #: of the mip level that the means are taken of
LEAST_SHARE = 1e-6  #: of a texel; a smaller sum of shares is none
HELD = 64  #: plain materials that are kept
OWN_BODY = ("stock", "foil")  #: kinds whose diffuse part is the material's


@dataclass(frozen=True)
class PlainFinish:
    """A finish as one material.

    material: its lobes over its typical diffuse part; the same object for an equal finish, so that
    what was computed of it is kept. luminance: Y of its diffuse albedo, 1 the perfect diffuser.
    lies_somewhere: whether any place of the pack shows its lobes.
    """

    finish: Finish
    material: Material
    luminance: float
    lies_somewhere: bool

    @property
    def shines(self) -> bool:
        """Whether some place of the pack can show a highlight of it."""
        return self.lies_somewhere and bool(self.material.visible_lobes())


def plain_finishes(pack: Pack, lamp: str) -> tuple[PlainFinish, ...]:
    """The finishes of a pack in their order, each as one material under a lamp's illuminant.

    A stock and a foil keep their material, whose diffuse part is their own. An ink and a varnish
    get a gray diffuse part: the mean luminance of the pack's diffuse albedo, weighted by the share
    of the finish, of a mip level of at most MOST_TEXELS. Where nothing is printed that is the base
    finish's. Raises InputError where a mask fits nothing.
    """
    layers, light = layers_of(pack), illuminant(lamp)
    own = [_luminance(f.material, light) for f in pack.finishes]
    specular, diffuse, paint = _texels(layers)
    printed = paint[..., 1] + (1.0 - paint[..., 3]) * own[0]
    albedos = [own[g] if f.kind in OWN_BODY else printed for g, f in enumerate(pack.finishes)]
    albedo = sum(diffuse[..., g] * albedos[g] for g in range(len(albedos)))
    covered = {layers.outside_finish, *layers.part_finish}
    made = []
    for k, finish in enumerate(pack.finishes):
        share = specular[..., k]
        total = float(np.sum(share))
        somewhere = total > LEAST_SHARE or k in covered
        if finish.kind in OWN_BODY or (k == 0 and pack.artwork is None):
            made.append(PlainFinish(finish, finish.material, own[k], somewhere))
            continue
        mean, below = own[0], 0
        if total > LEAST_SHARE:
            mean = float(np.sum(share * albedo) / total)
            below = int(np.argmax([np.sum(share * diffuse[..., g]) for g in range(len(own))]))
        body = (finish if finish.kind == "ink" else pack.finishes[below]).material.diffuse
        made.append(PlainFinish(finish, _on(finish.material, body, mean), mean, somewhere))
    return tuple(made)


def _texels(layers: Layers) -> tuple[Array, Array, Array]:
    """Specular and diffuse shares (h, w, F) and paint (h, w, 4) of the first small enough level."""
    paint, channels = next(
        level for level in layers.levels if level[0].shape[0] * level[0].shape[1] <= MOST_TEXELS
    )
    specular, diffuse = layers.shares(channels.astype(np.float64) / 255.0)
    return specular, diffuse, paint.astype(np.float64)


def _luminance(material: Material, lamp: Illuminant) -> float:
    """Y of a material's diffuse albedo under a lamp, Y = 1 the perfect diffuser."""
    return float(np.asarray(material.diffuse.albedo) @ material.xyz_weights(lamp)[:, 1])


_KEPT: dict[tuple[int, Diffuse], tuple[Material, Material]] = {}


def _on(material: Material, body: Diffuse, luminance: float) -> Material:
    """A material's lobes over a gray diffuse part; kept by the material's identity."""
    level = min(max(luminance, 0.0), ALBEDO_MAX)
    gray = dataclasses.replace(body, albedo=(level,) * material.bands.count)
    key = (id(material), gray)
    kept = _KEPT.pop(key, None)  # holds the material too, so that none takes its identity
    if kept is None:
        kept = (material, dataclasses.replace(material, diffuse=gray))
    _KEPT[key] = kept  # the last used one is the last
    while len(_KEPT) > HELD:
        del _KEPT[next(iter(_KEPT))]
    return kept[1]
