"""The look of a side: sigma_N, c, grain, quality; what people judge."""

from __future__ import annotations

from imgui_bundle import imgui

from relgloss_view.operators.registry import OPERATORS
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import SIDES

SIGMA_N_HAND_DEG = 3.0  #: the paper's range; typing reaches further


def show(model: Model) -> None:
    """Controls of the active side's look, and a choice of the side."""
    side_tabs(model)
    side = model.active_side
    look = model.state.side(side).look
    _sigma_n(model, side, look)
    _scaling(model, side, look)
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
        active = side == model.active_side
        style = imgui.get_style()
        colour = imgui.Col_.button_active if active else imgui.Col_.button
        imgui.push_style_color(imgui.Col_.button, style.color_(colour))
        if imgui.button(side.capitalize(), (width, 0.0)):
            model.active_side = side
        imgui.pop_style_color()
        widgets.tooltip(f"Tune the {side} picture.")
    imgui.spacing()


def _sigma_n(model: Model, side: str, look: Look) -> None:
    changed, value = widgets.slider(
        "σN", Look, "sigma_n_deg", look.sigma_n_deg, high=SIGMA_N_HAND_DEG, digits="%.2f"
    )
    if changed:
        model.set_look(side, gesture=f"{side} sigma_n", sigma_n_deg=value)


def _scaling(model: Model, side: str, look: Look) -> None:
    frame = model.frames.get(side)
    c_max = frame.c_max if frame else None
    c = frame.c if frame else None
    setting = look.setting
    fraction = setting.c_fraction
    if setting.c is not None:
        fraction = setting.c / c_max if c_max else 1.0
    changed, value = widgets.slider(
        "c / c_max", Look, "c_fraction", fraction, high=1.0, default=1.0, digits="%.3f"
    )
    if changed:
        model.set_setting(side, Setting(setting.sigma_n_deg, value), gesture=f"{side} c")
    absolute = c if c is not None else 1.0
    top = max(1.0, c_max or 1.0)
    changed, value = widgets.slider(
        "c", Look, "c", absolute, high=top, default=c_max or 1.0, digits="%.4g"
    )
    if changed:
        model.set_setting(side, Setting(setting.sigma_n_deg, c=value), gesture=f"{side} c")
    widgets.label("")
    locked = setting == Setting(setting.sigma_n_deg)
    if widgets.checkbox("lock c to c_max", locked, "as bright as the monitor can show"):
        model.set_setting(side, Setting(setting.sigma_n_deg, c=c if locked else None))
    widgets.label("c_max")
    imgui.align_text_to_frame_padding()
    imgui.text_unformatted("no highlight" if c_max is None else f"{c_max:.4g}")
    if c is not None and c > 1.0 + 1e-9:
        widgets.label("")
        widgets.flag("c > 1", "the picture exaggerates the contrast gloss")
    if c is not None and c_max is not None and c > c_max * (1.0 + 1e-9):
        widgets.label("")
        widgets.flag("clipped", "c is above c_max: highlights are cut at L* 100")


def _grain(model: Model, side: str, look: Look) -> None:
    changed, kind = widgets.choice("fixed to", Look, "grain", look.grain)
    if changed:
        model.set_look(side, grain=kind)
    if look.grain == "screen":
        changed, value = widgets.slider("cell", Look, "grain_px", look.grain_px, high=16)
        name = "grain_px"
    else:
        changed, value = widgets.slider(
            "cell", Look, "grain_mm", look.grain_mm, low=0.02, high=5.0, logarithmic=True
        )
        name = "grain_mm"
    if changed:
        model.set_look(side, gesture=f"{side} cell", **{name: value})
    changed, law = widgets.choice("tilt law", Look, "noise_law", look.noise_law)
    if changed:
        model.set_look(side, noise_law=law)
    changed, lobes = widgets.choice("tilts", Look, "noisy_lobes", look.noisy_lobes)
    if changed:
        model.set_look(side, noisy_lobes=lobes)
    changed, value = widgets.slider("seed", Look, "seed", look.seed, high=999)
    if changed:
        model.set_look(side, gesture=f"{side} seed", seed=int(value))


def _operator(model: Model, side: str) -> None:
    """The tone mapping of a side, and what there is to know where it is not the split."""
    present = model.state.presentation.operator(side)
    kind = OPERATORS[present]
    told = (
        f"How the light is brought to the display.\n{kind.title}: {kind.meaning} ({kind.source}). "
        "Other operators than the split are worked out when nothing moves, with their default "
        "parameters."
    )
    changed, name = widgets.combo("operator", tuple(OPERATORS), present, told)
    if changed:
        model.set_part("presentation", **{f"{side}_operator": name})
    operated = model.operated.get(side)
    if operated is not None and operated.displayed is None:
        widgets.label("")
        widgets.wrapped(f"{present} {operated.told}", dim=True)
    elif not kind.uses_c:
        widgets.label("")
        widgets.wrapped("c has no part in this picture", dim=True)


def _drawing(model: Model, side: str, look: Look) -> None:
    _operator(model, side)
    changed, name = widgets.choice("quality", Look, "quality", look.quality)
    if changed:
        model.set_look(side, quality=name)
    frame = model.frames.get(side)
    if look.quality == "auto" and frame is not None:
        widgets.wrapped(_simplified(frame.method.differences()), dim=True)
    changed, name = widgets.choice("diffuse", Look, "diffuse_model", look.diffuse_model)
    if changed:
        model.set_look(side, diffuse_model=name)
    options = ("auto", "1", "2", "3", "4", "8", "16")
    present = "auto" if look.samples is None else str(look.samples)
    changed, name = widgets.combo(
        "samples",
        options if present in options else (*options, present),
        present,
        "Samples along each side of a pixel; auto takes what the narrowest highlight needs.",
    )
    if changed:
        model.set_look(side, samples=None if name == "auto" else int(name))


def _simplified(stages: dict[str, str | int]) -> str:
    """What quality "auto" has chosen, in a line."""
    told = ", ".join(f"{stage} {name}" for stage, name in stages.items())
    return f"drawn simpler: {told}" if told else "nothing can be drawn simpler"
