"""Draw the artwork of the shipped packs: assets/packs, a can and a carton of invented brands.

Each artwork is a vector PDF: colours in sRGB, letters as outlines of the DejaVu fonts, and two
spot colours, "Varnish" and "Foil Gold", in layers that ISO 19593-1 marks as processing steps. The
PDF is then read as any artwork is, through Ghostscript, and written beside it as pictures: colours
and one gray picture a plate, so that the packs open where Ghostscript is not installed.

    python scripts/make_artwork.py

It needs Ghostscript and draws no random number.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

import numpy as np
import pikepdf
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont
from PIL import Image

FOLDER = Path(__file__).resolve().parents[1] / "assets" / "packs"
POINT_MM = 72.0 / 25.4
VARNISH, FOIL = "Varnish", "Foil Gold"
#: Of ISO 19593-1: group, and how a viewer shows the plate.
PLATES = {
    VARNISH: ("Varnish", (0.55, 0.0, 0.1, 0.0)),
    FOIL: ("HotFoilStamping", (0.1, 0.3, 0.9, 0.0)),
}
BEZIER = 0.5522847498  #: of a quarter circle
DPI = 254.0  #: of the pictures: 10 pixels a millimetre

Point = tuple[float, float]


def font(name: str) -> TTFont:
    """A font that matplotlib brings along."""
    import matplotlib

    return TTFont(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / f"{name}.ttf")


FONTS = {
    "bold": font("DejaVuSans-Bold"),
    "plain": font("DejaVuSans"),
    "display": font("DejaVuSerif-Bold"),
    "serif": font("DejaVuSerif"),
}


def _placed(q: Point, at: Point, scale: float) -> Point:
    return at[0] + q[0] * scale, at[1] + q[1] * scale


class Sheet:
    """A page in millimetres from its centre, y up: operators of a PDF, layer by layer."""

    def __init__(self, width_mm: float, height_mm: float) -> None:
        self.size = width_mm, height_mm
        self.layers: dict[str, list[str]] = {"": [], VARNISH: [], FOIL: []}
        self.layer = ""

    def on(self, layer: str) -> Sheet:
        """Draw on a plate from now on; '' is the coloured print."""
        self.layer = layer
        return self

    def put(self, *words: str) -> None:
        """Operators of the present layer."""
        self.layers[self.layer] += words

    def colour(self, code: str) -> None:
        """The colour of what follows, as #rrggbb; on a plate all of it prints."""
        if self.layer:
            self.put(f"/{self.layer.replace(' ', '')} cs 1 scn")
            return
        red, green, blue = (int(code[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
        self.put(f"{red:.4f} {green:.4f} {blue:.4f} rg")

    def path(self, points: Iterable[Point]) -> None:
        """A closed path through points, which nothing fills yet."""
        for k, (x, y) in enumerate(points):
            self.put(f"{x:.3f} {y:.3f} {'l' if k else 'm'}")
        self.put("h")

    def polygon(self, points: Iterable[Point], code: str = "#000000") -> None:
        """A filled polygon."""
        self.colour(code)
        self.path(points)
        self.put("f")

    def box(self, x: float, y: float, width: float, height: float, code: str = "#000000") -> None:
        """A rectangle about (x, y)."""
        self.colour(code)
        self.put(f"{x - width / 2:.3f} {y - height / 2:.3f} {width:.3f} {height:.3f} re f")

    def circle_path(self, x: float, y: float, r: float) -> None:
        """A circle of four Bezier curves, which nothing fills yet."""
        k = BEZIER * r
        self.put(
            f"{x + r:.3f} {y:.3f} m",
            f"{x + r:.3f} {y + k:.3f} {x + k:.3f} {y + r:.3f} {x:.3f} {y + r:.3f} c",
            f"{x - k:.3f} {y + r:.3f} {x - r:.3f} {y + k:.3f} {x - r:.3f} {y:.3f} c",
            f"{x - r:.3f} {y - k:.3f} {x - k:.3f} {y - r:.3f} {x:.3f} {y - r:.3f} c",
            f"{x + k:.3f} {y - r:.3f} {x + r:.3f} {y - k:.3f} {x + r:.3f} {y:.3f} c h",
        )

    def disc(self, x: float, y: float, r: float, code: str = "#000000") -> None:
        """A filled circle."""
        self.colour(code)
        self.circle_path(x, y, r)
        self.put("f")

    def ring(self, x: float, y: float, outer: float, inner: float, code: str = "#000000") -> None:
        """A filled ring."""
        self.colour(code)
        self.circle_path(x, y, outer)
        self.circle_path(x, y, inner)
        self.put("f*")

    def line(self, points: Sequence[Point], width: float, code: str = "#000000") -> None:
        """A line of a width, as the outline of its stroke."""
        p = np.asarray(points, dtype=float)
        step = np.gradient(p, axis=0)
        normal = np.stack([-step[:, 1], step[:, 0]], axis=1)
        normal *= 0.5 * width / np.linalg.norm(normal, axis=1, keepdims=True)
        self.polygon([*map(tuple, p + normal), *map(tuple, (p - normal)[::-1])], code)

    def text(
        self,
        words: str,
        x: float,
        y: float,
        cap_mm: float,
        code: str = "#000000",
        face: str = "plain",
        spread: float = 0.0,
        anchor: float = 0.5,
    ) -> float:
        """Letters as outlines on the base line y, capitals `cap_mm` high.

        anchor: 0 left of the words, 0.5 their middle, 1 their right. spread: further space
        between letters, in heights. Returns the width, millimetres.
        """
        made = FONTS[face]
        glyphs, names = made.getGlyphSet(), made.getBestCmap()
        scale = cap_mm / made["glyf"]["H"].yMax
        gap = spread * cap_mm
        advance = [glyphs[names[ord(c)]].width * scale + gap for c in words]
        width = float(sum(advance)) - gap
        self.colour(code)
        at = x - anchor * width
        for c, step in zip(words, advance, strict=True):
            pen = DecomposingRecordingPen(glyphs)
            glyphs[names[ord(c)]].draw(pen)
            place = partial(_placed, at=(at, y), scale=scale)
            self._glyph(pen.value, place)
            at += step
        self.put("f")
        return width

    def _glyph(self, moves: list, place: Callable[[Point], Point]) -> None:  # type: ignore[type-arg]
        start: Point = (0.0, 0.0)
        for word, points in moves:
            if word in ("moveTo", "lineTo"):
                x, y = place(points[0])
                self.put(f"{x:.3f} {y:.3f} {'m' if word == 'moveTo' else 'l'}")
                start = points[0]
            elif word == "qCurveTo":
                curve = list(points)
                for k, control in enumerate(curve[:-1]):  # TrueType leaves out middle points
                    last = k == len(curve) - 2
                    end = curve[-1] if last else _middle(control, curve[k + 1])
                    first = _middle(start, control, 2.0 / 3.0)
                    second = _middle(end, control, 2.0 / 3.0)
                    q = [v for p in (first, second, end) for v in place(p)]
                    self.put(" ".join(f"{v:.3f}" for v in q) + " c")
                    start = end
            elif word == "closePath":
                self.put("h")

    def save(self, path: Path, title: str) -> None:
        """The PDF: one page, the print first, then the plates, overprinting."""
        pdf = pikepdf.new()
        width, height = (POINT_MM * side for side in self.size)
        content = [f"{POINT_MM:.6f} 0 0 {POINT_MM:.6f} {width / 2:.4f} {height / 2:.4f} cm"]
        content += self.layers[""]
        spaces, layers = pikepdf.Dictionary(), pikepdf.Dictionary()
        groups = pikepdf.Array()
        for name, (step, cmyk) in PLATES.items():
            key = name.replace(" ", "")
            tint = pikepdf.Dictionary(
                FunctionType=2, Domain=[0, 1], C0=[0, 0, 0, 0], C1=list(cmyk), N=1
            )
            spaces[f"/{key}"] = pikepdf.Array(
                [pikepdf.Name.Separation, pikepdf.Name(f"/{name}"), pikepdf.Name.DeviceCMYK, tint]
            )
            layer = pdf.make_indirect(
                pikepdf.Dictionary(
                    Type=pikepdf.Name.OCG,
                    Name=name,
                    GTS_Metadata=pikepdf.Dictionary(GTS_ProcStepsGroup=pikepdf.Name(f"/{step}")),
                )
            )
            groups.append(layer)
            layers[f"/{key}"] = layer
            content += [f"/OC /{key} BDC q /Over gs", *self.layers[name], "Q EMC"]
        over = pikepdf.Dictionary(Type=pikepdf.Name.ExtGState, OP=True, op=True, OPM=1)
        page = pdf.add_blank_page(page_size=(width, height))
        page.obj.Resources = pikepdf.Dictionary(
            ColorSpace=spaces, Properties=layers, ExtGState=pikepdf.Dictionary(Over=over)
        )
        page.obj.TrimBox = page.obj.MediaBox
        page.obj.Contents = pdf.make_stream("\n".join(content).encode("ascii"))
        pdf.Root.OCProperties = pikepdf.Dictionary(
            OCGs=groups, D=pikepdf.Dictionary(ON=groups, Order=groups)
        )
        pdf.docinfo["/Title"] = title
        pdf.save(path, deterministic_id=True, compress_streams=True)


def _middle(a: Point, b: Point, share: float = 0.5) -> Point:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def bars(sheet: Sheet, x: float, y: float, digits: str, code: str) -> None:
    """Bars and digits on a white patch, like a retail code; the digits are no article's."""
    sheet.box(x, y, 34.0, 22.0, "#ffffff")
    at, unit = x - 14.2, 0.3
    for k in range(95):
        wide = (k in (0, 2, 46, 48, 92, 94)) or (int(digits[k % len(digits)]) * (k + 3)) % 7 > 3
        if wide:
            tall = 15.5 if k in (0, 2, 46, 48, 92, 94) else 14.0
            sheet.box(at + unit * k, y + 9.0 - tall / 2, unit, tall, code)
    sheet.text(digits, x, y - 9.0, 1.8, code, spread=0.55)


def facts(sheet: Sheet, x: float, y: float, rows: Sequence[tuple[str, str]], code: str) -> None:
    """A table of nutrition facts about x, from y downwards."""
    sheet.text("Typical values per 100 g", x - 17, y, 1.7, code, "bold", anchor=0.0)
    for k, (name, value) in enumerate(rows):
        base = y - 4.2 - 3.3 * k
        sheet.box(x, base + 2.5, 34.0, 0.12, code)
        sheet.text(name, x - 17, base, 1.35, code, anchor=0.0)
        sheet.text(value, x + 17, base, 1.35, code, anchor=1.0)
    sheet.box(x, y - 4.2 - 3.3 * len(rows) + 2.5, 34.0, 0.12, code)


def ridge(
    girth: float, level: float, tall: float, waves: Sequence[tuple[int, float, float]]
) -> list[Point]:
    """A skyline that closes around the girth: sharp tops, from sums of folded waves."""
    xs = np.linspace(-0.5 * girth - 1.0, 0.5 * girth + 1.0, 700)
    y = np.zeros_like(xs)
    for count, share, phase in waves:
        place = count * xs / girth + phase
        y += share * (1.0 - np.abs(2.0 * (place - np.floor(place)) - 1.0))
    return [(float(a), float(level + tall * b)) for a, b in zip(xs, y, strict=True)]


def can(width: float, height: float) -> Sheet:
    """KALDRA tonic water: night over mountains, a moon of foil, berries under gloss."""
    sheet = Sheet(width, height)
    cream, night, berry = "#f4ead8", "#0d2f38", "#c8243c"
    sheet.box(0, 0, width + 2, height + 2, night)
    floor = -0.5 * height - 1.0
    ranges = (
        (-12.0, 15.0, "#15434a", ((6, 1.0, 0.50), (17, 0.28, 0.1), (41, 0.08, 0.3))),
        (-24.0, 15.0, "#1d5a59", ((7, 1.0, 0.05), (19, 0.30, 0.4), (47, 0.08, 0.7))),
        (-37.0, 13.0, "#2a746b", ((5, 1.0, 0.32), (23, 0.30, 0.2), (53, 0.07, 0.5))),
    )
    for level, tall, code, waves in ranges:
        top = ridge(width, level, tall, waves)
        sheet.polygon([*top, (top[-1][0], floor), (top[0][0], floor)], code)
    # Lines of equal height as gloss alone: they show where a highlight crosses them.
    sheet.on(VARNISH)
    for k in range(17):
        level, tall, _, waves = ranges[k % 3]
        line = ridge(width, level - 3.2 - 2.4 * (k // 3), tall * (1.0 - 0.05 * k), waves)
        sheet.line(line, 0.55)
    # The moon and its rays in foil.
    sheet.on(FOIL).ring(0, 26, 17.0, 15.9)
    sheet.disc(0, 26, 13.6)
    for k in range(36):
        a = 2.0 * math.pi * k / 36
        r0, r1 = 18.6, 21.6 if k % 3 else 24.0
        sheet.line(
            [(r0 * math.cos(a), 26 + r0 * math.sin(a)), (r1 * math.cos(a), 26 + r1 * math.sin(a))],
            0.45,
        )
    sheet.on("").text("K", 0, 19.6, 12.8, night, "display")
    # A letter in the foil is printed ink: the plate leaves it out.
    sheet.layers[FOIL] = _without(sheet, "K", 0, 19.6, 12.8)
    sheet.text("KALDRA", 0, -10.5, 10.2, cream, "display", 0.14)
    sheet.on(VARNISH).text("KALDRA", 0, -10.5, 10.2, face="display", spread=0.14)
    sheet.on("").text("TONIC WATER", 0, -17.0, 2.9, cream, "bold", 0.42)
    sheet.on(FOIL).box(-29.5, -15.6, 9, 0.45)
    sheet.box(29.5, -15.6, 9, 0.45)
    sheet.on("").text("wild lingonberry", 0, -23.2, 3.0, "#f0b9ae", "serif", 0.06)
    for x, y, r in ((-9, -34, 5.6), (3.4, -32.6, 6.4), (-2.8, -41, 5.2), (12.6, -38.6, 5.0)):
        sheet.on("").disc(x, y, r, "#8f1329")
        sheet.disc(x - 0.08 * r, y + 0.08 * r, 0.9 * r, berry)
        sheet.disc(x + 0.05 * r, y - 0.75 * r, 0.14 * r, "#5f0c1c")
        sheet.on(VARNISH).disc(x, y, r)
    sheet.on("")
    for x, y, a in ((-17, -31, 2.5), (12, -28, 0.7), (20, -34, 0.2)):
        outline = [(t, 1.9 * math.sin(math.pi * t)) for t in np.linspace(0, 1, 14)]
        outline += [(t, -w) for t, w in outline[::-1]]
        turned = math.cos(a), math.sin(a)
        leaf = [
            (x + t * 7 * turned[0] - w * turned[1], y + t * 7 * turned[1] + w * turned[0])
            for t, w in outline
        ]
        sheet.polygon(leaf, "#8cbf62")
    sheet.text("330 ml", 30, -46.5, 2.3, cream, "bold", anchor=1.0)
    sheet.text("no alcohol", -30, -46.5, 2.3, cream, "bold", anchor=0.0)
    rows = (("Energy", "118 kJ / 28 kcal"), ("Fat", "0 g"), ("Carbohydrate", "6.8 g"),
            ("  of which sugars", "6.8 g"), ("Protein", "0 g"), ("Salt", "0.01 g"))  # fmt: skip
    facts(sheet, 76, 30, rows, cream)
    small = (
        "Water, sugar, lingonberry juice 4 %,",
        "carbon dioxide, citric acid, bitter bark.",
        "Serve cold. Best before: see base.",
        "An invented drink for an invented can.",
    )
    for k, words in enumerate(small):
        sheet.text(words, 59, 1.5 - 2.6 * k, 1.15, cream, anchor=0.0)
    bars(sheet, -76, 24, "0123456789128", "#101010")
    sheet.text("KALDRA", -76, 4, 3.6, cream, "display", 0.14)
    for k, words in enumerate(
        (
            "Brewed from snow that nobody",
            "has measured. Bitter at first,",
            "then mountain, then berry.",
        )
    ):
        sheet.text(words, -76, -1.5 - 3.2 * k, 1.5, cream, "serif")
    return sheet


def _without(sheet: Sheet, words: str, x: float, y: float, cap_mm: float) -> list[str]:
    """The foil of a sheet with letters knocked out: drawn again, with none of the plate."""
    kept = sheet.layers[FOIL]
    sheet.layers[FOIL] = []
    sheet.on(FOIL).text(words, x, y, cap_mm, face="display")
    hole = [word.replace("1 scn", "0 scn") for word in sheet.layers[FOIL]]
    sheet.on("")
    return [*kept, "Q q", *hole]


def carton(width: float, height: float) -> Sheet:
    """MERIDIAN chocolate: facets under gloss on soft touch, lettering and hairlines in foil."""
    sheet = Sheet(width, height)
    ground, cream, amber = "#2a1730", "#f5e8d8", "#e9a23b"
    front, side, tall, deep = 70.0, 40.0, 160.0, 40.0
    sheet.box(0, 0, width + 2, height + 2, ground)
    # A fan of facets from one point behind the name, right around the box.
    for copy in (-width, 0.0, width):
        for k in range(28):
            a, b = (math.pi * (k + j) / 28 for j in (0, 1))
            r = 260.0
            fan = [(copy, -62.0), (copy + r * math.cos(a), -62 + r * math.sin(a)),
                   (copy + r * math.cos(b), -62 + r * math.sin(b))]  # fmt: skip
            tone = ("#311b39", "#3a2042", "#281530")[(k * 5) % 3]
            if copy == 0.0:
                sheet.on("").polygon([(x, y) for x, y in fan], tone)
                if k % 2:
                    sheet.on(VARNISH).polygon(fan)
    sheet.on("").box(0, -101.0, width + 2, 78.0, amber)
    sheet.box(0, -61.6, width + 2, 1.2, cream)
    sheet.on(FOIL).text("MERIDIAN", 0, 44.0, 6.4, face="display", spread=0.16)
    sheet.box(0, 39.4, 56.0, 0.35)
    sheet.box(0, 55.0, 56.0, 0.35)
    for k in range(25):
        a = math.pi * (k + 0.5) / 25
        r0, r1 = 16.0, (25.0, 31.0)[k % 2]
        sheet.line([(r0 * math.cos(a), -60.6 + r0 * math.sin(a)),
                    (r1 * math.cos(a), -60.6 + r1 * math.sin(a))], 0.5)  # fmt: skip
    arc = [math.pi * k / 60 for k in range(61)]
    sheet.line([(13.6 * math.cos(a), -60.6 + 13.6 * math.sin(a)) for a in arc], 0.8)
    sheet.on("").text("dark chocolate", 0, 33.2, 3.4, cream, "serif", 0.08)
    sheet.text("72", 0, -4.0, 26.0, cream, "display")
    sheet.on(VARNISH).text("72", 0, -4.0, 26.0, face="display")
    sheet.on("").text("PER CENT CACAO", 0, -12.0, 2.5, amber, "bold", 0.42)
    sheet.text("sea salt & orange", 0, -70.5, 3.0, ground, "serif", 0.05)
    sheet.text("80 g", 0, -76.0, 2.2, ground, "bold")
    right = 0.5 * (front + side)
    for sign in (-1, 1):
        sheet.on(FOIL).text("MERIDIAN", sign * right, 44.0, 3.6, face="display", spread=0.16)
        for k in range(9):
            sheet.box(sign * right, 36.0 - 3.0 * k, 26.0 - 2.4 * k, 0.3)
    rows = (("Energy", "2390 kJ / 576 kcal"), ("Fat", "43 g"), ("  of which saturates", "26 g"),
            ("Carbohydrate", "35 g"), ("  of which sugars", "26 g"), ("Protein", "8.4 g"),
            ("Salt", "0.62 g"))  # fmt: skip
    sheet.on("")
    facts(sheet, right, -8, rows, cream)
    for copy in (-1, 1):  # the back is divided by the edges of the sheet
        x = copy * 0.5 * width
        sheet.text("Broken, not cut.", x, 44, 3.6, cream, "serif")
        small = (
            "Cacao mass, sugar, cacao butter, candied orange",
            "peel 6 %, sea salt 0.6 %. May contain milk, nuts.",
            "Keep cool and dry. An invented bar in an invented box.",
        )
        for k, line in enumerate(small):
            sheet.text(line, x, 36 - 3.4 * k, 1.35, cream)
        bars(sheet, x, -40, "0987654321098", "#101010")
    sheet.on(FOIL).text("MERIDIAN", 0, 0.5 * (tall + deep) - 2.0, 5.0, face="display", spread=0.16)
    return sheet


def pictures(pdf: Path) -> None:
    """The PDF as the program reads it: PNG of its colours, and one a plate."""
    from relgloss_view.material.cielab import srgb_encoded
    from relgloss_view.material.spectra import (
        D65_XY,
        SRGB_PRIMARIES_XY,
        illuminant,
        rgb_to_xyz_matrix,
    )
    from relgloss_view.pack.artwork.options import ArtworkOptions
    from relgloss_view.pack.artwork.read import read_artwork

    artwork = read_artwork(pdf, ArtworkOptions(dpi=DPI))
    matrix = rgb_to_xyz_matrix(SRGB_PRIMARIES_XY, D65_XY)
    xyz = artwork.xyz.astype(np.float64)
    if artwork.alpha is not None:  # on white
        xyz = (
            xyz
            + (1.0 - artwork.alpha.astype(np.float64))[..., None] * illuminant("D50").white_xyz()
        )
    linear = np.clip(
        xyz / illuminant("D50").white_xyz() * matrix.sum(axis=1) @ np.linalg.inv(matrix).T, 0, 1
    )
    digital = np.rint(255.0 * srgb_encoded(linear)).astype(np.uint8)
    picture = Image.fromarray(digital).quantize(256, dither=Image.Dither.NONE)
    picture.save(pdf.with_suffix(".png"), dpi=(DPI, DPI), optimize=True)
    for name, values in artwork.plates.items():
        slug = name.lower().replace(" ", "-")
        Image.fromarray(values).save(pdf.with_name(f"{pdf.stem}-{slug}.png"), optimize=True)
    print(
        pdf.name, artwork.size_px, round(artwork.width_mm, 2), list(artwork.plates), artwork.notes
    )


def main() -> None:
    from relgloss_view.pack.label import label_of
    from relgloss_view.pack.shape import Shape

    FOLDER.mkdir(parents=True, exist_ok=True)
    for name, draw in (("can", can), ("carton", carton)):
        width, height = (1e3 * side for side in label_of(Shape(name)).size_m)
        path = FOLDER / f"{name}.pdf"
        draw(width, height).save(path, f"relgloss sample artwork: {name}, an invented brand")
        pictures(path)


if __name__ == "__main__":
    main()
