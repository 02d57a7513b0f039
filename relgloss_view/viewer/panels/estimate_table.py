"""The numbers of an estimated material with their intervals, as a table of a panel."""

from __future__ import annotations

from imgui_bundle import imgui

from relgloss_view.material.estimated import EstimateRecord
from relgloss_view.viewer.panels import plot_widgets
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em

#: Key of an interval, its words, the digits after the point, and whether it is among the few that
#: are shown where there is little room.
ROWS = (
    ("s_deg", "Lobe width (s)", 2, True),
    ("strength", "Strength", 2, True),
    ("gloss-20", "Gloss at 20°", 1, True),
    ("gloss-60", "Gloss at 60°", 1, True),
    ("gloss-75", "Gloss at 75°", 1, True),
    ("gloss-85", "Gloss at 85°", 1, True),
    ("peak", "Peak at 45°, times white", 2, False),
    ("refractive_index", "Refractive index (n)", 3, False),
    ("diffuse_y", "Diffuse reflectance (Y)", 3, False),
    ("second_s_deg", "Second lobe: width", 1, False),
    ("second_strength", "Second lobe: strength", 3, False),
)
UNITS = {"s_deg": "°", "second_s_deg": "°"}
WIDTH_EM = 24.0  #: of the table at most


def show(record: EstimateRecord, *, whole: bool = False) -> None:
    """The table; `whole` adds what a designer rarely needs."""
    rows = [row for row in ROWS if row[0] in record.intervals and (whole or row[3])]
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_stretch_prop
    width = min(imgui.get_content_region_avail().x, em(WIDTH_EM))
    if not rows or not imgui.begin_table("intervals", 3, flags, (width, 0.0)):
        return
    level = f"{100.0 * record.level:.0f} % interval"
    for name, weight in (("Estimated", 1.35), ("Likeliest", 0.85), (level, 1.2)):
        imgui.table_setup_column(name, imgui.TableColumnFlags_.none, weight)
    plot_widgets.table_headings()
    read = {f"gloss-{r['angle_deg']:g}": r["value"] for r in record.readings}
    for key, words, digits, _ in rows:
        value, low, high = (f"{number:.{digits}f}" for number in record.intervals[key])
        unit = UNITS.get(key, "")
        imgui.table_next_row()
        imgui.table_next_column()
        widgets.wrapped(words)
        if key in read:
            widgets.tooltip(f"The reading is {read[key]:g}.")
        imgui.table_next_column()
        imgui.text_unformatted(f"{value}{unit}")
        imgui.table_next_column()
        widgets.quiet(f"{low} to {high}{unit}")
    imgui.end_table()
