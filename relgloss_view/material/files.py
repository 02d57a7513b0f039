"""Material files (JSON), which a fit writes and a picture reads. Format in docs/files.md."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

from relgloss_view.base.errors import InputError
from relgloss_view.base.foreign import HEAD_BYTES, refuse_foreign, refuse_foreign_json
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import printable, read_beginning, read_text, refuse, text
from relgloss_view.base.writing import whole_file
from relgloss_view.material.described import described_record
from relgloss_view.material.estimated import estimate_record
from relgloss_view.material.material import MAX_LOBES, Diffuse, FitRecord, Lobe, Material, Quality
from relgloss_view.measure.bands import RGB, WIDE_RGB, Bands
from relgloss_view.measure.table import source_is_synthetic

FORMAT = "relgloss-material"
VERSION = 1
MAX_BYTES = 8 * 1024 * 1024  #: the finest bands with a whole fit take less than one
EXPECTED = "a material file (JSON)"
MOST_VALUES = 10_000  #: of a list of bands; at their finest there are 5,801
MOST_ENTRIES = 1000  #: of a list of candidates or warnings
RGB_BASES = {"rgb": RGB, "rec2020": WIDE_RGB}
#: The kinds of lobes.
DIELECTRIC, METAL = "torrance-sparrow", "metal"
MAX_DIGITS = 1000  # of a whole number; Python itself refuses more than 4300


def material_to_dict(material: Material) -> dict[str, Any]:
    """The JSON object of a material."""
    bands = material.bands
    content: dict[str, Any] = {
        "format": FORMAT,
        "version": VERSION,
        "name": material.name,
        "source": material.source,
        "basis": next((name for name, b in RGB_BASES.items() if b == bands), "spectral"),
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
            "model": DIELECTRIC if lobe.f0 is None else METAL,
            "strength": _one_or_list(lobe.strength),
            **(
                {"refractive_index": lobe.refractive_index}
                if lobe.f0 is None
                else {"f0": _one_or_list(lobe.f0)}
            ),
            "s_deg": lobe.s_deg,
        }
        for lobe in material.specular
    ]
    if material.fit is not None:
        content["fit"] = {
            name: value
            for name, value in dataclasses.asdict(material.fit).items()
            if name in _FIT_FIELDS
        }
    if material.estimate is not None:
        content["estimate"] = material.estimate.as_json()
    if material.described is not None:
        content["described"] = material.described.as_json()
    for name, reading in _MARKS.items():
        if getattr(material, name) != reading(material.source):
            content[name] = getattr(material, name)
    return content


def _one_or_list(values: tuple[float, ...]) -> float | list[float]:
    return values[0] if len(values) == 1 else list(values)


def save_material(material: Material, path: str | os.PathLike[str]) -> None:
    """Write a material as JSON, whole or not at all. Raises InputError where that fails.

    >>> from relgloss_view import load_sample
    >>> save_material(load_sample("uncoated"), "uncoated.json")
    >>> load_material("uncoated.json") == load_sample("uncoated")
    True
    """
    try:
        content = material_to_dict(material)
        written = _written(content)
    except (ValueError, TypeError, RecursionError) as error:
        raise InputError(
            f"{path}: {material.name}: its evidence can't be written ({error})"
        ) from error
    _refuse_surrogates(content, written, f"{path}: ")
    with whole_file(path) as temporary:
        temporary.write_text(written + "\n", encoding="utf-8")


def material_text(content: dict[str, Any]) -> str:
    """The text of a material file that holds the JSON object of a material."""
    return _written(content) + "\n"


def load_material(path: str | os.PathLike[str]) -> Material:
    """Read a material file, as `fit_material` and `save_material` make it.

    Raises InputError, one line that names the file, the field, the expected and the actual value.

    >>> from relgloss_view.base.resources import asset
    >>> load_material(asset("materials", "uncoated.json")).name
    'uncoated, green ink'
    """
    refuse_foreign(read_beginning(path, HEAD_BYTES, EXPECTED), path)
    read = read_text(path, MAX_BYTES, EXPECTED)
    remedy = "a material is written by `relgloss fit`"
    try:
        content = parse_json(
            read, parse_constant=_no_constant, parse_int=_integer, object_pairs_hook=_unique
        )
    except InputError as error:
        raise InputError(f"{path}: {error}; {remedy}") from error
    if isinstance(content, dict) and "format" not in content:
        refuse_foreign_json(read.encode("utf-8", "surrogatepass"), path)
    try:
        _refuse_surrogates(content, read)
        return material_from_dict(content)
    except ValueError as error:
        raise InputError(f"{path}: {error}; {remedy}") from error
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


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
    "judgement": (dict, "an object"),
    "derived": (dict, "an object"),
    "convention": (str, "a text"),
    "grounds": (list, "a list of texts"),
    "covariance": (dict, "an object"),
    "instrument": (dict, "an object"),
}


#: Words of a warning that explains a quality.
_EXPLAINS = {
    Quality.GOOD: (),
    Quality.POOR: ("poor", "no model describes"),
    Quality.UNIDENTIFIABLE: ("unidentifiable",),
}


def _grounds(fit: FitRecord) -> tuple[str, ...]:
    """The warnings that explain the quality, by their words: older files do not mark them."""
    words = _EXPLAINS[fit.quality]
    judged = fit.judgement.get("poor") if fit.quality == Quality.POOR else None
    lines = judged if isinstance(judged, list) else []
    return tuple(
        text for text in fit.warnings if text in lines or any(word in text for word in words)
    )


def _source_is_hypothetical(source: str) -> bool:
    return "hypothetical" in source.partition(":")[0].lower()


#: Marks of a material that its source carries; a file has a field only where the source differs.
_MARKS: dict[str, Callable[[str], bool]] = {
    "synthetic": source_is_synthetic,
    "hypothetical": _source_is_hypothetical,
}


def material_from_dict(content: object) -> Material:
    """The material of a JSON object; InputError names the field that is wrong."""
    top = _table(content, "the file")
    if top.get("format") != FORMAT:
        refuse("format", f'"{FORMAT}"', top.get("format"))
    if top.get("version") != VERSION:
        refuse("version", f"{VERSION} (a newer file needs a newer relgloss)", top.get("version"))
    basis: Any = top.get("basis")
    if basis not in ("spectral", *RGB_BASES):
        refuse("basis", '"spectral", "rgb" or "rec2020"', basis)
    bands = Bands(_list(top, "wavelengths_nm")) if basis == "spectral" else RGB_BASES[basis]
    part = _table(top.get("diffuse"), "diffuse")
    with _inside("diffuse"):
        model: Any = part.get("model")
        diffuse = Diffuse(model, _list(part, "albedo"), part.get("sigma_deg", 0.0))
    lobes = top.get("specular", [])
    if not isinstance(lobes, list) or len(lobes) > MAX_LOBES:
        refuse("specular", f"a list of at most {MAX_LOBES} lobes", lobes)
    specular = tuple(_lobe(value, f"specular[{k}]", bands) for k, value in enumerate(lobes))
    fit, estimate = _fit(top.get("fit")), estimate_record(top.get("estimate"))
    described = described_record(top.get("described"))
    name, source = text(top.get("name"), "name"), text(top.get("source"), "source")
    marks = {mark: top.get(mark, reading(source)) for mark, reading in _MARKS.items()}
    for mark, value in marks.items():
        if not isinstance(value, bool):
            refuse(mark, "true or false", value)
    records: dict[str, Any] = {"estimate": estimate, "described": described}
    return Material(name, source, bands, diffuse, specular, fit, **records, **marks)


def _lobe(value: object, place: str, bands: Bands) -> Lobe:
    part = _table(value, place)
    if part.get("model") not in (DIELECTRIC, METAL):
        refuse(f"{place}.model", f'"{DIELECTRIC}" or "{METAL}"', part.get("model"))
    s_deg: Any = part.get("s_deg")
    if part["model"] == METAL:
        strength: Any = part.get("strength", 1.0)
        f0 = _per_band(part.get("f0"), f"{place}.f0", bands)
        with _inside(place):
            return Lobe((strength,), s_deg, f0=f0)
    values = _per_band(part.get("strength"), f"{place}.strength", bands)
    index: Any = part.get("refractive_index")
    with _inside(place):
        return Lobe(values, s_deg, index)


def _per_band(value: object, place: str, bands: Bands) -> tuple[Any, ...]:
    """The values of a list of one a band, or a single one; the lobe checks each."""
    if isinstance(value, list) and len(value) != bands.count:
        refuse(place, f"one number, or {bands.count}, one a band", len(value))
    return tuple(value) if isinstance(value, list) else (value,)


def _fit(value: object) -> FitRecord | None:
    if value is None:
        return None
    part = _table(value, "fit")
    record: dict[str, Any] = {}
    for name, (kind, expected) in _FIT_FIELDS.items():
        if name in part:
            if isinstance(part[name], list) and len(part[name]) > MOST_ENTRIES:
                raise InputError(
                    f"fit.{name}: expected at most {MOST_ENTRIES} entries, found {len(part[name])}"
                )
            if not isinstance(part[name], kind) or isinstance(part[name], bool):
                refuse(f"fit.{name}", expected, part[name])
            record[name] = tuple(part[name]) if kind is list else part[name]
    for name, kind in (("candidates", dict), ("warnings", str), ("grounds", str)):
        if not all(isinstance(entry, kind) for entry in record.get(name, ())):
            refuse(f"fit.{name}", _FIT_FIELDS[name][1], part[name])
    try:
        json.dumps(record, allow_nan=False)
    except ValueError:  # 1e999 is read as infinity
        raise InputError("fit: expected finite numbers, found one beyond every float") from None
    with _inside("fit"):
        fit = FitRecord(**record)
    return fit if "grounds" in record else dataclasses.replace(fit, grounds=_grounds(fit))


def _table(value: object, place: str) -> dict[str, Any]:
    if not isinstance(value, dict):
        refuse(place, "an object", value)
    return value


def _list(part: dict[str, Any], name: str) -> tuple[Any, ...]:
    """The entries of a list; the class that takes them checks each."""
    value = part.get(name)
    if not isinstance(value, list):
        refuse(name, "a list of numbers", value)
    if len(value) > MOST_VALUES:  # before each is looked at, which takes a second for a million
        raise InputError(f"{name}: expected at most {MOST_VALUES} numbers, found {len(value)}")
    return tuple(value)


@contextlib.contextmanager
def _inside(place: str) -> Iterator[None]:
    """Put the place of a part before the faults that the part finds in itself."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}.{error}") from error


