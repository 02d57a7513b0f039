"""Node graphs, pictures and colour spaces of MaterialX documents: what a surface's inputs come to.

No search for a material here: the surface's own numbers are looked at.
"""

from __future__ import annotations

import io
import warnings
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from relgloss_view.base.errors import InputError
from relgloss_view.exchange import materialx_nodes
from relgloss_view.exchange.materialx_colour import SPACES
from relgloss_view.exchange.materialx_models import MODELS
from relgloss_view.exchange.materialx_values import Values
from relgloss_view.exchange.picture_mean import picture_mean
from relgloss_view.material.cielab import srgb_decoded


def surface(inputs, nodes="", folder=None, node="open_pbr_surface", head=""):
    """The surface of a document, and what it names."""
    root = ElementTree.fromstring(
        f'<materialx {head}>{nodes}<{node} name="s">{inputs}</{node}></materialx>'
    )
    shader = root.find(node)
    return MODELS[node].surface(Values.of(root, shader, "here", folder))


def value(name, text, kind="float"):
    return f'<input name="{name}" type="{kind}" value="{text}" />'


def link(name, node, kind="float", more=""):
    return f'<input name="{name}" type="{kind}" nodename="{node}" {more}/>'


def node(tag, *inputs, kind="float"):
    return f'<{tag} name="n" type="{kind}">{"".join(inputs)}</{tag}>'


def test_names_of_others_are_calculated():
    """Judge: MaterialX's specification of each node, by hand."""
    cases = {
        node("multiply", value("in1", "0.8"), value("in2", "0.5")): 0.4,
        node("mix", value("bg", "1"), value("fg", "0.2"), value("mix", "0.75")): 0.4,
        node("invert", value("in", "0.7")): 0.3,
        node("clamp", value("in", "3"), value("high", "0.9")): 0.9,
        node("remap", value("in", "0.5"), value("outlow", "0.2"), value("outhigh", "0.6")): 0.4,
        node("range", value("in", "0.25"), value("gamma", "2")): 0.5,
        node("smoothstep", value("in", "0.25")): 0.15625,
        node("power", value("in1", "0.3"), value("in2", "2")): 0.09,
        node("extract", value("in", "0.1, 0.2, 0.3", "vector3"), value("index", "1")): 0.2,
        node("ifgreater", value("value1", "2"), value("value2", "3"), value("in2", "0.6")): 0.6,
    }
    for nodes, expected in cases.items():
        made, lost = surface(link("specular_roughness", "n"), nodes)
        assert made.specular_roughness == pytest.approx(expected), nodes
        assert lost == ()


def test_a_connection_counts_before_a_value():
    both = '<input name="specular_roughness" type="float" value="0.1" nodename="n" />'
    made, _ = surface(both, node("constant", value("value", "0.6")))
    assert made.specular_roughness == 0.6


@pytest.mark.parametrize(
    "nodes",
    [
        node("noise2d"),
        node("divide", value("in1", "1"), value("in2", "0")),
        node("extract", value("in", "0.1"), value("index", "3")),
        node("extract", value("in", "0.1"), value("index", "-1")),
        node("add", value("in1", "1, 2"), value("in2", "1, 2, 3")),
        node("dot", link("in", "n")),
        node("swizzle", value("in", "0.1, 0.2, 0.3", "color3")),  # without channels
        node("swizzle", value("in", "1"), value("channels", 5 * "r", "string"), kind="unknown"),
        node("image", value("file", "../up.png", "filename")),
        node("image", value("file", "/etc/hostname", "filename")),
        node("image", value("file", "gone_&lt;UDIM&gt;.exr", "filename")),
    ],
)
def test_what_has_no_value_is_a_guess_of_the_gloss(tmp_path, nodes):
    made, [line] = surface(link("specular_roughness", "n"), nodes, tmp_path)
    assert made.specular_roughness == 0.3  # the default of OpenPBR
    assert line.startswith("specular_roughness: comes from ")
    assert "the gloss is a guess" in line


def test_nodes_that_multiply_end():
    """Each node asks for the one before it twice: 2^60 ways."""
    chain = "".join(
        f'<add name="n{k}" type="float">{link("in1", f"n{k + 1}")}{link("in2", f"n{k + 1}")}</add>'
        for k in range(60)
    )
    chain += f'<constant name="n60" type="float">{value("value", "0")}</constant>'
    _, [line] = surface(link("specular_roughness", "n0"), chain)
    assert "more than" in line


def picture(path, values, mode=None):
    Image.fromarray(values, mode).save(path)


