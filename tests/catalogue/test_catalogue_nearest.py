"""The nearest pictures: against colour-science, against all pictures drawn, and controls."""

from __future__ import annotations

import io
import time

import numpy as np
import pytest
from PIL import Image
from search_rows import MemoryCatalogue, paths

from relgloss_view.catalogue.look import reference_of
from relgloss_view.catalogue.proofs import MANIFEST, write_proofs
from relgloss_view.catalogue.query import nearest
from relgloss_view.catalogue.query.fault import QueryError
from relgloss_view.catalogue.query.nearest import PictureDifference, highlight_of, redrawn
from relgloss_view.catalogue.query.pictures import Colours, Drawer
from relgloss_view.catalogue.query.search import Searcher
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.sheet import hits_sheet
from relgloss_view.gloss.match import gloss_of
from relgloss_view.material.recolour import Colour, recoloured
from relgloss_view.picture.scene.sample import SAMPLES, load_sample
from relgloss_view.proof.read import read_proof
from relgloss_view.quality.backends import open_renderer

PX = 128
INKS = ((50.0, 20.0, 10.0), (55.0, 16.0, 6.0), (60.0, -20.0, 20.0), (40.0, 0.0, -30.0))


@pytest.fixture(scope="module")
def renderer():
    with open_renderer() as opened:
        yield opened


@pytest.fixture(scope="module")
def catalogue(renderer):
    """Each paper in each ink, with thumbnails as the recipe draws them."""
    drawer = Drawer(Recipe(), renderer)
    rows, materials, thumbnails = [], {}, {}
    for paper in SAMPLES:
        for k, lab in enumerate(INKS):
            path = f"{paper}/{k}.csv"
            material = recoloured(load_sample(paper), Colour(lab))
            frame = drawer.draw(material, (PX, PX))
            data = io.BytesIO()
            Image.fromarray(np.ascontiguousarray(frame.display)).save(data, "PNG")
            frame.forget()
            materials[path], thumbnails[path] = material, data.getvalue()
            ratio = gloss_of(material) / reference_of(Recipe()).reading
            rows.append(
                {
                    "path": path,
                    "name": f"{paper} ink {k}",
                    "gloss_60": gloss_of(material, "gloss-60"),
                    "gloss_75": gloss_of(material),
                    "gloss_ratio": ratio,
                    "sigma_n_deg": 0.0,
                    "is_ratio_kept": k != 2,
                    "material": f"materials/{path}.json",
                }
            )
    return MemoryCatalogue(rows, materials, thumbnails)


def by_colour_science(renderer, first, second):
    """(object mean, object p95, highlight p95) from two frames' bytes, by other code than ours."""
    import colour

    frames = [Drawer(Recipe(), renderer).draw(m, (256, 256)) for m in (first, second)]
    d65 = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]
    labs = [colour.XYZ_to_Lab(colour.sRGB_to_XYZ(f.display / 255.0), d65) for f in frames]
    differences = colour.difference.delta_E(*labs, method="CIE 2000")
    on_object = frames[0].on_object
    tops = []
    for frame in frames:
        shine = np.where(on_object, frame.split[1], 0.0)
        tops.append(np.percentile(differences[shine >= max(shine.max() / 2.0, 1.0)], 95.0))
    inside = differences[on_object]
    return inside.mean(), np.percentile(inside, 95.0), max(tops)


