"""The look of a side: graininess, contrast gloss, grain and drawing; what people judge."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import imgui

from relgloss_view.base.parameters import Checked, parameter
from relgloss_view.base.reading import printable
from relgloss_view.operators.registry import OPERATORS
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.pack import Pack
from relgloss_view.picture.pair import ratio_words
from relgloss_view.picture.scene.look import Look
from relgloss_view.quality.planner import DEFAULT_TOLERANCE
from relgloss_view.viewer.panels import finishes
from relgloss_view.viewer.panels.drawing_words import drawing_words
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.widgets import Reach
from relgloss_view.viewer.state.matching import rematched, share_of_match, taken_as_match
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES, Presentation

SIGMA_N_REACH = Reach(high=3.0, digits="%.2f")  #: the paper's range
QUALITY_MEANINGS = {
    "auto": "draws only as much of the model as this scene needs: the colour difference to the "
    f"exact picture (CIEDE2000) is at most {DEFAULT_TOLERANCE.p95:g} for 95 % of the pixels, "
    f"and {DEFAULT_TOLERANCE.largest:g} for any",
    "exact": "draws the whole model, whatever the time",
}


@dataclass(frozen=True)
class Shares(Checked):
    """Contrast gloss of the two pictures in units of the match."""

    reference: float = parameter(
        1.0,
        0.0,
        1e4,
        "",
        "scales both pictures, so that their ratio of gloss stays",
        label="Contrast gloss",
    )
    test: float = parameter(
        1.0,
        0.0,
        1e4,
        "",
        "1 keeps the ratio of gloss to the reference; 0.5 shows half as much gloss",
        label="Contrast gloss",
    )


LONGEST_NAME = 60  #: characters
SHARE_REACH = Reach(high=2.0, digits="%.2f")
_MADE_BY = {
    "match": "1 is the setting that relgloss match proposes.",
    "experiment": "1 is the setting that observers found.",
    "paper": "1 is the setting that the paper's observers chose.",
    "hand": "1 is the setting that was taken by hand.",
}
#: The entry that holds the size of each kind of grain, and the reach of its slider.
GRAIN_SIZES = {
    "screen": ("grain_px", Reach(high=16)),
    "surface": ("grain_mm", Reach(0.02, 5.0, logarithmic=True)),
    "eye": ("grain_arcmin", Reach(0.5, 15.0, logarithmic=True)),
}
SAMPLE_COUNTS = ("auto", "1", "2", "3", "4", "8", "16")


def show(model: Model) -> None:
    """Controls of the active side's look, and a choice of the side."""
    side_tabs(model)
    side = model.active_side
    look = model.state.side(side).look
    pack, finish = model.pack(side), model.active_finish(side)
    if pack is None or finish is None:
        _sigma_n(model, side, look)
    else:
        _finish(model, side, pack, finish)
    _contrast(model, side, look)
    imgui.separator_text("Grain")
    _grain(model, side, look)
    imgui.separator_text("Drawing")
    _drawing(model, side, look)


def side_tabs(model: Model) -> None:
    """Two buttons that choose the side that is being tuned."""
    width = 0.5 * (imgui.get_content_region_avail().x - imgui.get_style().item_spacing.x)
    for k, side in enumerate(SIDES):
        if k:
            imgui.same_line()
        if widgets.toggle(side.capitalize(), on=side == model.active_side, width=width):
            model.active_side = side
        widgets.tooltip(f"Tune the {side} picture.")
    imgui.spacing()


def _sigma_n(model: Model, side: str, look: Look) -> None:
    changed, value = widgets.slider(Look, "sigma_n_deg", look.sigma_n_deg, SIGMA_N_REACH)
    if changed:
        model.set_sigma_n(side, value, gesture=f"{side} sigma_n")


def _finish(model: Model, side: str, pack: Pack, finish: Finish) -> None:
    """The active finish of a pack, its graininess and its gloss; c below is the picture's."""
    names = tuple(one.name for one in reversed(pack.finishes))
    words = {name: printable(name, LONGEST_NAME) for name in names}
    changed, name = widgets.combo(
        "Finish", names, finish.name,
        "The finish that the next two sliders change. A click on the picture chooses it too.",
        words=words,
    )  # fmt: skip
    if changed:
        model.choose_finish(side, name)
        return
    imgui.push_id("of the finish")
    finishes.sigma_n_slider(model, side, finish)
    finishes.k_slider(model, side, finish)
    imgui.pop_id()
    imgui.separator_text("Whole picture")


def _contrast(model: Model, side: str, look: Look) -> None:
    """Contrast gloss in units of the match; c itself behind a fold."""
    share = share_of_match(model.state, side)
    if share is None and model.state.match is not None:
        widgets.wrapped("The reference picture has no contrast gloss (c = 0): see In numbers.")
    if share is not None:
        changed, value = widgets.slider(Shares, side, share, SHARE_REACH, default=1.0)
        if changed:
            model.set_share(side, value, gesture=f"{side} share")
    _match(model)
    if imgui.tree_node_ex("In numbers (c, c_max)", imgui.TreeNodeFlags_.framed):
        _numbers(model, side, look)
        imgui.tree_pop()


