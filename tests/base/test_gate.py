"""One gate for files from outside: what passes, what does not, and that nobody goes around it."""

import ast
import io
import os
import threading
from pathlib import Path

import numpy as np
import pytest

import relgloss_view
from relgloss_view.base import font_tables
from relgloss_view.base.decoding import decoded
from relgloss_view.base.errors import LONGEST, InputError
from relgloss_view.base.fonts import dejavu
from relgloss_view.base.icc.header import parse_profile
from relgloss_view.base.reading import decoding, open_regular, read_bytes
from relgloss_view.base.text_lines import TextLines

PACKAGE = Path(relgloss_view.__file__).parent
#: Modules that read what this program, its installation or the system has written, each with why.
ELSEWHERE = {
    "base/reading.py": "the gate itself", "base/toml.py": "decodes behind the gate",
    "base/json_files.py": "decodes behind the gate", "base/xml.py": "parses behind the gate",
    "base/writing.py": "makes the file that it opens", "base/temporaries.py": "its own files",
    "base/file_system.py": "brings to the disk", "base/journal.py": "marks its folder",
    "base/room.py": "/proc", "base/terminal.py": "the null device",
    "material/lamp_names.py": "its own child", "picture/output/exr.py": "writes",
    "picture/output/exr_parts.py": "what it has just written",
    "base/csv_files.py": "writes", "cli.py": "the null device",
    "material/spectra.py": "an asset", "gloss/meter/lobe_table.py": "an asset",
    "pack/paint.py": "an asset", "pack/artwork/pdf_examination.py": "its parent's words",
    "experiment/report/page.py": "what it has just written", "picture/output/png16.py": "writes",
    "display/icc_writing.py": "what it has made itself",
    "experiment/design/study_file.py": "copies what it has made",
    "commands/experiment_new.py": "an asset", "commands/doctor.py": "the answer of its own child",
    "picture/gpu/shader.py": "a shader of its own", "bench/speed/floor.py": "a shader of its own",
    "bench/speed/machine.py": "/proc", "bench/peers/mitsuba_peer.py": "its own parent",
    "bench/peers/mitsuba_runner.py": "its own child",
    "pack/artwork/pictures.py": "the null device", "proof/page/build.py": "the page's own parts",
    "base/page_scripts.py": "the pages' own scripts",
    "catalogue/page/write.py": "the page's own parts",
    "catalogue/page/sentences.py": "the page's own words",
    "viewer/files/proof_files.py": "what it has unpacked, and its own session file",
    "proof/carry.py": "the folder that it has written",
    "pack/artwork/pdf.py": "the answer and the files of its own child",
    "catalogue/store.py": "its own records", "catalogue/outcome.py": "what it has written",
    "catalogue/catalogue.py": "whether its own mark may be read",
    "catalogue/folder.py": "its own lock", "catalogue/work.py": "whether a file may be read",
    "catalogue/cluster_processes.py": "its own children", "catalogue/one_thread.py": "/proc",
    "catalogue/cluster_worker.py": "its own parent's words, and the program itself",
    "pack/artwork/pdf_streams.py": "unpacks a stream behind the gate",
}  # fmt: skip
READS = {"read_text", "read_bytes", "memmap", "fromfile", "loadtxt", "genfromtxt"}
READS |= {"ImageCmsProfile"}
DECODES = {("json", "loads"), ("json", "load"), ("tomllib", "loads"), ("tomllib", "load")}
DECODES |= {("ElementTree", "parse"), ("ElementTree", "fromstring"), ("ET", "parse")}
DECODES |= {("ET", "fromstring"), ("ET", "iterparse"), ("expat", "ParserCreate")}


def readers_in(tree: ast.AST) -> list[str]:
    """Calls that read or decode a file without the gate."""
    found = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        f = node.func
        if isinstance(f, ast.Name) and f.id == "open":
            found.append("open")
        if isinstance(f, ast.Attribute):
            owner = f.value.id if isinstance(f.value, ast.Name) else ""
            # Functions of these names in base/reading.py are called without an owner.
            if f.attr in READS or (owner, f.attr) in DECODES or (owner, f.attr) == ("os", "open"):
                found.append(f.attr)
            mode = next((a.value for a in node.args if isinstance(a, ast.Constant)), None)
            as_text = any(k.arg in ("encoding", "errors", "newline") for k in node.keywords)
            if f.attr == "open" and (str(mode).startswith("r") or (as_text and mode is None)):
                found.append("open")
            if f.attr == "writer" and owner == "csv":
                found.append("csv.writer")
    return found


def test_nobody_goes_around_the_gate():
    around, used = {}, set()
    for file in sorted(PACKAGE.rglob("*.py")):
        name = file.relative_to(PACKAGE).as_posix()
        calls = readers_in(ast.parse(file.read_text(encoding="utf-8")))
        if calls and name not in ELSEWHERE:
            around[name] = calls
        used |= {name} if calls else set()
    assert around == {}
    assert set(ELSEWHERE) <= used, "no longer needed"


@pytest.mark.parametrize(
    "text",
    ["Path(p).read_text()", "open(p)", "json.loads(x)", "np.memmap(p)", "p.open('rb')",
     "p.open(encoding='utf-8')", "csv.writer(f)"],
)  # fmt: skip
def test_a_reader_that_goes_around_it_is_found(text):
    assert readers_in(ast.parse(text))