class TestDifference:
    @pytest.mark.parametrize("other", ["cast-coated/1.csv", "uncoated/0.csv", "art-coated/3.csv"])
    def test_against_colour_science(self, renderer, catalogue, other):
        """Their sRGB matrix has four digits more than ours needs: Lab differs by up to 0.01."""
        searcher = Searcher(catalogue)
        found = searcher.search("nearest to cast-coated/0.csv", renderer=renderer)
        numbers = next(hit.numbers for hit in found.hits if hit.path == other)
        pair = (catalogue.materials["cast-coated/0.csv"], catalogue.materials[other])
        mean, p95, highlight = by_colour_science(renderer, *pair)
        wanted = [mean, p95, highlight, max(p95, highlight)]
        keys = ("picture_mean", "picture_p95", "highlight_p95", "picture_difference")
        np.testing.assert_allclose([numbers[key] for key in keys], wanted, atol=0.02)
        assert numbers["picture_difference"] > 1.0

    def test_a_narrow_highlight_is_not_hidden_by_a_broad_one(self):
        """By hand: 4 of 100 pixels shine in one picture, all in the other."""
        lab = np.zeros((10, 10, 3))
        lab[..., 0] = 50.0
        shining = lab.copy()
        shining[:2, :2, 0] = 100.0
        narrow = np.zeros((10, 10))
        narrow[:2, :2] = 50.0
        everywhere = np.ones((10, 10), dtype=bool)
        first = Colours(shining, narrow, everywhere)
        second = Colours(lab, np.full((10, 10), 5.0), everywhere)
        made = PictureDifference.of(first, second)
        assert made.p95 == 0.0
        assert made.highlight_p95 == made.difference > 30.0
        assert np.sum(highlight_of(first)) == 4
        assert np.sum(highlight_of(second)) == 100

    def test_pictures_without_gloss_have_no_highlight(self):
        flat = Colours(np.zeros((4, 4, 3)), np.zeros((4, 4)), np.ones((4, 4), dtype=bool))
        made = PictureDifference.of(flat, flat)
        assert (made.difference, made.highlight_p95) == (0.0, None)


class TestRanking:
    @pytest.fixture(scope="class")
    @classmethod
    def exact(cls, renderer, catalogue):
        """All pictures drawn, nothing left to thumbnails."""
        reference = Searcher(catalogue).search("nearest to art-coated/0.csv").reference
        return redrawn(reference, list(catalogue.materials), catalogue, renderer)

    def test_the_best_are_ranked_exactly(self, renderer, catalogue, exact, monkeypatch):
        """Six are drawn anew: they have the order of all pictures drawn."""
        monkeypatch.setattr("relgloss_view.catalogue.query.search.EXACT_MOST", 6)
        found = Searcher(catalogue).search("nearest to art-coated/0.csv", 4, renderer=renderer)
        wanted = sorted(exact, key=lambda path: (exact[path].difference, path))
        assert paths(found) == wanted[:4]
        assert paths(found)[0] == "art-coated/0.csv"
        assert found.hits[0].numbers["picture_difference"] == 0.0
        assert found.is_exact
        assert "drawn anew" in found.notes[0]

    def test_thumbnails_come_close(self, catalogue, exact):
        """128 of 256 pixels a side, five rows of them, highlights by angle: within a fifth."""
        found = Searcher(catalogue).search("nearest to art-coated/0.csv")
        assert not found.is_exact
        for hit in found.hits:
            wanted = exact[hit.path].difference
            assert abs(hit.numbers["picture_difference"] - wanted) <= 0.2 * wanted + 0.5

    def test_other_thumbnails_are_noticed(self, catalogue, exact):
        """Negative control: with each picture at its neighbour's name the check above fails."""
        pictures = list(catalogue.pictures.values())
        turned = dict(zip(catalogue.pictures, [*pictures[5:], *pictures[:5]], strict=True))
        wrong = MemoryCatalogue(catalogue.rows, catalogue.materials, turned)
        found = Searcher(wrong).search("nearest to art-coated/0.csv")
        far = [
            abs(hit.numbers["picture_difference"] - exact[hit.path].difference)
            > 0.2 * exact[hit.path].difference + 0.5
            for hit in found.hits
        ]
        assert np.mean(far) > 0.5

    def test_conditions_come_first(self, renderer, catalogue):
        query = "nearest to art-coated and name contains uncoated, first 2"
        found = Searcher(catalogue).search(query, renderer=renderer)
        assert len(found.hits) == 2
        assert all(path.startswith("uncoated/") for path in paths(found))
        assert found.total == 4

    def test_another_order_stays(self, renderer, catalogue):
        query = "nearest to art-coated and name contains ink 0 sort by gloss 60"
        found = Searcher(catalogue).search(query, renderer=renderer)
        order = ["uncoated", "matte-coated", "art-coated", "cast-coated"]
        assert paths(found) == [f"{paper}/0.csv" for paper in order]
        assert all("picture_p95" in hit.numbers for hit in found.hits)

    def test_items_without_a_picture_are_left_out_and_counted(self, catalogue):
        some = {path: png for path, png in catalogue.pictures.items() if not path.endswith("1.csv")}
        some["uncoated/2.csv"] = b"\x89PNG\r\n\x1a\n, and no more"
        fewer = MemoryCatalogue(catalogue.rows, catalogue.materials, some)
        found = Searcher(fewer).search("nearest to art-coated")
        assert (found.total, found.left_out, found.missing) == (11, 5, {"thumbnail": 5})

    def test_two_pictures_are_refused(self, catalogue):
        with pytest.raises(QueryError, match="only once"):
            Searcher(catalogue).search("nearest to art-coated and nearest to uncoated")

    def test_compared_pixels_lie_on_the_object(self, renderer):
        """And where cast-coated shines most, the half-vector is nearly the normal."""
        place, delta_deg = nearest._compared_pixels(PX)
        frame = Drawer(Recipe(), renderer).draw(load_sample("cast-coated"), (PX, PX))
        assert np.mean(frame.on_object.reshape(-1)[place]) > 0.99
        shine = frame.split[1].reshape(-1)[place]
        assert delta_deg[np.argmax(shine)] < 3.0
        assert np.max(delta_deg) > 40.0


