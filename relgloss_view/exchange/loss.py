"""Loss: how far a surface of another model is from the material that it stands for."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

from relgloss_view.base.arrays import Array

#: Programs that draw RGB have a lamp that is white in sRGB; colours and losses are under it.
LAMP = "D65"
MOST_DE2000 = 3.0  #: in the highlight; above it a file states its loss as a warning
#: Below it nobody tells two highlights apart: about one just noticeable difference.
UNSEEN_DE2000 = 1.0
MOST_GLOSS_UNITS = 2.0


class Surface(Protocol):
    """What reflects: a Material, or a model of another program with its parameters."""

    def evaluate(self, i: Array, o: Array) -> tuple[Array, Array]:
        """Diffuse and specular BRDF in 1/sr, each (..., B); i, o unit vectors, normal +z."""
        ...


@dataclass(frozen=True)
class Loss:
    """The differences of a pair of surfaces in pictures and under gloss meters.

    de2000_p95, de2000_max: CIEDE2000 (Sharma et al. 2005) over the pixels of the highlight
    (L_s* > 1), picture against picture in the paper's geometry, at the same c.
    gloss_units: by key of a reading, such as 'gloss-60': (of the material, of the other).
    """

    de2000_p95: float
    de2000_max: float
    gloss_units: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def largest_gloss_units(self) -> float:
        """The largest difference of a reading at 20, 60, 75 or 85 degrees."""
        return max((abs(a - b) for a, b in self.gloss_units.values()), default=0.0)

    @property
    def is_small(self) -> bool:
        """Whether nobody has to be warned of it."""
        return self.de2000_p95 <= MOST_DE2000 and self.largest_gloss_units <= MOST_GLOSS_UNITS

    @property
    def verdict(self) -> str:
        """What the loss means for an eye and for a gloss meter, in one sentence.

        >>> Loss(0.8, 0.9, {"gloss-60": (30.3, 31.1)}).verdict
        'the highlight looks the same, and the gloss is kept (60 degrees: 30.3 -> 31.1 units)'
        >>> Loss(4.4, 7.2, {"gloss-20": (3.0, 3.1), "gloss-60": (738.6, 693.6)}).verdict
        'the highlight looks different, and the gloss changes (60 degrees: 738.6 -> 693.6 units)'
        """
        if self.de2000_p95 <= UNSEEN_DE2000:
            eye = "the highlight looks the same"
        elif self.de2000_p95 <= MOST_DE2000:
            eye = "the highlight looks nearly the same"
        else:
            eye = "the highlight looks different"
        if not self.gloss_units:
            return eye
        is_kept = self.largest_gloss_units <= MOST_GLOSS_UNITS
        # The reading that everybody knows, or the one that changes most.
        key = "gloss-60" if is_kept and "gloss-60" in self.gloss_units else self._changed_most
        ours, theirs = self.gloss_units[key]
        return (
            f"{eye}, {'and' if is_kept == (self.de2000_p95 <= MOST_DE2000) else 'but'} the gloss "
            f"{'is kept' if is_kept else 'changes'} "
            f"({key.removeprefix('gloss-')} degrees: {ours:.1f} -> {theirs:.1f} units)"
        )

    def _change(self, key: str) -> float:
        ours, theirs = self.gloss_units[key]
        return abs(theirs - ours)

    @property
    def _changed_most(self) -> str:
        """The key of the reading with the largest difference."""
        return max(self.gloss_units, key=self._change)

    @property
    def words(self) -> str:
        """The loss in one line.

        >>> Loss(1.234, 3.5, {"gloss-60": (30.3, 31.1)}).words
        'highlight dE2000 p95 1.2, largest 3.5; gloss at 60 degrees 30.3 -> 31.1'
        """
        parts = [f"highlight dE2000 p95 {self.de2000_p95:.1f}, largest {self.de2000_max:.1f}"]
        parts += [
            f"gloss at {key.removeprefix('gloss-')} degrees {a:.1f} -> {b:.1f}"
            for key, (a, b) in self.gloss_units.items()
        ]
        return "; ".join(parts)

    @classmethod
    def of_json(cls, content: dict[str, Any]) -> Loss:
        """The loss that `as_json` has written."""
        units = {key: (pair[0], pair[1]) for key, pair in content["gloss_units"].items()}
        return cls(content["de2000_p95"], content["de2000_max"], units)

    def as_json(self) -> dict[str, Any]:
        """The loss as files of other programs and `--json` hold it."""
        return {
            "de2000_p95": self.de2000_p95,
            "de2000_max": self.de2000_max,
            "gloss_units": {key: list(pair) for key, pair in self.gloss_units.items()},
        }
