"""The same cylinder drawn by Mitsuba: a program of its own, since its LLVM variants may abort.

Reads a scene as JSON from its first line, then draws a frame for each further line and answers with
its milliseconds.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

VARIANTS = ("scalar_rgb", "scalar_spectral", "llvm_ad_rgb")


def world(mi: Any, asked: dict[str, Any]) -> Any:
    """The scene: a rough plastic of the paper's albedo and lobe width, a point lamp, one sample."""
    width, height = asked["size"]
    reflectance = [[nm, value] for nm, value in asked["albedo"]]
    half = 0.5 * asked["height_m"]
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
            "sensor": {
                "type": "perspective",
                "fov": asked["field_of_view_deg"],
                "fov_axis": "y",
                "to_world": mi.ScalarTransform4f().look_at(
                    origin=asked["eye_m"], target=[0, 0, 0], up=[0, 1, 0]
                ),
                "film": {
                    "type": "hdrfilm",
                    "width": width,
                    "height": height,
                    "rfilter": {"type": "box"},
                },
                "sampler": {"type": "independent", "sample_count": 1},
            },
            "object": {
                "type": "cylinder",
                "p0": [0, -half, 0],
                "p1": [0, half, 0],
                "radius": 0.5 * asked["diameter_m"],
                "bsdf": {
                    "type": "roughplastic",
                    "distribution": "beckmann",
                    "alpha": asked["alpha"],
                    "int_ior": asked["refractive_index"],
                    "diffuse_reflectance": {"type": "spectrum", "value": reflectance},
                },
            },
            "lamp": {
                "type": "point",
                "position": asked["lamp_m"],
                "intensity": {"type": "spectrum", "value": 10.0},
            },
        }
    )


def main() -> int:
    """Serve frames until the input ends."""
    import mitsuba as mi

    mi.set_variant(sys.argv[1])
    drawn = world(mi, json.loads(sys.stdin.readline()))

    def frame(seed: int) -> float:
        start = time.perf_counter()
        picture = mi.render(drawn, spp=1, seed=mi.UInt32(seed))
        if "llvm" in sys.argv[1]:
            import drjit

            drjit.eval(picture)
            drjit.sync_thread()
        return 1e3 * (time.perf_counter() - start)

    for seed in range(2):  # the first compiles
        frame(seed)
    _say({"mitsuba": mi.__version__, "mean": _mean(mi.render(drawn, spp=1, seed=mi.UInt32(0)))})
    for turn, _ in enumerate(sys.stdin):
        _say({"ms": frame(2 + turn)})
    return 0


def _mean(picture: Any) -> float:
    """Of all values: a picture of nothing has none."""
    import numpy as np

    return float(np.mean(np.asarray(picture)))


def _say(answer: dict[str, Any]) -> None:
    print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    sys.exit(main())
