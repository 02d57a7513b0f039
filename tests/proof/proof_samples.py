"""Small proofs for tests of the format: every kind of entry, nothing that could be drawn."""

from __future__ import annotations

import base64
import functools
import json
from pathlib import Path

from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Eye, Setup
from relgloss_view.proof.content import content_of
from relgloss_view.proof.page import build
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.settings import LampPlace, PictureSetting, Settings
from relgloss_view.quality.backends import open_renderer

#: Replaced by `with_module`, as the page's own entry draws.
MODULES = Path(build.__file__).parent / "js"


def settings(c=1.5, sigma_n_deg=2.0):
    return Settings(PictureSetting(1.0, 1.0), PictureSetting(sigma_n_deg, c), Eye(), LampPlace())


def content():
    picture = base64.b64encode(bytes(range(90))).decode()
    sides = {s: {"lab": [[50.0, 1e-7, -0.25], None], "l_d": [1], "l_s": [2]} for s in SIDES}
    return {
        "title": "Dose <1> & Söhne\u00a0GmbH",
        "size_px": [16, 12],
        "files": {
            "scene.toml": {"text": 'a = "<b>"\n'},
            "materials/a.json": {"text": "{}"},
            "art.png": {"base64": picture, "type": "image/png"},
        },
        "meter": {},
        "display": {},
        "grid": {"columns": 2, "rows": 1, "sides": sides},
        "pictures": {side: {"base64": picture, "type": "image/webp"} for side in SIDES},
        "drawing": {"numbers": [5e-324, 1e21, 0.1, 12345678.9]},
    }


SIDES = ("reference", "test")
SHADERS = {
    "a.glsl": "float a() {\n  return 1.0 < 2.0 ? 1.0 : 0.0;\n}\n",
    "b.frag": "void main() {}\n",
}
BODY = "<main>\n<h1>Dose</h1>\n<p>Zwei Bilder &amp; Worte</p>\n</main>"


def thread(count, note="Bitte <etwas> weniger «Glanz» \U0001f642"):
    """A proof of `count` messages."""
    proof = Proof(content(), (Message(settings(), "first", "Aya", "2026-11-27T08:30:00Z", "x 1"),))
    for k in range(1, count):
        screen = {"gamma": 2.2} if k % 2 else None
        proof = proof.answered(Message(settings(c=1 + k / 8), f"{note} {k}", "Bo", screen=screen))
    return proof


def page_of(proof):
    return build.page(proof, SHADERS, BODY)


def small_page(monkeypatch, folder, script="window.relgloss = 1;"):
    """Pages with a style, words and a program of one line each, as long as a test."""
    (folder / "words").mkdir(parents=True)
    (folder / "words" / "en.json").write_text('{"word": "Wort"}')
    (folder / "style.css").write_text("body {\n  margin: 0;\n}\n")
    monkeypatch.setattr(build, "FOLDER", folder)
    monkeypatch.setattr(build, "script", lambda: script)


@functools.cache
def drawable(size):
    """A small proof of two papers that can be drawn: one message."""
    look = viewed_look()
    scene = SceneFile(
        Sample.built_in("matte-coated"), look.at(Setting(2.0, c=0.37)), Setup(),
        Sample.built_in("cast-coated"), look.at(Setting(0.0, c=0.14)),
    )  # fmt: skip
    with open_renderer() as renderer:
        made = content_of(scene, renderer, size=size, title="Dose")
    first = Message(made.settings, "Genug Glanz?\nSag es.", "Aya", "2026-11-27T08:30:00Z")
    return Proof(made.content, (first,))


@functools.cache
def canonical_module():
    """canonical.js as a script that sets window.canon."""
    text = (MODULES / "canonical.js").read_text(encoding="utf-8")
    names = ["canonical", "scriptJson", "Sha256", "sha256", "digestsOf", "pageText", "splitPage",
             "checkPage", "wordsOfPart", "withMessage", "fingerprint", "checkSignatures",
             "bytesOfHex"]  # fmt: skip
    body = text.replace("\nexport ", "\n")
    return f"(() => {{{body}\nwindow.canon = {{{', '.join(names)}}};}})()"


def as_js(value):
    """A value as JSON in JavaScript."""
    return json.dumps(value)
