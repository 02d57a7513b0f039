"""What a screen's profile holds beside colours, what is noted about it, and which are refused."""

from __future__ import annotations

import struct
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))

import made_profiles as made

from relgloss_view.base.errors import InputError
from relgloss_view.display.display import Display
from relgloss_view.display.icc_monitor import BLACK_POINT, NO_BLACK, monitor_of_profile
from relgloss_view.display.icc_tags import CALIBRATED, NO_LUMINANCE, calibration_of
from relgloss_view.display.icc_writing import matrix_profile
from relgloss_view.display.read import monitor_of


def gamma(value):
    return b"curv" + bytes(4) + struct.pack(">IH", 1, round(256 * value))


def sampled(values):
    values = np.round(65535 * np.clip(values, 0.0, 1.0)).astype(">u2")
    return b"curv" + bytes(4) + struct.pack(">I", len(values)) + values.tobytes()


def matrix(tags=(), *, columns=made.COLORANTS, curves=(2.2, 2.2, 2.2)):
    """A profile of version 2 of a matrix, curves and other tags."""
    names = zip((b"rXYZ", b"gXYZ", b"bXYZ"), np.asarray(columns).T, strict=True)
    held = {name: made.xyz_tag(xyz) for name, xyz in names}
    for name, curve in zip((b"rTRC", b"gTRC", b"bTRC"), curves, strict=True):
        held[name] = curve if isinstance(curve, bytes) else gamma(curve)
    held[b"wtpt"] = made.xyz_tag(np.array([0.95, 1.0, 1.09]))
    return made.assembled({**held, **dict(tags)}, lab=False, version=2)


def monitor(*arguments, **keywords):
    return monitor_of_profile(matrix(*arguments, **keywords), "made")


def test_luminance_of_white():
    known = monitor({b"lumi": made.xyz_tag(np.array([150.0, 160.0, 170.0]))})
    assert known.luminance_cd_m2 == 160.0
    assert not any("luminance" in note for note in known.notes)
    assert monitor().luminance_cd_m2 is None
    assert NO_LUMINANCE in monitor().notes
    dark = monitor({b"lumi": made.xyz_tag(np.array([0.1, 0.2, 0.3]))})
    assert dark.luminance_cd_m2 is None
    assert any("0.2 cd/m2" in note for note in dark.notes)


def test_black_of_the_curves_and_of_the_black_point():
    plain = monitor()
    assert not plain.black_known
    assert NO_BLACK in plain.notes
    assert plain.floor.tolist() == [0.0, 0.0, 0.0]
    # The black point is emitted light, relative to white: 0.4 % of it, a little blue.
    black = np.array([0.0038, 0.004, 0.006])
    named = monitor({b"bkpt": made.xyz_tag(black)})
    assert named.black_known
    assert BLACK_POINT in named.notes
    ends = named.xyz(np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]))
    assert np.abs(ends[0] - black).max() < 2e-5  # steps of 1/65536
    assert np.abs(ends[1] - named.white).max() < 1e-12
    # Curves that show light at 0 hold it themselves.
    raised = sampled(0.01 + 0.99 * np.linspace(0.0, 1.0, 256) ** 2.2)
    own = monitor({b"bkpt": made.xyz_tag(black)}, curves=(raised,) * 3)
    assert own.xyz(np.zeros((1, 3)))[0, 1] == pytest.approx(0.01, abs=2e-5)
    assert own.black_known
    assert BLACK_POINT not in own.notes


@pytest.mark.parametrize("part", made.calibration_tags(), ids=["table", "formula"])
def test_the_curves_of_the_video_card(part):
    known = monitor({b"vcgt": part})
    ramp = np.linspace(0.0, 1.0, 256)
    expected = np.stack([ramp**0.9, ramp, ramp**1.1])
    assert np.abs(known.calibration - expected).max() < 5e-5  # gammas in steps of 1/65536
    assert CALIBRATED in known.notes


def test_curves_of_the_card_that_change_nothing_or_are_damaged():
    same = b"vcgt" + bytes(4) + struct.pack(">IHHH", 0, 1, 256, 1) + bytes(range(256))
    assert monitor({b"vcgt": same}).calibration is None
    assert calibration_of(same).shape == (3, 256)
    for part in (same[:-1], b"vcgt", same[:8] + b"\0\0\0\7" + same[12:], same[:14] + bytes(4)):
        assert calibration_of(part) is None
        assert CALIBRATED not in monitor({b"vcgt": part}).notes


