"""The evidence behind a fitted material: candidates, the chosen one and why, and what to doubt."""

from __future__ import annotations

from typing import Any

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.material.material import FitRecord, Material, Quality
from relgloss_view.viewer.panels import plots
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model

NARROW_EM = 52.0  #: below this width the facts lie under the table
WHOLE_TABLE_EM = 28.0  #: a narrower table tells the verdicts in tooltips
QUALITY = {
    Quality.GOOD: "the model describes this sample",
    Quality.POOR: "the model does not describe this sample well",
    Quality.UNIDENTIFIABLE: "the measurement leaves the lobe's width open",
}
COLUMNS = (
    ("model", "A rung of the ladder of models that were tried."),
    (
        "held-out error",
        "Logarithmic error on groups of samples that were left out of the fit, about a relative "
        "error, with one standard error.",
    ),
    ("unknowns", "Numbers that were fitted."),
    ("verdict", "Why it was chosen or not: the smallest that is as good held out."),
)
LONGEST = 200  #: characters of a text from a file


def show(model: Model) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("fit")
    try:
        side = plots.side_switch(model)
        material = model.state.side(side).sample.material
        plots.beside(em(9))
        imgui.align_text_to_frame_padding()
        if material.fit is None:
            text = f"{printable(material.name, 60)}: not fitted, its parameters were given."
            widgets.wrapped(text, dim=True)
        else:
            _heading(material, material.fit)
            _body(material, material.fit)
    finally:
        imgui.pop_id()


def _heading(material: Material, fit: FitRecord) -> None:
    imgui.text_unformatted(printable(material.name, 60))
    told = f"quality {fit.quality}"
    plots.beside(imgui.calc_text_size(f"! {told}").x)
    if fit.quality == Quality.GOOD:
        imgui.text_unformatted(told)
        widgets.tooltip(widgets.sentence(QUALITY[fit.quality]))
    else:
        widgets.flag(told, QUALITY[fit.quality])


def _body(material: Material, fit: FitRecord) -> None:
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):  # one below the other, and the panel scrolls
        _candidates(fit)
        _facts(material, fit)
        return
    if imgui.begin_child("candidates", ImVec2(0.58 * room.x, room.y)):
        _candidates(fit)
    imgui.end_child()
    imgui.same_line(0.0, em(1.1))
    if imgui.begin_child("facts", ImVec2(0.0, room.y)):
        _facts(material, fit)
    imgui.end_child()


def _facts(material: Material, fit: FitRecord) -> None:
    for text in material.warnings:
        widgets.wrapped(f"! {printable(text, 2 * LONGEST)}")
    for title, text in facts(material, fit):
        widgets.quiet(title)
        imgui.same_line(em(6.5))
        widgets.wrapped(text)


def _candidates(fit: FitRecord) -> None:
    if not fit.candidates:
        widgets.wrapped(f"chosen: {printable(fit.chosen, LONGEST) or 'no candidates are kept'}")
        return
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_fixed_fit
    whole = imgui.get_content_region_avail().x >= em(WHOLE_TABLE_EM)
    columns = COLUMNS if whole else COLUMNS[:-1]
    if not imgui.begin_table("candidates", len(columns), flags):
        return
    for name, _ in columns:
        last = whole and name == COLUMNS[-1][0]
        stretch = imgui.TableColumnFlags_.width_stretch
        imgui.table_setup_column(name, stretch if last else imgui.TableColumnFlags_.none)
    imgui.table_next_row(imgui.TableRowFlags_.headers)
    for k, (name, meaning) in enumerate(columns):
        imgui.table_set_column_index(k)
        imgui.table_header(name)
        widgets.tooltip(meaning)
    for candidate in fit.candidates:
        name = str(candidate.get("name", ""))
        chosen = name == fit.chosen
        imgui.table_next_row()
        say = imgui.text_unformatted if chosen else widgets.quiet
        cells = (
            ("> " if chosen else "  ") + printable(name, 40),
            f"{_share(candidate.get('cv_mean'))} ± {_share(candidate.get('cv_se'))}",
            _plain(candidate.get("parameters")),
            printable(str(candidate.get("verdict", "")), LONGEST),
        )
        for text in cells[:-1]:
            imgui.table_next_column()
            say(text)
            if not whole:
                widgets.tooltip(widgets.sentence(cells[-1]))
        if whole:
            imgui.table_next_column()
            widgets.wrapped(cells[-1], dim=not chosen)
    imgui.end_table()


