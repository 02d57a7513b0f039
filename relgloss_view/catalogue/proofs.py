"""Proofs of hits: for each one file that shows the reference beside it in any browser."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.base.version import PROGRAM, __version__
from relgloss_view.catalogue.look import reference_of
from relgloss_view.catalogue.query.found import Found, Hit, Searched
from relgloss_view.gloss.match import matched
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.match import Match
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof.content import content_of
from relgloss_view.proof.page.whole import page_of
from relgloss_view.proof.proof import MOST_NOTE, Message, Proof, present_time
from relgloss_view.quality.backends import FrameRenderer

MANIFEST, FORMAT, VERSION = "proofs.json", "relgloss-catalogue-proofs", 1
LONGEST = 60  #: characters of a file's name without rank and ending


@dataclass(frozen=True)
class MadeProof:
    """A proof's file in its folder, the item that it shows, and the time that it took."""

    file: str
    path: str
    seconds: float


def write_proofs(
    found: Found,
    catalogue: Searched,
    folder: Path,
    renderer: FrameRenderer,
    progress: ProgressReport = no_progress,
) -> tuple[MadeProof, ...]:
    """One proof a hit in an empty folder, and the manifest that lists them.

    The reference is that of the query, or else the catalogue's. Hits that failed have none.
    """
    made = []
    hits = [hit for hit in found.hits if hit.row.get("material")]
    for count, hit in enumerate(hits):
        progress(count / len(hits), f"proof of {hit.name}")
        start = time.perf_counter()
        name = proof_name(hit)
        html = page_of(_proof(hit, found, catalogue, renderer))
        (folder / name).write_text(html, encoding="utf-8", newline="\n")
        made.append(MadeProof(name, hit.path, time.perf_counter() - start))
    content = {
        "format": FORMAT,
        "version": VERSION,
        "relgloss_version": __version__,
        "query": found.query.text,
        "proofs": [{"file": one.file, "path": one.path} for one in made],
    }
    (folder / MANIFEST).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return tuple(made)


def proof_name(hit: Hit) -> str:
    """The file of a hit's proof: its rank and its file's name, in letters that any system takes.

    >>> proof_name(Hit({"path": "lot 1/W\\u00e4rm & gloss.csv"}, 3))
    '003-W-rm-gloss.html'
    """
    stem = hit.path.rpartition("/")[2].rpartition(".")[0] or hit.path
    plain = re.sub(r"[^A-Za-z0-9_]+", "-", stem).strip("-")[:LONGEST]
    return f"{hit.rank:03d}-{plain or 'sample'}.html"


def listed_proofs(manifest: object) -> Sequence[str]:
    """Names of the proofs that a manifest lists, as a former run wrote them."""
    entries = manifest.get("proofs") if isinstance(manifest, dict) else None
    if not isinstance(entries, list):
        return ()
    return [str(e["file"]) for e in entries if isinstance(e, dict) and "file" in e]


def pair_of(hit: Hit, found: Found, catalogue: Searched) -> SceneFile:
    """A hit beside the reference of its query, or else of its catalogue; each c is matched."""
    base = reference_of(catalogue.recipe)
    material = catalogue.material(hit.path)
    sigma = float(hit.row.get("sigma_n_deg") or 0.0)
    match = matched(base, material, sigma)
    reference, reference_look = base.sample.material, base.sample_at_c.look
    pair: Match | None = match
    if found.reference is not None:
        reference = found.reference.material
        grain = found.reference.sigma_n_deg
        own = matched(base, reference, grain)
        reference_look = viewed_look().with_entries(c=own.test_c, sigma_n_deg=grain)
        pair = None
    return SceneFile(
        Sample(material),
        viewed_look().with_entries(c=match.test_c, sigma_n_deg=sigma),
        Setup(),
        Sample(reference),
        viewed_look().with_entries(c=reference_look.c, sigma_n_deg=reference_look.sigma_n_deg),
        match=pair,
    )


def note_of(hit: Hit, found: Found) -> str:
    """The note of a hit's proof."""
    return f"Hit {hit.rank} of the query: {found.query.text}"[:MOST_NOTE]


def _proof(hit: Hit, found: Found, catalogue: Searched, renderer: FrameRenderer) -> Proof:
    made = content_of(pair_of(hit, found, catalogue), renderer, title=hit.name)
    message = Message(made.settings, note_of(hit, found), "", present_time(), PROGRAM)
    return Proof(made.content, (message,))
