"""What a page of a PDF holds, found in a process of its own: colorants, layers, profile, fonts.

As a program: `python -m relgloss_view.pack.artwork.pdf_examination FILE PAGE FOLDER PROFILE S
PLATES`, where PROFILE is 'profile' if the caller has one of CMYK, S seconds of processor time, and
PLATES a JSON list of spot colours that are finishes whatever their names are. It prints JSON, and
writes into FOLDER copies of the PDF for Ghostscript: `page.pdf`, trimmed and with its spot colours
named RG0001, RG0002, so that no name can be lost in a file's name; and where no CMYK profile is at
hand `colour.pdf`, whose finishes are /None, which prints nothing (ISO 32000-2:2020, 8.6.6.4).
"""

from __future__ import annotations

import json
import logging
import math
import re
import sys
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import named, open_regular, printable
from relgloss_view.pack.artwork.pdf_functions import evaluate
from relgloss_view.pack.artwork.pdf_page import (
    Page,
    colorants,
    inherited,
    is_array,
    is_name,
    name_of,
)
from relgloss_view.pack.artwork.pdf_streams import pieces, stream_bytes
from relgloss_view.pack.artwork.plate_names import PROCESS, finishing_plates, is_technical

EXPECTED = "a PDF"
TINTS = 33  #: at which a spot colour's alternate is taken
MOST_MEMORY = 800_000_000  #: bytes of data of this process
MOST_NAMES = 1000
MOST_SIDE_PT = 1e6
MOST_CONTENT = 60_000_000  #: bytes of contents that are searched
MOST_PARSED = 30_000_000  #: bytes of contents whose layers are followed
MOST_PROFILE = 64_000_000  #: bytes
_LONGEST_WORD = 40  #: bytes of a match that a border of two pieces may cut
#: The operators k and K behind a number; searched from the letter on, which is rare.
_CMYK_OPERATOR = re.compile(rb"[kK](?<=[\d.]\s[kK])(?=[\s/\[(<]|$)")


def processing_steps(pdf: Any) -> dict[tuple[int, int], str]:
    """Layers that ISO 19593-1 marks, by object: their processing steps."""
    steps = {}
    layers = pdf.Root.get("/OCProperties", {}).get("/OCGs", [])
    for layer in list(layers)[:MOST_NAMES]:
        meta = layer.get("/GTS_Metadata", {})
        group, kind = meta.get("/GTS_ProcStepsGroup"), meta.get("/GTS_ProcStepsType")
        if group is not None or kind is not None:
            steps[layer.objgen] = name_of(kind if kind is not None else group)
    return steps


def steps_of_colorants(page: Page, steps: dict[tuple[int, int], str]) -> dict[str, str]:
    """Colorants that are used in layers of processing steps alone, with the step."""
    import pikepdf

    inside: dict[str, str] = {}
    outside: set[str] = set()
    left = MOST_PARSED
    for content, resources in page.contents:
        for part in content if is_array(content) else [content]:
            left -= sum(map(len, pieces(part, left)))
        step_of_form = _step(content.get("/OC") if hasattr(content, "get") else None, steps)
        stack: list[str] = [step_of_form]
        properties = (resources or {}).get("/Properties", {})
        source = page.page if content is page.contents[0][0] else content
        for instruction in pikepdf.parse_content_stream(source, "BDC BMC EMC cs CS sh Do"):
            operands, word = instruction.operands, str(instruction.operator)
            if word in ("BDC", "BMC"):
                step = stack[-1]
                if word == "BDC" and len(operands) > 1 and name_of(operands[0]) == "OC":
                    step = _step(properties.get(str(operands[1])), steps) or step
                stack.append(step)
            elif word == "EMC" and len(stack) > 1:
                stack.pop()
            elif word in ("cs", "CS", "sh", "Do") and operands:
                table = {"sh": "/Shading", "Do": "/XObject"}.get(word, "/ColorSpace")
                value = (resources or {}).get(table, {}).get(str(operands[0]))
                if word in ("sh", "Do") and value is not None:
                    value = value.get("/ColorSpace")
                if not is_array(value) or name_of(value[0]) not in ("Separation", "DeviceN"):
                    continue
                for one in colorants(value):
                    if stack[-1]:
                        inside[name_of(one)] = stack[-1]
                    else:
                        outside.add(name_of(one))
    return {name: step for name, step in inside.items() if name not in outside}


