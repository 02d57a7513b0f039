"""Samples as arguments of a command: a built-in paper or a material file, with its setting."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, refuse
from relgloss_view.gloss.samples import SampleLook
from relgloss_view.material.recolour import Colour
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.picture.scene.setting import Setting

PACK_SUFFIX = ".toml"
SYNTAX = re.compile(r"(.+)=([0-9.]+),([0-9.]+)(?:/([0-9.]+))?", re.DOTALL)


@dataclass(frozen=True)
class SampleArgument:
    """A sample of the command line."""

    sample_look: SampleLook  #: with the setting of the argument
    sample: Sample  #: as a scene file names it
    origin: str  #: of its setting: "given", "published", or "" where it has none of its own


def sample_argument(
    word: str, look: Look, *, published: bool = True, colour: Colour | None = None
) -> SampleArgument:
    """A sample or a pack from NAME|FILE[=SIGMA_N,C], in a colour; the rest of its look is `look`'s.

    Without a setting a built-in paper has the published one, if `published`; other samples have
    their own sigma_N (0 of a file) and c_max. Raises InputError where there is no such sample or a
    number is out of range.
    """
    match = SYNTAX.fullmatch(word)
    name = match[1] if match else word
    built_in = name in SAMPLES
    start = name.rpartition("=")[0]
    if not built_in and (start in SAMPLES or (Path(start).is_file() and not Path(name).exists())):
        refuse(printable(name), "SIGMA_N,C after the sample, such as =2.0,1/3", name[len(start) :])
    sample = _sample(name)
    sample = sample if colour is None else sample.in_colour(colour)
    setting = Setting(SAMPLES[name].sigma_n_deg) if built_in else Setting()
    if built_in and published:
        setting = SAMPLES[name]
    if match:
        setting = _setting(word, match[2], match[3], match[4])
    label = name if built_in else printable(Path(name).stem, 40)
    origin = "given" if match else "published" if built_in and published else ""
    drawn = SampleLook(label, sample.material, look.at(setting), sample.pack)
    return SampleArgument(drawn, sample, origin)


def _sample(name: str) -> Sample:
    """A built-in paper, the pack of a TOML file, or the material of any other file."""
    if name in SAMPLES:
        return Sample.built_in(name)
    if Path(name).suffix.lower() == PACK_SUFFIX:
        from relgloss_view.pack.pack_file import read_pack

        return Sample.of_pack(read_pack(name))
    return Sample.from_file(name)


def sample_arguments(
    words: Sequence[str], look: Look, *, published: bool = True, colour: Colour | None = None
) -> list[SampleArgument]:
    """Samples as sample_argument; a label that an earlier sample has gets a number."""
    samples: list[SampleArgument] = []
    for word in words:
        argument = sample_argument(word, look, published=published, colour=colour)
        first = argument.sample_look.label
        label, n = first, 1
        while label in {other.sample_look.label for other in samples}:
            n += 1
            label = f"{first} ({n})"
        labelled = dataclasses.replace(argument.sample_look, label=label)
        samples.append(dataclasses.replace(argument, sample_look=labelled))
    return samples


def _setting(word: str, sigma_n: str, share: str, of: str | None) -> Setting:
    try:
        return Setting(float(sigma_n), float(share) / float(of or 1))
    except (ValueError, ZeroDivisionError) as error:
        raise InputError(
            f"{word}: expected SAMPLE=SIGMA_N,C such as matte-coated=2.0,2/6"
        ) from error
