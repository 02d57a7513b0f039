"""Renderer: a scene and a look become a Frame on the GPU, for window, files and tests alike."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from relgloss_view.errors import InputError, RelglossError
from relgloss_view.material import brdf
from relgloss_view.material.spectra import illuminant, xyz_weights
from relgloss_view.picture.context import max_texture_size
from relgloss_view.picture.frame import Extremes, Frame, Scaling
from relgloss_view.picture.plan import TRANSFER_CODES, Plan
from relgloss_view.picture.programs import Programs, Uniforms
from relgloss_view.picture.scene import Look, Scene
from relgloss_view.picture.tone import DisplayModel
from relgloss_view.picture.view import Size, View, check_size

BLOCK = 16  #: side of the tiles of the reduction
#: Name of each target: components and moderngl's dtype.
TARGETS = {
    "diffuse": (4, "f4"),
    "specular": (4, "f4"),
    "display": (4, "f1"),
    "light": (4, "f4"),
    "lab": (4, "f4"),
    "normal": (4, "f4"),
    "tilted_normal": (4, "f4"),
    "point_m": (4, "f4"),
}
SHADE, TONE, GEOMETRY = TARGETS_OF_PASS = (
    ("diffuse", "specular"),
    ("display", "light", "lab"),
    ("normal", "tilted_normal", "point_m"),
)


@dataclass(frozen=True)
class _Request:
    """What a frame was asked to be; passes are drawn again only where their part of it changes."""

    scene: Scene
    look: Look
    size: Size

    def white_key(self) -> object:
        scene = self.scene
        return (scene.shape, _place(scene), scene.eye, self.look.samples, self.size)

    def shade_key(self) -> object:
        look = dataclasses.replace(self.look, c=None, c_fraction=None)
        scene = self.scene
        return (scene.material, scene.shape, scene.lamp, scene.eye, look, self.size)


def _place(scene: Scene) -> tuple[float, float, float]:
    lamp = scene.lamp
    return (lamp.azimuth_deg, lamp.elevation_deg, lamp.distance_m)


class Renderer:
    """Draws frames on one OpenGL context; keeps programs, targets and the passes still valid.

    `draws` counts the passes drawn so far by name, for those who check what is drawn again.
    """

    def __init__(self, ctx: moderngl.Context, programs: Programs | None = None) -> None:
        self.ctx = ctx
        self.programs = programs or Programs(ctx)
        self.draws = dict.fromkeys(("white", "shade", "measure", "tone", "geometry"), 0)
        self._size: Size | None = None
        self._textures: dict[str, moderngl.Texture] = {}
        self._framebuffers: dict[tuple[str, ...], moderngl.Framebuffer] = {}
        self._reduction: list[tuple[list[moderngl.Texture], moderngl.Framebuffer]] = []
        # Bound while others are freed: a bound framebuffer can't be freed where no screen exists.
        self._parking = ctx.framebuffer([ctx.texture((1, 1), 4)])
        self._done: dict[str, object] = {}
        self._white = 0.0
        self._extremes = Extremes.of_nothing()

    def prepare(self, scene: Scene, look: Look) -> None:
        """Compile every variant that sliders of this scene and look can reach without a pause."""
        for sigma_n_deg in (0.0, max(look.sigma_n_deg, 1.0)):
            variant = dataclasses.replace(look, sigma_n_deg=sigma_n_deg)
            self.programs.get("shade.frag", Plan.of(scene, variant).defines())
        self.programs.get("shade.frag", Plan.of_perfect_diffuser(scene, look).defines())
        for name in ("measure.frag", "reduce.frag"):
            self.programs.get(name, {"BLOCK": BLOCK})
        self.programs.get("tone.frag", {"TRANSFER": TRANSFER_CODES[scene.display.transfer]})

    def render(self, scene: Scene, look: Look, size: Size) -> Frame:
        """Draw a scene. Raises InputError for a size or a material that can't be drawn."""
        request = _Request(scene, look, check_size(size))
        scaling = self._bring_up_to_date(request)
        warnings = []
        if scene.shape.contains(scene.eye.position_m):
            warnings.append("the eye is inside the object: nothing is seen")
        elif self._white <= 0.0:
            warnings.append("the lamp lights nothing that the eye sees: the object is black")
        return Frame(
            scene,
            look,
            size,
            scaling,
            partial(self._fetch, request),
            str(self.ctx.info["GL_RENDERER"]),
            tuple(warnings),
        )

    def release(self) -> None:
        """Free the targets; frames whose stages were not fetched are drawn again when asked."""
        self._parking.use()
        for framebuffer in [*self._framebuffers.values(), *(f for _, f in self._reduction)]:
            framebuffer.release()
        for texture in [*self._textures.values(), *(t for ts, _ in self._reduction for t in ts)]:
            texture.release()
        self._framebuffers.clear()
        self._textures.clear()
        self._reduction.clear()
        self._done.clear()
        self._size = None

    # --- passes -----------------------------------------------------------------------------------

    def _bring_up_to_date(self, request: _Request) -> Scaling:
        self._resize(request.size)
        view = View.of(request.scene, request.size)
        shade_key = request.shade_key()
        if self._done.get("shade") != shade_key:
            self._done.pop("tone", None)
            self._done.pop("geometry", None)
            if self._done.get("white") != request.white_key():
                self._white = self._draw_white(request, view)
                self._done["white"] = request.white_key()
            self._draw_shade(request, view)
            self._extremes = self._measure()[0]
            self._done["shade"] = shade_key
        scaling = Scaling.of(request.look, self._extremes)
        tone_key = (scaling.c, request.scene.display)
        if self._done.get("tone") != tone_key:
            self._draw_tone(request, scaling.c)
            self._done["tone"] = tone_key
        return scaling

    def _draw_white(self, request: _Request, view: View) -> float:
        """The largest Y of the perfect diffuser in the object's place, lamp power free."""
        plan = Plan.of_perfect_diffuser(request.scene, request.look)
        uniforms = {
            **_view_uniforms(view, request),
            "irradiance": np.pi,
            "albedo_xyz": (1.0, 1.0, 1.0),
            "second_albedo_xyz": (0.0, 0.0, 0.0),
        }
        self._draw("white", "shade.frag", plan.defines(), uniforms, SHADE)
        return self._measure()[1]

    def _draw_shade(self, request: _Request, view: View) -> None:
        irradiance = np.pi / self._white if self._white > 0.0 else 0.0
        uniforms = {
            **_view_uniforms(view, request),
            **_grain_uniforms(request.look),
            **material_uniforms(request.scene),
            "irradiance": irradiance,
        }
        plan = Plan.of(request.scene, request.look)
        self._draw("shade", "shade.frag", plan.defines(), uniforms, SHADE)

    def _draw_geometry(self, request: _Request) -> None:
        plan = Plan.of(request.scene, request.look).defines()
        uniforms = {
            **_view_uniforms(View.of(request.scene, request.size), request),
            **_grain_uniforms(request.look),
        }
        defines = {name: plan[name] for name in ("SHAPE", "NOISE", "GRAIN")}
        self._draw("geometry", "geometry.frag", defines, uniforms, GEOMETRY)

    def _draw_tone(self, request: _Request, c: float) -> None:
        display = DisplayModel.of(request.scene.display)
        uniforms = {
            "diffuse_image": self._textures["diffuse"],
            "specular_image": self._textures["specular"],
            "white": illuminant(request.scene.lamp.illuminant).white_xyz(),
            "c": c,
            "display_white": display.white,
            "rgb_from_xyz": display.rgb_from_xyz.T,  # columns first
            "display_curve": display.curve,
            "background_light": display.background_light,
        }
        defines = {"TRANSFER": TRANSFER_CODES[display.transfer]}
        self._draw("tone", "tone.frag", defines, uniforms, TONE)

    def _measure(self) -> tuple[Extremes, float]:
        """Reduce pass 1 to its extremes and the largest Y of its diffuse target."""
        self.draws["measure"] += 1
        images = {name: self._textures[name] for name in SHADE}
        for step, (textures, target) in enumerate(self._reduction):
            stage = "reduce.frag" if step else "measure.frag"
            uniforms = {f"{name}_image": texture for name, texture in images.items()}
            self.programs.draw(stage, {"BLOCK": BLOCK}, uniforms, target)
            images = dict(zip(("extremes", "brightest"), textures, strict=True))
        ratio, l_d_max, l_s_max, y_max = _values(images["extremes"])
        total, l_d, l_s, not_finite = _values(images["brightest"])
        if total < -1e29 and not not_finite:
            return Extremes.of_nothing(), 0.0
        return Extremes(ratio, l_d_max, l_s_max, l_d, l_s, int(not_finite)), y_max

    # --- targets ----------------------------------------------------------------------------------

    def _resize(self, size: Size) -> None:
        if size == self._size:
            return
        limit = max_texture_size(self.ctx)
        if max(size) > limit:
            raise InputError(
                f"size {size[0]}x{size[1]}: this device draws at most {limit} pixels a side; "
                "give a smaller --size or --backend reference"
            )
        self.release()
        self._size = size
        self._target(SHADE)
        while not self._reduction or size != (1, 1):
            size = (-(-size[0] // BLOCK), -(-size[1] // BLOCK))
            textures = [self._texture(size, 4, "f4") for _ in range(2)]
            self._reduction.append((textures, self.ctx.framebuffer(textures)))

    def _target(self, names: tuple[str, ...]) -> moderngl.Framebuffer:
        if names not in self._framebuffers:
            assert self._size is not None
            for name in names:
                self._textures[name] = self._texture(self._size, *TARGETS[name])
            self._framebuffers[names] = self.ctx.framebuffer([self._textures[n] for n in names])
        return self._framebuffers[names]

    def _texture(self, size: Size, components: int, dtype: str) -> moderngl.Texture:
        texture = self.ctx.texture(size, components, dtype=dtype)
        if self.ctx.error != "GL_NO_ERROR":  # moderngl itself never raises on these
            texture.release()
            raise InputError(
                f"size {size[0]}x{size[1]}: the device has no memory for it; give a smaller --size"
            )
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture

    def _draw(
        self,
        name: str,
        stage: str,
        defines: Mapping[str, int],
        uniforms: Uniforms,
        targets: tuple[str, ...],
    ) -> None:
        self.programs.draw(stage, defines, uniforms, self._target(targets))
        self.draws[name] += 1

    def _fetch(self, request: _Request, stage: str) -> NDArray[Any]:
        """One stage of a frame, rows from the top; draws again what has been drawn over since."""
        self._bring_up_to_date(request)
        if stage in GEOMETRY and "geometry" not in self._done:
            self._draw_geometry(request)
            self._done["geometry"] = True
        components, dtype = TARGETS[stage]
        width, height = request.size
        data = self._textures[stage].read(alignment=1)
        if self.ctx.error != "GL_NO_ERROR":
            raise RelglossError(f"{stage}: the device failed while the picture was read back")
        kind = np.uint8 if dtype == "f1" else np.float32
        return np.frombuffer(data, dtype=kind).reshape(height, width, components)[::-1]


def _values(texture: moderngl.Texture) -> list[float]:
    """The four numbers of a 1 x 1 float texture."""
    return [float(v) for v in np.frombuffer(texture.read(), dtype=np.float32)]


def _view_uniforms(view: View, request: _Request) -> Uniforms:
    return {
        "eye_m": view.eye_m,
        "view_right": view.right,
        "view_up": view.up,
        "view_forward": view.forward,
        "pixel_step": view.pixel_step,
        "size_px": view.size,
        "half_extent_m": request.scene.shape.half_extent_m(),
        "lamp_m": request.scene.lamp.position_m,
    }


def _grain_uniforms(look: Look) -> Uniforms:
    return {
        "sigma_n": np.radians(look.sigma_n_deg),
        "grain_px": look.grain_px,
        "grain_m": look.grain_mm * 1e-3,
        "seed": look.seed,
    }


def material_uniforms(scene: Scene) -> Uniforms:
    """The material's spectra folded into XYZ under the scene's lamp, and its lobes' shapes."""
    material = scene.material
    weights = xyz_weights(material.bands, illuminant(scene.lamp.illuminant))
    strength, shape = np.zeros((2, 3)), np.zeros((2, 3))
    visible = [lobe for lobe in material.specular if any(lobe.strength)]
    for k, lobe in enumerate(visible):
        strength[k] = lobe.per_band(material.bands.count) @ weights
        shape[k] = (lobe.s, brdf.facet_amplitude(lobe.s), lobe.refractive_index)
    return {
        "albedo_xyz": np.asarray(material.diffuse.albedo) @ weights,
        "second_albedo_xyz": material.second_albedo() @ weights,
        "diffuse_sigma": material.diffuse.sigma,
        "lobe_strength_xyz": strength,
        "lobe_shape": shape,
    }
