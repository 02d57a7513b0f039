"""How much of the model a picture is drawn with, in plain words."""

from __future__ import annotations

from relgloss_view.picture.frame import Frame
from relgloss_view.picture.method import Method

WHOLE = "Drawn with the whole model"
_WORDS: dict[tuple[str, str | int], str] = {
    ("noise", "none"): "no grain",
    ("noise", "mean"): "the mean of the grain",
    ("noise", "specular"): "grain in the highlight only",
    ("lobes", 0): "no specular lobe",
    ("lobes", 1): "one specular lobe",
    ("c_max", "sparse"): "c_max from a quarter of the pixels",
    ("c_max", "eq4"): "c_max by eq. 4",
    ("c_max", "once"): "c_max without the grain",
    ("gamut", "clip"): "no gamut mapping (no colour needs it)",
    ("diffuse", "lambert"): "Lambert's diffuse model",
    ("diffuse", "oren-nayar"): "Oren and Nayar's diffuse model",
    ("diffuse", "qualitative"): "Oren and Nayar's qualitative diffuse model",
    ("diffuse", "eon"): "the EON diffuse model",
    ("fresnel", "constant"): "a constant reflectance of the facets",
    ("fresnel", "schlick"): "Schlick's reflectance of the facets",
    ("shadowing", "none"): "no shadowing by facets",
    ("lamp", "distant"): "a lamp far away",
    ("targets", "float16"): "numbers of half precision",
}


def drawing_words(method: Method) -> str:
    """A sentence about a method, without its full stop."""
    simpler = [
        _WORDS.get((stage, name), f"{stage} {name}") for stage, name in method.differences().items()
    ]
    return f"Drawn simpler: {', '.join(simpler)}" if simpler else WHOLE


def quality_words(frame: Frame) -> str:
    """The quality in use, in two or three words."""
    if frame.look.quality == "exact":
        return "exact"
    return "auto: drawn simpler" if frame.method.differences() else "auto: whole model"
