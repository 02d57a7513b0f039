"""`relgloss proof key`: make a key to sign with, and list the keys of those one knows."""

from __future__ import annotations

import argparse
import json
from typing import Any

from relgloss_view.base.reading import named, printable


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "key",
        help="make a key to sign proofs with, and name the keys of those you know",
        description="Make a key to sign proofs with, or name the public key of somebody you know. "
        "Compare its fingerprint by telephone before you name it. Without an option, list the keys "
        "that have names.",
        epilog="example: relgloss proof key -o me.key; relgloss proof key --trust aya.key.pub "
        "--name Aya",
    )
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "-o", "--output", metavar="FILE", help="Make a private key, and FILE.pub to give away"
    )
    what.add_argument("--trust", metavar="FILE.pub", help="Public key of somebody you know")
    what.add_argument("--forget", metavar="NAME", help="Remove the key of this name")
    what.add_argument("--show", metavar="FILE", help="Print the fingerprint of a public key")
    parser.add_argument("--name", metavar="NAME", help="With --trust: the key's owner")
    parser.add_argument("--json", action="store_true", help="Print the result as JSON")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Do the one thing that was asked for."""
    from relgloss_view.proof import keys
    from relgloss_view.viewer.state.places import config_folder

    if (args.trust is None) != (args.name is None):
        args.wrong_usage("name a key and its owner together: --trust FILE.pub --name NAME")
    if args.output is not None:
        key = keys.make_key(args.output)
        public = f"{args.output}{keys.SUFFIX}"
        lines = [
            f"{named(args.output)}: your private key; keep it, and give it to nobody",
            f"{named(public)}: your public key; give it to whoever checks your signatures",
        ]
        return _print(args, key, "", lines, private=args.output, public=public)
    if args.show is not None:
        return _print(args, keys.read_public(args.show), "", [])
    folder = config_folder()
    if args.trust is not None:
        key = keys.read_public(args.trust)
        keys.trust(folder, key, args.name)
        lines = [f"known as {printable(args.name, keys.MOST_NAME)} from now on"]
        return _print(args, key, args.name, lines)
    if args.forget is not None:
        key = keys.forget(folder, args.forget)
        return _print(args, key, args.forget, ["forgotten"])
    known = keys.known_keys(folder)
    if args.json:
        rows = [{"key": k, "fingerprint": keys.fingerprint(k), "name": n} for k, n in known.items()]
        print(json.dumps({"keys": rows}))
        return 0
    for key, name in known.items():
        print(f"{keys.fingerprint(key)}  {printable(name, keys.MOST_NAME)}")
    if not known:
        print("no known keys; `relgloss proof key --trust FILE.pub --name NAME` adds one")
    return 0


def _print(args: argparse.Namespace, key: str, name: str, lines: list[str], **more: Any) -> int:
    from relgloss_view.proof.keys import fingerprint

    if args.json:
        print(json.dumps({"key": key, "fingerprint": fingerprint(key), "name": name, **more}))
        return 0
    for line in lines:
        print(line)
    print(f"fingerprint {fingerprint(key)}")
    return 0
