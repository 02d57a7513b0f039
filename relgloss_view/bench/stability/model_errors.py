"""How far the shader, exact or simplified, is from the exact models in float64.

What is drawn at a place is f cos_i: all normals that eye and lamp can meet at a given angle
between them are tried, and the largest error is told as a share of the largest exact value, the
highlight's own top. `incidence_deg` is half the angle between lamp and eye: the incidence at the
mirror point, and theta_d everywhere. What is not finite gives an error that is not finite.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import moderngl
import numpy as np
from numpy.typing import ArrayLike

from relgloss_view.base.arrays import Array, Mask
from relgloss_view.material import approximations, brdf
from relgloss_view.picture.gpu import constants
from relgloss_view.picture.gpu.evaluate import evaluate
from relgloss_view.picture.gpu.targets import LARGEST_WHITE, Targets
from relgloss_view.picture.model import tone

INDEX = 1.5  #: refractive index of every lobe here
REACH_SD = 8.0  #: a Gaussian beyond this many standard deviations is 1e-14
#: Cosines below this share of the mirror point's are the last tenth of a per cent of a silhouette.
LOWEST_COSINE = 0.02
ALBEDOS = (0.3, 0.9)  #: of the diffuse maps: Oren-Nayar's interreflection grows with its square
#: XYZ per Y under a lamp of equal energy: gray, a green, an orange.
COLOURS = np.array([[1.0, 1.0, 1.0], [0.6, 1.0, 0.5], [1.3, 1.0, 0.3]])

#: A rotation by no particular angles.
ASKEW = np.linalg.qr(np.array([[0.61, -0.32, 0.43], [0.27, 0.83, 0.11], [-0.53, 0.21, 0.72]]))[0]


class Facings(NamedTuple):
    """Directions (..., 3) of every cell's normals, and which of them eye and lamp can meet."""

    n: Array
    i: Array
    o: Array
    met: Mask


def facings(incidence_deg: ArrayLike, reach_deg: ArrayLike, steps: int = 81) -> Facings:
    """Normals within `reach` of the half-vector: in the plane of i and o, across it, between them.

    Cells have the broadcast shape (...) of the arguments; results (..., 3 steps, 3). All stand
    askew in space: beside an axis small components would keep more digits than they do elsewhere.
    """
    theta, reach = np.broadcast_arrays(np.radians(incidence_deg), np.radians(reach_deg))
    turn = np.radians([0.0, 45.0, 90.0])
    # Further than this eye or lamp stand below the horizon: tan(tilt) cos(turn) tan(theta) = 1.
    horizon = np.arctan2(1.0, np.tan(theta)[..., None] * np.cos(turn))
    tilt = np.minimum(reach[..., None], horizon)[..., None] * np.linspace(-1.0, 1.0, steps)
    sin = np.sin(tilt)
    cos_turn, sin_turn = np.cos(turn)[:, None], np.sin(turn)[:, None]
    n = np.stack([sin * cos_turn, sin * sin_turn, np.cos(tilt)], axis=-1)
    n = n.reshape(*theta.shape, -1, 3)
    zero = np.zeros((*theta.shape, 1))
    x, z = np.sin(theta)[..., None] + zero, np.cos(theta)[..., None] + zero
    i, o = (np.stack([side * x, zero, z], axis=-1) + 0.0 * n for side in (1.0, -1.0))
    lowest = np.minimum(np.sum(n * i, axis=-1), np.sum(n * o, axis=-1))
    return Facings(n @ ASKEW, i @ ASKEW, o @ ASKEW, lowest > LOWEST_COSINE * z)


def share_of_peak(drawn: Array, exact: Array, met: Mask) -> Array:
    """Largest |drawn - exact| of a cell's normals (last axis) over its largest exact value."""
    fine = np.all(np.isfinite(drawn) | ~met, axis=-1)
    off = np.where(met & np.isfinite(drawn), np.abs(drawn - exact), 0.0)
    peak = np.max(np.where(met, exact, 0.0), axis=-1)
    worst = np.max(off, axis=-1)
    return np.where(fine, worst / np.where(peak > 0.0, peak, 1.0), np.inf)


def shader_values(
    ctx: moderngl.Context, body: str, f: Facings, defines: dict[str, int], **cells: Array
) -> Array:
    """`body` on the device for every facing; `cells` (..., 4) are numbers of each cell."""
    shape = f.n.shape[:-1]
    inputs: dict[str, Any] = {name: v.reshape(-1, 3) for name, v in zip("nio", f[:3], strict=True)}
    for name, numbers in cells.items():
        spread = np.broadcast_to(numbers[..., None, :], (*shape, numbers.shape[-1]))
        inputs[name] = spread.reshape(-1, numbers.shape[-1])
    text = f"Facing f = facing(n.xyz, i.xyz, o.xyz); {body}"
    result = evaluate(ctx, ["brdf.glsl"], text, inputs, defines=defines)
    return np.asarray(result.reshape(*shape, 4), dtype=np.float64)


LOBE_BODY = (
    "result = vec4(torrance_sparrow(f, Lobe(lobe.x, lobe.y, lobe.z, lobe.w)) * max(f.mu_i, 0.0));"
)


