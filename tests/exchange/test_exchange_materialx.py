"""MaterialX documents against MaterialX itself: its validation, and its own shader, executed."""

from __future__ import annotations

import dataclasses
import json
import shutil
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest

from relgloss_view.exchange import materialx
from relgloss_view.exchange.formats import ExportOptions
from relgloss_view.exchange.loss import MOST_DE2000
from relgloss_view.exchange.materialx_models import MODELS
from relgloss_view.exchange.materialx_values import Values
from relgloss_view.exchange.openpbr import OpenPbr
from relgloss_view.exchange.refit import Refit
from relgloss_view.pack.built_in import load_finish

pytest.importorskip("MaterialX")
import materialx_shader

TOP = '<?xml version="1.0"?>\n<materialx version="1.39" colorspace="lin_rec709">\n'
#: Every parameter that is drawn, away from its default somewhere.
SURFACES = {
    "default": OpenPbr(),
    "paper": OpenPbr(
        base_color=(0.2, 0.5, 0.1),
        base_diffuse_roughness=0.4,
        specular_weight=0.6,
        specular_color=(1.0, 0.8, 0.6),
        specular_roughness=0.35,
        specular_ior=1.6,
    ),
    "coated": OpenPbr(
        base_weight=0.9,
        base_color=(0.7, 0.4, 0.2),
        specular_roughness=0.5,
        specular_ior=2.2,
        coat_weight=0.7,
        coat_color=(0.9, 0.7, 0.8),
        coat_roughness=0.3,
        coat_ior=1.45,
        coat_darkening=0.6,
    ),
    "metal": OpenPbr(
        base_weight=0.95,
        base_color=(0.9, 0.7, 0.3),
        base_metalness=0.8,
        specular_weight=0.9,
        specular_color=(0.9, 0.95, 1.0),
        specular_roughness=0.25,
    ),
}


def document_of(surface):
    """A document with the parameters of a surface, each stated."""
    lines = []
    for name, value in materialx.parameters_of(surface).items():
        kind = "float" if isinstance(value, float) else "color3"
        text = f"{value:.6g}" if kind == "float" else ", ".join(f"{v:.6g}" for v in value)
        lines.append(f'<input name="{name}" type="{kind}" value="{text}" />')
    return (
        f'{TOP}<open_pbr_surface name="s" type="surfaceshader">{"".join(lines)}'
        '</open_pbr_surface><surfacematerial name="m" type="material">'
        '<input name="surfaceshader" type="surfaceshader" nodename="s" /></surfacematerial>'
        "</materialx>"
    )


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    path = tmp_path_factory.mktemp("mtlx") / "art.mtlx"
    return path, materialx.write(load_finish("art-coated"), path, ExportOptions())


def test_materialx_finds_nothing_wrong(exported):
    path, written = exported
    valid, faults = materialx_shader.document(path).validate()
    assert valid, faults
    # Negative control: it does find an input of the wrong type.
    text = path.read_text().replace('"specular_ior" type="float"', '"specular_ior" type="color3"')
    path.with_name("wrong.mtlx").write_text(text)
    assert not materialx_shader.document(path.with_name("wrong.mtlx")).validate()[0]
    [loss] = written.losses.values()
    assert loss.words in text.replace("&gt;", ">")
    assert ("WARNING" in text) == (not loss.is_small)
    assert loss.de2000_p95 < 1.5 * MOST_DE2000


def test_a_name_of_what_nobody_sees_leaves_a_document_that_is_read(exported):
    """Controls are no characters of XML; marks of direction hide others."""
    [loss] = exported[1].losses.values()
    name = "art\x1b[31m\x00\ufffe\u202e & <b>"
    material = dataclasses.replace(load_finish("art-coated"), name=name)
    part = materialx._Part("m", material, Refit(OpenPbr(), "one", loss))
    root = ElementTree.fromstring(materialx._document([part], bare=False).encode("utf-8"))
    written = root.find("surfacematerial")
    assert r"art\x1b[31m\x00\ufffe\u202e & <b>, by relgloss" in written.get("doc")
    assert json.loads(written.get(materialx.OWN_MATERIAL))["name"] == name


