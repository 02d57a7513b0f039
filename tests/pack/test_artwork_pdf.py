"""Pages of PDFs: plates against Ghostscript's own files, names against those that pikepdf wrote."""

import shutil
import subprocess
from pathlib import Path

import artwork_files as files
import numpy as np
import pikepdf
import pytest
from pikepdf import Dictionary, Name
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.base.icc.profile import read_profile
from relgloss_view.pack.artwork import ghostscript, pdf
from relgloss_view.pack.artwork.options import ArtworkOptions
from relgloss_view.pack.artwork.pdf_functions import evaluate
from relgloss_view.pack.artwork.read import read_artwork

CMYK = Path("/usr/share/color/icc/ghostscript/default_cmyk.icc")
SPOTS = {
    "Va": ("Varnish", (1, 0, 0, 0)),
    "Fo": ("Foil Gold", (0, 0.2, 0.8, 0)),
    "Pa": ("PANTONE 186 C", (0, 1, 0.8, 0.1)),
}
#: Magenta everywhere; an ink that knocks it out, one that overprints it, and finishes above.
CONTENT = b"""0 1 0 0 k 0 0 200 100 re f
/NO gs /Pa cs 1 scn 20 20 40 40 re f
/OV gs /Pa cs .5 scn 80 20 40 40 re f
/OV gs /Va cs 1 scn 0 0 100 50 re f
/OV gs /Fo cs 1 scn 150 50 20 20 re f
"""
AT_72 = ArtworkOptions(dpi=72.0)

pytestmark = pytest.mark.skipif(
    shutil.which("gs") is None or not CMYK.is_file(), reason="Ghostscript is absent"
)


def test_plates_are_those_of_ghostscript(tmp_path):
    path = tmp_path / "a.pdf"
    files.pdf(path, CONTENT, SPOTS, profile=CMYK.read_bytes())
    artwork = read_artwork(path, AT_72)
    words = ["gs", "-q", "-dSAFER", "-dBATCH", "-dNOPAUSE", "-sDEVICE=tiffsep", "-r72"]
    subprocess.run([*words, f"-sOutputFile={tmp_path / 'p.tif'}", path], check=True)
    assert set(artwork.plates) == {name for name, _ in SPOTS.values()}
    for name, plate in artwork.plates.items():
        with Image.open(tmp_path / f"p({name}).tif") as image:
            expected = 255 - np.asarray(image).astype(int)
        assert np.abs(plate - expected).max() <= 1
        assert plate.max() > 0
    assert (artwork.width_mm, artwork.height_mm) == pytest.approx(
        (200 * 25.4 / 72, 100 * 25.4 / 72)
    )


def test_colours_overprint_and_finishes_print_none(tmp_path):
    """Colours of patches: process by the profile, the spot by its alternate, finishes nowhere."""
    path = tmp_path / "a.pdf"
    files.pdf(path, CONTENT, SPOTS, profile=CMYK.read_bytes())
    artwork = read_artwork(path, AT_72)
    assert artwork.coloured == {"PANTONE 186 C"}
    xyz = artwork.xyz.astype(float)
    profile = read_profile(CMYK.read_bytes())

    def printed(*cmyk):
        return profile.xyz(np.array([cmyk], float))[0]

    def at(x, y):
        return xyz[99 - y, x]

    magenta, solid, half = printed(0, 1, 0, 0), printed(0, 1, 0.8, 0.1), printed(0, 0.5, 0.4, 0.05)
    assert at(190, 90) == pytest.approx(magenta, abs=2e-3)
    assert at(10, 10) == pytest.approx(magenta, abs=2e-3), "below the varnish"
    assert at(160, 60) == pytest.approx(magenta, abs=2e-3), "below the foil"
    assert at(40, 55) == pytest.approx(solid, abs=4e-3), "knocked out"
    paper = printed(0, 0, 0, 0)
    assert at(110, 55) == pytest.approx(magenta * half / paper, abs=6e-3), "overprinted"
    # Negative control: neither the varnish's alternate nor a knock-out gives these colours.
    assert np.abs(printed(1, 1, 0, 0) - magenta).max() > 0.05
    assert np.abs(half - magenta * half / paper).max() > 0.05


