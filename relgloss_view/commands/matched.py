"""Pictures whose contrast gloss keeps the ratio to a reference: what commands draw by default."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.terminal import warn
from relgloss_view.commands.scene_options import (
    SAMPLE_METAVAR,
    SOURCES,
    graininess_is_given,
    wants_match,
)
from relgloss_view.picture.pair import ratio_words
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene

if TYPE_CHECKING:
    from relgloss_view.gloss.match import Reference
    from relgloss_view.gloss.pack_match import PackMatch
    from relgloss_view.gloss.samples import SampleLook
    from relgloss_view.pack.pack import Pack
    from relgloss_view.picture.frame import Frame
    from relgloss_view.picture.scene.match import Match
    from relgloss_view.picture.scene.scene_file import SceneFile
    from relgloss_view.quality.backends import FrameRenderer


def add_reference_option(parser: argparse.ArgumentParser) -> None:
    """Declare --reference."""
    parser.add_argument(
        "--reference",
        metavar=SAMPLE_METAVAR,
        help="Reference sample, whose ratio of gloss the picture keeps, and the setting of its "
        "picture: c as a share of c_max at the paper's geometry (default that of the scene file, "
        "or cast-coated at sigma_N 0 and c_max)",
    )


@dataclass(frozen=True)
class MatchedPicture:
    """A look with the matched c, the reference that it is matched to, and the match itself."""

    look: Look
    reference: Reference
    match: Match
    pack: PackMatch | None = None  #: of a pack, whose finishes are matched too

    @property
    def share(self) -> float:
        """The picture's gloss in units of the match: 1 as matched."""
        ratio = self.match.ratio * self.reference.c
        c = self.look.c
        return c / ratio if c is not None and ratio > 0.0 else 1.0

    def factor(self, renderer: FrameRenderer, scene: Scene, size: tuple[int, int]) -> float:
        """The common factor of the pair's c in a view, from both pictures' c_max."""
        from relgloss_view.gloss.comparison import factor_in_view
        from relgloss_view.gloss.samples import SampleLook

        test = SampleLook("", scene.material, self.look, scene.pack)
        return factor_in_view(renderer, (self.reference.sample_at_c, test), scene, size)

    def as_numbers(self, frame: Frame) -> dict[str, Any]:
        """The match as JSON holds it, with what its frame shows of it."""
        return {
            "reference": {
                "label": self.reference.sample.label,
                "name": self.reference.sample.material.name,
                "sigma_n_deg": self.match.reference_sigma_n_deg,
                "c": self.match.reference_c,
            },
            "c": self.match.test_c,
            "ratio": self.match.ratio,
            "gloss": self.match.gloss,
            "spread": self.match.spread,
            "made_by": self.match.made_by,
            "share": self.share,
            "factor": frame.scaling.factor,
            **({} if self.pack is None else self.pack.as_numbers()),
        }


def matched_finishes(args: argparse.Namespace, scene: Scene, look: Look) -> tuple[Scene, Look]:
    """A pack whose finishes keep their ratio of gloss to each other, whatever c the picture has.

    Each finish gets its sigma_N and, unless it keeps its own, its k; the look has the sigma_N of
    the finish that c belongs to. A sample that is no pack stays as it is.
    """
    if scene.pack is None:
        return scene, look
    from relgloss_view.gloss.match import Reference
    from relgloss_view.gloss.pack_match import match_pack

    found = match_pack(Reference.default(), scene.pack, _given_graininess(args, look), scene.setup)
    for text in found.warnings:
        warn(text)
    changed = Scene(scene.material, scene.setup, pack=found.pack)
    return changed, look.with_entries(sigma_n_deg=found.anchor.sigma_n_deg)


def _given_graininess(args: argparse.Namespace, look: Look) -> float | None:
    """The look's sigma_N where words or a scene file decide on it."""
    return look.sigma_n_deg if graininess_is_given(args) else None


