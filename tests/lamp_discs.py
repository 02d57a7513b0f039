"""A lobe under a disc, by Mitsuba and by lights.py; run it for the table of docs/light.md.

Mitsuba's `disk` with an `area` emitter faces a point of a mirror-like rough conductor (Beckmann,
alpha = sqrt(2) s, 100 % reflectance), and a radiance meter sees the point at angles off the mirror
direction. Both profiles are over their own peak under a disc too small to matter, and what is
compared is the change that the size makes: Beckmann's facets and Smith's shadowing are not ours.
"""

from __future__ import annotations

import numpy as np

from relgloss_view.material import brdf
from relgloss_view.material.brdf import MetalPart
from relgloss_view.picture.model import lights

TINY = 1e-4  #: radius over distance of a disc that is as good as a point
WIDTHS_DEG = (0.5, 2.0, 6.0, 15.0)
RADII = (0.02, 0.05, 0.1, 0.15)
INCIDENCES_DEG = (0.0, 30.0, 60.0)
OFF = (0.0, 0.7, 1.4, 2.0)  #: of the facet's angle, in widths of the widened lobe
TURNS = ("within", "across")  #: of the plane of incidence


def directions(theta_deg, tilt_deg, turn):
    """To the lamp, and to an eye that sees a facet tilted within or across the plane."""
    theta, tilt = np.radians(theta_deg), np.radians(tilt_deg)
    i = np.array([-np.sin(theta), 0.0, np.cos(theta)])
    h = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    if turn == "across":
        h = np.array([0.0, np.sin(tilt), np.cos(tilt)])
    return i, 2.0 * (h @ i) * h - i


def mitsuba_radiance(mi, s_deg, radius, i, o, samples):
    """Radiance of the point towards o, the disc's intensity at its axis being one."""
    lamp = [float(v) for v in i]
    eye = [float(v) for v in o]
    world = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 1},
            "sensor": {
                "type": "radiancemeter",
                "origin": eye,
                "direction": [-v for v in eye],
                "film": {
                    "type": "hdrfilm",
                    "width": 1,
                    "height": 1,
                    "rfilter": {"type": "box"},
                    "pixel_format": "luminance",
                },
                "sampler": {"type": "independent", "sample_count": samples},
            },
            "ground": {
                "type": "rectangle",
                "bsdf": {
                    "type": "roughconductor",
                    "material": "none",
                    "distribution": "beckmann",
                    "alpha": float(np.sqrt(2.0) * np.radians(s_deg)),
                },
            },
            "lamp": {
                "type": "disk",
                "to_world": mi.ScalarTransform4f()
                .look_at(origin=lamp, target=[0, 0, 0], up=[0, 1, 0])
                .scale([radius, radius, 1]),
                "emitter": {
                    "type": "area",
                    "radiance": {"type": "spectrum", "value": 1.0 / (np.pi * radius**2)},
                },
            },
        }
    )
    return float(np.mean(np.array(mi.render(world, spp=samples, seed=1))))


def own_radiance(s_deg, radius, i, o, sized=True):
    """The same by lights.py."""
    n = np.array([0.0, 0.0, 1.0])
    s = float(np.radians(s_deg))
    f = brdf.facing(n, i, o)
    sin2_r = radius**2 / (1.0 + radius**2) if sized else 0.0
    delta2, peak = lights.spread_by_lamp(f, 0.5 / s**2, lights.across(n, i, o, f), sin2_r)
    at = f._replace(delta2=delta2)
    value = brdf.torrance_sparrow(at, s, MetalPart.FACING)
    value = value + brdf.torrance_sparrow(at, s, MetalPart.GRAZING)
    return float(peak * value * max(f.mu_i, 0.0) / (1.0 + radius**2))


def largest_error(mi, s_deg, radius, theta_deg, sized=True, samples=20000):
    """Largest difference of the two profiles, over the peak under the disc."""
    straight = directions(theta_deg, 0.0, "within")
    theirs_peak = mitsuba_radiance(mi, s_deg, TINY, *straight, samples)
    own_peak = own_radiance(s_deg, TINY, *straight)
    errors, disc_peak = [], 0.0
    wide = np.degrees(np.hypot(np.radians(s_deg), radius / 4.0))
    for off in OFF:
        for turn in TURNS if off else TURNS[:1]:
            i, o = directions(theta_deg, off * wide, turn)
            disc, point = (
                mitsuba_radiance(mi, s_deg, r, i, o, samples) / theirs_peak for r in (radius, TINY)
            )
            own, own_point = (
                own_radiance(s_deg, r, i, o, sized) / own_peak for r in (radius, TINY)
            )
            disc_peak = max(disc_peak, disc)
            errors.append(abs(own - own_point - (disc - point)))
    return max(errors) / disc_peak


if __name__ == "__main__":
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    print("| s | incidence | " + " | ".join(f"r/d = {r}" for r in RADII) + " |")
    for s_deg in WIDTHS_DEG:
        for theta_deg in INCIDENCES_DEG:
            cells = [f"{100 * largest_error(mitsuba, s_deg, r, theta_deg):.1f} %" for r in RADII]
            print(f"| {s_deg:g} | {theta_deg:g} | " + " | ".join(cells) + " |")
