"""Layers: shares of finishes by hand, area averages, and what keeps them."""

import numpy as np
import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.pack.artwork.artwork import Artwork
from relgloss_view.pack.finish import Finish
from relgloss_view.pack.layers import REST, ZERO, halved, layers_of
from relgloss_view.pack.pack import Pack
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.sample import load_sample

PAPER = load_sample("matte-coated")


def pack(*finishes, plates=None, size=(4, 6), **entries):
    """A pack of (kind, mask) finishes on a gray artwork."""
    height, width = size
    xyz = np.full((height, width, 3), 0.5, dtype=np.float16)
    plates = {k: np.asarray(v, dtype=np.uint8) for k, v in (plates or {}).items()}
    artwork = Artwork(xyz, 60.0, 40.0, plates=plates)
    made = tuple(Finish(f"f{k}", kind, PAPER, mask=m) for k, (kind, m) in enumerate(finishes))
    return Pack("p", entries.pop("shape", Shape()), made, artwork, **entries)


def shares(layers, row, column):
    specular, diffuse = layers.shares(layers.channels[row, column] / 255.0)
    return np.round(specular, 3).tolist(), np.round(diffuse, 3).tolist()


def test_later_finishes_lie_above_and_varnish_hides_no_diffuse():
    foil, varnish = np.zeros((2, 4, 6))
    foil[:2], varnish[:, :3] = 255, 255
    layers = layers_of(
        pack(
            ("ink", ""), ("foil", "plate:F"), ("varnish", "plate:V"),
            plates={"F": foil, "V": varnish},
        )
    )  # fmt: skip
    # Of base, foil, varnish: specular; diffuse.
    assert shares(layers, 0, 0) == ([0, 0, 1], [0, 1, 0])  # varnish over foil
    assert shares(layers, 0, 5) == ([0, 1, 0], [0, 1, 0])  # foil alone
    assert shares(layers, 3, 0) == ([0, 0, 1], [1, 0, 0])  # varnish over ink
    assert shares(layers, 3, 5) == ([1, 0, 0], [1, 0, 0])
    assert layers.specular_channel == (REST, 1, 0)
    assert layers.diffuse_channel == (REST, 2, ZERO)


def test_half_masks_multiply_in_their_order():
    half, third = np.full((4, 6), 128), np.full((4, 6), 85)
    layers = layers_of(
        pack(("ink", ""), ("foil", "plate:A"), ("ink", "plate:B"), plates={"A": half, "B": third})
    )
    specular, _ = layers.shares(layers.channels[0, 0] / 255.0)
    a, b = 128 / 255, 85 / 255
    assert specular == pytest.approx([(1 - a) * (1 - b), a * (1 - b), b], abs=1 / 255)
    reverse = layers_of(
        pack(("ink", ""), ("ink", "plate:B"), ("foil", "plate:A"), plates={"A": half, "B": third})
    )
    other, _ = reverse.shares(reverse.channels[0, 0] / 255.0)
    assert abs(other[2] - specular[1]) > 0.1  # the order counts


def test_levels_are_area_means_down_to_one_texel():
    rng = np.random.default_rng(3)
    plate = rng.integers(0, 256, (5, 7))
    layers = layers_of(pack(("ink", ""), ("foil", "plate:A"), plates={"A": plate}, size=(5, 7)))
    assert [paint.shape[:2] for paint, _ in layers.levels] == [(5, 7), (3, 4), (2, 2), (1, 1)]
    assert layers.levels[-1][1][0, 0, 0] == pytest.approx(plate.mean(), abs=1.0)
    # Texel (0, 0) of level 1 covers 5/3 rows and 7/4 columns.
    rows, columns = np.array([1, 2 / 3]), np.array([1, 3 / 4])
    mean = rows @ plate[:2, :2] @ columns / (rows.sum() * columns.sum())
    assert layers.levels[1][1][0, 0, 0] == pytest.approx(mean, abs=0.51)
    assert halved(np.ones((1, 3, 2))).tolist() == [[[1, 1], [1, 1]]]


def test_shares_never_pass_one_at_any_level():
    rng = np.random.default_rng(4)
    plates = {f"p{k}": rng.integers(0, 256, (9, 13)) for k in range(5)}
    kinds = ("foil", "varnish", "ink", "varnish", "stock")
    finishes = [("ink", ""), *((kind, f"plate:p{k}") for k, kind in enumerate(kinds))]
    layers = layers_of(pack(*finishes, plates=plates, size=(9, 13)))
    for _, channels in layers.levels:
        for places in (layers.specular_channel, layers.diffuse_channel):
            used = channels[..., [c for c in places if c >= 0]]
            assert used.astype(int).sum(axis=-1).max() <= 255


def test_looks_keep_the_layers_and_masks_do_not():
    plates = {"A": np.full((4, 6), 255), "B": np.zeros((4, 6))}
    first = pack(("ink", ""), ("varnish", "plate:A"), plates=plates)
    layers = layers_of(first)
    assert layers_of(first.with_finish("f1", k=2.0, sigma_n_deg=1.0)) is layers
    assert layers_of(first.with_finish("f1", material=load_sample("uncoated"))) is layers
    assert layers_of(first.with_finish("f1", mask="plate:B")) is not layers
    assert layers_of(first.with_finish("f1", kind="foil")) is not layers


def test_parts_and_what_is_outside_the_artwork():
    layers = layers_of(
        pack(("ink", ""), ("varnish", "everywhere"), ("foil", "part:top"), ("ink", "part:side"))
    )
    # The side is all that is printed, so its finish is everywhere on the artwork.
    assert layers.part_finish == (-1, 2, 1)
    assert layers.part_diffuse == (-1, 2, 0)
    assert (layers.outside_finish, layers.outside_diffuse) == (3, 3)
    assert layers.specular_channel == (ZERO, ZERO, ZERO, REST)


@pytest.mark.parametrize(
    ("finishes", "message"),
    [
        ([("varnish", "")], "can't be a varnish"),
        ([("ink", "plate:A")], "leave its mask out"),
        ([("ink", ""), ("foil", "plate:Gold")], "no such plate; the artwork has A"),
        ([("ink", ""), ("foil", "part:lid")], "a part of the cylinder: side, top, bottom"),
        ([("ink", ""), ("foil", "")], "expected plate:NAME"),
        ([("ink", ""), ("foil", "gold.png")], "expected plate:NAME"),
        (
            [("ink", ""), *[("foil", f"plate:p{k}") for k in range(6)], ("varnish", "plate:A")],
            "need 13 channels",
        ),
    ],
)
def test_faults_are_one_line(finishes, message):
    plates = {"A": np.full((4, 6), 9), **{f"p{k}": np.full((4, 6), 9) for k in range(6)}}
    plates = plates if len(finishes) > 2 else {"A": plates["A"]}
    with pytest.raises(InputError, match=message):
        layers_of(pack(*finishes, plates=plates))


def test_colours_measured_45_0_hold_the_lobes_part():
    from relgloss_view.pack.measured import lobe_at_45_0

    lobe = lobe_at_45_0(PAPER)
    body = layers_of(pack(("ink", "")))
    assert np.all(body.paint[..., :3] == np.float16(0.5))
    measured = layers_of(pack(("ink", ""), measured="45-0"))
    assert measured.paint[0, 0, :3] == pytest.approx(0.5 - lobe, abs=5e-4)
    assert lobe[1] > 1e-3
