"""Every reader of files from outside, with small valid files that it reads: for mutated_inputs.py.

The files are made here, by the program's own writers where it has them. Files of the folder
../shared/data join them where that folder is present and they are small enough.
"""

from __future__ import annotations

import base64
import functools
import json
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import input_catalogue as exchanged
import numpy as np
from made_profiles import D50, assembled, calibration_tags, table_profile, xyz_tag

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset

SHARED = Path(__file__).resolve().parents[2] / "shared"
LONGEST_TABLE = 20_000  #: bytes of a real table, of which the first lines are enough
MESHES = ("obj", "ply", "stl", "glb", "gltf")
LARGEST_REAL = 130_000  #: bytes of a real file that is mutated; larger ones take long to read


@dataclass(frozen=True)
class Reader:
    """A reader and its valid files."""

    name: str
    suffix: str
    read: Callable[[Path], object]  #: what it returns is checked by `sound`
    seeds: Callable[[], list[bytes]]
    share: float = 1.0  #: of the inputs, relative to other readers
    may_ignore: bool = False  #: a reader that takes a damaged file for an absent one


def readers() -> dict[str, Reader]:
    """All readers by name."""
    listed = (
        Reader("measurement", ".csv", _measurement, _tables, 4.0),
        Reader("declared", ".csv", _declared, _tables, 2.0),
        Reader("bsdf", ".bsdf", _measurement, _bsdf, 1.0),
        Reader("zemax", ".bsdf", _measurement, _zemax, 1.0),
        Reader("bsdf-xml", ".xml", _measurement, _bsdf_xml, 1.0),
        Reader("rgl-spectral", ".bsdf", _measurement, _spectral_bsdf, 0.5),
        Reader("pbsdf", ".pbsdf", _measurement, _pbsdf, 0.5),
        Reader("speos", ".brdf", _measurement, _speos),
        Reader("ssdd", ".ssdd", _measurement, _ssdd),
        Reader("astm-e1392", ".astm", _measurement, _astm),
        Reader("alta", ".alta", _measurement, _alta),
        Reader("merl", ".binary", _measurement, _merl, 0.2),
        Reader("lamp", ".csv", _lamp, _lamps, 2.0),
        Reader("spectrum", ".csv", _spectrum, _spectra, 2.0),
        Reader("samples", ".txt", _samples, _sample_files, 2.0),
        Reader("estimate", ".txt", _estimate, _estimates, 0.5),
        Reader("material", ".json", _material, _materials, 3.0),
        Reader("scene", ".toml", _scene, _scenes, 3.0),
        *(Reader(f"mesh-{k}", f".{k}", _mesh, functools.partial(_meshes, k)) for k in MESHES),
        Reader("study", ".toml", _study, _studies, 2.0),
        Reader("presets", ".toml", _presets, _preset_files),
        Reader("layout", ".toml", _layout, _layouts, may_ignore=True),
        Reader("window", ".toml", _window, _scenes, may_ignore=True),
        Reader("kind", "", _kind, _any, 2.0),
        Reader("results", ".json", _results, _result_files, may_ignore=True),
        Reader("icc", ".icc", _icc, _profiles, 2.0),
        Reader("picture", ".png", _artwork, _pictures, 2.0),
        Reader("pdf", ".pdf", _pdf, _pdfs, 0.3),
        Reader("profile", ".icc", _profile, _device_profiles),
        Reader("display", ".icc", _display, _screens, 2.0),
        Reader("font", ".ttf", _font, _fonts),
        Reader("table", ".csv", _own_table, _own_tables, 0.5),
        Reader("session", ".sqlite", _session, _sessions, 2.0),
        Reader("proof", ".html", _proof, _proofs, 2.0),
        Reader("sealed", ".html", _sealed, _sealed_values, 2.0),
        Reader("tensor-tree", ".xml", _measurement, exchanged.tensor_trees),
        Reader("mtlx", ".mtlx", exchanged.described, exchanged.material_x),
        Reader("gltf-material", ".gltf", exchanged.described, exchanged.gltf_materials),
        Reader("own-block", ".mtlx", exchanged.own_block, exchanged.own_blocks),
        Reader("import", ".mtlx", exchanged.searched, _described_files, 0.02),
        Reader("store-item", ".json", exchanged.store_item, exchanged.records, may_ignore=True),
        Reader("catalogue", ".parquet", exchanged.catalogue_table, exchanged.tables_of_catalogues),
        Reader("recipe", ".json", exchanged.recipe, exchanged.recipes),
        Reader("mark", ".json", exchanged.marked, exchanged.marks, 0.2, may_ignore=True),
        Reader("query", ".txt", exchanged.query, exchanged.queries),
    )
    return {reader.name: reader for reader in listed}


def sound(result: object) -> str | None:
    """What is wrong with what a reader returned, or None: numbers that are not finite."""
    from relgloss_view.material.material import Material
    from relgloss_view.measure.screening import MOST_BODY, MOST_NOISE
    from relgloss_view.measure.spectrum import GEOMETRIES, ColourReading
    from relgloss_view.measure.table import Measurement
    from relgloss_view.pack.mesh import Mesh

    if isinstance(result, Mesh):
        arrays = (result.points_m, result.normals, result.label_m)
        if not all(np.isfinite(values).all() for values in arrays):
            return "a number of the mesh is not finite"
        if not np.allclose(np.linalg.norm(result.normals, axis=1), 1.0):
            return "a normal is no unit vector"
        if not (len(result.triangles) and 0.0005 <= result.half_extent_m.max() <= 5.0):
            return "a mesh without triangles or of a size beyond any pack"
        if not 0 <= result.triangles.min() <= result.triangles.max() < len(result.points_m):
            return "a triangle names a point that there is not"
    if isinstance(result, ColourReading):
        factor, nm = result.radiance_factor, np.array(result.bands.wavelengths_nm)
        if not (np.isfinite(factor).all() and (factor >= 0.0).all() and factor.max() <= MOST_BODY):
            return "a reflectance is negative, not finite or above that of any surface"
        if factor.shape != nm.shape or (np.diff(nm) <= 0.0).any() or len(nm) < 2:
            return "the wavelengths do not fit the reflectances"
        if nm[0] < 360.0 or nm[-1] > 830.0 or np.diff(nm).max() > 50.0:
            return "the wavelengths are not those of a colour"
        if result.geometry not in (*GEOMETRIES, None):
            return "a geometry that there is not"
    if isinstance(result, Measurement):
        kept = result.radiance_factor[result.kept]
        # Readings this far below zero are noise about zero; a channel of linear RGB has none.
        least = 0.0 if result.bands.is_rgb else -MOST_NOISE
        if not (np.isfinite(kept).all() and (kept >= least).all() and len(kept)):
            return "a kept reading is negative or not finite"
        if kept.max() > 1e14:
            return "a kept reading is beyond any surface"
        for directions in (result.to_lamp, result.to_receiver):
            if not np.allclose(np.linalg.norm(directions, axis=1), 1.0):
                return "a direction is no unit vector"
            if not (directions[result.kept, 2] > 0.0).all():
                return "a kept direction is below the horizon"
        if kept.shape[1] != result.bands.count or len(result.group) != len(result.reasons):
            return "the arrays of a measurement do not fit each other"
    if isinstance(result, ShownByMonitor):
        return result.fault()
    if isinstance(result, Material):
        numbers = [*result.diffuse.albedo, *(s for lobe in result.specular for s in lobe.strength)]
        if not np.isfinite(numbers).all():
            return "a number of the material is not finite"
    return None


