"""Draw the four sample papers with their gloss in the right ratio to cast-coated, and a sheet.

Run: python scripts/demo.py [FOLDER]
"""

from __future__ import annotations

import sys

import relgloss_view as rg
from relgloss_view.base.errors import RelglossError
from relgloss_view.base.writing import make_folder
from relgloss_view.picture.output.contact_sheet import contact_sheet
from relgloss_view.picture.output.png import save_rgb
from relgloss_view.picture.scene.look import viewed_look

SIZE = (512, 512)
SAMPLES_A_SIDE = 3


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
    print(f"look at {folder / 'contact-sheet.png'}")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "out"))
    except RelglossError as error:
        sys.exit(f"relgloss: {error}")
