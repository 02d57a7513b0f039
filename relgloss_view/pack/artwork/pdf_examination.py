"""What a page of a PDF holds, found in a process of its own: colorants, layers, profile, fonts.

As a program: `python -m relgloss_view.pack.artwork.pdf_examination FILE PAGE FOLDER PROFILE`, where
PROFILE is 'profile' if the caller has one of CMYK. It prints JSON, and writes into FOLDER copies of
the PDF for Ghostscript: `page.pdf`, trimmed and with its spot colours named RG0001, RG0002, so that
no name can be lost in a file's name; and where no CMYK profile is at hand `colour.pdf`, whose
finishes are /None, which prints nothing (ISO 32000-2:2020, 8.6.6.4).
"""

from __future__ import annotations

import json
import math
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, open_regular, printable
from relgloss_view.pack.artwork.pdf_functions import evaluate
from relgloss_view.pack.artwork.plate_names import PROCESS, is_technical

EXPECTED = "a PDF"
TINTS = 33  #: at which a spot colour's alternate is taken
MOST_MEMORY = 2_000_000_000  #: bytes of data of this process
MOST_PARTS = 200_000  #: of a page that are walked
MOST_NAMES = 1000
MOST_SIDE_PT = 1e6
MOST_CONTENT = 400_000_000  #: bytes of contents that are searched
_CMYK_OPERATOR = re.compile(rb"[\d.]\s+[kK](?=[\s/\[(<]|$)|/(?:DeviceCMYK|CMYK)\b")


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
        if _is_name(value):
            self.cmyk |= _name(value) in ("DeviceCMYK", "CMYK")
            return
        if not _is_array(value) or len(value) == 0:
            return
        kind = _name(value[0])
        if kind in ("Separation", "DeviceN") and len(value) >= 4:
            if self._new(value) or getattr(value, "objgen", (0, 0)) == (0, 0):
                self.spaces.append(value)
                if kind == "DeviceN" and len(value) > 4 and "/Colorants" in value[4]:
                    for one in value[4]["/Colorants"].values():
                        self._space(one, depth + 1)
                if any(_name(n) in PROCESS for n in colorants(value)):
                    self.cmyk = True
        elif kind in ("Indexed", "I", "Pattern") and len(value) > 1:
            self._space(value[1], depth + 1)
        elif kind == "ICCBased" and len(value) > 1 and int(value[1].get("/N", 0)) == 4:
            self.cmyk = True
            if self._new(value[1]):
                self.profiles.append(value[1])

    def _font(self, font: Any) -> None:
        if _name(font.get("/Subtype", "")) == "Type3":
            return
        inner = font["/DescendantFonts"][0] if "/DescendantFonts" in font else font
        described = inner.get("/FontDescriptor", {})
        if not any(k in described for k in ("/FontFile", "/FontFile2", "/FontFile3")):
            self.fonts.add(_name(font.get("/BaseFont", "/unnamed")))


def _parts_of(resources: Any) -> Iterator[tuple[str, Any]]:
    if resources is None:
        return
    for key, kind in (
        ("/ColorSpace", "space"), ("/XObject", "object"), ("/Pattern", "pattern"),
        ("/Shading", "shading"), ("/Font", "font"), ("/ExtGState", "state"),
    ):  # fmt: skip
        for value in dict(resources.get(key, {})).values():
            yield kind, value


def _inner(page: Page, kind: str, value: Any, resources: Any) -> list[tuple[str, Any, Any]]:
    """Parts of a part that wait to be walked."""
    if kind == "object":
        if _name(value.get("/Subtype", "")) == "Form":
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
    elif kind == "state" and "/SMask" in value and not _is_name(value["/SMask"]):
        group = value["/SMask"].get("/G")
        if group is not None:
            return [("page", group, group.get("/Resources", resources))]
    return []


def _is_name(value: Any) -> bool:
    import pikepdf

    return isinstance(value, pikepdf.Name)


