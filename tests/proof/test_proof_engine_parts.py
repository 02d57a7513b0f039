"""Parts of the page's engine: shaders, hashes, twins, memory, and browsers that fail."""

from __future__ import annotations

import json

import numpy as np
import pytest
from browsers import before_pages, call, call_array
from engine_cases import ART, CASES, MATTE, look, pair_of, random_states
from engines import draw, open_engine, settings_of

from relgloss_view import Look, Scene
from relgloss_view.display.display import Display
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.gpu.shader import ShaderSource
from relgloss_view.picture.gpu.variant import _sees_a_cap
from relgloss_view.picture.model import noise
from relgloss_view.picture.model.pixel_sampling import sample_count
from relgloss_view.picture.model.silhouette import edge_tiles
from relgloss_view.picture.model.view import View, from_afar
from relgloss_view.picture.pair import common_factor, held_factor
from relgloss_view.proof.arrays import packed
from relgloss_view.proof.drawing import drawing_of, page_display, shaders_of

LANES = ("chromium_gl", "chromium_sw")


@pytest.mark.parametrize("lane", LANES)
def test_hashes(request, lane):
    """The grain's integers are the same everywhere; another seed gives others."""
    browser = request.getfixturevalue(lane)
    open_engine(browser, pair_of(Scene(MATTE), look()))
    rng = np.random.default_rng(3)
    cells = rng.integers(-(2**31), 2**31, (2000, 3))
    function = """(cells, seed) => evaluate(engine.device, ["noise.glsl"],
      `result = uvec4(cell_hash(ivec3(cell.xyz), ${seed}u), 0u);`,
      {cell: {columns: 3, values: new Uint32Array(cells)}}, {integers: true})"""
    unsigned = (cells & 0xFFFFFFFF).ravel().tolist()
    found = call_array(browser, function, unsigned, 7).reshape(-1, 4)[:, :3]
    assert np.array_equal(found, noise.cell_hash(cells, 7))
    assert not np.array_equal(found, noise.cell_hash(cells, 8))


@pytest.mark.parametrize("lane", LANES)
def test_every_stage_compiles(request, lane):
    """All variants of a drawing, with what the view adds, as ESSL 3.00."""
    browser = request.getfixturevalue(lane)
    smooth = Scene(MATTE, display=Display(edges="smooth", dither="ordered"))
    open_engine(browser, pair_of(smooth, look(grain="eye")))
    stages = call(
        browser,
        """() => {
          const {drawing, device} = engine;
          const made = new Set();
          const compile = (stage, defines) => { device.program(stage, defines); made.add(stage); };
          for (const variant of Object.values(drawing.sides.test.variants)) {
            for (const AFAR of [0, 1]) for (const CAPS of [0, 1]) {
              const seen = {AFAR, CAPS};
              compile("shade.frag", {...variant.shade, ...seen});
              compile("white.frag", {BLOCK: 4, ...variant.white, ...seen});
              compile("coverage.frag", {...variant.shape, ...seen});
            }
            compile("split.frag", variant.split);
            if (variant.reads_field) compile("grain_field.frag", variant.field);
          }
          for (const defines of Object.values(drawing.display.tone)) compile("tone.frag", defines);
          compile("edge.frag", drawing.display.edge);
          compile("measure.frag", {BLOCK: 4, STRIDE: 1});
          for (const stage of ["reduce.frag", "peak.frag"]) compile(stage, {BLOCK: 16});
          const lab = {columns: 3, values: new Float32Array([50, 0, 0])};
          evaluate(device, ["difference.glsl"], "result = vec4(0.0);", {lab});
          made.add("evaluate.frag");
          return [...made];
        }""",
    )
    drawing = drawing_of(pair_of(smooth, look(grain="eye")))
    assert set(stages) == {name for name in drawing["stages"] if name.endswith(".frag")}


