"""What the page writes into its own answers, in JavaScript, beside what Python writes."""

from __future__ import annotations

import json
import math
from fractions import Fraction

import numpy as np
import pytest
from browsers import Browser, call, open_page

from relgloss_view.proof import grid
from relgloss_view.proof.page import static
from relgloss_view.proof.page.build import bundle, words

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>twins</title></head><body>
<script type="application/json" id="words">{words}</script>
<script>{code}
Object.assign(window, {{shortNumber, plainText, gridPlaces}});
window.relgloss = {{ready: Promise.resolve()}};
</script></body></html>
"""


@pytest.fixture
def page(chromium_gl: Browser) -> Browser:
    """The modules alone, without a picture."""
    table = json.dumps(words()).replace("<", "\\u003c")
    open_page(chromium_gl, PAGE.format(words=table, code=bundle("static.js", "check.js")))
    return chromium_gl


def half_up(value: float) -> float:
    """Three significant digits, halves away from zero, by whole numbers alone."""
    exact = abs(Fraction(value))
    step = Fraction(10) ** (math.floor(math.log10(exact)) - 2)
    return math.copysign(float(math.floor(exact / step + Fraction(1, 2)) * step), value)


def test_numbers_are_written_alike(page: Browser) -> None:
    """Ties too: a slider of sigma_N reaches 1.125, of which a double holds every digit."""
    rng = np.random.default_rng(4)
    ties = [*(np.arange(801, 1600) / 800.0).tolist(), 10.25, 12.35, 100.5, 9996.0, 2.625]
    spread = 10.0 ** rng.uniform(-5.0, 4.0, 2000)
    values = [*ties, *spread.tolist(), *(-spread[:500]).tolist(), 0.0, 1e-4, 9.9999e-5]
    there = call(page, "(values) => values.map(shortNumber)", values)
    assert there == [static.number(value) for value in values]
    # Both, against a rounding that is neither's.
    large = [value for value in values if abs(value) >= 1e-4]
    assert [float(static.number(value)) for value in large] == pytest.approx(
        [half_up(value) for value in large], rel=1e-12
    )
    # The ties are such: rounding to even writes others.
    assert any(float(f"{value:.3g}") != half_up(value) for value in ties)


def test_texts_are_cleaned_alike(page: Browser) -> None:
    rng = np.random.default_rng(6)
    signs = [
        *map(chr, range(0x21)),
        *"<>&\"'\x7f\x85\xa0\ufdd0\ufdef\ufffe\uffff\ufffd\u2028",
        "é🖨",
    ]
    texts = ["".join(rng.choice(signs, 12)) for _ in range(300)] + ["a\r\nb\rc\n"]
    function = """(texts) => texts.map((text) => {
      const element = document.createElement("p");
      element.textContent = plainText(text);
      return element.innerHTML;
    })"""
    assert call(page, function, texts) == [static.escaped(text) for text in texts]


def test_the_grid_lies_on_the_same_pixels(page: Browser) -> None:
    for size in ((512, 512), (480, 641), (24, 25), (7, 4096)):
        there = call(
            page, "(size, n) => size.map((px) => gridPlaces(n, px))", list(size), grid.ROWS
        )
        assert there == [part.tolist() for part in grid.places(size)]
