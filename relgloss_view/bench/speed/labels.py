"""Labels of a column: each as near to its point as the others let it."""

from __future__ import annotations

from collections.abc import Sequence


def spread(wanted: Sequence[float], step: float, low: float, high: float) -> list[float]:
    """Places as near to those wanted (ascending) as a step between them allows, in least squares.

    They lie between low and high as long as there is room; otherwise they start at low.
    """
    # Blocks of labels that touch: what each would start its block at, summed, and how many.
    blocks: list[tuple[float, int]] = []
    for place in wanted:
        blocks.append((place, 1))
        while len(blocks) > 1:
            (total, count), (more, added) = blocks[-2:]
            if total / count + count * step <= more / added:
                break
            blocks[-2:] = [(total + more - added * count * step, count + added)]
    placed = [total / count + k * step for total, count in blocks for k in range(count)]
    for k in range(len(placed) - 1, -1, -1):
        placed[k] = min(placed[k], high - (len(placed) - 1 - k) * step)
    for k in range(len(placed)):
        placed[k] = max(placed[k], low + k * step)
    return placed
