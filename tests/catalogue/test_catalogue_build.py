"""A catalogue holds what fit, gloss, match and snapshot give; pandas and DuckDB read it."""

from __future__ import annotations

import dataclasses
import io
import json

import materials
import numpy as np
import pytest
from catalogue_trees import contents, save, small_table
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.base.reading import sha256_of
from relgloss_view.catalogue.build import BuildOptions, build
from relgloss_view.catalogue.catalogue import Catalogue
from relgloss_view.catalogue.columns import COLUMNS, LAB, NAMES, READINGS
from relgloss_view.catalogue.look import draw, match_of, setting_of
from relgloss_view.catalogue.one_thread import one_thread
from relgloss_view.catalogue.recipe import Recipe
from relgloss_view.catalogue.work import close_renderer, make_item
from relgloss_view.fitting import fit_material
from relgloss_view.gloss.match import Reference, full_c, matched
from relgloss_view.gloss.meter.meter import gloss_readings
from relgloss_view.material.files import load_material, material_to_dict, save_material
from relgloss_view.material.material import Lobe
from relgloss_view.measure.readers import read_measurement
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.scene import Scene
from relgloss_view.quality.backends import open_renderer

RECIPE = Recipe(fit={"model": "lobe"})


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tree") / "stock"
    small_table(folder / "tables" / "art.csv")
    save(folder / "cast.json", "cast")
    save(folder / "papers" / "matte.json", "matte")
    (folder / "README.md").write_text("no sample", encoding="utf-8")
    (folder / ".hidden.json").write_bytes((folder / "cast.json").read_bytes())
    return folder


@pytest.fixture(scope="module")
def built(tree):
    catalogue = tree.parent / "catalogue"
    report = build(tree, catalogue, RECIPE)
    assert (report.done, report.failed, report.worked, report.passed_over) == (3, 0, 3, 1)
    return Catalogue.open(catalogue)


def test_pandas_reads_the_table(built):
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_parquet(built.table)
    assert tuple(frame.columns) == NAMES
    assert list(frame["path"]) == ["cast.json", "papers/matte.json", "tables/art.csv"]
    for row, other in zip(built.rows, frame.to_dict("records"), strict=True):
        assert row["gloss_60"] == other["gloss_60"]
    # The mean is taken over numbers, and text would have none.
    assert frame["gloss_60"].dtype == np.float64
    assert frame["thumbnail"].map(type).eq(bytes).all()


def test_duckdb_reads_the_table(built):
    duckdb = pytest.importorskip("duckdb")
    query = f"select path from '{built.table}' where gloss_60 > 40 and status = 'done'"
    found = {row[0] for row in duckdb.sql(query).fetchall()}
    assert found == {row["path"] for row in built.rows if row["gloss_60"] > 40.0}
    assert 0 < len(found) < 3


def test_a_row_has_the_readings_of_its_material(built):
    for row in built.rows:
        with one_thread():  # as every engine has it
            readings = gloss_readings(built.material(row["path"]))
        for reading in readings:
            assert row[READINGS[reading.key]] == reading.value
            assert row[f"{READINGS[reading.key]}_se"] == reading.standard_error
    assert built.row("tables/art.csv")["gloss_60_se"] > 0.0
    assert built.row("cast.json")["gloss_60_se"] is None


def test_a_table_has_the_material_of_a_fit(built, tree):
    with one_thread():
        fitted = fit_material(read_measurement(tree / "tables" / "art.csv"), model="lobe")
    assert fitted.fit is not None
    assert fitted.fit.seconds > 0.0
    timeless = dataclasses.replace(fitted, fit=dataclasses.replace(fitted.fit, seconds=0.0))
    expected = json.loads(json.dumps(material_to_dict(timeless)))
    found = built.material("tables/art.csv")
    assert json.loads(json.dumps(material_to_dict(found))) == expected
    row = built.row("tables/art.csv")
    assert (row["quality"], row["model"]) == (str(fitted.fit.quality), fitted.fit.chosen)
    assert row["material"] == "materials/tables/art.csv.json"


