"""Contents of a picture's file beside its pixels: parameters, results and warnings."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from relgloss_view.base.version import __version__
from relgloss_view.pack.pack import Pack
from relgloss_view.picture.displayed import Displayed
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.seen import seen_numbers, seen_warnings

SPLIT = "split"  #: name of the operator whose picture a frame itself holds


def parameters(frame: Frame, displayed: Displayed | None = None) -> dict[str, Any]:
    """The parameters and results of a picture as values for JSON, without the material's spectra.

    displayed: the picture of another operator than the split. The counts are of that picture; c
    and c_max are of the split.
    """
    scene, look, scaling = frame.scene, frame.look, frame.scaling
    picture = displayed or frame
    return {
        "sample": scene.name,
        "source": scene.material.source,
        "size": list(frame.size),
        "sigma_n_deg": look.sigma_n_deg,
        "c": scaling.c,
        "c_max": scaling.c_max,
        "c_max_eq4": scaling.c_max_eq4,
        "pair_factor": scaling.factor,
        "y_n_cd_m2": frame.y_n_cd_m2,
        "seed": look.seed,
        "samples": sample_count(scene, look, frame.size),
        "operator": displayed.operator if displayed else SPLIT,
        "operator_parameters": dict(displayed.settings) if displayed else {},
        "clip_count": picture.clip_count,
        "out_of_gamut_count": picture.out_of_gamut_count,
        "object_pixels": frame.object_pixels,
        "lamp_m": [round(float(v), 9) for v in scene.lamp.position_m],
        "eye_m": [round(float(v), 9) for v in scene.eye.position_m],
        **{name: asdict(getattr(scene, name)) for name in ("shape", "lamp", "eye", "display")},
        "further_lamps": [asdict(lamp) for lamp in scene.setup.further_lamps],
        "look": asdict(look),
        "method": frame.method.differences(),
        "fit_quality": scene.material.fit.quality if scene.material.fit else None,
        "seen_on": seen_numbers(frame, displayed),
        "pack": None if scene.pack is None else pack_numbers(scene.pack, look),
        "warnings": list(warnings(frame, displayed)),
        "device": frame.device,
        "version": __version__,
    }


def pack_numbers(pack: Pack, look: Look) -> dict[str, Any]:
    """A pack as values for JSON: its files, its form, and its finishes from the lowest up."""
    artwork = pack.artwork
    return {
        "name": pack.name,
        "file": pack.file or None,
        "form": pack.shape.kind,
        "artwork": None
        if artwork is None
        else {
            "file": artwork.file or None,
            "size_px": list(artwork.size_px),
            "size_mm": [artwork.width_mm, artwork.height_mm],
            "plates": list(artwork.plates),
        },
        "colour": pack.colour,
        "measured": pack.measured,
        "placement": asdict(pack.placement),
        "finishes": [
            {
                "name": finish.name,
                "kind": finish.kind,
                "material": finish.source or finish.material.name,
                "mask": finish.mask,
                "invert": finish.invert,
                "sigma_n_deg": look.sigma_n_deg
                if finish.sigma_n_deg is None
                else finish.sigma_n_deg,
                "k": finish.k,
            }
            for finish in pack.finishes
        ],
        "notes": list(pack.notes),
    }


def warnings(frame: Frame, displayed: Displayed | None = None) -> tuple[str, ...]:
    """The warnings that go with a picture; those about c belong to the split's picture only."""
    of_screen = seen_warnings(frame, displayed)
    if displayed is None:
        return (*frame.warnings, *of_screen)
    of_c = frame.scaling.warnings
    of_scene = (text for text in frame.warnings if text not in of_c)
    return (*of_scene, *displayed.warnings, *of_screen)
