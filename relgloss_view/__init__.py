"""relgloss: pictures of printed packaging that keep the ratio of gloss between samples.

The public names below are imported when first used: importing the package loads no OpenGL and no
window library.
"""

from __future__ import annotations

# First, for a signal may come while the rest is imported.
from relgloss_view.base import interruptions as _interruptions  # noqa: F401 - isort: skip

import importlib

from relgloss_view.base.version import __version__

TYPE_CHECKING = False  # importing typing takes longer than all else here
if TYPE_CHECKING:
    from typing import Any

    from relgloss_view.base.errors import GLUnavailableError as GLUnavailableError
    from relgloss_view.base.errors import InputError as InputError
    from relgloss_view.base.errors import RelglossError as RelglossError
    from relgloss_view.display.display import Display as Display
    from relgloss_view.fitting import fit_material as fit_material
    from relgloss_view.fitting.estimate.estimate import estimate_material as estimate_material
    from relgloss_view.gloss.match import Reference as Reference
    from relgloss_view.gloss.match import matched as matched
    from relgloss_view.gloss.meter.meter import gloss_readings as gloss_readings
    from relgloss_view.gloss.pack_match import match_pack as match_pack
    from relgloss_view.material.files import load_material as load_material
    from relgloss_view.material.files import save_material as save_material
    from relgloss_view.material.material import Material as Material
    from relgloss_view.measure.bands import Bands as Bands
    from relgloss_view.measure.readers import read_measurement as read_measurement
    from relgloss_view.measure.table import Measurement as Measurement
    from relgloss_view.operators.registry import OPERATORS as OPERATORS
    from relgloss_view.operators.registry import make_operator as make_operator
    from relgloss_view.pack.artwork.artwork import Artwork as Artwork
    from relgloss_view.pack.artwork.options import ArtworkOptions as ArtworkOptions
    from relgloss_view.pack.artwork.read import read_artwork as read_artwork
    from relgloss_view.pack.built_in import FINISHES as FINISHES
    from relgloss_view.pack.built_in import load_finish as load_finish
    from relgloss_view.pack.check import check_pack as check_pack
    from relgloss_view.pack.finish import Finish as Finish
    from relgloss_view.pack.pack import Pack as Pack
    from relgloss_view.pack.pack import Placement as Placement
    from relgloss_view.pack.pack_file import read_pack as read_pack
    from relgloss_view.pack.pack_file import write_pack as write_pack
    from relgloss_view.pack.quick import quick_pack as quick_pack
    from relgloss_view.pack.shape import Shape as Shape
    from relgloss_view.picture.frame import Frame as Frame
    from relgloss_view.picture.output.export import save_frame as save_frame
    from relgloss_view.picture.scene.look import Look as Look
    from relgloss_view.picture.scene.match import Match as Match
    from relgloss_view.picture.scene.sample import SAMPLES as SAMPLES
    from relgloss_view.picture.scene.sample import Sample as Sample
    from relgloss_view.picture.scene.sample import load_sample as load_sample
    from relgloss_view.picture.scene.scene import Scene as Scene
    from relgloss_view.picture.scene.scene_file import load_scene as load_scene
    from relgloss_view.picture.scene.setting import Setting as Setting
    from relgloss_view.picture.scene.setup import Eye as Eye
    from relgloss_view.picture.scene.setup import FurtherLamp as FurtherLamp
    from relgloss_view.picture.scene.setup import Lamp as Lamp
    from relgloss_view.picture.scene.setup import Setup as Setup
    from relgloss_view.proof.proof import Proof as Proof
    from relgloss_view.proof.read import read_proof as read_proof
    from relgloss_view.proof.unpack import open_proof as open_proof
    from relgloss_view.quality.backends import open_renderer as open_renderer

_HOMES = {
    "measure.bands": ("Bands",),
    "base.errors": ("GLUnavailableError", "InputError", "RelglossError"),
    "material.files": ("load_material", "save_material"),
    "fitting": ("fit_material",),
    "fitting.estimate.estimate": ("estimate_material",),
    "gloss.match": ("Reference", "matched"),
    "gloss.meter.meter": ("gloss_readings",),
    "gloss.pack_match": ("match_pack",),
    "material.material": ("Material",),
    "measure.readers": ("read_measurement",),
    "operators.registry": ("OPERATORS", "make_operator"),
    "measure.table": ("Measurement",),
    "proof.proof": ("Proof",),
    "proof.read": ("read_proof",),
    "proof.unpack": ("open_proof",),
    "quality.backends": ("open_renderer",),
    "pack.artwork.artwork": ("Artwork",),
    "pack.artwork.options": ("ArtworkOptions",),
    "pack.artwork.read": ("read_artwork",),
    "pack.built_in": ("FINISHES", "load_finish"),
    "pack.check": ("check_pack",),
    "pack.finish": ("Finish",),
    "pack.pack": ("Pack", "Placement"),
    "pack.pack_file": ("read_pack", "write_pack"),
    "pack.quick": ("quick_pack",),
    "picture.output.export": ("save_frame",),
    "picture.frame": ("Frame",),
    "picture.scene.sample": ("SAMPLES", "Sample", "load_sample"),
    "picture.scene.look": ("Look",),
    "picture.scene.match": ("Match",),
    "picture.scene.scene": ("Scene",),
    "picture.scene.scene_file": ("load_scene",),
    "picture.scene.setting": ("Setting",),
    "display.display": ("Display",),
    "picture.scene.setup": ("Eye", "FurtherLamp", "Lamp", "Setup", "Shape"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}
__all__ = ["__version__", *sorted(_HOME_OF)]


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_HOME_OF[name]}"), name)


def __dir__() -> list[str]:
    return __all__
