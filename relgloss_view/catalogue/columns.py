"""The columns of a catalogue's table, declared once: its file, search, page and window use them.

One row is one file of the tree. Names carry their unit; an empty cell is null.
"""

from __future__ import annotations

from dataclasses import dataclass

TABLE_FILE = "catalogue.parquet"  #: in the folder of a catalogue
TEXT, NUMBER, WHOLE, FLAG, BYTES = "text", "number", "whole number", "yes or no", "bytes"
TABLE, MATERIAL, PROOF = "table", "material", "proof"  #: kinds of files
DONE, FAILED = "done", "failed"  #: what became of a file


@dataclass(frozen=True)
class Column:
    """A column: its name in the file, the kind of its values, their unit and meaning."""

    name: str
    kind: str
    unit: str
    meaning: str
    label: str  #: its heading for people


#: Reading.key of gloss/meter -> column; `NAME_se` is the standard error.
READINGS = {
    "gloss-20": "gloss_20",
    "gloss-60": "gloss_60",
    "gloss-75": "gloss_75",
    "gloss-85": "gloss_85",
    "haze": "haze",
    "doi": "doi",
    "contrast-gloss": "contrast_gloss",
    "distinctness": "distinctness",
}

LAB = ("L_star", "a_star", "b_star")  #: columns of the colour

COLUMNS = (
    Column("path", TEXT, "", "the file, from the top of the tree, with /", "file"),
    Column("kind", TEXT, "", "table, material or proof", "kind"),
    Column("status", TEXT, "", "done or failed", "status"),
    Column("fault", TEXT, "", "why it failed, in one line", "fault"),
    Column("sha256", TEXT, "", "digest of the file's bytes", "SHA-256"),
    Column("bytes", WHOLE, "bytes", "size of the file", "size"),
    Column("name", TEXT, "", "name of the sample", "name"),
    Column("source", TEXT, "", "where its data came from", "source"),
    Column("marks", TEXT, "", "synthetic, hypothetical, estimated, described", "marks"),
    Column("material", TEXT, "", "the material's file, from the catalogue", "material"),
    Column("quality", TEXT, "", "good, poor or unidentifiable; empty without a fit", "quality"),
    Column("model", TEXT, "", "the model that the fit has chosen", "model"),
    Column("geometries", WHOLE, "", "geometries that were fitted", "geometries"),
    Column("bands", WHOLE, "", "bands of the material", "bands"),
    Column("diffuse_model", TEXT, "", "lambert, oren-nayar or eon", "diffuse"),
    Column("sigma_deg", NUMBER, "degrees", "roughness of the diffuse part", "diffuse roughness"),
    Column("lobes", WHOLE, "", "specular lobes that reflect", "lobes"),
    Column("s_deg_1", NUMBER, "degrees", "width of the brightest lobe", "lobe width"),
    Column("s_deg_2", NUMBER, "degrees", "width of the next lobe", "second lobe width"),
    Column("L_star", NUMBER, "", "CIELAB 45/0 under D50, 2 degrees", "L*"),
    Column("a_star", NUMBER, "", "CIELAB 45/0 under D50, 2 degrees", "a*"),
    Column("b_star", NUMBER, "", "CIELAB 45/0 under D50, 2 degrees", "b*"),
    Column("gloss_20", NUMBER, "GU", "specular gloss at 20 degrees, ISO 2813", "gloss 20"),
    Column("gloss_20_se", NUMBER, "GU", "its standard error", "gloss 20, error"),
    Column("gloss_60", NUMBER, "GU", "specular gloss at 60 degrees, ISO 2813", "gloss 60"),
    Column("gloss_60_se", NUMBER, "GU", "its standard error", "gloss 60, error"),
    Column("gloss_75", NUMBER, "GU", "paper gloss at 75 degrees, ISO 8254-1", "gloss 75"),
    Column("gloss_75_se", NUMBER, "GU", "its standard error", "gloss 75, error"),
    Column("gloss_85", NUMBER, "GU", "specular gloss at 85 degrees, ISO 2813", "gloss 85"),
    Column("gloss_85_se", NUMBER, "GU", "its standard error", "gloss 85, error"),
    Column("haze", NUMBER, "", "reflection haze at 20 degrees, ASTM E430", "haze"),
    Column("haze_se", NUMBER, "", "its standard error", "haze, error"),
    Column("doi", NUMBER, "", "distinctness of image at 30 degrees, ASTM E430", "DOI"),
    Column("doi_se", NUMBER, "", "its standard error", "DOI, error"),
    Column("contrast_gloss", NUMBER, "", "contrast gloss c, Pellacini 2000", "contrast gloss"),
    Column("contrast_gloss_se", NUMBER, "", "its standard error", "contrast gloss, error"),
    Column("distinctness", NUMBER, "", "distinctness d, Pellacini 2000", "distinctness"),
    Column("distinctness_se", NUMBER, "", "its standard error", "distinctness, error"),
    Column("gloss_ratio", NUMBER, "", "gloss over the reference's", "x the reference"),
    Column("sigma_n_deg", NUMBER, "degrees", "graininess sigma_N of its picture", "graininess"),
    Column("c", NUMBER, "", "contrast gloss c that keeps the ratio", "c"),
    Column("c_spread", NUMBER, "", "largest c that a pose proposes over the smallest", "c, spread"),
    Column("c_max", NUMBER, "", "largest c that its picture shows without clipping", "c_max"),
    Column("is_ratio_kept", FLAG, "", "whether its thumbnail shows c, at most c_max", "ratio kept"),
    Column("warnings", TEXT, "", "a line each", "warnings"),
    Column("thumbnail", BYTES, "PNG", "its picture in the paper's geometry, sRGB", "picture"),
)
BY_NAME = {column.name: column for column in COLUMNS}
NAMES = tuple(BY_NAME)
