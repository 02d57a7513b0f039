"""The finishes of a pack as the numbers and constants that finishes.glsl takes."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.material import brdf
from relgloss_view.material.approximations import mean_lobe, plain_lobe
from relgloss_view.material.material import Lobe
from relgloss_view.material.spectra import illuminant
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.paint import paint_from_rgb, paint_matrix
from relgloss_view.picture.gpu.constants import NAMES, code
from relgloss_view.picture.gpu.uniforms import NO_LOBE
from relgloss_view.picture.method import Method
from relgloss_view.picture.model.drawn import drawn_diffuse, drawn_lobes, in_model
from relgloss_view.picture.scene.look import Look

LOBES = 2  #: of a finish, at most


class DrawnFinish(NamedTuple):
    """What is drawn of a finish."""

    finish: Finish
    lobes: tuple[Lobe, ...]
    diffuse: str  #: '' where it has no diffuse part of its own
    sigma_n: float  #: radians
    k: float


def drawn_finishes(pack: Pack, look: Look, method: Method) -> tuple[DrawnFinish, ...]:
    """The finishes of a pack at a look, as a method draws them."""
    drawn = []
    for finish in pack.finishes:
        material = in_model(finish.material, look)
        sigma = look.sigma_n_deg if finish.sigma_n_deg is None else finish.sigma_n_deg
        diffuse = "" if finish.kind == "varnish" else drawn_diffuse(material, method)
        lobes = drawn_lobes(material, method)
        drawn.append(DrawnFinish(finish, lobes, diffuse, math.radians(sigma), finish.k))
    return tuple(drawn)


def finish_constants(finishes: tuple[DrawnFinish, ...]) -> dict[str, int]:
    """FINISHES and the constants of finishes.glsl that follow from them, and LOBES."""
    metals = diffuses = inks = 0
    for k, drawn in enumerate(finishes):
        for n, lobe in enumerate(drawn.lobes):
            metals |= int(lobe.is_metal) << (LOBES * k + n)
        if drawn.diffuse:
            diffuses |= (code("DIFFUSE", drawn.diffuse) + 1) << (4 * k)
        inks |= int(drawn.finish.kind == "ink") << k
    assert len(NAMES["DIFFUSE"]) < 8  # so that the last one's bits are no sign
    return {
        "FINISHES": len(finishes),
        "FINISH_METALS": metals,
        "FINISH_DIFFUSES": diffuses,
        "FINISH_INKS": inks,
        "INK_SECOND": code("DIFFUSE", ink_second(finishes)[0]) if ink_second(finishes)[0] else -1,
        "LOBES": max(len(drawn.lobes) for drawn in finishes),
    }


def finish_tables(
    pack: Pack, look: Look, method: Method, lamp_name: str, blurred: bool
) -> dict[str, str]:
    """The numbers of the finishes that neither sigma_N nor k moves, as constants of finishes.glsl.

    As constants they cost a software driver nothing, where a uniform is read again in each pixel;
    a program is compiled where a material or the lamp's spectrum changes. blurred: each lobe is its
    mean over the finish's tilts.
    """
    finishes = drawn_finishes(pack, look, method)
    lamp = illuminant(lamp_name)
    count = len(finishes)
    lobe, strength = np.tile(NO_LOBE, (LOBES * count, 1)), np.zeros((LOBES * count, 4))
    terms, albedo, second = (np.zeros((count, 4)) for _ in range(3))
    base = pack.material
    for k, drawn in enumerate(finishes):
        material = drawn.finish.material
        weights = material.xyz_weights(lamp)
        for n, one in enumerate(drawn.lobes):
            at = LOBES * k + n
            lobe[at] = (
                mean_lobe(one.s, one.refractive_index, drawn.sigma_n, look.noise_law)
                if blurred and drawn.sigma_n > 0.0
                else plain_lobe(one.s, one.refractive_index)
            )
            colour, *white = (part.spectrum for part in one.parts(material.bands.count))
            strength[at, :3] = np.asarray(colour) @ weights
            strength[at, 3] = white[0][0] if white else 0.0
        if not drawn.diffuse:
            continue
        sigma = material.diffuse.sigma
        terms[k] = brdf.diffuse_terms(drawn.diffuse, sigma)
        bare = base if drawn.finish.kind == "ink" else material
        rho = np.asarray(bare.diffuse.albedo)
        of_bare = bare.xyz_weights(lamp)
        albedo[k, :3] = rho @ of_bare
        second[k, :3] = brdf.second_albedo(drawn.diffuse, rho, sigma) @ of_bare
        second[k, 3] = mean_albedo(drawn)
    return {
        "FINISH_LOBE": glsl_rows(lobe),
        "FINISH_STRENGTH": glsl_rows(strength),
        "FINISH_TERMS": glsl_rows(terms),
        "FINISH_ALBEDO": glsl_rows(albedo),
        "FINISH_SECOND": glsl_rows(second),
    }


def ink_second(finishes: tuple[DrawnFinish, ...]) -> tuple[str, float]:
    """The model, and its factor, of the second albedo of all inks; ('', 0) where they differ."""
    kinds = {
        (one.diffuse, mean_albedo(one))
        for one in finishes
        if one.finish.kind == "ink" and one.diffuse in ("oren-nayar", "eon")
    }
    return next(iter(kinds)) if len(kinds) == 1 else ("", 0.0)


def mean_albedo(drawn: DrawnFinish) -> float:
    """The factor of EON's second albedo; 0 of other models, which have none."""
    sigma = drawn.finish.material.diffuse.sigma
    return brdf.fujii_mean_albedo(sigma) if drawn.diffuse == "eon" else 0.0


def glsl_rows(rows: Array) -> str:
    """Rows of four numbers as an array of GLSL.

    >>> glsl_rows(np.array([[1.0, 0.5, 0.0, -2.0]]))
    'vec4[1](vec4(1.0, 0.5, 0.0, -2.0))'
    """
    vectors = (", ".join(repr(float(v)) for v in row) for row in rows.astype(np.float32))
    return f"vec4[{len(rows)}]({', '.join(f'vec4({vector})' for vector in vectors)})"


def finish_uniforms(pack: Pack, look: Look, lamp_name: str) -> dict[str, Any]:
    """The numbers of the finishes that are no constants."""
    lamp = illuminant(lamp_name)
    return {
        **look_uniforms(pack, look),
        **RGB_OF_PAINT,
        "paint_matrix": paint_matrix(pack.colour, lamp).T,  # columns first
        "lamp_xyz": lamp.white_xyz(),
        "per_white": 1.0 / lamp.white_xyz(),
    }


#: Linear sRGB of artwork, and back; columns first.
RGB_OF_PAINT = {
    "rgb_from_paint": np.linalg.inv(paint_from_rgb()).T,
    "paint_from_rgb": paint_from_rgb().T,
}


def look_uniforms(pack: Pack, look: Look) -> dict[str, Any]:
    """sigma_N (radians) and k of each finish."""
    looks = [
        (look.sigma_n_deg if f.sigma_n_deg is None else f.sigma_n_deg, f.k) for f in pack.finishes
    ]
    return {"finish_look": np.array([[math.radians(sigma), k] for sigma, k in looks])}


def ink_uniforms(pack: Pack | None, look: Look, method: Method) -> dict[str, Any]:
    """What the paint of the second albedo follows from, where all inks have it in common."""
    if pack is None:
        return {}
    return {**RGB_OF_PAINT, "ink_mean": ink_second(drawn_finishes(pack, look, method))[1]}
