"""Time packs and meshes against the plain cylinder of the same coverage, in turns inside one run.

    python scripts/pack_speed.py [--rounds N]

Prints a table: what is drawn, milliseconds (median) on the wall and of all processors together, and
their ratios to the plain cylinder; on a busy machine the second ratio says more. A frame is one
whole picture whose shown part changes: its lamp, its eye, a finish's k or sigma_N.
"""

from __future__ import annotations

import argparse
import dataclasses
import statistics
import time
from collections.abc import Callable
from functools import partial

import numpy as np

from relgloss_view import Look, Scene, load_sample, open_renderer
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.label import label_of
from relgloss_view.pack.mesh import Mesh
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.scene.setup import Eye, Lamp
from relgloss_view.quality.planner import MethodChooser

SIZE, PANE = (1280, 720), (640, 640)
TEXELS = 4096


def artwork_of(shape: Shape) -> Artwork:
    """An artwork of fine print, TEXELS x TEXELS, with a plate of spots."""
    y, x = np.mgrid[0:TEXELS, 0:TEXELS]
    dark = ((x // 7 + y // 5) % 3 == 0) & ((x // 512 + y // 512) % 2 == 0)
    xyz = np.where(dark[..., None], 0.05, np.array([0.8, 0.82, 0.6])).astype(np.float16)
    plate = ((((x - 512) % 1024 - 512) ** 2 + ((y - 512) % 1024 - 512) ** 2) < 300**2) * 255
    width, height = label_of(shape).size_m
    return Artwork(xyz, 1e3 * width, 1e3 * height, plates={"Gloss": plate.astype(np.uint8)})


def pack_of(shape: Shape) -> Pack:
    """An ink and a spot varnish."""
    ink = Finish("ink", "ink", load_sample("matte-coated"))
    spot = Finish("spot", "varnish", load_sample("art-coated"), mask="plate:Gloss", sigma_n_deg=0.5)
    return Pack("timed", shape, (ink, spot), artwork_of(shape))


def fine_cylinder(triangles: int) -> Mesh:
    """A cylinder of about so many triangles."""
    rows = round((triangles / 8.0) ** 0.5)
    columns = 4 * rows
    turn = np.linspace(-np.pi, np.pi, columns + 1)
    height = np.linspace(-0.05, 0.05, rows + 1)
    angle, up = (v.ravel() for v in np.meshgrid(turn, height))
    normals = np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    points = 0.0425 * normals
    points[:, 1] = up
    corner = np.arange(rows * (columns + 1)).reshape(rows, -1)[:, :-1].ravel()
    above = corner + columns + 1
    faces = np.stack([corner, corner + 1, above + 1, corner, above + 1, above], axis=-1)
    return Mesh(
        points_m=points,
        normals=normals,
        label_m=np.stack([angle * 0.0425, up], axis=-1),
        part=np.zeros(len(points), dtype=np.int64),
        triangles=faces.reshape(-1, 3),
        label_size_m=(2.0 * np.pi * 0.0425, 0.1),
        around=True,
    )


def coverage(renderer: Renderer, scene: Scene, look: Look) -> float:
    """Share of the picture that the object covers."""
    frame = renderer.render(scene, look, SIZE)
    return frame.object_pixels / (SIZE[0] * SIZE[1])


def framed(renderer: Renderer, scene: Scene, look: Look, share: float) -> Scene:
    """The scene with an angle of view at which the object covers a share of the picture."""
    degrees = 10.0
    for _ in range(8):
        placed = scene.placed(eye=Eye(field_of_view_deg=degrees))
        degrees = min(degrees * (coverage(renderer, placed, look) / share) ** 0.5, 100.0)
    return scene.placed(eye=Eye(field_of_view_deg=degrees))


def moved(scene: Scene, k: int, what: str) -> Scene:
    """The scene with its lamp, its eye, or a finish's k or sigma_N changed a little."""
    if what == "lamp":
        return scene.placed(lamp=Lamp(azimuth_deg=40.0 + 0.05 * k))
    if what == "eye":
        return scene.placed(eye=dataclasses.replace(scene.eye, azimuth_deg=0.05 * k))
    assert scene.pack is not None
    entry = {what: 0.5 + 0.003 * k}
    return Scene(scene.material, scene.setup, pack=scene.pack.with_finish("spot", **entry))


class Times:
    """Milliseconds of frames, by name: on the wall, and of all processors together."""

    def __init__(self) -> None:
        self.wall: dict[str, list[float]] = {}
        self.busy: dict[str, list[float]] = {}

    def add(self, name: str, draw: Callable[[], object], renderer: Renderer) -> None:
        """Draw once and note how long it took."""
        wall, busy = time.perf_counter(), time.process_time()
        draw()
        renderer.ctx.finish()
        self.wall.setdefault(name, []).append(1e3 * (time.perf_counter() - wall))
        self.busy.setdefault(name, []).append(1e3 * (time.process_time() - busy))

    def print(self) -> None:
        """A row of medians for each name, with ratios to the plain cylinder's."""
        print(f"{'':32s} {'wall ms':>8s} {'ratio':>6s} {'busy ms':>8s} {'ratio':>6s}")
        for name in self.wall:
            cells = ""
            for times in (self.wall, self.busy):
                lead = "eye" if "eye" in name else "lamp"
                base = statistics.median(times[f"plain cylinder, {lead} moves"])
                median = statistics.median(times[name])
                cells += f" {median:8.1f} {median / base:6.2f}"
            print(f"{name:32s}{cells}")


def main() -> None:
    """Time all rows in turns and print them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    look = Look(sigma_n_deg=1.0, c=0.5, quality="auto", samples=1)
    with open_renderer() as renderer:
        if not isinstance(renderer, Renderer):
            raise SystemExit("there is no OpenGL here")
        plain = Scene(load_sample("matte-coated"))
        share = coverage(renderer, plain, look)
        can = Scene(load_sample("matte-coated"), pack=pack_of(Shape("can")))
        packed = framed(renderer, can, look, share)
        meshed = Scene(load_sample("matte-coated"), shape=Shape("mesh", file="fine"))
        chooser = MethodChooser()
        renderer.choose = chooser.method
        rows: dict[str, Callable[[int], Scene]] = {
            "plain cylinder, lamp moves": lambda k: moved(plain, k, "lamp"),
            "plain cylinder, eye moves": lambda k: moved(plain, k, "eye"),
            "can, two finishes, lamp moves": lambda k: moved(packed, k, "lamp"),
            "can, two finishes, eye moves": lambda k: moved(packed, k, "eye"),
            "can, k dragged": lambda k: moved(packed, k, "k"),
            "can, sigma_N dragged": lambda k: moved(packed, k, "sigma_n_deg"),
            "mesh of 200,000, lamp moves": lambda k: moved(meshed, k, "lamp"),
            "mesh of 200,000, eye moves": lambda k: moved(meshed, k, "eye"),
        }
        for scene_of in rows.values():
            renderer.render(scene_of(0), look, SIZE)
        chooser.moving = True  # so that no time is that of choosing a method
        times = Times()
        for turn in range(rounds):
            for name, scene_of in rows.items():
                renderer.render(scene_of(4 * turn), look, SIZE)  # the scene before is another row's
                for again in range(1, 4):
                    scene = scene_of(4 * turn + again)
                    times.add(name, partial(renderer.render, scene, look, SIZE), renderer)
        panes: list[float] = []
        with_panes = [Renderer(renderer.ctx, renderer.programs, renderer.choose) for _ in range(2)]
        for k in range(rounds + 2):
            start = time.perf_counter()
            for pane in with_panes:
                pane.render(moved(packed, 1000 + k, "k"), look, PANE)
            renderer.ctx.finish()
            panes.append(time.perf_counter() - start)
        print(f"{renderer.ctx.info['GL_RENDERER']}; coverage {share:.3f}")
        times.print()
        print(f"two panes 640 x 640, k dragged: {1.0 / statistics.median(panes[2:]):.1f} a second")


def with_mesh(mesh: Mesh, mesh_of: Callable[[Shape], Mesh | None], shape: Shape) -> Mesh | None:
    """The mesh in place of a mesh file's."""
    return mesh if shape.kind == "mesh" else mesh_of(shape)


if __name__ == "__main__":
    from relgloss_view.pack import forms

    forms.mesh_of = partial(with_mesh, fine_cylinder(200_000), forms.mesh_of)
    main()
