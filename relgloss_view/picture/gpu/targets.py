"""The targets of the passes: made once a size, checked, cleared where a pass does not reach."""

from __future__ import annotations

from collections.abc import Iterable

import moderngl
import numpy as np

from relgloss_view.base.arrays import AnyArray, Array
from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.interruptions import checkpoint
from relgloss_view.picture.frame import Extremes
from relgloss_view.picture.gpu.context import max_texture_size
from relgloss_view.picture.model.tone import OFF_OBJECT
from relgloss_view.picture.model.view import Size
from relgloss_view.picture.peak import check_memory

WEIGHTS = ("diffuse_weights", "specular_weights")
#: Where a lobe is a metal's, which has two weights.
METAL_WEIGHTS = ("diffuse_weights", "metal_weights")
XYZ = ("diffuse", "specular")
SPLIT = ("split",)
#: The targets of pass 1, by what it writes: constants.WRITES.
WRITTEN = {"weights": WEIGHTS, "xyz": XYZ, "split": SPLIT, "xyz and split": (*XYZ, *SPLIT)}


def written(writes: str, metals: int) -> tuple[str, ...]:
    """The targets of pass 1, by what it writes and whether a lobe is a metal's."""
    return METAL_WEIGHTS if writes == "weights" and metals else WRITTEN[writes]


TONE = ("display",)
LIGHT = ("light", "lab")
GEOMETRY = ("normal", "tilted_normal", "point_m")
OVERLAY = ("overlay",)
GRAIN_FIELD = ("grain_field",)  #: of a size of its own
COVERAGE = ("coverage",)
TRIANGLE = ("triangle",)  #: drawn with a depth buffer
MASK = ("mask",)  #: of a mesh at half pixels
SHARES_A_TARGET = 4