def _is_array(value: Any) -> bool:
    import pikepdf

    return isinstance(value, pikepdf.Array)


def _name(value: Any) -> str:
    """A name without its slash; bytes that are no UTF-8 as Latin-1."""
    try:
        return str(value).removeprefix("/")
    except UnicodeDecodeError:
        text = value.unparse()[1:]
        parts = re.sub(rb"#([0-9a-fA-F]{2})", lambda m: bytes([int(m[1], 16)]), text)
        return parts.decode("latin-1")


def colorants(space: Any) -> list[Any]:
    """The names of a Separation or DeviceN space."""
    return [space[1]] if _name(space[0]) == "Separation" else list(space[1])


def inherited(node: Any, key: str) -> Any:
    """An entry of a page or of its parents; None where there is none."""
    for _ in range(50):
        if key in node:
            return node[key]
        if "/Parent" not in node:
            return None
        node = node["/Parent"]
    return None


def processing_steps(pdf: Any) -> dict[tuple[int, int], str]:
    """Layers that ISO 19593-1 marks, by object: their processing steps."""
    steps = {}
    layers = pdf.Root.get("/OCProperties", {}).get("/OCGs", [])
    for layer in list(layers)[:MOST_NAMES]:
        meta = layer.get("/GTS_Metadata", {})
        group, kind = meta.get("/GTS_ProcStepsGroup"), meta.get("/GTS_ProcStepsType")
        if group is not None or kind is not None:
            steps[layer.objgen] = _name(kind if kind is not None else group)
    return steps


def steps_of_colorants(page: Page, steps: dict[tuple[int, int], str]) -> dict[str, str]:
    """Colorants that are used in layers of processing steps alone, with the step."""
    import pikepdf

    inside: dict[str, str] = {}
    outside: set[str] = set()
    for content, resources in page.contents:
        step_of_form = _step(content.get("/OC") if hasattr(content, "get") else None, steps)
        stack: list[str] = [step_of_form]
        properties = (resources or {}).get("/Properties", {})
        source = page.page if content is page.contents[0][0] else content
        for operands, operator in pikepdf.parse_content_stream(source, "BDC BMC EMC cs CS sh Do"):
            word = str(operator)
            if word in ("BDC", "BMC"):
                step = stack[-1]
                if word == "BDC" and len(operands) > 1 and _name(operands[0]) == "OC":
                    step = _step(properties.get(str(operands[1])), steps) or step
                stack.append(step)
            elif word == "EMC" and len(stack) > 1:
                stack.pop()
            elif word in ("cs", "CS", "sh", "Do") and operands:
                table = {"sh": "/Shading", "Do": "/XObject"}.get(word, "/ColorSpace")
                value = (resources or {}).get(table, {}).get(str(operands[0]))
                if word in ("sh", "Do") and value is not None:
                    value = value.get("/ColorSpace")
                if not _is_array(value) or _name(value[0]) not in ("Separation", "DeviceN"):
                    continue
                for one in colorants(value):
                    if stack[-1]:
                        inside[_name(one)] = stack[-1]
                    else:
                        outside.add(_name(one))
    return {name: step for name, step in inside.items() if name not in outside}


def _step(layer: Any, steps: dict[tuple[int, int], str]) -> str:
    if layer is None:
        return ""
    if "/OCGs" in layer:
        members = layer["/OCGs"]
        layer = members[0] if _is_array(members) and len(members) else members
    return steps.get(getattr(layer, "objgen", (0, 0)), "")


def alternates(page: Page, folder: Path) -> dict[str, dict[str, Any]]:
    """What each spot colour looks like: space and values at TINTS tints, of its Separation first."""
    made: dict[str, dict[str, Any]] = {}
    for space in sorted(page.spaces, key=lambda s: _name(s[0]) != "Separation"):
        names = [_name(n) for n in colorants(space)]
        for k, name in enumerate(names):
            if name in made or name in (*PROCESS, "All", "None"):
                continue
            try:
                kind, icc = _alternate_space(space[2], folder, len(made))
                rows = []
                for t in range(TINTS):
                    tints = [0.0] * len(names)
                    tints[k] = t / (TINTS - 1)
                    rows.append(evaluate(space[3], tints))
                if len({len(row) for row in rows}) == 1:
                    made[name] = {"space": kind, "icc": icc, "values": rows}
            except (ValueError, KeyError, TypeError, IndexError, AttributeError, ArithmeticError):
                continue
    return made


