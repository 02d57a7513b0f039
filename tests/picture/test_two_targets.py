"""The exact path: pass 1 writes diffuse and specular to two targets, pass 2 splits and scales.

The cheaper method splits L* in pass 1 (Method.split "first pass"). Both come of the same numbers:
the weights of the models' shapes, from which XYZ is summed, and then the split. So the two may
differ by how a compiler orders and contracts these sums, and by nothing else; `bounds` gives how
much that is.
"""

from __future__ import annotations

import dataclasses
import itertools

import moderngl
import numpy as np
import pytest
from splits import IN_PASS_1, SHAPES, SIZE, ULP, bounds, excess, forced, internal_format, scene_of

from relgloss_view.picture.gpu.constants import WRITES
from relgloss_view.picture.gpu.programs import Programs
from relgloss_view.picture.gpu.renderer import Renderer
from relgloss_view.picture.gpu.shader import ShaderSource
from relgloss_view.picture.gpu.targets import SPLIT, WEIGHTS, WRITTEN, XYZ
from relgloss_view.picture.gpu.uniforms import per_size
from relgloss_view.picture.gpu.variant import Variant
from relgloss_view.picture.method import EXACT, FIRST_PASS, Method
from relgloss_view.picture.model import tone
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.sample import SAMPLES, load_sample


def written(scene, look, method=EXACT):
    """The targets of pass 1."""
    return WRITTEN[Variant.of(scene, look, look.samples or 1, method).writes]


@pytest.fixture
def passes_drawn(monkeypatch):
    """Every draw from here on: the stage, and OpenGL's names of what it reads and writes."""
    drawn = []
    original = Programs.draw

    def draw(self, stage, defines, uniforms, target, *vertices):
        reads = {
            k: v.glo
            for k, v in uniforms.items()
            if isinstance(v, moderngl.Texture) and k in self.get(stage, defines).program
        }
        drawn.append((stage, reads, [texture.glo for texture in target.color_attachments]))
        return original(self, stage, defines, uniforms, target, *vertices)

    monkeypatch.setattr(Programs, "draw", draw)
    return drawn


