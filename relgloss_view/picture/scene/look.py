"""Look: the values that are tuned by eye, with their ranges."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Checked, choice, parameter, whole_number
from relgloss_view.material.material import DIFFUSE_MODELS
from relgloss_view.picture.scene.setting import FULL_SHARE, Setting

GRAINS = ("screen", "surface", "eye")
NOISE_LAWS = ("paper", "tangent")
VIEWED_GRAIN = "eye"  #: see viewed_look
QUALITIES = ("exact", "auto")
NOISY_LOBES = ("both", "specular")


@dataclass(frozen=True)
class Look(Checked):
    """The values that are tuned by eye: graininess, contrast gloss, and how the grain is drawn.

    sigma_n_deg: standard deviation of the normal's tilt, degrees, 0 to 10.
    c: factor of L_s*, 0 to 10,000. c_fraction: c as a share of the picture's exact c_max, 0 to 10.
    At most one of the two; without either, c is c_max.
    grain: 'screen' fixes grains to pixels, grain_px (1 to 1024) a side; 'surface' fixes them to the
    object, grain_mm (0.001 to 100) a side; 'eye' gives them grain_arcmin (0.1 to 600) minutes of
    arc at the observer's eye, whatever the monitor's pixels are. See also `viewed_look`.
    noise_law: 'paper', a Gaussian angle of uniform azimuth, or 'tangent', two Gaussian components.
    noisy_lobes: 'both' reflections see the tilt, or only the 'specular' one.
    seed: of the grain, 0 to 2^31 - 1. samples: along each side of a pixel, 1 to 16.
    diffuse_model: 'fitted', 'lambert', 'oren-nayar' or 'eon'. quality: 'exact' or 'auto'.

    `setting` reads sigma_N and c, `at` changes both. Raises InputError where a value is out of its
    range. Source: Ishii et al., eqs. 2 to 4.

    >>> look = Look(sigma_n_deg=2.0, c_fraction=2 / 6)
    >>> look.setting.words
    '2 deg, 2/6 c_max'
    >>> look.at(Setting(0.5, c=0.4)).c
    0.4
    >>> Look(sigma_n_deg=20.0)
    Traceback (most recent call last):
    ...
    relgloss_view.base.errors.InputError: look.sigma_n_deg: expected 0 to 10 deg, found 20.0
    """

    sigma_n_deg: float = parameter(
        0.0,
        0.0,
        10.0,
        "deg",
        "graininess: standard deviation of the tilt of the surface normal",
        option="--sigma-n",
        label="Graininess (sigma_N)",
    )
    c: float | None = parameter(
        None,
        0.0,
        1e4,
        "",
        "contrast gloss: scales the specular part of L*",
        option="--c",
        label="Contrast gloss (c)",
    )
    c_fraction: float | None = parameter(
        None,
        0.0,
        10.0,
        "",
        "contrast gloss as a share of c_max, the most that the display shows",
        option="--c-fraction",
        label="Contrast gloss (c / c_max)",
    )
    grain: str = choice(
        "screen",
        GRAINS,
        "screen: grains of whole pixels; surface: fixed to the object; eye: of one size at the "
        "observer's eye on every monitor",
        option="--grain-kind",
        label="Grain fixed to",
    )
    grain_px: int = whole_number(1, 1, 1024, "px", "side of a screen grain", label="Grain size")
    grain_mm: float = parameter(
        0.2, 0.001, 100.0, "mm", "side of a surface grain", label="Grain size"
    )
    grain_arcmin: float = parameter(
        1.5,
        0.1,
        600.0,
        "arcmin",
        "size of a grain at the observer's eye, where the kind of grain is eye",
        option="--grain-arcmin",
        label="Grain size",
    )
    noise_law: str = choice(
        "paper",
        NOISE_LAWS,
        "paper: a Gaussian angle of uniform azimuth; tangent: two Gaussian components",
        label="Tilt distribution",
    )
    noisy_lobes: str = choice(
        "both",
        NOISY_LOBES,
        "both reflections, or only the specular one",
        label="Tilted reflections",
    )
    seed: int = whole_number(
        0, 0, 2**31 - 1, "", "seed of the grain", option="--seed", label="Random seed"
    )
    #: None takes as many as the narrowest lobe needs. One samples the pixel's centre, so that
    #: each number of a picture can be computed again from the point and normal that go with it.
    samples: int | None = whole_number(
        1,
        1,
        16,
        "",
        "samples along each side of a pixel",
        optional=True,
        option="--samples",
        label="Samples per pixel side",
    )
    diffuse_model: str = choice(
        "fitted",
        ("fitted", *DIFFUSE_MODELS),
        "as fitted, or a model with the same albedo",
        label="Diffuse model",
    )
    quality: str = choice(
        "exact",
        QUALITIES,
        "draws the whole model, or what this scene needs (see `relgloss plan`)",
        option="--quality",
        label="Drawing quality",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.c is not None and self.c_fraction is not None:
            raise InputError("look: give c or c_fraction, not both")

    @property
    def setting(self) -> Setting:
        """sigma_N and c of this look; without either form of c, the share is 1."""
        share = FULL_SHARE if self.c_fraction is None else self.c_fraction
        return Setting(self.sigma_n_deg, share, self.c)

    def at(self, setting: Setting) -> Look:
        """The look with another sigma_N and c; InputError where they are out of range."""
        share = setting.c_fraction if setting.c is None else None
        return dataclasses.replace(
            self, sigma_n_deg=setting.sigma_n_deg, c=setting.c, c_fraction=share
        )

    def with_entries(self, **entries: Any) -> Look:
        """The look with some entries changed; one form of c takes the place of the other.

        Raises InputError where a value is out of its range.
        """
        forms = {"c", "c_fraction"} & set(entries)
        dropped = dict.fromkeys({"c", "c_fraction"} - forms) if len(forms) == 1 else {}
        return dataclasses.replace(self, **{**dropped, **entries})

    def without_c(self) -> Look:
        """The look without c, as a key for results that do not depend on c."""
        return dataclasses.replace(self, c=None, c_fraction=None)


def viewed_look(**entries: Any) -> Look:
    """The look that commands and the window begin with: its grain has one size at the eye.

    `Look()` itself keeps the paper's grain, one a pixel: scene files, studies, `grid` and the
    Python interface draw as before. entries: of Look, in place of its defaults.

    >>> viewed_look(sigma_n_deg=2.0).grain, Look(sigma_n_deg=2.0).grain
    ('eye', 'screen')
    """
    return Look(**{"grain": VIEWED_GRAIN, **entries})
