"""Draw the pictures of packs in README and docs/packs.md: docs/images/packs.png, pack-*.png.

Run: python scripts/pack_pictures.py [FOLDER]

Each part of a picture is drawn by `relgloss snapshot`; the words are in PICTURES. Can, carton and
bottle have the artwork of assets/packs, and the pouch one that is drawn here.
"""

from __future__ import annotations

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from relgloss_view.base.resources import asset
from relgloss_view.cli import main as relgloss
from relgloss_view.pack.built_in import FINISHES
from relgloss_view.picture.output.contact_sheet import contact_sheet

PIXELS_A_MM = 6
FILM_MM = (280, 197)  #: of the pouch's usual size
#: Light of a photographer's table: a soft box, a weaker one from the left, and the room.
TABLE = (
    "--set lamp.radius_m=0.08 --set lamp.elevation_deg=14 --set lamp.ambient=0.3 "
    "--further-lamp=-55,10,1,0.08,0.35 --lamp given"
)
#: Of the bottle: radius and height.
OUTLINE_MM = [
    [27, 0], [32.5, 5], [32.5, 118], [29, 145], [17, 178], [13, 188], [13, 196],
    [15, 198], [15, 200], [13, 202], [13.5, 204], [13.5, 219],
]  # fmt: skip
LABEL = """
[[finish]]
name = "ink"
material = "{ink}"

[[finish]]
name = "foil"
kind = "foil"
material = "{foil}"
mask = "{foil_mask}"

[[finish]]
name = "spot gloss"
kind = "varnish"
material = "gloss-varnish"
mask = "{gloss_mask}"
"""
#: Parts of the pictures: size, and words of `relgloss snapshot`.
PICTURES = {
    "can": ("300x420", f"--pack {{packs}}/can.toml --set lamp.azimuth_deg=32 {TABLE}"),
    "carton": (
        "260x420",
        "--pack {packs}/carton.toml --set eye.azimuth_deg=28 --set eye.elevation_deg=10 "
        f"{TABLE} --set lamp.azimuth_deg=-24 --set lamp.elevation_deg=2",
    ),
    "bottle": ("220x420", f"--pack {{here}}/bottle.toml --set lamp.azimuth_deg=32 {TABLE}"),
    "pouch": (
        "340x420",
        f"--pack {{here}}/pouch.toml --set eye.azimuth_deg=-16 --set lamp.azimuth_deg=24 {TABLE}",
    ),
    "near": (
        "480x360",
        "--pack {packs}/can.toml --set eye.field_of_view_deg=4.6 --set eye.azimuth_deg=-14 "
        "--set eye.shift_up=-0.035 --set eye.shift_right=0.02 "
        f"{TABLE} --set lamp.azimuth_deg=16 --set lamp.elevation_deg=0",
    ),
}
#: Of the built-in finishes, each on a cylinder under blue ink.
SWATCH, IN_A_ROW = "180x150", 5
_LEVEL = TABLE.replace("elevation_deg=14", "elevation_deg=0").replace("-55,10,", "-55,0,")
SWATCH_WORDS = f"--set lamp.azimuth_deg=32 {_LEVEL}"


def film(folder: Path) -> None:
    """The artwork of the pouch: an invented coffee, with plates as gray pictures."""
    width, height = (PIXELS_A_MM * mm for mm in FILM_MM)

    def letters(px: int) -> ImageFont.FreeTypeFont:
        import matplotlib

        fonts = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
        return ImageFont.truetype(fonts / "DejaVuSans-Bold.ttf", px)

    picture = Image.new("RGB", (width, height), (46, 32, 30))
    foil, gloss = Image.new("L", (width, height)), Image.new("L", (width, height))
    pen, foil_pen, gloss_pen = (ImageDraw.Draw(image) for image in (picture, foil, gloss))
    middle = width // 2
    pen.rectangle((0, 0.62 * height, width, height), fill=(196, 92, 54))
    for k in range(-7, 8):  # hills, right across the film
        x = middle + k * 0.075 * width
        top = (0.5 + 0.05 * (k % 3)) * height
        hill = [(x - 0.09 * width, 0.63 * height), (x, top), (x + 0.09 * width, 0.63 * height)]
        pen.polygon(hill, fill=((122, 60, 48), (150, 72, 50), (98, 50, 46))[k % 3])
    sun = (middle - 110, 0.3 * height - 110, middle + 110, 0.3 * height + 110)
    pen.ellipse(sun, fill=(232, 184, 96))
    foil_pen.ellipse(sun, fill=255)
    for text, y, px, ink in (
        ("ALTURA", 0.72, 150, (250, 238, 220)),
        ("whole bean coffee", 0.81, 50, (250, 238, 220)),
        ("250 g", 0.88, 44, (46, 32, 30)),
    ):
        pen.text((middle, y * height), text, ink, letters(px), "mm")
        if px > 100:
            gloss_pen.text((middle, y * height), text, 255, letters(px), "mm")
    for x in (0.0, float(width)):  # the back, whose middle is the film's edges
        pen.text((x, 0.3 * height), "ALTURA", (250, 238, 220), letters(90), "mm")
    picture.save(folder / "film.png", dpi=(PIXELS_A_MM * 25.4,) * 2)
    foil.save(folder / "film-foil.png")
    gloss.save(folder / "film-gloss.png")


