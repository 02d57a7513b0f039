"""A comparison as a page of HTML that stands alone: pictures inside, numbers in a table."""

from __future__ import annotations

import io
from html import escape

from relgloss_view.base import pages
from relgloss_view.base.arrays import Bytes
from relgloss_view.base.version import __version__
from relgloss_view.gloss.comparison import Comparison, Row, Settled, title_of, words_of
from relgloss_view.gloss.comparison_sheet import MEASURES, VERDICTS, body_words, number

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
    """The page as text; `command` is the line that makes it again."""
    parts = [
        "<h1>Samples under each operator</h1>",
        f'<p class="muted">{escape(note)} Pictures are shown pixel by pixel; look at them at 100 %.'
        "</p>",
        _samples(comparison),
        *(_operator(row, comparison.srgb) for row in comparison.rows),
        "<h2>Made with</h2>",
        f'<p class="muted">relgloss {escape(__version__)}</p><p><code>{escape(command)}</code></p>',
    ]
    return pages.page("relgloss compare", parts, STYLE)


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

    return pages.table(heads, [cells(s) for s in comparison.samples])


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
            f"<p>{escape(pages.sentence_case(body_words(row)))}</p>",
            pages.table(heads, numbers),
            *told,
        ]
    )


def _rounded(value: float | None) -> str:
    return "-" if value is None else f"{value:.4g}"


def _embedded(picture: Bytes, srgb: bool) -> str:
    """A picture as a data URL, PNG."""
    from PIL import Image

    from relgloss_view.picture.output.png import srgb_profile

    held = io.BytesIO()
    profile = {"icc_profile": srgb_profile()} if srgb else {}
    Image.fromarray(picture).save(held, format="PNG", **profile)
    return pages.embedded_png(held.getvalue())
