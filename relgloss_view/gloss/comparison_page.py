"""A comparison as a page of HTML that stands alone: pictures inside, numbers in a table."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from relgloss_view.base.version import __version__
from relgloss_view.gloss.comparison import Comparison, Row, Settled, title_of, words_of
from relgloss_view.gloss.comparison_sheet import MEASURES, VERDICTS, body_words, number

#: Neutral grays: the pictures' own surround is L* 50.
STYLE = """
body { margin: 2rem; background: #777; color: #fff; font: 15px/1.45 system-ui, sans-serif; }
h1 { font-size: 1.5rem; font-weight: 600; margin: 0 0 .3rem; }
h2 { font-size: 1.1rem; font-weight: 600; margin: 2rem 0 .2rem; }
p { margin: .2rem 0; max-width: 60rem; }
.muted { color: #eee; }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; margin: .8rem 0; }
figure { margin: 0; } img { display: block; } figcaption { color: #eee; }
table { border-collapse: collapse; margin: .6rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: .15rem .8rem .15rem 0; text-align: right; border-bottom: 1px solid #909090; }
th { font-weight: 600; } th:first-child, td:first-child { text-align: left; }
code { font: 13px/1.4 ui-monospace, monospace; overflow-wrap: anywhere; }
"""
COLUMNS = (
    ("99th percentile", "L*"),
    ("peak contrast", "L*"),
    ("graininess", "L*"),
    ("sharpness", "L*/deg"),
    ("clipped", "%"),
    ("body colour", "dE2000"),
)


def comparison_page(comparison: Comparison, note: str, command: str) -> str:
    """The page as text; `command` is the line that makes it again."""
    parts = [
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width">',
        f"<title>relgloss compare</title><style>{STYLE}</style></head><body>",
        "<h1>Samples under each operator</h1>",
        f'<p class="muted">{escape(note)} Pictures are shown pixel by pixel; look at them at 100 %.'
        "</p>",
        _samples(comparison),
        *(_operator(row, comparison.srgb) for row in comparison.rows),
        "<h2>Made with</h2>",
        f'<p class="muted">relgloss {escape(__version__)}</p><p><code>{escape(command)}</code></p>',
        "</body></html>\n",
    ]
    return "\n".join(parts)


def _samples(comparison: Comparison) -> str:
    heads = ("sample", words_of(comparison.gloss), "sigma_N, deg", "c of the split", "c_max")

    def cells(s: Settled) -> tuple[str, ...]:
        return (
            s.case.label,
            _rounded(s.gloss[comparison.gloss]),
            f"{s.case.look.sigma_n_deg:g}",
            _rounded(s.c),
            _rounded(s.c_max),
        )

    return _table(heads, [cells(s) for s in comparison.samples])


def _operator(row: Row, srgb: bool) -> str:
    figures = [
        f'<figure><img src="{_embedded(cell.picture, srgb)}" width="{cell.picture.shape[1]}" '
        f'height="{cell.picture.shape[0]}" alt="{escape(label, quote=True)} shown by '
        f'{escape(title_of(row.operator), quote=True)}"><figcaption>{escape(label)}</figcaption>'
        "</figure>"
        for label, cell in row.cells.items()
    ]
    heads = ("sample", *(f"{name}, {unit}" for name, unit in COLUMNS))
    numbers = []
    for label, cell in row.cells.items():
        m = cell.measures
        share = None if m.clipped_share is None else 100.0 * m.clipped_share
        numbers.append(
            (
                label,
                number(m.contrast_gloss),
                number(m.peak_contrast),
                number(m.graininess, 2),
                number(m.sharpness, 0),
                number(share, 2),
                number(m.body_difference, 2),
            )
        )
    orders = []
    for name, words in MEASURES.items():
        order = row.orders[name]
        tau = "" if order.tau is None else f", Kendall's tau {order.tau:.2f}"
        orders.append(
            f"<p>By {words}: <strong>{VERDICTS[order.verdict]}</strong>{tau}"
            f"{escape(f' ({order.words})') if order.ranks else ''}</p>"
        )
    told = [
        f'<p class="muted">{escape(label)}: {escape(text)}</p>'
        for label, cell in row.cells.items()
        for text in cell.warnings
    ]
    return "\n".join(
        [
            f"<h2>{escape(title_of(row.operator))}</h2>",
            f'<p class="muted">{escape(row.operator.meaning)} ({escape(row.operator.source)})</p>',
            f'<div class="pictures">{"".join(figures)}</div>',
            *orders,
            f"<p>{escape(_sentence(body_words(row)))}</p>",
            _table(heads, numbers),
            *told,
        ]
    )


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(text)}</td>" for text in row) + "</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _rounded(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def _embedded(picture: NDArray[np.uint8], srgb: bool) -> str:
    """A picture as a data URL, PNG."""
    from PIL import Image

    from relgloss_view.picture.output.png import srgb_profile

    held = io.BytesIO()
    profile = {"icc_profile": srgb_profile()} if srgb else {}
    Image.fromarray(picture).save(held, format="PNG", **profile)
    return "data:image/png;base64," + base64.b64encode(held.getvalue()).decode("ascii")
