"""The pair of a proof from the options of a command: as the window would show it."""

from __future__ import annotations

import argparse
import dataclasses
from typing import TYPE_CHECKING

from relgloss_view.commands.matched import matched_finishes, matched_picture
from relgloss_view.commands.sample_arguments import sample_argument
from relgloss_view.commands.scene_options import scene_from
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.scene_file import SceneFile, read_scene_file

if TYPE_CHECKING:
    from relgloss_view.pack.pack import Pack
    from relgloss_view.quality.backends import FrameRenderer

#: Of [presentation]: what the page, which shows the paper's split, does not follow.
OPERATORS = ("reference_operator", "test_operator")
SPLIT = "split"


def scene_of_options(
    args: argparse.Namespace, renderer: FrameRenderer
) -> tuple[SceneFile, tuple[int, int], tuple[str, ...]]:
    """The pair with absolute c on both sides, the pictures' size, and warnings.

    c of the test picture is the matched one unless the options or a scene file give another. A
    share of c_max becomes the number that its picture has. Raises InputError, also where the
    reference has no gloss.
    """
    scene, look, size = scene_from(args)
    own = scene.pack
    scene, look = matched_finishes(args, scene, look)
    picture = matched_picture(args, scene, look)
    content = None if args.scene is None else read_scene_file(args.scene)
    reference, reference_look = _reference(args, content, look)
    match = None if content is None else content.match
    if picture is not None:
        look, match = picture.look, picture.match
        reference_look = picture.reference.sample_at_c.look
    pack = scene.pack
    if own is not None and pack is not None:
        pack = _with_open_graininess(own, pack, look.sigma_n_deg)
    made = SceneFile(
        Sample(scene.material) if pack is None else Sample.of_pack(pack),
        look,
        scene.setup,
        reference,
        reference_look,
        match=match,
        reference_shape=None if content is None else content.reference_shape,
    )
    return _pinned(made, renderer, size), size, _warnings(content)


def _reference(
    args: argparse.Namespace, content: SceneFile | None, look: Look
) -> tuple[Sample, Look]:
    """The reference's sample and look: of --reference, of the scene file, or cast-coated."""
    from relgloss_view.gloss.match import DEFAULT_REFERENCE

    if args.reference is None and content is not None and content.reference is not None:
        return content.reference, content.reference_look or Look()
    argument = sample_argument(args.reference or DEFAULT_REFERENCE, look)
    return argument.sample, argument.sample_look.look


def _with_open_graininess(own: Pack, matched: Pack, sigma_n_deg: float) -> Pack:
    """The matched pack whose finishes follow the picture's sigma_N where that draws the same.

    So the slider of graininess moves the finishes that had none of their own.
    """
    finishes = tuple(
        dataclasses.replace(now, sigma_n_deg=None)
        if before.sigma_n_deg is None and now.sigma_n_deg == sigma_n_deg
        else now
        for before, now in zip(own.finishes, matched.finishes, strict=True)
    )
    return dataclasses.replace(matched, finishes=finishes)


def _pinned(content: SceneFile, renderer: FrameRenderer, size: tuple[int, int]) -> SceneFile:
    """The pair with each c that was a share of c_max as the number that its picture has."""
    from relgloss_view.gloss.match import absolute_c
    from relgloss_view.pack.shape import Shape

    assert content.reference is not None
    assert content.reference_look is not None

    def pinned(sample: Sample, scene: Scene, look: Look) -> Look:
        if look.c is not None:
            return look
        frame = renderer.render(scene, look, size)
        c = frame.c if frame.c_max is not None else absolute_c(look, sample.material)
        return look.with_entries(c=c)

    setup = content.setup
    if content.sample.pack is not None:
        setup = setup.placed(shape=content.reference_shape or Shape())
    return dataclasses.replace(
        content,
        look=pinned(content.sample, content.scene(), content.look),
        reference_look=pinned(
            content.reference, content.reference.scene(setup), content.reference_look
        ),
    )


def _warnings(content: SceneFile | None) -> tuple[str, ...]:
    if content is None:
        return ()
    others = {str(content.presentation.get(name, SPLIT)) for name in OPERATORS} - {SPLIT}
    if not others:
        return ()
    return (
        f"the scene shows the tones of {', '.join(sorted(others))}; a proof shows the split, on "
        "which c and its sliders act",
    )
