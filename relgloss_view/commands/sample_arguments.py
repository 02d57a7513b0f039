"""Samples as words of a command line: a built-in paper or a material file, with its settings."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Sequence
from pathlib import Path

from relgloss_view.errors import InputError
from relgloss_view.material.files import load_material
from relgloss_view.operators.comparison import Case
from relgloss_view.picture.samples import SAMPLES, load_sample
from relgloss_view.picture.scene import Look
from relgloss_view.text_input import printable

SETTINGS = re.compile(r"(.+)=([0-9.]+),([0-9.]+)(?:/([0-9.]+))?", re.DOTALL)


def case_of(word: str, look: Look) -> tuple[Case, str]:
    """A sample from NAME|FILE[=SIGMA_N,C_FRACTION]; the rest of its look is `look`'s.

    Without settings a built-in paper has the published ones, a file sigma_N 0 and c_max, which
    the second value tells. InputError where the sample or a number is none.
    """
    match = SETTINGS.fullmatch(word)
    name = match[1] if match else word
    material = load_sample(name) if name in SAMPLES else load_material(name)
    told = ""
    if match:
        sigma_n_deg, fraction = _settings(word, *match.groups()[1:])
    elif name in SAMPLES:
        published = SAMPLES[name]
        sigma_n_deg, fraction = published.sigma_n_deg, published.c_fraction
    else:
        sigma_n_deg, fraction = 0.0, 1.0
        told = f"{printable(name)}: drawn at sigma_N 0 and c_max; {name}=2.0,1/3 sets others"
    look = dataclasses.replace(look, sigma_n_deg=sigma_n_deg, c=None, c_fraction=fraction)
    label = name if name in SAMPLES else printable(Path(name).stem, 40)
    return Case(label, material, look), told


def unique(cases: Sequence[Case]) -> list[Case]:
    """The cases with a number behind labels that come again."""
    found: list[Case] = []
    for case in cases:
        label, n = case.label, 1
        while label in {c.label for c in found}:
            n += 1
            label = f"{case.label} ({n})"
        found.append(dataclasses.replace(case, label=label))
    return found


def _settings(word: str, sigma_n: str, share: str, of: str | None) -> tuple[float, float]:
    try:
        return float(sigma_n), float(share) / float(of or 1)
    except (ValueError, ZeroDivisionError) as error:
        raise InputError(
            f"{word}: expected SAMPLE=SIGMA_N,C such as matte-coated=2.0,2/6"
        ) from error