def _alternate_space(space: Any, folder: Path, number: int) -> tuple[str, str]:
    kinds = {"DeviceCMYK": "CMYK", "DeviceRGB": "RGB", "DeviceGray": "GRAY", "Lab": "Lab"}
    kinds |= {"CalRGB": "RGB", "CalGray": "GRAY"}
    kind = _name(space if _is_name(space) else space[0])
    if kind != "ICCBased":
        return kinds[kind], ""
    icc = folder / f"alternate-{number}.icc"
    icc.write_bytes(space[1].read_bytes())
    return {1: "GRAY", 3: "RGB", 4: "CMYK"}[int(space[1]["/N"])], icc.name


def output_intent(pdf: Any) -> tuple[Any, str]:
    """The stream of the output intent's CMYK profile, and the condition's name; None, '' without."""
    name = ""
    for intent in list(pdf.Root.get("/OutputIntents", []))[:10]:
        name = name or str(intent.get("/OutputConditionIdentifier", ""))
        stream = intent.get("/DestOutputProfile")
        if stream is not None and int(stream.get("/N", 0)) == 4:
            return stream, name
    return None, name


def trim(page: Any) -> tuple[float, float, float]:
    """Make the trim box the whole page; its printed width and height, points, and its unit."""
    box = next(
        b
        for b in (page.obj.get("/TrimBox"), inherited(page.obj, "/CropBox"),
                  inherited(page.obj, "/MediaBox"), [0, 0, 612, 792])
        if b is not None
    )  # fmt: skip
    numbers = [float(v) for v in box]
    x0, x1 = sorted(numbers[0::2][:2])
    y0, y1 = sorted(numbers[1::2][:2])
    unit = float(page.obj.get("/UserUnit", 1.0))
    width, height = (x1 - x0) * unit, (y1 - y0) * unit
    if not (0.1 <= min(width, height) and max(width, height) <= MOST_SIDE_PT):
        raise ValueError("a page without a size that can be printed")
    for key in ("/TrimBox", "/BleedBox", "/ArtBox", "/UserUnit"):
        if key in page.obj:
            del page.obj[key]
    page.obj["/MediaBox"] = page.obj["/CropBox"] = [x0, y0, x1, y1]
    turned = int(inherited(page.obj, "/Rotate") or 0) % 180 == 90
    return (height, width, unit) if turned else (width, height, unit)


def _rename(page: Page, keys: dict[str, str]) -> None:
    import pikepdf

    for space in page.spaces:
        if _name(space[0]) == "Separation":
            name = _name(space[1])
            if name in keys:
                space[1] = pikepdf.Name("/" + keys[name])
            continue
        for k, one in enumerate(list(space[1])):
            if _name(one) in keys:
                space[1][k] = pikepdf.Name("/" + keys[_name(one)])
        if len(space) > 4:
            attributes = space[4]
            if "/MixingHints" in attributes:
                del attributes["/MixingHints"]
            if "/Colorants" in attributes:
                old = attributes["/Colorants"]
                named_now = {"/" + keys.get(_name(k), _name(k)): v for k, v in old.items()}
                named_now.pop("/None", None)
                attributes["/Colorants"] = pikepdf.Dictionary(named_now)


