"""Faults that know a format: its words exchanged, its counts absurd, its elements nested.

`fault_of` draws one of them for a reader.
"""

from __future__ import annotations

import random
import re

_ANGLES = "theta_i_deg phi_i_deg theta_r_deg phi_r_deg alpha_deg beta_deg gamma_deg"
_TABLE = (
    f"{_ANGLES} theta_i phi_o R G B 400 500nm R600 wavelength_nm brdf radiance-factor sample value "
    "quantity brdf-cos radiance-factor-percent deg rad % name source gamma_s_deg angle_unit "
    "radians aperture_sd_deg saturation mean sep=,"
)
_SAMPLES = (
    "NUMBER_OF_FIELDS NUMBER_OF_SETS BEGIN_DATA_FORMAT END_DATA_FORMAT BEGIN_DATA END_DATA "
    "CGATS.17 CTI3 SAMPLE_NAME SAMPLE_ID GEOMETRY LAB_L LAB_A LAB_B SPECTRAL_NM_400 SPECTRAL_NM "
    "SPECTRAL_PCT SPEC_450 SPECTRAL_BANDS SPECTRAL_START_NM SPECTRAL_END_NM SPECTRAL_NORM "
    "DEVICE_CLASS DISPLAY "
    "MEASUREMENT_GEOMETRY 45as15 45as-15 45as45 15as45 CxF Object ObjectCollection ColorValues "
    "ReflectanceSpectrum CustomSpectrum SpectralPoint ColorSpecification MeasurementSpec "
    "MultiAngle BRDFAngle Aspecular Azimuth IlluminationAngle WavelengthRange StartWL Increment "
    "WL Notation "
    "Name Id ColorCIELab Spectrum_Reflectance Spectrum_Transmittance SingleAngle SphereGeometry"
)
#: The words of each reader's formats, any of which may stand in another's place.
VOCABULARY: dict[str, str] = {
    "measurement": _TABLE,
    "declared": _TABLE,
    "zemax": "Source Symmetry PlaneSymmetrical ASymmetrical Asymmetrical4D SpectralContent "
    "Monochrome XYZ ScatterType BRDF BTDF SampleRotation AngleOfIncidence ScatterAzimuth "
    "ScatterRadial TristimulusX TristimulusY TristimulusZ DataBegin DataEnd TIS",
    "bsdf-xml": "WindowElement Optical Layer Material Name DataDefinition IncidentDataStructure "
    "Columns Rows TensorTree3 AngleBasis AngleBasisName AngleBasisBlock Theta nPhis ThetaBounds "
    "LowerTheta UpperTheta WavelengthData Wavelength Visible Solar CIE-X CIE-Z NIR "
    "WavelengthDataBlock WavelengthDataDirection Front Back Transmission Reflection "
    "ColumnAngleBasis RowAngleBasis ScatteringDataType ScatteringData BRDF BTDF LBNL/Klems",
    "ssdd": "VERSION DATA_TYPE brdf btdf specular_reflectance COLOR_MODEL rgb xyz spectrum "
    "monochrome PARAM_TYPE spherical_coordinate_system specular_coordinate_system "
    "half_difference_coordinate_system REDUCTION_TYPE bilateral_symmetry reciprocity PARAM0_LIST "
    "PARAM1_LIST PARAM2_LIST PARAM3_LIST PARAM4_LIST WAVELENGTH_LIST NAME DEVICE DATA ascii binary",
    "speos": "OPTIS Anisotropic BSDF brdf surface file v8.0 v7.0 0 1 End of",
    "astm-e1392": "VARS theta_i phi_i theta_s phi_s theta_r R G B X Y Z 450nm BRDF CCBRDF "
    "NUM_POINTS ANGLE_UNIT degrees radians TITLE SAMPLE",
    "alta": "#DIM #PARAM_IN #PARAM_OUT #VS #FORMAT binary RUSIN_TH_TD_PD RUSIN_TH_TD STARK_3D "
    "SPHERICAL_TL_PL_TV_PV CARTESIAN COS_TH COS_TH_TD ISOTROPIC_TV_TL_DPHI RGB_COLOR XYZ_COLOR "
    "INV_STERADIAN INV_STERADIAN_COSINE_FACTOR UNKNOWN_INPUT UNKNOWN_OUTPUT",
    "spectrum": f"nm wavelength R% reflectance % percent a b name {_TABLE}",
    "samples": _SAMPLES,
    "lamp": "nm wavelength power sep=, counts W/nm um 400nm %",
    "estimate": "20= 60= 75= 85= 20=12.3 60=45 nan inf -0 1e308 , ; = 46,-50,25 D65 D50 A",
}
_MTLX = (
    "materialx surfacematerial open_pbr_surface standard_surface gltf_pbr UsdPreviewSurface input "
    "output nodegraph nodename interfacename constant dot convert value in type name float color3 "
    "string colorspace srgb_texture lin_rec709 acescg surfaceshader base_color base_weight "
    "specular_roughness specular_ior coat_weight base_metalness metalness roughness ior include "
    "relgloss_material relgloss_digest 0.5,0.5 displacementshader"
)
_GLTF = (
    "asset version materials pbrMetallicRoughness baseColorFactor metallicFactor roughnessFactor "
    "baseColorTexture metallicRoughnessTexture extensions KHR_materials_specular specularFactor "
    "specularColorFactor KHR_materials_ior ior KHR_materials_clearcoat clearcoatFactor index "
    "source textures images bufferViews buffers byteLength byteOffset uri extras relgloss finishes "
    "digest material surface KHR_materials_unlit KHR_materials_pbrSpecularGlossiness alphaMode"
)
VOCABULARY |= {
    "tensor-tree": "{ } {{ }} { 0.1 } TensorTree3 TensorTree4 LBNL/Shirley-Chiu Visible CIE-u "
    "CIE-v Reflection Front Back Transmission ScatteringData Wavelength AngleBasis BTDF BRDF",
    "mtlx": _MTLX,
    "import": f"{_MTLX} {_GLTF}",
    "gltf-material": _GLTF,
    "query": "gloss 20 60 75 85 between and or not but ( ) ((((( ))))) , ; within dE dE76 of 50,20 "
    "colour near looks x as glossy like nearest to cast-coated uncoated name contains is \" ' sort "
    "by order descending first top limit > < >= <= = != haze lobe width quality good kind table "
    "empty known L* a* b* closeness * % nan inf 1e999 -1e308 /dev/zero . .. / all",
}
_COUNTS = (
    b"0", b"-1", b"1", b"2", b"3", b"7", b"1000", b"100000", b"1000000", b"9999999", b"10000000",
    b"2147483647", b"2147483648", b"4294967295", b"18446744073709551616", b"9" * 400, b"1e9",
    b"0.5", b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"-0", b"-0.0", b"1e-320", b"0x7f", b"",
    b"+3", b"3.0", b"\xd9\xa3", b"1 000", b"1,5", b"1e999",
)  # fmt: skip
_NUMBER = re.compile(rb"(?<![\w.])[+-]?\d+\.?\d*(?:[eE][+-]?\d+)?(?![\w.])")
_ELEMENT = re.compile(rb"<(\w[\w:]*)(?:\s[^<>]*)?>[^<>]*</\1>")
_TAG = re.compile(rb"<\w[^<>]*?(?=/?>)")
_XML = (
    b'<!DOCTYPE a [<!ENTITY b "c">]>', b'<!DOCTYPE a SYSTEM "file:///etc/passwd">', b"&b;", b"&lt;",
    b"&#0;", b"&#x1b;", b"&#99999999;", b"<![CDATA[ 0.5 ]]>", b"<!-- -- -->", b"<!--", b"<?a b?>",
    b"<?xml version='1.1'?>", b"</", b"<a/>", b"]]>", b"<a:b xmlns:a='urn:c'/>", b"&amp;" * 500,
    b"<!ENTITY % a 'b'>%a;",
)  # fmt: skip


