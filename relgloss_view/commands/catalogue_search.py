"""`relgloss catalogue search`: samples of a catalogue by their gloss, colour and pictures."""

from __future__ import annotations

import argparse
import json
import shutil
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import printable
from relgloss_view.base.terminal import Progress
from relgloss_view.base.version import __version__
from relgloss_view.base.writing import check_writable, together, whole_folder

if TYPE_CHECKING:
    from relgloss_view.catalogue.catalogue import Catalogue
    from relgloss_view.catalogue.proofs import MadeProof
    from relgloss_view.catalogue.query.found import Found
    from relgloss_view.quality.backends import FrameRenderer

LIMIT = 20
PICTURES, PAGES = (".png",), (".html", ".htm")


def add(commands: Any) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "search",
        help="find samples by gloss, colour, pictures, names",
        description="Find samples in a catalogue. QUERY may ask for gloss, haze, colour, the ratio "
        "of gloss to another sample, the nearest pictures, names, quality and every column of the "
        "table, joined with and, or, not and parentheses; it may end with 'sort by COLUMN' and "
        "'first N'. Without QUERY every sample is a hit. docs/catalogue.md has all phrases.",
        epilog="examples: relgloss catalogue search stock 'gloss 60 between 40 and 50 and colour "
        "within dE 3 of 50 20 10'; relgloss catalogue search stock 'looks 0.7 x as glossy as "
        "cast-coated within 5 %' -o hits.png --page hits.html",
    )
    parser.add_argument("catalogue", metavar="CATALOGUE", help="Folder of the catalogue")
    parser.add_argument(
        "query", metavar="QUERY", nargs="*", help="What to find; quote it for the shell"
    )
    parser.add_argument(
        "--limit",
        metavar="N",
        type=int,
        default=LIMIT,
        help=f"Largest number of hits; 0 gives all of them (default {LIMIT})",
    )
    parser.add_argument("-o", "--output", metavar="OUT.png", help="Contact sheet of the hits")
    parser.add_argument("--page", metavar="OUT.html", help="Page of the hits for any browser")
    parser.add_argument(
        "--proofs",
        metavar="FOLDER",
        help="Folder for a proof of each hit: the reference and the sample side by side in any "
        "browser, about a second each",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="Compare thumbnails alone where the query asks for the nearest pictures",
    )
    parser.add_argument("--json", action="store_true", help="Print the hits as one JSON object")
    parser.set_defaults(run=run, wrong_usage=parser.error)


def run(args: argparse.Namespace) -> int:
    """Search, write what is asked for, and print the hits."""
    from relgloss_view.catalogue.catalogue import Catalogue
    from relgloss_view.catalogue.query.listing import listing
    from relgloss_view.catalogue.query.parse import parse
    from relgloss_view.catalogue.query.search import search

    _check(args)
    catalogue = Catalogue.open(args.catalogue)
    query = parse(" ".join(args.query))
    with ExitStack() as stack:
        progress = stack.enter_context(Progress("search"))
        renderer = _renderer(args, query, stack)
        exact = None if args.quick else renderer
        found = search(catalogue, query, args.limit or None, renderer=exact, progress=progress)
        # Before the block below: what is written in it has its place at its end alone.
        made = _proofs(args, found, catalogue, renderer, stack, progress)
        with together():
            if made is not None:
                made.put(args.proofs)
            if args.output is not None:
                _sheet(args.output, found, catalogue)
            if args.page is not None:
                _page(args, found, catalogue, made)
    proofs = () if made is None else made.proofs
    if args.json:
        content = found.as_json()
        content["proofs"] = {one.path: one.file for one in proofs}
        print(json.dumps(content, allow_nan=False))
        return 0
    most = LIMIT if args.page is not None else None  # the page has the others
    print(listing(found, most))
    _print_files(args, proofs)
    return 0


