"""`relgloss proof show`: what was sent and answered, as text or JSON, and the files inside."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

from relgloss_view.base.reading import named, printable
from relgloss_view.base.visible import visible

if TYPE_CHECKING:
    from relgloss_view.proof.keys import Signed
    from relgloss_view.proof.proof import Message, Proof
    from relgloss_view.proof.settings import Settings

SHORT = 12  #: digits of a digest that a line shows


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "show",
        help="print a proof's messages, settings and signatures, and unpack its files",
        description="Print a proof's title, its messages with their settings, and who signed them. "
        "--files writes what is inside into a folder: the scene, materials and artwork, and a "
        "scene with the settings of each answer.",
        epilog="example: relgloss proof show carton.html --files carton",
    )
    parser.add_argument("file", metavar="FILE.html", help="Proof to show")
    parser.add_argument(
        "--files", metavar="FOLDER", help="Folder to write the files to that are inside"
    )
    parser.add_argument("--json", action="store_true", help="Print the proof as JSON")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print the thread; write the files where they are asked for."""
    from relgloss_view.proof.keys import checked, known_keys
    from relgloss_view.proof.read import read_proof
    from relgloss_view.viewer.state.places import config_folder

    proof = read_proof(args.file)
    signatures = checked(proof, known_keys(config_folder()))
    if args.files is not None:
        from relgloss_view.proof.unpack import unpacked

        unpacked(proof, args.files, answers=True)
    if args.json:
        print(json.dumps(_numbers(args, proof, signatures)))
        return 0
    print(f"{printable(args.file)}: {printable(proof.title, 200)}")
    before = None
    for k, message in enumerate(proof.messages):
        lines = message_lines(message, before)
        print(f"\nmessage {k + 1}, {proof.digests[k]}")
        signed = [s.words for s in signatures if s.message == k]
        if signatures and not signed and k >= len(proof.messages) - proof.unsigned:
            signed = ["not signed; anyone could have added it"]
        for line in lines + signed:
            print(f"  {line}")
        before = message
    print(f"\nfiles: {', '.join(printable(name, 80) for name in proof.content['files'])}")
    if args.files is not None:
        print(f"written to {named(args.files)}; scene.toml has the settings of message 1")
        if before is not proof.messages[0]:
            from relgloss_view.proof.unpack import answer_scene

            print(f"{answer_scene(len(proof.messages))} has those of the newest message")
    else:
        print("--files FOLDER writes them.")
    return 0


def message_lines(message: Message, before: Message | None) -> list[str]:
    """A message as lines: who and when, the note, the settings or what of them has changed."""
    from relgloss_view.proof.screen_words import screen_line

    # "from" before a name that anyone has written, which may read "signed by ...".
    author = printable(message.author, 200)
    who = [f"from {author}" if author else "no name", message.made, message.program]
    lines = [", ".join(printable(part, 220) for part in who if part)]
    if message.parent:
        lines.append(f"answers {message.parent[:SHORT]}")
    lines += [f"| {visible(line)}" for line in message.note.splitlines()]
    if screen := screen_line(message.screen):
        lines.append(f"screen: {screen}")
    words = setting_words(message.settings)
    if before is None:
        return [*lines, *words.values()]
    old = setting_words(before.settings)
    changed = [text for name, text in words.items() if text != old[name]]
    return [*lines, *(changed or ["the settings as before"])]


def setting_words(settings: Settings) -> dict[str, str]:
    """Settings in words, by their part."""
    from relgloss_view.proof.settings import SIDES

    words = {}
    for side in SIDES:
        one = settings.side(side)
        words[side] = (
            f"{side}: graininess (sigma_N) {one.sigma_n_deg:.4g} deg, "
            f"contrast gloss (c) {one.c:.4g}"
        )
    eye, lamp = settings.eye, settings.lamp
    words["eye"] = (
        f"eye: azimuth {eye.azimuth_deg:.4g}, elevation {eye.elevation_deg:.4g} deg, "
        f"distance {eye.distance_m:.4g} m"
    )
    words["lamp"] = (
        f"lamp: {printable(lamp.illuminant, 60)}, azimuth {lamp.azimuth_deg:.4g}, elevation "
        f"{lamp.elevation_deg:.4g} deg, distance {lamp.distance_m:.4g} m"
    )
    return words


def _numbers(
    args: argparse.Namespace, proof: Proof, signatures: tuple[Signed, ...]
) -> dict[str, Any]:
    messages = []
    for k, (message, digest) in enumerate(zip(proof.messages, proof.digests, strict=True)):
        own = [
            {"key": s.key, "name": s.name, "right": s.is_right, "words": s.words}
            for s in signatures
            if s.message == k
        ]
        messages.append({**message.as_json(), "digest": digest, "signatures": own})
    return {
        "file": args.file,
        "title": proof.title,
        "digest": proof.digest,
        "size_px": proof.content["size_px"],
        "messages": messages,
        "files": list(proof.content["files"]),
        "written_to": args.files,
    }