def matched_picture(args: argparse.Namespace, scene: Scene, look: Look) -> MatchedPicture | None:
    """The match of what the options describe; None where they ask for another c.

    A scene file that holds a match stays a pair: its c are kept, or matched anew where the options
    name another sample. Raises InputError where the reference has no gloss.
    """
    pair = _pair_of_file(args, look)
    another_sample = any(getattr(args, name) is not None for name in (*SOURCES, "lab"))
    if pair is not None and not another_sample:
        return pair
    if not wants_match(args, look) and pair is None:
        if args.reference is not None:
            raise InputError(
                f"--reference {args.reference}: c of this picture is given, so nothing is matched; "
                "leave it out, or give --c matched"
            )
        return None
    from relgloss_view.gloss.match import Reference, matched, own_sigma_n_deg
    from relgloss_view.picture.scene.sample import DEFAULT_SAMPLE

    reference = Reference.of(reference_look(args, look))
    if scene.pack is not None:
        return _matched_pack(reference, scene, scene.pack, look)
    sigma_n_deg = look.sigma_n_deg
    if not graininess_is_given(args) and args.material is None:
        sigma_n_deg = own_sigma_n_deg(args.sample or DEFAULT_SAMPLE)
    match = matched(reference, scene.material, sigma_n_deg)
    changed = look.with_entries(c=match.test_c, sigma_n_deg=sigma_n_deg)
    return MatchedPicture(changed, reference, match)


def _matched_pack(reference: Reference, scene: Scene, pack: Pack, look: Look) -> MatchedPicture:
    """The match of a pack whose finishes were matched among themselves."""
    from relgloss_view.gloss.pack_match import match_pack

    found = match_pack(reference, pack, look.sigma_n_deg, scene.setup)
    sigma_n_deg = found.anchor.sigma_n_deg
    changed = look.with_entries(c=found.c, sigma_n_deg=sigma_n_deg)
    return MatchedPicture(changed, reference, found.match, found)


def _pair_of_file(args: argparse.Namespace, look: Look) -> MatchedPicture | None:
    """The pair that a scene file holds with its match, unless an option gives another c."""
    from relgloss_view.gloss.match import Reference, matched
    from relgloss_view.gloss.pack_match import match_pack
    from relgloss_view.picture.scene.scene_file import read_scene_file

    given = any(getattr(args, name, None) for name in ("c", "c_fraction", "published"))
    if args.scene is None or given or args.reference is not None:
        return None
    content = read_scene_file(args.scene)
    sample = _reference_of_file(content)
    if content.match is None or sample is None or look.c is None:
        return None
    if content.presentation.get("clip_highlights") is True or look.c != content.look.c:
        return None
    try:
        reference = Reference.of(sample, content.match.gloss)
    except InputError:  # a reference without gloss: nothing is to be kept
        return None
    match, c = content.match, look.c
    if look.sigma_n_deg != content.look.sigma_n_deg:  # another graininess keeps the share
        share = c / (match.ratio * reference.c) if match.ratio > 0.0 else 1.0
        if content.sample.pack is not None:
            match = match_pack(reference, content.sample.pack, look.sigma_n_deg).match
        else:
            match = matched(reference, content.sample.material, look.sigma_n_deg)
        c = share * match.ratio * reference.c
    return MatchedPicture(look.with_entries(c=c), reference, match)


def reference_look(args: argparse.Namespace, look: Look) -> SampleLook:
    """The reference of the options: --reference, the scene file's, or cast-coated."""
    from relgloss_view.commands.sample_arguments import sample_argument
    from relgloss_view.gloss.match import DEFAULT_REFERENCE
    from relgloss_view.picture.scene.scene_file import read_scene_file

    if args.reference is None and args.scene is not None:
        of_file = _reference_of_file(read_scene_file(args.scene))
        if of_file is not None:
            return of_file
    return sample_argument(args.reference or DEFAULT_REFERENCE, look).sample_look


def _reference_of_file(content: SceneFile) -> SampleLook | None:
    """The reference of a scene file at its look; None where it has none."""
    from relgloss_view.gloss.samples import SampleLook

    sample = content.reference
    if sample is None:
        return None
    label = sample.name or sample.material.name
    return SampleLook(label, sample.material, content.reference_look or Look(), sample.pack)


def match_words(picture: MatchedPicture, frame: Frame) -> str:
    """The match of a drawn picture in a few words."""
    label = picture.reference.sample.label
    if not any(material.visible_lobes() for material in frame.scene.materials):
        return f"it has no highlight, so there is no gloss to match to {label}"
    words = f"matched to {label} (c {picture.reference.c:.4g})"
    if abs(picture.share - 1.0) > 5e-4:
        words = f"{picture.share:.2f} of the gloss that is {words}"
    changed = ratio_words(frame.scaling.factor)
    return f"{words}; {changed}" if changed else words