def _step(layer: Any, steps: dict[tuple[int, int], str]) -> str:
    if layer is None:
        return ""
    if "/OCGs" in layer:
        members = layer["/OCGs"]
        layer = members[0] if is_array(members) and len(members) else members
    return steps.get(getattr(layer, "objgen", (0, 0)), "")


def alternates(page: Page, folder: Path) -> dict[str, dict[str, Any]]:
    """What each spot colour looks like: space and values at TINTS tints."""
    made: dict[str, dict[str, Any]] = {}
    for space in sorted(page.spaces, key=lambda s: name_of(s[0]) != "Separation"):
        names = [name_of(n) for n in colorants(space)]
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
    kind = name_of(space if is_name(space) else space[0])
    if kind != "ICCBased":
        return kinds[kind], ""
    icc = folder / f"alternate-{number}.icc"
    icc.write_bytes(stream_bytes(space[1], MOST_PROFILE))
    return {1: "GRAY", 3: "RGB", 4: "CMYK"}[int(space[1]["/N"])], icc.name


def output_intent(pdf: Any, page: Any) -> tuple[Any, str]:
    """The stream of the output intent's CMYK profile, or None; and the condition's name.

    An intent of the page goes before those of the document (14.11.5).
    """
    name = ""
    listed = [*page.obj.get("/OutputIntents", []), *pdf.Root.get("/OutputIntents", [])]
    for intent in listed[:20]:
        name = name or str(intent.get("/OutputConditionIdentifier", ""))
        stream = intent.get("/DestOutputProfile")
        if stream is not None and int(stream.get("/N", 0)) == 4:
            return stream, name
    return None, name


def trim(page: Any) -> tuple[float, float, float]:
    """Make the trim box the whole page; its printed width and height, points, and its unit."""
    media = _box(inherited(page.obj, "/MediaBox") or [0, 0, 612, 792])
    trimmed = page.obj.get("/TrimBox")
    if trimmed is None:
        trimmed = inherited(page.obj, "/CropBox")
    box = media if trimmed is None else _box(trimmed)
    # What lies beyond the medium is no part of the page (14.11.2.1).
    x0, y0 = max(box[0], media[0]), max(box[1], media[1])
    x1, y1 = min(box[2], media[2]), min(box[3], media[3])
    unit = float(page.obj.get("/UserUnit", 1.0))
    width, height = (x1 - x0) * unit, (y1 - y0) * unit
    if not (min(width, height) >= 0.1 and max(width, height) <= MOST_SIDE_PT):
        raise ValueError("a page without a size that can be printed")
    for key in ("/TrimBox", "/BleedBox", "/ArtBox", "/UserUnit"):
        if key in page.obj:
            del page.obj[key]
    page.obj["/MediaBox"] = page.obj["/CropBox"] = [x0, y0, x1, y1]
    turned = int(inherited(page.obj, "/Rotate") or 0) % 180 == 90
    return (height, width, unit) if turned else (width, height, unit)


def _box(values: Any) -> tuple[float, float, float, float]:
    """A rectangle with its lower left corner first; its corners may be any two opposite ones."""
    numbers = [float(v) for v in values]
    if len(numbers) != 4:
        raise ValueError("a box that is not of four numbers")
    x0, x1 = sorted(numbers[0::2])
    y0, y1 = sorted(numbers[1::2])
    return x0, y0, x1, y1


def _rename(page: Page, keys: dict[str, str]) -> None:
    import pikepdf

    for space in page.spaces:
        if name_of(space[0]) == "Separation":
            name = name_of(space[1])
            if name in keys:
                space[1] = pikepdf.Name("/" + keys[name])
            continue
        for k, one in enumerate(list(space[1])):
            if name_of(one) in keys:
                space[1][k] = pikepdf.Name("/" + keys[name_of(one)])
        if len(space) > 4:
            attributes = space[4]
            if "/MixingHints" in attributes:
                del attributes["/MixingHints"]
            if "/Colorants" in attributes:
                old = attributes["/Colorants"]
                named_now = {"/" + keys.get(name_of(k), name_of(k)): v for k, v in old.items()}
                named_now.pop("/None", None)
                attributes["/Colorants"] = pikepdf.Dictionary(named_now)


