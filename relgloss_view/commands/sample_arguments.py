"""Samples as words of a command line: a built-in paper or a material file, with its settings."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import fault, printable
from relgloss_view.gloss.comparison import Case
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, Sample
from relgloss_view.picture.scene.setting import Setting

METAVAR = "SAMPLE|MATERIAL.json[=SIGMA_N,C]"
SETTINGS = re.compile(r"(.+)=([0-9.]+),([0-9.]+)(?:/([0-9.]+))?", re.DOTALL)


@dataclass(frozen=True)
class Given:
    """A sample as it was given."""

    case: Case
    sample: Sample  #: as a scene file names it
    settings: str  #: "given", "published", or none: sigma_N 0 and c_max


def given_sample(word: str, look: Look) -> Given:
    """A sample from NAME|FILE[=SIGMA_N,C_FRACTION]; the rest of its look is `look`'s.

    Without settings a built-in paper has the published ones. InputError where the sample or a
    number is none.
    """
    match = SETTINGS.fullmatch(word)
    name = match[1] if match else word
    built_in = name in SAMPLES
    start = name.rpartition("=")[0]
    if not built_in and (start in SAMPLES or (Path(start).is_file() and not Path(name).exists())):
        fault(printable(name), "SIGMA_N,C after the sample, such as =2.0,1/3", name[len(start) :])
    sample = Sample.built_in(name) if built_in else Sample.from_file(name)
    setting = SAMPLES[name] if built_in else Setting()
    if match:
        setting = _setting(word, match[2], match[3], match[4])
    look = look.at(setting)
    label = name if built_in else printable(Path(name).stem, 40)
    settings = "given" if match else "published" if built_in else ""
    return Given(Case(label, sample.material, look), sample, settings)


def given_samples(words: Sequence[str], look: Look) -> list[Given]:
    """Samples as given_sample; labels that come again get a number."""
    found: list[Given] = []
    for word in words:
        given = given_sample(word, look)
        label, n = given.case.label, 1
        while label in {other.case.label for other in found}:
            n += 1
            label = f"{given.case.label} ({n})"
        found.append(dataclasses.replace(given, case=dataclasses.replace(given.case, label=label)))
    return found


def _setting(word: str, sigma_n: str, share: str, of: str | None) -> Setting:
    try:
        return Setting(float(sigma_n), float(share) / float(of or 1))
    except (ValueError, ZeroDivisionError) as error:
        raise InputError(
            f"{word}: expected SAMPLE=SIGMA_N,C such as matte-coated=2.0,2/6"
        ) from error
