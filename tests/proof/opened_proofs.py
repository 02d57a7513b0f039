"""Proofs of papers, small and quickly made, and what a reader sees of a page."""

from __future__ import annotations

import dataclasses
from typing import Any

from relgloss_view.display.display import Display
from relgloss_view.picture.scene.look import viewed_look
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import SceneFile
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import Setup
from relgloss_view.proof.content import content_of
from relgloss_view.proof.drawing import shaders_of
from relgloss_view.proof.page import whole
from relgloss_view.proof.page.build import page
from relgloss_view.proof.page.static import body
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.quality.backends import open_renderer

SIZE = (96, 64)
NOTE, AUTHOR = "Is the highlight too strong?", "Ana"
MADE, PROGRAM = "2026-11-27T08:30:00Z", "relgloss 0.2.0"


def paper_proof(sample: str = "matte-coated", size: tuple[int, int] = SIZE) -> Proof:
    """A paper beside the cast-coated reference, with grain."""
    look = viewed_look()
    scene = SceneFile(
        Sample.built_in(sample),
        look.at(Setting(2.0, c=0.37)),
        Setup(display=Display().for_the_eye()),
        Sample.built_in("cast-coated"),
        look.at(Setting(0.0, c=0.14)),
    )
    with open_renderer() as renderer:
        made = content_of(scene, renderer, size=size)
    return Proof(made.content, (Message(made.settings, NOTE, AUTHOR, MADE, PROGRAM),))


def page_of(proof: Proof, drawing: Any = None) -> str:
    """The page of a proof, as `relgloss proof make` writes it.

    drawing: one that takes the place of the proof's own; the shaders stay.
    """
    if drawing is None:
        return whole.page_of(proof)
    changed = dataclasses.replace(proof, content={**proof.content, "drawing": drawing})
    return page(changed, shaders_of(proof.content["drawing"]), body(proof))


#: What a reader sees, as JSON: words, stored pictures that have a size, controls, the canvas.
SEEN = """() => {
  const shown = (element) => {
    const box = element.getBoundingClientRect(), style = getComputedStyle(element);
    return box.width > 0 && box.height > 0 && style.visibility === "visible";
  };
  const all = (selector) => [...document.querySelectorAll(selector)].filter(shown);
  return {
    state: document.getElementById("main")?.dataset.state ?? null,
    text: document.body.innerText,
    notice: all(".notice").map((element) => element.innerText).join(" "),
    pictures: all("img").map((image) => [image.naturalWidth, image.naturalHeight]),
    sliders: all("input").length,
    canvases: all("#canvas").length,
  };
}"""
