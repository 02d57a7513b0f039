"""Whatever bytes a file holds, a reader gives a sound measurement or an InputError."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from files import GCMS, GENERIC, rgl_fields, tensor_file
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.measure import table
from relgloss_view.measure.readers import read_measurement

BSDF = tensor_file(rgl_fields())
MERL_HEADER = struct.pack("<3i", 90, 90, 180)
SEEDS = (GCMS.encode(), GENERIC.encode(), BSDF, MERL_HEADER + bytes(200))

#: What people and programs write into the fields of a table.
TOKENS = st.sampled_from(
    (
        "0", "1", "-1", "45", "-45", "90", "1e5", "1e308", "1e-320", "-0.0", "nan", "inf", "1_0",
        "0x1", ",", ";", "#", ":", "'", "٣", "R", "G", "B", "400", "500", "nm", "alpha_deg",
        "beta_deg", "gamma_deg", "quantity:", "brdf", "brdf-cos", "theta_i_deg", "phi_i_deg",
        "theta_r_deg", "phi_r_deg", "saturation:", "aperture_sd_deg:", "gamma_s_deg:", '"', " ",
        "\t", "\n", "\r\n", "\x0b", "\u2028", "\ufeff", "\x00",
    )
)  # fmt: skip

quick = settings(max_examples=150, deadline=None)


@pytest.fixture(scope="module")
def outcome(tmp_path_factory):
    path = tmp_path_factory.mktemp("fuzz") / "input"

    def read(content):
        """Whether the content was read; fails on anything but a sound measurement or InputError."""
        path.write_bytes(content)
        message = None
        try:
            m = read_measurement(path, quantity="brdf-cos")
        except InputError as error:
            message = str(error)
        if message is not None:
            assert str(path) in message
            assert "\n" not in message
            return False
        count = len(m.reasons)
        assert m.radiance_factor.shape == (count, m.bands.count)
        assert m.group.shape == (count,)
        assert m.kept.any()
        assert np.isfinite(m.radiance_factor[m.kept]).all()
        assert (m.radiance_factor[m.kept] >= 0).all()
        for directions in (m.to_lamp, m.to_receiver):
            assert directions.shape == (count, 3)
            np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1.0, rtol=1e-12)
            assert (directions[m.kept, 2] >= 0.05 - 1e-12).all()
        assert sum(m.left_out().values()) == count - m.kept.sum()
        assert set(m.left_out()) <= {
            table.NEGATIVE, table.MISSING, table.SATURATED, table.OCCLUDED, table.GRAZING,
            table.BELOW,
        }  # fmt: skip
        return True

    return read


def test_the_seeds(outcome):
    assert [outcome(seed) for seed in SEEDS] == [True, True, True, False]


@quick
@given(content=st.binary(max_size=300), head=st.sampled_from((b"", BSDF[:14], MERL_HEADER)))
def test_random_bytes(outcome, content, head):
    outcome(head + content)


@quick
@given(words=st.lists(TOKENS, max_size=60), head=st.sampled_from(("", GCMS, GENERIC)))
def test_random_text(outcome, words, head):
    outcome((head + "".join(words)).encode())


@quick
@given(
    which=st.integers(0, len(SEEDS) - 1),
    edits=st.lists(
        st.tuples(st.floats(0, 1), st.sampled_from("rid"), st.binary(min_size=1, max_size=8)),
        min_size=1,
        max_size=6,
    ),
    kept=st.sampled_from((1.0, 1.0, 0.9, 0.5)),
)
def test_mutated_files(outcome, which, edits, kept):
    seed = SEEDS[which]
    content = bytearray(seed[: int(kept * len(seed))])
    for place, kind, data in edits:
        at = int(place * len(content))
        if kind == "i":
            content[at:at] = data
        elif kind == "d":
            del content[at : at + len(data)]
        else:
            content[at : at + len(data)] = data
    outcome(bytes(content))


@quick
@given(data=st.data())
def test_mutated_directory_of_a_bsdf(outcome, data):
    # Numbers in the directory, where a wrong one could make a reader allocate or run away.
    directory = BSDF.index(b"made up")
    at = data.draw(st.integers(12, directory - 8))
    number = data.draw(st.one_of(st.integers(0, 300), st.sampled_from([2**31, 2**63, 2**64 - 1])))
    outcome(BSDF[:at] + struct.pack("<Q", number) + BSDF[at + 8 :])


@quick
@given(
    name=st.sampled_from(("theta_i", "sigma", "ndf", "vndf", "rgb", "phi_i", "jacobian")),
    value=st.one_of(st.floats(width=64), st.sampled_from([0.0, 1e38, -1e38, 1e-45, 1e308])),
    dtype=st.sampled_from(("f4", "f8")),
    where=st.sampled_from((slice(0, 1), slice(5, 9), slice(None))),
)
def test_strange_numbers_in_a_bsdf(outcome, name, value, dtype, where):
    with np.errstate(over="ignore"):
        field = rgl_fields()[name].astype(dtype)
        field.reshape(-1)[where] = value
    outcome(tensor_file(rgl_fields(**{name: field})))
