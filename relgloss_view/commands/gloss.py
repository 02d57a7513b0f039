"""`relgloss gloss`: what gloss meters would read on a material, or read in a measured table."""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import os
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.fit import QUANTITIES

if TYPE_CHECKING:
    from relgloss_view.gloss.meter.meter import Reading
    from relgloss_view.material.material import Material
    from relgloss_view.measure.table import Measurement


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.picture.scene.sample import SAMPLES

    parser = commands.add_parser(
        "gloss",
        description="Specular gloss at 20, 60 and 85 degrees and of paper at 75, haze, "
        "distinctness of image, and contrast gloss and distinctness as Ferwerda and others define "
        "them; from fitted materials with the uncertainty that the fit implies, and from measured "
        "tables where they hold the directions.",
        epilog="example: relgloss gloss art.json; "
        "relgloss gloss art.json --reading 60=45 -o glossier.json",
    )
    parser.add_argument(
        "samples",
        metavar="MATERIAL.json|SAMPLE|TABLE",
        nargs="+",
        help=f"a material that `fit` wrote, a built-in paper ({', '.join(SAMPLES)}), or a table",
    )
    parser.add_argument(
        "--reading",
        metavar="ANGLE=VALUE",
        type=_wanted,
        help="the other way round: the lobe width that would read VALUE at ANGLE",
    )
    parser.add_argument(
        "-o", "--output", metavar="MATERIAL.json", help="write that hypothetical material"
    )
    parser.add_argument(
        "--quantity", choices=QUANTITIES, help="what a table holds, where it does not say so"
    )
    parser.add_argument(
        "--gamma-s-deg", metavar="DEG", type=float, help="tilt that sees the mirror direction"
    )
    parser.add_argument("--json", action="store_true", help="print the readings as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Read everything, then print; with --reading make the hypothetical material first."""
    if args.output is not None and args.reading is None:
        args.wrong_usage(
            "argument -o: gives a place to the material of --reading, which is missing"
        )
    if args.reading is not None and len(args.samples) != 1:
        args.wrong_usage("argument --reading: expected one material")
    if args.output is not None:
        _check_place(args.output, args.samples[0])
    if args.reading is None:
        found = [_read(name, args) for name in args.samples]
    else:
        found = [_hypothetical(args)]
    if args.json:
        print(json.dumps({"samples": found}))
        return 0
    print("\n\n".join(_table(sample) for sample in found))
    if args.output is not None:
        print(f"{printable(args.output)}: written")
    return 0


def _read(name: str, args: argparse.Namespace) -> dict[str, Any]:
    """Name, source, readings and warnings of a built-in sample, a material or a table."""
    from relgloss_view.gloss.meter.table import table_readings
    from relgloss_view.measure.readers import read_measurement
    from relgloss_view.picture.scene import file_kinds
    from relgloss_view.picture.scene.sample import SAMPLES

    kind = file_kinds.MATERIAL if name in SAMPLES else file_kinds.likely_kind(name)
    if kind == file_kinds.SCENE:
        raise InputError(f"{name}: this is a scene; give a material, a table or a built-in paper")
    if kind == file_kinds.MATERIAL:
        return _of_material(name, _material(name))
    table = read_measurement(name, quantity=args.quantity, gamma_s_deg=args.gamma_s_deg)
    return _found("table", table, table_readings(table), table.warnings)


def _of_material(place: str, material: Material) -> dict[str, Any]:
    from relgloss_view.gloss.meter.meter import gloss_readings

    try:
        readings = gloss_readings(material)
    except InputError as error:  # of a number inside the file
        raise InputError(f"{place}: {error}") from error
    found = _found("material", material, readings, material.warnings)
    limits = [k + 1 for k, lobe in enumerate(material.specular) if lobe.at_the_limit]
    if material.fit and limits:
        found["warnings"].append(
            f"the width of lobe {limits[0]} is the widest there is, so it has no standard error"
        )
    return found


def _hypothetical(args: argparse.Namespace) -> dict[str, Any]:
    """The readings of the material whose lobe width gives the wanted one; written if asked."""
    from relgloss_view.gloss.meter.meter import gloss_readings, hypothetical
    from relgloss_view.material.files import save_material

    angle_deg, value = args.reading
    material = hypothetical(_material(args.samples[0]), angle_deg, value)
    found = _found("hypothetical", material, gloss_readings(material), material.warnings)
    found["s_deg"] = [lobe.s_deg for lobe in material.specular]
    if args.output is not None:
        save_material(material, args.output)
        found["output"] = args.output
    return found


def _material(name: str) -> Material:
    from relgloss_view.material.files import load_material
    from relgloss_view.picture.scene.sample import SAMPLES, load_sample

    return load_sample(name) if name in SAMPLES else load_material(name)


def _found(
    kind: str,
    of: Material | Measurement,
    readings: tuple[Reading, ...],
    warnings: tuple[str, ...],
) -> dict[str, Any]:
    return {
        "name": of.name,
        "source": of.source,
        "kind": "hypothetical" if getattr(of, "hypothetical", False) else kind,
        "readings": {r.key: _shown(r) for r in readings},
        "warnings": list(warnings),
    }


def _shown(reading: Reading) -> dict[str, Any]:
    """A reading as JSON: its key is the name of it."""
    return {k: v for k, v in dataclasses.asdict(reading).items() if k != "key"}


def _table(sample: dict[str, Any]) -> str:
    """A sample's readings in columns."""
    lines = [printable(sample["name"]), f"  {printable(sample['source'])}"]
    if "s_deg" in sample:
        widths = ", ".join(f"{s:.4g}" for s in sample["s_deg"])
        lines.append(f"  lobe widths {widths} degrees; no one has measured such a sample")
    lines.append(f"  {'':31}{'':38}{'reading':>8}{'se':>10}{'diffuse':>10}")
    for reading in sample["readings"].values():
        line = f"  {reading['name']:31}{reading['standard']:38}"
        if reading["value"] is None:
            lines.append(f"{line}{'-':>8}  {reading['reason']}")
            continue
        error, diffuse = reading["standard_error"], reading["diffuse"]
        line += f"{reading['value']:8.4g}"
        line += f"{'' if error is None else f'{error:.2g}':>10}"
        line += f"{'' if diffuse is None else f'{diffuse:.2g}':>10}"
        lines.append(f"{line.rstrip()}  {reading['note']}".rstrip())
    lines += [f"  warning: {printable(text, 300)}" for text in sample["warnings"]]
    return "\n".join(lines)


def _wanted(text: str) -> tuple[float, float]:
    """Angle and gloss units of words such as 60=45."""
    angle, mark, value = text.partition("=")
    try:
        numbers = float(angle), float(value)
    except ValueError:
        numbers = (math.nan, math.nan)
    if not (mark and all(math.isfinite(n) for n in numbers)):
        raise argparse.ArgumentTypeError(f"expected ANGLE=VALUE such as 60=45, found {text!r}")
    return numbers


def _check_place(output: str, source: str) -> None:
    """Refuse a name that is wrong, can't be written, or is the material itself."""
    if not output.lower().endswith(".json"):
        raise InputError(f"-o {output or repr(output)}: expected a name that ends in .json")
    check_writable(output)
    if os.path.realpath(output) == os.path.realpath(source.replace("\0", "")):
        raise InputError(f"-o {output}: is the material itself; choose another place")
