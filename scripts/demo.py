"""Draw the four sample papers at the settings that the paper's observers chose, and a sheet.

Run: python scripts/demo.py [FOLDER]
"""

from __future__ import annotations

import dataclasses
import sys

import relgloss_view as rg
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.writing import make_folder
from relgloss_view.picture.output.contact_sheet import contact_sheet
from relgloss_view.picture.output.png import save_rgb

SIZE = (512, 512)
SAMPLES_A_SIDE = 3


def main(folder_name: str) -> int:
    folder = make_folder(folder_name)
    pictures, captions = [], []
    with rg.open_renderer() as renderer:
        for name, matched in rg.SAMPLES.items():
            look = dataclasses.replace(rg.Look().at(matched), samples=SAMPLES_A_SIDE)
            frame = renderer.render(rg.Scene(rg.load_sample(name)), look, SIZE)
            options = f"--sample {name} --matched --samples {SAMPLES_A_SIDE}"
            command = f"relgloss snapshot {options} -o {name}.png"
            rg.save_frame(frame, folder / f"{name}.png", command)
            rg.save_frame(frame, folder / f"{name}.exr", command)
            pictures.append(frame.display)
            sixths = round(6 * matched.c_fraction)
            captions.append(f"{name}: {matched.sigma_n_deg:.1f} deg, {sixths}/6 c_max")
            print(f"{folder / name}.png, .exr: c = {frame.c:.3g}, c_max = {frame.c_max:.3g}")
    sheet = contact_sheet(
        [pictures],
        [captions],
        "Relative-glossiness matched pictures",
        "synthetic papers under one green ink; sigma_N and c as published by Ishii et al.",
    )
    save_rgb(sheet, folder / "contact-sheet.png", {"Software": f"relgloss {rg.__version__}"})
    print(f"look at {folder / 'contact-sheet.png'}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "out"))
    except RelglossError as error:
        sys.exit(f"relgloss: {error}")