def packs(folder: Path, shipped: Path) -> None:
    """The pack files of the bottle and of the pouch."""
    girth_mm, artwork_mm = 204.2, 207.345
    bottle = LABEL.format(
        ink="gloss-varnish",
        foil="cold-foil-gold",
        foil_mask=shipped / "can-foil-gold.png",
        gloss_mask=shipped / "can-varnish.png",
    )
    (folder / "bottle.toml").write_text(
        f'[pack]\nartwork = "{shipped / "can.png"}"\n'
        f'[pack.form]\nkind = "bottle"\nprofile_mm = {OUTLINE_MM}\n'
        f"[pack.placement]\nscale = {girth_mm / artwork_mm:.5f}\n{bottle}",
        encoding="utf-8",
    )
    film(folder)
    pouch = LABEL.format(
        ink="matt-varnish",
        foil="cold-foil-gold",
        foil_mask="film-foil.png",
        gloss_mask="film-gloss.png",
    )
    (folder / "pouch.toml").write_text(
        f'[pack]\nform = "pouch"\nartwork = "film.png"\n{pouch}', encoding="utf-8"
    )
    Image.new("RGB", (64, 64), (38, 92, 138)).save(folder / "blue.png", dpi=(25.4, 25.4))
    for name, kind in FINISHES.items():
        kind = "ink" if kind == "varnish" else kind
        (folder / f"{name}.toml").write_text(
            f'[pack]\nform = "cylinder"\nartwork = "blue.png"\n[pack.placement]\nscale = 6.0\n'
            f'[[finish]]\nmaterial = "{name}"\nkind = "{kind}"\n',
            encoding="utf-8",
        )


def draw(folder: Path, name: str, size: str, words: str) -> Image.Image:
    """The picture of a snapshot; exits where it can't be drawn."""
    made = folder / f"{name}.png"
    if relgloss(f"snapshot {words} --samples 3 --size {size} -o {made}".split()) != 0:
        sys.exit(f"{name}: not drawn")
    with Image.open(made) as picture:
        return picture.convert("RGB")


def main(name: str) -> int:
    images, shipped = Path(name).absolute(), Path(str(asset("packs"))).absolute()
    with TemporaryDirectory() as kept:
        folder = Path(kept)
        packs(folder, shipped)
        row = [
            np.asarray(draw(folder, part, size, words.format(packs=shipped, here=folder)))
            for part, (size, words) in PICTURES.items()
        ]
        swatches = {
            part: np.asarray(
                draw(folder, part, SWATCH, f"--pack {folder / part}.toml {SWATCH_WORDS}")
            )
            for part in FINISHES
        }
    save(np.concatenate(row[:-1], axis=1), images / "packs.png")
    save(row[-1], images / "pack-finishes.png")
    names, pictures = list(swatches), list(swatches.values())
    sheet = contact_sheet(
        [pictures[k : k + IN_A_ROW] for k in range(0, len(names), IN_A_ROW)],
        [names[k : k + IN_A_ROW] for k in range(0, len(names), IN_A_ROW)],
        note="matched to cast-coated; synthetic",
    )
    save(sheet, images / "pack-built-in.png")
    return 0


def save(picture: np.ndarray, file: Path) -> None:
    """Write a small PNG."""
    Image.fromarray(np.ascontiguousarray(picture)).save(file, optimize=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "docs/images"))