def lobe_error(
    ctx: moderngl.Context,
    s_deg: ArrayLike,
    incidence_deg: ArrayLike,
    *,
    fresnel: str = "exact",
    shadowing: str = "v-groove",
    facets: str = "gaussian",
) -> Array:
    """Error of a lobe as the shader draws it, with the named parts; cells broadcast."""
    s, theta = np.broadcast_arrays(np.asarray(s_deg, dtype=np.float64), incidence_deg)
    f = facings(theta, REACH_SD * s)
    defines = {
        "FRESNEL": constants.code("FRESNEL", fresnel),
        "SHADOWING": constants.code("SHADOWING", shadowing),
        "FACETS": constants.code("FACETS", facets),
    }
    lobes = np.array([approximations.plain_lobe(float(v), INDEX) for v in np.radians(s).ravel()])
    drawn = shader_values(ctx, LOBE_BODY, f, defines, lobe=lobes.reshape(*s.shape, 4))[..., 0]
    return share_of_peak(drawn, exact_lobe(f, s), f.met)


def exact_lobe(f: Facings, s_deg: Array) -> Array:
    """f_s cos_i in float64, for cells of lobe widths (...)."""
    s = np.radians(s_deg)[..., None]
    amplitude = np.vectorize(brdf.facet_amplitude)(s)
    g = brdf.facing(f.n, f.i, f.o)
    density = amplitude * np.exp(-np.minimum(g.delta2 / (2.0 * s * s), brdf.LARGEST_EXPONENT))
    value = 0.25 * density * brdf.fresnel_dielectric(g.cos_d, INDEX) * brdf.shadowing(g)
    return np.where(f.met, value * np.maximum(g.mu_i, 0.0), 0.0)


def diffuse_error(
    ctx: moderngl.Context, sigma_deg: ArrayLike, incidence_deg: ArrayLike, model: str
) -> Array:
    """Error of a diffuse model for the full one of Oren and Nayar; cells broadcast."""
    sigma, theta = np.broadcast_arrays(np.radians(np.asarray(sigma_deg, np.float64)), incidence_deg)
    f = facings(theta, np.full(theta.shape, 90.0))
    terms = np.array([brdf.diffuse_terms(model, float(v)) for v in sigma.ravel()])
    number = constants.code("DIFFUSE", model)
    body = f"result = vec4(diffuse_shapes({number}, f, terms), 0, 0) * max(f.mu_i, 0.0);"
    drawn = shader_values(ctx, body, f, {}, terms=terms.reshape(*sigma.shape, 4))
    g = brdf.facing(f.n, f.i, f.o)
    exact = np.zeros((*drawn.shape[:-1], 2))
    for cell in np.ndindex(sigma.shape):
        part = brdf.Facing(*(v[cell] for v in g))
        shapes = brdf.oren_nayar(part, float(sigma[cell]))
        exact[cell] = np.stack(shapes, axis=-1) * np.maximum(part.mu_i, 0.0)[:, None]
    errors = []
    for rho in ALBEDOS:
        second = np.array([float(brdf.second_albedo(model, rho, float(v))) for v in sigma.ravel()])
        shown = rho * drawn[..., 0] + second.reshape(sigma.shape)[..., None] * drawn[..., 1]
        errors.append(share_of_peak(shown, rho * exact[..., 0] + rho**2 * exact[..., 1], f.met))
    return np.asarray(np.max(errors, axis=0))


def tone_error(
    ctx: moderngl.Context,
    y_specular: ArrayLike,
    y_diffuse: ArrayLike,
    *,
    cube_root: str,
    targets: str,
) -> Array:
    """Largest error of L~*, a*, b* of three colours through split and scaling, c the largest to 1.

    XYZ beyond the largest number of the targets, under a lamp whose X or Z is the largest there is,
    counts as not finite.
    """
    y_s, y_d = np.broadcast_arrays(
        np.asarray(y_specular, dtype=np.float64), np.asarray(y_diffuse, dtype=np.float64)
    )
    shape = y_s.shape
    diffuse = (y_d[..., None, None] * COLOURS).reshape(-1, 3)
    specular = np.broadcast_to(y_s[..., None, None], (*shape, len(COLOURS), 3)).reshape(-1, 3)
    body = "result = split_lab(diffuse.xyz, specular.xyz, vec3(1.0));"
    root = {"CUBE_ROOT": constants.code("CUBE_ROOT", cube_root)}
    inputs = {"diffuse": diffuse, "specular": specular}
    targets_of = Targets(ctx)
    samplers = {"cube_root_table": targets_of.cube_root_table()} if cube_root == "table" else {}
    split = evaluate(ctx, ["tone.glsl"], body, inputs, defines=root, samplers=samplers)
    split = split.astype(np.float64)
    if targets == "float16":
        with np.errstate(over="ignore"):
            split = split.astype(np.float16).astype(np.float64)
            brightest = np.max(LARGEST_WHITE * (diffuse + specular), axis=-1).astype(np.float16)
        split[~np.isfinite(brightest)] = np.nan
    exact = tone.split_lab(diffuse, specular, np.ones(3))
    c = np.minimum(tone.largest_c(exact[:, 0], exact[:, 1]), 1.0)[:, None]
    with np.errstate(invalid="ignore"):
        off = [v[:, :1] + c * v[:, 1:2] for v in (split, exact)]
        error = np.maximum(
            np.abs(off[0] - off[1])[:, 0], np.max(np.abs(split - exact)[:, 2:], axis=-1)
        )
    error = np.where(np.isfinite(error), error, np.inf)
    return np.asarray(np.max(error.reshape(*shape, -1), axis=-1))


def peak_y(s_deg: ArrayLike, incidence_deg: ArrayLike) -> Array:
    """Largest Y of a lobe of strength 1 relative to the perfect diffuser's largest; no error."""
    s, theta = np.broadcast_arrays(np.asarray(s_deg, dtype=np.float64), incidence_deg)
    f = facings(theta, REACH_SD * s)
    return np.asarray(np.pi * np.max(exact_lobe(f, s), axis=-1))