# What reads


def _measurement(path: Path) -> object:
    from relgloss_view.measure.readers import read_measurement

    return read_measurement(path, quantity="brdf-cos", part="1")


def _declared(path: Path) -> object:
    from relgloss_view.measure.readers import read_measurement

    return read_measurement(path)


def _lamp(path: Path) -> object:
    from relgloss_view.material.spectra import illuminant

    return illuminant(str(path))


def _spectrum(path: Path) -> object:
    from relgloss_view.measure.readers.spectrum import read_spectrum

    return read_spectrum(path, part="2")


def _mesh(path: Path) -> object:
    from relgloss_view.pack.forms.mesh_files import read_mesh

    return read_mesh(path)


def _samples(path: Path) -> object:
    from relgloss_view.measure.readers import read_measurement
    from relgloss_view.measure.readers.spectrum import read_spectrum

    try:
        return read_measurement(path, part="1")
    except InputError:
        return read_spectrum(path, part="1")


def _estimate(path: Path) -> object:
    """The arguments of `relgloss estimate`, one a line: --gloss, --gloss-error, --lab."""
    import argparse

    from relgloss_view.commands.estimate import _colour, gloss_readings_of
    from relgloss_view.fitting.estimate.colour import colour_of

    gloss, error, lab = (*path.read_text("utf-8", "replace").split("\n"), "", "")[:3]
    args = argparse.Namespace(lab=lab, spectrum=None, lab_illuminant=None, part=None)
    try:
        readings = gloss_readings_of(gloss, float(error) if error else None)
        return readings, colour_of(_colour(args))
    except InputError as error_of_word:
        raise InputError(f"{path}: {error_of_word}") from None
    except ValueError as error_of_number:
        if "could not convert" not in str(error_of_number):
            raise
        raise InputError(f"{path}: argparse refuses it") from None


def _material(path: Path) -> object:
    from relgloss_view.material.files import load_material

    return load_material(path)


def _scene(path: Path) -> object:
    from relgloss_view.viewer.state.state_file import load_state

    return load_state(path)


def _study(path: Path) -> object:
    from relgloss_view.experiment.design.study_file import load_study, study_to_dict

    return study_to_dict(load_study(path))


def _presets(path: Path) -> object:
    from relgloss_view.viewer.state import presets

    return presets.load(path)


def _layout(path: Path) -> object:
    from relgloss_view.viewer.state.layout_file import load_layout

    return load_layout(path)


def _window(path: Path) -> object:
    from relgloss_view.viewer.state.session import restore

    restored = restore(path)
    for aside in path.parent.glob(f"{path.stem}-damaged*"):
        aside.unlink()
    return restored


def _kind(path: Path) -> object:
    from relgloss_view.picture.scene.file_kinds import likely_kind

    return likely_kind(path)


def _results(path: Path) -> object:
    from relgloss_view.commands.output_folder import own_folder
    from relgloss_view.experiment.report import folder

    target = path.parent / folder.RESULTS
    target.write_bytes(path.read_bytes())
    folder.earlier_files(path.parent)
    try:
        own_folder(str(path.parent), {folder.RESULTS: "relgloss-experiment"}, "experiment")
    finally:
        target.unlink()
    return None


def _icc(path: Path) -> object:
    from relgloss_view.viewer.trials.device import read_profile

    return read_profile(path)


def _artwork(path: Path) -> object:
    from relgloss_view.pack.artwork.options import ArtworkOptions
    from relgloss_view.pack.artwork.read import read_artwork

    if b"%PDF-" in path.read_bytes()[:1024] or path.read_bytes()[:2] == b"%!":
        raise InputError(f"{path}: a PDF, which starts programs")
    return read_artwork(path, ArtworkOptions(most_px=64))


def _pdf(path: Path) -> object:
    """What a page holds, in this process; `read_artwork` starts another one and Ghostscript."""
    import tempfile

    from relgloss_view.pack.artwork import pdf_examination

    with tempfile.TemporaryDirectory() as folder:
        answer = pdf_examination.answer(str(path), 1, Path(folder), has_profile=False, plates=[])
    if "error" in answer:
        raise InputError(answer["error"])
    return None


@dataclass(frozen=True)
class ShownByMonitor:
    """A monitor's numbers, its light of digital values, and the digital values of light."""

    numbers: list[float]
    light: np.ndarray
    digital: np.ndarray
    additive: bool

    def fault(self) -> str | None:
        """What is wrong with them, or None."""
        if not (np.isfinite(self.numbers).all() and np.isfinite(self.light).all()):
            return "a number or a light of the monitor is not finite"
        if self.additive and not (self.light.min() >= 0.0 and self.light.max() <= 1.0):
            return "a light of a curve is not between 0 and 1"
        if not (self.digital.min() >= 0.0 and self.digital.max() <= 1.0):
            return "a digital value is not finite or not between 0 and 1"
        return None


def _display(path: Path) -> object:
    from relgloss_view.display.read import monitor_of

    monitor = monitor_of(str(path))
    axis = np.linspace(0.0, 1.0, 5)
    colours = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    numbers = [*monitor.white, *monitor.xyz_from_rgb.ravel(), *monitor.floor]
    numbers += [] if monitor.luminance_cd_m2 is None else [monitor.luminance_cd_m2]
    numbers += [] if monitor.calibration is None else [*monitor.calibration.ravel()]
    light = monitor.emission.light(colours)
    wide = np.concatenate([colours**2, 1.4 * colours - 0.2])
    return ShownByMonitor(
        numbers, light, monitor.emission.digital(wide), monitor.emission.kind == "curves"
    )


def _profile(path: Path) -> object:
    from relgloss_view.pack.artwork.pictures import profile_of_file

    profile = profile_of_file(path)
    xyz = profile.xyz(np.full((2, profile.channels), 0.5))
    if not np.isfinite(xyz).all():
        raise ValueError("a colour that is not finite")
    return None


def _font(path: Path) -> object:
    from relgloss_view.base.fonts import FontFile, _characters, _height_em

    file = FontFile(str(path))
    return _characters.__wrapped__(file), _height_em.__wrapped__(file)


def _own_table(path: Path) -> object:
    from relgloss_view.base.csv_files import read_csv

    return read_csv(path)


def _session(path: Path) -> object:
    from relgloss_view.experiment.session.pool import read_pool

    try:
        return read_pool([path], path.parent)
    finally:
        for beside in path.parent.glob(f"{path.name}-*"):
            beside.unlink()
        for lamp in path.parent.glob("lamp-*.csv"):
            lamp.unlink()


