"""`relgloss view`: the window."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError, RelglossError
from relgloss_view.base.interruptions import checkpoint, pause
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.base.writing import check_writable
from relgloss_view.commands.outputs import refuse_read
from relgloss_view.commands.scene_options import add_colour_options, colour_from, size_of_text
from relgloss_view.picture.scene.options import OPTIONS

if TYPE_CHECKING:
    from relgloss_view.material.recolour import Colour
    from relgloss_view.viewer.files.open_job import Opened
    from relgloss_view.viewer.shell.app import App

#: Options that name displays, and the entry of the window's state that each sets.
DISPLAYS = {"--display": "profile", "--seen-on": "test_seen_on"}
DEFAULT_FRAMES = 3  #: the first settles the layout
MOST_FRAMES = 100_000
STEP_S = 0.05


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "view",
        description="Open the window on the built-in papers, or on a proof, scenes, materials and "
        "measured tables, which are fitted first, or on a pack: a pack file, an artwork (PDF or "
        "picture), a mesh. One sample becomes the test picture's; of two samples, the first "
        "becomes the reference's, as does one beside a pack. The last session is restored.",
        epilog="example: relgloss view paper.csv",
    )
    parser.add_argument(
        "files",
        metavar="FILE",
        nargs="*",
        help="Proof (.html), scene, material, measured table, pack file, artwork, mesh, display "
        "(ICC profile or display file), the folder of a catalogue, or the name of a built-in paper",
    )
    add_colour_options(parser)
    for flag, entry in DISPLAYS.items():
        option = next(option for option in OPTIONS if option.flag == flag)
        more = "; only the test picture" if entry != "profile" else ""
        parser.add_argument(flag, metavar="FILE", help=f"{option.help}{more}")
    parser.add_argument("--fresh", action="store_true", help="Start without the last session")
    parser.add_argument(
        "--screenshot",
        metavar="OUT.png",
        help="Draw the window without a display, save it as a picture and leave",
    )
    parser.add_argument(
        "--frames",
        metavar="N",
        type=int,
        default=DEFAULT_FRAMES,
        help=f"Number of frames to draw before the screenshot (default {DEFAULT_FRAMES})",
    )
    parser.add_argument(
        "--window",
        metavar="WxH",
        type=size_of_text,
        help="Size of the window in pixels (default 1280x800)",
    )
    parser.add_argument(
        "--font-scale",
        metavar="F",
        type=float,
        help="Size of the text, 0.5 to 4 times the normal (default 1)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Open the window, or draw it without a display for a screenshot."""
    if args.font_scale is not None and not 0.5 <= args.font_scale <= 4.0:
        raise InputError(f"--font-scale {args.font_scale:g}: expected 0.5 to 4")
    from relgloss_view.picture.peak import check_window

    check_window()
    if args.screenshot is not None:
        return _screenshot(args)
    return _interactive(args)


def _screenshot(args: argparse.Namespace) -> int:
    if not 1 <= args.frames <= MOST_FRAMES:
        raise InputError(f"--frames {args.frames}: expected 1 to {MOST_FRAMES}")
    if not args.screenshot.lower().endswith(".png"):
        named = args.screenshot or "''"
        raise InputError(f"--screenshot {named}: expected a name that ends in .png")
    check_writable(args.screenshot)
    refuse_read(args.screenshot, args.files)
    displays = _displays(args)
    opened = _opened(args.files)
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.layout_file import DEFAULT_SIZE
    from relgloss_view.viewer.state.state import State

    app = App(State.initial())
    _show(app, opened, colour_from(args), displays)
    window = Window(
        app, args.window or DEFAULT_SIZE, headless=True, font_scale=args.font_scale or 1.0
    )
    warn_if_clamped(args, window.size)
    pixels = window.run(args.frames)
    checkpoint()
    from relgloss_view.picture.output.png import save_rgb

    save_rgb(pixels, args.screenshot, {}, display=app.model.on_screen.setup.display)
    frames = "1 frame" if args.frames == 1 else f"{args.frames} frames"
    print(f"{printable(args.screenshot)}: the window after {frames}")
    return 0


def _interactive(args: argparse.Namespace) -> int:
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.shell.platform import check_display
    from relgloss_view.viewer.shell.window import Window
    from relgloss_view.viewer.state.layout_file import load_layout
    from relgloss_view.viewer.state.places import config_folder
    from relgloss_view.viewer.state.session import (
        Autosave,
        Restored,
        read_whole,
        restore,
        session_file,
    )
    from relgloss_view.viewer.state.state import State

    checkpoint()  # the imports have taken a while
    check_display()
    displays = _displays(args)
    opened = _opened(args.files)
    layout_path, session_path, faults = None, None, []
    try:
        layout_path, session_path = config_folder() / "window.toml", session_file()
    except RelglossError as error:
        faults.append(str(error))
    restored = Restored() if args.fresh or session_path is None else restore(session_path)
    if restored.coming and opened and session_path is not None:  # they may belong on its pack
        with Progress("read the last session") as progress:
            state, messages = read_whole(session_path, progress)
        restored = Restored(state, messages)
    app = App(restored.state or State.initial())
    for text in (*faults, *restored.messages):
        app.model.report(text, fault=True)
    if session_path is not None:
        app.files.session = Autosave(session_path, app.model.state)
        if restored.coming:
            app.files.read_session(session_path, restored.coming)
    _show(app, opened, colour_from(args), displays)
    if layout_path is not None:
        app.keep_layout(layout_path, load_layout(layout_path))
    size = args.window or app.kept_layout.size
    scale = args.font_scale or app.kept_layout.font_scale
    window = Window(app, size, font_scale=scale)
    warn_if_clamped(args, window.size)
    window.run()
    checkpoint()
    return 0


