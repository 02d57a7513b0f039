"""Pages of words: their contents, and how they are drawn on the surround."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.arrays import Rgb
from relgloss_view.base.words import sentence_case
from relgloss_view.experiment.session.flow import Flow, Phase
from relgloss_view.picture.model.view import Size
from relgloss_view.viewer.shell.theme import coloured
from relgloss_view.viewer.trials import keys
from relgloss_view.viewer.trials.ink import Ink

TEXT_SHARE, TEXT_PX = 1.0 / 38.0, (13.0, 40.0)  #: size of text: share of the window's height
HEADING, NOTE = 1.45, 0.85  #: times the text's size
PADDING, BETWEEN = (0.8, 0.35), 0.7  #: in and between buttons, in sizes of the text
COLUMN = 34.0  #: width of a column of text, in sizes of it: about 65 letters
WIDEST = 0.9  #: share of the window
_FLAGS = (
    imgui.WindowFlags_.no_decoration
    | imgui.WindowFlags_.no_background
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_saved_settings
)

CONFIRM, DECLINE, UNDO, CLOSE, RETRY = "confirm", "decline", "undo", "close", "retry"


@dataclass(frozen=True)
class Button:
    """What can be done on a page, by mouse and by key."""

    text: str
    action: str
    chords: tuple[int, ...] = ()


@dataclass(frozen=True)
class Page:
    """Heading, text, a quieter line, and what can be done."""

    heading: str
    text: str = ""
    note: str = ""
    buttons: tuple[Button, ...] = ()


_BACK = Button("Take the last answer back (Backspace)", UNDO, keys.BACKSPACE)


def page_of(flow: Flow, *, answered: bool, note: str = "") -> Page | None:
    """The page of the present screen; None where pictures or the surround alone stand.

    answered: whether there is an answer to take back. note: what the first page tells the operator.
    """
    study = flow.study
    back = (_BACK,) if answered else ()
    if flow.phase is Phase.CONSENT:
        agree = Button("I agree (Enter)", CONFIRM, keys.ENTER)
        return Page(study.title, study.consent, "", (agree, Button("I decline", DECLINE)))
    if flow.phase is Phase.INSTRUCTIONS:
        go_on = Button("Continue (Enter)", CONFIRM, keys.ENTER)
        return Page(study.title, study.guide, note, (go_on,))
    if flow.phase is Phase.OBJECT and flow.trial is not None:
        label = study.samples[flow.trial.sample].label
        in_place = Button("It is in place (Enter)", CONFIRM, keys.ENTER)
        note = "The experimenter does this."
        return Page(f"Put {label} beside the reference", "", note, (in_place, *back))
    if flow.phase is Phase.PAUSE:
        go_on = Button("Continue (Enter or Space)", CONFIRM, keys.ENTER + keys.SPACE)
        return Page("Pause", "", "", (go_on,))
    if flow.phase is Phase.FINISHED:
        end = Button("End (Enter)", CLOSE, keys.ENTER)
        return Page("Thank you", "That was the last picture.", note, (end, *back))
    if flow.phase is Phase.DECLINED:
        end = Button("Close (Enter)", CLOSE, keys.ENTER)
        return Page("Thank you", "You will be asked nothing. Only the refusal is kept.", "", (end,))
    return None


def fault_page(heading: str, reason: str) -> Page:
    """What was not done and why; it stays until somebody goes back or ends."""
    return Page(
        heading,
        f"{reason}.\n\nPlease call the experimenter. Every earlier answer is kept. Go "
        "back to try again.",
        "",
        (
            Button("Go back (Enter)", RETRY, keys.ENTER),
            Button("End (Ctrl+Q)", CLOSE, keys.QUIT),
        ),
    )


def letters_page(warnings: list[str]) -> Page:
    """What of the study can't be read here, for the operator; before anything is asked."""
    lines = "\n\n".join(f"{sentence_case(line)}." for line in warnings)
    return Page(
        "Texts of this study can't be read here",
        f"{lines}\n\nPlease mend this before an observer reads it.",
        "This page is for the experimenter.",
        (
            Button("Continue all the same (Enter)", RETRY, keys.ENTER),
            Button("End (Ctrl+Q)", CLOSE, keys.QUIT),
        ),
    )