def _proof(path: Path) -> object:
    """All of a proof but its pictures: seal, thread, fields, files, scene, its page again."""
    from relgloss_view.proof.check import foreign_parts
    from relgloss_view.proof.read import proof_of, read_page
    from relgloss_view.proof.unpack import opened

    page = read_page(path)
    try:
        proof = proof_of(page)
        with opened(proof) as one:
            return foreign_parts(page, proof), one.pair()
    except InputError as error:
        raise InputError(f"{path}: {error}") from error


def _sealed(path: Path) -> object:
    """A proof whose sealed JSON is the file, sealed again as anybody can."""
    from relgloss_view.proof.page.parts import joined, load, script_json
    from relgloss_view.proof.proof import digests_of

    texts = dict(_page_texts())
    try:
        values = load(path.read_text("utf-8", "surrogateescape"))
        texts["proof"] = script_json(values)
        html = joined(texts, digests_of(values)[-1])
    except (InputError, AttributeError, IndexError, KeyError, TypeError, ValueError):
        raise InputError(f"{path}: no JSON that can be sealed") from None
    path.write_text(html, encoding="utf-8", newline="\n")
    return _proof(path)


# Valid files


@functools.cache
def _small_proof() -> Any:
    """A proof of two papers whose pictures are of one pixel."""
    import io
    import tempfile

    from PIL import Image

    from relgloss_view.picture.scene.look import viewed_look
    from relgloss_view.picture.scene.sample import Sample
    from relgloss_view.picture.scene.scene_file import SceneFile
    from relgloss_view.picture.scene.setting import Setting
    from relgloss_view.picture.scene.setup import Setup
    from relgloss_view.proof.carry import carried, files_of
    from relgloss_view.proof.content import display_words
    from relgloss_view.proof.meter import meter_of
    from relgloss_view.proof.pair import Pair
    from relgloss_view.proof.proof import Message, Proof

    look = viewed_look()
    scene = SceneFile(
        Sample.built_in("matte-coated"), look.at(Setting(2.0, c=0.37)), Setup(),
        Sample.built_in("cast-coated"), look.at(Setting(0.0, c=0.14)),
    )  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        pair = Pair.of(carried(scene, Path(folder), artwork_px=16).scene)
        files = files_of(Path(folder))
    memory = io.BytesIO()
    Image.new("RGB", (1, 1)).save(memory, "WEBP")
    picture = base64.b64encode(memory.getvalue()).decode("ascii")
    points = {"lab": [[50.0, 1.5, -2.5]], "l_d": [50.0], "l_s": [10.0]}
    content = {
        "title": "made", "size_px": [1, 1], "files": files, "meter": meter_of(pair),
        "display": display_words(Setup().display),
        "grid": {"columns": 1, "rows": 1, "sides": dict.fromkeys(("reference", "test"), points)},
        "pictures": dict.fromkeys(("reference", "test"), picture),
        "drawing": {"stages": [], "sides": {}},
    }  # fmt: skip
    first = Message(pair.settings, "Enough?", "Aya", "2026-11-27T08:30:00Z", "relgloss 1")
    proof = Proof(content, (first,))
    return proof.answered(Message(pair.settings, "Yes\n<b>", "Bo", screen={"gamma": 2.2}))


@functools.cache
def _page_texts() -> dict[str, str]:
    """The parts of its page, with a style and a program of one line, so that many are read."""
    from relgloss_view.proof.page.parts import split
    from relgloss_view.proof.page.whole import page_of

    return split(page_of(_small_proof())) | {"style": "b {}", "script": "1;", "shaders": "{}"}


def _proofs() -> list[bytes]:
    from relgloss_view.proof.page.parts import joined

    return [joined(_page_texts(), _small_proof().digest).encode()]


def _sealed_values() -> list[bytes]:
    from relgloss_view.proof.proof import canonical

    return [canonical(_small_proof().as_json())]


def _real(*patterns: str) -> list[bytes]:
    """Files below SHARED, where it is present; of large tables the first lines."""
    made = []
    for file in (file for pattern in patterns for file in sorted(SHARED.glob(pattern))):
        data = file.read_bytes()
        if file.suffix == ".csv" and len(data) > LONGEST_TABLE:
            data = b"\n".join(data.split(b"\n")[:60])
        if len(data) <= LARGEST_REAL:
            made.append(data)
    return made


def _tables() -> list[bytes]:
    angles = [(a, b, g) for a in (-60, -30, -10) for b in (0, 20, 50) for g in (0, 5, 15, 30)]
    head = "# name: made\n# source: made\n# quantity: radiance-factor\n# gamma_s_deg: 15\n"
    gcms = head + "alpha_deg,beta_deg,gamma_deg,400,500,600,700\n"
    gcms += "".join(f"{a},{b},{g},0.1,0.25,{0.3 + 0.01 * g:g},0.4\n" for a, b, g in angles)
    generic = (
        "# quantity: brdf\ntheta_i_deg\tphi_i_deg\ttheta_r_deg\tphi_r_deg\tR\tG\tB\n"
        + "".join(
            f"{i}\t0\t{r}\t{p}\t0.2\t0.3\t{0.1 + r / 500:g}\n"
            for i in (0, 20, 45, 70)
            for r in (5, 25, 45, 65)
            for p in (0, 90, 180)
        )
    )
    spaces = "Measured by hand\n\n" + generic.replace("\t", "   ")
    commas = generic.replace("\t", ";").replace(".", ",")
    quoted = "sep=,\n" + generic.replace("\t", '","').replace("\n", '"\n"')[:-1]
    beginning = b"\n".join(asset("papers", "uncoated.csv").read_bytes().splitlines()[:60])
    texts = [text.encode() for text in (gcms, generic, spaces, commas, quoted)]
    wide = [generic.encode("utf-16"), gcms.encode("utf-16-le"), ("°µ\n" + gcms).encode("cp1252")]
    real = _real("data/gonio/*.csv", "cases/c*.csv", "cases/c*.txt")
    return [*texts, *wide, *_other_tables(gcms, generic), beginning, *real]


def _other_tables(gcms: str, generic: str) -> list[bytes]:
    """The tables as R, pandas and spreadsheets write them, and one reading a row."""
    head, *rows = generic.replace("\t", ",").splitlines()[1:]
    pandas = f"# quantity: brdf\n,{head}\n" + "".join(f"{k},{row}\n" for k, row in enumerate(rows))
    names = ",".join(f'"{name}"' for name in head.split(","))
    r = f"# quantity: brdf\n{names}\n" + "".join(
        f'"{k}",{row}\n' for k, row in enumerate(rows, start=1)
    )
    angles = "Theta_i [deg];Phi_i [deg];Theta_r [deg];Phi_r [deg]"
    long = f"# quantity: brdf\n{angles.replace(';', ',')},Wavelength [nm],BRDF [1/sr]\n"
    long += "".join(
        f"{row.rsplit(',', 3)[0]},{nm},{0.1 + nm / 4000:g}\n"
        for row in rows
        for nm in (450, 550, 650)
    )
    one = f"# quantity: brdf\n{angles.replace(';', ',')},BRDF\n"
    one += "".join(f"{row.rsplit(',', 2)[0]}\n" for row in rows)
    data = [row for row in gcms.splitlines() if row.startswith("-")]
    percent = (
        "# gamma_s_deg: 15\nalpha_deg,beta_deg,gamma_deg,R400 [%],R500 [%],R600 [%],R700 [%]\n"
    )
    percent += "".join(f"{row}\n" for row in data).replace(",0.", ",")
    units = "Report;of a scan;;\n;;\nquantity;brdf;;\n" + angles.replace(" [deg]", "")
    units += ";400;500;600\ndeg;deg;deg;deg;1/sr;1/sr;1/sr\n"
    units += "".join(f"{row};;\n".replace(",", ";").replace(".", ",") for row in rows)
    units += ";;;;;;;\nmean;;;;0,1;0,2;0,3\nMeasured by X\n"
    several = f"# quantity: brdf\nsample,date,{head.replace('R,G,B', '400nm,500nm,600nm')}\n"
    several += "".join(f"{name},2024-05-01,{row}\n" for name in ("a", "b") for row in rows[:24])
    texts = [pandas, r, long, one, percent, units, several]
    return [text.encode() for text in texts] + [units.encode("utf-16"), r.encode("utf-16-le")]


