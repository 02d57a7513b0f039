"""A proof of two papers for the tests of the page, quick to make."""

from __future__ import annotations

import base64
import io
import json
from functools import lru_cache
from pathlib import Path

from PIL import Image

from relgloss_view import Look, Scene, load_sample
from relgloss_view.picture.scene.setup import Eye
from relgloss_view.proof.drawing import drawing_of, shaders_of
from relgloss_view.proof.page import build, static
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.settings import SIDES, LampPlace, PictureSetting, Settings

NOTE = "The lid should look like the sample that you have.\nPlease look at the edge."
NOTHING = {"lab": [None], "l_d": [None], "l_s": [None]}  #: of a grid's side
FIRST = Settings(PictureSetting(0.4, 0.1), PictureSetting(0.2, 0.25), Eye(), LampPlace())
SECOND = Settings(
    PictureSetting(0.4, 0.1), PictureSetting(0.6, 0.2), Eye(20.0), LampPlace(azimuth_deg=30.0)
)


@lru_cache(maxsize=1)
def drawing() -> tuple[str, dict[str, str]]:
    """The drawing of two papers as JSON text, and its shaders."""
    sides = {
        "reference": (Scene(load_sample("matte-coated")), Look()),
        "test": (Scene(load_sample("art-coated")), Look()),
    }
    made = drawing_of(sides)
    return json.dumps(made), shaders_of(made)


def picture(gray: int) -> dict[str, str]:
    """A stored picture of one gray."""
    held = io.BytesIO()
    Image.new("RGB", (64, 64), (gray, gray, gray)).save(held, "webp")
    return {"type": "image/webp", "base64": base64.b64encode(held.getvalue()).decode("ascii")}


def sample_proof(*, text: str = "", replies: int = 1) -> Proof:
    """A proof with so many replies; text stands in the place of every name and note."""
    content = {
        "title": text[:200] or "Sample box, autumn edition",
        "size_px": [64, 64],
        "files": {"scene.toml": {"text": ""}},
        "pictures": {"reference": picture(90), "test": picture(160)},
        "grid": {"columns": 1, "rows": 1, "sides": dict.fromkeys(SIDES, NOTHING)},
        "drawing": json.loads(drawing()[0]),
        "meter": {
            "gloss-60": {"name": text or "60°", "reference": 21.34, "test": 55.2, "decimals": 1},
            "haze": {"name": text or "Haze", "reference": None, "test": 12.1, "decimals": 1},
        },
        "display": {"words": text or "27-inch panel", "sentences": [text or "White 160 cd/m2."]},
    }
    first = Message(
        FIRST, text or NOTE, text[:200] or "Ayako Ishii", "2026-11-27T08:30:00Z", "relgloss 0"
    )
    proof = Proof(content, (first,))
    for k in range(replies):
        proof = proof.answered(
            Message(
                SECOND,
                text or f"Answer {k + 1}",
                text[:200] or "Jonas Weber",
                "2026-11-27T14:05:00Z",
            )
        )
    return proof


def sample_page(path: Path, language: str = "en", **options: object) -> Path:
    """The page of such a proof, written to a file."""
    proof = sample_proof(**options)  # type: ignore[arg-type]
    html = build.page(proof, drawing()[1], static.body(proof, language), language)
    path.write_bytes(html.encode("utf-8"))
    return path
