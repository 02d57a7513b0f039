"""Draw the four sample papers and the shipped packs, their gloss in the right ratio to cast-coated.

A sheet shows the papers, another the packs; the reference is the same.

Run: python scripts/demo.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from PIL import Image

import relgloss_view as rg
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.resources import asset
from relgloss_view.base.writing import make_folder
from relgloss_view.cli import main as relgloss
from relgloss_view.picture.output.contact_sheet import contact_sheet
from relgloss_view.picture.output.png import save_rgb
from relgloss_view.picture.scene.look import viewed_look

SIZE = (512, 512)
SAMPLES_A_SIDE = 3
#: Words of `relgloss snapshot` for the shipped packs, and for both.
PACKS = {
    "can": "--set lamp.azimuth_deg=32 --set lamp.elevation_deg=14",
    "carton": "--set eye.azimuth_deg=28 --set eye.elevation_deg=10 "
    "--set lamp.azimuth_deg=-24 --set lamp.elevation_deg=2",
}
LIGHT = "--set lamp.radius_m=0.08 --further-lamp=-55,10,1,0.08,0.35 --lamp given"


def main(folder_name: str) -> int:
    folder = make_folder(folder_name)
    pictures, captions = [], []
    reference = rg.Reference.default()
    display = rg.Display().for_the_eye()
    with rg.open_renderer() as renderer:
        for name, published in rg.SAMPLES.items():
            material, sigma_n_deg = rg.load_sample(name), published.sigma_n_deg
            c = rg.matched(reference, material, sigma_n_deg).test_c
            look = viewed_look(sigma_n_deg=sigma_n_deg, c=c, samples=SAMPLES_A_SIDE)
            frame = renderer.render(rg.Scene(material, display=display), look, SIZE)
            options = f"--sample {name} --samples {SAMPLES_A_SIDE}"
            command = f"relgloss snapshot {options} -o {name}.png"
            rg.save_frame(frame, folder / f"{name}.png", command)
            rg.save_frame(frame, folder / f"{name}.exr", command)
            pictures.append(frame.display)
            captions.append(f"{name}: {sigma_n_deg:.1f} deg, c {c:.3f}")
            print(f"{folder / name}.png, .exr: c = {frame.c:.3g}, c_max = {frame.c_max:.3g}")
    sheet = contact_sheet(
        [pictures],
        [captions],
        "Relative-glossiness matched pictures",
        "synthetic papers under one green ink, matched to cast-coated (relgloss match)",
    )
    save_rgb(sheet, folder / "contact-sheet.png", {"Software": f"relgloss {rg.__version__}"})
    draw_packs(folder)
    print(f"look at {folder / 'contact-sheet.png'} and {folder / 'packs.png'}")
    return 0


def draw_packs(folder: Path) -> None:
    """Draw the shipped packs, each finish matched, as `relgloss snapshot` does, and their sheet."""
    pictures, captions = [], []
    for name, words in PACKS.items():
        pack, made = asset("packs", f"{name}.toml"), folder / f"{name}.png"
        options = f"{words} {LIGHT} --samples {SAMPLES_A_SIDE}".split()
        if relgloss(["snapshot", "--pack", str(pack), *options, "-o", str(made)]) != 0:
            raise RelglossError(f"{name}: not drawn")
        with Image.open(made) as picture:
            pictures.append(np.asarray(picture.convert("RGB")))
        captions.append(rg.read_pack(pack).name)
    sheet = contact_sheet(
        [pictures],
        [captions],
        "Packs of invented brands",
        "each finish matched to the same reference as the papers (docs/packs.md)",
    )
    save_rgb(sheet, folder / "packs.png", {"Software": f"relgloss {rg.__version__}"})


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "out"))
    except RelglossError as error:
        sys.exit(f"relgloss: {error}")