@pytest.mark.parametrize("turn", [pytest.param(0, marks=pytest.mark.slow), 90])
def test_box_unit_and_rotation(tmp_path, turn):
    def change(_, page):
        page.obj["/TrimBox"] = [10, 10, 190, 90]
        page.obj["/UserUnit"] = 2.0
        page.obj["/Rotate"] = turn

    content = b"0 0 0 1 k 0 0 200 100 re f 0 0 0 0 k 10 10 90 80 re f"
    files.pdf(tmp_path / "a.pdf", content, {}, profile=CMYK.read_bytes(), change=change)
    artwork = read_artwork(tmp_path / "a.pdf", AT_72)
    size = (360, 160) if turn == 0 else (160, 360)
    assert artwork.size_px == size
    mm = tuple(side * 25.4 / 72 for side in size)
    assert (artwork.width_mm, artwork.height_mm) == pytest.approx(mm)
    luminance = artwork.xyz[..., 1].astype(float)
    left_or_top = luminance[:, :180] if turn == 0 else luminance[:180]
    rest = luminance[:, 181:] if turn == 0 else luminance[181:]
    assert left_or_top.min() > 0.5 > rest.max()


@pytest.mark.slow
def test_odd_names_keep_their_plates(tmp_path):
    names = ["Spot/UV #1 (x)%d", "Weiß ä日本", "../../x", "cyan", "-sOutputFile=x", "a b", "A B"]
    spots = {f"S{k}": (name, (1, 0, 0, 0)) for k, name in enumerate(names)}
    spots |= {"Sall": ("All", (1, 1, 1, 1)), "Snone": ("None", (1, 1, 1, 1))}
    content = b"/OV gs "
    content += b"".join(b"/S%d cs 1 scn %d 0 10 50 re f\n" % (k, 20 * k) for k in range(len(names)))
    files.pdf(tmp_path / "a.pdf", content, spots, profile=CMYK.read_bytes())
    artwork = read_artwork(tmp_path / "a.pdf", AT_72)
    assert set(artwork.plates) == set(names)
    for k, name in enumerate(names):
        columns = np.flatnonzero(artwork.plates[name].any(axis=0))
        assert (columns.min(), columns.max()) == (20 * k, 20 * k + 9)


def test_a_layer_of_a_processing_step_is_no_ink(tmp_path):
    """ISO 19593-1: an ink whose name does not reveal it."""

    def change(made, page):
        meta = Dictionary()
        meta["/GTS_ProcStepsGroup"] = Name("/Varnish")
        layer = made.make_indirect(Dictionary(Type=Name.OCG, Name="x", GTS_Metadata=meta))
        made.Root["/OCProperties"] = Dictionary(OCGs=[layer], D=Dictionary(ON=[layer]))
        page.obj["/Resources"]["/Properties"] = Dictionary(MC0=layer)

    content = b"0 1 0 0 k 0 0 200 100 re f /OC /MC0 BDC /OV gs /S cs 1 scn 0 0 50 50 re f EMC"
    spots = {"S": ("Special 7", (1, 0, 0, 0))}
    files.pdf(tmp_path / "a.pdf", content, spots, profile=CMYK.read_bytes(), change=change)
    artwork = read_artwork(tmp_path / "a.pdf", AT_72)
    assert artwork.xyz[90, 10].tolist() == artwork.xyz[10, 190].tolist()
    assert any("'Special 7'" in note and "Varnish" in note for note in artwork.notes)
    # Negative control: without the layer it is an ink.
    bare = content.replace(b"/OC /MC0 BDC", b"").replace(b"EMC", b"")
    files.pdf(tmp_path / "b.pdf", bare, spots, profile=CMYK.read_bytes())
    other = read_artwork(tmp_path / "b.pdf", AT_72)
    assert other.xyz[90, 10].tolist() != other.xyz[10, 190].tolist()


