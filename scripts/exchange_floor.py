"""The floor of docs/exchange.md: how near any sum of GGX lobes comes to a material's highlight.

    python scripts/exchange_floor.py                       # the four that no model shows
    python scripts/exchange_floor.py --lobes 3 cold-foil-silver

No model of another program counts here: the lobes have any strength and width, and the material's
own body, colour and Fresnel's reflectance. What a model reaches above this is the model's own loss.
"""

from __future__ import annotations

import argparse

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.exchange import ggx, judge
from relgloss_view.exchange.refit import NARROWEST, roughness_of
from relgloss_view.gloss.meter.meter import main_lobe
from relgloss_view.material import brdf
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.pack.built_in import load_finish

LOST = ("cast-coated", "art-coated", "cold-foil-silver", "cold-foil-gold")
ROWS = 4
#: The largest difference may be this many times the 95th percentile: a spike that fewer than 5 % of
#: the highlight show costs the percentile nothing.
LARGEST = 1.6
WIDEST = 60.0  #: alpha over that of the material's main lobe


def main() -> int:
    """Print the floor of each material."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*", help=f"Materials; without any {', '.join(LOST)}")
    parser.add_argument("--lobes", type=int, default=2, help="Number of GGX lobes")
    parser.add_argument("--rounds", type=int, default=60, help="Rounds of differential evolution")
    args = parser.parse_args()
    print("| material | dE2000 p95 | largest |\n| --- | --- | --- |")
    for name in args.names or LOST:
        p95, largest = floor(name, args.lobes, args.rounds)
        print(f"| {name} | {p95:.1f} | {largest:.1f} |", flush=True)
    return 0


def floor(name: str, lobes: int, rounds: int) -> tuple[float, float]:
    """The 95th percentile and the largest of CIEDE2000 that the search ends at."""
    from scipy.optimize import Bounds, differential_evolution, minimize

    material = load_finish(name)
    main = main_lobe(material)
    assert main is not None
    points = judge.points_of(judge.AZIMUTH_DEG, rows=ROWS)
    own = judge.seen(material, points)
    picture = judge.picture_of(own)
    colour = own.specular / np.maximum(own.specular[:, 1:2], 1e-9)
    t = ggx.turn(points.i, points.o)
    lobe = material.specular[main]
    fresnel = np.ones_like(t.cos_d)
    if not lobe.is_metal:
        fresnel = brdf.fresnel_dielectric(np.minimum(t.cos_d, 1.0), lobe.refractive_index)
    alpha = roughness_of(lobe) ** 2
    low, high = np.array(
        [(-7.0, 3.0), (np.log(NARROWEST**2 * alpha), min(np.log(WIDEST * alpha), 0.0))] * lobes
    ).T

    def shown(x: Array) -> judge.Seen:
        total = np.zeros_like(t.cos_d)
        for strength, width in np.exp(np.clip(x, low, high)).reshape(-1, 2):
            total += strength * ggx.density(t.cos_h, width) * ggx.shadowing(t, width) * fresnel
        return judge.Seen(own.diffuse, (total * points.arriving)[:, None] * colour)

    def cost(x: Array) -> float:
        lab = judge.scaled(picture, shown(x))[picture.highlight]
        apart = delta_e_2000(picture.lab[picture.highlight], lab)
        return max(float(np.percentile(apart, judge.PERCENTILE)), float(np.max(apart)) / LARGEST)

    found = differential_evolution(
        cost, Bounds(low, high), seed=0, maxiter=rounds, popsize=12, polish=False
    )
    best = minimize(cost, found.x, method="Nelder-Mead", options={"maxfev": 3000})
    return judge.difference(picture, shown(best.x))


if __name__ == "__main__":
    raise SystemExit(main())