@pytest.mark.parametrize(
    ("order", "words"),
    [([1, 0, 2], "red shows green, green shows red"), ([0, 2, 1], "green shows blue")],
)
def test_swapped_channels_are_noted(order, words):
    assert any(words in note for note in monitor(columns=made.COLORANTS[:, order]).notes)
    assert not any("swapped" in note for note in monitor().notes)


def test_curves_that_fall_or_are_flat_at_white_are_noted():
    x = np.linspace(0.0, 1.0, 256)
    falls = monitor(curves=(sampled(x + 0.1 * np.sin(4 * np.pi * x)), 2.2, 2.2))
    assert any("curve of red falls" in note for note in falls.notes)
    flat = monitor(curves=(2.2, sampled(x / 0.9), 2.2))
    assert any("curve of green is flat from 90 % on" in note for note in flat.notes)
    assert flat.emission.digital(np.ones((1, 3)))[0, 1] == pytest.approx(0.9, abs=1 / 255)
    assert not any("curve of" in note for note in monitor().notes)


def test_a_table_and_what_it_can_not_show():
    """Channels do not add: full red and green are as bright as white less blue would not be."""
    known = monitor_of_profile(made.table_profile("mft2", points=17), "made")
    assert known.emission.kind == "table"
    assert known.black_known
    assert np.abs(known.xyz(np.ones((1, 3)))[0] - known.white).max() < 1e-9
    assert np.abs(known.xyz_from_rgb.sum(axis=1) - known.white).max() < 1e-9
    digital = np.random.default_rng(0).random((500, 3))
    light = known.emission.light(digital)
    assert np.abs(known.emission.digital(light) - digital).max() < 1e-7
    assert known.emission.reach(light).all()
    # A tenth is lost at white, so a single channel shows more than its share of white.
    single = known.emission.light(np.eye(3))
    assert np.diag(single).min() > 1.05
    # The negative controls: light beyond white, and an own light that is far off.
    beyond = np.array([[1.3, 1.3, 1.3], [1.0, -0.2, 0.5]])
    assert not known.emission.reach(beyond).any()
    assert np.isfinite(known.emission.digital(beyond)).all()


def test_the_nearest_of_light_out_of_reach():
    """Held against a search over many digital values, by the distance in CIELAB."""
    known = monitor_of_profile(made.table_profile("mft2", points=9), "made")
    rng = np.random.default_rng(1)
    light = rng.uniform(-0.1, 1.4, (40, 3))
    digital, left = known.emission.solved(light)
    edge = rng.random((200_000, 3))
    edge[np.arange(len(edge)), rng.integers(0, 3, len(edge))] = rng.integers(0, 2, len(edge))
    lab = made.lab_of(known.emission.forward(edge))
    wanted = (known.floor + (1.0 - known.floor) * light) @ np.linalg.inv(
        known.emission.rgb_from_connection
    ).T
    searched = np.array([np.linalg.norm(lab - t, axis=1).min() for t in made.lab_of(wanted)])
    out = ~known.emission.reach(light)
    assert out.sum() > 20
    assert (left[out] <= searched[out] + 1e-6).all()
    assert ((digital >= 0.0) & (digital <= 1.0)).all()


def test_a_table_that_can_not_be_inverted():
    """Digital values above 0.8 show the same, and those below 0.1 nothing."""

    def clipped(rgb):
        return made.shown(np.clip((rgb - 0.1) / 0.7, 0.0, 1.0))

    known = monitor_of_profile(made.table_profile("mft2", points=33, colours=clipped), "made")
    digital = np.random.default_rng(2).random((300, 3))
    light = known.emission.light(digital)
    again = known.emission.light(known.emission.digital(light))
    assert np.abs(again - light).max() < 1e-6
    assert known.emission.reach(light).all()


OTHER = {b"nmcl": "named colours", b"prtr": "a printer", b"scnr": "scanner", b"link": "a link"}
GOOD = matrix()


def changed(data, at, value):
    return data[:at] + value + data[at + len(value) :]


