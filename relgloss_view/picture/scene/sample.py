"""Sample: a material and its origin; the built-in papers with the paper's published settings."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.resources import asset
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.material.files import load_material
from relgloss_view.material.material import Material
from relgloss_view.material.recolour import Colour, recoloured
from relgloss_view.pack.kinds import PACK, kind_of_pack
from relgloss_view.pack.pack import Pack
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Setup


@dataclass(frozen=True)
class Sample:
    """A material and its origin. A built-in sample has a name; others come from a file.

    >>> Sample.built_in("uncoated").material.name
    'uncoated, green ink'
    >>> Sample.built_in("velvet")
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: sample 'velvet': expected one of cast-coated, ...
    """

    material: Material
    name: str | None = None  #: of a built-in sample
    file: str | None = None  #: the material file, from which the sample can be drawn again
    table: str | None = None  #: the measured table that the material was fitted to
    colour: Colour | None = None  #: in place of the material's own; see `in_colour`
    original: Material | None = None  #: the material in its own colour, where it has another
    pack: Pack | None = None  #: a pack, whose base finish has the material

    @classmethod
    def of_pack(cls, pack: Pack) -> Sample:
        """The sample that a pack is, with the file that it came from."""
        return cls(pack.material, file=pack.file or None, pack=pack)

    def scene(self, setup: Setup | None = None) -> Scene:
        """The sample in a setup; a pack brings its own shape."""
        return Scene(self.material, setup, pack=self.pack)

    @property
    def own_material(self) -> Material:
        """The material in its own colour, as its file holds it."""
        return self.material if self.original is None else self.original

    def in_colour(self, colour: Colour | None) -> Sample:
        """The sample in another colour, or in its own; InputError where it can't have it.

        >>> from relgloss_view.material.recolour import Colour
        >>> Sample.built_in("uncoated").in_colour(Colour((50, 60, 20))).material.name
        'uncoated, colour Lab 50 60 20'
        """
        if self.pack is not None:
            if colour is None:
                return self
            raise InputError("lab: a pack has the colours of its artwork; leave it out")
        own = self.own_material
        if colour is None:
            return dataclasses.replace(self, material=own, colour=None, original=None)
        made = recoloured(own, colour, self.name)
        return dataclasses.replace(self, material=made, colour=colour, original=own)

    @classmethod
    def built_in(cls, name: str) -> Sample:
        """A built-in sample; InputError for any other name."""
        return cls(load_sample(name), name=name)

    @classmethod
    def from_file(
        cls, file: str, table: str | None = None, progress: ProgressReport = no_progress
    ) -> Sample:
        """The sample of a material file, a pack file or an artwork, by the file's content.

        An artwork becomes a can with the finishes that quick_pack chooses. Raises InputError where
        the file can't be read.
        """
        kind = kind_of_pack(file, FILE_EXPECTED)
        if kind is None:
            return cls(load_material(file), file=file, table=table)
        if kind == PACK:
            from relgloss_view.pack.pack_file import read_pack

            return cls.of_pack(read_pack(file, progress))
        from relgloss_view.pack.quick import quick_pack

        return cls.of_pack(quick_pack(file, progress=progress))


#: In order of gloss, with the optima of the subjective evaluation (Ishii et al., "Results"). The
#: first is the paper's reference, by its own choice at sigma_N 0 and c_max.
FILE_EXPECTED = "a material (JSON), a pack (TOML) or an artwork (PDF, PNG, JPEG, TIFF, PSD)"
SAMPLES = {
    "cast-coated": Setting(0.0, 6 / 6),
    "art-coated": Setting(0.0, 5 / 6),
    "matte-coated": Setting(2.0, 2 / 6),
    "uncoated": Setting(2.0, 1 / 6),
}
DEFAULT_SAMPLE = "matte-coated"


def load_sample(name: str) -> Material:
    """The fitted material of a built-in sample paper.

    name: a key of SAMPLES. The papers are synthetic; their measurements are in assets/papers.
    Raises InputError for any other name.

    >>> load_sample("art-coated").synthetic
    True
    """
    if name not in SAMPLES:
        raise InputError(f"sample {printable(name, 60)!r}: expected one of {', '.join(SAMPLES)}")
    return load_material(asset("materials", f"{name}.json"))
