"""The page of a catalogue in Firefox and WebKitGTK: engines that share no code with Chromium."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import other_engines
import pytest
from browsers import screen
from page_rows import seeded, seeded_rows

from relgloss_view.catalogue.page.write import write_page

pytestmark = pytest.mark.slow

COUNT = 300
FILTERED = """async () => {
  await relgloss.ready;
  const field = document.querySelectorAll('[data-range="gloss_60"] input[type="number"]');
  field[0].value = "40"; field[0].dispatchEvent(new Event("change"));
  field[1].value = "50"; field[1].dispatchEvent(new Event("change"));
  for (let k = 0; k < 600 && !location.hash; k++)
    await new Promise((done) => setTimeout(done, 100));
  const pictures = [...document.querySelectorAll("#list img")];
  await Promise.all(pictures.map((one) => one.decode()));
  return [relgloss.csv(), pictures.map((one) => one.naturalWidth), location.hash];
}"""
OPENED = """async () => {
  document.querySelector(".open").click();
  const box = document.querySelector("dialog[open]");
  const seen = [box.querySelectorAll("dd").length, box.querySelector("code").textContent];
  box.close();
  document.querySelectorAll(".pick input")[0].click();
  document.querySelectorAll(".pick input")[1].click();
  await new Promise((done) => setTimeout(done, 1000));
  document.querySelector("#tray .first").click();
  seen.push(document.querySelectorAll("dialog[open] thead th").length);
  document.querySelector("dialog[open]").close();
  return seen;
}"""
#: Nothing overlaps: the list ends within the window, and no line of the page is wider than it.
PLACED = """() => {
  const list = document.getElementById("list").getBoundingClientRect();
  return [list.height, list.bottom <= innerHeight + 1,
    document.documentElement.scrollWidth <= innerWidth];
}"""


@pytest.fixture(params=["firefox", "webkit"])
def other_engine(request):
    with screen() as display, getattr(other_engines, request.param)(display) as browser:
        yield browser


def test_other_engines_filter_open_and_compare(other_engine, tmp_path: Path):
    found, catalogue = seeded(COUNT)
    page = tmp_path / "page.html"
    write_page(found, catalogue, page)
    other_engine.open(page)
    other_engine.resize(1400, 900)
    text, widths, fragment = other_engine.call(FILTERED)
    done = [row for row in seeded_rows(COUNT) if row.get("status") != "failed"]
    expected = {row["path"] for row in done if 40 <= row["gloss_60"] <= 50}
    assert 0 < len(expected) < len(done)
    assert {row["path"] for row in csv.DictReader(io.StringIO(text))} == expected
    assert len(widths) > 4
    assert set(widths) == {128}  # each one decoded
    assert "gloss_60=40..50" in fragment
    facts, command, compared = other_engine.call(OPENED)
    assert facts > 10
    assert command.startswith("relgloss view ")
    assert compared == 2
    for width in (1400, 900, 460):
        other_engine.resize(width, 900)
        other_engine.call("() => new Promise((done) => setTimeout(done, 200))")
        high, is_within, is_narrow = other_engine.call(PLACED)
        assert high > 300
        assert is_within
        assert is_narrow
    if isinstance(other_engine, other_engines.Firefox):
        assert other_engine.requests() == []
        assert other_engine.errors() == []