def test_a_wrong_shader_names_its_line(chromium_gl):
    open_engine(chromium_gl, pair_of(Scene(MATTE), look()))
    with pytest.raises(AssertionError, match=r"ShaderError: tone\.frag: .*tone\.glsl:\d+"):
        call(
            chromium_gl,
            """() => {
              const texts = engine.device.texts;
              const wrong = texts["tone.glsl"].replace("vec3(", "vec4(");
              engine.device.texts = {...texts, "tone.glsl": wrong};
              try {
                engine.device.program("tone.frag", {...engine.drawing.display.tone.one, TWICE: 1});
              } finally { engine.device.texts = texts; }
            }""",
        )
    with pytest.raises(AssertionError, match=r"ambient\.glsl \(included by shade\.frag\): no such"):
        call(
            chromium_gl,
            """() => {
              const {shade} = engine.drawing.sides.test.variants["smooth one"];
              engine.device.program("shade.frag", {...shade, AMBIENT: 1});
            }""",
        )
    with pytest.raises(AssertionError, match=r"uniform 'c' has no value"):
        call(
            chromium_gl,
            """(s) => {
              engine.draw(s, [32, 32]);
              const passes = engine.passes.test;
              const texture = passes.texture("split");
              engine.device.draw({stage: "tone.frag", defines: engine.drawing.display.tone.one,
                uniforms: {...engine.drawing.display.uniforms, split_image: texture,
                  per_size: [1, 1], lowest_row: 0}, target: passes.target(["display"])});
            }""",
            settings_of(pair_of(Scene(MATTE), look())).as_json(),
        )


def test_stages_are_composed_as_on_the_desktop(chromium_gl):
    """But for the header, what conditions leave out, and uniforms that nobody reads."""
    sides = pair_of(Scene(MATTE), look())
    open_engine(chromium_gl, sides)
    defines = drawing_of(sides)["sides"]["test"]["variants"]["grainy one"]["shade"]
    text = call(
        chromium_gl,
        """(defines) => {
          const {texts, definitions} = engine.device;
          const name = "shade.frag";
          return new ShaderSource({texts, definitions, name, defines, most: 99}).text;
        }""",
        defines,
    )
    expected = ShaderSource("shade.frag", defines).text.split("\n")[1:]
    found = [line for line in text.split("\n")[6:] if line.strip() and line[:5] != "#line"]
    assert set(found) <= set(expected)
    assert len(found) > 300
    lines = iter(expected)
    assert all(line in lines for line in found)  # in the same order


def test_views_are_those_of_python(chromium_gl):
    """Frame, bounds, samples, tiles and factors: 200 views of each shape."""
    for kind in ("cylinder", "sphere", "plane", "box"):
        scene = Scene(ART, shape=Shape(kind), display=Display(edges="smooth"))
        sides = pair_of(scene, look(samples=None, grain="eye", grain_arcmin=0.7))
        open_engine(chromium_gl, sides)
        states = random_states(50, 5)
        found = call(
            chromium_gl,
            """(states, size) => states.map((s) => {
              const request = engine.passes.reference.request(s, "reference", size);
              const {view, samples, afar, seen} = request;
              const {shape} = engine.drawing.sides.reference;
              return [view.eye_m, view.right, view.up, view.forward, view.pixelStep, view.bounds,
                samples, afar, seen.CAPS, edgeTiles(shape, view, engine.drawing.numbers)];
            })""",
            [state.as_json() for state in states],
            [96, 72],
        )
        for state, (eye, right, up, forward, step, bounds, samples, afar, cap, tiles) in zip(
            states, found, strict=True
        ):
            placed = scene.placed(eye=state.eye)
            placed = Scene(ART, state.in_setup(placed.setup))
            view = View.of(placed, (96, 72))
            for there, here in (
                (eye, view.eye_m),
                (right, view.right),
                (up, view.up),
                (forward, view.forward),
                (step, view.pixel_step),
            ):
                # A last bit of float64 may round another way to float32, one of 2^29 times.
                assert np.allclose(there, here, rtol=1e-7, atol=1e-12)
            assert tuple(bounds) == view.bounds
            drawn = sides["reference"][1].with_entries(sigma_n_deg=state.reference.sigma_n_deg)
            page = placed.placed(display=page_display(placed.display))
            assert samples == sample_count(page, drawn, (96, 72))
            assert afar == from_afar(placed.shape, placed.eye)
            assert bool(cap) == _sees_a_cap(placed)
            assert np.array_equal(np.reshape(tiles, (-1, 3)), edge_tiles(placed.shape, view))