def facts(material: Material, fit: FitRecord) -> list[tuple[str, str]]:
    """What was found, in words: a title and a text each."""
    errors, residuals = fit.standard_errors, fit.residuals
    found = [
        ("quality", f"{fit.quality}: {QUALITY[fit.quality]}"),
        ("source", printable(material.source, LONGEST)),
        ("chosen", printable(fit.chosen, 60) or "-"),
        ("diffuse", _diffuse(material, errors)),
    ]
    for k, lobe in enumerate(material.specular):
        width = "at the limit" if lobe.at_the_limit else _error(errors, "s_deg", k)
        strength = sum(lobe.strength) / len(lobe.strength)
        found.append(
            (
                f"lobe {k + 1}",
                f"s {lobe.s_deg:.3g} deg {width}, strength {strength:.3g} "
                f"{_error(errors, 'strength', k)}, n {lobe.refractive_index:.3g}",
            )
        )
    near, far = (
        _inner(residuals, name).get("median_relative_error") for name in ("near_mirror", "far")
    )
    found.append(
        (
            "residuals",
            f"median {_share(residuals.get('median_relative_error'))}, 90th percentile "
            f"{_share(residuals.get('p90_relative_error'))}; near the mirror {_share(near)}, "
            f"elsewhere {_share(far)}",
        )
    )
    left_out = _inner(residuals, "left_out")
    text = f"{_plain(residuals.get('samples'))} used"
    text += "".join(f", {_plain(n)} left out: {printable(str(w), 60)}" for w, n in left_out.items())
    found.append(("samples", text))
    found += [("bounds", text) for text in _bounds(fit)]
    method = errors.get("method")
    if method:
        found.append(("errors", f"± one standard error, {printable(str(method), 80)}"))
    return found


def _diffuse(material: Material, errors: dict[str, Any]) -> str:
    albedo = material.diffuse.albedo
    text = f"{material.diffuse.model}, albedo {min(albedo):.3f} to {max(albedo):.3f}"
    relative = errors.get("albedo_relative")
    if _is_number(relative):
        text += f" ± {_share(relative)}"
    if material.diffuse.sigma_deg > 0.0:
        text += f", sigma {material.diffuse.sigma_deg:.3g} deg"
        if _is_number(errors.get("sigma_deg")):
            text += f" ± {errors['sigma_deg']:.2g}"
    return text


def _bounds(fit: FitRecord) -> list[str]:
    main = _inner(fit.bounds, "main_lobe")
    told = []
    low, high = main.get("s_deg_lower"), main.get("s_deg_upper")
    if _is_number(low) or _is_number(high):
        ends = [f"{v:.4g}" if _is_number(v) else "open" for v in (low, high)]
        told.append(f"s of the main lobe {ends[0]} to {ends[1]} deg")
    upper = _inner(fit.bounds, "no_lobe").get("largest_strength_upper")
    if _is_number(upper):
        told.append(f"no lobe; a strength of at most {upper:.2g}")
    index = _inner(fit.bounds, "refractive_index")
    if index.get("held"):
        correlation = index.get("correlation_with_strength")
        text = "n is held"
        if _is_number(correlation):
            text += f"; its correlation with the strength is {correlation:.2g}"
        told.append(text)
    return told


def _inner(table: dict[str, Any], name: str) -> dict[str, Any]:
    """A table inside one; a file may hold anything in its place."""
    value = table.get(name)
    return value if isinstance(value, dict) else {}


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _share(value: Any) -> str:
    return f"{100.0 * value:.3g} %" if _is_number(value) else "-"


def _plain(value: Any) -> str:
    return f"{value:g}" if _is_number(value) else "-"


def _error(errors: dict[str, Any], name: str, lobe: int) -> str:
    values = errors.get(name)
    if isinstance(values, list | tuple) and lobe < len(values) and _is_number(values[lobe]):
        return f"± {values[lobe]:.2g}"
    return ""
