"""Pages of a PDF as rasters: plates and colours by Ghostscript, names by what the page holds.

Ghostscript runs as a program (-dSAFER), as it is under the AGPL. Its device `tiffsep` gives every
plate with overprint. Process plates become colours by the profile of the printing condition; a spot
ink multiplies them by the colour of its alternate, relative to paper; finishes have no colour.
A page of RGB and gray alone, without such a profile, is rendered as sRGB instead.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from relgloss_view.base import followed
from relgloss_view.base.arrays import Bytes, Floats
from relgloss_view.base.child import PACKAGE_FOLDER, Child
from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import Profile, lab_space, read_profile
from relgloss_view.base.reading import decoding, named, open_regular, printable, read_beginning
from relgloss_view.base.temporaries import scratch_folder
from relgloss_view.base.terminal import ProgressReport, no_progress
from relgloss_view.pack.artwork.artwork import REPAIRED
from relgloss_view.pack.artwork.ghostscript import WAITING, Renderer, allowed_s, ghostscript
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.pictures import gray_of, profile_of_file, quiet_pillow
from relgloss_view.pack.artwork.plate_names import PROCESS
from relgloss_view.pack.artwork.raster import MM_PER_INCH, USUAL_DPI, Raster
from relgloss_view.pack.artwork.spaces import srgb

EXPECTED = "a PDF"
MOST_BYTES = 1_000_000_000  #: of a PDF
MOST_SPOTS = 60  #: beside the four process colours, Ghostscript's limit being 64
MOST_PLANE_PIXELS = 300_000_000  #: of all plates together; they are held in memory
_MODULE = "relgloss_view.pack.artwork.pdf_examination"
_LAB_ZERO, _LAB_SPAN = np.array([0.0, 128.0, 128.0]), np.array([100.0, 255.0, 255.0])
_POSTSCRIPT = (b"%!PS", b"\xc5\xd0\xd3\xc6", b"\x04%!PS")


def read_pdf(
    path: str | os.PathLike[str], options: ArtworkOptions, progress: ProgressReport
) -> Raster:
    """The raster of a page, trimmed. Raises InputError with one line."""
    program = ghostscript(path)
    with open_regular(path, EXPECTED) as file:
        size = os.fstat(file.fileno()).st_size
    if size > MOST_BYTES:
        raise InputError(
            f"{named(path)}: larger than {MOST_BYTES // 1_000_000} MB; export it smaller"
        )
    own = profile_of_file(options.profile) if options.profile else None
    has_cmyk = own is not None and own.space == "CMYK"
    with scratch_folder() as folder, decoding(path, EXPECTED):
        source = Path(path)
        budget_s = allowed_s(size)
        renderer = Renderer(program, folder, path, budget_s)
        if read_beginning(path, 4, EXPECTED) in {mark[:4] for mark in _POSTSCRIPT}:
            source = _as_pdf(renderer, source, folder, progress)
        page = examined(
            source, options.page, folder, has_cmyk,
            shown=path, plates=options.finish_plates, budget_s=budget_s, progress=progress,
        )  # fmt: skip
        profile = _profile(page, own, options, folder, path)
        if len(page["names"]) > MOST_SPOTS:
            raise InputError(
                f"{named(path)}: {len(page['names'])} spot colours on a page; Ghostscript "
                f"separates at most {MOST_SPOTS}: remove unused ones"
            )
        return _rendered(renderer, page, profile, options, folder, progress)


def missing_fonts(path: str | os.PathLike[str], page: int = 1) -> tuple[str, ...]:
    """Fonts of a PDF's page that are not embedded, so that another one may be drawn."""
    with scratch_folder() as folder, decoding(path, EXPECTED):
        budget_s = allowed_s(os.path.getsize(path))
        return tuple(examined(Path(path), page, folder, True, budget_s=budget_s)["fonts"])


