"""Material JSON: what is written is read back; what is broken is refused in one line."""

from __future__ import annotations

import json
import re
import sys
from dataclasses import replace

import materials
import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.base.resources import asset
from relgloss_view.material import files
from relgloss_view.material.files import (
    load_material,
    material_from_dict,
    material_to_dict,
    save_material,
)
from relgloss_view.material.material import Diffuse, FitRecord, Lobe, Material, Quality
from relgloss_view.measure.bands import RGB, WIDE_RGB, Bands


def test_round_trip(tmp_path):
    record = FitRecord(
        candidates=({"name": "lambert", "cv": [0.1, 0.2]},), chosen="lambert", warnings=("w",)
    )
    for material in (
        materials.paper("art"),
        Material("rgb", "made up", RGB, Diffuse("eon", (0.1, 0.2, 0.3), 10.0), (), record),
        Material(
            "lobes",
            "made up",
            RGB,
            Diffuse("lambert", (0.0, 0.0, 1.0)),
            (Lobe((0.1, 0.2, 0.3), 0.05, 1.0), Lobe((2.0,), 40.0, 1.7)),
        ),
    ):
        save_material(material, tmp_path / "m.json")
        assert load_material(tmp_path / "m.json") == material


def test_file_follows_the_published_format(tmp_path):
    save_material(materials.paper("art"), tmp_path / "m.json")
    content = json.loads((tmp_path / "m.json").read_text())
    assert content["format"] == "relgloss-material"
    assert content["version"] == 1
    assert content["basis"] == "spectral"
    assert set(content["diffuse"]) == {"model", "albedo", "sigma_deg"}
    assert set(content["specular"][0]) == {"model", "strength", "refractive_index", "s_deg"}
    assert content["specular"][0]["strength"] == 1.0
    assert len(content["wavelengths_nm"]) == len(content["diffuse"]["albedo"]) == 35


@pytest.mark.parametrize(
    ("source", "synthetic", "hypothetical"),
    [
        ("synthetic", True, False),
        ("Synthetic (made up)", True, False),
        ("card on synthetic leather, GCMS-4", False, False),
        ("", False, False),
        ("synthetic, hypothetical: width of lobe 1 set", True, True),
        ("hypothetical: made from card (synthetic)", False, True),
        ("GCMS-4: a hypothetical standard", False, False),
    ],
)
def test_an_old_file_is_marked_by_its_source(tmp_path, source, synthetic, hypothetical):
    """Files without the fields: the source begins with the word, or has it before a colon."""
    (tmp_path / "m.json").write_text(changed(("source",), source))
    material = load_material(tmp_path / "m.json")
    assert (material.synthetic, material.hypothetical) == (synthetic, hypothetical)
    assert not {"synthetic", "hypothetical"} & material_to_dict(material).keys()


@pytest.mark.parametrize("mark", ["synthetic", "hypothetical"])
@pytest.mark.parametrize("source", ["GCMS-4", "synthetic, hypothetical: made up"])
def test_a_mark_that_the_source_contradicts_is_a_field(tmp_path, source, mark):
    plain = replace(materials.flat(), source=source, synthetic=False, hypothetical=False)
    for value in (False, True):
        material = replace(plain, **{mark: value})
        save_material(material, tmp_path / "m.json")
        assert load_material(tmp_path / "m.json") == material
        content = json.loads((tmp_path / "m.json").read_text())
        assert content.get(mark) == (None if value == source.startswith("synthetic") else value)
        content[mark] = "yes"
        (tmp_path / "m.json").write_text(json.dumps(content))
        with pytest.raises(InputError, match=f"{mark}: expected true or false"):
            load_material(tmp_path / "m.json")


@pytest.mark.parametrize(
    ("quality", "warnings", "grounds"),
    [
        ("poor", ["dark", "no model describes this sample"], 1),
        ("poor", ["dark"], 0),
        ("unidentifiable", ["s is unidentifiable, at most 1 deg", "dark"], 1),
        ("good", ["a poor lamp"], 0),
    ],
)
def test_what_explains_the_quality_is_read_from_the_warnings(tmp_path, quality, warnings, grounds):
    fit = {"quality": quality, "warnings": warnings}
    (tmp_path / "m.json").write_text(changed(("fit",), fit))
    material = load_material(tmp_path / "m.json")
    assert material.fit.quality is Quality(quality)
    assert len(material.fit.grounds) == grounds
    assert set(material.fit.grounds) <= set(warnings)
    assert len(material.warnings) == len(warnings) + (quality != "good" and not grounds)
    written = material_to_dict(material)["fit"]
    assert written["quality"] == quality
    assert json.loads(json.dumps(written))["warnings"] == warnings
    assert tuple(written["grounds"]) == material.fit.grounds


def changed(path, value):
    content = material_to_dict(materials.paper("art"))
    target = content
    if not path:
        return json.dumps(content)
    for key in path[:-1]:
        target = target[key]
    if value is None:
        target.pop(path[-1], None) if isinstance(target, dict) else target.pop(path[-1])
    else:
        target[path[-1]] = value
    return json.dumps(content)