def test_a_pipe_that_takes_the_place_of_a_file_hangs_nobody(tmp_path, monkeypatch):
    path = tmp_path / "a.csv"
    os.mkfifo(path)
    regular = os.stat(__file__)
    with monkeypatch.context() as patched:
        patched.setattr("os.stat", lambda *_, **__: regular)  # the check saw a file
        raised = []

        def attempt():
            try:
                open_regular(path, "a table")
            except InputError as error:
                raised.append(str(error))

        thread = threading.Thread(target=attempt, daemon=True)
        thread.start()
        thread.join(60.0)
    assert raised == [f"{path}: this is not a regular file; give a table"]


def test_files_of_the_system_hold_more_than_they_claim():
    path = Path("/proc/self/status")
    if not path.is_file():
        pytest.skip("/proc is of Linux")
    assert b"VmHWM" in read_bytes(path, 1 << 20, "a text")
    with pytest.raises(InputError, match="larger than 100 bytes"):
        read_bytes(path, 100, "a text")


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        (KeyError("x"), "can't be decoded (KeyError)"), (MemoryError(), "not enough memory"),
        (RecursionError(), "nested too deeply"), (OSError(5, "Input/output error"), "Input/output"),
        (InputError("a.b: its own"), "a.b: its own"), (AttributeError("x"), "(AttributeError)"),
    ],
)  # fmt: skip
def test_whatever_a_decoder_raises_is_one_line(fault, words):
    with pytest.raises(InputError) as caught, decoding("a.b", "a table"):
        raise fault
    assert words in str(caught.value)
    assert str(caught.value).startswith("a.b: ")


def test_a_signal_passes():
    with pytest.raises(KeyboardInterrupt), decoding("a.b", "a table"):
        raise KeyboardInterrupt


def test_a_long_message_keeps_its_remedy():
    message = str(InputError("a.csv: " + "x" * 5000 + "; correct it"))
    assert len(message) == LONGEST
    assert message.startswith("a.csv: ")
    assert message.endswith("; correct it")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"])
@pytest.mark.parametrize("chunk", [1, 7, 1 << 18])
def test_lines_are_those_of_the_whole_text(tmp_path, monkeypatch, encoding, chunk):
    """As the text of all bytes, split; ends of lines and characters cut by chunks or not."""
    if chunk == 1 and "16" in encoding:
        pytest.skip("an encoding without a mark is recognised by more than a byte")
    text = "a,b;µ°\r\n1,2\r3\n\n4,5,\r\n\r\nlast,6\x1a\x1a"
    path = tmp_path / "t"
    path.write_bytes((("0123456789," * 60) + text).encode(encoding))
    whole = decoded(path.read_bytes(), "t")
    monkeypatch.setattr("relgloss_view.base.text_lines.CHUNK", 1400 if "16" in encoding else chunk)
    with TextLines(path, "a table", most_bytes=10**6, most_lines=99) as lines:
        expected = whole.text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        assert list(lines.lines()) == expected
        assert [*zip(lines.lines(), lines.lines(), strict=True)] == [(x, x) for x in expected]
        assert lines.note == whole.note


def test_a_long_line_is_not_held(tmp_path):
    path = tmp_path / "t"
    path.write_bytes(b"a\n" + b"," * 10_000)
    limits = {"most_bytes": 10**6, "most_lines": 9}
    short = TextLines(path, "a table", longest_line=9999, **limits)
    with short as lines, pytest.raises(InputError, match="line 2: longer than 9999 characters"):
        list(lines.lines())
    with TextLines(path, "a table", longest_line=10_000, **limits) as lines:
        assert [len(line) for line in lines.lines()] == [1, 10_000]


def test_the_tables_of_a_font():
    """The letters and the height that fontTools reads from the same file."""
    from fontTools.ttLib import TTFont

    path = dejavu()
    assert path is not None
    for file in sorted(path.parent.glob("*.ttf"))[::4]:
        with TTFont(file, lazy=True) as font:
            line = font["hhea"]
            height = (line.ascent - line.descent) / font["head"].unitsPerEm
            letters = set(font["cmap"].getBestCmap())
        assert font_tables.characters(str(file), 0, "a font") == letters
        assert font_tables.height_em(str(file), 0, "a font") == height
        with pytest.raises(InputError, match="not a font"):
            font_tables.characters(str(file), 1, "a font")


def test_the_name_of_a_profile():
    """The name that Little CMS reads, and that a damaged one takes no gigabyte."""
    from PIL import ImageCms

    data = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    name = ImageCms.getProfileDescription(ImageCms.ImageCmsProfile(io.BytesIO(data))).strip()
    assert parse_profile(data).description == name == "sRGB built-in"
    at = data.index(b"mluc")
    for value in (0xFFFFFFFF, 0x7FFFFFFF, 0, 12):
        for offset in (8, 12, 20, 24):
            damaged = bytearray(data)
            damaged[at + offset : at + offset + 4] = value.to_bytes(4, "big")
            assert len(parse_profile(bytes(damaged)).description) < 1000
    rng = np.random.default_rng(0)
    for _ in range(300):
        damaged = bytearray(data)
        damaged[rng.integers(len(data))] = rng.integers(256)
        try:
            assert len(parse_profile(bytes(damaged)).description) < 1000
        except ValueError as error:
            assert "ICC profile" in str(error)