def bsdf_of(fields: dict[str, np.ndarray[Any, Any]]) -> bytes:
    """A file in the container of the RGL database."""
    codes = {"uint8": 1, "uint16": 3, "float32": 10, "float64": 11}
    directory, offset = 18 + sum(13 + len(n) + 8 * v.ndim for n, v in fields.items()), 0
    head, body = b"tensor_file\0" + bytes((1, 0)) + struct.pack("<I", len(fields)), b""
    for name, values in fields.items():
        head += struct.pack("<H", len(name)) + name.encode()
        head += struct.pack("<HBQ", values.ndim, codes[str(values.dtype)], directory + offset)
        head += struct.pack(f"<{values.ndim}Q", *values.shape)
        body += values.tobytes()
        offset = len(body)
    return head + body


def _bsdf() -> list[bytes]:
    return [bsdf_of(_bsdf_fields())]


def _spectral_bsdf() -> list[bytes]:
    fields = _bsdf_fields()
    rgb = fields.pop("rgb")
    fields["wavelengths"] = np.linspace(370.0, 790.0, 12, dtype=np.float32)
    fields["spectra"] = np.repeat(rgb, 4, axis=2)
    return [bsdf_of(fields)]


def _pbsdf() -> list[bytes]:
    axis = np.linspace(0.0, 1.5, 5, dtype=np.float32)[None]
    fields: dict[str, np.ndarray[Any, Any]] = {
        "phi_d": np.linspace(-3.0, 3.0, 7, dtype=np.float32)[None],
        "theta_d": axis,
        "theta_h": axis,
        "wvls": np.array([450, 500, 550, 600, 650], np.uint16),
        "M": np.random.default_rng(0).uniform(0.1, 0.3, (7, 5, 5, 5, 4, 4)).astype(np.float32),
    }
    return [bsdf_of(fields)]


def _speos() -> list[bytes]:
    rows = [f"{theta}" + "\t0.2" * 5 + "\n" for theta in range(0, 91, 10)]
    block = f"{len(rows)}\t5\n\t0\t90\t180\t270\t360\n" + "".join(rows)
    spectrum = "10\t0\n\n3\n400\t20\n550\t40\n700\t10\n"
    head = "0\nmade\n5\n-----\n"
    by_spectrum = f"OPTIS - Anisotropic BSDF surface file v8.0\n{head}1\t0\t0\n1\t0\n0\n1\n0\n"
    by_spectrum += f"2\n10\t40\n{spectrum}{block}{block}End of file\n"
    by_wavelength = f"OPTIS - brdf surface file v8.0\n{head}1\t0\n1\n2\t2\n10\t40\n500\t600\n"
    by_wavelength += f"20\n{block}" * 4
    return [by_spectrum.encode(), by_wavelength.encode()]


def _bsdf_fields() -> dict[str, np.ndarray[Any, Any]]:
    rng = np.random.default_rng(0)

    def positive(*shape: int) -> np.ndarray[Any, Any]:
        return rng.uniform(0.1, 1.0, shape).astype(np.float32)

    return {
        "description": np.frombuffer(b"made", np.uint8),
        "phi_i": np.zeros(1, np.float32),
        "theta_i": np.linspace(0.0, 1.5, 4, dtype=np.float32),
        "ndf": positive(2, 8),
        "sigma": positive(2, 8),
        "vndf": positive(1, 4, 6, 6),
        "rgb": positive(1, 4, 3, 6, 6),
        "luminance": positive(1, 4, 6, 6),
        "jacobian": np.ones(1, np.uint8),
    }


def _ssdd() -> list[bytes]:
    made = []
    for kind, polar in (("spherical", 60), ("specular", 30), ("half_difference", 20)):
        head = (
            "# made\nVERSION 0.2\nAPI libbsdf-1.0.0\nDATA_TYPE brdf\nCOLOR_MODEL {}\n"
            f"PARAM_TYPE {kind}_coordinate_system\nREDUCTION_TYPE bilateral_symmetry\n"
            f"PARAM0_LIST 0 {polar}\nPARAM2_LIST 0 10\nPARAM3_LIST 0 90 180\n"
            + ("PARAM4_LIST 0 -2.5\n" if kind == "specular" else "")
            + "NAME card\nSOURCE_TYPE measured\nDEVICE GCMS-4\nDATA "
        )
        rows = "".join(f"0.{k} 0.2 0.3\n# PARAM2: 10\n" for k in range(1, 13))
        made.append((head.format("rgb") + "ascii\n" + rows).encode())
        spectral = head.format("spectrum\nWAVELENGTH_LIST 400 500 600") + "binary\n"
        table = np.linspace(0.1, 0.5, 36, dtype="<f4").tobytes()
        behind = b"\nDATA_TYPE specular_reflectance\nCOLOR_MODEL xyz\nDATA ascii\n1 1 1\n"
        made.append(spectral.encode() + table + behind)
    return made


def _astm() -> list[bytes]:
    angles = [(i, p, s) for i in (0.1, 0.6) for p in (0.0, 1.5, 3.1) for s in (0.2, 0.5)]
    files = []
    for names, values in (("R,G,B", "0.1,0.2,-0.01"), ("450nm,550nm", "0.1,0.2"), ("BRDF", "1")):
        head = f"TITLE made\nSAMPLE card\nNUM_POINTS 12\nVARS theta_i,phi_i,theta_s,phi_s,{names}\n"
        files.append(head + "".join(f"{i},3.14159,{s},{p},{values}\n" for i, p, s in angles))
    degrees = files[2].replace("TITLE", "ANGLE_UNIT degrees\nTITLE").replace(",", " ")
    return [text.encode() for text in (*files, degrees)]


def _alta() -> list[bytes]:
    files = []
    for name, count in (("RUSIN_TH_TD_PD", 3), ("STARK_3D", 3), ("SPHERICAL_TL_PL_TV_PV", 4)):
        head = f"# made\n#DIM {count} 3\n#PARAM_IN  {name}\n#PARAM_OUT RGB_COLOR\n#VS 2\n"
        rows = ("\t".join(["0.2", "0.1", "0.3", "0.4"][:count]), "\t".join(["0"] * count))
        files.append(head + "".join(f"{row}\t0.1\t0.2\t0.3\t0.1\t0.4\t\n" for row in rows * 3))
    gray = files[0].replace("#DIM 3 3", "#DIM 3 1").replace("RGB_COLOR", "INV_STERADIAN")
    cartesian = "#DIM 6 1\n#PARAM_IN CARTESIAN\n#PARAM_OUT INV_STERADIAN_COSINE_FACTOR\n"
    return [text.encode() for text in (*files, gray, cartesian + "0 0 1 0.6 0 0.8 0.5\n")]