def test_factors_are_those_of_python(chromium_gl):
    open_engine(chromium_gl, pair_of(Scene(MATTE), look()))
    rng = np.random.default_rng(2)
    pairs = [[[float(c), float(m)] for c, m in rng.uniform(0.05, 2.0, (2, 2))] for _ in range(50)]
    pairs.append([[0.5, None], [0.2, 0.1]])
    present = rng.uniform(0.1, 1.0, len(pairs)).tolist()
    found = call(
        chromium_gl,
        """(pairs, present) => pairs.map((pair, k) =>
          [commonFactor(pair), heldFactor(commonFactor(pair), present[k], engine.drawing.numbers)])
        """,
        pairs,
        present,
    )
    for pair, held, (common, moving) in zip(pairs, present, found, strict=True):
        assert common == common_factor(map(tuple, pair))
        assert moving == held_factor(common, held)


def test_arrays_come_back(chromium_gl):
    open_engine(chromium_gl, pair_of(Scene(MATTE), look()))
    rng = np.random.default_rng(1)
    for values in (
        rng.normal(size=(17, 3)).astype(np.float32),
        rng.normal(size=5),
        rng.integers(0, 2**32, (4, 4), dtype=np.uint32),
        np.zeros((0, 3), dtype=np.uint8),
    ):
        found = call_array(chromium_gl, "async (a) => (await unpacked(a)).values", packed(values))
        assert found.dtype.itemsize == values.dtype.itemsize
        assert found.tobytes() == values.tobytes()


@pytest.mark.parametrize("shape", [[4], [2**31, 2**20], [-1], [0.5]])
def test_an_array_that_claims_another_length_is_refused(chromium_gl, shape):
    """64 MB of zeros in 64 kB: no more is inflated than the shape holds."""
    open_engine(chromium_gl, pair_of(Scene(MATTE), look()))
    bomb = packed(np.zeros(64 << 20, np.uint8)) | {"shape": shape}
    answer = call(
        chromium_gl,
        "async (a) => { try { await unpacked(a); } catch (e) { return e.message; } }",
        bomb,
    )
    assert answer in ("an array has the wrong length", "an array beyond all bounds")


def test_sliders_wait_for_no_compiler(chromium_gl):
    """After `prepare`, grain and c of any value need no further program."""
    sides = pair_of(Scene(ART), look(sigma_n_deg=0.0))
    open_engine(chromium_gl, sides)
    compiled = call(
        chromium_gl,
        """async (s) => {
          engine.draw(s, [64, 64]);
          const before = engine.device.compiled;
          await Promise.all([engine.prepare(s), engine.prepare(s)]);
          const prepared = engine.device.compiled;
          s.reference.sigma_n_deg = 3; s.test.sigma_n_deg = 0.5; s.test.c = 0.2;
          engine.draw(s, [64, 64]);
          return [before, prepared, engine.device.compiled];
        }""",
        settings_of(sides).as_json(),
    )
    assert compiled[0] < compiled[1] == compiled[2]


def test_a_lost_context_comes_back(chromium_gl):
    sides = pair_of(Scene(ART, display=Display(edges="smooth")), look(grain="eye"))
    open_engine(chromium_gl, sides)
    settings = settings_of(sides)
    _, before = draw(chromium_gl, settings, (64, 48))
    answer = call(
        chromium_gl,
        """async (s) => {
          const lose = engine.device.gl.getExtension("WEBGL_lose_context");
          const lost = new Promise((done) => { engine.device.onLost = done; });
          lose.loseContext();
          await lost;
          await new Promise((done) => setTimeout(done, 50)); // the event has to end first
          let reason = "";
          try { engine.draw(s, [64, 48]); } catch (error) { reason = error.reason; }
          const restored = new Promise((done) => { engine.onRestored = done; });
          lose.restoreContext();
          await restored;
          return [reason, engine.lost];
        }""",
        settings.as_json(),
    )
    assert answer == ["lost", False]
    _, after = draw(chromium_gl, settings, (64, 48))
    for side, picture in before.items():
        assert np.array_equal(after[side], picture)
        assert np.ptp(picture) > 50  # a black picture is equal to a black one


def test_too_large(chromium_gl):
    sides = pair_of(Scene(MATTE), look())
    open_engine(chromium_gl, sides)
    answer = call(
        chromium_gl,
        """(s) => {
          try { engine.draw(s, [engine.device.maxSize + 1, 4]); } catch (error) {
            return [error.reason, engine.draw(s, [32, 32]).reference.objectPixels > 0];
          }
        }""",
        settings_of(sides).as_json(),
    )
    assert answer == ["too large", True]