def test_rgb_alone_stays_srgb_and_cmyk_wants_a_profile(tmp_path):
    path = tmp_path / "a.pdf"
    content = b"1 0 0 rg 0 0 200 100 re f /OV gs /Va cs 1 scn 0 0 100 50 re f"
    files.pdf(path, content, {"Va": SPOTS["Va"]})
    artwork = read_artwork(path, AT_72)
    assert artwork.xyz.reshape(-1, 3).astype(float) == pytest.approx(
        np.tile([0.4361, 0.2225, 0.0139], (20_000, 1)), abs=2e-3
    )
    assert artwork.plates["Varnish"][60:, :90].min() == 255
    files.pdf(path, CONTENT, SPOTS)
    with pytest.raises(InputError, match=r"CMYK without a profile.*--profile FILE.icc"):
        read_artwork(path, AT_72)
    given = read_artwork(path, ArtworkOptions(dpi=72.0, profile=str(CMYK)))
    assert len(given.plates) == 3


def test_fonts_that_are_missing(tmp_path):
    def change(made, page):
        font = Dictionary(Type=Name.Font, Subtype=Name.Type1, BaseFont=Name("/Frutiger-Bold"))
        page.obj["/Resources"]["/Font"] = Dictionary(F0=made.make_indirect(font))

    path = tmp_path / "a.pdf"
    files.pdf(path, b"", {}, change=change)
    assert pdf.missing_fonts(path) == ("Frutiger-Bold",)
    files.pdf(path, b"", {})
    assert pdf.missing_fonts(path) == ()


def test_pdfs_that_are_refused(tmp_path, monkeypatch):
    path = tmp_path / "a.pdf"
    files.pdf(path, CONTENT, SPOTS, profile=CMYK.read_bytes())
    with pytest.raises(InputError, match="page 3 is not there; give --page 1 to 1"):
        read_artwork(path, ArtworkOptions(page=3))
    whole = path.read_bytes()
    with pikepdf.open(path) as opened:
        opened.save(tmp_path / "b.pdf", encryption=pikepdf.Encryption(owner="a", user="b"))
    (tmp_path / "c.pdf").write_bytes(whole[:400])
    for name, words in (("b.pdf", "encrypted"), ("c.pdf", "damaged PDF")):
        with pytest.raises(InputError, match=words):
            read_artwork(tmp_path / name)
    monkeypatch.setattr("shutil.which", lambda _: None)
    with pytest.raises(InputError, match="Ghostscript, which renders PDF, is not installed"):
        read_artwork(path)


def test_an_endless_page_is_ended(tmp_path, monkeypatch):
    (tmp_path / "a.eps").write_bytes(b"%!PS\n{} loop\n")
    monkeypatch.setattr(ghostscript, "LEAST_S", 0.3)
    with pytest.raises(InputError, match="Ghostscript takes longer than"):
        read_artwork(tmp_path / "a.eps")
    (tmp_path / "a.eps").write_bytes(b"%!PS\n(/etc/passwd) (r) file pop showpage\n")
    with pytest.raises(InputError, match="invalidfileaccess"):
        read_artwork(tmp_path / "a.eps")


def test_trim_boxes(tmp_path):
    """A trim box counts within the medium alone, its corners in any order (14.11.2.1)."""
    sizes = {
        (10, 20, 110, 70): (100, 50),
        (110, 70, 10, 20): (100, 50),
        (-50, 40, 50, 300): (50, 60),
    }
    for box, size in sizes.items():
        path = tmp_path / "a.pdf"

        def trim(_, page, box=box):
            page.obj["/TrimBox"] = list(box)

        files.pdf(path, CONTENT, SPOTS, profile=CMYK.read_bytes(), change=trim)
        assert read_artwork(path, AT_72).size_px == size


