"""What `relgloss match` prints of the display that its pictures are seen on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from relgloss_view.base.reading import printable

if TYPE_CHECKING:
    from relgloss_view.display.display import Display
    from relgloss_view.gloss.match import MatchCurve, Reference
    from relgloss_view.gloss.match_display import OnScreen, Screen

NO_BLACK = "its black is not known, so relgloss can't compute what the black changes"


def display_lines(
    display: Display, reference: Reference, curves: Sequence[MatchCurve]
) -> list[str]:
    """For each screen whose black counts: the c that keeps the ratio there, or why none changes."""
    from relgloss_view.display.model import DisplayModel
    from relgloss_view.gloss.match_display import on_screen, screens_of

    lines: list[str] = []
    for screen in screens_of(display):
        lines += [_heading(screen)]
        if screen.black_known:
            present = [on_screen(screen, reference, m) for m in curves]
            samples = [sample for sample in present if sample is not None]
            lines += _drawn_lines(screen, samples)
            lines += _opened_lines(samples) if screen.black > 0.0 else []
        seen = DisplayModel.of(display).seen
        lines += _brightness_lines(screen, None if seen is None else seen.screen_cd_m2)
    return lines


def _heading(screen: Screen) -> str:
    white = "white of unknown luminance"
    if screen.cd_m2 is not None:
        white = f"white {screen.cd_m2:.4g} cd/m2"
    black = NO_BLACK
    if screen.black_known:
        black = f"black {screen.black:.2%} of it, L* {screen.black_lstar:.1f}"
    return f"on {printable(screen.name, 60)}: {white}; {black}"


def _drawn_lines(screen: Screen, samples: Sequence[OnScreen]) -> list[str]:
    """Pictures that are drawn for the screen."""
    changes = [(s.label, s.drawn_share, s.drawn_c) for s in samples]
    reason = "the black hides as much of the reference's highlight, within 2 %"
    if all(s.body_lstar >= screen.black_lstar for s in samples):
        reason = "the bodies at the highlights are brighter than it, so L* is shown as wanted"
    return _way_lines("drawn for this black", changes, reason)


def _opened_lines(samples: Sequence[OnScreen]) -> list[str]:
    """Pictures that were drawn without the screen's black."""
    changes = [(s.label, s.opened_share, s.opened_c) for s in samples]
    reason = "the black weakens the reference's highlight as much, within 2 %"
    return _way_lines("drawn without this black, and opened there", changes, reason)


def _way_lines(
    way: str, changes: Sequence[tuple[str, float | None, float | None]], reason: str
) -> list[str]:
    from relgloss_view.gloss.match_display import KEPT

    same = [label for label, share, _ in changes if share and abs(share - 1.0) < KEPT]
    lines = [f"  {way}: nothing has to change for {', '.join(same)}: {reason}"] if same else []
    lines += [
        f"  {way}: {_changed(label, share, c)}" for label, share, c in changes if label not in same
    ]
    return lines


def _changed(label: str, share: float | None, c: float | None) -> str:
    if share is None:
        return (
            f"{label}: the black hides a highlight of the pair in one of the poses, so no ratio "
            "can be kept; make the room darker, or take a brighter sample as the reference"
        )
    words = f"{label} would show {share:.2f} of its ratio to the reference"
    if c is None:
        return f"{words}, and no c keeps it, because white is not bright enough"
    return f"{words}; c {c:.4g} keeps it"


def _brightness_lines(screen: Screen, own_cd_m2: float | None) -> list[str]:
    """What the luminance of white changes, where both are known."""
    if screen.cd_m2 is None or own_cd_m2 is None or abs(screen.cd_m2 / own_cd_m2 - 1.0) < 0.02:
        return []
    weaker = (screen.cd_m2 / own_cd_m2) ** (1.0 / 3.0)
    kind = "dimmer" if weaker < 1.0 else "brighter"
    return [
        f"  its white is {kind} than this display's ({own_cd_m2:.4g} cd/m2): in cube roots of "
        f"cd/m2 every highlight is {weaker:.2f} times as strong, the reference's too, so the ratio "
        "stays and no c changes",
        "  how glossy all of them look there, this model can't decide: look at the reference "
        "picture on that display",
    ]
