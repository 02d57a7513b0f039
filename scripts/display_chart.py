"""The chart of docs/display.md: the four papers at the published settings on ten displays.

    python scripts/display_chart.py docs/images/displays.png [NUMBERS.json]

Prints the table of the page. Each display shows the four papers in two ways: drawn for it, with its
white, primaries and black; and drawn for the first display, and opened there, where the display's
black lies over everything (light = black + (1 - black) x, as Berns 1996's flare).

Displayed contrast is what the highlight adds at its brightest place: in L* relative to the
display's white, and in cube roots of luminance (100 cd/m2 as the unit), the display's black
included. The second takes luminances where Pellacini, Ferwerda and Greenberg 2000 have
reflectances in their contrast gloss, cbrt(rho_s + rho_d / 2) - cbrt(rho_d / 2); the ratio of the
two luminances is Hunter's 1936 contrast.
"""

from __future__ import annotations

import dataclasses
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base.arrays import Array
from relgloss_view.base.figures import drawing, new_figure, save_figure
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.seen import ABSOLUTE, between
from relgloss_view.gloss.match import gloss_of
from relgloss_view.gloss.shown import ORDER_TIE_LSTAR, agreement
from relgloss_view.picture.frame import Frame
from relgloss_view.picture.model import tone
from relgloss_view.picture.reference import ReferenceRenderer
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.picture.seen import Tally

SIDE_PX = 160
C_TICKS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
GAMUTS = {
    "sRGB": ((0.64, 0.33), (0.30, 0.60), (0.15, 0.06)),
    "P3": ((0.68, 0.32), (0.265, 0.69), (0.15, 0.06)),
    "2020": ((0.708, 0.292), (0.170, 0.797), (0.131, 0.046)),
}
#: White in cd/m2, black as a share of it, gamut: the designer's first, then by luminance.
DISPLAYS = (
    (160.0, 0.0, "sRGB"),
    (80.0, 0.0, "sRGB"),
    (80.0, 0.02, "sRGB"),
    (120.0, 0.005, "P3"),
    (200.0, 0.01, "sRGB"),
    (250.0, 0.001, "2020"),
    (300.0, 0.02, "P3"),
    (500.0, 0.002, "P3"),
    (600.0, 0.01, "2020"),
    (1000.0, 0.0, "2020"),
)
PAPERS = tuple(SAMPLES)


@dataclass(frozen=True)
class Shown:
    """What one paper's highlight is on one display, at its brightest place."""

    added_lstar: float
    added_roots: float  #: of luminance in units of 100 cd/m2
    ratio_of_light: float  #: highlight to body

    @classmethod
    def of(cls, bright: Array, body: Array, cd_m2: float) -> Shown:
        """bright, body: luminance (N,) of the pixels with and without highlight, white at 1."""
        added = tone.lightness(bright) - tone.lightness(body)
        k = int(np.argmax(added))
        roots = np.cbrt(np.array([bright[k], body[k]]) * cd_m2 / 100.0)
        ratio = float(bright[k] / body[k])
        return cls(float(added[k]), float(roots[0] - roots[1]), ratio)


def display_of(cd_m2: float, black: float, gamut: str) -> Display:
    """One of DISPLAYS, with a curve of 2.2."""
    return Display(
        transfer="gain-offset-gamma",
        primaries_xy=GAMUTS[gamut],
        luminance_cd_m2=cd_m2,
        black_cd_m2=black * cd_m2,
    )


def measured(frame: Frame, black: float, cd_m2: float) -> tuple[Shown, Shown]:
    """The frame as drawn for its display; and its wanted light as it is on one with this black."""
    model = DisplayModel.of(frame.scene.display)
    whole = frame.coverage >= 1.0
    body = tone.lab_f_inverse((frame.split[0][whole].astype(np.float64) + 16.0) / 116.0)
    darkest = float(model.xyz_from_rgb[1] @ model.darkest)
    drawn = frame.light[whole].astype(np.float64) @ model.xyz_from_rgb[1]
    lstar = np.clip(frame.lab[whole][:, 0].astype(np.float64), 0.0, 100.0)
    wanted = tone.lab_f_inverse((lstar + 16.0) / 116.0)
    opened = (black + (1.0 - black) * wanted, black + (1.0 - black) * body)
    return Shown.of(drawn, np.maximum(body, darkest), cd_m2), Shown.of(*opened, cd_m2)


def cut_on_first(frame: Frame) -> float:
    """Share of the object that the first display can't show of this one's light."""
    first, model = DisplayModel.of(display_of(*DISPLAYS[0])), DisplayModel.of(frame.scene.display)
    matrix, _, _ = between(
        model.xyz_from_rgb,
        first.rgb_from_xyz,
        model.luminance_cd_m2,
        first.luminance_cd_m2,
        ABSOLUTE,
    )
    tally = Tally(dataclasses.replace(model, screen=first, screen_from_rgb=matrix))
    tally.add(frame.light[frame.on_object])
    return tally.limits().cut