class TestExactPath:
    """The design's own words: two float targets, then split and scale."""

    @pytest.mark.parametrize("samples", [1, 3])
    def test_pass_1_writes_two_targets_and_pass_2_reads_them(self, renderer, passes_drawn, samples):
        scene, look = scene_of(), Look(sigma_n_deg=1.0, c=0.3, samples=samples)
        renderer.render(scene, look, SIZE)
        stages = {name: (reads, writes) for name, reads, writes in passes_drawn}
        assert [name for name, *_ in passes_drawn if name in PICTURE] == list(PICTURE)
        _, (diffuse, specular) = stages["shade.frag"]
        assert diffuse != specular
        assert stages["shade.frag"][0] == {}  # pass 1 comes of the scene alone
        reads, (split,) = stages["split.frag"]
        assert reads == {"diffuse_image": diffuse, "specular_image": specular}
        reads, (display,) = stages["tone.frag"]
        # The share of a pixel that the object covers is beside diffuse, where it can be a share.
        assert reads["split_image"] == split
        assert reads.get("diffuse_image", diffuse) == diffuse
        assert ("diffuse_image" in reads) == (samples > 1)
        assert len({diffuse, specular, split, display}) == 4

    @pytest.mark.parametrize(
        ("method", "samples", "targets", "numbers"),
        [
            (EXACT, 1, WEIGHTS, "RG32F"),
            (Method(facets="ggx"), 1, WEIGHTS, "RG32F"),
            (EXACT, 3, XYZ, "RGBA32F"),  # XYZ has the share of the pixel in alpha
            (Method(variant=(("writes", "xyz"),)), 1, XYZ, "RGBA32F"),
        ],
    )
    def test_the_targets_are_floats(self, renderer, method, samples, targets, numbers):
        scene, look = scene_of(), Look(sigma_n_deg=1.0, c=0.3, samples=samples)
        renderer.render(scene, look, SIZE, method)
        assert written(scene, look, method) == targets
        for name in targets:
            assert internal_format(renderer, name) == numbers
        assert internal_format(renderer, *SPLIT) == "RGBA32F"
        assert internal_format(renderer, "display") == "RGBA8"

    @pytest.mark.parametrize(
        ("method", "numbers"),
        [(IN_PASS_1, "RGBA32F"), (Method(split=FIRST_PASS, targets="float16"), "RGBA16F")],
    )
    def test_the_cheaper_method_writes_the_split_alone(
        self, renderer, passes_drawn, method, numbers
    ):
        renderer.render(scene_of(), Look(sigma_n_deg=1.0, c=0.3), SIZE, method)
        assert [name for name, *_ in passes_drawn if name in PICTURE] == ["shade.frag", "tone.frag"]
        (split,) = next(writes for name, _, writes in passes_drawn if name == "shade.frag")
        assert split == renderer.texture("split").glo
        assert internal_format(renderer, "split") == numbers

    def test_the_split_is_that_of_the_two_targets(self, renderer):
        """tone.split_lab, in float64, of the XYZ that pass 1 found."""
        scene, look = scene_of(), Look(sigma_n_deg=1.0, c=0.3)
        frame = renderer.render(scene, look, SIZE)
        on = frame.on_object
        expected = tone.split_lab(
            frame.diffuse.astype(np.float64), frame.specular.astype(np.float64), frame.white_xyz
        )
        difference = np.abs(frame._fetch("split") - expected)
        assert np.all(difference[on] <= bounds(frame, 0)[on])
        # Eq. 2 and 3: L~* = L_d* + c L_s*.
        scaled = expected[..., 0] + frame.c * expected[..., 1]
        np.testing.assert_allclose(frame.lab[on][:, 0], scaled[on], atol=3e-4)

    def test_c_max_is_that_of_the_two_targets(self, renderer):
        """Eq. 4 at every pixel: the smallest (100 - L_d*) / L_s* over the object."""
        for sample in SAMPLES:
            frame = renderer.render(scene_of(material=load_sample(sample)), Look(), SIZE)
            l_d, l_s = (part[frame.on_object] for part in frame.split)
            expected = np.min(tone.largest_c(l_d, l_s))
            assert frame.c_max == pytest.approx(expected, rel=1e-5)


PROBE = """#version 330 core
#include "texel.glsl"
uniform sampler2D source_image;
layout(location = 0) out vec4 result;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    result = texel(source_image, SHIFT == 1 ? at + ivec2(1, 0) : at);
}
"""


@pytest.mark.parametrize(
    "size", [(1, 1), (3, 2), (56, 42), (257, 129), (4099, 5), (5, 4099), (8191, 2), (2, 8191)]
)
def test_a_texel_read_by_coordinates_is_that_texel(ctx, size):
    """Its centre is at most 2 roundings of float32 off, 1e-3 of a texel in 8192."""
    values = np.random.default_rng(5).random((size[1], size[0], 4), dtype=np.float32)
    image = ctx.texture(size, 4, values.tobytes(), dtype="f4")
    image.filter = (moderngl.NEAREST, moderngl.NEAREST)
    target = ctx.texture(size, 4, dtype="f4")
    framebuffer = ctx.framebuffer([target])
    for shift in (0, 1):
        source = ShaderSource("probe.frag", {"SHIFT": shift}, PROBE)
        program = ctx.program(vertex_shader=source.vertex, fragment_shader=source.text)
        image.use(0)
        program["source_image"] = 0
        (per_size_name,) = [name for name in program if name.endswith("per_size")]
        program[per_size_name] = per_size(size)["per_size"]
        framebuffer.use()
        ctx.vertex_array(program, []).render(moderngl.TRIANGLES, vertices=3)
        got = np.frombuffer(target.read(), dtype=np.float32).reshape(values.shape)
        # Shifted by one it is the next one: the shader reads where it is asked to.
        inside = slice(0, size[0] - shift)
        np.testing.assert_array_equal(got[:, inside], values[:, shift:])


#: The passes of an exact picture, in order.
PICTURE = ("shade.frag", "split.frag", "tone.frag")


