"""The evidence behind a fitted material: candidates, the chosen one and why, and warnings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.base.words import sentence_case
from relgloss_view.material.material import FitRecord, Material, Quality
from relgloss_view.viewer.panels import estimate_table, plot_widgets
from relgloss_view.viewer.panels.list_rows import fitting
from relgloss_view.viewer.shell import widgets
from relgloss_view.viewer.shell.theme import em
from relgloss_view.viewer.state.model import Model

NARROW_EM = 52.0  #: below this width the facts lie under the table
WHOLE_TABLE_EM = 28.0  #: a narrower table has the verdicts in tooltips
COUNTS_EM = 26.0  #: a still narrower one the numbers of parameters, too
QUALITY = {
    Quality.GOOD: "the model describes this sample",
    Quality.POOR: "the model does not describe this sample well",
    Quality.UNIDENTIFIABLE: "the measurement leaves open what its gloss depends on",
}
COLUMNS = (
    ("Model", "One of the models that were fitted, the simplest first."),
    (
        "Held-out error",
        "Error on samples that were left out of the fit, about a relative error, with one standard "
        "error.",
    ),
    ("Parameters", "How many numbers were fitted."),
    ("Verdict", "The simplest model is chosen that predicts the left-out samples as well as any."),
)
FACT_EM = 7.5  #: width of the column of titles
LONGEST = 200  #: characters of a text from a file


def show(model: Model) -> None:
    """Draw the panel into the present window."""
    imgui.push_id("fit")
    try:
        side = plot_widgets.side_switch(model)
        material = model.sample(side).material
        plot_widgets.beside(em(9))
        imgui.align_text_to_frame_padding()
        if material.fit is None:
            text = f"{printable(material.name, 60)}: not fitted; the file gives its parameters."
            if material.estimate is not None:
                text = f"{printable(material.name, 60)}: {material.estimate.range_words}."
            widgets.wrapped(text, dim=True)
            if material.estimate is not None:
                for warning in material.warnings:
                    widgets.wrapped(f"! {printable(warning, 2 * LONGEST)}")
                estimate_table.show(material.estimate, whole=True)
        else:
            _heading(material, material.fit)
            _body(material, material.fit)
    finally:
        imgui.pop_id()


def _heading(material: Material, fit: FitRecord) -> None:
    name = printable(material.name, 60)
    room = imgui.get_content_region_avail().x - em(1.2)  # the gap to what comes beside it
    imgui.text_unformatted(fitting(name, room))
    text = f"Fit quality: {fit.quality}"
    plot_widgets.beside(imgui.calc_text_size(f"! {text}").x)
    if fit.quality == Quality.GOOD:
        imgui.text_unformatted(text)
        widgets.tooltip(widgets.sentence(QUALITY[fit.quality]))
    else:
        widgets.flag(text, QUALITY[fit.quality])


def _body(material: Material, fit: FitRecord) -> None:
    room = imgui.get_content_region_avail()
    if room.x < em(NARROW_EM):  # one below the other, and the panel scrolls
        _candidates(fit)
        _facts(material, fit)
        return
    if imgui.begin_child(
        "candidates", ImVec2(0.58 * room.x, room.y), imgui.ChildFlags_.nav_flattened
    ):
        _candidates(fit)
    imgui.end_child()
    imgui.same_line(0.0, em(1.1))
    if imgui.begin_child("facts", ImVec2(0.0, room.y), imgui.ChildFlags_.nav_flattened):
        _facts(material, fit)
    imgui.end_child()


def _facts(material: Material, fit: FitRecord) -> None:
    for text in material.warnings:
        widgets.wrapped(f"! {printable(text, 2 * LONGEST)}")
    for fact in facts(material, fit):
        widgets.quiet(fact.title)
        imgui.same_line(em(FACT_EM))
        widgets.wrapped(fact.text)


def _candidates(fit: FitRecord) -> None:
    if not fit.candidates:
        widgets.wrapped(
            f"Chosen: {printable(fit.chosen, LONGEST) or 'the file lists no candidates'}"
        )
        return
    flags = imgui.TableFlags_.row_bg | imgui.TableFlags_.sizing_fixed_fit
    room = imgui.get_content_region_avail().x
    whole = room >= em(WHOLE_TABLE_EM)
    columns = COLUMNS if whole else COLUMNS[: 3 if room >= em(COUNTS_EM) else 2]
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
        write = imgui.text_unformatted if chosen else widgets.quiet
        cells = (
            ("> " if chosen else "  ") + printable(name, 40),
            f"{_share(candidate.get('cv_mean'))} ± {_share(candidate.get('cv_se'))}",
            _plain(candidate.get("parameters")),
            printable(str(candidate.get("verdict", "")), LONGEST),
        )
        for text in cells[: min(len(columns), 3)]:
            imgui.table_next_column()
            write(text)
            if not whole:
                widgets.tooltip(f"{cells[2]} parameters. {widgets.sentence(cells[3])}")
        if whole:
            imgui.table_next_column()
            widgets.wrapped(cells[-1], dim=not chosen)
    imgui.end_table()


@dataclass(frozen=True)
class Fact:
    """One line about a fit."""

    title: str
    text: str


def facts(material: Material, fit: FitRecord) -> list[Fact]:
    """A fit in words."""
    errors, residuals = fit.standard_errors, fit.residuals
    near, far = (
        _inner(residuals, name).get("median_relative_error") for name in ("near_mirror", "far")
    )
    left_out = _inner(residuals, "left_out")
    samples = f"{_plain(residuals.get('samples'))} used"
    samples += "".join(
        f", {_plain(count)} left out: {printable(str(reason), 60)}"
        for reason, count in left_out.items()
    )
    listed = [
        Fact("Quality", f"{fit.quality}: {QUALITY[fit.quality]}"),
        Fact("Source", printable(material.source, LONGEST)),
        Fact("Chosen model", printable(fit.chosen, 60) or "-"),
        Fact("Diffuse", _diffuse(material, errors)),
        *(Fact(f"Lobe {k + 1}", _lobe(material, errors, k)) for k in range(len(material.specular))),
        Fact(
            "Residuals",
            f"median {_share(residuals.get('median_relative_error'))}, 90th percentile "
            f"{_share(residuals.get('p90_relative_error'))}; near the mirror {_share(near)}, "
            f"elsewhere {_share(far)}",
        ),
        Fact("Samples", samples),
        *_use(fit),
        *(Fact("Bounds", text) for text in _bounds(fit)),
    ]
    method = errors.get("method")
    if method:
        listed.append(Fact("Errors", f"± one standard error, {printable(str(method), 80)}"))
    return listed


def _use(fit: FitRecord) -> list[Fact]:
    """What the fit gives for use, and its table beside it; nothing where a file has neither."""
    if not fit.judgement and not fit.derived:
        return []
    from relgloss_view.fitting.describe import derived_lines, use_lines

    lines = [*derived_lines(fit), *use_lines(fit.judgement)]
    return [Fact(sentence_case(label), words) for label, words in lines]


def _lobe(material: Material, errors: dict[str, Any], k: int) -> str:
    lobe = material.specular[k]
    error = "at the limit" if lobe.at_the_limit else _error(errors, "s_deg", k)
    strength = sum(lobe.strength) / len(lobe.strength)
    words = (
        f"width (s) {lobe.s_deg:.3g} deg {error}, strength {strength:.3g} "
        f"{_error(errors, 'strength', k)}, "
    )
    if lobe.f0 is not None:
        return f"metal, {words}reflectance head on (F0) {min(lobe.f0):.3g} to {max(lobe.f0):.3g}"
    return f"{words}refractive index (n) {lobe.refractive_index:.3g}"


def _diffuse(material: Material, errors: dict[str, Any]) -> str:
    albedo = material.diffuse.albedo
    text = f"{material.diffuse.model}, albedo {min(albedo):.3f} to {max(albedo):.3f}"
    relative = errors.get("albedo_relative")
    if _is_number(relative):
        text += f" ± {_share(relative)}"
    if material.diffuse.sigma_deg > 0.0:
        text += f", roughness (sigma) {material.diffuse.sigma_deg:.3g} deg"
        if _is_number(errors.get("sigma_deg")):
            text += f" ± {errors['sigma_deg']:.2g}"
    return text


def _bounds(fit: FitRecord) -> list[str]:
    main = _inner(fit.bounds, "main_lobe")
    bounds = []
    low, high = main.get("s_deg_lower"), main.get("s_deg_upper")
    if _is_number(low) or _is_number(high):
        ends = [f"{v:.4g}" if _is_number(v) else "open" for v in (low, high)]
        bounds.append(f"width (s) of the main lobe {ends[0]} to {ends[1]} deg")
    upper = _inner(fit.bounds, "no_lobe").get("largest_strength_upper")
    if _is_number(upper):
        bounds.append(f"no specular lobe; its strength is at most {upper:.2g}")
    index = _inner(fit.bounds, "refractive_index")
    if index.get("held"):
        correlation = index.get("correlation_with_strength")
        text = "the refractive index (n) is fixed"
        if _is_number(correlation):
            text += f"; its correlation with the strength is {correlation:.2g}"
        bounds.append(text)
    return bounds


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
