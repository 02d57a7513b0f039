"""Material JSON: the file that a fit leaves and a picture starts from. Format in docs/files.md."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
import os
import re
from pathlib import Path
from typing import Any, NoReturn

from relgloss_view.atomic import whole_file
from relgloss_view.bands import RGB, Bands
from relgloss_view.errors import InputError
from relgloss_view.material.material import (
    DIFFUSE_MODELS,
    MAX_LOBES,
    QUALITIES,
    S_DEG_RANGE,
    SIGMA_DEG_MAX,
    Diffuse,
    FitRecord,
    Lobe,
    Material,
)

FORMAT = "relgloss-material"
VERSION = 1
MAX_BYTES = 64 * 1024 * 1024
ALBEDO_MAX = 4.0  # fluorescent papers pass 1; anything above this is a unit mistake
INDEX_RANGE = (1.0, 10.0)


def material_to_dict(material: Material) -> dict[str, Any]:
    """The JSON object of a material."""
    bands = material.bands
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "name": material.name,
        "source": material.source,
        "basis": "rgb" if bands.is_rgb else "spectral",
    }
    if bands.wavelengths_nm is not None:
        content["wavelengths_nm"] = list(bands.wavelengths_nm)
    content["diffuse"] = {
        "model": material.diffuse.model,
        "albedo": list(material.diffuse.albedo),
        "sigma_deg": material.diffuse.sigma_deg,
    }
    content["specular"] = [
        {
            "model": "torrance-sparrow",
            "strength": lobe.strength[0] if len(lobe.strength) == 1 else list(lobe.strength),
            "refractive_index": lobe.refractive_index,
            "s_deg": lobe.s_deg,
        }
        for lobe in material.specular
    ]
    if material.fit is not None:
        content["fit"] = dataclasses.asdict(material.fit)
    return content


def save_material(material: Material, path: str | os.PathLike[str]) -> None:
    """Write a material as JSON, whole or not at all. Raises InputError where that fails."""
    text = json.dumps(material_to_dict(material), indent=1, allow_nan=False)
    with whole_file(path) as temporary:
        temporary.write_text(_one_line_arrays(text) + "\n", encoding="utf-8")


def load_material(path: str | os.PathLike[str]) -> Material:
    """Read a material; InputError names the file, the field, what was expected and found."""
    file = Path(path)
    try:
        if file.stat().st_size > MAX_BYTES:
            raise InputError(f"{file}: larger than {MAX_BYTES} bytes; not a material file")
        text = file.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{file}: can't be read ({error.strerror}); check the name") from error
    except UnicodeDecodeError as error:
        raise InputError(f"{file}: byte {error.start}: not UTF-8 text; expected JSON") from error
    try:
        content = json.loads(text, parse_constant=_no_constant, object_pairs_hook=_unique)
    except json.JSONDecodeError as error:
        raise InputError(
            f"{file}: line {error.lineno}, column {error.colno}: not JSON ({error.msg}); "
            "a material is written by `relgloss fit`"
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"{file}: {error}; a material is written by `relgloss fit`") from error
    return _Reader(file).material(content)


_FIT_FIELDS: dict[str, tuple[Any, str]] = {
    "candidates": (list, "a list of objects"),
    "chosen": (str, "a text"),
    "residuals": (dict, "an object"),
    "quality": (str, "a text"),
    "warnings": (list, "a list of texts"),
    "seed": (int, "a whole number"),
    "seconds": (int | float, "a number"),
    "standard_errors": (dict, "an object"),
    "bounds": (dict, "an object"),
    "convention": (str, "a text"),
}


class _Reader:
    """Checks each field and says where a fault is."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.notes: list[str] = []

    def fault(self, place: str, expected: str, found: object) -> NoReturn:
        shown = json.dumps(found, default=str)
        shown = shown if len(shown) <= 60 else shown[:57] + "..."
        raise InputError(f"{self.file}: {place}: expected {expected}, found {shown}")

    def number(self, value: object, place: str, expected: str, low: float, high: float) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            self.fault(place, expected, value)
        try:
            number = float(value)
        except OverflowError:
            self.fault(place, expected, value)
        if not (math.isfinite(number) and low <= number <= high):
            self.fault(place, expected, value)
        return number

    def numbers(
        self, value: object, place: str, expected: str, low: float, high: float
    ) -> tuple[float, ...]:
        if not isinstance(value, list):
            self.fault(place, f"a list, each {expected}", value)
        return tuple(
            self.number(v, f"{place}[{k}]", expected, low, high) for k, v in enumerate(value)
        )

    def text(self, value: object, place: str) -> str:
        if not isinstance(value, str):
            self.fault(place, "a text", value)
        return value

    def table(self, value: object, place: str) -> dict[str, Any]:
        if not isinstance(value, dict):
            self.fault(place, "an object", value)
        return value

    def material(self, content: object) -> Material:
        top = self.table(content, "the file")
        if top.get("format") != FORMAT:
            self.fault("format", f'"{FORMAT}"', top.get("format"))
        if top.get("version") != VERSION:
            self.fault(
                "version", f"{VERSION} (a newer file needs a newer relgloss)", top.get("version")
            )
        bands = self.bands(top)
        diffuse = self.diffuse(self.table(top.get("diffuse"), "diffuse"), bands)
        lobes = top.get("specular", [])
        if not isinstance(lobes, list) or len(lobes) > MAX_LOBES:
            self.fault("specular", f"a list of at most {MAX_LOBES} lobes", lobes)
        specular = tuple(
            self.lobe(self.table(v, f"specular[{k}]"), f"specular[{k}]", bands)
            for k, v in enumerate(lobes)
        )
        fit = self.fit(top.get("fit"))
        if self.notes:
            fit = dataclasses.replace(
                fit or FitRecord(), warnings=(*(fit.warnings if fit else ()), *self.notes)
            )
        name = self.text(top.get("name"), "name")
        return Material(name, self.text(top.get("source"), "source"), bands, diffuse, specular, fit)

    def bands(self, top: dict[str, Any]) -> Bands:
        if top.get("basis") == "rgb":
            return RGB
        if top.get("basis") != "spectral":
            self.fault("basis", '"spectral" or "rgb"', top.get("basis"))
        place = "wavelengths_nm"
        centres = self.numbers(top.get(place), place, "a wavelength in nm, 100 to 3000", 100, 3000)
        if len(centres) < 2 or any(b <= a for a, b in itertools.pairwise(centres)):
            self.fault(place, "two or more wavelengths, increasing", list(centres))
        return Bands(centres)

    def diffuse(self, part: dict[str, Any], bands: Bands) -> Diffuse:
        model = part.get("model")
        if model not in DIFFUSE_MODELS:
            self.fault("diffuse.model", f"one of {', '.join(DIFFUSE_MODELS)}", model)
        expected = f"an albedo, 0 to {ALBEDO_MAX:g}"
        albedo = self.numbers(part.get("albedo"), "diffuse.albedo", expected, 0.0, ALBEDO_MAX)
        if len(albedo) != bands.count:
            self.fault("diffuse.albedo", f"{bands.count} values, one a band", len(albedo))
        expected = f"an angle in degrees, 0 to {SIGMA_DEG_MAX:.1f}"
        sigma = self.number(
            part.get("sigma_deg", 0.0), "diffuse.sigma_deg", expected, 0, SIGMA_DEG_MAX
        )
        return Diffuse(str(model), albedo, sigma)

    def lobe(self, part: dict[str, Any], place: str, bands: Bands) -> Lobe:
        if part.get("model") != "torrance-sparrow":
            self.fault(f"{place}.model", '"torrance-sparrow"', part.get("model"))
        strength = part.get("strength")
        values = strength if isinstance(strength, list) else [strength]
        strengths = self.numbers(values, f"{place}.strength", "a number of at least 0", 0.0, 1e6)
        if isinstance(strength, list) and len(strengths) != bands.count:
            self.fault(
                f"{place}.strength", f"one number, or {bands.count}, one a band", len(values)
            )
        low, high = INDEX_RANGE
        index = self.number(
            part.get("refractive_index"),
            f"{place}.refractive_index",
            f"a refractive index, {low:g} to {high:g}",
            low,
            high,
        )
        low, high = S_DEG_RANGE
        s_deg = self.number(
            part.get("s_deg"),
            f"{place}.s_deg",
            f"a lobe width above 0 and at most {high:g} degrees",
            1e-12,
            high,
        )
        if s_deg < low:
            self.notes.append(
                f"{place}.s_deg = {s_deg:g} is narrower than {low:g} degrees, where a point "
                f"lamp has no limit image; drawn as {low:g}"
            )
            s_deg = low
        return Lobe(strengths, s_deg, index)

    def fit(self, value: object) -> FitRecord | None:
        if value is None:
            return None
        part = self.table(value, "fit")
        record: dict[str, Any] = {}
        for name, (kind, expected) in _FIT_FIELDS.items():
            if name in part:
                if not isinstance(part[name], kind) or isinstance(part[name], bool):
                    self.fault(f"fit.{name}", expected, part[name])
                record[name] = tuple(part[name]) if kind is list else part[name]
        if record.get("quality", "good") not in QUALITIES:
            self.fault("fit.quality", f"one of {', '.join(QUALITIES)}", record["quality"])
        for name, kind in (("candidates", dict), ("warnings", str)):
            if not all(isinstance(entry, kind) for entry in record.get(name, ())):
                self.fault(f"fit.{name}", _FIT_FIELDS[name][1], part[name])
        return FitRecord(**record)


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number")


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) != len(pairs):
        seen: set[str] = set()
        twice = next(k for k, _ in pairs if k in seen or seen.add(k))  # type: ignore[func-returns-value]
        raise ValueError(f"the field {twice!r} stands twice")
    return result


def _one_line_arrays(text: str) -> str:
    """Join the lines of arrays that hold only numbers, so that spectra stay readable."""
    return _NUMBERS.sub(lambda match: f"[{' '.join(match[1].split())}]", text)


_NUMBERS = re.compile(r"\[\s+([-+.\deE,\s]+?)\s+\]")
