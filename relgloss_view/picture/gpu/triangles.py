"""The triangles of a mesh on the device: buffers for the rasteriser, textures for surface.frag."""

from __future__ import annotations

from typing import Any

import moderngl
import numpy as np

from relgloss_view.base.arrays import AnyArray
from relgloss_view.base.errors import InputError
from relgloss_view.base.room import Need, check_room
from relgloss_view.pack.mesh import Mesh
from relgloss_view.picture.gpu.context import max_texture_size
from relgloss_view.picture.gpu.targets import bytes_of
from relgloss_view.picture.model.view import View

WIDE = 1024  #: texels of a row of a list; constant MESH_WIDE of triangles.glsl
MOST_TRIANGLES = 1 << 24  #: whole numbers that float32 holds
BYTES = 288  #: a triangle and its share of the points take, on the device and on the way


class Triangles:
    """A mesh on one OpenGL context; `release` frees it.

    Raises InputError where the device can't hold it.
    """

    def __init__(self, ctx: moderngl.Context, mesh: Mesh) -> None:
        self.mesh = mesh
        self.count = len(mesh.triangles)
        lines = -(-max(self.count, len(mesh.points_m)) // WIDE)
        if self.count > MOST_TRIANGLES or lines > max_texture_size(ctx):
            raise InputError(
                f"mesh of {self.count} triangles: this device takes at most "
                f"{min(MOST_TRIANGLES, WIDE * max_texture_size(ctx))}; use a coarser mesh"
            )
        check_room(Need(BYTES * self.count), f"a mesh of {self.count} triangles", "coarsen it")
        self._held: list[Any] = []
        try:
            self._fill(ctx, mesh)
        except BaseException:
            self.release()
            raise

    def _fill(self, ctx: moderngl.Context, mesh: Mesh) -> None:
        points = np.ascontiguousarray(mesh.points_m, dtype=np.float32)
        corners = np.ascontiguousarray(mesh.triangles, dtype=np.uint32)
        # Of each triangle on its own: a shared point can't know whose corner it is.
        self._corners = self._keep(ctx, ctx.buffer(listed(points, corners).tobytes()))
        part = np.asarray(mesh.part)[corners[:, 0]] if self.count else np.zeros(0)
        label = np.asarray(mesh.label_m)
        self.uniforms: dict[str, Any] = {
            "mesh_triangles": self._list(ctx, corners, part),
            "mesh_points": self._list(ctx, points, label[:, 0]),
            "mesh_normals": self._list(ctx, np.asarray(mesh.normals), label[:, 1]),
        }
        self._array: tuple[moderngl.Program, moderngl.VertexArray] | None = None

    def _keep(self, ctx: moderngl.Context, made: Any) -> Any:
        self._held.append(made)
        if ctx.error != "GL_NO_ERROR":
            raise InputError("the device has no memory for the mesh; use a coarser one")
        return made

    def _list(self, ctx: moderngl.Context, rows: AnyArray, last: AnyArray) -> moderngl.Texture:
        """Rows (N, 3) and a fourth number each as a texture WIDE texels wide."""
        lines = max(1, -(-len(rows) // WIDE))
        texels = np.zeros((lines * WIDE, 4), dtype=np.float32)
        texels[: len(rows), :3] = rows
        texels[: len(rows), 3] = last
        texture: moderngl.Texture = self._keep(
            ctx, ctx.texture((WIDE, lines), 4, texels.tobytes(), dtype="f4")
        )
        texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return texture

    def array(self, ctx: moderngl.Context, program: moderngl.Program) -> moderngl.VertexArray:
        """The mesh, ready to be drawn by a program of mesh.vert."""
        if self._array is None or self._array[0] is not program:
            self._drop_array()
            self._array = program, array_of(ctx, program, self._corners)
        return self._array[1]

    def _drop_array(self) -> None:
        if self._array is not None:
            self._array[1].release()
        self._array = None

    def bytes(self) -> int:
        """Bytes on the device."""
        return sum(
            bytes_of(one) if isinstance(one, moderngl.Texture) else one.size for one in self._held
        )

    def release(self) -> None:
        """Free all of it."""
        self._array = getattr(self, "_array", None)
        self._drop_array()
        for one in self._held:
            one.release()
        self._held.clear()


def array_of(
    ctx: moderngl.Context, program: moderngl.Program, corners: moderngl.Buffer
) -> moderngl.VertexArray:
    """Triangles, as `listed` has them; the caller frees it."""
    names = "first_m", "second_m", "third_m", "which"
    return ctx.vertex_array(program, [(corners, "3f 3f 3f 2f", *names)])


def listed(points: AnyArray, corners: AnyArray) -> AnyArray:
    """(T, 3, 11) float32: for each corner of a triangle all three, its number, the corner's number.

    Triangles are counted from 1, their corners from 0.
    """
    rows = np.empty((len(corners), 3, 11), dtype=np.float32)
    rows[..., :9] = points[corners].reshape(-1, 1, 9)
    rows[..., 9] = np.arange(1.0, len(corners) + 1.0)[:, None]
    rows[..., 10] = np.arange(3.0)
    return rows


def hides_backs(mesh: Mesh, view: View) -> bool:
    """Whether no triangle is seen from behind: a closed mesh hides those from an eye outside."""
    return mesh.is_closed and bool(np.any(np.abs(view.eye_m) > 1.01 * mesh.half_extent_m))


def projection(mesh: Mesh, view: View, box: tuple[float, ...], texels: int = 1) -> dict[str, Any]:
    """How mesh.vert draws a view into a target that holds a box of the picture's pixels.

    texels: of the target, along each side of a pixel.
    Depth grows from -1 to 1 over the ball around the object; where the eye is inside it, from a
    thousandth of its radius.
    """
    left, bottom, right, top = box
    width, height = right - left, top - bottom
    axes = np.stack([view.right, view.up, view.forward])
    along = axes @ view.eye_m
    distance = -float(along[2])
    radius = max(float(np.linalg.norm(mesh.half_extent_m)), 1e-6)
    near = max(distance - radius, 1e-3 * radius)
    far = max(distance + radius, 2.0 * near)
    slope = (far + near) / (far - near)
    scale = 2.0 / (view.pixel_step * np.array([width, height]))
    middle = np.array([view.size[0] - 2.0 * left, view.size[1] - 2.0 * bottom])
    shift = middle / np.array([width, height]) - 1.0 - scale * np.array(view.shift)
    return {
        "eye_axes": axes,  # columns first
        "eye_along": along,
        "target_px": texels * np.array([width, height]),
        "mesh_frame": np.concatenate([scale, shift]),
        "mesh_depth": np.array([slope, slope * distance - 2.0 * far * near / (far - near)]),
    }