def numbers() -> list[dict[str, Any]]:
    """Everything that the chart shows, by display."""
    gloss = {name: gloss_of(load_sample(name)) for name in PAPERS}
    rows: list[dict[str, Any]] = []
    renderer = ReferenceRenderer()
    for cd_m2, black, gamut in DISPLAYS:
        setup = dataclasses.replace(Setup(), display=display_of(cd_m2, black, gamut))
        frames = {
            name: renderer.render(
                Scene(load_sample(name), setup), Look().at(SAMPLES[name]), (SIDE_PX, SIDE_PX)
            )
            for name in PAPERS
        }
        shown = {name: measured(frame, black, cd_m2) for name, frame in frames.items()}
        row: dict[str, Any] = {
            "white_cd_m2": cd_m2,
            "black": black,
            "gamut": gamut,
            "c_max": {name: frame.c_max for name, frame in frames.items()},
            "out_of_gamut": {
                name: frame.out_of_gamut_count / frame.object_pixels
                for name, frame in frames.items()
            },
            "cut_on_first": {name: cut_on_first(frame) for name, frame in frames.items()},
        }
        for k, way in enumerate(("drawn", "opened")):
            added = {name: shown[name][k].added_lstar for name in PAPERS}
            ratios = {name: gloss[name] / added[name] for name in PAPERS}  # R = G / G~
            row[way] = {
                **{name: dataclasses.asdict(shown[name][k]) for name in PAPERS},
                "tau": agreement(added, gloss, ORDER_TIE_LSTAR).tau,
                "ratio": {name: ratios[name] / ratios[PAPERS[0]] for name in PAPERS},
            }
        rows.append(row)
    return rows


def label(row: Mapping[str, Any]) -> str:
    return f"{row['white_cd_m2']:g}\n{100.0 * row['black']:g} %\n{row['gamut']}"


def table(rows: list[dict[str, Any]]) -> None:
    """Print the numbers as the page has them: cast-coated / uncoated where two stand."""
    ends = PAPERS[0], PAPERS[-1]
    print(
        "| white, black, gamut | c_max | adds L*: drawn | opened | cube roots: drawn | tau | "
        "R, uncoated to cast-coated: drawn | opened | cut at 160 cd/m2 |"
    )
    print("| --- " * 9 + "|")
    first = rows[0]
    for row in rows:
        cells = [label(row).replace("\n", ", ")]
        cells.append(" / ".join(f"{row['c_max'][name]:.3f}" for name in ends))
        cells += [
            " / ".join(f"{row[way][name]['added_lstar']:.1f}" for name in ends)
            for way in ("drawn", "opened")
        ]
        cells.append(" / ".join(f"{row['drawn'][name]['added_roots']:.3f}" for name in ends))
        cells.append(" / ".join(f"{row[way]['tau']:.2f}" for way in ("drawn", "opened")))
        for way in ("drawn", "opened"):
            ratio = row[way]["ratio"][ends[1]] / first["drawn"]["ratio"][ends[1]]
            cells.append(f"{ratio:.2f}")
        cells.append(f"{max(row['cut_on_first'].values()):.0%}")
        print(f"| {' | '.join(cells)} |")


def chart(rows: list[dict[str, Any]], path: Path) -> None:
    """Four panels over the displays, a line a paper; dashed where the picture was opened there."""
    at = np.arange(len(rows))
    with drawing():
        figure = new_figure(10.5, 6.6, dpi=110, layout="constrained")
        panels = figure.subplots(2, 2, sharex=True)
        for n, name in enumerate(PAPERS):
            colour = f"C{n}"
            panels[0, 0].plot(at, [r["c_max"][name] for r in rows], "o-", color=colour, label=name)
            for way, line in (("drawn", "o-"), ("opened", "s--")):
                style = {"color": colour, "markersize": 4.0}
                lstar = [r[way][name]["added_lstar"] for r in rows]
                roots = [r[way][name]["added_roots"] for r in rows]
                first = rows[0]["drawn"]["ratio"][name]
                ratio = [r[way]["ratio"][name] / first for r in rows]
                panels[0, 1].plot(at, lstar, line, **style)
                panels[1, 0].plot(at, roots, line, **style)
                panels[1, 1].plot(at, ratio, line, **style)
        panels[0, 0].set(yscale="log", ylim=(0.1, 30.0), title="c_max: no display changes it")
        panels[0, 0].set_yticks(C_TICKS, [f"{tick:g}" for tick in C_TICKS])
        panels[0, 0].minorticks_off()
        panels[0, 1].set(ylabel="L*", title="What the highlight adds, relative to white")
        panels[1, 0].set(
            ylabel="cube roots of 100 cd/m2", title="The same in luminance, black included"
        )
        panels[1, 1].axhline(1.0, color="0.8", linewidth=0.8)
        panels[1, 1].set_ylim(0.97, 1.03)
        panels[1, 1].set(title="Ratio R to cast-coated's, over that of the first display")
        panels[0, 0].legend(ncols=2, loc="upper left")
        panels[0, 1].plot([], [], "o-", color="0.4", label="drawn for the display")
        panels[0, 1].plot([], [], "s--", color="0.4", label="drawn for the first, opened here")
        panels[0, 1].legend()
        for panel in panels[1]:
            panel.set_xticks(at, [label(r) for r in rows], fontsize=7.0)
            panel.set_xlabel("white in cd/m2, black, gamut")
        save_figure(figure, path)


def main() -> int:
    """Print the table, draw the chart, and write the numbers where a file is named."""
    rows = numbers()
    table(rows)
    chart(rows, Path(sys.argv[1]))
    if len(sys.argv) > 2:
        Path(sys.argv[2]).write_text(json.dumps(rows, indent=1), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
