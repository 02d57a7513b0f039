"""The grain: hash vectors, distribution tests with a control that fails, the mean lobe."""

from __future__ import annotations

import glsl
import numpy as np
import pytest
from scipy import stats

from relgloss_view.picture.model import noise

SIDE = 1024
SIGMA = float(np.radians(2.0))
#: Tests of this file that compare a p-value; the bound is a family-wise 1 % (Sidak).
COMPARISONS = 8
P_BOUND = 1.0 - (1.0 - 0.01) ** (1.0 / COMPARISONS)

VECTORS = [
    ((0, 0, 0), (2611992518, 2833812075, 1058359340)),
    ((1, 2, 3), (4204755366, 1223881804, 1500469937)),
]


def cells(side=SIDE):
    y, x = np.mgrid[0:side, 0:side]
    return np.stack([x.ravel(), y.ravel(), np.zeros(side * side, dtype=int)], axis=-1)


def test_hash_vectors():
    for key, expected in VECTORS:
        np.testing.assert_array_equal(noise.pcg3d(np.array(key, dtype=np.uint32)), expected)


def test_hash_vectors_on_the_gpu(ctx):
    keys = np.array([key for key, _ in VECTORS], dtype=np.uint32)
    result = glsl.evaluate(
        ctx, ["noise.glsl"], "result = uvec4(pcg3d(key.xyz), 0u);", {"key": keys}, integers=True
    )
    np.testing.assert_array_equal(result[:, :3], [expected for _, expected in VECTORS])


@pytest.mark.parametrize("seed", [0, 1, 2**31 - 1])
def test_hashes_are_identical_on_the_gpu(ctx, seed):
    rng = np.random.default_rng(seed)
    cell = rng.integers(-(2**31), 2**31, (50_000, 3))
    cell[:4] = [[-1, -1, 0], [2**24 + 1, -(2**24) - 1, 5], [0, 0, 0], [2**31 - 1, -(2**31), 2]]
    ours = noise.cell_hash(cell, seed)
    gpu = glsl.evaluate(
        ctx,
        ["noise.glsl"],
        f"result = uvec4(cell_hash(ivec3(cell.xyz), {seed}u), 0u);",
        {"cell": cell.astype(np.int64).astype(np.uint32)},
        integers=True,
    )
    np.testing.assert_array_equal(gpu[:, :3], ours)


def test_neighbouring_and_huge_cells_do_not_repeat():
    big = 2**24
    x = np.concatenate([np.arange(-500, 500), big + np.arange(1000), -big - np.arange(1000)])
    cell = np.stack(np.meshgrid(x, np.arange(-3, 3), indexing="ij"), axis=-1).reshape(-1, 2)
    cell = np.concatenate([cell, np.zeros((len(cell), 1), dtype=int)], axis=1)
    hashes = noise.cell_hash(cell, 0)
    assert len(np.unique(hashes, axis=0)) == len(cell)


def test_extreme_hashes_give_finite_gaussians(ctx):
    words = np.array([0, 1, 2**9 - 1, 2**31, 2**32 - 1], dtype=np.uint32)
    hashes = np.stack(np.meshgrid(words, words, words), axis=-1).reshape(-1, 3)
    u = noise.uniforms(hashes)
    assert np.all((u > 0) & (u < 1))
    assert np.max(np.abs(noise.gaussians(u[:, :2]))) <= 5.77
    gpu = glsl.evaluate(
        ctx, ["noise.glsl"], "result = vec4(gaussians(uniforms(h.xyz).xy), 0, 0);", {"h": hashes}
    )
    # log near 1 is good to 2^-21 absolute in the language's tables, and the radius to its root.
    np.testing.assert_allclose(gpu[:, :2], noise.gaussians(u[:, :2]), atol=2e-3)


def gpu_tilts(ctx, law, seed):
    cell = np.array(cells(), dtype=np.int64).astype(np.uint32)
    return glsl.evaluate(
        ctx,
        ["noise.glsl"],
        f"result = vec4(tilt_angles({law}, cell_hash(ivec3(cell.xyz), {seed}u), {SIGMA!r}), 0, 0);",
        {"cell": cell},
    )[:, :2].astype(np.float64)


