"""A comparison as one file of HTML: the pictures inside it, the numbers in tables."""

from __future__ import annotations

import io
from html import escape

from relgloss_view.base import pages
from relgloss_view.base.arrays import Bytes
from relgloss_view.base.version import __version__
from relgloss_view.base.words import sentence_case
from relgloss_view.display.display import Display
from relgloss_view.gloss.comparison import Cell, Comparison, DrawnSample, OperatorRow
from relgloss_view.gloss.comparison_sheet import MEASURES, VERDICTS, body_words, number, percent
from relgloss_view.gloss.samples import gloss_words

STYLE = """
h2 { font-size: 1.1rem; font-weight: 600; margin: 2rem 0 .2rem; }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; margin: .8rem 0; }
figure { margin: 0; } img { display: block; } figcaption { color: #eee; }
table { margin: .6rem 0; }
th, td { padding: .15rem .8rem .15rem 0; }
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
    """The page as text; `command` is the command line that makes it again."""
    parts = [
        "<h1>Samples under each operator</h1>",
        f'<p class="muted">{escape(note)} Pictures are shown pixel by pixel; look at them at 100 %.'
        "</p>",
        _samples(comparison),
        *(_operator(row, comparison.display) for row in comparison.rows),
        "<h2>Made with</h2>",
        f'<p class="muted">relgloss {escape(__version__)}</p><p><code>{escape(command)}</code></p>',
    ]
    return pages.page("relgloss compare", parts, STYLE)


def _samples(comparison: Comparison) -> str:
    heads = ("sample", gloss_words(comparison.gloss), "sigma_N, deg", "c of the split", "c_max")

    def cells(drawn: DrawnSample) -> tuple[str, ...]:
        return (
            drawn.sample.label,
            _rounded(drawn.gloss[comparison.gloss]),
            f"{drawn.sample.look.sigma_n_deg:g}",
            _rounded(drawn.c),
            _rounded(drawn.c_max),
        )

    return pages.table(heads, [cells(drawn) for drawn in comparison.samples])


def _operator(row: OperatorRow, display: Display) -> str:
    figures = [
        f'<figure><img src="{_embedded(cell.picture, display)}" width="{cell.picture.shape[1]}" '
        f'height="{cell.picture.shape[0]}" alt="{escape(label, quote=True)} shown by '
        f'{escape(row.operator.label, quote=True)}"><figcaption>{escape(label)}</figcaption>'
        "</figure>"
        for label, cell in row.cells.items()
    ]
    heads = ("sample", *(f"{name}, {unit}" for name, unit in COLUMNS))
    numbers = [_numbers(label, cell) for label, cell in row.cells.items()]
    orders = []
    for name, words in MEASURES.items():
        order = row.orders[name]
        tau = "" if order.tau is None else f", Kendall's tau {order.tau:.2f}"
        orders.append(
            f"<p>By {words}: <strong>{VERDICTS[order.verdict]}</strong>{tau}"
            f"{escape(f' ({order.words})') if order.ranks else ''}</p>"
        )
    warnings = [
        f'<p class="muted">{escape(label)}: {escape(text)}</p>'
        for label, cell in row.cells.items()
        for text in cell.warnings
    ]
    return "\n".join(
        [
            f"<h2>{escape(row.operator.label)}</h2>",
            f'<p class="muted">{escape(row.operator.meaning)} ({escape(row.operator.source)})</p>',
            f'<div class="pictures">{"".join(figures)}</div>',
            *orders,
            f"<p>{escape(sentence_case(body_words(row)))}</p>",
            pages.table(heads, numbers),
            *warnings,
        ]
    )


def _numbers(label: str, cell: Cell) -> tuple[str, ...]:
    m = cell.measures
    return (
        label,
        number(m.contrast_gloss),
        number(m.peak_contrast),
        number(m.graininess, 2),
        number(m.sharpness, 0),
        number(percent(m.clipped_share), 2),
        number(m.body_difference, 2),
    )


def _rounded(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def _embedded(picture: Bytes, display: Display) -> str:
    """A picture as a data URL, PNG."""
    from PIL import Image

    from relgloss_view.display.icc_writing import profile_of

    file = io.BytesIO()
    Image.fromarray(picture).save(file, format="PNG", icc_profile=profile_of(display))
    return pages.embedded_png(file.getvalue())
