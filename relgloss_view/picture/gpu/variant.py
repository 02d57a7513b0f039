"""Variant: which shader code a picture needs: no noise where sigma_N is 0, no lobe without one."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from relgloss_view.display.display import Display
from relgloss_view.display.inverse_nodes import CURVE_CELLS
from relgloss_view.display.model import DisplayModel
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import ANALYTIC
from relgloss_view.picture import method
from relgloss_view.picture.gpu.constants import code
from relgloss_view.picture.gpu.finishes import drawn_finishes, finish_constants, finish_tables
from relgloss_view.picture.gpu.targets import written
from relgloss_view.picture.model.drawn import drawn_diffuse, drawn_facets, drawn_lobes
from relgloss_view.picture.model.lights import lamps_of
from relgloss_view.picture.model.view import from_afar
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene


@dataclass(frozen=True)
class Variant:
    """The variant of pass 1 that a scene and a look need."""

    shape: str
    diffuse: str
    lobes: int
    metals: int = 0  #: bits of the lobes that are a metal's, the first lobe's the lowest
    caps: bool = True  #: of a cylinder, which the eye may see
    afar: bool = False  #: rays begin beside the object: see view.from_afar
    noise: str = "none"
    noisy_diffuse: bool = True
    grain: str = "screen"
    sampled: bool = False  #: more than one sample a pixel
    fresnel: str = "exact"
    shadowing: str = "v-groove"
    facets: str = "gaussian"
    lamp: str = "point"
    lamps: int = 1  #: that give light, 1 to 4
    lamp_size: bool = False  #: one of them is a disc
    ambient: bool = False  #: there is light from all around
    bands: int = 0  #: drawn one by one; 0 where their spectra are folded into XYZ
    cube_root: str = "householder"
    surface: str = "met"  #: constants.SURFACES
    finishes: tuple[tuple[str, int | str], ...] = ()  #: finishes.finish_constants, of a pack
    writes: str = "weights"  #: what pass 1 writes: constants.WRITES

    @classmethod
    def of(
        cls, scene: Scene, look: Look, samples: int = 1, chosen: method.Method = method.EXACT
    ) -> Variant:
        """The smallest variant that draws this, at so many samples along a pixel's side.

        Exactly, unless the chosen method says otherwise.
        """
        if scene.pack is not None:
            return cls._of_pack(scene, scene.pack, look, samples, chosen)
        drawn = drawn_lobes(scene.material, chosen)
        lobes = len(drawn)
        grainy = look.sigma_n_deg > 0.0 and chosen.noise not in ("mean", "none")
        needed = cls(
            **_met(scene),
            diffuse=drawn_diffuse(scene.material, chosen),
            lobes=lobes,
            metals=sum(1 << k for k, lobe in enumerate(drawn) if lobe.is_metal),
            sampled=samples > 1,
            fresnel=chosen.fresnel if not all(lobe.is_metal for lobe in drawn) else "exact",
            shadowing=chosen.shadowing if lobes else "v-groove",
            facets=drawn_facets(look, chosen) if lobes else "gaussian",
            lamp=chosen.lamp,
            writes=_written(chosen, samples, xyz=scene.lamp.ambient > 0.0),
        )
        if grainy:
            needed = dataclasses.replace(
                needed,
                noise=look.noise_law,
                noisy_diffuse=look.noisy_lobes == "both" and chosen.noise == "drawn",
                grain=look.grain,
            )
        forced: dict[str, Any] = dict(chosen.variant)
        return dataclasses.replace(needed, **forced)

    @classmethod
    def _of_pack(
        cls, scene: Scene, pack: Pack, look: Look, samples: int, chosen: method.Method
    ) -> Variant:
        finishes = drawn_finishes(pack, look, chosen)
        constants = finish_constants(finishes)
        tilted = any(drawn.sigma_n > 0.0 for drawn in finishes)
        grainy = tilted and chosen.noise not in ("mean", "none")
        blurred = tilted and chosen.noise == "mean" and chosen.facets == "gaussian"
        tables = finish_tables(pack, look, chosen, scene.lamp.illuminant, blurred)
        needed = cls(
            **_met(scene),
            diffuse=finishes[0].diffuse or "lambert",  # each finish has its own
            lobes=constants.pop("LOBES"),
            sampled=samples > 1,
            fresnel=chosen.fresnel,
            shadowing=chosen.shadowing,
            facets="mean-gaussian" if blurred else chosen.facets,
            lamp=chosen.lamp,
            noise=look.noise_law if grainy else "none",
            noisy_diffuse=look.noisy_lobes == "both" and chosen.noise == "drawn",
            grain=look.grain if grainy else "screen",
            finishes=(*constants.items(), *tables.items()),
            writes=_written(chosen, samples, xyz=True),
        )
        forced: dict[str, Any] = dict(chosen.variant)
        return dataclasses.replace(needed, **forced)

    @property
    def reads_field(self) -> bool:
        """Whether the grain's tilts come from a field that is drawn before."""
        return self.noise != "none" and self.grain == "eye"

    @property
    def splits(self) -> bool:
        """Whether pass 1 splits L* itself."""
        return "split" in self.writes

    @property
    def targets(self) -> tuple[str, ...]:
        """The targets of pass 1."""
        return written(self.writes, self.metals)

    def writing(self, writes: str) -> Variant:
        """The same, with other numbers in its targets."""
        return dataclasses.replace(self, writes=writes)

    def defines(self) -> dict[str, int | str]:
        """The constants of the shader variant."""
        return {
            **self.shape_defines(),
            "DIFFUSE": code("DIFFUSE", self.diffuse),
            "LOBES": self.lobes,
            "METALS": self.metals,
            "NOISE": code("NOISE", self.noise),
            "NOISY_DIFFUSE": int(self.noisy_diffuse),
            "GRAIN": code("GRAIN", self.grain),
            "SAMPLED": int(self.sampled),
            "FRESNEL": code("FRESNEL", self.fresnel),
            "SHADOWING": code("SHADOWING", self.shadowing),
            "FACETS": code("FACETS", self.facets),
            **self.lamp_defines(),
            "AMBIENT": int(self.ambient),
            "BANDS": self.bands,
            "CUBE_ROOT": code("CUBE_ROOT", self.cube_root),
            "WRITES": code("WRITES", self.writes),
            **self._read_defines(),
        }

    def _read_defines(self) -> dict[str, int | str]:
        """The constants of what reads a surface; none where rays meet it."""
        if self.surface == "met":
            return {}
        return {"SURFACE": code("SURFACE", self.surface), **dict(self.finishes)}

    def shape_defines(self) -> dict[str, int]:
        """The constants of what meets the object."""
        return {
            "SHAPE": code("SHAPE", self.shape),
            "CAPS": int(self.caps),
            "AFAR": int(self.afar),
        }

    def surface_defines(self) -> dict[str, int | str]:
        """The constants of the pass that draws the surface which is read."""
        ink = {name: value for name, value in self.finishes if name == "INK_SECOND"}
        return {**self.shape_defines(), **ink}

    def split_defines(self) -> dict[str, int | str]:
        """The constants of the pass that splits what pass 1 wrote."""
        names = ("WRITES", "LOBES", "METALS", "BANDS", "CUBE_ROOT", "FINISHES")
        return {name: value for name, value in self.defines().items() if name in names}

    def white_defines(self) -> dict[str, int]:
        """The constants of the pass that draws the perfect diffuser, for Y_n."""
        return {
            **self.shape_defines(),
            "SAMPLED": int(self.sampled),
            **self.lamp_defines(),
        }

    def lamp_defines(self) -> dict[str, int]:
        """The constants of the lamps."""
        return {
            "LAMP": code("LAMP", self.lamp),
            "LAMPS": self.lamps,
            "LAMP_SIZE": int(self.lamp_size),
            **({} if self.surface == "met" else {"SURFACE": code("SURFACE", self.surface)}),
        }

    def field_defines(self) -> dict[str, int]:
        """The constants of the pass that draws the field of the grain's tilts."""
        return {"NOISE": code("NOISE", self.noise)}

    def geometry_defines(self) -> dict[str, int | str]:
        """The constants of the pass that draws normals and points."""
        defines = {k: self.defines()[k] for k in ("SHAPE", "CAPS", "AFAR", "NOISE", "GRAIN")}
        if self.surface != "met":
            defines |= {**self._read_defines(), "SAMPLED": int(self.sampled)}
        return defines