def _zemax() -> list[bytes]:
    head = (
        "#made\nSource Measured\nSymmetry PlaneSymmetrical\nSpectralContent {}\nScatterType BRDF\n"
        "SampleRotation 1\n0\nAngleOfIncidence 2\n20 60\nScatterAzimuth 3\n0 90 180\n"
        "ScatterRadial 3\n0 10 40\n\n"
    )
    rows = "TIS 0.3\n" + "0.2\t0.1\t0.05\n" * 3
    data = "\nDataBegin\n" + 2 * rows + "DataEnd\n"
    colour = "".join(f"Tristimulus{c}{data}" for c in "XYZ")
    texts = [head.format("Monochrome") + "Monochrome" + data, head.format("XYZ") + colour]
    made = [text.encode() for text in texts]
    return [*made, *_real("data/formats/*zemax.bsdf", "cases/*zemax.bsdf")]


def _bsdf_xml() -> list[bytes]:
    ring = "<AngleBasisBlock><Theta>{2}</Theta><nPhis>{3}</nPhis><ThetaBounds><LowerTheta>{0}"
    ring += "</LowerTheta><UpperTheta>{1}</UpperTheta></ThetaBounds></AngleBasisBlock>"
    rings = ring.format(0, 30, 0, 1) + ring.format(30, 70, 50, 6)
    blocks = "".join(
        f"<WavelengthData><Wavelength unit='Integral'>{band}</Wavelength><WavelengthDataBlock>"
        f"<WavelengthDataDirection>Reflection {side}</WavelengthDataDirection><ColumnAngleBasis>two"
        "</ColumnAngleBasis><RowAngleBasis>two</RowAngleBasis><ScatteringDataType>BRDF"
        f"</ScatteringDataType><ScatteringData>{'0.1, 0.2,0.3 0.4 0.5 0.6 0.7 ' * 7}"
        "</ScatteringData></WavelengthDataBlock></WavelengthData>"
        for band in ("Visible", "CIE-X", "CIE-Z", "500")
        for side in ("Front", "Back")
    )
    text = (
        "<?xml version='1.0' encoding='{0}'?>\n<WindowElement xmlns='http://windows.lbl.gov'>"
        "<Optical><Layer><Material><Name>made</Name></Material><DataDefinition>"
        "<IncidentDataStructure>Columns</IncidentDataStructure><AngleBasis><AngleBasisName>two"
        f"</AngleBasisName>{rings}</AngleBasis></DataDefinition>{blocks}</Layer></Optical>"
        "</WindowElement>"
    )
    made = [text.format("UTF-8").encode(), text.format("UTF-16").encode("utf-16")]
    real = _real("data/formats/*.XML")
    return [*made, *real[:1], *(data.replace(b"Transmission", b"Reflection") for data in real)]


def _merl() -> list[bytes]:
    return [np.array((90, 90, 180), "<i4").tobytes() + bytes(8 * 1000)]


def _lamps() -> list[bytes]:
    spectra = [asset("spectra", f"{name}.csv").read_bytes() for name in ("A", "D65")]
    lines = [line for line in spectra[0].decode().splitlines() if line[:1].isdigit()]
    commas = "".join(line.replace(",", ";").replace(".", ",") + "\n" for line in lines)
    spaces = "Instrument X\nWavelength Power\n" + "\n".join(lines).replace(",", "  ")
    made = [commas.encode(), spaces.encode("utf-16"), ("µW\n" + spaces).encode("cp1252")]
    return [*spectra, *made, *_real("cases/c21*.csv")]


def _spectra() -> list[bytes]:
    nm = range(400, 701, 10)
    values = [0.1 + 0.02 * k for k in range(len(nm))]
    pairs = "".join(f"{w},{v:.3f}\n" for w, v in zip(nm, values, strict=True))
    columns = "nm,a,b\n" + pairs.replace("\n", ",0.5\n")
    row = ",".join(f"{v:.3f}" for v in values)
    rows = f"name,{','.join(f'R{w}' for w in nm)}\nred,{row}\nblue,{row}\n"
    semicolons = rows.replace(",", ";").replace(".", ",").encode("utf-16")
    table = "# quantity: brdf\ntheta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,"
    table += ",".join(map(str, nm)) + f"\n45,180,0,0,{row.replace('0.', '0.0')}\n"
    percent = "nm,R%\n" + pairs
    return [text.encode() for text in (pairs, columns, rows, table, percent)] + [semicolons]


def _sample_files() -> list[bytes]:
    nm = range(400, 701, 50)
    values = " ".join(f"{0.1 + 0.05 * k:.3f}" for k in range(len(nm)))
    fields = " ".join(f"SPECTRAL_NM_{w}" for w in nm)
    angles = ("45as-15", "45as15", "15as45", "45as25az90")
    chart = 'CGATS.17\nORIGINATOR "x"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME GEOMETRY LAB_L LAB_A LAB_B '
    chart += f"{fields}\nEND_DATA_FORMAT\nNUMBER_OF_SETS 4\nBEGIN_DATA\n"
    chart += "".join(f'"a b" {g} 50 1 -2 {values}\n' for g in angles) + "END_DATA\n"
    argyll = 'CTI3\nSPECTRAL_BANDS "7"\nSPECTRAL_START_NM "400"\nSPECTRAL_NORM "100"\n'
    argyll += "BEGIN_DATA_FORMAT\nSAMPLE_ID SPECTRAL_NM SPECTRAL_PCT " + fields.replace(
        "SPECTRAL_NM", "SPEC"
    )
    argyll += f"\nEND_DATA_FORMAT\nBEGIN_DATA\n1 400 20 {values}\nEND_DATA\n"
    table = "name,geometry," + ",".join(f"{w}nm" for w in nm) + "\n"
    table += "".join(f"a,{g},{values.replace(' ', ',')}\n" for g in angles)
    brdf = "".join(
        f'<BRDFAngle Notation="{g}"><IlluminationAngle>45</IlluminationAngle><Aspecular>{g[-2:]}'
        "</Aspecular><Azimuth>0</Azimuth></BRDFAngle>"
        for g in angles
    )
    cxf = (
        '<CxF xmlns="http://colorexchangeformat.com/CxF3-core"><Resources><ObjectCollection>'
        '<Object Name="a" Id="1"><ColorValues><ColorCIELab ColorSpecification="s"><L>5</L><A>1</A>'
        "<B>2</B></ColorCIELab>"
        + "".join(
            f'<ReflectanceSpectrum Name="{g}" StartWL="400" ColorSpecification="s">{values}'
            "</ReflectanceSpectrum>"
            for g in angles
        )
        + '<CustomSpectrum Name="as20" ColorSpecification="s"><SpectralPoint WL="450.5">0.5'
        '</SpectralPoint><SpectralPoint WL="650">0.5</SpectralPoint></CustomSpectrum>'
        "</ColorValues></Object></ObjectCollection><ColorSpecificationCollection>"
        '<ColorSpecification Id="s"><MeasurementSpec><MeasurementType>Spectrum_Reflectance'
        f"</MeasurementType><GeometryChoice><MultiAngle>{brdf}</MultiAngle></GeometryChoice>"
        '<WavelengthRange StartWL="400" Increment="50"/></MeasurementSpec></ColorSpecification>'
        "</ColorSpecificationCollection></Resources></CxF>"
    )
    made = [text.encode() for text in (chart, argyll, table, cxf)]
    return [*made, chart.encode("utf-16"), *map(_few_objects, _real("data/formats/*.cxf"))]