class TestSheet:
    def test_pictures_lie_on_it(self, catalogue):
        found = Searcher(catalogue).search("sort by name")
        sheet = hits_sheet(found, catalogue.thumbnails(paths(found)), PX)
        assert sheet.dtype == np.uint8
        first = np.asarray(Image.open(io.BytesIO(catalogue.pictures[found.hits[0].path])))
        windows = np.lib.stride_tricks.sliding_window_view(sheet[:, :400], (PX, PX, 3))[
            ..., 0, :, :, :
        ]
        assert any(np.array_equal(w, first) for row in windows[:120] for w in row[:120])

    def test_hits_without_pictures_and_long_names(self):
        name = "A very long name of a varnish that nobody would ever fit below one picture" * 3
        rows = [{"path": f"{k}.csv", "name": name, "gloss_60": 3.0} for k in range(2)]
        rows.append({"path": "\u202ebad.csv", "status": "failed"})
        found = Searcher(MemoryCatalogue(rows)).search("")
        sheet = hits_sheet(found, {}, PX)
        assert sheet.shape[1] < 4 * 1.5 * PX + 100


class TestProofs:
    def test_a_hit_beside_the_reference(self, renderer, catalogue, tmp_path):
        query = "looks 0.3 x as glossy as art-coated and name contains ink 0, first 1"
        found = Searcher(catalogue).search(query)
        (made,) = write_proofs(found, catalogue, tmp_path, renderer)
        assert made.path == "matte-coated/0.csv"
        proof = read_proof(str(tmp_path / made.file))
        assert proof.content["names"]["reference"] == load_sample("art-coated").name
        assert query in proof.messages[0].note
        # what it was found for: the pair's gloss, c L_s*, has the ratio of the readings
        reference, test = proof.sent.reference, proof.sent.test
        assert reference.c != test.c
        assert (tmp_path / MANIFEST).is_file()


@pytest.mark.slow
class TestTenThousand:
    MOST_S = 10.0  #: of processor time; two cores alone take 2 s

    def test_thumbnails_are_compared_in_time(self):
        """Processor time, because others may be at work: the thumbnails are real pictures' size."""
        with open_renderer() as renderer:
            picture = Drawer(Recipe(), renderer).draw(load_sample("art-coated"), (PX, PX)).display
        thumbnails, rows = {}, []
        for k in range(10_000):
            data = io.BytesIO()
            Image.fromarray(np.roll(picture, k % 3, -1) ^ np.uint8(k % 251)).save(data, "PNG")
            path = f"{k:05}.csv"
            thumbnails[path] = data.getvalue()
            rows.append({"path": path})
        searcher = Searcher(MemoryCatalogue(rows, {}, thumbnails))
        start = time.process_time()
        found = searcher.search("nearest to 00005.csv first 3")
        assert time.process_time() - start < self.MOST_S
        assert found.hits[0].path == "00005.csv"
        assert found.total == 10_000
