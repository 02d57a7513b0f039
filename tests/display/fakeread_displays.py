"""Displays behind Argyll's fakeread: what its tools read, and what they make."""

from __future__ import annotations

import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest

from relgloss_view.base.icc.profile import read_profile

COLORD = Path("/usr/share/color/icc/colord")
needs_argyll = pytest.mark.skipif(
    not (shutil.which("fakeread") and shutil.which("targen") and COLORD.is_dir()),
    reason="needs Argyll (fakeread, targen) and colord's profiles",
)


def version_2(name, folder):
    """A colord profile as ICC version 2, which Argyll 2.3 reads: curves of 4096 samples."""
    data = (COLORD / f"{name}.icc").read_bytes()
    profile = read_profile(data)
    count = struct.unpack_from(">I", data, 128)[0]
    tags = {
        t: data[o : o + n] for t, o, n in struct.iter_unpack(">4sII", data[132 : 132 + 12 * count])
    }
    made = {key: tags[key] for key in (b"wtpt", b"rXYZ", b"gXYZ", b"bXYZ")}
    text = b"display\0"
    made[b"desc"] = b"desc" + bytes(4) + struct.pack(">I", len(text)) + text + bytes(78)
    made[b"cprt"] = b"text" + bytes(4) + b"none\0"
    at = np.linspace(0.0, 1.0, 4096)
    for k, key in enumerate((b"rTRC", b"gTRC", b"bTRC")):
        samples = np.round(65535.0 * np.clip(profile.curves[k](at), 0.0, 1.0)).astype(">u2")
        made[key] = b"curv" + bytes(4) + struct.pack(">I", 4096) + samples.tobytes()
    table, body, start = b"", b"", 132 + 12 * len(made)
    for key, tag in made.items():
        table += struct.pack(">4sII", key, start + len(body), len(tag))
        body += tag + bytes(-len(tag) % 4)
    head = bytearray(data[:128])
    head[:4] = struct.pack(">I", start + len(body))
    head[8:12] = b"\x02\x40\x00\x00"
    file = folder / f"{name}.icc"
    file.write_bytes(bytes(head) + struct.pack(">I", len(made)) + table + body)
    return file


def run(folder, *words):
    """Run one of Argyll's tools in a folder."""
    done = subprocess.run([str(w) for w in words], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


def read(folder, profile, chart, name, *options):
    """The .ti3 that fakeread makes of a chart (.ti1 in the folder)."""
    shutil.copyfile(folder / f"{chart}.ti1", folder / f"{name}.ti1")
    run(folder, "fakeread", *options, profile, name)
    return folder / f"{name}.ti3"


def charts(folder, count=100, unseen=500):
    """chart.ti1 as targen spreads patches, and unseen.ti1 of random ones."""
    run(folder, "targen", "-d3", f"-f{count}", "chart")
    run(folder, "targen", "-d3", "-r", "-e1", "-B0", f"-f{unseen}", "unseen")
