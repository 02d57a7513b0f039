from __future__ import annotations

import itertools
import random
import xml.etree.ElementTree

import numpy as np
import pytest
from PIL import Image

from relgloss_view.bench.speed import methods
from relgloss_view.bench.speed.chart import CHARTS, figure_of, write_chart
from relgloss_view.bench.speed.labels import spread


def made_up(entries=None, quick=False):
    """What a run finds, as far as the chart looks at it."""
    chance = random.Random(7)
    if entries is None:
        entries = [
            (way.label, way.group, 1.2 + 0.5 * chance.random(), 10 ** chance.uniform(-4, 1.5))
            for way in methods.WAYS
        ]
        entries[-1] = (*entries[-1][:2], 4.2, 20.0)
        entries[-2] = (*entries[-2][:2], 9.0, 0.7)
    return {
        "methods": [
            {
                "method": f"m{k}",
                "label": label,
                "group": group,
                "floors": floors,
                "worst_p95": p95,
                "front": k in (0, 3),
                "default": group == "default",
                "charted": True,
            }
            for k, (label, group, floors, p95) in enumerate(entries)
        ],
        "settings": {"size": (1280, 720)},
        "scenes": [{"floor_ms": 6.0}, {"floor_ms": 7.0}],
        "machine": {"cpu": "A $processor$", "cores": 2, "opengl": {"renderer": "a driver"}},
        "quick": quick,
    }


def boxes(found):
    figure = figure_of(found)
    canvas = figure.canvas.get_renderer()
    labels = {entry["label"] for entry in found["methods"]}
    texts = [t for axis in figure.axes for t in axis.texts]
    return {
        t.get_text().replace(",\n", ", "): t.get_window_extent(canvas)
        for t in texts
        if t.get_text().replace(",\n", ", ") in labels
    }, figure


def test_no_label_is_missing_and_none_overlaps_another():
    found = made_up()
    placed, figure = boxes(found)
    assert set(placed) == {entry["label"] for entry in found["methods"]}
    for (one, a), (other, b) in itertools.combinations(placed.items(), 2):
        apart = a.x1 <= b.x0 or b.x1 <= a.x0 or a.y1 <= b.y0 + 1.0 or b.y1 <= a.y0 + 1.0
        assert apart, (one, other)
    width, height = figure.bbox.width, figure.bbox.height
    for label, box in placed.items():
        assert 0.0 <= box.x0 <= box.x1 <= width, label
        assert 0.0 <= box.y0 <= box.y1 <= height, label


@pytest.mark.parametrize("quick", [True, False])
def test_both_files_are_written_and_hold_something(tmp_path, quick):
    write_chart(made_up(quick=quick), tmp_path)
    assert {p.name for p in tmp_path.iterdir()} == set(CHARTS)
    picture = np.asarray(Image.open(tmp_path / "chart.png").convert("L"))
    assert picture.shape[1] > 1200
    assert 0.01 < np.mean(picture < 200) < 0.3
    root = xml.etree.ElementTree.parse(tmp_path / "chart.svg").getroot()
    assert root.tag.endswith("svg")
    first = (tmp_path / "chart.svg").read_bytes()
    write_chart(made_up(quick=quick), tmp_path)
    assert (tmp_path / "chart.svg").read_bytes() == first


def test_a_run_whose_rows_all_stand_alone_or_together():
    # One panel where nothing is far slower; a single row; nothing near the floor.
    for entries in (
        [("default", "default", 1.5, 1e-5), ("Lambert", "diffuse", 1.4, 2.0)],
        [("default", "default", 40.0, 1e-5)],
        [("default", "default", 30.0, 0.0), ("16 samples", "samples", 400.0, 3.0)],
    ):
        placed, _ = boxes(made_up(entries))
        assert len(placed) == len(entries)


def test_labels_spread_no_more_than_they_must():
    assert spread([1.0, 2.0, 5.0], 1.0, 0.0, 10.0) == [1.0, 2.0, 5.0]
    # Two that want one place share the way; a third that they reach joins them.
    assert spread([4.0, 4.0], 1.0, 0.0, 10.0) == pytest.approx([3.5, 4.5])
    assert spread([4.0, 4.0, 4.0], 1.0, 0.0, 10.0) == pytest.approx([3.0, 4.0, 5.0])
    assert spread([0.0, 0.0], 1.0, 0.0, 10.0) == [0.0, 1.0]
    assert spread([10.0, 10.0], 1.0, 0.0, 10.0) == [9.0, 10.0]
    assert spread([], 1.0, 0.0, 1.0) == []
    chance = random.Random(2)
    for _ in range(50):
        wanted = sorted(chance.uniform(0.0, 10.0) for _ in range(9))
        placed = spread(wanted, 0.8, 0.0, 10.0)
        assert all(b - a > 0.8 - 1e-9 for a, b in itertools.pairwise(placed))
        # No worse than spreading them evenly.
        even = [1.25 * k for k in range(9)]
        off = [
            sum((p - w) ** 2 for p, w in zip(some, wanted, strict=True)) for some in (placed, even)
        ]
        assert off[0] <= off[1] + 1e-9