def refused():
    """Profiles that are of no screen or damaged, each with a word of what is reported."""
    for kind, words in OTHER.items():
        yield words, changed(GOOD, 12, kind)
    yield "of GRAY", changed(matrix({b"kTRC": gamma(2.2)}), 16, b"GRAY")
    yield "without a table or a matrix", changed(GOOD, 16, b"CMYK")
    yield "not an ICC profile", b""
    yield "not an ICC profile", changed(GOOD, 36, b"none")
    yield "cut off", GOOD[:-1]
    yield "cut off", changed(GOOD, 128, b"\xff\xff\xff\xff")
    yield "without a table or a matrix", changed(GOOD, GOOD.index(b"rXYZ"), b"none")
    yield "lie on a line", matrix(columns=made.COLORANTS[:, [0, 0, 2]])
    yield "lie on a line", matrix(columns=made.COLORANTS * [1.0, 1.0, 0.0])
    yield "shows no light", matrix(columns=np.zeros((3, 3)))
    yield "no more light", matrix(curves=(sampled(np.ones(9)), 2.2, 2.2))
    yield "no more light", matrix(curves=(0.0, 2.2, 2.2))
    yield "longer than its tag", matrix(curves=(b"curv" + bytes(4) + b"\xff" * 6, 2.2, 2.2))
    for numbers in ([0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]):  # a power of 0, and one below
        para = b"para" + bytes(4) + struct.pack(">HH3i", 1, 0, *(int(65536 * n) for n in numbers))
        yield "curve without numbers", matrix(curves=(para, 2.2, 2.2))
    for kind in ("mft2", "mft1", "mAB "):
        table = made.table_profile(kind, points=5)
        at = table.index(kind.encode())
        grid = at + 10 if kind != "mAB " else at + 104
        yield "larger than its tag", changed(table, grid, b"\xff" * (3 if kind == "mAB " else 1))
        yield "other channels", changed(table, at + 8, b"\4")
    flat = made.table_profile(colours=lambda rgb: np.broadcast_to(made.D50, rgb.shape))
    yield "as bright as its white", flat


@pytest.mark.filterwarnings("error")
def test_profiles_of_no_screen_are_refused_in_one_line(tmp_path):
    path = tmp_path / "monitor.icc"
    for words, data in refused():
        path.write_bytes(data)
        with pytest.raises(InputError) as caught:
            monitor_of(str(path))
        assert words in str(caught.value)
        assert str(caught.value).startswith(f"{path}: ")
        assert "\n" not in str(caught.value)


def test_tags_that_overlap_take_no_memory():
    tracemalloc = pytest.importorskip("tracemalloc")
    data = bytearray(matrix_profile(Display()).ljust(4_000_000, b"\0"))
    struct.pack_into(">I", data, 0, len(data))
    struct.pack_into(">I", data, 128, 100)
    for k in range(12, 100):
        struct.pack_into(">4sII", data, 132 + 12 * k, b"t%03d" % k, 3000 + k, 3_900_000)
    tracemalloc.start()
    with pytest.raises(ValueError, match="tags overlap"):
        monitor_of_profile(bytes(data), "made")
    assert tracemalloc.get_traced_memory()[1] < 30_000_000
    tracemalloc.stop()


@pytest.mark.parametrize("seed", [0, 1])
def test_damaged_profiles_are_refused_or_finite(seed):
    """The harness of damaged inputs has more kinds; these strike the tags' own numbers."""
    import input_readers

    rng = np.random.default_rng(seed)
    read = 0
    seeds = input_readers.readers()["display"].seeds()
    for _ in range(25):
        data = bytearray(seeds[rng.integers(len(seeds))])
        for at in 132 + 4 * rng.integers(0, min(len(data) // 4 - 40, 150), 2):
            data[at : at + 4] = struct.pack(
                ">I", rng.choice([0, 1, 255, 1 << 16, 2**31, 2**32 - 1])
            )
        try:
            known = monitor_of_profile(bytes(data), "made")
        except ValueError:
            continue
        read += 1
        digital = rng.random((20, 3))
        assert np.isfinite(known.emission.light(digital)).all()
        back = known.emission.digital(rng.uniform(-0.2, 1.2, (20, 3)))
        assert ((back >= 0.0) & (back <= 1.0)).all()
        assert np.isfinite([*known.white, *known.xyz_from_rgb.ravel(), *known.floor]).all()
    assert 0 < read < 25
