"""Every text that a window draws, read back from what ImGui hands to the device: letters, extents
of their ink, whether anything cuts them.

A letter is a rectangle whose texture coordinates are those of a glyph in the font's atlas. Where
they are only a part of a glyph's, ImGui has cut the letter itself; where the rectangle leaves the
scissor's, the device cuts it. Letters that follow each other on a line are one text.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, field

import numpy as np

SLACK_PX = 1.0  #: what smooth edges may reach over
#: A letter that the scissor leaves out altogether is not drawn. What ends so near to its edge, in
#: sizes of the text, goes on behind it: panels leave more between their words and their edge.
EDGE_EM = 0.3
SPACE_EM = 0.45  #: the widest gap between letters of one text, in sizes of it

Box = tuple[float, float, float, float]  #: left, top, right, bottom, pixels of the window


@dataclass
class Text:
    """A line of text as it is drawn: its letters, the extent of their ink, what cuts it."""

    letters: str
    ink: Box
    clip: Box
    window: str
    root: str
    size: float  #: of the font, pixels
    upright: bool = True
    cut: set[str] = field(default_factory=set)  #: edges that something is lost at: x, y


@dataclass
class Screen:
    """All texts of a frame, and the windows with more in them than they show."""

    texts: list[Text]
    wider: list[str]  #: windows whose content is wider than they are
    hidden: list[str]  #: windows with content below their edge and no bar to scroll to it
    size: tuple[float, float]

    @property
    def letters(self):
        return [text.letters for text in self.texts]

    def holds(self, text):
        """Whether a text is drawn somewhere, on one line."""
        wanted = "".join(text.split())
        return any(wanted in "".join(t.letters.split()) for t in self.texts)

    def faults(self, names=(), fields=()):
        """What of the screen can't be read, in words; an empty list where all can.

        names: of samples, which may be shortened. Other texts that end in "…" are cut. fields:
        texts that are being edited, which move in their field.
        """
        found = [
            f"{t.letters!r} in {t.window} is cut ({', '.join(sorted(t.cut))})"
            for t in self.texts
            if t.cut and not any(t.letters in field for field in fields)
        ]
        beginnings = ["".join(name.split())[:2] for name in names]
        found += [
            f"{t.letters!r} in {t.window} is shortened"
            for t in self.texts
            if "…" in t.letters and not any(b in "".join(t.letters.split()) for b in beginnings)
        ]
        found += [
            f"{one!r} in {a.window} is written over {two!r}" for one, two, a in overlaps(self)
        ]
        found += [f"{name} is narrower than its content" for name in self.wider]
        found += [f"{name} hides what is below its edge" for name in self.hidden]
        return found


def read(sizes):
    """The screen of the frame that was drawn last. sizes: of the font, all that are in use."""
    from imgui_bundle import imgui

    glyphs = _Glyphs(sizes)
    texts, wider, hidden = [], [], []
    draw_data = imgui.get_draw_data()
    seen = set()
    for draw_list in draw_data.cmd_lists:
        name = draw_list._owner_name or ""
        window = imgui.internal.find_window_by_name(name)
        # Words in a child or a page reach to its edge; what would reach further makes it wider.
        child = window is not None and bool(window.flags & imgui.WindowFlags_.child_window)
        flush = child or name == "##page"
        root = window.root_window.name if window is not None else name
        down = window is not None and _scrolls(window)
        if window is not None and name not in seen:
            seen.add(name)
            flags = window.flags
            bar = imgui.WindowFlags_.no_scrollbar
            if (
                window.scroll_max.x > SLACK_PX
                and not flags & imgui.WindowFlags_.horizontal_scrollbar
            ):
                wider.append(name)
            # Dock space and menu bar show all they hold, whatever that adds up to.
            whole = name.startswith(("##dock", "##MainMenuBar"))
            if window.scroll_max.y > 0.5 * max(sizes) and flags & bar and not whole:
                hidden.append(name)
        texts += _texts_of(draw_list, glyphs, name, root, down=down, flush=flush)
    size = (draw_data.display_size.x, draw_data.display_size.y)
    return Screen(texts, wider, hidden, size)


def overlaps(screen):
    """Pairs of texts whose ink is on top of each other, with the first: (one, other, first).

    A window over another one hides what is below it, so only texts of one window count, and
    those of windows that are docked side by side.
    """
    floating = {t.root for t in screen.texts} - BOTTOM
    found = []
    for k, one in enumerate(screen.texts):
        for other in screen.texts[k + 1 :]:
            apart = one.root != other.root and (one.root in floating or other.root in floating)
            if not apart and _shared(_seen(one), _seen(other)):
                found.append((one.letters, other.letters, one))
    return found


#: Windows that lie side by side at the bottom; all others are over them.
BOTTOM = {
    "Pictures", "##dock", "##status", "##MainMenuBar", "Look", "Scene", "Sample", "Lightness",
    "Reflection", "Fit", "Gloss", "Pixel", "##page", "##strip", "##Background", "##Foreground",
}  # fmt: skip


def _seen(text):
    left, top, right, bottom = text.ink
    return (
        max(left, text.clip[0]), max(top, text.clip[1]),
        min(right, text.clip[2]), min(bottom, text.clip[3]),
    )  # fmt: skip


def _shared(one, other):
    wide = min(one[2], other[2]) - max(one[0], other[0])
    tall = min(one[3], other[3]) - max(one[1], other[1])
    return wide > SLACK_PX and tall > SLACK_PX


def _scrolls(window):
    """Whether the window, or one that it is in, has a bar to bring up what is below its edge."""
    from imgui_bundle import imgui

    while window is not None:
        if window.scroll_max.y > 0.0 and not window.flags & imgui.WindowFlags_.no_scrollbar:
            return True
        window = window.parent_window if window.flags & imgui.WindowFlags_.child_window else None
    return False


class _Glyphs:
    """Glyphs of the atlas by the place of their pictures in it."""

    def __init__(self, sizes):
        from imgui_bundle import imgui

        font = imgui.get_io().fonts.fonts[0]
        rows, self.of = [], []
        for size in sorted(sizes):
            baked = font.get_font_baked(size)
            for glyph in baked.glyphs:
                if glyph.is_visible and glyph.u1 > glyph.u0:
                    rows.append((glyph.u0, glyph.v0, glyph.u1, glyph.v1))
                    self.of.append((chr(glyph.get_codepoint()), glyph, baked.size))
        self.boxes = np.array(rows, dtype=np.float64).reshape(-1, 4)

    def find(self, u0, v0, u1, v1):
        """Which glyph a part of the atlas is of; None where it is of none."""
        e = 1e-6
        boxes = self.boxes
        inside = (
            (boxes[:, 0] <= u0 + e) & (boxes[:, 1] <= v0 + e)
            & (boxes[:, 2] >= u1 - e) & (boxes[:, 3] >= v1 - e)
        )  # fmt: skip
        places = np.flatnonzero(inside)
        return None if len(places) == 0 else int(places[0])


def _array(buffer, kind):
    size = buffer.size() * np.dtype(kind).itemsize
    if size == 0:
        return np.zeros(0, kind)
    raw = (ctypes.c_char * size).from_address(buffer.data_address())
    return np.frombuffer(bytes(raw), dtype=kind)


_VERTEX = np.dtype([("pos", "<f4", 2), ("uv", "<f4", 2), ("ink", "<u4")])


def _texts_of(draw_list, glyphs, name, root, *, down, flush):
    from imgui_bundle import imgui

    vertices = _array(draw_list.vtx_buffer, _VERTEX)
    indices = _array(draw_list.idx_buffer, f"<u{imgui.INDEX_SIZE}").astype(np.int64)
    found = []
    for command in draw_list.cmd_buffer:
        index = indices[command.idx_offset : command.idx_offset + command.elem_count]
        index = index + command.vtx_offset
        clip = tuple(float(v) for v in (command.clip_rect.x, command.clip_rect.y,
                                        command.clip_rect.z, command.clip_rect.w))  # fmt: skip
        if len(index) < 6:
            continue
        first = index[:-5]
        steps = np.stack([index[k : len(index) - 5 + k] - first for k in range(6)], axis=1)
        places = np.flatnonzero((steps == (0, 1, 2, 0, 2, 3)).all(axis=1))
        text, pen, until = None, (0.0, 0.0), -1
        for place in places:
            if place < until:
                continue
            corners = vertices[first[place] : first[place] + 4]
            uv = corners["uv"].astype(np.float64)
            low, high = uv.min(axis=0), uv.max(axis=0)
            if high[0] - low[0] <= 0.0 or high[1] - low[1] <= 0.0 or not corners["ink"][0] >> 24:
                continue
            number = glyphs.find(*low, *high)
            if number is None:
                continue
            until = place + 6
            letter, glyph, size = glyphs.of[number]
            xy = corners["pos"].astype(np.float64)
            (x0, y0), (x1, y1) = xy.min(axis=0), xy.max(axis=0)
            upright = abs(xy[1, 1] - xy[0, 1]) < 1e-3
            cut = set()
            if upright:  # the whole letter, of which a part may be drawn
                wide = (x1 - x0) / (high[0] - low[0])
                tall = (y1 - y0) / (high[1] - low[1])
                x0, x1 = x0 - (low[0] - glyph.u0) * wide, x1 + (glyph.u1 - high[0]) * wide
                y0, y1 = y0 - (low[1] - glyph.v0) * tall, y1 + (glyph.v1 - high[1]) * tall
                lost_x = (low[0] - glyph.u0 + glyph.u1 - high[0]) * wide
                lost_y = (low[1] - glyph.v0 + glyph.v1 - high[1]) * tall
                cut |= {"x"} if lost_x > SLACK_PX else set()
                cut |= {"y"} if lost_y > SLACK_PX else set()
            box = (x0, y0, x1, y1)
            cut |= {"x"} if x0 < clip[0] - SLACK_PX or x1 > clip[2] + SLACK_PX else set()
            cut |= {"y"} if y0 < clip[1] - SLACK_PX or y1 > clip[3] + SLACK_PX else set()
            near = upright and not flush and clip[2] - EDGE_EM * size < x1
            cut |= {"x"} if near else set()
            if down:
                cut.discard("y")
            at = (x0 - glyph.x0, y0 - glyph.y0)
            follows = text is not None and text.upright == upright and text.size == size
            if follows and upright:
                gap = at[0] - pen[0]
                follows = abs(at[1] - pen[1]) < 0.75 and -1.5 < gap < SPACE_EM * size
            elif follows:
                follows = abs(x1 - text.ink[2]) < size and abs(y1 - text.ink[1]) < size
            if not follows:
                text = Text("", box, clip, name, root, size, upright)
                found.append(text)
            elif upright and at[0] - pen[0] > 0.1 * size:
                text.letters += " "
            text.letters += letter
            text.ink = (min(text.ink[0], x0), min(text.ink[1], y0),
                        max(text.ink[2], x1), max(text.ink[3], y1))  # fmt: skip
            text.cut |= cut
            pen = (at[0] + glyph.advance_x, at[1])
    return found