def _met(scene: Scene) -> dict[str, Any]:
    """How the object is met and lit: the entries of a Variant for its shape and the lamps."""
    lit = {
        "lamps": len(lamps_of(scene.setup)),
        "lamp_size": any(lamp.radius_m > 0.0 for lamp in lamps_of(scene.setup)),
        "ambient": scene.lamp.ambient > 0.0,
    }
    if scene.shape.kind not in ANALYTIC:
        # Rays to triangles begin beside the object, which keeps the digits of small ones.
        return {"shape": "triangles", "caps": False, "afar": True, "surface": "read", **lit}
    return {
        "shape": scene.shape.kind,
        "caps": _sees_a_cap(scene),
        "afar": from_afar(scene.shape, scene.eye),
        "surface": "met" if scene.pack is None else "read",
        **lit,
    }


def _written(chosen: method.Method, samples: int, *, xyz: bool) -> str:
    """What pass 1 writes. XYZ holds the share of a pixel that several samples cover.

    xyz: the weights of one material's shapes are not enough, as where its lobes reflect the
    surround into the diffuse picture.
    """
    # Half floats hold what is split: XYZ would be rounded before its difference is taken.
    if chosen.split == method.FIRST_PASS or chosen.targets == "float16":
        return "split" if samples == 1 else "xyz and split"
    return "weights" if samples == 1 and not xyz else "xyz"


def _sees_a_cap(scene: Scene) -> bool:
    """Whether the eye is above or below a cylinder; compared as the shader would."""
    eye, half = scene.eye.position_m[1], scene.shape.half_extent_m()[1]
    return scene.shape.kind == "cylinder" and bool(np.float32(abs(eye)) > np.float32(half))


def tone_defines(
    display: Display, stage: str, samples: int = 1, chosen: method.Method = method.EXACT
) -> dict[str, int | str]:
    """The constants of a stage that shows colours."""
    gamut = display.gamut if chosen.gamut == "as asked" else chosen.gamut
    defines: dict[str, int | str] = {"GAMUT": code("GAMUT", gamut)}
    if stage != "light.frag":  # which is linear
        model = DisplayModel.of(display)
        screen = model.screen or model
        defines["TRANSFER"] = code("TRANSFER", screen.transfer)
        defines["SEEN_ON"] = int(model.screen is not None)
        if screen.transfer == "curves":
            defines["CURVE_CELLS"] = f"{CURVE_CELLS}.0"
    if stage not in ("overlay.frag", "edge.frag"):
        defines["SAMPLED"] = int(samples > 1)
    if stage in ("tone.frag", "edge.frag"):
        defines["DITHER"] = code("DITHER", display.dither)
    return defines