def test_the_setting_is_that_of_match(built):
    for row in built.rows:
        match = matched(Reference.default(), built.material(row["path"]), 0.0)
        assert row["c"] == pytest.approx(match.test_c, rel=1e-12)  # rounding of several threads
        assert row["c_spread"] == pytest.approx(match.spread, rel=1e-12)
        assert row["c_max"] == pytest.approx(full_c(built.material(row["path"])), rel=1e-12)
        assert row["is_ratio_kept"] == (row["c"] <= row["c_max"])


def test_a_ratio_that_would_clip_is_cut_and_marked():
    white = materials.flat(0.9, (Lobe((1.0,), 4.0),))
    match = match_of(white, RECIPE)
    assert match.c is not None
    assert match.c_max is not None
    assert match.c > 1.2 * match.c_max
    with open_renderer() as renderer:
        frame = draw(white, RECIPE, renderer)
        assert setting_of(match, frame, 0.0)["is_ratio_kept"] is False
        assert frame.clip_count == 0
        # A tenth more would clip, so nothing was given away.
        look = frame.look.with_entries(c=1.1 * frame.c)
        assert renderer.render(frame.scene, look, frame.size).clip_count > 0


def test_grain_is_drawn_and_bounds_c_by_its_own_picture():
    paper = materials.paper("cast")
    with open_renderer() as renderer:
        frame = draw(paper, RECIPE, renderer, (64, 64), sigma_n_deg=2.0)
        row = setting_of(match_of(paper, RECIPE, 2.0), frame, 2.0)
        assert frame.look.sigma_n_deg == row["sigma_n_deg"] == 2.0
        assert row["c_max"] == pytest.approx(frame.c_max)
        assert frame.c <= frame.c_max * (1.0 + 1e-5)


def test_a_material_without_a_lobe_has_a_picture_and_no_c(tmp_path):
    save_material(materials.flat(0.5), tmp_path / "tree.json")
    item = make_item(
        str(tmp_path / "tree.json"),
        "tree.json",
        "material",
        sha256_of(tmp_path / "tree.json", "a material")[0],
        RECIPE,
    )
    close_renderer()
    assert not item.failed
    assert item.row["thumbnail"]
    assert (item.row["c"], item.row["c_max"], item.row["is_ratio_kept"]) == (None, None, None)


def test_a_thumbnail_is_the_picture_at_its_c(built):
    with open_renderer() as renderer:
        for row in built.rows:
            c = min(row["c"], row["c_max"])
            look = Look(c=c, grain="eye")
            frame = renderer.render(Scene(built.material(row["path"])), look, (128, 128))
            expected = np.asarray(frame.display)
            other = renderer.render(
                Scene(built.material(row["path"])), look.with_entries(c=0.5 * c), (128, 128)
            )
            seen = np.asarray(Image.open(io.BytesIO(built.thumbnail(row["path"]))).convert("RGB"))
            np.testing.assert_array_equal(seen, expected)
            assert (np.asarray(other.display) != expected).any()  # the test sees another c
    close_renderer()


def test_the_colour_is_that_of_45_0(built):
    """By colour-science: it sums each nanometre, the row the bands of 10 nm, so 0.3 are between."""
    import colour

    material = built.material("cast.json")
    up, at_45 = np.array([[0.0, 0.0, 1.0]]), np.array([[0.5**0.5, 0.0, 0.5**0.5]])
    factors = np.pi * sum(material.evaluate(at_45, up))[0]
    spectrum = dict(zip(material.bands.wavelengths_nm, factors, strict=True))
    lamp = colour.SDS_ILLUMINANTS["D50"]
    with colour.utilities.suppress_warnings(colour_runtime_warnings=True):  # the lamp has 5 nm
        xyz = colour.sd_to_XYZ(colour.SpectralDistribution(spectrum), illuminant=lamp) / 100.0
    white = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D50"]
    row = built.row("cast.json")
    found = [row[name] for name in LAB]
    np.testing.assert_allclose(found, colour.XYZ_to_Lab(xyz, white), atol=0.3)
    assert row["a_star"] < -10.0  # a green solid: the check sees colour


