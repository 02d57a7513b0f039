"""`relgloss proof make`: a scene as one HTML file that others open in a browser."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable, read_text
from relgloss_view.base.terminal import Progress, warn
from relgloss_view.base.writing import check_writable, whole_file
from relgloss_view.commands.matched import add_reference_option
from relgloss_view.commands.outputs import refuse_read
from relgloss_view.commands.scene_options import DEFAULT_SIZE, SOURCES, add_scene_options
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.proof.proof import ARTWORK_PX, MOST_AUTHOR, MOST_NOTE, MOST_TITLE

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PrivateKey

    from relgloss_view.proof.proof import Message, Proof

SUFFIXES = (".html", ".htm")
#: Options that a reply can change of the settings that it answers.
OF_REPLIES = ("sigma_n", "c")


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "make",
        help="make a proof of a scene, a pack, an artwork or a material, or answer a proof",
        description="Make one HTML file of a design and its reference: whoever opens it in a "
        "browser sees both pictures and can change them, without installing anything. SCENE may "
        "also be a proof that you answer.",
        epilog="example: relgloss proof make carton.toml -o carton.html --note 'Is the foil too "
        "strong?'; relgloss proof make carton.html -o answer.html --note 'Yes' --c 0.2",
    )
    parser.add_argument(
        "design",
        metavar="SCENE",
        nargs="?",
        help="Scene file, pack file, artwork, material file, built-in name (matte-coated, carton), "
        "or a proof that you answer",
    )
    parser.add_argument(
        "-o", "--output", metavar="FILE.html", required=True, help="File of the proof"
    )
    add_scene_options(parser, look=viewed_look())
    add_reference_option(parser)
    words = parser.add_argument_group("what you write")
    note = words.add_mutually_exclusive_group()
    note.add_argument("--note", metavar="TEXT", help="Note to whoever opens the proof")
    note.add_argument("--note-file", metavar="FILE", help="Text file (UTF-8) of a longer note")
    words.add_argument("--author", metavar="NAME", default="", help="Your name")
    words.add_argument(
        "--title", metavar="TEXT", default="", help="Title of the page (default the sample's name)"
    )
    words.add_argument(
        "--sign", metavar="KEY", help="Key file that `relgloss proof key` made, to sign the proof"
    )
    parser.add_argument(
        "--artwork-px",
        metavar="N",
        type=int,
        default=ARTWORK_PX,
        help="Pixels of the longer side of an artwork in the proof; a larger one is scaled down "
        f"(default {ARTWORK_PX})",
    )
    parser.add_argument("--json", action="store_true", help="Print the result as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Make the proof, write it, and print its name and the receiver's next step."""
    output = Path(args.output)
    if output.suffix.lower() not in SUFFIXES:
        raise InputError(f"{output}: expected a name that ends in .html, which browsers open")
    if not 16 <= args.artwork_px <= 8192:
        args.wrong_usage(f"argument --artwork-px: expected 16 to 8192, found {args.artwork_px}")
    note = _note(args)
    _check_length(args.author, "--author", MOST_AUTHOR)
    _check_length(args.title, "--title", MOST_TITLE)
    check_writable(output)
    # An answer may take the place of the proof that it answers: it holds all of the thread.
    sample = None if _is_proof(args.design) else args.design
    refuse_read(output, (sample, args.reference, args.note_file, args.sign))
    key = None if args.sign is None else _key(args.sign)
    sizes: dict[str, int] = {}
    notes: tuple[str, ...] = ()
    with Progress("proof") as progress:
        if _is_proof(args.design):
            proof = _reply(args, note)
        else:
            proof, sizes, notes, warnings = _new(args, note, progress)
            for text in warnings:
                warn(text)
        progress(0.95, "writing")
        if key is not None:
            proof = _signed(proof, key)
        html = _page(proof)
        with whole_file(output) as temporary:
            temporary.write_text(html, encoding="utf-8", newline="\n")
    total = len(html.encode("utf-8"))
    if args.json:
        print(json.dumps(_numbers(proof, output, total, sizes, notes)))
        return 0
    print(f"{printable(output)}: {printable(proof.title, 80)}, {_size_words(total)}")
    print(f"  digest {proof.digest}")
    for text in notes:
        print(f"  {printable(text)}")
    if len(proof.messages) > 1:
        print(f"  answers {proof.messages[-1].parent}, message {len(proof.messages)} of the thread")
    print("  Send the file; whoever receives it opens it in a browser, and needs nothing else.")
    return 0


def _new(
    args: argparse.Namespace, note: str, progress: Progress
) -> tuple[Proof, dict[str, int], tuple[str, ...], tuple[str, ...]]:
    """A new proof, bytes of its parts, its notes, and warnings."""
    from relgloss_view.commands.proof_scene import scene_of_options
    from relgloss_view.proof.content import content_of
    from relgloss_view.proof.proof import Proof
    from relgloss_view.quality.backends import open_renderer

    _place_design(args)
    with open_renderer(args.backend) as renderer:
        progress(0.0, "reading")
        scene, size, warnings = scene_of_options(args, renderer)
        made = content_of(
            scene,
            renderer,
            size=size,
            title=args.title,
            artwork_px=args.artwork_px,
            progress=lambda share, text: progress(0.2 + 0.7 * share, text),
        )
    message = _message(args, note, made.settings)
    proof = Proof(made.content, (message,))
    return proof, made.sizes, made.notes, (*warnings, *made.warnings)