def test_a_picture_counts_by_its_mean(tmp_path):
    checks = np.zeros((8, 8, 3), dtype=np.uint8)
    checks[::2] = (255, 128, 0)
    picture(tmp_path / "a.png", checks)
    nodes = (
        '<nodegraph name="g" fileprefix="./" colorspace="srgb_texture">'
        '<image name="i" type="color3">' + value("file", "a.png", "filename") + "</image>"
        '<image name="r" type="vector3">' + value("file", "a.png", "filename") + "</image>"
        '<extract name="e" type="float">'
        + link("in", "r", "vector3")
        + value("index", "1")
        + "</extract>"
        '<output name="c" type="color3" nodename="i" />'
        '<output name="rough" type="float" nodename="e" /></nodegraph>'
    )
    inputs = (
        '<input name="base_color" type="color3" nodegraph="g" output="c" />'
        '<input name="specular_roughness" type="float" nodegraph="g" output="rough" />'
    )
    made, lost = surface(inputs, nodes, tmp_path)
    # Colours are decoded before the mean, numbers are not.
    assert made.base_color == pytest.approx((0.5, 0.5 * float(srgb_decoded(128 / 255)), 0.0))
    assert made.specular_roughness == pytest.approx(0.5 * 128 / 255)
    assert "base_color: the mean of a.png stands for it" in lost
    # Negative control: without the folder no picture is opened.
    assert surface(inputs, nodes)[0].base_color == (0.8, 0.8, 0.8)


def test_what_a_picture_node_multiplies_by_and_adds(tmp_path):
    """Judge: the node graphs of MaterialX 1.39.5, libraries/bxdf."""
    picture(tmp_path / "a.png", np.full((2, 2, 3), 51, dtype=np.uint8))  # 0.2

    def read(tag, more, output):
        nodes = f'<{tag} name="n">{value("file", "a.png", "filename")}{more}</{tag}>'
        made, lost = surface(
            link("specular_roughness", "n", more=f'output="{output}"'), nodes, tmp_path
        )
        return made.specular_roughness, lost

    added = value("scale", "2, 2, 2, 1", "color4") + value("bias", "0.1, 0.1, 0.1, 0", "color4")
    assert read("UsdUVTexture", added, "r")[0] == pytest.approx(0.5)
    both = value("color", "2, 2, 2, 1", "color4") + value("geomcolor", "0.5, 1, 1, 1", "color4")
    assert read("gltf_colorimage", both, "r")[0] == pytest.approx(0.2)
    assert read("gltf_colorimage", both, "g")[0] == pytest.approx(0.4)
    unfit, [line] = read("gltf_image", value("factor", "1, 1", "vector2"), "r")
    assert unfit == 0.3  # the default of OpenPBR
    assert "does not fit its inputs" in line


def test_a_channel_that_nobody_knows_is_not_the_first(tmp_path):
    nodes = '<constant name="c" type="color3">' + value("value", "0.7, 0.7, 0.7", "color3")
    nodes += "</constant>" + node("separate3", link("in", "c", "color3"), kind="multioutput")
    made, _ = surface(link("specular_roughness", "n", more='output="outr"'), nodes)
    assert made.specular_roughness == pytest.approx(0.7)
    made, [line] = surface(link("specular_roughness", "n", more='output="outq"'), nodes)
    assert made.specular_roughness == 0.3
    assert "a channel" in line


def test_a_picture_that_is_broken_is_opened_once(tmp_path, monkeypatch):
    (tmp_path / "a.png").write_bytes(b"no picture")
    opened = []
    monkeypatch.setattr(
        materialx_nodes, "read_bytes", lambda *words: opened.append(words) or b"no picture"
    )
    nodes = node("image", value("file", "a.png", "filename"))
    _, lost = surface(link("specular_roughness", "n") + link("coat_weight", "n"), nodes, tmp_path)
    assert len(lost) == 2
    assert len(opened) == 1


def test_a_picture_of_many_pixels_prints_nothing(monkeypatch):
    """Pillow warns where a picture has more pixels than this limit, 89 million as it comes."""
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 2500 * 2000)
    file, half = io.BytesIO(), np.zeros((3000, 2500), dtype=np.uint8)
    half[:1500] = 255
    Image.fromarray(half).save(file, "PNG", compress_level=1)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Every second row and column is taken, which are as many of both halves.
        assert picture_mean(file.getvalue(), None) == pytest.approx([0.5, 0.5, 0.5, 1.0])
    # The control: Pillow itself warns of this file.
    with pytest.warns(Image.DecompressionBombWarning):
        Image.open(file)


def test_the_mean_of_gray_of_sixteen_bits():
    """As Poly Haven and others write roughness; Pillow alone would cut it at 255."""
    file = io.BytesIO()
    Image.fromarray(np.full((4, 4), 19661, dtype=np.uint16)).save(file, "PNG")
    assert picture_mean(file.getvalue(), None) == pytest.approx([0.3, 0.3, 0.3, 1.0], abs=1e-4)
    with pytest.raises(InputError, match="neither PNG nor JPEG nor WebP"):
        picture_mean(b"RIFF0000WAVE", None)


