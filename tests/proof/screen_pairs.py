"""Simulated pairs of displays, pixel by pixel, by colour-science and not by proof/screens.py.

Each display has three channels of its own gamma, 8 bits, a black and a luminance; each observer
looks at the page's patterns on it, with an eye of its own. Gloss is what the 99.5th percentile of
brightness is above the median: in cube roots of cd/m2, or CIECAM16's brightness.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import colour
import numpy as np

from relgloss_view import Look, Scene, load_sample, open_renderer, read_pack
from relgloss_view.material.recolour import Colour, recoloured
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof import screens

SIZE = (96, 96)
SRGB = np.array(colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ)
WHITE = SRGB.sum(axis=1)
D65_XY = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
SCALES = ("cube roots", "CIECAM16")


@dataclass(frozen=True)
class Picture:
    """Object pixels of a drawn sample."""

    name: str
    lab: Any
    l_d: Any
    l_s: Any
    c_max: float

    def digital(self, c):
        """8-bit sRGB, as the page shows it, 0 to 1."""
        lab = np.column_stack([np.minimum(self.l_d + c * self.l_s, 100.0), self.lab[:, 1:]])
        xyz = colour.Lab_to_XYZ(lab, D65_XY) * (WHITE / colour.xy_to_XYZ(D65_XY))
        linear = np.clip(xyz @ np.linalg.inv(SRGB).T, 0.0, 1.0)
        return np.round(255.0 * colour.cctf_encoding(linear, function="sRGB")) / 255.0


@dataclass(frozen=True)
class Shown:
    """A display. gamma: of each channel; None: sRGB's curve. black: relative to white."""

    white_cd_m2: float
    black: float
    gamma: Any

    def xyz(self, digital):
        """cd/m2 of digital values (N, 3)."""
        if self.gamma is None:
            linear = colour.cctf_decoding(digital, function="sRGB")
        else:
            linear = digital**self.gamma
        light = self.black * WHITE + (1.0 - self.black) * (linear @ SRGB.T)
        return self.white_cd_m2 * light

    def gloss(self, digital, scale):
        """What the highlight adds to brightness."""
        xyz = self.xyz(digital)
        order = np.argsort(xyz[:, 1])
        ends = xyz[order[[int(0.995 * (len(order) - 1)), len(order) // 2]]]
        if scale == "cube roots":
            bright = 116.0 * np.cbrt(ends[:, 1] / 100.0)
        else:
            relative = 100.0 * ends / self.white_cd_m2
            bright = colour.XYZ_to_CIECAM16(relative, 100.0 * WHITE, 0.2 * self.white_cd_m2, 20.0).Q
        return float(bright[0] - bright[1])


IDEAL = Shown(100.0, 0.0, None)


def step(scale):
    """What a step of 1 L* at L* 50 is in a scale."""
    if scale == "cube roots":
        return 1.0
    grays = np.array([colour.Lab_to_XYZ([lstar, 0.0, 0.0], D65_XY) for lstar in (50.0, 51.0)])
    low, high = colour.XYZ_to_CIECAM16(100.0 * grays, 100.0 * WHITE, 20.0, 20.0).Q
    return float(high - low)


def pictures():
    """Papers in green (smooth and grainy), black and red, and both built-in packs."""
    drawn = []

    def add(name, scene, look, renderer):
        frame = renderer.render(scene, look, SIZE)
        on = frame.on_object
        lab, l_d, l_s = (np.asarray(v[on], dtype=float) for v in (frame.lab, *frame.split))
        drawn.append(Picture(name, lab, l_d, l_s, frame.c_max))

    with open_renderer() as renderer:
        for paper in ("cast-coated", "art-coated", "matte-coated", "uncoated"):
            own = load_sample(paper)
            dark = (24.0 if paper == "uncoated" else 8.0, 0.0, 0.0)
            for lab in (None, dark, (35.0, 40.0, 10.0)):
                material = own if lab is None else recoloured(own, Colour(lab))
                for sigma_n_deg in (0.0, 2.0) if lab is None else (1.0,):
                    look = Look(sigma_n_deg=sigma_n_deg)
                    add(f"{paper} {lab} {sigma_n_deg}", Scene(material), look, renderer)
        for name in ("can", "carton"):
            pack = read_pack(name)
            add(name, Scene(pack.material, Setup(shape=pack.shape), pack=pack), Look(), renderer)
    return drawn


def display(rng):
    """80 to 1,000 cd/m2, black and flare 0.05 to 15 %, gamma 1.8 to 2.6, or sRGB's curve."""
    white, black = np.exp(rng.uniform(np.log([80.0, 5e-4]), np.log([1000.0, 0.15])))
    gamma = None if rng.random() < 0.3 else rng.uniform(1.8, 2.6) + rng.normal(0.0, 0.03, 3)
    return Shown(float(white), float(black), gamma)


def found_by(shown, rng):
    """What an observer reads, sees and sets: the screen as the page would estimate it."""
    luminance = shown.xyz(np.repeat(np.arange(256)[:, None] / 255.0, 3, axis=1))[:, 1]
    middle = 0.5 * (luminance[0] + luminance[255])
    match = int(np.argmin(np.abs(luminance - middle))) + int(rng.integers(-2, 3))
    lstar = colour.lightness(100.0 * luminance / shown.white_cd_m2, method="CIE 1976")
    threshold = rng.uniform(0.35, 1.1)
    seen = [k for k, d in enumerate(screens.DARK_STEPS) if lstar[d] - lstar[0] >= threshold]
    gamma = screens.pattern_gamma(match / 255.0)
    first = seen[0] if seen else len(screens.DARK_STEPS)
    least, most = screens.black_bounds(first, screens.possible_gammas(gamma))
    return screens.Screen(shown.white_cd_m2 * float(rng.uniform(0.95, 1.05)), least, most, gamma)


def simulated(drawn, pairs, seed, verdict=screens.order_of_gloss):
    """Counter of (scale, verdict, what is seen) over pairs of displays, and of bounds of black.

    What is seen, where the scale gives the designed order a full step: 'kept' (half a step or
    more), 'same' (less than half a step) or 'reversed'; else 'no order'.
    """
    rng = np.random.default_rng(seed)
    counts = Counter()
    for _ in range(pairs):
        a, b = (drawn[k] for k in rng.choice(len(drawn), 2, replace=False))
        c_a, c_b = (p.c_max * float(np.exp(rng.uniform(np.log(0.1), 0.0))) for p in (a, b))
        digital = a.digital(c_a), b.digital(c_b)
        highlights = (
            screens.highlights_of(a.l_d, a.l_s, c_a),
            screens.highlights_of(b.l_d, b.l_s, c_b),
        )
        designed = np.subtract(*(h[0].peak - h[0].body for h in highlights))
        for _ in ("designer", "maker"):
            shown = display(rng)
            screen = found_by(shown, rng)
            counts["black within bounds"] += screen.black_least <= shown.black <= screen.black_most
            kind = verdict(*highlights, screen).kind
            for scale in SCALES:
                ideal, own = (
                    np.subtract(*(s.gloss(d, scale) for d in digital)) for s in (IDEAL, shown)
                )
                unit = step(scale)
                if ideal * designed <= 0.0 or abs(ideal) < unit:
                    seen = "no order"
                elif abs(own) < 0.5 * unit:
                    seen = "same"
                else:
                    seen = "kept" if own * ideal > 0.0 else "reversed"
                counts[scale, kind, seen] += 1
    return counts
