"""What Passes draws on request beside colours: normals and points, and the silhouette's pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl

from relgloss_view.pack import forms
from relgloss_view.picture.gpu.drawing import Drawing
from relgloss_view.picture.gpu.edges import TILE_VERTICES, Silhouette
from relgloss_view.picture.gpu.finishes import look_uniforms
from relgloss_view.picture.gpu.mesh_edges import draw_coverage
from relgloss_view.picture.gpu.request import Request
from relgloss_view.picture.gpu.targets import COVERAGE, GEOMETRY
from relgloss_view.picture.gpu.uniforms import LAMP_NAMES, grain_uniforms, per_size, view_uniforms
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.silhouette import edge_tiles
from relgloss_view.picture.model.view import View

if TYPE_CHECKING:
    from relgloss_view.picture.gpu.passes import Passes


def geometry_of(passes: Passes, request: Request) -> Drawing:
    """Normals and points."""
    scene, look, size = request.scene, request.look, request.size
    samples = sample_count(scene, look, size)
    variant = Variant.of(scene, look, chosen=request.method)
    if variant.surface == "read":
        variant = Variant.of(scene, look, samples, request.method)
    view = View.of(scene, size)
    uniforms: dict[str, Any] = {
        **view_uniforms(scene, view, afar=variant.afar),
        **grain_uniforms(scene, look, size),
        **passes.field(variant),
        **({} if scene.pack is None else look_uniforms(scene.pack, look)),
        "samples": samples,
    }
    tiles = passes.tiles(request, variant)
    defines, bounds = variant.geometry_defines(), view.bounds if tiles is not None else None
    return Drawing(
        "geometry", "geometry.frag", defines, uniforms, GEOMETRY, bounds, "geometry", (), tiles
    )


def silhouette_of(passes: Passes, request: Request) -> Silhouette:
    """The pixels at the silhouette; they are found again where the view has changed."""
    view = View.of(request.scene, request.size)
    variant = Variant.of(request.scene, request.look, chosen=request.method)
    uniforms = view_uniforms(request.scene, view, afar=variant.afar)
    defines = variant.shape_defines()
    seen_from = {name: value for name, value in uniforms.items() if name not in LAMP_NAMES}
    mesh = forms.mesh_of(request.scene.shape)
    if not passes.held.renew("coverage", tuple(defines.items()), seen_from, mesh):
        return passes.silhouette
    if mesh is not None:
        triangles = passes.programs.uploads.triangles(mesh)
        passes.around.pop("coverage", None)
        draw_coverage(passes.programs, passes.targets, passes.surface.masks, triangles, view)
        passes.silhouette.fill_edges(passes.targets.read("coverage")[..., 0], view.bounds)
        passes.draws["coverage"] += 1
    else:
        passes.silhouette.fill_tiles(edge_tiles(request.scene.shape, view), view.size[1])
        passes.around.pop("coverage", None)  # so that it is cleared: the tiles are others
        tiles = passes.silhouette.tiles
        if tiles.texture is not None:
            listed = {"tile_list": tiles.texture, **per_size(view.size)}
            mode = moderngl.TRIANGLES, TILE_VERTICES * tiles.count
            uniforms = {**uniforms, **listed}
            passes.draw(
                "coverage",
                "coverage.frag",
                defines,
                uniforms,
                COVERAGE,
                view.bounds,
                vertices=mode,
            )
            coverage = passes.targets.read("coverage")[..., 0]
            passes.silhouette.fill_edges(coverage, view.bounds)
    return passes.silhouette
