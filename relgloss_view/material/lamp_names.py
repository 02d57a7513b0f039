"""Spectra of the lamps that colour-science knows by name, read in a process of its own.

colour-science and what it imports in turn take 130 MB, which no process gives back. Run as a
program, this module prints the tables as JSON; or which of them a name means.
"""

from __future__ import annotations

import json
import sys
from functools import lru_cache
from typing import Any

from relgloss_view.base.child import run_module
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable

#: Wavelengths (nm) and relative powers.
Table = tuple[tuple[float, ...], tuple[float, ...]]


def lamp_table(name: str) -> Table | None:
    """The spectrum of a lamp by its name; None where colour-science has none of that name.

    The first one takes some seconds. Raises RelglossError where colour-science can't be used.
    """
    tables = _tables()
    return tables.get(name) or tables.get(_meant(name))


@lru_cache(maxsize=1)
def _tables() -> dict[str, Table]:
    tables: dict[str, Any] = _own_tables() if _is_loaded() else json.loads(_asked())
    return {name: (tuple(nm), tuple(power)) for name, (nm, power) in tables.items()}


@lru_cache(maxsize=64)
def _meant(name: str) -> str:
    """The name of the table that another spelling of it means, such as fl2; empty for none."""
    if "\0" in name:  # no program can be given it
        return ""
    return _own_meant(name) if _is_loaded() else str(json.loads(_asked(name)))


def _is_loaded() -> bool:
    """Whether this process has paid for colour-science already."""
    return "colour" in sys.modules


def _asked(*words: str) -> str:
    done = run_module(__spec__.name, *words)
    if done.status != 0:
        reason = done.crash or printable(done.err.strip().rpartition("\n")[2], 200)
        raise RelglossError(f"colour-science, which knows lamps by name, can't be used: {reason}")
    return done.out


def _own_tables() -> dict[str, Any]:
    import colour

    # An illuminant comes before a light source of its name.
    named = {**dict(colour.SDS_LIGHT_SOURCES.items()), **dict(colour.SDS_ILLUMINANTS.items())}
    return {
        str(name): ([float(nm) for nm in lamp.wavelengths], [float(p) for p in lamp.values])
        for name, lamp in named.items()
    }


def _own_meant(name: str) -> str:
    import colour

    for lamps in (colour.SDS_ILLUMINANTS, colour.SDS_LIGHT_SOURCES):
        if name in lamps:
            return next(str(known) for known in lamps if lamps[known] is lamps[name])
    return ""


def main(words: list[str]) -> None:
    """Print all tables, or which of them a name means, as JSON."""
    # colour-science draws with it where it is there; a broken one must not cost the tables.
    sys.modules["matplotlib"] = None  # type: ignore[assignment]
    json.dump(_own_meant(words[0]) if words else _own_tables(), sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1:])