@pytest.mark.parametrize(
    ("script", "reason"),
    [
        ("HTMLCanvasElement.prototype.getContext = () => null;", "no webgl2"),
        (
            """const getExtension = WebGL2RenderingContext.prototype.getExtension;
            WebGL2RenderingContext.prototype.getExtension = function (name) {
              return name === "EXT_color_buffer_float" ? null : getExtension.call(this, name);
            };""",
            "no float targets",
        ),
    ],
)
def test_browsers_that_cannot_draw(chromium_gl, script, reason):
    before_pages(chromium_gl, script)
    open_engine(chromium_gl, pair_of(Scene(MATTE), look()), ready=False)
    answer = call(
        chromium_gl,
        """async () => {
          try { await relgloss.ready; return "drawn"; } catch (error) {
            return [error instanceof Unsupported, error.reason];
          }
        }""",
    )
    assert answer == [True, reason]


def test_memory_is_given_back(chromium_gl):
    """Sizes and sides come and go, and the device holds as many textures as before."""
    before_pages(
        chromium_gl,
        """window.textures = 0;
        const of = WebGL2RenderingContext.prototype;
        const {createTexture, deleteTexture} = of;
        of.createTexture = function () { textures += 1; return createTexture.call(this); };
        of.deleteTexture = function (t) { if (t) textures -= 1; deleteTexture.call(this, t); };""",
    )
    sides = pair_of(*CASES["smooth edges"])
    open_engine(chromium_gl, sides)
    counts = call(
        chromium_gl,
        """async (s) => {
          const seen = [textures];
          engine.draw(s, [64, 48]);
          seen.push(textures);
          for (const size of [[32, 32], [128, 96], [64, 48]]) engine.draw(s, size);
          await engine.prepare(s);
          seen.push(textures);
          engine.forget();
          seen.push(textures);
          return seen;
        }""",
        settings_of(sides).as_json(),
    )
    assert counts[0] == counts[3]
    assert counts[1] == counts[2] > counts[0]


def test_shown_on_the_canvas(chromium_gl):
    """Boxes of both pictures land where they belong, and the surround is around them."""
    sides = pair_of(Scene(MATTE), look())
    open_engine(chromium_gl, sides)
    data = call_array(
        chromium_gl,
        """(s) => {
          engine.draw(s, [40, 30]);
          canvas.width = 100; canvas.height = 50;
          engine.show([{side: "reference", from: [0, 0, 40, 30], to: [5, 10, 40, 30]},
                       {side: "test", from: [10, 5, 20, 20], to: [50, 0, 40, 40]}]);
          const gl = engine.device.gl;
          const bytes = new Uint8Array(4 * 100 * 50);
          gl.readPixels(0, 0, 100, 50, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
          return bytes;
        }""",
        settings_of(sides).as_json(),
    ).reshape(50, 100, 4)[::-1, :, :3]
    shown = {
        side: call_array(chromium_gl, f"() => engine.pixels('{side}').data").reshape(30, 40, 4)
        for side in sides
    }
    assert np.array_equal(data[10:40, 5:45], shown["reference"][..., :3])
    doubled = shown["test"][5:25, 10:30, :3].repeat(2, axis=0).repeat(2, axis=1)
    assert np.array_equal(data[:40, 50:90], doubled)
    assert np.array_equal(data[49, 0], call(chromium_gl, "() => engine.background"))


def test_drawing_is_small_and_json():
    sides = pair_of(Scene(MATTE, display=Display(edges="smooth")), Look(2.0, c=0.2, grain="eye"))
    drawing = drawing_of(sides)
    assert json.loads(json.dumps(drawing, allow_nan=False)) == drawing
    # Of 400 kB that a proof may have without artwork.
    assert len(json.dumps(drawing)) < 40_000
    texts = shaders_of(drawing)
    assert len(json.dumps(texts)) < 120_000
    assert {"shade.frag", "fill.vert", "tiles.vert", "edge.vert"} <= set(texts)
    plain = shaders_of(drawing_of(pair_of(Scene(MATTE), look())))
    assert "grain_field.frag" not in plain
    assert not {"mesh.frag", "finishes.glsl", "ambient.glsl", "lamp_size.glsl"} & set(texts)
    assert "ambient.glsl" in shaders_of(drawing_of(pair_of(*CASES["ambient"])))
    assert "lamp_size.glsl" in shaders_of(drawing_of(pair_of(*CASES["disc"])))