def fault_of(name: str, data: bytes, rng: random.Random) -> bytes:
    """The data with one fault of the formats of a reader of VOCABULARY."""
    vocabulary = [word.encode() for word in VOCABULARY[name].split()]
    kinds = [_exchanged, _exchanged, _counted, _counted, _without, _again, _lists, _extreme]
    if data.lstrip()[:1] == b"<":
        kinds += [_marked, _attributes, _nested, _moved] * 2
    return rng.choice(kinds)(data, vocabulary, rng)


def _place(data: bytes, vocabulary: list[bytes], rng: random.Random) -> tuple[int, int]:
    """Begin and end of an occurrence of one of the words; an empty place where there is none."""
    for _ in range(8):
        word = rng.choice(vocabulary)
        begin = rng.randrange(len(data) + 1)
        at = data.find(word, begin)
        at = data.find(word) if at < 0 else at
        if at >= 0:
            return at, at + len(word)
    at = rng.randrange(len(data) + 1)
    return at, at


def _exchanged(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    begin, end = _place(data, vocabulary, rng)
    word = rng.choice(vocabulary)
    if rng.random() < 0.2:
        word = rng.choice((word.upper(), word.lower(), word + b" ", word + word[-1:], word[:-1]))
    return data[:begin] + word + data[end:]


def _without(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """Without one of the words, or without its line."""
    begin, end = _place(data, vocabulary, rng)
    if rng.random() < 0.6:
        begin = data.rfind(b"\n", 0, begin) + 1
        end = data.find(b"\n", end) + 1 or len(data)
    return data[:begin] + data[end:]


def _again(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """The line of one of the words once more, here or elsewhere."""
    begin, end = _place(data, vocabulary, rng)
    begin = data.rfind(b"\n", 0, begin) + 1
    end = data.find(b"\n", end) + 1 or len(data)
    at = rng.choice((begin, end, data.find(b"\n", rng.randrange(len(data) + 1)) + 1))
    return data[:at] + data[begin:end] * rng.choice((1, 1, 2, 50)) + data[at:]


def _counted(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """Another number behind one of the words."""
    _, end = _place(data, vocabulary, rng)
    found = _NUMBER.search(data, end, min(end + 300, len(data)))
    if found is None:
        return data[:end] + b" " + rng.choice(_COUNTS) + data[end:]
    return data[: found.start()] + rng.choice(_COUNTS) + data[found.end() :]


def _lists(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """A long, short or descending list of numbers behind one of the words."""
    _, end = _place(data, vocabulary, rng)
    count = rng.choice((0, 1, 2, 10, 500, 5000))
    step = rng.choice((1.0, 0.01, -1.0, 0.0))
    mark = rng.choice((b" ", b",", b"\n", b"\t"))
    numbers = mark.join(b"%g" % (step * k) for k in range(count))
    line = data.find(b"\n", end)
    line = len(data) if line < 0 or rng.random() < 0.3 else line
    return data[:end] + mark + numbers + data[line if line - end < 5000 else end :]


def _extreme(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """All numbers of a line or of the file alike."""
    value = rng.choice((*_COUNTS, b"90", b"-90", b"180", b"360", b"0.5", b"100", b"1e12", b"1e13"))
    if rng.random() < 0.3:
        return _NUMBER.sub(value, data[:20_000]) + data[20_000:]
    begin, _ = _place(data, vocabulary, rng)
    end = data.find(b"\n", begin) + 1 or len(data)
    end = data.find(b"\n", end) + 1 or len(data)
    return data[:begin] + _NUMBER.sub(value, data[begin:end]) + data[end:]


def _marked(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """A piece of XML that a reader may stumble over."""
    at = data.find(rng.choice((b"<", b">", b"</")), rng.randrange(len(data) + 1))
    at = max(at, 0) + rng.choice((0, 1))
    return data[:at] + rng.choice(_XML) + data[at:]


def _attributes(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """Many attributes in one tag, or one twice."""
    tags = list(_TAG.finditer(data[:100_000]))
    if not tags:
        return data
    end = rng.choice(tags).end()
    many = b"".join(b" a%d='1'" % k for k in range(rng.choice((1, 10, 3000))))
    twice = b" Name='1' Name='2'"
    one = b" Name='" + rng.choice((b"x" * 5000, b"\xff", b"&lt;", b"", b"45as-15")) + b"'"
    return data[:end] + rng.choice((many, twice, one)) + data[end:]


def _nested(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """An element within many others, or closed too often."""
    elements = list(_ELEMENT.finditer(data[:100_000]))
    if not elements:
        return data
    element, depth = rng.choice(elements), rng.choice((1, 5, 70, 5000))
    tag = rng.choice((element[1], b"a", b"Object", b"Layer"))
    opened, closed = b"<" + tag + b">", b"</" + tag + b">"
    depth_closed = depth if rng.random() < 0.8 else depth + rng.choice((-1, 1))
    inner = opened * depth + element[0] + closed * max(depth_closed, 0)
    return data[: element.start()] + inner + data[element.end() :]


def _moved(data: bytes, vocabulary: list[bytes], rng: random.Random) -> bytes:
    """An element elsewhere, again, or gone."""
    elements = list(_ELEMENT.finditer(data[:100_000]))
    if not elements:
        return data
    element, other = rng.choice(elements), rng.choice(elements)
    at = rng.choice((other.start(), other.end()))
    copies = element[0] * rng.choice((0, 1, 1, 2, 300))
    changed = data[:at] + copies + data[at:]
    if rng.random() < 0.5 and at > element.end():
        changed = changed[: element.start()] + changed[element.end() :]
    return changed
