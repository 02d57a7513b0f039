"""What the window reports of a file that was opened, and the panel that comes to the front."""

from __future__ import annotations

from relgloss_view.viewer.files.display_files import display_note
from relgloss_view.viewer.files.open_job import Opened
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.packs import artwork_words, missing_plates
from relgloss_view.viewer.state.proofs import author_of, time_of


def report_opened(model: Model, opened: Opened, name: str, side: str, finish: str) -> None:
    """Report what was opened, which the model shows already.

    name: of the file. side, finish: what it was opened for.
    """
    if opened.proof is not None:
        newest = opened.proof.proof.messages[-1]
        sent = f"from {author_of(newest)}, {time_of(newest)}"
        model.report(f"opened the proof {name} {sent}; {opened.proof.signed[-1]}")
    elif opened.state is not None:
        model.report(f"opened the scene {name}")
    elif opened.display:
        model.report(display_note(opened.display, opened.path))
    elif opened.sample is None:
        _report_pack(model, opened, name, side)
    else:
        _report_sample(model, opened, name, side, finish)


def _report_sample(model: Model, opened: Opened, name: str, side: str, finish: str) -> None:
    assert opened.sample is not None
    if opened.measurement is not None and opened.sample.table is not None:
        model.measurements[opened.sample.table] = opened.measurement
    fit = opened.sample.material.fit
    text = f"fitted {name}" if opened.measurement is not None else f"opened {name}"
    if opened.measurement is not None and fit is not None:
        text += f": {fit.quality}"
    if finish and model.pack(side) is not None:
        model.report(f"{text}; it is the material of the finish {finish} now")
    else:
        model.report(f"{text}; it is the {side} sample now")
    if opened.warning:
        model.report(opened.warning, fault=True)


def _report_pack(model: Model, opened: Opened, name: str, side: str) -> None:
    """A line on a pack, an artwork or a mesh, and its panel in front."""
    pack = model.pack(side)
    model.active_side, model.wanted_panel = side, "Pack" if pack is not None else ""
    if opened.pack is not None:
        model.report(f"opened the pack {name}")
    elif opened.shape is not None:
        model.report(f"{name} is the form now; the panel {'Pack' if pack else 'Scene'} has it")
        return
    else:
        words = "" if opened.artwork is None else artwork_words(opened.artwork)
        model.report(f"{name} is the artwork of the {side} picture now{words}")
    missing = () if pack is None else missing_plates(pack)
    if missing:
        model.report(
            f"the artwork has no plate {', '.join(missing)}: choose another mask in the panel Pack",
            fault=True,
        )
