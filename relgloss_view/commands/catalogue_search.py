"""`relgloss catalogue search`: samples of a catalogue by their gloss, colour and pictures."""

from __future__ import annotations

import argparse
import json
from contextlib import ExitStack
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
        "cast-coated within 5 %%' -o hits.png --page hits.html",
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

    _check(args)
    query = parse(" ".join(args.query))
    catalogue = Catalogue.open(args.catalogue)
    proofs: tuple[MadeProof, ...] = ()
    with ExitStack() as stack:
        progress = stack.enter_context(Progress("search"))
        renderer = _renderer(args, query, stack)
        from relgloss_view.catalogue.query.search import search

        limit = args.limit or None
        exact = None if args.quick else renderer
        found = search(catalogue, query, limit, renderer=exact, progress=progress)
        with together():
            if args.proofs is not None:
                assert renderer is not None
                proofs = _proofs(args.proofs, found, catalogue, renderer, progress)
            if args.output is not None:
                _sheet(args.output, found, catalogue)
            if args.page is not None:
                _page(args, found, catalogue, proofs)
    if args.json:
        content = found.as_json()
        content["proofs"] = {one.path: one.file for one in proofs}
        print(json.dumps(content, allow_nan=False))
        return 0
    print(listing(found))
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


def _renderer(args: argparse.Namespace, query: Any, stack: ExitStack) -> FrameRenderer | None:
    """The renderer, where pictures are drawn."""
    from relgloss_view.catalogue.query.terms import Nearest
    from relgloss_view.quality.backends import open_renderer

    compares = any(isinstance(leaf, Nearest) for leaf in query.leaves)
    if args.proofs is None and (not compares or args.quick):
        return None
    return stack.enter_context(open_renderer("auto"))


def _proofs(
    name: str, found: Found, catalogue: Catalogue, renderer: FrameRenderer, progress: Progress
) -> tuple[MadeProof, ...]:
    from relgloss_view.base.json_files import read_mark
    from relgloss_view.catalogue.proofs import FORMAT, MANIFEST, listed_proofs, write_proofs
    from relgloss_view.commands.output_folder import own_folder

    folder = own_folder(name, {MANIFEST: FORMAT}, "catalogue search --proofs", alone=True)

    def stale(old: Path) -> list[str]:
        return list(listed_proofs(read_mark(old / MANIFEST)))

    with whole_folder(folder, MANIFEST, stale) as temporary:
        return write_proofs(found, catalogue, temporary, renderer, progress)


def _sheet(name: str, found: Found, catalogue: Catalogue) -> None:
    from relgloss_view.catalogue.sheet import hits_sheet
    from relgloss_view.picture.output.png import save_rgb

    thumbnails = catalogue.thumbnails([hit.path for hit in found.hits])
    sheet = hits_sheet(found, thumbnails, catalogue.recipe.thumbnail_px)
    title = printable(found.query.text) or "all"
    save_rgb(sheet, name, {"Software": f"relgloss {__version__}", "Title": title})


def _page(
    args: argparse.Namespace, found: Found, catalogue: Catalogue, proofs: tuple[MadeProof, ...]
) -> None:
    from relgloss_view.catalogue.page.write import write_page

    folder = Path(args.proofs or "")
    write_page(found, catalogue, args.page, {one.path: folder / one.file for one in proofs})


def _print_files(args: argparse.Namespace, proofs: tuple[MadeProof, ...]) -> None:
    for name, words in ((args.output, "contact sheet"), (args.page, "page of the hits")):
        if name is not None:
            print(f"{printable(name)}: {words}")
    if args.proofs is not None:
        each = sum(one.seconds for one in proofs) / max(len(proofs), 1)
        count = f"{len(proofs)} proof{'' if len(proofs) == 1 else 's'}"
        print(f"{printable(args.proofs)}: {count}" + f", {each:.1f} s each" * bool(proofs))
