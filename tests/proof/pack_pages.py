"""Packs for the page's tests: artwork and masks in a folder, as a proof carries them."""

from __future__ import annotations

import base64
import dataclasses
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from relgloss_view import Look, Scene
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.pack_file import read_pack
from relgloss_view.picture.scene.sample import load_sample
from relgloss_view.picture.scene.setup import FurtherLamp, Lamp, Setup

FINISHES = (("foil", "cold-foil-gold", "foil.png"), ("varnish", "gloss-varnish", "gloss.png"))


def artwork(mode: str, size: tuple[int, int], seed: int = 3) -> Image.Image:
    """Squares of colour, a band of one colour, and noise; some of it transparent."""
    width, height = size
    rng = np.random.default_rng(seed)
    values = rng.integers(0, 256, (height, width, 4)).astype(np.uint8)
    values[: height // 2] = np.kron(
        rng.integers(0, 256, (8, 8, 4)), np.ones((-(-height // 16), -(-width // 8), 1))
    ).astype(np.uint8)[: height // 2, :width]
    values[height // 2 : -(-3 * height // 4)] = (200, 30, 60, 255)
    picture = Image.fromarray(values)
    if mode == "P":
        return picture.convert("RGB").quantize(13)
    return picture.convert(mode)


def mask(size: tuple[int, int], *, round_one: bool) -> Image.Image:
    """A soft ball, or stripes with soft edges."""
    width, height = size
    x, y = np.meshgrid(np.arange(width) / width - 0.5, np.arange(height) / height - 0.5)
    value = 8.0 * (0.3 - np.hypot(x, y)) if round_one else 4.0 * np.sin(20.0 * x + 9.0 * y)
    return Image.fromarray(np.rint(255.0 * np.clip(value, 0.0, 1.0)).astype(np.uint8))


def make_pack(
    folder: Path,
    form: str,
    *,
    mode: str = "RGB",
    size: tuple[int, int] = (201, 134),
    finishes: Iterable[tuple[str, ...]] = FINISHES,
    more: str = "",
    further: str = "",
    seed: int = 3,
) -> Pack:
    """A pack of a form, with artwork and masks beside its file. more: entries of [pack]."""
    folder.mkdir(parents=True, exist_ok=True)
    artwork(mode, size, seed).save(folder / "art.png")
    mask(size, round_one=True).save(folder / "foil.png")
    mask(size, round_one=False).save(folder / "gloss.png")
    lines = [
        "[pack]", 'name = "p"', f'form = "{form}"', 'artwork = "art.png"', "width_mm = 150.0", more,
        "[[finish]]", 'name = "ink"', 'kind = "ink"', 'material = "matt-varnish"',
    ]  # fmt: skip
    for kind, material, *where in finishes:
        lines += ["[[finish]]", f'name = "{material}"', f'kind = "{kind}"']
        lines += [f'material = "{material}"', f'mask = "{where[0]}"', *where[1:]]
    (folder / "pack.toml").write_text("\n".join([*lines, further]))
    return read_pack(folder / "pack.toml")


def carried(folder: Path) -> dict[str, Any]:
    """The PNG files of a folder, as a proof's content holds them."""
    return {
        path.name: {
            "base64": base64.b64encode(path.read_bytes()).decode("ascii"),
            "type": "image/png",
        }
        for path in folder.glob("*.png")
    }


def pair_of(pack: Pack, look: Look, **setup: Any) -> dict[str, tuple[Scene, Look]]:
    """A pack beside the reference sample on its own form."""
    paper = load_sample("cast-coated")
    whole = dataclasses.replace(Setup(), **setup)
    return {
        "reference": (Scene(paper, whole), Look(0.4, c=1.2)),
        "test": (Scene(pack.material, whole, pack=pack), look),
    }


LIT = {
    "lamp": Lamp(azimuth_deg=35.0, elevation_deg=25.0, ambient=0.25),
    "further_lamps": (FurtherLamp(azimuth_deg=-50.0, elevation_deg=10.0, share=0.5, radius_m=0.1),),
}


def _torus(around: int = 48, across: int = 24, wide: float = 30.0, thick: float = 12.0) -> str:
    """A ring as the text of an OBJ file, in millimetres, with normals and places on the label."""
    lines = []
    for i in range(around + 1):
        for j in range(across + 1):
            a, b = 2.0 * np.pi * i / around, 2.0 * np.pi * j / across
            out = np.array([np.cos(a), np.sin(a), 0.0])
            n = np.cos(b) * out + np.array([0.0, 0.0, np.sin(b)])
            place = wide * out + thick * n
            lines.append("v {:.6f} {:.6f} {:.6f}".format(*place))
            lines.append("vn {:.6f} {:.6f} {:.6f}".format(*n))
            lines.append(f"vt {i / around:.6f} {j / across:.6f}")
    for i in range(around):
        for j in range(across):
            first = i * (across + 1) + j + 1
            corners = (first, first + across + 1, first + across + 2, first + 1)
            lines.append("f " + " ".join(f"{c}/{c}/{c}" for c in corners))
    return "\n".join(lines)


TORUS = _torus()
