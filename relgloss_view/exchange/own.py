"""Our own numbers in files of other programs: a material that comes back as it was.

Beside the refitted parameters a file holds the material's own JSON and a digest of the parameters.
Where the parameters are as they were written, the material is read from that JSON; where somebody
has edited them, it is refitted from what the file states now.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import parse_json
from relgloss_view.material.files import material_from_dict, material_to_dict
from relgloss_view.material.material import Material

EXTRAS = "relgloss"  #: the entry of glTF's `extras` that holds them
MOST_CHARACTERS = 400_000  #: of a material's JSON; its evidence is left out where it is longer
DIGITS = 6  #: significant, of the parameters in a digest


def own_numbers(material: Material, parameters: Mapping[str, Any]) -> dict[str, str]:
    """`material` (JSON text) and `digest` (of the parameters as the file states them)."""
    content = material_to_dict(material)
    text = json.dumps(content, allow_nan=False, separators=(",", ":"))
    if len(text) > MOST_CHARACTERS:
        content.pop("fit", None)
        text = json.dumps(content, allow_nan=False, separators=(",", ":"))
    return {"material": text, "digest": digest_of(parameters)}


def own_material(text: object, digest: object, parameters: Mapping[str, Any]) -> Material | None:
    """The material of own_numbers; None where there is none, or the parameters were edited.

    A JSON that is no material counts as none: the parameters describe the surface.
    """
    if not isinstance(text, str) or digest != digest_of(parameters):
        return None
    if len(text) > 2 * MOST_CHARACTERS:
        return None
    try:
        return material_from_dict(parse_json(text, parse_constant=_no_constant))
    except (InputError, ValueError, RecursionError):
        return None


def _no_constant(name: str) -> float:
    raise ValueError(name)


def digest_of(parameters: Mapping[str, Any]) -> str:
    """SHA-256 of parameters by name, their numbers to 6 significant digits, in any order.

    >>> digest_of({"a": 0.1, "b": (1, 2)}) == digest_of({"b": [1.0, 2.0], "a": 0.1000000001})
    True
    """
    text = json.dumps(_plain(parameters), sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f"{float(value):.{DIGITS}g}"
    return value


def rounded(value: float) -> float:
    """A parameter as files state it: 6 significant digits.

    >>> rounded(1.0 / 3.0)
    0.333333
    """
    return float(f"{value:.{DIGITS}g}")