class TestSplitInEitherPass:
    @pytest.mark.parametrize("grain", [0.0, 1.5], ids=["smooth", "grainy"])
    @pytest.mark.parametrize("shape", SHAPES)
    def test_same_within_rounding(self, renderer, shape, grain):
        for sample, azimuth_deg, banded in itertools.product(SAMPLES, (-12.0, 60.0), (False, True)):
            scene = scene_of(shape, load_sample(sample), azimuth_deg)
            look = Look(sigma_n_deg=grain, c=0.4)
            bands = scene.material.bands.count if banded else 0
            exact = renderer.render(scene, look, SIZE, forced(bands=bands))
            _ = exact.diffuse, exact.specular, exact.on_object, exact.display
            exact_split = exact._fetch("split").copy()
            cheaper = renderer.render(
                scene, look, SIZE, dataclasses.replace(forced(bands=bands), split=FIRST_PASS)
            )
            assert np.sum(exact.on_object) > 100
            on = exact.on_object
            np.testing.assert_array_equal(cheaper.on_object, on)
            difference = np.abs(cheaper._fetch("split").astype(np.float64) - exact_split)
            assert np.all(difference[on] <= 2.0 * bounds(exact, bands)[on])
            # A display's value may fall to either side of a step.
            apart = cheaper.display.astype(int) - exact.display
            assert np.max(np.abs(apart)) <= 1
            assert np.mean(apart != 0) < 0.01

    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_c_max_is_the_same(self, renderer, sample):
        """Off by the rounding of L_d* and L_s* over the smaller of 100 - L_d* and L_s*."""
        scene = scene_of(material=load_sample(sample))
        exact = renderer.render(scene, Look(), SIZE)
        cheaper = renderer.render(scene, Look(), SIZE, IN_PASS_1)
        l_d, l_s = exact.split
        ratio = np.where(exact.on_object, tone.largest_c(l_d, l_s), np.inf)
        top = np.unravel_index(np.argmin(ratio), ratio.shape)
        rounding = 2.0 * np.sum(bounds(exact, 0)[top][:2])
        relative = rounding / min(100.0 - l_d[top], l_s[top])
        assert relative < 1e-3
        assert cheaper.c_max == pytest.approx(exact.c_max, rel=relative)

    @pytest.mark.parametrize("samples", [2, 3])
    @pytest.mark.parametrize("shape", SHAPES)
    def test_same_where_samples_share_a_pixel(self, renderer, shape, samples):
        scene, look = scene_of(shape), Look(sigma_n_deg=1.0, c=0.4, samples=samples)
        exact = renderer.render(scene, look, SIZE)
        assert len(np.unique(exact.coverage)) > 2
        _ = exact.specular, exact.display
        cheaper = Renderer(renderer.ctx, renderer.programs).render(scene, look, SIZE, IN_PASS_1)
        assert excess(exact, cheaper) <= 2.0
        np.testing.assert_array_equal(cheaper.coverage, exact.coverage)
        assert np.max(np.abs(cheaper.display.astype(int) - exact.display)) <= 1

    @pytest.mark.parametrize("shape", SHAPES)
    def test_a_lobe_stronger_by_a_ten_thousandth_is_another_picture(self, renderer, shape):
        """Negative control of every comparison here."""
        scene = scene_of(shape)
        lobe = scene.material.specular[0]
        stronger = dataclasses.replace(lobe, strength=tuple(1.0001 * s for s in lobe.strength))
        material = dataclasses.replace(
            scene.material, specular=(stronger, *scene.material.specular[1:])
        )
        look = Look(c=0.4)
        exact = renderer.render(scene, look, SIZE)
        _ = exact.diffuse, exact.specular
        other = Renderer(renderer.ctx, renderer.programs)
        assert excess(exact, other.render(scene, look, SIZE, IN_PASS_1)) <= 2.0
        changed = dataclasses.replace(scene, material=material)
        assert excess(exact, other.render(changed, look, SIZE, IN_PASS_1)) > 2.0


def ways(samples):
    """Every way that pass 1 can write a picture of so many samples."""
    able = WRITES if samples == 1 else [w for w in WRITES if set(XYZ) <= set(WRITTEN[w])]
    return {w: forced(writes=w) for w in able}