def examine(
    path: str, number: int, folder: Path, has_profile: bool, plates: list[str]
) -> dict[str, Any]:
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
            raise InputError(f"{named(path)}: page {number} is not there; give --page 1 to {count}")
        source = pdf.pages[number - 1]
        page = Page(pdf, source)
        steps = processing_steps(pdf)
        by_layer = steps_of_colorants(page, steps) if steps else {}
        width, height, unit = trim(source)
        looks = alternates(page, folder)
        names = list(
            dict.fromkeys(
                name_of(n)
                for space in page.spaces
                for n in colorants(space)
                if name_of(n) not in (*PROCESS, "All", "None")
            )
        )
        if len(names) > MOST_NAMES:
            raise InputError(f"{named(path)}: {len(names)} spot colours; at most {MOST_NAMES}")
        technical = [n for n in names if n in by_layer or is_technical(n)]
        finishes = [n for n in finishing_plates(names, plates) if n not in technical]
        technical += finishes
        stream, condition = output_intent(pdf, source)
        if stream is None and not has_profile and len(page.profiles) == 1:
            stream = page.profiles[0]
        profile = ""
        if stream is not None:
            profile = "intent.icc"
            (folder / profile).write_bytes(stream_bytes(stream, MOST_PROFILE))
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
        "pages": count, "size_pt": [width, height], "unit": unit, "names": keys,
        "technical": technical, "finishes": finishes, "repaired": bool(pdf.get_warnings()),
        "layers": by_layer, "alternates": looks, "profile": profile, "condition": condition,
        "cmyk": cmyk, "fonts": sorted(page.fonts), "off": off,
    }  # fmt: skip


def _paints_cmyk(page: Page) -> bool:
    left = MOST_CONTENT
    for content, _ in page.contents:
        parts = list(content) if is_array(content) else [content]
        for part in parts:
            end = b""
            for piece in pieces(part, left):
                left -= len(piece)
                piece_and_end = end + piece
                if b"CMYK" in piece_and_end or _CMYK_OPERATOR.search(piece_and_end):
                    return True
                end = piece[-_LONGEST_WORD:]
    return False


def _switched_off(pdf: Any, steps: dict[tuple[int, int], str]) -> list[str]:
    off = pdf.Root.get("/OCProperties", {}).get("/D", {}).get("/OFF", [])
    return [printable(str(one.get("/Name", ""))) for one in off if one.objgen in steps]


def answer(
    path: str, number: int, folder: Path, *, has_profile: bool, plates: list[str]
) -> dict[str, Any]:
    """What examine finds, or 'error' with one line, whatever is wrong with the file."""
    logger = logging.getLogger("pikepdf")  # it warns of what it mends
    if not logger.handlers:
        logger.addHandler(logging.NullHandler())
    try:
        found = examine(path, number, folder, has_profile, plates)
    except InputError as error:
        return {"error": str(error)}
    except Exception as error:
        words = str(error).partition(">: ")[2] or str(error).replace(path, "").strip(" :")
        reason = printable(words, 120)
        if not reason or isinstance(error, AttributeError | TypeError | LookupError):
            reason = "an entry is of a wrong kind"
        remedy = "open it in its program, export it again"
        return {"error": f"{named(path)}: a damaged PDF ({reason}); {remedy}"}
    if not all(math.isfinite(v) for v in found["size_pt"]):
        return {"error": f"{named(path)}: a page without a size; export it again"}
    return found


def main(words: list[str]) -> None:
    """Print the answer as JSON."""
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, MOST_MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (int(words[4]), int(words[4]) + 1))
    except (ImportError, ValueError, OSError):  # Windows, or a limit that is lower already
        pass
    path, number, folder, profile = words[:4]
    found = answer(
        path, int(number), Path(folder), has_profile=profile == "profile",
        plates=json.loads(words[5]),
    )  # fmt: skip
    print(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1:])