def examine(path: str, number: int, folder: Path, has_profile: bool) -> dict[str, Any]:
    """What the caller needs of a page, and the copies for Ghostscript; InputError with one line."""
    import pikepdf

    with open_regular(path, EXPECTED) as file:
        try:
            pdf = pikepdf.Pdf.open(file)
        except pikepdf.PasswordError:
            raise InputError(
                f"{named(path)}: an encrypted PDF; save it without a password"
            ) from None
        count = len(pdf.pages)
        if count == 0:
            raise InputError(f"{named(path)}: a PDF without pages; export it again")
        if number > count:
            raise InputError(
                f"{named(path)}: page {number} is not there; it has {count}: give --page 1 to {count}"
            )
        source = pdf.pages[number - 1]
        page = Page(pdf, source)
        steps = processing_steps(pdf)
        by_layer = steps_of_colorants(page, steps) if steps else {}
        width, height, unit = trim(source)
        looks = alternates(page, folder)
        names = list(
            dict.fromkeys(
                _name(n)
                for space in page.spaces
                for n in colorants(space)
                if _name(n) not in (*PROCESS, "All", "None")
            )
        )
        if len(names) > MOST_NAMES:
            raise InputError(f"{named(path)}: {len(names)} spot colours; at most {MOST_NAMES}")
        technical = [n for n in names if n in by_layer or is_technical(n)]
        stream, condition = output_intent(pdf)
        if stream is None and not has_profile and len(page.profiles) == 1:
            stream = page.profiles[0]
        profile = ""
        if stream is not None:
            profile = "intent.icc"
            (folder / profile).write_bytes(stream.read_bytes())
        cmyk = page.cmyk or any(
            looks.get(n, {}).get("space") == "CMYK" for n in names if n not in technical
        )
        by_profile = bool(profile) or has_profile
        if not by_profile:
            cmyk = cmyk or _paints_cmyk(page)
        save = {"compress_streams": False, "object_stream_mode": pikepdf.ObjectStreamMode.preserve}
        keys = {name: f"RG{k:04d}" for k, name in enumerate(names, start=1)}
        _rename(page, keys)
        pdf.save(folder / "page.pdf", **save)
        if not by_profile and not cmyk:
            _rename(page, {keys[n]: "None" for n in technical})
            pdf.save(folder / "colour.pdf", **save)
        off = _switched_off(pdf, steps)
    return {
        "pages": count, "size_pt": [width, height], "unit": unit, "names": keys, "technical": technical,
        "layers": by_layer, "alternates": looks, "profile": profile, "condition": condition,
        "cmyk": cmyk, "fonts": sorted(page.fonts), "off": off,
    }  # fmt: skip


def _paints_cmyk(page: Page) -> bool:
    left = MOST_CONTENT
    for content, _ in page.contents:
        parts = list(content) if _is_array(content) else [content]
        for part in parts:
            data = part.read_bytes()
            left -= len(data)
            if left < 0:
                raise ValueError("a page of too much content")
            if _CMYK_OPERATOR.search(data):
                return True
    return False


def _switched_off(pdf: Any, steps: dict[tuple[int, int], str]) -> list[str]:
    off = pdf.Root.get("/OCProperties", {}).get("/D", {}).get("/OFF", [])
    return [printable(str(one.get("/Name", ""))) for one in off if one.objgen in steps]


def main(words: list[str]) -> None:
    """Print what was found, or the error, as JSON."""
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, MOST_MEMORY))
    except (ImportError, ValueError, OSError):  # Windows, or a limit that is lower already
        pass
    path, number, folder, profile = words
    try:
        answer = examine(path, int(number), Path(folder), profile == "profile")
    except InputError as error:
        answer = {"error": str(error)}
    except Exception as error:
        reason = (
            printable(str(error).partition(">: ")[2] or error, 120).replace(path, "").strip(" :")
            or type(error).__name__
        )
        answer = {
            "error": f"{named(path)}: a damaged PDF ({reason}); open it in its program, export again"
        }
    if not all(math.isfinite(v) for v in answer.get("size_pt", [])):
        answer = {"error": f"{named(path)}: a page without a size"}
    print(json.dumps(answer))


if __name__ == "__main__":
    main(sys.argv[1:])