def test_colour_spaces_agree_with_those_of_materialx():
    """Judge: the matrices of MaterialX's own library, which its shaders use."""
    folder = Path(pytest.importorskip("MaterialX").__file__).parent / "libraries" / "cmlib"
    root = ElementTree.parse(folder / "cmlib_ng.mtlx").getroot()
    seen = 0
    for name in ("acescg", "lin_adobergb", "lin_displayp3"):
        graph = root.find(f"nodegraph[@name='NG_{name}_to_lin_rec709_color3']")
        words = graph.find("constant/input").get("value").split(",")
        theirs = np.array([float(word) for word in words]).reshape(3, 3)
        # 2e-3: ACES's white and adaptation are rounded in different places.
        assert np.allclose(SPACES[name].linear_srgb(np.eye(3)), theirs, atol=2e-3)
        seen += 1
    assert seen == 3
    for definition in ElementTree.parse(folder / "cmlib_defs.mtlx").getroot().iter("nodedef"):
        assert definition.get("node").removesuffix("_to_lin_rec709") in SPACES


def test_a_colour_space_holds_for_what_is_inside():
    inner = value("base_color", "0.5, 0.5, 0.5", "color3")
    assert surface(inner)[0].base_color == pytest.approx((0.5,) * 3)
    for made, lost in (
        surface(inner, head='colorspace="srgb_texture"'),
        surface(
            '<input name="base_color" type="color3" nodegraph="g" />',
            '<nodegraph name="g" colorspace="srgb_texture"><constant name="c" type="color3">'
            + value("value", "0.5, 0.5, 0.5", "color3")
            + '</constant><output name="o" type="color3" nodename="c" /></nodegraph>',
            head='colorspace="lin_rec709"',
        ),
    ):
        assert made.base_color == pytest.approx((0.2140,) * 3, abs=1e-4)  # IEC 61966-2-1
        assert lost == ()
    vector = value("base_color", "0.5, 0.5, 0.5", "vector3")
    assert surface(vector, head='colorspace="srgb_texture"')[0].base_color == (0.5, 0.5, 0.5)
    _, [line] = surface(inner, head='colorspace="lin_rec2020_of_ours"')
    assert "lin_rec2020_of_ours, read as linear sRGB" in line
    made, [line] = surface(
        value("base_color", "0.1, 0.9, 0.1", "color3"), head='colorspace="acescg"'
    )
    assert min(made.base_color) == 0.0
    assert "cut to 0 to 1" in line


def test_no_surface_takes_light_away():
    """Black in face and edge, or a mirror above a body: each at 200 directions."""
    theta = np.linspace(0.0, 1.5, 200)
    to_lamp = np.stack([np.sin(theta), 0.0 * theta, np.cos(theta)], axis=-1)
    to_eye = to_lamp * np.array([-1.0, 1.0, 1.0])
    black = value("base_color", "0, 0, 0", "color3") + value("specular_color", "0, 0, 0", "color3")
    mirror = value("specular_ior", "100") + value("specular_roughness", "0")
    for inputs in (black + value("base_metalness", "1"), mirror):
        made, _ = surface(inputs)
        for light in made.evaluate(to_lamp, to_eye):
            assert np.min(light) >= 0.0
            assert np.all(np.isfinite(light))


def test_what_passes_through_a_body_is_no_colour_of_it():
    made, lost = surface(value("transmission_weight", "1"))
    assert made.base_color == (0.0, 0.0, 0.0)
    assert lost == ("transmission (transmission_weight)",)
    inside = value("subsurface_weight", "0.5") + value("subsurface_color", "0, 1, 0", "color3")
    made, _ = surface(value("base_color", "1, 0, 0", "color3") + inside)
    assert made.base_color == (0.5, 0.5, 0.0)


def test_an_index_of_a_metal_and_none():
    """MaterialX's own gold for USD has index 50; its velvet has 0."""
    made, lost = surface(value("ior", "50"), node="UsdPreviewSurface")
    assert (made.ior, lost) == (50.0, ())
    made, [line] = surface(value("specular_IOR", "0"), node="standard_surface")
    assert made.specular_ior == 1.0
    assert "counts as 1" in line


def test_a_colour_outside_of_srgb_is_cut_and_named():
    """Gold, as the library of physicallybased.info states it for OpenPBR."""
    made, [line] = surface(value("base_color", "1.059, 0.773, 0.307", "color3"))
    assert made.base_color == (1.0, 0.773, 0.307)
    assert line == "base_color: 1.06, 0.773, 0.307, cut to 0 to 1"
    with pytest.raises(InputError, match="expected 0 to 1, found 255, 0, 0"):
        surface(value("base_color", "255, 0, 0", "color3"))