class TestDistribution:
    """1024 x 1024 tilts of the shader itself, fixed seeds."""

    @pytest.mark.parametrize("seed", [0, 12345])
    def test_angle_is_half_normal_and_azimuth_uniform(self, ctx, seed):
        tilt = gpu_tilts(ctx, "NOISE_PAPER", seed)
        theta = np.hypot(*tilt.T)
        azimuth = np.arctan2(tilt[:, 1], tilt[:, 0])
        assert stats.kstest(theta, stats.halfnorm(scale=SIGMA).cdf).pvalue > P_BOUND
        assert stats.kstest(azimuth, stats.uniform(-np.pi, 2 * np.pi).cdf).pvalue > P_BOUND
        # Angle and azimuth are independent: rank correlation over a million pairs.
        assert stats.spearmanr(theta, np.abs(azimuth)).pvalue > P_BOUND

    def test_the_tangent_law_fails_the_papers_test(self, ctx):
        theta = np.hypot(*gpu_tilts(ctx, "NOISE_TANGENT", 0).T)
        assert stats.kstest(theta, stats.halfnorm(scale=SIGMA).cdf).pvalue < 1e-12

    def test_the_tangent_law_is_rayleigh(self, ctx):
        theta = np.hypot(*gpu_tilts(ctx, "NOISE_TANGENT", 0).T)
        assert stats.kstest(theta, stats.rayleigh(scale=SIGMA).cdf).pvalue > P_BOUND

    def test_grains_beside_each_other_are_unrelated(self, ctx):
        theta = np.hypot(*gpu_tilts(ctx, "NOISE_PAPER", 0).T).reshape(SIDE, SIDE)
        for a, b in ((theta[:, 1:], theta[:, :-1]), (theta[1:], theta[:-1])):
            r = np.corrcoef(a.ravel(), b.ravel())[0, 1]
            assert abs(r) < 4.0 / SIDE  # four standard errors of a million pairs

    def test_spectrum_is_flat(self, ctx):
        # Spectral flatness of white noise is exp(-Euler's constant) = 0.5615.
        theta = np.hypot(*gpu_tilts(ctx, "NOISE_PAPER", 0).T).reshape(SIDE, SIDE)
        power = np.abs(np.fft.fft2(theta - theta.mean())) ** 2
        flatness = np.exp(np.mean(np.log(power.ravel()[1:]))) / np.mean(power.ravel()[1:])
        assert flatness == pytest.approx(np.exp(-np.euler_gamma), abs=0.005)


MEAN_BODY = """
    vec2 angles = tilt_angles({law}, cell_hash(ivec3(cell.xyz), 7u), {sigma!r});
    vec3 n = tilted(vec3(0.0, 0.0, 1.0), angles);
    vec3 h = vec3(sin({delta!r}), 0.0, cos({delta!r}));
    vec3 e = n - h;
    result = vec4(facet_density(squared_angle(dot(e, e)), {sharpness!r}, 1.0), 0, 0, 0);
"""


class TestMeanLobe:
    """Mean of the noisy lobe over a million grains against the closed form.

    Four standard errors and 1.5 %, which covers the small-angle geometry of the closed form.
    """

    @pytest.mark.parametrize("law", ["paper", "tangent"])
    @pytest.mark.parametrize("ratio", [0.2, 1.0, 5.0])
    @pytest.mark.parametrize("steps", [0.0, 1.0, 3.0])
    def test_mean_and_second_moment(self, ctx, law, ratio, steps):
        sigma = float(np.radians(2.0))
        s, delta = ratio * sigma, steps * ratio * sigma
        name = f"NOISE_{law.upper()}"
        body = MEAN_BODY.format(law=name, sigma=sigma, delta=delta, sharpness=0.5 / s**2)
        cell = np.array(cells(), dtype=np.int64).astype(np.uint32)
        lobe = glsl.evaluate(ctx, ["brdf.glsl", "noise.glsl"], body, {"cell": cell})[:, 0]
        lobe = lobe.astype(np.float64)
        for values, width in ((lobe, s), (lobe**2, s / np.sqrt(2))):
            expected = noise.mean_lobe(np.array(delta), width, sigma, law)
            error = np.std(values) / np.sqrt(len(values))
            assert abs(np.mean(values) - expected) <= 4 * error + 0.015 * expected

    def test_the_other_law_has_another_mean(self):
        # Negative control: at the centre the laws differ by (1 + q^2)^-1/2, far beyond the bound.
        paper = noise.mean_lobe(np.array(0.0), 0.01, 0.03, "paper")
        tangent = noise.mean_lobe(np.array(0.0), 0.01, 0.03, "tangent")
        assert paper / tangent == pytest.approx(np.sqrt(10))

    @pytest.mark.parametrize("law", ["paper", "tangent"])
    def test_integral_is_conserved(self, law):
        delta, step = np.linspace(0, 0.5, 200_001, retstep=True)
        s, sigma = 0.01, 0.02
        total = 2 * np.pi * np.sum(delta * noise.mean_lobe(delta, s, sigma, law)) * step
        assert total == pytest.approx(2 * np.pi * s * s, rel=0.01)


def test_silhouette_grains_stay_visible(ctx):
    rng = np.random.default_rng(1)
    n = np.tile([0.0, 0.0, 1.0], (20_000, 1))
    mu = 10 ** rng.uniform(-7, -1, len(n))
    o = np.stack([np.sqrt(1 - mu**2), 0 * mu, mu], axis=-1)
    hashes = noise.cell_hash(rng.integers(0, 9999, (len(n), 3)), 0)
    sigma = float(np.radians(3.0))
    turned = noise.noisy_normal("paper", n, o, hashes, sigma)
    assert np.min(np.sum(turned * o, axis=-1)) > 0.0
    gpu = glsl.evaluate(
        ctx,
        ["noise.glsl"],
        f"result = vec4(noisy_normal(NOISE_PAPER, vec3(0, 0, 1), o.xyz, h.xyz, {sigma!r}), 0);",
        {"o": o.astype(np.float32), "h": hashes},
    )
    # The same draw in float32 may take another step of halving on a hair's breadth.
    close = np.abs(gpu[:, :3] - turned).max(axis=1) < 1e-4
    assert np.mean(close) > 0.99
    assert np.min(np.sum(gpu[:, :3] * o.astype(np.float32), axis=-1)) > -1e-6


def test_no_noise_is_the_normal_itself():
    n = np.array([[0.0, 0.6, 0.8]])
    hashes = noise.cell_hash(np.array([[1, 2, 3]]), 0)
    assert noise.noisy_normal("paper", n, n, hashes, 0.0) is n