def _described_files() -> list[bytes]:
    return [*exchanged.material_x(), *exchanged.gltf_materials()]


def _few_objects(cxf: bytes) -> bytes:
    """A CxF file with the first of its objects alone, so that a mutation soon meets each part."""
    objects = list(re.finditer(rb"<(\w+:)?Object .*?</(\w+:)?Object>\s*", cxf, re.DOTALL))
    return cxf if len(objects) < 8 else cxf[: objects[8].start()] + cxf[objects[-1].end() :]


def _estimates() -> list[bytes]:
    lines = (
        "20=3.8,60=30.3,85=30.9\n0.2\n59,-58,45\n",
        "60=45\n\n46; -50; 25\n",
        "75=8e1\n\n5,0,0",
    )
    return [line.encode() for line in lines]


def _materials() -> list[bytes]:
    made = [asset("materials", f"{name}.json").read_bytes() for name in ("uncoated", "art-coated")]
    rgb = {
        "format": "relgloss-material", "version": 1, "name": "blue", "source": "made",
        "basis": "rgb", "diffuse": {"model": "oren-nayar", "albedo": [0.1, 0.2, 0.5],
        "sigma_deg": 10.0}, "specular": [{"model": "torrance-sparrow", "strength": 0.5,
        "refractive_index": 1.5, "s_deg": 4.0}, {"model": "metal", "f0": [0.5, 0.4, 0.3],
        "s_deg": 9.0}],
    }  # fmt: skip
    numbers = {"value": 2.5, "lower": 2.3, "upper": 2.7}
    estimated = rgb | {
        "estimate": {
            "readings": [{"angle_deg": 60.0, "value": 30.0, "standard_error": 0.2}],
            "colour": {"kind": "lab", "lab": [50.0, 0.0, 0.0]}, "level": 0.95,
            "intervals": {"s_deg": numbers}, "seed": 0, "contradiction": "", "warnings": ["w"],
            "draws": {"names": ["log_s_deg"], "rows": [[0.9], [1.0]]},
        }
    }  # fmt: skip
    return [*made, json.dumps(rgb).encode(), json.dumps(estimated).encode()]


def _scenes() -> list[bytes]:
    scene = (
        '# a scene\n[sample]\nname = "uncoated"\n[look]\nsigma_n_deg = 2.0\nc_fraction = 0.5\n'
        'quality = "auto"\nseed = 3\n[lamp]\nilluminant = "D50"\n[display]\ntransfer = "srgb"\n'
        'white_xy = [0.3127, 0.329]\n[reference]\nname = "cast-coated"\n[reference.look]\n'
        "sigma_n_deg = 0.0\n[presentation]\n"
    )
    small = "[look]\nsigma_n_deg = 1.5\n[shape]\n[eye]\n"
    from relgloss_view.viewer.state.state import State
    from relgloss_view.viewer.state.state_file import save_state

    written = _written(lambda path: save_state(path, State.initial()))
    return [scene.encode(), small.encode(), written]


def _meshes(kind: str) -> list[bytes]:
    """A tetrahedron with texture coordinates, in one of MESHES."""
    points = np.array([[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]], "<f4")
    corners = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], "<u4")
    if kind == "obj":
        lines = ["mtllib a.mtl", *(f"v {x} {y} {z}" for x, y, z in points)]
        lines += ["vt 0 0", "vt 1 0", "vt 0 1", "vn 0 0 1", "o body", "usemtl ink"]
        lines += [f"f {a + 1}/1 {b + 1}/2 {c + 1}/3" for a, b, c in corners]
        square = "v 0 0 0\nv 70 0 0\nv 70 90 0\nv 0 90 0\nf -4//1 -3//1 -2//1 -1//1\nvn 0 0 1\n"
        return ["\n".join(lines).encode(), square.encode()]
    if kind == "stl":
        rows = [struct.pack("<12fH", 0, 0, 1, *points[c].ravel(), 0) for c in corners]
        text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        return [bytes(80) + struct.pack("<I", 4) + b"".join(rows), text.encode()]
    if kind == "ply":
        head = "ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        head += "property float z\nproperty float s\nproperty float t\nelement face 4\n"
        head += "property list uchar uint vertex_indices\nend_header\n"
        table = np.concatenate([points, points[:, :2] * 10.0], axis=1)
        faces = b"".join(b"\x03" + row.tobytes() for row in corners)
        text = "\n".join(" ".join(map(str, row)) for row in table.tolist())
        text += "\n" + "\n".join("3 " + " ".join(map(str, row)) for row in corners.tolist())
        binary = head.format("binary_little_endian").encode() + table.astype("<f4").tobytes()
        return [binary + faces, (head.format("ascii") + text + "\n").encode()]
    data = points.tobytes() + corners.tobytes() + (points[:, :2] * 10.0).astype("<f4").tobytes()
    content: dict[str, Any] = {
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": size}
                        for at, size in ((0, 48), (48, 48), (96, 32))],
        "accessors": [
            {"bufferView": k, "componentType": t, "count": n, "type": name}
            for k, t, n, name in (
                (0, 5126, 4, "VEC3"), (1, 5125, 12, "SCALAR"), (2, 5126, 4, "VEC2")
            )
        ],
        "materials": [{"name": "ink"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1,
                                    "material": 0}]}],
        "nodes": [{"children": [1], "scale": [1, 2, 1]}, {"mesh": 0, "rotation": [0, 0, 0, 1]}],
        "scenes": [{"nodes": [0]}], "scene": 0,
    }  # fmt: skip
    if kind == "gltf":
        uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        content["buffers"][0]["uri"] = uri
        return [json.dumps(content).encode()]
    text = json.dumps(content)
    coded = text.encode() + b" " * (-len(text) % 4)
    parts = struct.pack("<I", len(coded)) + b"JSON" + coded
    parts += struct.pack("<I", len(data)) + b"BIN\0" + data
    return [b"glTF" + struct.pack("<II", 2, 12 + len(parts)) + parts]


def _written(write: Callable[[Path], object], name: str = "seed") -> bytes:
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def _studies() -> list[bytes]:
    return [asset("studies", "paper.toml").read_bytes(), *_scenes()[1:2]]


def _preset_files() -> list[bytes]:
    from relgloss_view.viewer.state import presets

    return [_written(lambda path: presets.save(path, presets.built_in()))]


