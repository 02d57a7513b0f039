"""Mutations of good files as other programs save them: read or InputError, within a bounded time.

A seeded sample of what is run by hand over many more. Whatever is printed of an input is printable.
"""

from __future__ import annotations

import random
import time

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.material.lamp_file import read_lamp
from relgloss_view.measure.readers import read_measurement

TABLE = "\n".join(
    [
        "# quantity: radiance-factor",
        "# aperture_sd_deg: 0.3,0.4",
        "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,390,450,550,650",
        *(f"{a},0,{b},180,-0.0004,0.2,0.3,0.4" for a in (0, 20, 45) for b in (0, 30, 60)),
        "Mean,,,,0,0.2,0.3,0.4",
        "",
    ]
)
LAMP = "nm,power\n" + "".join(f"{nm},{1 + nm % 7}.5\n" for nm in range(380, 781, 5))
ZEMAX = "Source  Measured\nSymmetry  PlaneSymmetrical\nScatterType  BRDF\nSampleRotation  1\n0\n"


#: Long runs of what a careless expression would try to split in every way.
LONG = ["9" * 200_000 + "x", " " * 200_000 + "x", "9 " * 100_000, '"' * 100_001, "theta " * 50_000]


def european(text):
    return text.replace(",", ";").replace(".", ",")


#: Contents of good files; a lamp's are read by another reader.
SEEDS = {
    "plain": TABLE.encode(),
    "european": european(TABLE).encode("utf-16"),
    "tabs": TABLE.replace(",", "\t").encode("utf-16-le"),
    "one cell a line": ('"' + TABLE.replace("\n", '",,\n"') + '"').encode("cp1252"),
    "foreign": ZEMAX.encode(),
    "lamp": LAMP.encode(),
    "european lamp": european(LAMP).encode("utf-16-be"),
}
TOKENS = [
    b",", b";", b"\t", b"\n", b"\r", b'"', b'""', b"#", b"# quantity: brdf\n", b"nan", b"inf", b"-",
    b"n/a", b"1e999", b"0,5", b"1.234,5", b"\x00", b"\xff", b"\xb0", b"\x1b[31m", b"\xef\xbb\xbf",
    b"\xff\xfe", b"Mean", b"deg", b"rad", b"nm", b"theta", b"alpha_deg", b"R,G,B", b"=", b":", b"%",
    b" ", b"-1", b"1.5708", b"# angle_unit: radians\n", b"sep=;\n", b"9" * 400, b"1e-320",
]  # fmt: skip
LIMIT_S = 10.0  #: of one reading, which takes milliseconds; a machine may be busy


def mutated(seed, content):
    """The content with a few random edits: tokens put in, bytes changed, parts repeated or cut."""
    draw = random.Random(seed)
    data = bytearray(content)
    for _ in range(draw.choice((1, 1, 2, 3, 6))):
        at = draw.randrange(len(data) + 1)
        kind = draw.randrange(6)
        if kind < 2:
            data[at:at] = draw.choice(TOKENS)
        elif kind == 2:
            data[at : at + draw.choice((1, 2, 40, 200))] = b""
        elif kind == 3:
            data[at : at + 1] = bytes([draw.randrange(256)])
        elif kind == 4:
            data[at:at] = data[at : at + draw.choice((3, 20, 100))]
        else:
            lines = bytes(data).split(b"\n")
            draw.shuffle(lines)
            data = bytearray(b"\n".join(lines))
    return bytes(data)


def outcome(path, name):
    """'read' or 'refused'; whatever else happens fails."""
    began = time.process_time()
    try:
        if "lamp" in name:
            table = read_lamp(path)
            assert min(table.power) >= 0.0
            assert all(np.diff(table.wavelengths_nm) > 0.0)
            printed = list(table.notes)
        else:
            found = read_measurement(path)
            assert np.isfinite(found.radiance_factor[found.kept]).all()
            assert found.kept.any()
            printed = [found.name, *found.warnings]
        result = "read"
    except InputError as error:
        printed, result = [str(error)], "refused"
    assert time.process_time() - began < LIMIT_S
    assert all(text.isprintable() and len(text) < 900 for text in printed)
    return result


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", SEEDS)
def test_mutations_are_read_or_refused(tmp_path, name):
    path = tmp_path / "input"
    path.write_bytes(SEEDS[name])
    assert outcome(path, name) == ("refused" if name == "foreign" else "read")
    outcomes = set()
    for seed in range(120):
        path.write_bytes(mutated(seed, SEEDS[name]))
        outcomes.add(outcome(path, name))
    assert "refused" in outcomes


@pytest.mark.parametrize("name", ["plain", "european", "lamp"])
@pytest.mark.parametrize("long", range(len(LONG)))
@pytest.mark.parametrize("place", [0, 1, 2, 5])
def test_long_cells_take_no_longer(tmp_path, name, long, place):
    path = tmp_path / "input"
    text = SEEDS[name].decode("utf-16" if name == "european" else "utf-8").split("\n")
    text.insert(place, LONG[long])
    text[place + 1] = text[place + 1].replace(":", ":" + LONG[long])
    path.write_text("\n".join(text))
    outcome(path, name)
