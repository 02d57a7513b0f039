"""The static body of a proof's page: complete with JavaScript off, or where nothing can be drawn.

Texts of people are escaped as browsers escape them when they serialise a page, and never go into an
attribute, so that the page can hash itself (build.py).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from decimal import ROUND_HALF_UP, Context
from typing import Any

from relgloss_view.proof.page import build
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.settings import SIDES, LampPlace, Settings

#: Characters that HTML changes or that no text needs: controls but for the line feed.
_CONTROLS = dict.fromkeys(
    [*range(0x0A), *range(0x0B, 0x20), *range(0x7F, 0xA0), *range(0xFDD0, 0xFDF0), 0xFFFE, 0xFFFF],
    "\ufffd",
)
_SIGNS: dict[str, str | int | None] = {"&": "&amp;", "<": "&lt;", ">": "&gt;", "\u00a0": "&nbsp;"}
Say = Callable[..., str]
_THREE_DIGITS = Context(prec=3, rounding=ROUND_HALF_UP)


def body(proof: Proof, language: str = "en") -> str:
    """The HTML between <body> and the data of a proof's page."""
    table = build.words(language)

    def say(key: str, /, **values: object) -> str:
        """A text of the table with its placeholders filled, escaped."""
        return escaped(table[key].format_map(values))

    newest = proof.messages[-1]
    byline = _byline(newest, len(proof.messages), say)
    note = f'<blockquote class="note">{escaped(newest.note)}</blockquote>\n' if newest.note else ""
    return (
        '<div id="top">\n'
        f'<header class="head"><p class="kicker">{say("page.kind")}</p>\n'
        f"<h1>{escaped(proof.title)}</h1>{_beside(proof.content.get('names'), say)}</header>\n"
        f'<p id="unchecked" class="notice late">{say("state.unchecked")}</p>\n'
        '<p id="notice" class="notice" role="alert" hidden=""></p>\n'
        '<main id="main">\n<div class="work">\n<section id="look" class="look">\n'
        '<div id="view" class="view"><div id="stage" class="stage">\n'
        f"{_pictures(proof, say)}</div></div>\n</section>\n"
        f'<div id="panel" class="panel"><p class="byline">{byline}</p>\n{note}'
        f'<div id="controls"></div></div>\n</div>\n<div id="more" class="more">\n'
        f'<div class="talk">{_thread(proof, say)}</div>\n<div class="facts">\n'
        f"{_readings(proof.content, say)}"
        f"{_made_for(proof.content.get('display'), say)}"
        '<section id="check"></section>\n<section id="screen"></section>\n'
        f"{_how(say)}</div></div>\n</main>\n"
        '<p id="live" class="unseen" role="status" aria-live="polite"></p></div>'
    )


def escaped(text: object) -> str:
    """Text as browsers serialise it in an element.

    >>> escaped('<b> & "q"')
    '&lt;b&gt; &amp; "q"'
    """
    lines = "\n".join("\n".join(str(text).split("\r\n")).split("\r"))
    plain = lines.translate(_CONTROLS).encode("utf-8", "replace").decode("utf-8")
    return plain.translate(str.maketrans(_SIGNS))


def number(value: float) -> str:
    """A number with three significant digits at most, halves rounded up, as browsers round them.

    Twin: js/static.js `shortNumber`.

    >>> number(0.14), number(54.5454), number(-1e-9), number(9996.0), number(1.125)
    ('0.14', '54.5', '0', '10000', '1.13')
    """
    if abs(value) < 1e-4:
        return "0"
    return f"{float(_THREE_DIGITS.create_decimal_from_float(value)):.10g}"


def settings_rows(settings: Settings, say: Say) -> list[tuple[str, str]]:
    """Settings in words: (what, value) of each, as HTML."""
    rows = []
    for side in SIDES:
        setting = settings.side(side)
        values = say(
            "settings.of-side", grain=number(setting.sigma_n_deg), contrast=number(setting.c)
        )
        rows.append((say(f"side.{side}"), values))
    eye = settings.eye
    place = say(
        "settings.eye-place", azimuth=number(eye.azimuth_deg), elevation=number(eye.elevation_deg)
    )
    lamp = (say("settings.lamp"), _lamp(settings.lamp, say))
    return [*rows, lamp, (say("settings.eye"), place)]


def _lamp(lamp: LampPlace, say: Say) -> str:
    return say(
        "settings.lamp-place",
        spectrum=lamp.illuminant,
        azimuth=number(lamp.azimuth_deg),
        elevation=number(lamp.elevation_deg),
    )


def _beside(names: object, say: Say) -> str:
    """Which reference sample both sides hold beside the screen; nothing where it has no name."""
    name = names.get("reference") if isinstance(names, Mapping) else None
    return f'<p class="quiet">{say("head.beside", name=name)}</p>' if name else ""