def test_its_shader_compiles(exported, tmp_path):
    validator = shutil.which("glslangValidator")
    if validator is None:
        pytest.skip("glslangValidator is not installed")
    _, vertex, pixel = materialx_shader.shader(materialx_shader.document(exported[0]))
    for name, text in (("s.vert", vertex), ("s.frag", pixel)):
        (tmp_path / name).write_text(text)
        done = subprocess.run(
            [validator, tmp_path / name], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", list(SURFACES))
def test_its_shader_shows_what_our_model_computes(ctx, tmp_path, name):
    """The judge that nobody here wrote: MaterialX's GLSL of the document, run by OpenGL."""
    surface = SURFACES[name]
    path = tmp_path / "s.mtlx"
    path.write_text(document_of(surface))
    i, o = directions(40)
    theirs = materialx_shader.executed(ctx, materialx_shader.document(path), i, o)
    # float32, and an approximated arccosine in the albedo of EON (1e-3 there).
    ours = sum(surface.evaluate(i, o)) * i[:, 2:]
    assert theirs == pytest.approx(ours, rel=4e-3, abs=1e-5)
    # Negative control: 3 % of roughness shows.
    other = dataclasses.replace(surface, specular_roughness=1.03 * surface.specular_roughness)
    assert not np.allclose(theirs, sum(other.evaluate(i, o)) * i[:, 2:], rtol=4e-3, atol=1e-5)


#: Surfaces of the other models, each with what differs between them.
OTHERS = {
    "standard_surface coated": (
        "base_color=0.5,0.3,0.2 specular_roughness=0.4 specular=0.6 coat=0.8 coat_roughness=0.15 "
        "coat_color=0.9,0.8,0.5"
    ),
    "standard_surface metal": (
        "base_color=0.9,0.7,0.3 metalness=1 specular_color=0.998,0.981,0.751 specular_roughness=0.3"
    ),
    "standard_surface inside": (
        "base_color=0.9,0.7,0.3 subsurface=0.4 subsurface_color=0.2,0.9,0.7 specular_roughness=0.3"
    ),
    "gltf_pbr coated": (
        "base_color=0.5,0.3,0.2 metallic=0.2 roughness=0.5 clearcoat=0.8 clearcoat_roughness=0.2 "
        "specular_color=1,0.5,0.5 ior=1.8"
    ),
    "UsdPreviewSurface metal": (
        "diffuseColor=0.9,0.7,0.3 roughness=0.3 metallic=1 clearcoat=0.5 clearcoatRoughness=0.2"
    ),
    "UsdPreviewSurface specular": (
        "diffuseColor=0.5,0.3,0.2 roughness=0.3 useSpecularWorkflow=1 specularColor=0.1,0.05,0.2"
    ),
    "disney_principled plain": "baseColor=0.5,0.3,0.2 roughness=0.3 specularTint=0.5",
}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(OTHERS))
def test_other_models_are_drawn_as_materialx_draws_them(ctx, tmp_path, name):
    """The same judge. Disney's diffuse part is Burley's, which ours takes for Lambert's."""
    node = name.split()[0]
    lines = []
    for word in OTHERS[name].split():
        key, _, text = word.partition("=")
        kind = "color3" if "," in text else "integer" if key.startswith("use") else "float"
        lines.append(f'<input name="{key}" type="{kind}" value="{text}" />')
    path = tmp_path / "s.mtlx"
    path.write_text(
        f'{TOP}<{node} name="s" type="surfaceshader">{"".join(lines)}</{node}>'
        '<surfacematerial name="m" type="material"><input name="surfaceshader" '
        'type="surfaceshader" nodename="s" /></surfacematerial></materialx>'
    )
    root = ElementTree.parse(path).getroot()
    surface, _ = MODELS[node].surface(Values.of(root, root.find(node), "here"))
    i, o = directions(40)
    theirs = materialx_shader.executed(ctx, materialx_shader.document(path), i, o)
    ours = sum(surface.evaluate(i, o)) * i[:, 2:]
    rel = 5e-2 if node == "disney_principled" else 4e-3
    assert ours == pytest.approx(theirs, rel=rel, abs=1e-5)


def directions(count):
    """Unit vectors to lamp and eye, up to 80 degrees from the normal; the last ones are mirrors."""
    generator = np.random.default_rng(5)
    ends = []
    for _ in range(2):
        theta = np.radians(80.0) * generator.random(count)
        phi = 2.0 * np.pi * generator.random(count)
        ends.append(
            np.stack(
                [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1
            )
        )
    i, o = ends
    half = count // 2
    o[half:] = i[half:] * np.array([-1.0, -1.0, 1.0])
    # MaterialX 1.39.5 takes i.o below 0 as 0 in EON, which is a slip: the paper of EON does not.
    near = np.sum(i * o, axis=-1) > 0.0
    return i[near], o[near]
