"""Profiles that are made of displays, read back by Argyll to the colours that they show."""

from __future__ import annotations

import dataclasses
import struct

import numpy as np
import pytest
from screens import D65, profile_file, screen, shown, to_d50, xicclu

from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import profile_of, profile_of_monitor, srgb_profile
from relgloss_view.display.model import DisplayModel
from relgloss_view.display.monitor import Monitor
from relgloss_view.display.read import monitor_of
from relgloss_view.material.cielab import lab_from_xyz
from relgloss_view.material.difference import delta_e_2000
from relgloss_view.material.spectra import white_from_xy

D50 = np.array([0.9642, 1.0, 0.8249])
P3 = ((0.68, 0.32), (0.265, 0.69), (0.15, 0.06))
GAMMA = Display(
    transfer="gain-offset-gamma", gain=0.95, offset=0.05, gamma=2.3, flare=0.01, primaries_xy=P3
)
DECLARED = {
    "gain, offset, gamma, flare": GAMMA,
    "brighter black": dataclasses.replace(GAMMA, luminance_cd_m2=200.0, black_cd_m2=8.0),
    "darker black": dataclasses.replace(GAMMA, luminance_cd_m2=200.0, black_cd_m2=0.4),
}
#: dE2000. Numbers of a profile have steps of 1/65536: 0.007 L* at black, and less elsewhere.
NEAR = 0.03


def colours():
    steps = np.array([0.0, 0.02, 0.2, 0.5, 0.8, 1.0])
    return np.stack(np.meshgrid(steps, steps, steps), axis=-1).reshape(-1, 3)


def apart(one, other):
    """dE2000 of XYZ (N, 3) under D50."""
    return delta_e_2000(lab_from_xyz(one, D50), lab_from_xyz(other, D50))


@pytest.mark.parametrize("name", list(DECLARED))
def test_a_declared_display(name, tmp_path):
    display = DECLARED[name]
    path = tmp_path / "a.icc"
    path.write_bytes(profile_of(display))
    model = DisplayModel.of(display)
    theirs = xicclu(path, colours(), "-ff", "-ir", "-px")
    assert apart(to_d50(model.xyz(colours()), model.white), theirs).max() < NEAR
    # The negative control: a display of twice the black shows other colours.
    black = model.black_cd_m2
    other = DisplayModel.of(
        dataclasses.replace(display, luminance_cd_m2=model.luminance_cd_m2, black_cd_m2=2.0 * black)
    )
    assert apart(to_d50(other.xyz(colours()), model.white), theirs).max() > 30.0 * NEAR


def test_a_measured_monitor(tmp_path):
    path = profile_file(tmp_path)
    theirs = xicclu(path, colours(), "-ff", "-ir", "-px")
    expected = to_d50(shown(colours()), white_from_xy(D65))
    assert apart(expected, theirs).max() < NEAR
    without = to_d50(shown(colours(), black=np.zeros(3)), white_from_xy(D65))
    assert apart(without, theirs).max() > 30.0 * NEAR  # the negative control


def test_what_is_written_is_read(tmp_path):
    made, read = screen(), monitor_of(profile_file(tmp_path))
    assert read.luminance_cd_m2 == pytest.approx(160.0, abs=1e-3)
    assert read.black_known
    assert np.abs(read.floor - made.floor).max() < 2e-5
    assert np.abs(read.xyz_from_rgb - made.xyz_from_rgb).max() < 1e-4
    assert read.icc == profile_of_monitor(read)


def test_luminance_is_written_where_it_is_known():
    def luminance(data):
        count = struct.unpack_from(">I", data, 128)[0]
        for tag, at, _ in struct.iter_unpack(">4sII", data[132 : 132 + 12 * count]):
            if tag == b"lumi":
                return struct.unpack_from(">i", data, at + 12)[0] / 65536.0
        return None

    assert luminance(profile_of(GAMMA)) is None
    assert luminance(profile_of(dataclasses.replace(GAMMA, luminance_cd_m2=140.0))) == 140.0


def test_the_rooms_light_is_in_no_profile():
    in_a_room = dataclasses.replace(GAMMA, reflected_cd_m2=5.0, background_lstar=20.0)
    assert profile_of(in_a_room) == profile_of(GAMMA)
    assert profile_of(Display(reflected_cd_m2=5.0)) == srgb_profile()
    assert profile_of(Display(black_cd_m2=1.0)) != srgb_profile()


def test_a_table_is_not_written_as_curves():
    class Tabled:
        kind = "table"

    made = screen()
    fields = {f.name: getattr(made, f.name) for f in dataclasses.fields(made)}
    with pytest.raises(ValueError, match="table"):
        profile_of_monitor(Monitor(**(fields | {"emission": Tabled()})))
