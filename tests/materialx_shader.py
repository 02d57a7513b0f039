"""MaterialX's own shader of a document, generated as ESSL, for the tests of what is exported."""

from __future__ import annotations

from pathlib import Path

import MaterialX as mx
import moderngl
import numpy as np
from MaterialX import PyMaterialXGenGlsl as gen_glsl
from MaterialX import PyMaterialXGenShader as gen_shader

POINT_LIGHT = 1


def library():
    """The standard libraries as a document."""
    found = mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), found)
    return found


def document(path: Path):
    """A document on the standard libraries."""
    found = mx.createDocument()
    mx.readFromXmlFile(found, str(path))
    found.setDataLibrary(library())
    return found


def shader(doc):
    """Vertex and pixel shader of a document's only material, lit by one point light."""
    generator = gen_glsl.EsslShaderGenerator.create()
    context = gen_shader.GenContext(generator)
    context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
    colours = gen_shader.DefaultColorManagementSystem.create(generator.getTarget())
    colours.loadLibrary(doc.getDataLibrary())
    generator.setColorManagementSystem(colours)
    options = context.getOptions()
    options.hwMaxActiveLightSources = 1
    lights = mx.createDocument()
    lights.setDataLibrary(doc.getDataLibrary())
    light = lights.addNode("point_light", "light", "lightshader")
    gen_shader.HwShaderGenerator.bindLightShader(light.getNodeDef(), POINT_LIGHT, context)
    [material] = doc.getMaterialNodes()
    made = generator.generate("material", material, context)
    return made, made.getSourceCode("vertex"), made.getSourceCode("pixel")


def executed(ctx, doc, i, o):
    """What the shader of a document shows at a point of normal +z, (N, 3), under unit light.

    i, o: unit vectors (N, 3) to the lamp and the eye; the result is the BRDF times cos_i.
    """
    made, vertex, pixel = shader(doc)
    program = ctx.program(vertex_shader=vertex, fragment_shader=pixel)
    black = ctx.texture((1, 1), 4, bytes(4))
    values = {
        "u_worldMatrix": np.eye(4),
        "u_viewProjectionMatrix": np.eye(4),
        "u_worldInverseTransposeMatrix": np.eye(4),
        "u_envMatrix": np.eye(4),
        "u_envLightIntensity": 0.0,
        "u_envRadianceMips": 1,
        "u_envRadianceSamples": 1,
        "u_numActiveLightSources": 1,
        "u_lightData[0].type": POINT_LIGHT,
        "u_lightData[0].color": (1.0, 1.0, 1.0),
        "u_lightData[0].intensity": 1.0,
        "u_lightData[0].decay_rate": 0.0,
    }
    for port in made.getStage("pixel").getUniformBlocks()["PublicUniforms"]:
        value = port.getValue()
        if value is not None and port.getVariable() in program:
            data = value.getData()
            values[port.getVariable()] = (
                data if isinstance(data, float | bool | int) else tuple(data)
            )
    for name, value in values.items():
        if name in program:
            _set(program[name], value)
    for unit, name in enumerate(("u_envRadiance", "u_envIrradiance")):
        if name in program:
            black.use(unit)
            program[name].value = unit
    point = {"i_position": (0, 0, 0), "i_normal": (0, 0, 1), "i_tangent": (1, 0, 0)}
    names = [name for name in point if name in program]
    buffer = ctx.buffer(np.array([point[name] for name in names], dtype="f4").tobytes())
    vertices = ctx.vertex_array(program, [(buffer, " ".join(["3f"] * len(names)), *names)])
    target = ctx.simple_framebuffer((1, 1), 4, dtype="f4")
    shown = []
    with ctx.scope(target, 0):
        for to_lamp, to_eye in zip(i, o, strict=True):
            _set(program["u_viewPosition"], tuple(to_eye))
            _set(program["u_lightData[0].position"], tuple(to_lamp))
            target.clear()
            vertices.render(moderngl.POINTS, vertices=1)
            shown.append(np.frombuffer(target.read(components=3, dtype="f4"), dtype="f4"))
    for made_here in (vertices, buffer, target, black, program):
        made_here.release()
    return np.array(shown, dtype=np.float64)


def _set(uniform, value):
    if isinstance(value, np.ndarray):
        uniform.write(value.astype("f4").tobytes())
    else:
        uniform.value = value
