"""Catalogue: the folder that `relgloss catalogue build` has made, to be read."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, printable, refuse
from relgloss_view.catalogue import table
from relgloss_view.catalogue.columns import TABLE_FILE
from relgloss_view.catalogue.places import in_system, parts_within
from relgloss_view.catalogue.recipe import MOST_THUMBNAIL_PX, Recipe
from relgloss_view.catalogue.tree import FORMAT, MARK, is_catalogue
from relgloss_view.gloss.samples import GLOSSES
from relgloss_view.material.files import load_material
from relgloss_view.material.material import Material

REMEDY = "give the folder that `relgloss catalogue build` has made"


@dataclass(frozen=True)
class Catalogue:
    """A catalogue. Its rows are read once, its thumbnails and materials when they are asked for.

    folder: as it was opened. recipe: how its items were fitted, matched and drawn. metadata: what
    the table's file holds beside its rows: the program's version, the drivers, the recipe.
    """

    folder: Path
    recipe: Recipe
    metadata: dict[str, Any] = field(repr=False)

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Catalogue:
        """The catalogue of a folder. Raises InputError where it is none, or holds no table yet.

        >>> Catalogue.open("no such folder")
        Traceback (most recent call last):
        ...
        relgloss_view.base.errors.InputError: no such folder: is no catalogue; give the folder ...
        """
        place = Path(folder)
        try:
            if (place / MARK).is_file():  # a pipe would keep whoever opens it waiting
                (place / MARK).open("rb").close()
        except PermissionError as error:
            reason = f"can't be read ({error.strerror}); ask its owner for the right to read it"
            raise InputError(f"{named(place)}: {reason}") from error
        except OSError:
            pass  # none, or one in the words below
        if not is_catalogue(place):
            raise InputError(f"{named(place)}: is no catalogue; {REMEDY}")
        path = place / TABLE_FILE
        if not os.path.lexists(path):
            raise InputError(
                f"{named(place)}: holds no table yet, because its build did not end; build it again"
            )
        metadata = table.read_metadata(path)
        if metadata.get("format") != FORMAT or metadata.get("version") != table.VERSION:
            refuse(f"{named(path)}: version", f"{table.VERSION}", metadata.get("version"))
        return cls(place, recipe_of(metadata.get("recipe"), path), metadata)

    @property
    def table(self) -> Path:
        """The Parquet file."""
        return self.folder / TABLE_FILE

    @cached_property
    def rows(self) -> tuple[dict[str, Any], ...]:
        """A row a file, sorted by path: every column but the thumbnail."""
        return tuple(table.read_rows(self.table))

    @cached_property
    def _by_path(self) -> dict[str, dict[str, Any]]:
        return {row["path"]: row for row in self.rows}

    def columns(self, names: Iterable[str]) -> list[dict[str, Any]]:
        """The rows with these columns alone, read from the file each time."""
        return table.read_rows(self.table, tuple(names))

    def row(self, path: str) -> dict[str, Any]:
        """The row of a file; InputError where there is none."""
        try:
            return self._by_path[path]
        except KeyError:
            name = printable(path, 100)
            raise InputError(f"{named(self.folder)}: has no file {name!r}") from None

    def thumbnails(self, paths: Iterable[str]) -> Mapping[str, bytes]:
        """Pictures (PNG) by path; an item without one is not in it."""
        return table.read_thumbnails(self.table, set(paths))

    def thumbnail(self, path: str) -> bytes | None:
        """The picture (PNG) of one item; None where it has none."""
        return self.thumbnails([path]).get(path)

    def material_file(self, path: str) -> Path:
        """The material file of an item; InputError where it has none."""
        place = self.row(path)["material"]
        if not place:
            raise InputError(f"{printable(path, 100)}: has no material, because it has failed")
        parts = parts_within(place)
        if not parts:
            raise InputError(f"{named(self.table)}: names a material outside the catalogue")
        return self.folder.joinpath(*map(in_system, parts))

    def material(self, path: str) -> Material:
        """The material of an item. Raises InputError."""
        return load_material(self.material_file(path))


def recipe_of(content: object, place: Path) -> Recipe:
    """The recipe of a table's metadata; InputError where it is none."""
    try:
        values = dict(content)  # type: ignore[call-overload]
        values.pop("revision")
        recipe = Recipe(**values)
        _check(recipe)
        return recipe
    except (TypeError, ValueError, KeyError) as error:
        raise InputError(f"{named(place)}: holds no recipe ({MARK} and it differ?)") from error


def _check(recipe: Recipe) -> None:
    """Raise ValueError where a value is none that a recipe holds."""
    numbers = [recipe.reference_sigma_n_deg]
    numbers += [] if recipe.reference_c is None else [recipe.reference_c]
    is_number = [isinstance(v, int | float) and not isinstance(v, bool) for v in numbers]
    options = (recipe.fit, recipe.table)
    right = (
        isinstance(recipe.reference, str | dict)
        and all(is_number)
        and recipe.gloss in GLOSSES
        and type(recipe.thumbnail_px) is int
        and 1 <= recipe.thumbnail_px <= MOST_THUMBNAIL_PX
        and all(isinstance(one, dict) for one in options)
    )
    if not right:
        raise ValueError("a value of a recipe")