def _match(model: Model) -> None:
    """Where the match comes from, what the view does to it, and how to change it."""
    state = model.state
    match = state.match
    if match is None:
        widgets.wrapped("No match: the reference shows no gloss.", dim=True)
        return
    widgets.wrapped(_MADE_BY[match.made_by], dim=True)
    words = ratio_words(model.factor)
    if words:
        widgets.wrapped(f"{words}.", dim=True)
    on = state.presentation.clip_highlights
    text = widgets.label_of(Presentation, "clip_highlights")
    if widgets.checkbox(text, on, "keeps each c as it is, and marks what clips"):
        model.set_part("presentation", clip_highlights=not on)
    if widgets.button("Match again", "sets both pictures to what relgloss match proposes"):
        model.change(rematched(state))
    imgui.same_line()
    if widgets.button("Take as match", "makes the present settings the match, as your eye found"):
        model.change(taken_as_match(state))


def _numbers(model: Model, side: str, look: Look) -> None:
    frame = model.frames.get(side)
    c_max = frame.c_max if frame else None
    c = look.c if look.c is not None else frame.c if frame else 1.0
    reach = Reach(high=max(1.0, c_max or 1.0), digits="%.4g")
    changed, value = widgets.slider(Look, "c", c, reach, default=c_max or 1.0)
    if changed:
        model.set_c(side, value, gesture=f"{side} c")
    if c_max:
        reach = Reach(high=1.0, digits="%.3f")
        changed, value = widgets.slider(Look, "c_fraction", c / c_max, reach, default=1.0)
        if changed:
            model.set_c(side, value * c_max, gesture=f"{side} c")
    widgets.label("Highest (c_max)")
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted("no highlight" if c_max is None else f"{c_max:.4g}")
    widgets.tooltip("The highest contrast gloss that this view shows without clipping.")
    if frame is not None and c_max is not None and frame.c > c_max * (1.0 + 1e-9):
        widgets.label("")
        widgets.flag("clipped", "c is above c_max: highlights are cut at L* 100")


def _grain(model: Model, side: str, look: Look) -> None:
    changed, kind = widgets.choice(Look, "grain", look.grain)
    if changed:
        model.set_look(side, grain=kind)
    name, reach = GRAIN_SIZES[look.grain]
    changed, value = widgets.slider(Look, name, getattr(look, name), reach)
    if changed:
        model.set_look(side, gesture=f"{side} cell", **{name: value})
    changed, law = widgets.choice(Look, "noise_law", look.noise_law)
    if changed:
        model.set_look(side, noise_law=law)
    changed, lobes = widgets.choice(Look, "noisy_lobes", look.noisy_lobes)
    if changed:
        model.set_look(side, noisy_lobes=lobes)
    changed, value = widgets.slider(Look, "seed", look.seed, Reach(high=999))
    if changed:
        model.set_look(side, gesture=f"{side} seed", seed=int(value))


def _operator(model: Model, side: str) -> None:
    """The tone mapping of a side, and a remark where it is not the split."""
    present = model.state.presentation.operator(side)
    kind = OPERATORS[present]
    meaning = (
        f"How the light is brought to the display.\n{kind.title}: {kind.meaning} ({kind.source}). "
        "Operators other than the split have their default parameters, and are computed when "
        "nothing moves."
    )
    entry = f"{side}_operator"
    text = widgets.label_of(Presentation, entry)
    changed, name = widgets.combo(text, tuple(OPERATORS), present, meaning)
    if changed:
        model.set_part("presentation", **{entry: name})
    picture = model.operator_pictures.get(side)
    if picture is not None and picture.displayed is None:
        widgets.wrapped(f"{present} {picture.reason}", dim=True)
    elif not kind.uses_c:
        widgets.wrapped(f"{present} does not use the contrast gloss (c).", dim=True)


def _drawing(model: Model, side: str, look: Look) -> None:
    text = widgets.label_of(Look, "quality")
    changed, name = widgets.buttons(text, QUALITY_MEANINGS, look.quality)
    if changed:
        model.set_look(side, quality=name)
    frame = model.frames.get(side)
    if frame is not None:
        widgets.wrapped(f"{drawing_words(frame.method)}.", dim=True)
    _operator(model, side)
    changed, name = widgets.choice(Look, "diffuse_model", look.diffuse_model)
    if changed:
        model.set_look(side, diffuse_model=name)
    present = "auto" if look.samples is None else str(look.samples)
    changed, name = widgets.combo(
        widgets.label_of(Look, "samples"),
        SAMPLE_COUNTS if present in SAMPLE_COUNTS else (*SAMPLE_COUNTS, present),
        present,
        "Samples along each side of a pixel; auto takes as many as the narrowest highlight needs.",
    )
    if changed:
        model.set_look(side, samples=None if name == "auto" else int(name))