def _place_design(args: argparse.Namespace) -> None:
    """Put SCENE in the place of the option that it stands for, by its content."""
    if args.design is None:
        return
    given = [name for name in (*SOURCES, "scene") if getattr(args, name) is not None]
    if given:
        args.wrong_usage(f"argument SCENE: not allowed with argument --{given[0]}")
    from relgloss_view.pack.kinds import ARTWORK, PACK, SHIPPED
    from relgloss_view.picture.scene.file_kinds import MATERIAL, SCENE, likely_kind
    from relgloss_view.picture.scene.sample import SAMPLES

    if not Path(args.design).exists():
        if args.design in SAMPLES:
            args.sample = args.design
            return
        if args.design not in SHIPPED:
            raise InputError(
                f"{args.design}: there is no such file; give a scene or a pack (.toml), a material "
                "(.json), an artwork (PDF, PNG, JPEG, TIFF, PSD), a proof (.html), or a name of "
                f"{', '.join((*SAMPLES, *SHIPPED))}"
            )
    places = {SCENE: "scene", MATERIAL: "material", PACK: "pack", ARTWORK: "artwork"}
    kind = likely_kind(args.design)
    if kind not in places:
        raise InputError(
            f"{args.design}: a measured table shows nothing by itself; fit a material to it with "
            "`relgloss fit`, and give that"
        )
    setattr(args, places[kind], args.design)


def _is_proof(design: str | None) -> bool:
    """Whether SCENE is an HTML file, which can only be a proof."""
    return design is not None and Path(design).suffix.lower() in SUFFIXES


def _reply(args: argparse.Namespace, note: str) -> Proof:
    """The answer to a proof: its settings, or those of options, and a note."""
    import dataclasses

    from relgloss_view.proof.read import read_proof
    from relgloss_view.proof.settings import PictureSetting

    if not note.strip():
        raise InputError(f"{args.design}: is a proof, so this answers it; give --note TEXT")
    proof = read_proof(args.design)
    _refuse_options(args)
    settings = proof.sent
    test = settings.test
    c = getattr(args, "c", None)
    if isinstance(c, str):
        raise InputError(f"--c {c}: an answer has a number of its own; give --c VALUE")
    changed = PictureSetting(
        getattr(args, "sigma_n", test.sigma_n_deg), test.c if c is None else float(c)
    )
    settings = dataclasses.replace(settings, test=changed)
    return proof.answered(_message(args, note, settings))


def _refuse_options(args: argparse.Namespace) -> None:
    """InputError where an option asks for another scene than the proof has."""
    from relgloss_view.picture.scene.options import OPTIONS

    given = [name for name in (*SOURCES, "scene", "reference", "lab") if getattr(args, name)]
    given += [o.name for o in OPTIONS if hasattr(args, o.name) and o.name not in OF_REPLIES]
    given += [name for name in ("set", "further_lamp", "title", "lamp") if getattr(args, name)]
    defaults = {"size": DEFAULT_SIZE, "backend": "auto", "artwork_px": ARTWORK_PX}
    given += [name for name, default in defaults.items() if getattr(args, name) != default]
    if given:
        flag = given[0].replace("_", "-")
        raise InputError(
            f"--{flag}: an answer keeps the scene of the proof; change --sigma-n and --c, or make "
            "a new proof of a scene"
        )


def _message(args: argparse.Namespace, note: str, settings: Any) -> Message:
    from relgloss_view.base.version import PROGRAM
    from relgloss_view.proof.proof import Message, present_time

    return Message(settings, note, args.author, present_time(), PROGRAM)


def _note(args: argparse.Namespace) -> str:
    if args.note_file is None:
        note = args.note or ""
        where = "--note"
    else:
        note = read_text(args.note_file, 4 * MOST_NOTE, "a text file of the note")
        where = args.note_file
    _check_length(note, where, MOST_NOTE)
    return note.replace("\r\n", "\n").rstrip("\n")


def _check_length(text: str, where: str, most: int) -> None:
    from relgloss_view.base.reading import text as checked

    checked(text, where)
    if len(text) > most:
        raise InputError(f"{where}: expected at most {most} characters, found {len(text)}")


def _key(file: str) -> Ed25519PrivateKey:
    from relgloss_view.proof.keys import read_private

    return read_private(file)


def _signed(proof: Proof, key: Ed25519PrivateKey) -> Proof:
    from relgloss_view.proof.keys import signed

    return signed(proof, key)


def _page(proof: Proof) -> str:
    from relgloss_view.proof.page.whole import page_of

    return page_of(proof)


def _numbers(
    proof: Proof, output: Path, total: int, sizes: dict[str, int], notes: tuple[str, ...]
) -> dict[str, Any]:
    return {
        "output": str(output),
        "digest": proof.digest,
        "title": proof.title,
        "bytes": total,
        "sizes": sizes,
        "picture_quality": proof.content.get("picture_quality"),
        "messages": len(proof.messages),
        "parent": proof.messages[-1].parent,
        "signed": len(proof.signatures),
        "settings": proof.sent.as_json(),
        "notes": list(notes),
    }


def _size_words(total: int) -> str:
    return f"{total / 1e3:.0f} kB" if total < 1e6 else f"{total / 1e6:.1f} MB"
