"""Help in the window: nothing of it is cut at any size, tooltips beside what they explain."""

from __future__ import annotations

import driven
import pytest

from relgloss_view.base.parameters import Range
from relgloss_view.viewer.shell.widgets import _meaning

SIZES = (((800, 500), 1.0), ((1280, 800), 1.0), ((1280, 800), 2.0), ((1920, 1080), 1.0))
WINDOWS = ("Keys and mouse", "First steps", "Manual")


def rect(window):
    return [window.pos.x, window.pos.y, window.pos.x + window.size.x, window.pos.y + window.size.y]


def shows_help(hand, found):
    from relgloss_view.viewer.panels import help as panel

    for title in WINDOWS:
        hand.app.help_window = title
        hand.frames(4)
        window = hand.ctx.window_info(f"//{title}").window
        found[title] = [*rect(window), window.scroll_max.x, window.scroll_max.y]
    found["columns"] = panel._columns(panel._sections())
    found["manual"] = str(panel.manual())
    hand.app.help_window = ""
    hand.frames(2)


def shows_tooltips(hand, found):
    """Of the first and the last slider of a panel: the item's box and the tooltip's."""
    from imgui_bundle import imgui

    hand.app.layout.hidden = False
    hand.frames(3)
    hand.app.layout.focus("Scene")
    hand.frames(4)
    items = {
        "control": "//Scene/##Out-of-gamut colours",
        "slider": "//Scene/##Surround lightness (L*)",
    }
    for name, path in items.items():
        hand.ctx.scroll_to_item_y(path)
        hand.frames(2)
        item = hand.ctx.item_info(path).rect_full
        box = [item.min.x, item.min.y, item.max.x, item.max.y]
        hand.ctx.mouse_move_to_pos((0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3])))

        def tip():
            for k in range(2):
                window = imgui.internal.find_window_by_name(f"##Tooltip_{k:02d}")
                if window is not None and window.active and not window.hidden:
                    return rect(window)
            return None

        found[name] = [box, hand.until(lambda tip=tip: tip() is not None) and tip()]
        hand.ctx.mouse_move_to_pos((30.0, 200.0))
        hand.frames(4)
    item = hand.ctx.item_info(items["slider"]).rect_full
    place = (0.5 * (item.min.x + item.max.x), 0.5 * (item.min.y + item.max.y))
    hand.ctx.mouse_move_to_pos(place)
    hand.ctx.mouse_down(0)
    hand.frames(60)
    found["held"] = tip()
    hand.ctx.mouse_up(0)


SCRIPTS = (shows_help, shows_tooltips)


@pytest.fixture(
    scope="module",
    params=[SIZES[1], *(pytest.param(p, marks=pytest.mark.slow) for p in (SIZES[0], *SIZES[2:]))],
    ids=lambda p: f"{p[0][0]}x{p[0][1]} {p[1]:g}",
)
def found(request, tmp_path_factory):
    size, font = request.param
    folder = tmp_path_factory.mktemp("help")
    return size, font, driven.drive("test_help", folder, size=size, font=font)


def test_nothing_of_the_help_is_cut(found):
    (width, height), font, got = found
    for title in WINDOWS:
        left, top, right, bottom, scroll_x, scroll_y = got["shows_help"][title]
        assert left >= 0.0
        assert top >= 0.0
        assert right <= width
        assert bottom <= height
        assert scroll_x == 0.0
        if height >= 800 and font == 1.0:
            assert scroll_y == 0.0  # all of it at once
    assert got["shows_help"]["columns"] == (3 if width >= 1280 and font == 1.0 else 1)


def test_the_manual_is_where_the_window_names_it(found):
    manual = found[2]["shows_help"]["manual"]
    assert manual.endswith("docs/window.md")
    with open(manual, encoding="utf-8") as file:
        assert file.read().startswith("# ")


def test_tooltips_cover_neither_their_control_nor_leave_the_window(found):
    (width, height), _, got = found
    for name in ("control", "slider"):
        item, tip = got["shows_tooltips"][name]
        assert tip, name
        apart = tip[0] >= item[2] or tip[2] <= item[0] or tip[1] >= item[3] or tip[3] <= item[1]
        assert apart, (item, tip)
        assert min(tip) >= 0.0
        assert tip[2] <= width
        assert tip[3] <= height
    assert got["shows_tooltips"]["held"] is None  # while a hand moves it, the number counts


class TestWords:
    def test_they_do_not_repeat_the_label(self):
        allowed = Range(0.0, 10.0, "deg", "graininess: deviation of the normal")
        text = _meaning(allowed, 0.0, "Graininess (sigma_N)", (0.0, 3.0))
        assert text.splitlines()[0] == "Deviation of the normal."
        other = _meaning(allowed, 0.0, "Roughness", (0.0, 3.0))
        assert other.splitlines()[0] == "Graininess: deviation of the normal."

    def test_a_range_shows_where_typing_reaches_further(self):
        allowed = Range(0.001, 1000.0, "m", "from the centre")
        text = _meaning(allowed, 0.6, "Eye distance", (0.1, 10.0))
        assert text.splitlines()[1] == "Typed values: 0.001 to 1000 m. Default: 0.6 m."
        same = _meaning(allowed, 0.6, "Eye distance", (0.001, 1000.0))
        assert same.splitlines()[1] == "Default: 0.6 m."

    def test_a_range_without_an_end_is_no_help(self):
        allowed = Range(0, 2**31 - 1, "", "seed of the grain")
        text = _meaning(allowed, 0, "Random seed", (0, 999))
        assert "21474" not in text
        assert text.splitlines()[1] == "Default: 0."
