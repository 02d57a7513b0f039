"""A page of a PDF, walked: the colour spaces, fonts and contents that it reaches.

Source: ISO 32000-2:2020, 7.8.3 (resources), 8.6 (colour spaces), 8.7 (patterns), 11.6 (soft masks).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from relgloss_view.pack.artwork.plate_names import PROCESS

MOST_PARTS = 200_000  #: of a page that are walked


class Page:
    """A page: its colour spaces, fonts and contents, each once."""

    def __init__(self, pdf: Any, page: Any) -> None:
        self.pdf, self.page = pdf, page
        self.spaces: list[Any] = []  #: arrays that name colorants
        self.fonts: set[str] = set()
        self.profiles: list[Any] = []  #: streams of ICCBased spaces of four channels
        self.cmyk = False
        self.contents: list[Any] = []
        self._seen: set[tuple[int, int]] = set()
        self._parts = 0
        self._walk(page.obj.get("/Contents"), inherited(page.obj, "/Resources"))

    def _walk(self, contents: Any, resources: Any) -> None:
        waiting = [("page", contents, resources)]
        while waiting:
            self._parts += 1
            if self._parts > MOST_PARTS:
                raise ValueError("a page of too many parts")
            kind, content, res = waiting.pop()
            if kind == "page" and content is not None:
                self.contents.append((content, res))
            if kind == "space":
                self._space(content, 0)
                continue
            for part, value in _parts_of(res):
                if part == "space":
                    self._space(value, 0)
                elif self._new(value):
                    if part == "font":
                        self._font(value)
                    waiting += _inner(self, part, value, res)

    def _new(self, value: Any) -> bool:
        mark = getattr(value, "objgen", (0, 0))
        if mark == (0, 0):
            return True
        fresh = mark not in self._seen
        self._seen.add(mark)
        return fresh

    def space(self, value: Any) -> None:
        """Note a colour space that is used."""
        self._space(value, 0)

    def _space(self, value: Any, depth: int) -> None:
        if value is None or depth > 8:
            return
        if is_name(value):
            self.cmyk |= name_of(value) in ("DeviceCMYK", "CMYK")
            return
        if not is_array(value) or len(value) == 0:
            return
        kind = name_of(value[0])
        if kind in ("Separation", "DeviceN") and len(value) >= 4:
            if self._new(value) or getattr(value, "objgen", (0, 0)) == (0, 0):
                self.spaces.append(value)
                if kind == "DeviceN" and len(value) > 4 and "/Colorants" in value[4]:
                    for one in value[4]["/Colorants"].values():
                        self._space(one, depth + 1)
                if any(name_of(n) in PROCESS for n in colorants(value)):
                    self.cmyk = True
        elif kind in ("Indexed", "I", "Pattern") and len(value) > 1:
            self._space(value[1], depth + 1)
        elif kind == "ICCBased" and len(value) > 1 and int(value[1].get("/N", 0)) == 4:
            self.cmyk = True
            if self._new(value[1]):
                self.profiles.append(value[1])

    def _font(self, font: Any) -> None:
        if name_of(font.get("/Subtype", "")) == "Type3":
            return
        inner = font["/DescendantFonts"][0] if "/DescendantFonts" in font else font
        described = inner.get("/FontDescriptor", {})
        if not any(k in described for k in ("/FontFile", "/FontFile2", "/FontFile3")):
            self.fonts.add(name_of(font.get("/BaseFont", "/unnamed")))


def _parts_of(resources: Any) -> Iterator[tuple[str, Any]]:
    if resources is None:
        return
    for key, kind in (
        ("/ColorSpace", "space"), ("/XObject", "object"), ("/Pattern", "pattern"),
        ("/Shading", "shading"), ("/Font", "font"), ("/ExtGState", "state"),
    ):  # fmt: skip
        for value in (v for _, v in sorted(dict(resources.get(key, {})).items())):
            yield kind, value


def _inner(page: Page, kind: str, value: Any, resources: Any) -> list[tuple[str, Any, Any]]:
    """Parts of a part that wait to be walked."""
    if kind == "object":
        if name_of(value.get("/Subtype", "")) == "Form":
            group = value.get("/Group", {})
            page.space(group.get("/CS") if "/CS" in group else None)
            return [("page", value, value.get("/Resources", resources))]
        page.space(value.get("/ColorSpace"))
        if "/SMask" in value:
            return []
    elif kind == "pattern":
        if "/Shading" in value:
            page.space(value["/Shading"].get("/ColorSpace"))
        elif "/Resources" in value:
            return [("page", value, value["/Resources"])]
    elif kind == "shading":
        page.space(value.get("/ColorSpace"))
    elif kind == "font" and "/CharProcs" in value:
        inner = value.get("/Resources", resources)
        return [("page", one, inner) for one in value["/CharProcs"].values()]
    elif kind == "state" and "/SMask" in value and not is_name(value["/SMask"]):
        group = value["/SMask"].get("/G")
        if group is not None:
            return [("page", group, group.get("/Resources", resources))]
    return []


def is_name(value: Any) -> bool:
    """Whether an object is a name."""
    import pikepdf

    return isinstance(value, pikepdf.Name)


def is_array(value: Any) -> bool:
    """Whether an object is an array."""
    import pikepdf

    return isinstance(value, pikepdf.Array)


def name_of(value: Any) -> str:
    """A name without its slash; bytes that are no UTF-8 as Latin-1."""
    try:
        return str(value).removeprefix("/")
    except UnicodeDecodeError:
        text = value.unparse()[1:]
        parts = re.sub(rb"#([0-9a-fA-F]{2})", lambda m: bytes([int(m[1], 16)]), text)
        return parts.decode("latin-1")


def colorants(space: Any) -> list[Any]:
    """The names of a Separation or DeviceN space."""
    return [space[1]] if name_of(space[0]) == "Separation" else list(space[1])


def inherited(node: Any, key: str) -> Any:
    """An entry of a page or of its parents; None where there is none."""
    for _ in range(50):
        if key in node:
            return node[key]
        if "/Parent" not in node:
            return None
        node = node["/Parent"]
    return None