def display_page(lines: tuple[str, ...]) -> Page:
    """What is to be known of the display before anything is asked; for the experimenter."""
    return Page(
        "Please check the display",
        "\n\n".join(f"{sentence_case(line)}." for line in lines),
        "This page is for the experimenter.",
        (
            Button("Continue all the same (Enter)", RETRY, keys.ENTER),
            Button("End (Ctrl+Q)", CLOSE, keys.QUIT),
        ),
    )


def small_page(window: Size, needed: Size) -> Page:
    """The pictures don't fit into the window, and are never shown scaled."""
    return Page(
        "The window is too small for the pictures",
        f"It has {window[0]} x {window[1]} pixels; they take {needed[0]} x {needed[1]}. Make the "
        "window larger (without --window it fills the screen), or set screen.width_px and "
        "screen.height_px lower in the study file, before its first observer.",
        "Ctrl+Q ends; all is kept.",
    )


def text_px(window: Size) -> float:
    """Size of the text on a window of so many pixels, a whole number: fonts are drawn in those."""
    return float(round(min(max(TEXT_SHARE * window[1], TEXT_PX[0]), TEXT_PX[1])))


def show(page: Page, ink: Ink, window: Size, *, keyed: bool = True) -> str | None:
    """Draw a page in the middle of the window; returns what was clicked or pressed, an action.

    keyed: whether keys of this frame are for this page.
    """
    size = text_px(window)
    pressed = _pressed(page) if keyed else None
    if window[0] < 4.0 * size or window[1] < 4.0 * size:
        return pressed  # no room for a word
    column = min(_natural(page, size), COLUMN * size, WIDEST * window[0])
    imgui.set_next_window_pos(ImVec2(0.5 * (window[0] - column), 0.0))
    imgui.set_next_window_size(ImVec2(column, window[1]))
    for variable in (imgui.StyleVar_.window_padding, imgui.StyleVar_.window_min_size):
        imgui.push_style_var(variable, ImVec2(0.0, 0.0))
    imgui.begin("##page", None, _FLAGS)
    imgui.pop_style_var(2)
    _push_look(ink, size)
    action = _fill(page, ink, column, window[1])
    _pop_look()
    imgui.end()
    return action or pressed


def line(text: str, shade: Rgb, size: float, window: Size, top: float) -> None:
    """A line of text in the middle of the window's width, `top` pixels from its upper edge."""
    size = round(size)
    wide = _size(text, size).x
    colour = imgui.color_convert_float4_to_u32(coloured(shade))
    place = ImVec2(max(round(0.5 * (window[0] - wide)), 0.0), round(top))
    imgui.get_background_draw_list().add_text(imgui.get_font(), size, place, colour, text)


def _fill(page: Page, ink: Ink, column: float, height: float) -> str | None:
    """Heading, text and buttons, as a block a little above the middle."""
    size = imgui.get_font_size()
    space = 0.9 * size
    heading_px = _height(page.heading, column, HEADING * size)
    text_px, note_px = _height(page.text, column, size), _height(page.note, column, NOTE * size)
    rows = _rows(page.buttons, column)
    fixed = heading_px + note_px + len(rows) * (imgui.get_frame_height() + space)
    fixed += space * (bool(page.text) + bool(page.note) + 1)
    text_room = min(text_px, max(height - fixed - 3.0 * space, 2.0 * size))
    imgui.set_cursor_pos_y(max(0.42 * (height - fixed - text_room), space))
    _words(page.heading, ink.text, HEADING * size)
    if page.text:
        imgui.dummy(ImVec2(0.0, space))
        imgui.begin_child("text", ImVec2(column, text_room + 1.0))
        _words(page.text, ink.text, size)
        _scroll(size, text_room)
        imgui.end_child()
    if page.note:
        imgui.dummy(ImVec2(0.0, space))
        _words(page.note, ink.text if not page.text else ink.quiet, NOTE * size)
    imgui.dummy(ImVec2(0.0, space))
    action = None
    for row in rows:
        for k, button in enumerate(row):
            if k:
                imgui.same_line()
            if imgui.button(button.text):
                action = button.action
    return action