def examined(
    path: Path,
    page: int,
    folder: Path,
    has_profile: bool,
    shown: str | os.PathLike[str] | None = None,
    *,
    plates: tuple[str, ...] = (),
    budget_s: float,
    progress: ProgressReport = no_progress,
) -> dict[str, Any]:
    """What pdf_examination.examine finds; InputError with its line.

    shown: the file's name. plates: spot colours that are finishes. budget_s: processor time that
    it may take.
    """
    search = os.pathsep.join(filter(None, (str(PACKAGE_FOLDER), os.environ.get("PYTHONPATH"))))
    words = [str(path), str(page), str(folder), "profile" if has_profile else "",
             str(math.ceil(budget_s)), json.dumps(plates)]  # fmt: skip
    child = Child(
        [sys.executable, "-m", followed.__name__, _MODULE, *words],
        followed=True,
        env={**os.environ, "PYTHONPATH": search},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    outcome = child.outcome(WAITING * budget_s, lambda: progress(0.1, "examining the PDF"))
    name = named(path if shown is None else shown)
    try:
        answer = json.loads(outcome.out)
    except ValueError:
        raise InputError(
            f"{name}: a damaged PDF, or one of too many parts; export it again"
        ) from None
    if "error" in answer:
        raise InputError(str(answer["error"]).replace(str(path), name))
    return dict(answer)


def _profile(
    page: dict[str, Any],
    own: Profile | None,
    options: ArtworkOptions,
    folder: Path,
    path: str | os.PathLike[str],
) -> Profile | None:
    """The CMYK profile of the page, else that of the options; None where none is needed."""
    if page["profile"]:
        try:
            profile = read_profile((folder / page["profile"]).read_bytes())
            if profile.space == "CMYK":
                return profile
        except ValueError as error:
            if own is None or own.space != "CMYK":
                raise InputError(
                    f"{named(path)}: the profile of its output intent can't be used ({error}); "
                    "name one with --profile FILE.icc"
                ) from None
    if own is not None and own.space == "CMYK":
        (folder / "intent.icc").write_bytes(_bytes_of(options.profile))
        return own
    if page["cmyk"]:
        meant = f" (its output intent names {page['condition']})" if page["condition"] else ""
        raise InputError(
            f"{named(path)}: CMYK without a profile{printable(meant, 80)}; name the ICC profile of "
            "its printing condition with --profile FILE.icc (in a pack file: profile)"
        )
    return None


def _bytes_of(path: str) -> bytes:
    with open_regular(path, "an ICC profile (.icc)") as file:
        return file.read()


def _rendered(
    renderer: Renderer,
    page: dict[str, Any],
    profile: Profile | None,
    options: ArtworkOptions,
    folder: Path,
    progress: ProgressReport,
) -> Raster:
    width_pt, height_pt = page["size_pt"]
    wanted = options.dpi or USUAL_DPI
    dpi = min(wanted, options.most_px * 72.0 / max(width_pt, height_pt))
    if math.ceil(max(width_pt, height_pt) * dpi / 72.0) > options.most_px:
        dpi = (options.most_px - 0.5) * 72.0 / max(width_pt, height_pt)
    dpi = max(dpi, 72.0 / min(width_pt, height_pt))
    planes = 4 + len(page["names"])
    pixels = width_pt * height_pt * (dpi / 72.0) ** 2
    fewer = math.sqrt(min(MOST_PLANE_PIXELS / (planes * pixels), 1.0))
    dpi *= fewer
    pixels *= fewer**2
    renderer.add(planes * pixels)
    _check_disk(folder, (planes + 4) * pixels, renderer.path)
    notes = _notes(page, profile)
    if fewer < 1.0:
        notes.append(
            f"The page has {planes} plates, so it is rendered at {dpi:.0f} dpi instead of "
            f"{wanted:g}."
        )
    elif dpi < wanted * 0.999:
        notes.append(
            f"The page is rendered at {dpi:.0f} dpi instead of {wanted:g}, for at most "
            f"{options.most_px} pixels a side."
        )
    words = [
        f"-r{dpi * page['unit']:.6f}",
        f"-dFirstPage={options.page}",
        f"-dLastPage={options.page}",
    ]
    separate = ["-sDEVICE=tiffsep", f"-dMaxSpots={max(len(page['names']), 1)}", *words]
    if profile is not None:
        # The same profile twice: CMYK stays as it is, and RGB is separated by it.
        separate += ["-sDefaultCMYKProfile=intent.icc", "-sOutputICCProfile=intent.icc"]
    plates: dict[str, Bytes] = {}
    samples: Bytes
    if profile is not None or page["names"]:
        renderer.run(
            [*separate, "-sOutputFile=plate.tif", "page.pdf"],
            lambda share, text: progress(0.15 + 0.6 * share, text),
        )
        for name, key in page["names"].items():
            made = folder / f"plate({key}).tif"
            if made.exists():
                plates[name] = _plate(made)
    if profile is not None:
        inks = [_plate(folder / f"plate({name}).tif") for name in PROCESS]
        samples = np.stack(inks, axis=2)
    else:
        colour = ["-sDEVICE=tiff24nc", *words]
        renderer.run(
            [*colour, "-sOutputFile=colour.tif", "colour.pdf"],
            lambda share, text: progress(0.75 + 0.2 * share, text),
        )
        samples = _pixels(folder / "colour.tif")
        profile = srgb()
    mm = MM_PER_INCH / 72.0
    spots = {name for name in plates if name not in page["technical"]}
    factors = {}
    if profile.space == "CMYK":
        factors = _factors(page, spots, profile, options.intent, folder, notes)
    width_mm = options.width_mm or width_pt * mm
    return Raster(
        samples,
        profile,
        plates=plates,
        width_mm=width_mm,
        height_mm=width_mm * height_pt / width_pt,
        inks=factors,
        coloured=frozenset(spots),
        finish_plates=frozenset(plates) & frozenset(page["finishes"]),
        notes=tuple(notes),
    )


def _notes(page: dict[str, Any], profile: Profile | None) -> list[str]:
    notes = []
    if page["repaired"]:
        notes.append(REPAIRED)
    if page["pages"] > 1:
        notes.append(f"The PDF has {page['pages']} pages; one is read (entry page).")
    if profile is not None:
        notes.append(f"Process colours by the profile {profile.description or 'of the file'!r}.")
    else:
        notes.append("The page has no CMYK and no output intent; its colours are taken as sRGB.")
    if page["technical"]:
        listed = ", ".join(page["technical"][:20])
        notes.append(f"Plates that print no colour: {printable(listed, 300)}.")
    notes += [
        f"Plate {printable(name, 60)!r} is one of a finish of the pack, so it prints no colour."
        for name in page["finishes"]
    ]
    for name, step in page["layers"].items():
        notes.append(f"Plate {printable(name, 60)!r}: its layer is marked {printable(step, 40)}.")
    notes += [
        f"Layer {printable(name, 60)!r} is switched off in the PDF, so it is empty."
        for name in page["off"]
    ]
    if page["fonts"]:
        listed = ", ".join(page["fonts"][:20])
        notes.append(f"Fonts that are not embedded: {printable(listed, 300)}.")
    return notes


def _factors(
    page: dict[str, Any],
    names: set[str],
    profile: Profile,
    intent: str,
    folder: Path,
    notes: list[str],
) -> dict[str, Floats]:
    """Factors of XYZ of spot inks by their digital values: of the alternate, relative to paper."""
    paper = profile.xyz(np.zeros((1, 4)), intent)[0]
    made: dict[str, Floats] = {}
    for name in sorted(names):
        look = page["alternates"].get(name)
        if look is None:
            notes.append(f"The colour of ink {printable(name, 60)!r} is unknown; it is left out.")
            continue
        xyz = _xyz_of(look, profile, intent, folder)
        tint = np.linspace(0.0, 1.0, len(xyz))[:, None]
        factors = xyz / np.maximum((1.0 - tint) * xyz[0] + tint * paper, 1e-6)
        at = np.arange(256) / 255.0
        made[name] = np.stack(
            [np.interp(at, tint[:, 0], factors[:, k]) for k in range(3)], axis=1
        ).astype(np.float32)
    return made


def _xyz_of(look: dict[str, Any], profile: Profile, intent: str, folder: Path) -> Floats:
    values = np.array(look["values"], np.float64)
    space = look["space"]
    if space == "Lab":
        return lab_space().xyz((values + _LAB_ZERO) / _LAB_SPAN)
    if look["icc"]:
        try:
            found = read_profile((folder / look["icc"]).read_bytes())
            if found.channels == values.shape[1]:
                return found.xyz(values, intent)
        except ValueError:
            pass
    if space == "CMYK":
        return profile.xyz(values, intent)
    return (srgb() if space == "RGB" else gray_of(srgb())).xyz(values)


def _check_disk(folder: Path, needed: float, path: str | os.PathLike[str]) -> None:
    """InputError where the plates would not find room; Ghostscript ends well on a full disk."""
    free = shutil.disk_usage(folder).free
    if needed > free:
        raise InputError(
            f"{named(path)}: its plates need {needed / 1e6:.0f} MB in the folder of temporary "
            f"files, where {free / 1e6:.0f} MB are free; free some, or give a coarser resolution "
            "(dpi)"
        )


def _pixels(path: Path) -> Bytes:
    from PIL import Image, UnidentifiedImageError

    try:
        with open_regular(path, "a picture") as file, quiet_pillow(), Image.open(file) as image:
            return np.array(image)
    except (UnidentifiedImageError, ValueError, OSError):
        raise InputError(
            f"{path.name}: Ghostscript did not write this plate whole; free some room in the "
            "folder of temporary files"
        ) from None


def _plate(path: Path) -> Bytes:
    """A plate of tiffsep, 255 where all of it prints."""
    return 255 - _pixels(path)


def _as_pdf(renderer: Renderer, source: Path, folder: Path, progress: ProgressReport) -> Path:
    """PostScript, EPS and old Illustrator files as a PDF whose colours are unchanged."""
    with open_regular(source, EXPECTED) as file, (folder / "source.ps").open("wb") as copy:
        shutil.copyfileobj(file, copy)
    words = ["-sDEVICE=pdfwrite", "-dEPSCrop", "-sColorConversionStrategy=LeaveColorUnchanged"]
    renderer.run(
        [*words, "-sOutputFile=source.pdf", "source.ps"],
        lambda share, _: progress(0.05 + 0.05 * share, "converting PostScript"),
    )
    return folder / "source.pdf"