def warn_if_clamped(args: argparse.Namespace, size: tuple[int, int]) -> None:
    """Warn where the window could not have the size of --window."""
    if args.window is not None and args.window != size:
        asked = f"{args.window[0]}x{args.window[1]}"
        warn(f"--window {asked}: clamped to {size[0]}x{size[1]}")


def _opened(files: list[str]) -> list[Opened]:
    """The content of the files, read before there is a window, so that a fault ends the command."""
    from relgloss_view.pack.kinds import pack_path
    from relgloss_view.picture.scene.sample import Sample
    from relgloss_view.viewer.files.open_job import Opened, OpenJob

    _check_files(files)
    opened = []
    for file in files:
        if _is_built_in(file):
            opened.append(Opened(file, sample=Sample.built_in(file)))
            continue
        job = OpenJob(str(pack_path(file)), lambda: None)
        try:
            with Progress(f"open {Path(file).name}") as progress:
                while not job.done:
                    progress(*job.progress)
                    pause(STEP_S)
        finally:
            job.close()
        if job.fault is not None:
            raise InputError(job.fault)
        assert job.result is not None
        opened.append(job.result)
    return opened


def _displays(args: argparse.Namespace) -> dict[str, str]:
    """The files of the displays that were named, by entry; InputError where one is of none."""
    from relgloss_view.viewer.files.display_files import check_display

    named = {}
    for flag, entry in DISPLAYS.items():
        file = getattr(args, flag.removeprefix("--").replace("-", "_"))
        if file is not None:
            check_display(file)
            named[entry] = str(Path(file).absolute())
    return named


def _show(app: App, opened: list[Opened], colour: Colour | None, displays: dict[str, str]) -> None:
    """Show the opened files in the window: a scene first, then the samples on its sides.

    The test picture's sample gets the colour. Beside a pack, which is the test, one sample is the
    reference. A form comes before the artwork that lies on it.
    """
    from relgloss_view.viewer.files.display_files import with_display
    from relgloss_view.viewer.state.matching import with_colour

    state = app.model.state
    for one in opened:
        if one.state is not None:
            state = one.applied(state, "test")
            app.files.scene_path = None if one.proof is not None else one.path
        if one.proof is not None:
            app.files.proofs.opened(one.proof)
        if one.catalogue is not None:
            app.files.catalogue.take(one.catalogue)
        if one.warning:
            app.model.report(one.warning, fault=True)
    for one in opened:
        state = one.applied(state, "test") if one.display else state
    samples = [one for one in opened if one.sample is not None]
    of_pack = [one for one in opened if one.is_of_a_pack]
    sides = ("reference", "test") if len(samples) == 2 or of_pack else ("test",)
    for side, one in zip(sides, samples, strict=False):
        state = one.applied(state, side)
        table = one.sample.table if one.sample else None
        if one.measurement is not None and table is not None:
            app.model.measurements[table] = one.measurement
    for one in sorted(of_pack, key=lambda one: (one.pack is None, one.shape is None)):
        state = one.applied(state, "test")
        app.model.wanted_panel = "Pack" if state.test.sample.pack is not None else ""
        if one.pack is not None:
            app.files.note_pack(one.pack)
    if colour is not None:
        state = with_colour(state, "test", colour)
    for entry, file in displays.items():
        state = with_display(state, entry, file)
    app.model.change(state)


def _is_built_in(file: str) -> bool:
    """Whether a word names a built-in paper, and no file of that name is there."""
    from relgloss_view.picture.scene.sample import SAMPLES

    return file in SAMPLES and not Path(file).exists()


def _check_files(files: list[str]) -> None:
    """Raise InputError for too many files before the first is fitted, which takes a while."""
    from relgloss_view.pack.kinds import ARTWORK, PACK
    from relgloss_view.picture.scene.file_kinds import SCENE
    from relgloss_view.viewer.files.catalogue_files import catalogue_folder
    from relgloss_view.viewer.files.display_files import is_display_file
    from relgloss_view.viewer.files.pack_files import MESH, file_kind
    from relgloss_view.viewer.files.proof_files import PROOF, is_proof_file

    catalogues = sum(catalogue_folder(file) is not None for file in files)
    if catalogues > 1:
        raise InputError(f"{catalogues} catalogues given: expected at most 1")
    files = [file for file in files if catalogue_folder(file) is None]
    displays = sum(is_display_file(file) for file in files)
    if displays > 1:
        raise InputError(f"{displays} displays given: expected at most 1")
    files = [file for file in files if not is_display_file(file)]
    named = [file for file in files if not _is_built_in(file)]
    kinds = [PROOF if is_proof_file(file) else file_kind(file) for file in named]
    for kind, words in (
        (SCENE, "scenes"),
        (PROOF, "proofs"),
        (PACK, "packs"),
        (ARTWORK, "artworks"),
        (MESH, "forms"),
    ):
        count = kinds.count(kind)
        if count > 1:
            raise InputError(f"{count} {words} given: expected at most 1")
    if SCENE in kinds and PROOF in kinds:
        raise InputError("a proof and a scene given: expected one of them, both hold a pair")
    packs = any(kind in (PACK, ARTWORK, MESH) for kind in kinds)
    samples = len(files) - sum(kind in (SCENE, PROOF, PACK, ARTWORK, MESH) for kind in kinds)
    if samples > 2:
        raise InputError(f"{samples} samples given: expected at most 2, reference and test")
    if samples > 1 and packs:
        raise InputError(f"{samples} samples given beside a pack: expected 1, the reference")