def test_the_file_states_what_it_was_made_with(built):
    assert built.recipe == RECIPE
    assert built.metadata["drivers"]
    assert built.metadata["program"]
    units = {column.name: column.unit for column in COLUMNS}
    import pyarrow.parquet

    schema = pyarrow.parquet.read_schema(built.table)
    for name, unit in units.items():
        assert (schema.field(name).metadata or {})[b"unit"].decode() == unit


def test_only_what_has_changed_is_done(built, tree, tmp_path):
    import shutil

    stock, catalogue = tmp_path / "stock", tmp_path / "catalogue"
    shutil.copytree(tree, stock)
    shutil.copytree(built.folder, catalogue)

    def counts(recipe=RECIPE, **options):
        report = build(stock, catalogue, recipe, BuildOptions(**options))
        return report.worked, report.drawn_again, report.unchanged, report.removed

    before = contents(catalogue)
    assert counts() == (0, 0, 3, 0)
    assert contents(catalogue) == before
    (stock / "cast.json").touch()
    assert counts() == (0, 0, 3, 0)
    (stock / "papers").rename(stock / "boards")  # a folder's name decides nothing
    assert counts() == (0, 0, 3, 1)
    assert next(row["path"] for row in Catalogue.open(catalogue).rows) == "boards/matte.json"
    (stock / "lot").mkdir()
    shutil.copy(stock / "cast.json", stock / "lot" / "cast.json")  # an equal file shares the work
    assert counts() == (0, 0, 3, 0)
    save(stock / "cast.json", "uncoated")
    assert counts() == (1, 0, 3, 0)
    (stock / "lot" / "cast.json").unlink()
    assert counts() == (0, 0, 3, 1)
    other = dataclasses.replace(RECIPE, reference="art-coated")
    assert counts(other) == (0, 3, 0, 0)
    ratio = Catalogue.open(catalogue).row("cast.json")["gloss_ratio"]
    reference = Reference.default().reading
    own = Catalogue.open(catalogue).row("cast.json")["gloss_75"]
    assert ratio != pytest.approx(own / reference)
    assert counts(dataclasses.replace(other, fit={"model": "lambert"})) == (1, 0, 2, 0)
    assert len(list((catalogue / "items").rglob("*.json"))) == 3


def test_what_another_version_has_made_is_made_again(built, tree, tmp_path, monkeypatch):
    import shutil

    from relgloss_view.catalogue import recipe, store

    shutil.copytree(built.folder, tmp_path / "old")
    for module in (recipe, store):
        monkeypatch.setattr(module, "MADE_BY", "0.0.1, 1")
    assert build(tree, tmp_path / "old", RECIPE, BuildOptions()).worked == 3


def test_another_reference_by_way_of_the_store_gives_the_same_bytes(built, tree, tmp_path):
    other = dataclasses.replace(RECIPE, reference="uncoated", reference_sigma_n_deg=1.0)
    build(tree, tmp_path / "fresh", other)
    import shutil

    shutil.copytree(built.folder, tmp_path / "renewed")
    build(tree, tmp_path / "renewed", other)
    assert contents(tmp_path / "fresh") == contents(tmp_path / "renewed")


def test_a_reference_without_gloss_is_refused_before_anything_is_written(tree, tmp_path):
    body = material_to_dict(load_material(tree / "cast.json")) | {"specular": []}
    recipe = Recipe(reference=json.loads(json.dumps(body)))
    with pytest.raises(InputError, match="no highlight"):
        build(tree, tmp_path / "catalogue", recipe)
    assert not (tmp_path / "catalogue").exists()