def _layouts() -> list[bytes]:
    from relgloss_view.viewer.state.layout_file import WindowLayout, save_layout

    layout = WindowLayout(closed=("Fit", "Help"), docking="[Window][Look]\nPos=1,2\n")
    return [_written(lambda path: save_layout(path, layout))]


def _result_files() -> list[bytes]:
    content = {"format": "relgloss-experiment", "version": 1, "written": ["results.json", "a.csv"]}
    return [json.dumps({**content, "samples": [{"label": "x", "scale": [0.5, 1]}] * 3}).encode()]


def _profiles() -> list[bytes]:
    from PIL import ImageCms

    from relgloss_view.display.display import Display
    from relgloss_view.display.icc_writing import matrix_profile, srgb_profile

    gamma = matrix_profile(Display(transfer="gain-offset-gamma"))
    lab = ImageCms.ImageCmsProfile(ImageCms.createProfile("LAB")).tobytes()
    return [srgb_profile(), gamma, lab]


def _screens() -> list[bytes]:
    """Profiles of monitors: of matrices, with all tags that are read, and of each kind of table."""
    table, formula = calibration_tags()
    tags = {b"lumi": xyz_tag(160.0 * D50), b"bkpt": xyz_tag(0.003 * D50)}
    made = [*_profiles()[:2]]
    for kind, vcgt in (("mft1", table), ("mft2", formula), ("mAB ", table)):
        held = {**tags, b"vcgt": vcgt}
        made += [table_profile(kind, lab=lab, points=5, tags=held) for lab in (True, False)]
    return made


def _device_profiles() -> list[bytes]:
    """Profiles of matrices, and of tables mft2 and mAB of three and one channels."""
    head = bytearray(_profiles()[0][:128])
    head[20:24] = b"Lab "
    made = [*_profiles()[:2]]
    rng = np.random.default_rng(0)
    grid = rng.integers(0, 65536, 2**4 * 3).astype(">u2").tobytes()
    ramp = np.array([0, 65535], ">u2").tobytes()
    for space, count in ((b"CMYK", 4), (b"RGB ", 3)):
        nodes = grid[: 2**count * 6]
        old = b"mft2" + bytes(4) + bytes((count, 3, 2, 0)) + bytes(36) + struct.pack(">HH", 2, 2)
        old += ramp * count + nodes + ramp * 3
        curve = b"curv" + bytes(8)
        first = 32 + 12 * 3 + 12 * count
        new = b"mAB " + bytes(4) + bytes((count, 3, 0, 0))
        new += struct.pack(">5I", 32, 0, 0, first, 32 + 36) + curve * (3 + count)
        new += bytes([2] * count).ljust(16, b"\0") + bytes((2, 0, 0, 0)) + nodes
        for table in (old, new):
            head[12:20] = b"prtr" + space
            data = bytes(head) + struct.pack(">I4sII", 1, b"A2B0", 144, len(table)) + table
            made.append(struct.pack(">I", len(data)) + data[4:])
    return made


def _pictures() -> list[bytes]:
    import io

    from PIL import Image

    rng = np.random.default_rng(0)
    colours = rng.integers(0, 256, (9, 11, 4), np.uint8)
    made = []

    def save(image: Image.Image, kind: str, **options: Any) -> None:
        file = io.BytesIO()
        image.save(file, kind, **options)
        made.append(file.getvalue())

    profile = _profiles()[0]
    save(Image.fromarray(colours), "PNG", icc_profile=profile, dpi=(300, 300))
    save(Image.fromarray(colours[..., :3]).quantize(8), "PNG")
    save(Image.fromarray(colours[..., 0].astype(np.uint16)), "PNG")
    save(Image.fromarray(colours[..., :3]), "JPEG", icc_profile=profile)
    cmyk = _device_profiles()[2]
    save(Image.fromarray(colours, "CMYK"), "JPEG", icc_profile=cmyk)
    for compression in ("raw", "tiff_lzw", "tiff_adobe_deflate", "packbits", "jpeg"):
        save(Image.fromarray(colours[..., :3]), "TIFF", compression=compression)
    save(Image.fromarray(colours, "CMYK"), "TIFF", icc_profile=cmyk, compression="tiff_lzw")
    names = b"8BIM" + struct.pack(">HHI", 1006, 0, 5) + b"\x04Foil\0"
    body = b"\0\0" + np.moveaxis(colours, 2, 0).tobytes()
    head = b"8BPS" + struct.pack(">H6xHIIHH", 1, 4, 9, 11, 8, 3)
    made.append(head + struct.pack(">II", 0, len(names)) + names + bytes(4) + body)
    return made


def _pdfs() -> list[bytes]:
    import io

    import pikepdf
    from pikepdf import Array, Dictionary, Name

    made = []
    for space in ("Separation", "DeviceN"):
        pdf = pikepdf.Pdf.new()
        pdf.add_blank_page(page_size=(20, 10))
        page = pdf.pages[0].obj
        tint = pdf.make_stream(b"{dup 0.5 mul exch 0 exch 0 0.1}")
        tint["/FunctionType"], tint["/Domain"] = 4, [0, 1]
        tint["/Range"] = [0, 1] * 4
        name = Name("/Foil") if space == "Separation" else Array([Name("/Foil")])
        layer = pdf.make_indirect(Dictionary(Type=Name.OCG, Name="x", GTS_Metadata=Dictionary()))
        layer["/GTS_Metadata"]["/GTS_ProcStepsGroup"] = Name("/Varnish")
        pdf.Root["/OCProperties"] = Dictionary(OCGs=[layer], D=Dictionary(ON=[layer]))
        colour = pdf.make_indirect(Array([Name("/" + space), name, Name.DeviceCMYK, tint]))
        page["/Resources"] = Dictionary(
            ColorSpace=Dictionary(S=colour), Properties=Dictionary(M=layer)
        )
        page["/Contents"] = pdf.make_stream(b"/OC /M BDC /S cs 1 scn 0 0 9 9 re f EMC 1 0 0 rg")
        page["/TrimBox"] = [1, 1, 19, 9]
        file = io.BytesIO()
        pdf.save(file, compress_streams=False)
        made.append(file.getvalue())
    return made


def _fonts() -> list[bytes]:
    from relgloss_view.base.fonts import dejavu

    path = dejavu()
    return [] if path is None else [subset_font(path)]


def subset_font(path: Path) -> bytes:
    """A font of a few letters, so that mutations meet its tables."""
    import io

    from fontTools import subset
    from fontTools.ttLib import TTFont

    data = io.BytesIO()
    with TTFont(path) as font:
        del font["FFTM"]  # it holds dates, and the subsetter does not know it
        chosen = subset.Subsetter()
        chosen.populate(text="relgloss äΩж")
        chosen.subset(font)
        font.save(data)
    return data.getvalue()


def _own_tables() -> list[bytes]:
    from relgloss_view.base.csv_files import write_csv

    rows = [("=1+1", 0.5, "a,b"), ("'x\n", -1, "ü"), ("", None, '"')]
    return [_written(lambda path: write_csv(path, ("label", "value", "text"), rows))]


