"""Judges of glTF files that nobody here wrote: Khronos's validator, and trimesh."""

from __future__ import annotations

import io
import json
import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

FOLDER = Path(__file__).resolve().parents[2] / "requirements" / "gltf-validator"
SCRIPT = """
const fs = require("fs"), validator = require("gltf-validator");
Promise.all(process.argv.slice(1).map(async (file) => {
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
  return report.issues;
})).then((issues) => console.log(JSON.stringify(issues)));
"""


def validated(*files: Path) -> list[dict]:
    """The validator's issues of each file: numErrors, numWarnings, messages."""
    if shutil.which("node") is None:
        pytest.fail("node is missing. Install it: scripts/system-packages test", pytrace=False)
    if not (FOLDER / "node_modules" / "gltf-validator").is_dir():
        pytest.fail(
            "gltf-validator is missing. Install it: npm ci --prefix requirements/gltf-validator "
            "--ignore-scripts (make test does)",
            pytrace=False,
        )
    words = ["node", "-e", SCRIPT, *map(str, files)]
    done = subprocess.run(words, cwd=FOLDER, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def parts_of(data: bytes) -> tuple[dict, bytes]:
    """The JSON and the binary part of a .glb."""
    (length,) = struct.unpack("<I", data[12:16])
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def rebuilt(content: dict, binary: bytes) -> bytes:
    """A .glb of another JSON."""
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary))
    chunk = struct.pack("<I4s", len(text), b"JSON") + text
    return head + chunk + struct.pack("<I4s", len(binary), b"BIN\0") + binary


def picture(content: dict, binary: bytes, texture: int) -> np.ndarray:
    """The pixels of a texture, (H, W, C)."""
    image = content["images"][content["textures"][texture]["source"]]
    view = content["bufferViews"][image["bufferView"]]
    begin = view["byteOffset"]
    return np.asarray(Image.open(io.BytesIO(binary[begin : begin + view["byteLength"]])))