def surface_targets(finishes: int) -> tuple[str, ...]:
    """What surface.frag writes for so many finishes; 0: one material."""
    names: tuple[str, ...] = ("surface_point", "surface_normal")
    if finishes:
        count = -(-2 * finishes // SHARES_A_TARGET)
        names = (*names, "paint_image", "second_image", *(f"shares_{k}" for k in range(count)))
    return names


LARGEST_HALF = 65504.0
LARGEST_WHITE = 1.5  #: no white's X or Z is larger beside a Y of one
TABLE_STEPS = 256  #: as in cube_root.glsl
#: What says that a pixel shows nothing of the object, for a pass that draws inside its bounds only.
CLEARED = {
    "diffuse": (0.0, 0.0, 0.0, 0.0),
    "specular": (0.0, 0.0, 0.0, 0.0),
    "diffuse_weights": (OFF_OBJECT, 0.0, 0.0, 0.0),
    "specular_weights": (0.0, 0.0, 0.0, 0.0),
    "metal_weights": (0.0, 0.0, 0.0, 0.0),
    "split": (OFF_OBJECT, 0.0, 0.0, 0.0),
    "coverage": (0.0, 0.0, 0.0, 0.0),
    "normal": (0.0, 0.0, 0.0, 0.0),
    "tilted_normal": (0.0, 0.0, 0.0, 0.0),
    "point_m": (0.0, 0.0, 0.0, 0.0),
}
#: The targets that hold 8-bit numbers; the others hold floats.
EIGHT_BIT = ("display", "overlay", "coverage", "mask")


def components(name: str) -> int:
    """Numbers a pixel of a target."""
    if name in (*COVERAGE, *TRIANGLE, *MASK):
        return 1
    return 2 if name in (*WEIGHTS, *GRAIN_FIELD) else 4


def bytes_per_pixel(name: str) -> int:
    """Bytes of a target for each pixel, of float32 or 8-bit numbers."""
    return components(name) * (1 if name in EIGHT_BIT else 4)


def bytes_of(texture: moderngl.Texture) -> int:
    """Bytes of a texture's pixels."""
    each = {"f1": 1, "f2": 2}.get(texture.dtype, 4)
    return texture.width * texture.height * texture.components * each


class Targets:
    """The textures that passes write and read, all of one size, and framebuffers over them."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.size: Size | None = None
        self.numbers = "float32"  #: of the split
        self._textures: dict[str, moderngl.Texture] = {}
        self._framebuffers: dict[tuple[str, ...], moderngl.Framebuffer] = {}
        self._table: moderngl.Texture | None = None
        self._depth_buffer: moderngl.Renderbuffer | None = None
        self._albedos: moderngl.Texture | None = None
        self._albedo_rows = b""
        # Bound while others are freed: a bound framebuffer can't be freed where no screen exists.
        self._parking = ctx.framebuffer([ctx.texture((1, 1), 4)])

    def resize(self, size: Size, numbers: str = "float32") -> bool:
        """Make room for pictures of a size; returns whether everything drawn so far is gone.

        Raises InputError where the device can't hold it, and holds nothing then.
        """
        if (size, numbers) == (self.size, self.numbers):
            return False
        limit = max_texture_size(self.ctx)
        if max(size) > limit:
            raise InputError(
                f"size {size[0]}x{size[1]}: this device draws at most {limit} pixels a side; "
                "give a smaller --size or --backend reference"
            )
        self.release()
        self.size, self.numbers = size, numbers
        try:
            self.framebuffer(SPLIT)
        except BaseException:  # whatever went wrong, nothing half made is kept
            self.release()
            raise
        return True

    def check_fits(self, extremes: Extremes) -> None:
        """InputError where what was drawn passes the largest number of the targets."""
        brightest = (extremes.brightest_l_d + extremes.brightest_l_s + 16.0) / 116.0
        if self.numbers == "float16" and not brightest**3 * LARGEST_WHITE < LARGEST_HALF:
            raise InputError(
                f"targets float16: the highlight is {brightest**3:.3g} times as bright as the "
                f"white, and they hold {LARGEST_HALF:g} at most; draw with float32"
            )

    def names(self) -> list[int]:
        """OpenGL's names of the textures."""
        return [int(texture.glo) for texture in self._textures.values()]

    def texture(self, name: str) -> moderngl.Texture:
        """The texture of a target that has been drawn."""
        return self._textures[name]

    def framebuffer(self, names: tuple[str, ...], depth: bool = False) -> moderngl.Framebuffer:
        """What a pass that writes these targets draws into; made when first asked for.

        depth: with a depth buffer, which all such framebuffers share.
        """
        key = (*names, *(("depth",) if depth else ()))
        if key not in self._framebuffers:
            assert self.size is not None
            made: dict[str, moderngl.Texture] = {}
            try:
                for name in names:
                    if name not in self._textures:
                        made[name] = self._texture(self.size, name)
                textures = self._textures | made
                self._framebuffers[key] = self.ctx.framebuffer(
                    [textures[name] for name in names], self._depth(self.size) if depth else None
                )
            except BaseException:
                for texture in made.values():
                    texture.release()
                raise
            self._textures |= made
        return self._framebuffers[key]

    def grain_field(self, size: Size) -> moderngl.Framebuffer:
        """What the field of the grain's tilts is drawn into, of a size of its own."""
        (name,) = GRAIN_FIELD
        held = self._textures.get(name)
        if held is not None and held.size != size:
            self._parking.use()
            self._framebuffers.pop(GRAIN_FIELD).release()
            self._textures.pop(name).release()
        if name not in self._textures:
            texture = self._texture(size, name)
            self._framebuffers[GRAIN_FIELD] = self.ctx.framebuffer([texture])
            self._textures[name] = texture
        return self._framebuffers[GRAIN_FIELD]

    def read(self, name: str, rows: slice | None = None) -> AnyArray:
        """A target's contents, (rows, W, components), rows from the top; all of them by default."""
        checkpoint()
        texture = self._textures[name]
        first, last = (0, texture.height) if rows is None else (rows.start, rows.stop)
        check_memory((texture.width, last - first), bytes_per_pixel(name))
        if last - first == texture.height:
            data = texture.read(alignment=1)
        else:
            box = (0, texture.height - last, texture.width, last - first)
            data = self.framebuffer((name,)).read(
                box, components=texture.components, alignment=1, dtype=texture.dtype
            )
        if self.ctx.error != "GL_NO_ERROR":
            raise RelglossError(f"{name}: the device failed while the picture was read back")
        kind = {"f1": np.uint8, "f2": np.float16}.get(texture.dtype, np.float32)
        shape = (last - first, texture.width, texture.components)
        return np.frombuffer(data, dtype=kind).reshape(shape)[::-1]

    def cube_root_table(self) -> moderngl.Texture:
        """Cube roots from 1 to 8, each with the next one, for the method that looks them up."""
        if self._table is None:
            roots = np.cbrt(np.linspace(1.0, 8.0, TABLE_STEPS + 1))
            pairs = np.stack([roots, np.append(roots[1:], roots[-1])], axis=-1).astype(np.float32)
            self._table = self.ctx.texture((len(pairs), 1), 2, pairs.tobytes(), dtype="f4")
            self._table.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return self._table

    def albedo_table(self, rows: Array | None) -> dict[str, moderngl.Texture]:
        """The table of ambient.glsl, (rows, entries, 4) float32, as the texture that it reads.

        Empty where there are no rows. The texture is kept until other rows come.
        """
        if rows is None:
            return {}
        data = rows.tobytes()
        if self._albedo_rows != data:
            if self._albedos is not None:
                self._albedos.release()
            size = (rows.shape[1], rows.shape[0])
            self._albedos = self.ctx.texture(size, 4, data, dtype="f4")
            self._albedos.filter = (moderngl.NEAREST, moderngl.NEAREST)
            self._albedo_rows = data
        assert self._albedos is not None
        return {"albedo_table": self._albedos}

    def held(self) -> tuple[str, ...]:
        """The names of the targets that there are."""
        return tuple(self._textures)

    def drop(self, names: Iterable[str]) -> int:
        """Free some targets, where there are any; returns their bytes."""
        names, freed = set(names), 0
        for group in [g for g in self._framebuffers if names & set(g)]:
            self._parking.use()
            self._framebuffers.pop(group).release()
        for name in names:
            texture = self._textures.pop(name, None)
            if texture is not None:
                freed += bytes_of(texture)
                texture.release()
        return freed

    def bytes(self) -> int:
        """Bytes of all the targets."""
        return sum(bytes_of(texture) for texture in self._textures.values())

    def _depth(self, size: Size) -> moderngl.Renderbuffer:
        """The depth buffer of those that have one."""
        if self._depth_buffer is None:
            check_memory(size, 4)
            self._depth_buffer = self.ctx.depth_renderbuffer(size)
            if self.ctx.error != "GL_NO_ERROR":
                raise InputError(f"size {size[0]}x{size[1]}: the device has no memory for it")
        return self._depth_buffer

    def release(self) -> None:
        """Free everything that a size needs."""
        self._parking.use()
        for framebuffer in self._framebuffers.values():
            framebuffer.release()
        for texture in self._textures.values():
            texture.release()
        if self._depth_buffer is not None:
            self._depth_buffer.release()
        self._depth_buffer = None
        self._framebuffers.clear()
        self._textures.clear()
        self.size = None

    def _texture(self, size: Size, name: str) -> moderngl.Texture:
        refused = InputError(
            f"size {size[0]}x{size[1]}: the device has no memory for it; give a smaller --size"
        )
        check_memory(size, bytes_per_pixel(name))  # drivers crash where they get none
        dtype = "f1" if name in EIGHT_BIT else "f4"
        if name in SPLIT and self.numbers == "float16":
            dtype = "f2"
        try:
            texture = self.ctx.texture(size, components(name), dtype=dtype)
        except moderngl.Error as error:
            raise refused from error
        if self.ctx.error != "GL_NO_ERROR":  # moderngl itself raises on few of these
            texture.release()
            raise refused
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture
