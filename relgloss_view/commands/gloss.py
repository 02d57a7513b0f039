"""`relgloss gloss`: the readings of gloss meters, computed from a material or a measured table."""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import WARNING_LENGTH, Column, table
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.scene_options import add_colour_options, colour_from
from relgloss_view.commands.table_options import add_table_options, table_options

if TYPE_CHECKING:
    from relgloss_view.gloss.meter.meter import Reading
    from relgloss_view.material.material import Material

MATERIAL, TABLE, HYPOTHETICAL, ESTIMATED = "material", "table", "hypothetical", "estimated"
MOST_REFLECTED = 1.2  #: of the light received; fits of bright samples may pass 1 by noise


def add(commands: Any) -> None:
    """Declare the command."""
    from relgloss_view.pack.built_in import FINISHES
    from relgloss_view.picture.scene.sample import SAMPLES

    parser = commands.add_parser(
        "gloss",
        description="Compute what gloss meters would read: specular gloss at 20, 60 and 85 "
        "degrees, paper gloss at 75, haze, distinctness of image, and the contrast gloss and "
        "distinctness of Ferwerda and others. Fitted materials give a standard error too; "
        "measured tables give the readings whose directions they hold.",
        epilog="example: relgloss gloss art.json; "
        "relgloss gloss art.json --reading 60=45 -o glossier.json",
    )
    parser.add_argument(
        "samples",
        metavar="MATERIAL.json|SAMPLE|TABLE|PACK",
        nargs="+",
        help="Material that `relgloss fit` wrote, built-in paper "
        f"({', '.join(SAMPLES)}), built-in finish ({', '.join(FINISHES)}), measured table, or a "
        "pack, each of whose finishes is read",
    )
    parser.add_argument(
        "--reading",
        metavar="ANGLE=VALUE",
        type=_wanted,
        help="Find the lobe width with which the material would read VALUE at ANGLE degrees",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="MATERIAL.json",
        help="Write the hypothetical material of --reading into this file",
    )
    add_colour_options(parser)
    add_table_options(parser)
    parser.add_argument("--json", action="store_true", help="Print the readings as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


@dataclass(frozen=True)
class SampleReadings:
    """The gloss readings of one sample of the command line."""

    name: str
    source: str
    kind: str  #: MATERIAL, TABLE, HYPOTHETICAL or ESTIMATED
    readings: tuple[Reading, ...]
    warnings: tuple[str, ...]
    lobe_widths_deg: tuple[float, ...] | None = None  #: of the material that --reading makes
    output: str | None = None  #: the file that this material was written to

    def as_json(self) -> dict[str, Any]:
        """The sample as JSON holds it; readings by their key."""
        numbers: dict[str, Any] = {
            "name": self.name,
            "source": self.source,
            "kind": self.kind,
            "readings": {r.key: _reading_numbers(r) for r in self.readings},
            "warnings": list(self.warnings),
        }
        if self.lobe_widths_deg is not None:
            numbers["s_deg"] = list(self.lobe_widths_deg)
        if self.output is not None:
            numbers["output"] = self.output
        return numbers


def run(args: argparse.Namespace) -> int:
    """Compute all readings, then print; with --reading make the hypothetical material first."""
    if args.output is not None and args.reading is None:
        args.wrong_usage("argument -o: writes the material of --reading, which is missing")
    if args.reading is not None and len(args.samples) != 1:
        args.wrong_usage("argument --reading: expected one material")
    if args.output is not None:
        _check_place(args.output, args.samples[0])
    if args.reading is None:
        samples = [sample for name in args.samples for sample in _read(name, args)]
    else:
        samples = [_hypothetical(args)]
    if args.json:
        print(json.dumps({"samples": [sample.as_json() for sample in samples]}))
        return 0
    print("\n\n".join(_table(sample) for sample in samples))
    if args.output is not None:
        print(f"{printable(args.output)}: written")
    return 0


def _read(name: str, args: argparse.Namespace) -> list[SampleReadings]:
    """The readings of a built-in sample, a material, a measured table, or a pack's finishes."""
    from relgloss_view.gloss.meter.table import table_readings
    from relgloss_view.measure.findings import examine
    from relgloss_view.measure.readers import read_measurement
    from relgloss_view.picture.scene import file_kinds

    kind = file_kinds.MATERIAL if _is_built_in(name) else file_kinds.likely_kind(name)
    if kind == file_kinds.SCENE:
        raise InputError(f"{name}: this is a scene; give a material, a table or a built-in paper")
    if kind == file_kinds.MATERIAL:
        return [_of_material(name, _material(name, args))]
    if args.lab is not None:
        of = "pack has the colours of its artwork; leave"
        of = (
            of
            if kind in file_kinds.OF_PACKS
            else "measured table has its own colour; fit it, or leave"
        )
        raise InputError(f"{name}: a {of} out --lab")
    if kind in file_kinds.OF_PACKS:
        return _of_pack(name)
    measured = read_measurement(name, **table_options(args))
    examined = examine(measured)
    readings = table_readings(examined.measurement)
    warnings = (*examined.measurement.warnings, *examined.texts)
    return [SampleReadings(measured.name, measured.source, TABLE, readings, warnings)]


def _of_pack(name: str) -> list[SampleReadings]:
    """The readings of each finish of a pack, over the material's own diffuse part."""
    from relgloss_view.picture.scene.sample import Sample

    pack = Sample.from_file(name).pack
    assert pack is not None
    read = [_of_material(f"{name}: finish {f.name}", f.material) for f in pack.finishes]
    return [
        dataclasses.replace(one, name=f"{printable(finish.name, 60)}: {one.name}")
        for finish, one in zip(pack.finishes, read, strict=True)
    ]


def _is_built_in(name: str) -> bool:
    """Whether a word names a built-in paper or finish."""
    from relgloss_view.pack.built_in import FINISHES
    from relgloss_view.picture.scene.sample import SAMPLES

    return name in SAMPLES or (name in FINISHES and not os.path.exists(name))


def _of_material(place: str, material: Material) -> SampleReadings:
    import numpy as np

    from relgloss_view.gloss.meter.meter import gloss_readings
    from relgloss_view.material.albedo import directional_albedo

    try:
        readings = gloss_readings(material)
    except InputError as error:  # of a number inside the file
        raise InputError(f"{place}: {error}") from error
    warnings = material.warnings
    limits = [k + 1 for k, lobe in enumerate(material.specular) if lobe.at_the_limit]
    if material.fit and limits:
        text = f"the width of lobe {limits[0]} is the widest there is, so it has no standard error"
        warnings = (*warnings, text)
    reflected = float(np.max(np.sum(directional_albedo(material, 0.0), axis=0)))
    if reflected > MOST_REFLECTED:
        text = (
            f"it reflects {reflected:.3g} times the light that it receives: if its numbers are "
            "percent, divide them by 100"
        )
        warnings = (*warnings, text)
    kind = HYPOTHETICAL if material.hypothetical else MATERIAL
    kind = ESTIMATED if material.estimate else kind
    return SampleReadings(material.name, material.source, kind, readings, warnings)


def _hypothetical(args: argparse.Namespace) -> SampleReadings:
    """The readings of the material whose lobe width gives the wanted one; written if asked."""
    from relgloss_view.gloss.meter.meter import gloss_readings, hypothetical
    from relgloss_view.material.files import save_material

    angle_deg, value = args.reading
    material = hypothetical(_material(args.samples[0], args), angle_deg, value)
    if args.output is not None:
        save_material(material, args.output)
    return SampleReadings(
        name=material.name,
        source=material.source,
        kind=HYPOTHETICAL,
        readings=gloss_readings(material),
        warnings=material.warnings,
        lobe_widths_deg=tuple(lobe.s_deg for lobe in material.specular),
        output=args.output,
    )


def _material(name: str, args: argparse.Namespace) -> Material:
    """The material of a built-in paper or a file, in the colour of the options."""
    from relgloss_view.pack.built_in import load_finish
    from relgloss_view.picture.scene.sample import SAMPLES, Sample

    if name not in SAMPLES and _is_built_in(name):
        sample = Sample(load_finish(name))
    else:
        sample = Sample.built_in(name) if name in SAMPLES else Sample.from_file(name)
    if sample.pack is not None:
        raise InputError(f"{name}: this is a pack; give one of its materials")
    colour = colour_from(args)
    return sample.material if colour is None else sample.in_colour(colour).material


def _reading_numbers(reading: Reading) -> dict[str, Any]:
    """A reading as JSON; the key is its name there."""
    return {k: v for k, v in dataclasses.asdict(reading).items() if k != "key"}


COLUMNS = (
    Column("", 29, left=True),
    Column("", 36, left=True),
    Column("reading", 8),
    Column("se", 8),
    Column("diffuse", 8),
    Column("", left=True),
)


def _table(sample: SampleReadings) -> str:
    """A sample's readings in columns."""
    mark = " [estimated]" if sample.kind == ESTIMATED else ""
    lines = [f"{printable(sample.name)}{mark}", f"  {printable(sample.source)}"]
    if sample.lobe_widths_deg is not None:
        widths = ", ".join(f"{width:.4g}" for width in sample.lobe_widths_deg)
        lines.append(f"  lobe widths {widths} degrees; no one has measured such a sample")
    lines.append(table(COLUMNS, [_row(reading) for reading in sample.readings], indent="  "))
    lines += [f"  warning: {printable(text, WARNING_LENGTH)}" for text in sample.warnings]
    return "\n".join(lines)


def _row(reading: Reading) -> tuple[str, ...]:
    if reading.value is None:
        return reading.name, reading.standard, "-", "", "", reading.reason
    parts = reading.error_words, reading.words(reading.diffuse)
    return reading.name, reading.standard, reading.words(reading.value), *parts, reading.note


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