class TestStagesOfEveryWay:
    """Whatever pass 1 writes, a frame's diffuse and specular are float32 XYZ."""

    @pytest.mark.parametrize("samples", [1, 2])
    @pytest.mark.parametrize("shape", SHAPES)
    def test_the_split_is_the_same(self, renderer, shape, samples):
        scene, look = scene_of(shape), Look(sigma_n_deg=1.0, c=0.4, samples=samples)
        exact = renderer.render(scene, look, SIZE)
        assert len(ways(samples)) >= 2
        for writes, method in ways(samples).items():
            other = Renderer(renderer.ctx, renderer.programs)
            frame = other.render(scene, look, SIZE, method)
            assert Variant.of(scene, look, samples, method).writes == writes
            assert excess(exact, frame) <= 2.0, writes
            other.release()

    @pytest.mark.parametrize("samples", [1, 2])
    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_xyz_is_the_same(self, renderer, sample, samples):
        """Up to the sums of XYZ, in units of each channel's white."""
        scene = scene_of(material=load_sample(sample))
        look = Look(sigma_n_deg=1.0, c=0.4, samples=samples)
        exact = renderer.render(scene, look, SIZE)
        wanted = {name: getattr(exact, name).astype(np.float64) for name in XYZ}
        for method in (*ways(samples).values(), IN_PASS_1, Method(targets="float16")):
            frame = renderer.render(scene, look, SIZE, method)
            for name, values in wanted.items():
                got = getattr(frame, name)
                assert got.dtype == np.float32
                np.testing.assert_allclose(got, values, rtol=2 * 4 * ULP, atol=0.0)
            np.testing.assert_array_equal(frame.coverage, exact.coverage)

    @pytest.mark.parametrize("method", [EXACT, IN_PASS_1, Method(targets="float16")])
    @pytest.mark.parametrize("sample", list(SAMPLES))
    def test_xyz_is_that_of_the_reference(self, renderer, reference, sample, method):
        """Against float64.

        A point on the object is right to some 1e-7 of the eye's distance over the object's radius,
        about 1e-6 rad of its normal. The diffuse part follows it in proportion; a Gaussian lobe is
        steepest at s, where it changes by 0.61 / s of its peak. 2e-5 more for the chain of some
        hundred roundings and exp.
        """
        scene = scene_of(material=load_sample(sample))
        look = Look(c=0.4)
        frame = renderer.render(scene, look, SIZE, method)
        truth = reference.render(scene, look, SIZE)
        narrowest = min(lobe.s for lobe in scene.material.visible_lobes())
        np.testing.assert_allclose(frame.diffuse, truth.diffuse, atol=3e-5)
        peak = np.max(truth.specular)
        within = (2e-5 + 2e-6 * 0.61 / narrowest) * peak
        np.testing.assert_allclose(frame.specular, truth.specular, atol=within)
        assert np.sum(truth.specular[..., 1] > 100.0 * within) > 10  # it has something to compare

    @pytest.mark.parametrize("quality", ["exact", "auto"])
    def test_a_file_holds_xyz(self, renderer, tmp_path, quality):
        OpenEXR = pytest.importorskip("OpenEXR")
        from relgloss_view.picture.output.export import save_frame

        look = Look(sigma_n_deg=1.0, c=0.4, quality=quality)
        frame = renderer.render(scene_of(), look, SIZE)
        assert (frame.method == EXACT) == (quality == "exact")
        path = tmp_path / "frame.exr"
        save_frame(frame, path)
        fresh = Renderer(renderer.ctx).render(
            scene_of(), look, SIZE, dataclasses.replace(frame.method, **WRITES_XYZ)
        )
        with OpenEXR.File(str(path), separate_channels=True) as file:
            channels = file.channels()
            for name in XYZ:
                stage = getattr(fresh, name)
                assert np.max(stage) > 0.05
                for k, axis in enumerate("XYZ"):
                    pixels = channels[f"{name}.{axis}"].pixels
                    assert pixels.dtype == np.float32
                    np.testing.assert_array_equal(pixels, stage[..., k])


#: What makes pass 1 write XYZ, whatever the method.
WRITES_XYZ = {"variant": (("writes", "xyz"),)}