@pytest.mark.parametrize(
    ("path", "value", "place"),
    [
        (("format",), "other", "format"),
        (("version",), 2, "version"),
        (("version",), None, "version"),
        (("basis",), "xyz", "basis"),
        (("name",), 7, "name"),
        (("wavelengths_nm",), [400, 400], "wavelengths_nm"),
        (("wavelengths_nm", 3), -400, "wavelengths_nm[3]"),
        (("wavelengths_nm", 3), 410.4, "wavelengths_nm[3]"),
        (("wavelengths_nm", 34), 3001, "wavelengths_nm[34]"),
        (("diffuse",), None, "diffuse"),
        (("diffuse", "model"), None, "diffuse.model"),
        (("diffuse", "model"), "phong", "diffuse.model"),
        (("diffuse", "albedo"), [0.1], "diffuse.albedo"),
        (("diffuse", "albedo", 2), -0.1, "diffuse.albedo[2]"),
        (("diffuse", "albedo", 2), True, "diffuse.albedo[2]"),
        (("diffuse", "sigma_deg"), 90, "diffuse.sigma_deg"),
        (("specular",), {}, "specular"),
        (("specular", 0, "model"), "ggx", "specular[0].model"),
        (("specular", 0, "s_deg"), 0, "specular[0].s_deg"),
        (("specular", 0, "s_deg"), -1, "specular[0].s_deg"),
        (("specular", 0, "s_deg"), 41, "specular[0].s_deg"),
        (("specular", 0, "refractive_index"), 0.9, "specular[0].refractive_index"),
        (("specular", 0, "strength"), [1, 2], "specular[0].strength"),
        (("specular", 0, "strength"), "1", "specular[0].strength"),
        (("specular", 0, "strength"), 10**400, "specular[0].strength"),
    ],
)
def test_faults_name_file_and_field(tmp_path, path, value, place):
    file = tmp_path / "broken.json"
    file.write_text(changed(path, value))
    with pytest.raises(InputError) as caught:
        load_material(file)
    message = str(caught.value)
    assert "broken.json" in message
    assert place in message
    assert "expected" in message
    assert "\n" not in message


@pytest.mark.parametrize(
    "text",
    ["", "{", "[]", "null", '{"format": NaN}', '{"a": 1, "a": 2}', "[" * 100_000, '"\\ud800"'],
)
def test_not_a_material(tmp_path, text):
    file = tmp_path / "broken.json"
    file.write_text(text)
    with pytest.raises(InputError, match=r"broken\.json"):
        load_material(file)


def test_not_text_not_there_not_a_file(tmp_path):
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe\x00")
    for name in ("bytes.json", "absent.json", "."):
        with pytest.raises(InputError):
            load_material(tmp_path / name)


def test_very_narrow_lobe_is_kept_drawn_wider_and_told(tmp_path):
    file = tmp_path / "narrow.json"
    file.write_text(changed(("specular", 0, "s_deg"), 0.01))
    material = load_material(file)
    lobe = material.specular[0]
    assert lobe.s_deg == 0.01
    assert np.degrees(lobe.s) == pytest.approx(0.05)
    assert any("narrower than 0.05" in warning for warning in material.warnings)
    save_material(material, file)
    assert load_material(file) == material
    assert Lobe((1.0,), 0.05 * (1 - 1e-12)).too_narrow is False


def test_failed_write_leaves_nothing(tmp_path):
    save_material(materials.paper("art"), tmp_path / "kept.json")
    before = (tmp_path / "kept.json").read_bytes()
    for record in (FitRecord(residuals={"rms": float("nan")}), FitRecord(chosen="lone \ud800")):
        bad = Material("x", "x", RGB, Diffuse("lambert", (0.1,) * 3), (), record)
        with pytest.raises(InputError, match=r"kept\.json"):
            save_material(bad, tmp_path / "kept.json")
    assert (tmp_path / "kept.json").read_bytes() == before
    with pytest.raises(InputError, match="can't be written"):
        save_material(materials.paper("art"), tmp_path / "no" / "folder.json")
    assert [p.name for p in tmp_path.iterdir()] == ["kept.json"]


def test_a_byte_order_mark_is_no_fault(tmp_path):
    (tmp_path / "m.json").write_text(changed((), None), encoding="utf-8-sig")
    assert load_material(tmp_path / "m.json") == materials.paper("art")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[" * 100_000, "nested too deeply"),
        ('{"format": ' + "[" * 700 + "]" * 700 + "}", "nested too deeply"),
        ('{"seed": ' + "9" * 5000 + "}", "a number of 5000 digits"),
        ('{"name": "\\ud800"}', "lone surrogate"),
        ('{"format": "relgloss-material", "version": 1, "fit": 1e999}', "basis"),
    ],
)
def test_python_does_not_speak_to_the_user(tmp_path, text, says):
    file = tmp_path / "broken.json"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        load_material(file)
    message = str(caught.value)
    assert says in message
    assert "recursion" not in message
    assert "set_int" not in message
    assert len(message) < 250