def _check(args: argparse.Namespace) -> None:
    """Refuse wrong names before any work is done."""
    if args.limit < 0:
        args.wrong_usage(f"argument --limit: expected 0 or more, found {args.limit}")
    for name, endings, what in (
        (args.output, PICTURES, "-o: expected a name that ends in .png"),
        (args.page, PAGES, "--page: expected a name that ends in .html"),
    ):
        if name is None:
            continue
        if Path(name).suffix.lower() not in endings:
            raise InputError(f"{what}, found {printable(name)!r}")
        check_writable(name)
    if args.proofs is not None:
        _proofs_folder(args.proofs)


def _renderer(args: argparse.Namespace, query: Any, stack: ExitStack) -> FrameRenderer | None:
    """The renderer, where pictures are drawn."""
    from relgloss_view.catalogue.query.terms import Nearest
    from relgloss_view.quality.backends import open_renderer

    compares = any(isinstance(leaf, Nearest) for leaf in query.leaves)
    if args.proofs is None and (not compares or args.quick):
        return None
    return stack.enter_context(open_renderer("auto"))


@dataclass(frozen=True)
class _Proofs:
    """Proofs that are made, in a temporary folder."""

    folder: Path
    proofs: tuple[MadeProof, ...]

    def put(self, name: str) -> None:
        """Put them into the folder that was asked for, in the place of a former search's."""
        from relgloss_view.base.json_files import read_mark
        from relgloss_view.catalogue.proofs import MANIFEST, listed_proofs

        def stale(old: Path) -> list[str]:
            return list(listed_proofs(read_mark(old / MANIFEST)))

        with whole_folder(_proofs_folder(name), MANIFEST, stale) as temporary:
            for file in self.folder.iterdir():
                shutil.copyfile(file, temporary / file.name)


def _proofs_folder(name: str) -> Path:
    """The folder of proofs, new or of a former search; InputError for any other one."""
    from relgloss_view.catalogue.proofs import FORMAT, MANIFEST
    from relgloss_view.commands.output_folder import own_folder

    return own_folder(name, {MANIFEST: FORMAT}, "catalogue search --proofs", alone=True)


def _proofs(
    args: argparse.Namespace,
    found: Found,
    catalogue: Catalogue,
    renderer: FrameRenderer | None,
    stack: ExitStack,
    progress: Progress,
) -> _Proofs | None:
    """The proofs of the hits; None where none are asked for."""
    if args.proofs is None or renderer is None:
        return None
    from relgloss_view.catalogue.proofs import write_proofs

    folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="relgloss-")))
    return _Proofs(folder, write_proofs(found, catalogue, folder, renderer, progress))


def _sheet(name: str, found: Found, catalogue: Catalogue) -> None:
    from relgloss_view.catalogue.sheet import hits_sheet
    from relgloss_view.picture.output.png import save_rgb

    thumbnails = catalogue.thumbnails([hit.path for hit in found.hits])
    sheet = hits_sheet(found, thumbnails, catalogue.recipe.thumbnail_px)
    title = printable(found.query.text) or "all"
    save_rgb(sheet, name, {"Software": f"relgloss {__version__}", "Title": title})


def _page(
    args: argparse.Namespace, found: Found, catalogue: Catalogue, made: _Proofs | None
) -> None:
    from relgloss_view.catalogue.page.write import write_page

    folder = Path(args.proofs or "")
    proofs = () if made is None else made.proofs
    write_page(found, catalogue, args.page, {one.path: folder / one.file for one in proofs})


def _print_files(args: argparse.Namespace, proofs: tuple[MadeProof, ...]) -> None:
    for name, words in ((args.output, "contact sheet"), (args.page, "page of the hits")):
        if name is not None:
            print(f"{printable(name)}: {words}")
    if args.proofs is not None:
        each = sum(one.seconds for one in proofs) / max(len(proofs), 1)
        count = f"{len(proofs)} proof{'' if len(proofs) == 1 else 's'}"
        print(f"{printable(args.proofs)}: {count}" + f", {each:.1f} s each" * bool(proofs))