@functools.cache
def _sessions() -> list[bytes]:
    from relgloss_view.cli import main

    def make(path: Path) -> None:
        few = ["--set", "grid.sigma_n_deg=[0, 1]", "--set", "grid.c_fraction=[0.5, 1]"]
        words = ["experiment", "simulate", "paper", "-o", str(path), "--observers", "2"]
        words += ["--truth", "cells", *few]
        import contextlib
        import io

        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            if main(words) != 0:
                raise InputError("the seed of a session could not be made")

    return [_written(make, "seed.sqlite")]


def structured_bombs(size: int) -> list[tuple[str, bytes]]:
    """Names and bytes of binary files whose parts claim much: for the reader that has the name."""
    made = [(f"bsdf: {name}", data) for name, data in _bsdf_bombs(size)]
    made += [(f"icc: {name}", data) for name, data in _icc_bombs(size)]
    made += [(f"display: {name}", data) for name, data in _screen_bombs(size)]
    made += [(f"font: {name}", data) for name, data in _font_bombs(size)]
    return [(name, data) for name, data in made if len(data) <= size]


def _bsdf_bombs(size: int) -> list[tuple[str, bytes]]:
    def fields(count: int, grid: int) -> dict[str, np.ndarray[Any, Any]]:
        ones = np.ones
        return {
            "phi_i": np.zeros(1, np.float32),
            "theta_i": np.linspace(0.0, 1.5, count, dtype=np.float32),
            "ndf": ones((2, 2), np.float32),
            "sigma": ones((2, 2), np.float32),
            "vndf": ones((1, count, grid, grid), np.float32),
            "rgb": ones((1, count, 3, grid, grid), np.float32),
        }

    slices = bsdf_of(fields(size // 80, 2))
    fine = bsdf_of(fields(1, int((size / 20) ** 0.5)))
    many = bsdf_of({f"f{k}": np.zeros(0, np.uint8) for k in range(900)})
    long = bsdf_of({"a" * (60_000 - k): np.zeros(0, np.uint8) for k in range(size // 60_100)})
    return [("slices", slices), ("a fine grid", fine), ("fields", many), ("long names", long)]


def _screen_bombs(size: int) -> list[tuple[str, bytes]]:
    """Profiles of screens: tags that overlap, tables and curves that claim much, a large one."""
    whole = bytearray(_screens()[0].ljust(size, b"\0"))
    struct.pack_into(">II", whole, 0, len(whole), 0)
    struct.pack_into(">I", whole, 128, 100)
    for k in range(8, 100):
        struct.pack_into(">4sII", whole, 132 + 12 * k, b"t%03d" % k, 2000 + k, len(whole) - 2100)
    made = [("a hundred tags that overlap", bytes(whole))]
    table = bytearray(table_profile("mft2", points=5))
    table[table.index(b"mft2") + 10] = 255
    made.append(("a grid of 255 a channel", bytes(table)))
    new = bytearray(table_profile("mAB ", points=5))
    at = new.index(b"mAB ") + 32 + 72
    new[at : at + 3] = bytes((255, 255, 255))
    made.append(("a new grid of 255 a channel", bytes(new)))
    for entries in (0xFFFFFFFF, 0x7FFFFFFF, 1 << 16):
        curve = b"curv" + bytes(4) + struct.pack(">IH", entries, 1)
        same = {name: xyz_tag(D50) for name in (b"rXYZ", b"gXYZ", b"bXYZ")}
        tags = {**same, b"rTRC": curve, b"gTRC": curve, b"bTRC": curve}
        made.append((f"a curve of {entries} entries", assembled(tags, lab=False, version=2)))
    fits = int((size / 8.0) ** (1.0 / 3.0))
    made.append(("a large table", table_profile("mft2", points=min(fits, 50))))
    return made


def _icc_bombs(size: int) -> list[tuple[str, bytes]]:
    head = bytearray(_profiles()[1][:128])

    def profile(tags: list[tuple[bytes, int, int]], body: bytes) -> bytes:
        table = struct.pack(">I", len(tags)) + b"".join(struct.pack(">4sII", *tag) for tag in tags)
        data = bytes(head) + table + body
        return struct.pack(">I", len(data)) + data[4:]

    start = 132 + 12
    text = "relgloss".encode("utf-16-be") * ((size - 400) // 16)
    long = b"mluc" + bytes(4) + struct.pack(">II2s2sII", 1, 12, b"en", b"US", len(text), 28) + text
    count = (size - 400) // 12
    record = struct.pack(">2s2sII", b"en", b"US", 12 * count, 16)
    many = b"mluc" + bytes(4) + struct.pack(">II", count, 12) + record * count
    old = b"desc" + bytes(4) + struct.pack(">I", size - 400) + b"a" * (size - 400)
    bombs = [
        (name, profile([(b"desc", start, len(body))], body))
        for name, body in (("a long text", long), ("many texts", many), ("old text", old))
    ]
    same = [(b"%04d" % k, 132 + 12 * 100, len(long) - 2000) for k in range(99)]
    tags = [(b"desc", 132 + 12 * 100, len(long) - 2000), *same]
    return [*bombs, ("a hundred tags of one text", profile(tags, long[:-2000]))]


def _font_bombs(size: int) -> list[tuple[str, bytes]]:
    def font(cmap: bytes) -> bytes:
        tables = {
            b"cmap": cmap,
            b"head": struct.pack(">HHIIIHH", 1, 0, 0, 0, 0x5F0F3CF5, 0, 1000) + bytes(34),
            b"hhea": struct.pack(">Ihh", 0x10000, 800, -200) + bytes(28),
        }
        directory, body = b"", b""
        for tag, data in tables.items():
            directory += struct.pack(">4sIII", tag, 0, 12 + 16 * len(tables) + len(body), len(data))
            body += data
        return b"\0\1\0\0" + struct.pack(">4H", len(tables), 0, 0, 0) + directory + body

    def maps(*subtables: bytes) -> bytes:
        head = struct.pack(">HHHHI", 0, 1, 3, 10, 12)
        return head + b"".join(subtables)

    groups = (size - 400) // 12
    whole = struct.pack(">III", 0, 0x10FFFF, 1)
    twelve = struct.pack(">HHIII", 12, 0, 16 + 12 * groups, 0, groups) + whole * groups
    one = struct.pack(">HHIII", 12, 0, 28, 0, 1) + whole
    count = 8000
    four = struct.pack(">7H", 4, 0, 0, 2 * count, 0, 0, 0) + b"\xff\xff" * count + bytes(2)
    four += bytes(2 * count) + b"\0\1" * count + bytes(2 * count)
    records = (size - 400) // 8
    many = struct.pack(">HH", 0, min(records, 65535))
    many += struct.pack(">HHI", 3, 10, 4 + 8 * 65535) * 65535 + one
    return [
        ("groups of all characters", font(maps(twelve))),
        ("one group of all characters", font(maps(one))),
        ("segments of all characters", font(maps(four))),
        ("many maps", font(many)),
        ("compressed", b"wOFF" + bytes(size - 100)),
    ]


def _any() -> list[bytes]:
    return [*_tables(), *_bsdf(), *_materials(), *_scenes(), *_lamps()[:1], *_profiles()[:1]]