def _natural(page: Page, size: float) -> float:
    """Width that a page takes where no line is broken, so that a short one is centred."""
    widths = [_size(button.text, size).x + 2.0 * PADDING[0] * size for button in page.buttons]
    across = sum(widths) + BETWEEN * size * max(len(widths) - 1, 0)
    parts = ((page.heading, HEADING * size), (page.text, size), (page.note, NOTE * size))
    return max(across, *(_size(text, px).x for text, px in parts)) + 1.0


def _size(text: str, size: float, column: float = -1.0) -> ImVec2:
    """What a text takes, broken at a column's width if there is one."""
    imgui.push_font(None, size)
    taken = imgui.calc_text_size(text, wrap_width=column)
    imgui.pop_font()
    return taken


def _rows(buttons: tuple[Button, ...], column: float) -> list[list[Button]]:
    """Buttons beside each other as far as they fit."""
    style = imgui.get_style()
    rows: list[list[Button]] = []
    reached = 0.0
    for button in buttons:
        wide = imgui.calc_text_size(button.text).x + 2.0 * style.frame_padding.x
        if rows and reached + style.item_spacing.x + wide <= column:
            rows[-1].append(button)
            reached += style.item_spacing.x + wide
        else:
            rows.append([button])
            reached = wide
    return rows


def _words(text: str, shade: Rgb, size: float) -> None:
    imgui.push_font(None, size)
    imgui.push_style_color(imgui.Col_.text, coloured(shade))
    imgui.push_text_wrap_pos(0.0)
    imgui.text_unformatted(text)
    imgui.pop_text_wrap_pos()
    imgui.pop_style_color()
    imgui.pop_font()


def _height(text: str, column: float, size: float) -> float:
    return float(_size(text, size, column).y) if text else 0.0


def _scroll(size: float, room: float) -> None:
    """Long texts move by keys too."""
    steps = (("down_arrow", 2.0 * size), ("up_arrow", -2.0 * size),
             ("page_down", 0.9 * room), ("page_up", -0.9 * room))  # fmt: skip
    for key, step in steps:
        if imgui.is_key_pressed(getattr(imgui.Key, key)):
            imgui.set_scroll_y(imgui.get_scroll_y() + step)


def _pressed(page: Page) -> str | None:
    for button in page.buttons:
        if keys.pressed(button.chords):
            return button.action
    return None


def _push_look(ink: Ink, size: float) -> None:
    imgui.push_font(None, size)
    imgui.push_style_var(
        imgui.StyleVar_.frame_padding, ImVec2(PADDING[0] * size, PADDING[1] * size)
    )
    imgui.push_style_var(imgui.StyleVar_.frame_border_size, 0.0)
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(BETWEEN * size, 0.0))
    imgui.push_style_color(imgui.Col_.text, coloured(ink.text))
    for name, shade in (
        ("button", ink.field), ("button_hovered", ink.hovered), ("button_active", ink.pressed),
        ("scrollbar_grab", ink.hovered), ("scrollbar_grab_hovered", ink.pressed),
        ("scrollbar_grab_active", ink.pressed),
    ):  # fmt: skip
        imgui.push_style_color(getattr(imgui.Col_, name), coloured(shade))


def _pop_look() -> None:
    imgui.pop_style_color(7)
    imgui.pop_style_var(3)
    imgui.pop_font()
