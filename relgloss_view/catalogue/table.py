"""The table of a catalogue: one Parquet file that pandas, DuckDB and this program read.

Equal rows give equal bytes: nothing of the time or the machine is in it, but for the version of the
library that writes it.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from relgloss_view.base.errors import InputError
from relgloss_view.base.json_files import parse_json
from relgloss_view.base.reading import named, open_regular, printable
from relgloss_view.base.writing import whole_file
from relgloss_view.catalogue.columns import (
    BY_NAME,
    BYTES,
    COLUMNS,
    FLAG,
    NAMES,
    NUMBER,
    TEXT,
    WHOLE,
    Column,
)
from relgloss_view.catalogue.store import faults_of

# Its own allocator would set a gigabyte of addresses aside, which `ulimit -v` may not leave.
pa.set_memory_pool(pa.system_memory_pool())

VERSION = 1  #: of the table
KEY = b"relgloss.catalogue"  #: of the JSON object in the file's metadata
MOST = 1e100  #: of a number; a table that somebody else has written may hold any
ROWS = 200  #: of a row group, which is what the writer holds in memory
MOST_ROWS = 1_000_000  #: of a row group that is read; pandas writes a whole table as one
EXPECTED = "the table of a catalogue (Parquet, from `relgloss catalogue build`)"
_TYPES = {
    TEXT: pa.string(),
    NUMBER: pa.float64(),
    WHOLE: pa.int64(),
    FLAG: pa.bool_(),
    BYTES: pa.binary(),
}


def _field(column: Column) -> pa.Field:
    words = {"unit": column.unit, "meaning": column.meaning}
    return pa.field(column.name, _TYPES[column.kind], metadata=words)


SCHEMA = pa.schema([_field(column) for column in COLUMNS])


def write_table(
    path: Path, rows: Iterable[dict[str, Any]], metadata: dict[str, Any], named_as: Path
) -> None:
    """Write rows, a few hundred at a time; a name that a row lacks is null.

    metadata: goes into the file as JSON, read when the rows are written, so that they may add to
    it. named_as: what a message names. The file appears whole or not at all; raises InputError.
    """
    with whole_file(path) as temporary, faults_of(named_as):
        writer = pq.ParquetWriter(temporary, SCHEMA, compression="zstd", version="2.6")
        try:
            for part in _parts(rows):
                writer.write_table(pa.Table.from_pylist(part, schema=SCHEMA))
            writer.add_key_value_metadata({KEY: json.dumps(metadata, sort_keys=True).encode()})
        finally:
            writer.close()


def _parts(rows: Iterable[dict[str, Any]]) -> Iterator[list[dict[str, Any]]]:
    part: list[dict[str, Any]] = []
    for row in rows:
        part.append(row)
        if len(part) == ROWS:
            yield part
            part = []
    yield part


def read_metadata(path: Path) -> dict[str, Any]:
    """The JSON object in a table's metadata. Raises InputError where it is no catalogue's."""
    with _opened(path) as file:
        held = (file.metadata.metadata or {}).get(KEY)
    try:
        content = parse_json((held or b"").decode("utf-8"))
    except (InputError, UnicodeDecodeError):
        content = None
    if not isinstance(content, dict):
        raise InputError(f"{named(path)}: not {EXPECTED}")
    return content


def rows_in(path: Path) -> int:
    """How many rows a table has; 0 where it is none."""
    try:
        with _opened(path) as file:
            return int(file.metadata.num_rows)
    except InputError:
        return 0


def read_rows(path: Path, names: Collection[str] | None = None) -> list[dict[str, Any]]:
    """The rows, in the file's order, with these columns or, by default, all but the thumbnail."""
    wanted = [name for name in NAMES if name != "thumbnail" and (names is None or name in names)]
    if names is not None and "thumbnail" in names:
        wanted.append("thumbnail")
    rows: list[dict[str, Any]] = []
    with _opened(path) as file:
        # In parts: pyarrow keeps all other threads from working while it makes values of a table.
        for k in range(file.num_row_groups):
            rows += file.read_row_group(k, columns=wanted, use_threads=False).to_pylist()
    numbers = [name for name in wanted if BY_NAME[name].kind == NUMBER]
    for row in rows:
        for name in numbers:
            value = row[name]
            if value is not None and not -MOST <= value <= MOST:  # not of a build; nan too
                row[name] = None
    return rows


def read_thumbnails(path: Path, wanted: Collection[str]) -> dict[str, bytes]:
    """The thumbnails of these paths; a file without one has no entry. Reads what it has to."""
    found: dict[str, bytes] = {}
    left = set(wanted)
    with _opened(path) as file:
        for k in range(file.num_row_groups):
            if not left:
                break
            here = (
                file.read_row_group(k, columns=["path"], use_threads=False)
                .column("path")
                .to_pylist()
            )
            numbers = [n for n, name in enumerate(here) if name in left]
            if numbers:
                column = file.read_row_group(k, columns=["thumbnail"], use_threads=False).column(
                    "thumbnail"
                )
                for n in numbers:
                    data = column[n].as_py()
                    if data is not None:
                        found[here[n]] = data
                left.difference_update(here)
    return found


def _check_counts(footer: pq.FileMetaData, path: Path) -> None:
    """InputError for counts that no build writes: memory is taken by them before a row is read."""
    counts = [footer.row_group(k).num_rows for k in range(footer.num_row_groups)]
    if min(counts, default=0) < 0 or max(counts, default=0) > MOST_ROWS:
        raise InputError(f"{named(path)}: not {EXPECTED} (its counts of rows can't be right)")


@contextmanager
def _opened(path: Path) -> Iterator[pq.ParquetFile]:
    """A table, opened and checked; InputError for what is none."""
    open_regular(path, EXPECTED).close()
    try:
        with pq.ParquetFile(path) as file:
            if not file.schema_arrow.equals(SCHEMA):
                raise InputError(
                    f"{named(path)}: has other columns than this program's; build it again"
                )
            _check_counts(file.metadata, path)
            yield file
    except (pa.ArrowException, MemoryError, OSError, ValueError) as error:
        raise InputError(f"{named(path)}: not {EXPECTED} ({printable(error)})") from error