def test_a_pair_of_surrogates_is_a_character(tmp_path):
    file = tmp_path / "m.json"
    file.write_text(changed(("name",), "\U0001f58c"))
    assert "\\ud83d" in file.read_text()
    assert load_material(file).name == "\U0001f58c"


def test_infinity_in_the_evidence_is_refused(tmp_path):
    content = json.loads(changed((), None))
    content["fit"] = {"seconds": 0}
    file = tmp_path / "m.json"
    file.write_text(json.dumps(content).replace('"seconds": 0', '"seconds": 1e999'))
    with pytest.raises(InputError, match=r"m\.json: fit: expected finite numbers"):
        load_material(file)


#: Any text that a file can hold, and texts that look like JSON.
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=40) | st.text(
    '[]{},:"\\ \n\t12.eE+-', max_size=40
)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=TEXTS, source=TEXTS, warning=TEXTS)
@example("lot [ 12 ]", "[" + 4000 * " ", "[ 1,\n 2 ]")
def test_any_text_is_written_as_it_is(tmp_path, name, source, warning):
    record = FitRecord(candidates=({"name": name, name: [1.5, 2]},), warnings=(warning,))
    material = replace(materials.paper("art"), name=name, source=source, fit=record)
    save_material(material, tmp_path / "m.json")
    assert load_material(tmp_path / "m.json") == material
    # Python's own writer knows nothing of lines: the content is that of the object.
    content = json.loads((tmp_path / "m.json").read_text(encoding="utf-8"))
    assert content == json.loads(json.dumps(material_to_dict(material)))


def test_lists_of_numbers_take_one_line_and_the_sample_papers_keep_their_bytes():
    for name in ("cast-coated", "art-coated", "matte-coated", "uncoated"):
        text = asset("materials", f"{name}.json").read_text(encoding="utf-8")
        assert files._written(json.loads(text)) + "\n" == text
    assert '"albedo": [0.0' in text
    assert '"s_deg": []' in text


def calls_of(action):
    """How many functions of Python and of C an action calls, and which of them are of `re`."""
    calls = []

    def note(frame, event, argument):
        if event in ("call", "c_call"):
            called = argument if event == "c_call" else frame.f_code
            calls.append(isinstance(getattr(called, "__self__", None), re.Pattern))

    sys.setprofile(note)
    try:
        action()
    finally:
        sys.setprofile(None)
    return len(calls), sum(calls)


def test_the_work_does_not_depend_on_what_a_text_says():
    """A text is one call of json's encoder, however long and whatever its brackets.

    No search goes over what was written: that took 39 s for a bracket and 4,000 spaces.
    """

    def work(name):
        content = material_to_dict(replace(materials.paper("art"), name=name))
        return calls_of(lambda: files._written(content))

    assert work("[" + 64_000 * " ") == work("[" + 4000 * " ") == work("a")
    assert work("a")[1] == 0
    text = "[" + 100 * " "
    assert calls_of(lambda: re.compile(r"\[\s+").sub("[", text))[1] > 0  # control


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=8,
)
PLACES = [
    ("format",), ("version",), ("name",), ("source",), ("basis",), ("wavelengths_nm",), ("fit",),
    ("diffuse",), ("diffuse", "albedo"), ("diffuse", "sigma_deg"), ("specular",), ("specular", 0),
    ("specular", 0, "strength"), ("specular", 0, "s_deg"), ("specular", 0, "refractive_index"),
]  # fmt: skip


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(path=st.sampled_from(PLACES), value=JSON)
def test_any_value_anywhere_is_read_or_refused(tmp_path, path, value):
    file = tmp_path / "fuzz.json"
    file.write_text(changed(path, value))
    try:
        material = load_material(file)
    except InputError as error:
        assert "\n" not in str(error)
    else:
        assert material.bands.count == len(material.diffuse.albedo)


def test_a_colour_outside_srgb_keeps_its_basis(tmp_path):
    wide = Material("sunflower", "by hand", WIDE_RGB, Diffuse("lambert", (0.65, 0.42, 0.02)))
    path = tmp_path / "sunflower.json"
    save_material(wide, path)
    assert load_material(path) == wide
    content = json.loads(path.read_text())
    assert content["basis"] == "rec2020"
    content["basis"] = "cmyk"
    with pytest.raises(InputError, match='basis: expected "spectral", "rgb" or "rec2020"'):
        material_from_dict(content)
    with pytest.raises(InputError, match="primaries: expected one of srgb, rec2020"):
        Bands(primaries="adobe")
    with pytest.raises(InputError, match="none beside wavelengths"):
        Bands((400.0, 500.0), primaries="rec2020")


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (
            b"Symmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n",
            "Zemax BSDF",
        ),
        (b"<?xml version='1.0'?><WindowElement/>", "BSDF in XML"),
        (b"\x89HDF\r\n\x1a\n", "AxF"),
        (b"tensor_file\0\1\0", "RGL"),
        (b"PK\x03\x04xl/workbook.xml", "spreadsheet"),
    ],
)
def test_a_file_of_another_program_is_named(tmp_path, content, name):
    path = tmp_path / "art.json"
    path.write_bytes(content)
    with pytest.raises(InputError, match=f"this looks like .*{name}"):
        load_material(path)