def _integer(digits: str) -> int:
    if len(digits) > MAX_DIGITS:
        raise ValueError(f"a number of {len(digits)} digits")
    return int(digits)


def _refuse_surrogates(content: object, written: str, place: str = "") -> None:
    """Half of a surrogate pair, as in "\\ud800", is no character and can't be shown or saved."""
    if "\\ud" not in written.lower():
        return
    try:
        json.dumps(content, ensure_ascii=False).encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(
            f"{place}a text holds a lone surrogate such as \\ud800; remove it"
        ) from None


def _no_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a number")


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) != len(pairs):
        seen: set[str] = set()
        twice = next(k for k, _ in pairs if k in seen or seen.add(k))  # type: ignore[func-returns-value]
        raise ValueError(f"the field {printable(twice, 40)!r} appears twice")
    return result


def _written(value: object, indent: str = "") -> str:
    """JSON with an indent of one; lists of numbers take one line, so that spectra stay readable."""
    inner = indent + " "
    if isinstance(value, dict) and value:
        entries = (f"{json.dumps(str(k))}: {_written(v, inner)}" for k, v in value.items())
        return f"{{\n{inner}" + f",\n{inner}".join(entries) + f"\n{indent}}}"
    if isinstance(value, list | tuple) and not all(isinstance(v, int | float) for v in value):
        return (
            f"[\n{inner}" + f",\n{inner}".join(_written(v, inner) for v in value) + f"\n{indent}]"
        )
    return json.dumps(value, allow_nan=False)