def test_output_intent_of_the_page(tmp_path):
    """Of PDF 2.0: it counts as the document's does, and before it."""

    def of_page(made, page):
        page.obj["/OutputIntents"] = made.Root["/OutputIntents"]
        del made.Root["/OutputIntents"]

    for change, name in ((None, "a.pdf"), (of_page, "b.pdf")):
        files.pdf(tmp_path / name, CONTENT, SPOTS, profile=CMYK.read_bytes(), change=change)
    one, other = (read_artwork(tmp_path / name, AT_72) for name in ("a.pdf", "b.pdf"))
    assert np.array_equal(one.xyz, other.xyz)


def test_many_plates_are_coarser(tmp_path, monkeypatch):
    """Plates lie in memory: where they are too many, the resolution gives way, with a note."""
    path = tmp_path / "a.pdf"
    files.pdf(path, CONTENT, SPOTS, profile=CMYK.read_bytes())
    assert read_artwork(path, AT_72).size_px == (200, 100)
    monkeypatch.setattr(pdf, "MOST_PLANE_PIXELS", 7 * 200 * 100 / 4)
    artwork = read_artwork(path, AT_72)
    assert artwork.size_px == (100, 50)
    assert any("7 plates" in note and "36 dpi" in note for note in artwork.notes)


def test_plates_that_find_no_room(tmp_path, monkeypatch):
    """Ghostscript ends well on a full disk, so room is asked for, and plates are checked."""
    files.pdf(tmp_path / "a.pdf", CONTENT, SPOTS, profile=CMYK.read_bytes())
    with monkeypatch.context() as patch:
        patch.setattr(pdf, "_plate", lambda path: path.write_bytes(b"II*") and pdf._pixels(path))
        with pytest.raises(InputError, match="did not write this plate whole"):
            read_artwork(tmp_path / "a.pdf", AT_72)
    full = shutil.disk_usage(tmp_path)._replace(free=100_000)
    monkeypatch.setattr("shutil.disk_usage", lambda _: full)
    with pytest.raises(InputError, match="in the folder of temporary files"):
        read_artwork(tmp_path / "a.pdf", AT_72)


class TestFunctions:
    """The functions of PDF against Ghostscript's own calculator and closed forms."""

    def test_calculator(self):
        programs = {
            b"{dup 0.5 mul exch 1 exch sub 2 copy add 2 index}": 0.25,
            b"{dup 0.3 gt {2 exp} {sqrt} ifelse dup 0.1 add 2 1 roll}": 0.6,
            b"{360 mul sin 0.5 add dup cvi 7 3 idiv 3 -1 roll 2 atan}": 0.4,
        }
        made = pikepdf.Pdf.new()
        # The stack that PostScript prints for the same words.
        for program, x in programs.items():
            stream = made.make_stream(program)
            stream["/FunctionType"], stream["/Domain"] = 4, [0, 1]
            got = evaluate(stream, [x])
            text = b"[ %g %s exec ] { == } forall flush quit" % (x, program)
            words = ["gs", "-q", "-dNODISPLAY", "-dSAFER", "-dBATCH", "-c", text.decode()]
            out = subprocess.run(words, capture_output=True, text=True, check=True).stdout
            assert got == pytest.approx([float(v) for v in out.split()], abs=1e-5)

    def test_sampled_and_stitched(self):
        made = pikepdf.Pdf.new()
        stream = made.make_stream(bytes([0, 255, 128, 0]))
        entries = {"/FunctionType": 0, "/Domain": [0, 1], "/Range": [0, 1, 0, 2], "/Size": [2],
                   "/BitsPerSample": 8}  # fmt: skip
        for key, value in entries.items():
            stream[key] = value
        assert evaluate(stream, [0.25]) == pytest.approx([0.25 * 128 / 255, 1.5])
        power = Dictionary(FunctionType=2, Domain=[0, 1], C0=[0], C1=[1], N=2)
        both = Dictionary(FunctionType=3, Domain=[0, 1], Functions=[power, power], Bounds=[0.5],
                          Encode=[0, 1, 1, 0])  # fmt: skip
        assert evaluate(both, [0.25]) == [0.25]
        assert evaluate(both, [0.75]) == [0.25]
        assert evaluate(both, [0.5]) == [1.0]
