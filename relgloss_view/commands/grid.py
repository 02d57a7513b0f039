"""`relgloss grid`: the stimuli of the subjective evaluation, 7 sigma_N x 6 c of one sample."""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.arrays import Bytes
from relgloss_view.base.decoration import decoration
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import whole_folder
from relgloss_view.commands.matched import add_reference_option, reference_look
from relgloss_view.commands.operator_options import (
    add_operator_options,
    displayed_by,
    operator_from,
    operator_words,
)
from relgloss_view.commands.output_folder import own_folder, stimuli_files
from relgloss_view.commands.scene_options import (
    add_scene_options,
    printable_command,
    scene_from,
    scene_words_of,
)
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.picture.scene.setting import Setting

if TYPE_CHECKING:
    from relgloss_view.gloss.match import Reference
    from relgloss_view.operators.operator import Operator
    from relgloss_view.picture.output.writers import Writers
    from relgloss_view.picture.scene.look import Look
    from relgloss_view.quality.backends import FrameRenderer

THUMBNAIL_PX = 200
NEAR_MATCH = 2.0  #: a stimulus within this factor of the matched c may be marked
CAPTION_PX = 150  #: width of a picture that has room for c in its caption
FORMAT, VERSION = "relgloss-grid", 1
MANIFEST, SHEET = "manifest.json", "contact-sheet.png"


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "grid",
        description="Draw the 42 stimuli of a sample that the paper's observers judged: sigma_N "
        "from 0 to 3 degrees in steps of 0.5, c from c_max/6 to c_max. An operator that takes no "
        "account of c has 7 stimuli.",
        epilog="example: relgloss grid --sample uncoated --size 512x512 -o stimuli",
    )
    parser.add_argument(
        "-o",
        "--output",
        metavar="FOLDER",
        required=True,
        help="Folder for the pictures, the contact sheet and the manifest",
    )
    add_scene_options(parser, tuned=False, for_the_eye=False)
    add_reference_option(parser)
    add_operator_options(parser)
    parser.add_argument("--json", action="store_true", help="Print the manifest as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Draw all stimuli beside the folder, and move them in when the last is done."""
    from relgloss_view.gloss.match import Reference
    from relgloss_view.picture.model.pixel_sampling import sample_count
    from relgloss_view.picture.output.parameters import SPLIT
    from relgloss_view.picture.output.writers import Writers
    from relgloss_view.picture.peak import check_picture
    from relgloss_view.quality.backends import open_renderer

    folder = own_folder(args.output, {MANIFEST: FORMAT}, "grid")
    operator = operator_from(args)
    scene, look, size = scene_from(args)
    reference = Reference.of(reference_look(args, look)) if operator.uses_c else None
    uses = [use for use in ("grid", operator.name) if use != SPLIT]
    samples = sample_count(scene, look, size)
    check_picture(size, samples, backend=args.backend, uses=uses, scene=scene)
    with (
        open_renderer(args.backend) as renderer,
        Progress("grid") as progress,
        whole_folder(folder, MANIFEST, lambda old: stimuli_files(old, MANIFEST)) as temporary,
        Writers() as writers,
    ):
        by = renderer, writers, operator
        manifest, sheet = _draw(args, temporary, by, scene, look, size, reference, progress)
    count = len(manifest["stimuli"])
    summary = f"{printable(folder)}: {count} stimuli{f', {SHEET}' * sheet} and {MANIFEST}"
    print(json.dumps(manifest) if args.json else summary)
    return 0


def _draw(
    args: argparse.Namespace,
    folder: Path,
    by: tuple[FrameRenderer, Writers, Operator],
    scene: Scene,
    look: Look,
    size: tuple[int, int],
    reference: Reference | None,
    progress: Progress,
) -> tuple[dict[str, Any], bool]:
    """Draw pictures, contact sheet and manifest into a folder.

    Returns the manifest, and whether there is a contact sheet.
    """
    from relgloss_view.experiment.design.grid import C_SIXTHS, SIGMA_N_DEG
    from relgloss_view.gloss.match import Reference, matched_point
    from relgloss_view.gloss.pack_match import match_pack
    from relgloss_view.picture.output.contact_sheet import contact_sheet, thumbnail
    from relgloss_view.picture.output.parameters import parameters
    from relgloss_view.picture.output.png import save_rgb

    renderer, writers, operator = by
    drawn = scene
    scales: tuple[int | None, ...] = C_SIXTHS if operator.uses_c else (None,)
    total = len(SIGMA_N_DEG) * len(scales)
    stimuli: list[dict[str, Any]] = []
    rows: list[list[Bytes]] = []
    captions: list[list[str]] = []
    for sigma_n_deg in SIGMA_N_DEG:
        matched_c = None
        if scene.pack is not None:  # finishes without a sigma_N of their own have the row's
            beside = reference or Reference.default()
            found = match_pack(beside, scene.pack, sigma_n_deg, scene.setup)
            matched_c = found.c if reference is not None else None
            drawn = Scene(scene.material, scene.setup, pack=found.pack)
        elif reference is not None:
            matched_c = matched_point(reference, scene.material, sigma_n_deg).c
        rows.append([])
        captions.append([])
        for sixths in scales:
            name = f"sigma_{sigma_n_deg:.1f}" + (f"_c_{sixths}of6.png" if sixths else ".png")
            progress(len(stimuli) / total, name)
            variant = look.at(Setting(sigma_n_deg, (sixths or 6) / 6))
            variant = variant if sixths else variant.without_c()
            frame = renderer.render(drawn, variant, size)
            displayed = displayed_by(operator, frame)
            command = _command(args, sigma_n_deg, sixths, name)
            writers.save(frame, folder / name, command, displayed)
            numbers = parameters(frame, displayed)
            of_match = frame.c / matched_c if matched_c else None
            stimuli.append(
                {"file": name, "c_sixths": sixths, **_varying(numbers), "of_match": of_match}
            )
            rows[-1].append(thumbnail(frame, THUMBNAIL_PX, displayed))
            # A narrow picture has no room for more.
            room = rows[0][0].shape[1] >= CAPTION_PX
            absolute = f", c {frame.c:.3g}" if room else ""
            scale = f", {sixths}/6{absolute}" if sixths else ""
            captions[-1].append(f"{sigma_n_deg:.1f} deg{scale}")
        _mark_matched(captions[-1], stimuli[-len(scales) :])
    kept = f"all pictures and {MANIFEST} are written"
    with decoration(SHEET, kept, files=[folder / SHEET]) as sheet:
        title, note = _sheet_words(scene, operator, stimuli, reference)
        if not operator.uses_c:  # one row
            rows, captions = [[row[0] for row in rows]], [[texts[0] for texts in captions]]
        save_rgb(
            contact_sheet(rows, captions, title, note, display=scene.display),
            folder / SHEET,
            {"Software": f"relgloss {__version__}", "Title": title},
            display=scene.display,
        )
    same = {k: v for k, v in numbers.items() if k not in (*stimuli[0], "warnings", "version")}
    manifest = {
        "format": FORMAT,
        "version": VERSION,
        "relgloss_version": __version__,
        **same,
        "reference": None if reference is None else reference.sample.label,
        "stimuli": stimuli,
    }
    text = json.dumps(manifest, indent=1) + "\n"
    (folder / MANIFEST).write_text(text, encoding="utf-8")
    return manifest, sheet.done


def _sheet_words(
    scene: Scene, operator: Operator, stimuli: list[dict[str, Any]], reference: Reference | None
) -> tuple[str, str]:
    """The title and the note of a contact sheet."""
    title = printable(scene.name, 60)
    if operator.uses_c:
        title += f": sigma_N down, c / c_max across{_c_max(stimuli)}"
    else:
        title += f", {operator.name}: sigma_N across"
    marks = scene.marks
    note = f"{marks} sample" if marks else ""
    if reference is not None and any(s["of_match"] for s in stimuli):
        note += ". " if note else ""
        note += f"> <: nearest to the gloss that is matched to {reference.sample.label}"
    return title, note


def _mark_matched(captions: list[str], stimuli: list[dict[str, Any]]) -> None:
    """Mark the caption of the stimulus nearest to the matched gloss, in ratio."""
    distances = [abs(math.log(s["of_match"])) if s["of_match"] else math.inf for s in stimuli]
    nearest = min(range(len(stimuli)), key=distances.__getitem__)
    if distances[nearest] < math.log(NEAR_MATCH):
        captions[nearest] = f"> {captions[nearest]} <"


def _c_max(stimuli: list[dict[str, Any]]) -> str:
    """The range of c_max on the sheet, in words; it changes from row to row with the grain."""
    values = [s["c_max"] for s in stimuli if s["c_max"] is not None]
    if not values:
        return ""
    low, high = f"{min(values):.3g}", f"{max(values):.3g}"
    return f", c_max {low}" + ("" if low == high else f" to {high}")


def _varying(numbers: dict[str, Any]) -> dict[str, Any]:
    keys = (
        "sigma_n_deg",
        "c",
        "c_max",
        "c_max_eq4",
        "clip_count",
        "out_of_gamut_count",
        "warnings",
    )
    return {key: numbers[key] for key in keys}


def _command(args: argparse.Namespace, sigma_n_deg: float, sixths: int | None, name: str) -> str:
    """The snapshot that draws the same stimulus."""
    words = ["snapshot", *scene_words_of(args), *operator_words(args)]
    words += ["--sigma-n", f"{sigma_n_deg:g}"]
    words += ["--c-fraction", repr(sixths / 6)] if sixths else []
    return printable_command([*words, "-o", name])