def _pictures(proof: Proof, say: Say) -> str:
    pictures: Mapping[str, Any] = proof.content.get("pictures", {})
    figures = []
    for side in SIDES:
        picture = pictures.get(side)
        if picture is None:
            continue
        # A str is base64 of WebP; a table has its media type.
        table = {"type": "image/webp", "base64": picture} if isinstance(picture, str) else picture
        source = f"data:{table.get('type', 'image/webp')};base64,{table['base64']}"
        figures.append(
            f'<figure><img alt="{say("picture.stored")}" src="{source}">\n'
            f"<figcaption>{say(f'side.{side}')}</figcaption></figure>\n"
        )
    return "".join(figures)


def _byline(message: Message, number: int, say: Say) -> str:
    """number: of the message in its thread, from 1."""
    if message.author:
        author = say("message.from", number=number, name=message.author)
    else:
        author = say("message.unnamed", number=number)
    return f"{author} {_time(message.made)}"


def _time(made: str) -> str:
    written = re.fullmatch(r"(\d{4}-\d\d-\d\d)T(\d\d:\d\d):\d\dZ", made, re.ASCII)
    if written is None:
        return ""
    return f'<time datetime="{made}">{written[1]} {written[2]} UTC</time>'


def _thread(proof: Proof, say: Say) -> str:
    """The messages, each with what it changes of the settings before it."""
    items = []
    before: list[tuple[str, str]] = []
    for number, message in enumerate(proof.messages, 1):
        settings = settings_rows(message.settings, say)
        rows = "".join(
            f"<div><dt>{name}</dt><dd>{value}</dd></div>"
            for name, value in settings
            if (name, value) not in before
        )
        before = settings
        same = f'<p class="quiet">{say("settings.same")}</p>'
        listed = f'<dl class="settings">{rows}</dl>' if rows else same
        note = f'<p class="said">{escaped(message.note)}</p>\n' if message.note else ""
        items.append(
            f'<li class="message"><p class="byline">{_byline(message, number, say)}</p>\n{note}'
            f"{listed}\n</li>\n"
        )
    return (
        f'<section id="thread"><h2>{say("thread.title")}</h2>\n'
        f'<ol class="thread">\n{"".join(items)}</ol></section>\n'
    )


def _readings(content: Mapping[str, Any], say: Say) -> str:
    meter, finishes = content.get("meter"), content.get("meter_finishes") or ()
    rows = []
    for entry in meter.values() if isinstance(meter, Mapping) else ():
        decimals = int(entry.get("decimals", 1))
        cells = "".join(f"<td>{_reading(entry.get(side), decimals)}</td>" for side in SIDES)
        rows.append(f'<tr><th scope="row">{escaped(entry["name"])}</th>{cells}</tr>\n')
    if not rows:
        return ""
    heads = "".join(f'<th scope="col">{say(f"side.{side}")}</th>' for side in SIDES)
    how = say("readings.how") + (f" {say('readings.glossiest')}" if finishes else "")
    return (
        f'<section id="readings"><h2>{say("readings.title")}</h2>\n'
        f'<p class="quiet">{how}</p>\n<table class="table"><thead><tr>'
        f'<th scope="col">{say("readings.meter")}</th>{heads}</tr></thead>\n'
        f"<tbody>{''.join(rows)}</tbody></table>\n{_finishes(meter, finishes, say)}</section>\n"
    )


def _finishes(meter: Any, finishes: Any, say: Say) -> str:
    """The readings of each finish that lies somewhere on a pack, folded."""
    parts = []
    for one in finishes:
        if not one.get("lies_somewhere", True):
            continue
        rows = "".join(
            f'<tr><th scope="row">{escaped(entry["name"])}</th>'
            f"<td>{_reading(one['readings'].get(key), int(entry.get('decimals', 1)))}</td></tr>\n"
            for key, entry in meter.items()
        )
        head = f'<tr><th colspan="2" scope="rowgroup">{escaped(one["finish"])}</th></tr>\n'
        parts.append(f"<tbody>{head}{rows}</tbody>")
    if not parts:
        return ""
    table = f'<table class="table finishes">{"".join(parts)}</table>'
    return f"<details><summary>{say('readings.finishes')}</summary>\n{table}</details>"


def _reading(value: object, decimals: int) -> str:
    return f"{value:.{decimals}f}" if isinstance(value, int | float) else "\u2013"


def _made_for(display: object, say: Say) -> str:
    if not isinstance(display, Mapping):
        return ""
    sentences = list(display.get("sentences", ()))
    lines = [(display.get("name") if sentences else "") or display.get("words", ""), *sentences]
    text = "".join(f"<p>{escaped(line)}</p>\n" for line in lines if line)
    if not text:
        return ""
    return f'<section id="made-for"><h2>{say("display.title")}</h2>\n{text}</section>\n'


def _how(say: Say) -> str:
    return (
        f'<section id="how"><h2>{say("how.title")}</h2>\n<p>{say("how.browser")}</p>\n'
        f"<p>{say('how.window')}</p></section>\n"
    )
