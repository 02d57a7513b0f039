"""A display's file is kept whole, and its place does not count."""

from __future__ import annotations

import json

import pytest

from relgloss_view.base.errors import InputError
from relgloss_view.display.icc_writing import srgb_profile
from relgloss_view.display.kept_file import MOST_BYTES, KeptFile, keep_file
from relgloss_view.display.read import monitor_of

TEXT = b"""format = "relgloss-display"
version = 1
[display]
profile = "%s"  # beside it
luminance_cd_m2 = 160
"""


def test_a_display_file_and_its_profile_are_one(tmp_path):
    here = KeptFile("a.toml", TEXT % b"monitor.icc", srgb_profile())
    there = KeptFile("b.toml", TEXT % b"another name.icc", srgb_profile())
    assert here.digest == there.digest
    assert here.digest != KeptFile("a.toml", TEXT % b"monitor.icc", srgb_profile()[:-4]).digest
    assert here.digest != KeptFile("a.toml", TEXT.replace(b"160", b"161"), srgb_profile()).digest
    file = there.put_into(tmp_path)
    written = {path.suffix: path for path in tmp_path.iterdir()}
    assert str(written[".toml"]) == file
    assert written[".icc"].read_bytes() == srgb_profile()
    assert written[".icc"].name in written[".toml"].read_text()
    again = KeptFile("c.toml", written[".toml"].read_bytes(), written[".icc"].read_bytes())
    assert again.digest == here.digest


def test_it_survives_json_and_a_session(tmp_path):
    for kept in (
        KeptFile("a.toml", TEXT % b"monitor.icc", srgb_profile()),
        KeptFile("display.icc", srgb_profile()),
    ):
        assert KeptFile.from_dict(json.loads(json.dumps(kept.to_dict()))) == kept
        assert KeptFile.from_bytes(kept.to_bytes()) == kept
        assert kept.put_into(tmp_path) == kept.put_into(tmp_path)
    assert monitor_of(kept.put_into(tmp_path)).name == "sRGB built-in"


def test_a_display_file_is_kept_with_the_profile_beside_it(tmp_path):
    (tmp_path / "here").mkdir()
    (tmp_path / "here" / "monitor.icc").write_bytes(srgb_profile())
    (tmp_path / "here" / "a.toml").write_bytes(TEXT % b"monitor.icc")
    kept = keep_file(tmp_path / "here" / "a.toml")
    assert kept == KeptFile("a.toml", TEXT % b"monitor.icc", srgb_profile())
    again = monitor_of(kept.put_into(tmp_path))
    assert again.luminance_cd_m2 == 160.0
    assert keep_file(kept.put_into(tmp_path)).digest == kept.digest


def test_what_is_no_display_is_refused(tmp_path):
    for name, data in (
        ("a.icc", b"x" * 200),
        ("b.toml", b"x = 1\n"),
        ("c.icc", srgb_profile()[:99]),
    ):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(InputError, match=name):
            keep_file(tmp_path / name)
    with pytest.raises(InputError, match=r"none\.icc: can't be read"):
        keep_file(tmp_path / "none.icc")
    large = tmp_path / "large.icc"
    size = MOST_BYTES + 1
    large.write_bytes(
        size.to_bytes(4, "big") + srgb_profile()[4:] + bytes(size - len(srgb_profile()))
    )
    with pytest.raises(InputError, match="at most 6 MB"):
        keep_file(large)
    for value in (
        b"{}",
        b'{"name": 1, "data": "", "profile": null}',
        b'{"name": "", "data": "?", "profile": null}',
    ):
        with pytest.raises(ValueError, match="display file"):
            KeptFile.from_bytes(value)
