"""The tables of docs/exchange.md: what the programs of others lose of our papers and finishes.

    python scripts/exchange_losses.py                       # all tables
    python scripts/exchange_losses.py --model glTF --only kraft
    python scripts/exchange_losses.py --round-trips --only kraft

Each row is a material of this program; a table is ready to be pasted into the page. A round trip
writes a file and reads it again, once as it is and once without our own numbers in it, as a file
is that another program has saved.
"""

from __future__ import annotations

import argparse
import json
import re
import struct
import tempfile
from collections.abc import Callable
from pathlib import Path

from relgloss_view.exchange import judge
from relgloss_view.exchange.formats import ExportOptions, format_of, reader_of
from relgloss_view.exchange.gltf_refit import refit_gltf
from relgloss_view.exchange.principled import refit_principled
from relgloss_view.exchange.refit import Refit, refit_openpbr
from relgloss_view.material.material import Material
from relgloss_view.pack.built_in import FINISHES, PAPERS, load_finish

#: The models of other programs, and the search for their parameters.
MODELS: dict[str, Callable[[Material], Refit]] = {
    "OpenPBR": refit_openpbr,
    "glTF": refit_gltf,
    "principled": refit_principled,
}
ENDINGS = (".mtlx", ".glb")
JSON_CHUNK = 0x4E4F534A  #: of a binary glTF 2.0


def main() -> int:
    """Print the tables that are asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    names = (*PAPERS, *FINISHES)
    parser.add_argument("--only", action="append", choices=names, help="Material to try alone")
    parser.add_argument("--model", action="append", choices=list(MODELS), help="Model to try alone")
    parser.add_argument("--round-trips", action="store_true", help="Print the round trips alone")
    args = parser.parse_args()
    chosen = args.only or list(names)
    if not args.round_trips:
        for model in args.model or MODELS:
            _losses(model, chosen)
    if args.round_trips or not args.model:
        for ending in ENDINGS:
            _round_trips(ending, chosen)
    return 0


def _losses(model: str, names: list[str]) -> None:
    """The table of one model: dE2000 in the highlight and gloss units, ours and theirs."""
    print(f"\n{model}\n")
    print("| material | dE2000 p95 / largest | gloss 20 | 60 | 75 | 85 | fitted with |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for name in names:
        refit = MODELS[model](load_finish(name))
        loss = refit.loss
        cells = [f"{ours:.1f} → {theirs:.1f}" for ours, theirs in loss.gloss_units.values()]
        seen = f"{loss.de2000_p95:.1f} / {loss.de2000_max:.1f}"
        print(f"| {' | '.join((name, seen, *cells, refit.way))} |", flush=True)


def _round_trips(ending: str, names: list[str]) -> None:
    """The table of one format: a material against what comes back of its file."""
    print(f"\n{ending}, out and in again\n")
    print("| material | as it was | gloss units | dE2000 p95 |")
    print("| --- | --- | --- | --- |")
    for name in names:
        material = load_finish(name)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"material{ending}"
            format_of(path).write(material, path, ExportOptions(most_px=16))
            is_same = reader_of(path).read(path, None) == material
            path.write_bytes(without_own_numbers(path.read_bytes()))
            back = reader_of(path).read(path, None)
        if back.described is None:
            raise SystemExit(f"{name}: our own numbers are still in the file")
        loss = judge.compare(material, back)
        cells = (name, "yes" if is_same else "NO")
        numbers = f"{loss.largest_gloss_units:.1f} | {loss.de2000_p95:.1f}"
        print(f"| {' | '.join(cells)} | {numbers} |", flush=True)


def without_own_numbers(data: bytes) -> bytes:
    """A .mtlx or .glb file without what only this program reads."""
    if not data.startswith(b"glTF"):
        return re.sub(rb""" relgloss_\w+=("[^"]*"|'[^']*')""", b"", data)
    (length,) = struct.unpack_from("<I", data, 12)
    content = json.loads(data[20 : 20 + length])
    for entry in content["materials"]:
        entry.pop("extras", None)
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    return head + struct.pack("<II", len(text), JSON_CHUNK) + text + rest


if __name__ == "__main__":
    raise SystemExit(main())
