"""Which display answers belong to: what a session keeps of it, and what is not pooled."""

from __future__ import annotations

import json

import numpy as np
import pytest
from cases import Clock, answer, started, study, to_trial

from relgloss_view.base.errors import InputError
from relgloss_view.cli import main
from relgloss_view.display.display import Display
from relgloss_view.display.icc_writing import matrix_profile, srgb_profile
from relgloss_view.display.record import ASSUMED, OPTION, STUDY, SYSTEM, DisplayRecord
from relgloss_view.experiment.design.grid import Grid
from relgloss_view.experiment.design.stimuli import digest_of, draw_reference
from relgloss_view.experiment.design.study_file import (
    load_study,
    study_digest,
    study_from_dict,
    study_to_dict,
)
from relgloss_view.experiment.report import sentences
from relgloss_view.experiment.report.page import displays_part
from relgloss_view.experiment.report.results import display_numbers
from relgloss_view.experiment.report.tables import ANSWER_COLUMNS, answer_rows
from relgloss_view.experiment.session.display_difference import (
    MOST_BLACK_LSTAR,
    MOST_LUMINANCE_RATIO,
    MOST_MEAN_DE2000,
    difference,
)
from relgloss_view.experiment.session.flow import Flow
from relgloss_view.experiment.session.pool import read_pool
from relgloss_view.experiment.session.records import read_record
from relgloss_view.experiment.session.sitting import Sitting, choose_sitting, remarks
from relgloss_view.experiment.session.store import Store
from relgloss_view.material.cielab import lightness

SMALL = Grid((0.0, 2.0), (0.5, 1.0))
P3 = Display(
    transfer="gain-offset-gamma",
    primaries_xy=((0.68, 0.32), (0.265, 0.69), (0.15, 0.06)),
)


@pytest.fixture
def profiles(tmp_path):
    """An sRGB profile, the same elsewhere, and one of other primaries."""
    (tmp_path / "lab").mkdir()
    files = {"srgb": tmp_path / "srgb.icc", "again": tmp_path / "lab" / "other name.icc",
             "p3": tmp_path / "p3.icc"}  # fmt: skip
    for name, file in files.items():
        file.write_bytes(matrix_profile(P3) if name == "p3" else srgb_profile())
    return {name: str(file) for name, file in files.items()}


def record(origin=STUDY, **entries):
    return DisplayRecord.of(Display(**entries), origin)


def sit(file, made, sitting, name=None, answers=1):
    """An observer answers on a display, in a new sitting."""
    with Store(file, made) as store:
        flow = started(store, name=name) if sitting is None else _begun(store, sitting, name)
        for _ in range(answers):
            answer(flow)


def _begun(store, sitting, name):
    observer = store.observer(name)
    run = store.begin_run(observer, "device", {"platform": "test"}, sitting=sitting)
    flow = Flow(store, observer, run, Clock())
    to_trial(flow)
    return flow


# --- the record -----------------------------------------------------------------------------------


def test_the_record_is_what_srgb_emits():
    """Against the matrix and the curve of IEC 61966-2-1, as the standard prints them."""
    kept = record(luminance_cd_m2=120.0, reflected_cd_m2=0.0)
    matrix = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    half = ((0.5 + 0.055) / 1.055) ** 2.4
    place = 2 * 25 + 4 * 5  # (0.5, 1, 0)
    assert np.allclose(kept.table[place], matrix @ [half, 1.0, 0.0], atol=2e-4)
    assert kept.white_xy == (0.3127, 0.329)
    assert (kept.luminance_cd_m2, kept.luminance_known) == (120.0, True)


def test_black_and_reflected_light_are_in_it():
    kept = record(luminance_cd_m2=100.0, black_cd_m2=0.5, reflected_cd_m2=2.0)
    assert kept.black_cd_m2 == pytest.approx(2.5)
    assert kept.luminance_cd_m2 == pytest.approx(102.0)
    assert not record().black_known


def test_a_record_survives_json_and_refuses_what_is_none():
    kept = record(black_cd_m2=0.1, luminance_cd_m2=100.0)
    content = json.loads(json.dumps(kept.to_dict()))
    assert DisplayRecord.from_dict(content) == kept
    for change in (
        {"xyz": content["xyz"][:-1]}, {"xyz": [None] * 375}, {"origin": "nowhere"},
        {"luminance_cd_m2": 1e300}, {"luminance_known": 1}, {"name": 3}, {"xyz": [0.0] * 375},
        {"more": 1},
    ):  # fmt: skip
        with pytest.raises(ValueError, match="display"):
            DisplayRecord.from_dict({**content, **change})


# --- the difference -------------------------------------------------------------------------------


def test_a_display_does_not_differ_from_itself():
    one = record(luminance_cd_m2=100.0)
    apart = difference(one, one)
    assert apart.same
    assert apart.beyond == ()


@pytest.mark.parametrize(("luminance", "pooled"), [(124.0, True), (126.0, False), (79.0, False)])
def test_the_luminance_of_white(luminance, pooled):
    apart = difference(record(luminance_cd_m2=100.0), record(luminance_cd_m2=luminance))
    assert (apart.beyond == ()) == pooled
    assert apart.mean_de2000 < 1e-9  # each relative to its own white


def test_unknown_luminance_is_not_compared():
    apart = difference(record(), record(luminance_cd_m2=1000.0))
    assert apart.luminance_ratio is None
    assert apart.beyond == ()


def test_black_counts_in_lightness():
    """The L* of a black of 1 % against 0.1 %, by CIE 15's formula."""
    dark = record(luminance_cd_m2=100.0, black_cd_m2=0.1)
    light = record(luminance_cd_m2=100.0, black_cd_m2=1.0)
    apart = difference(dark, light)
    wanted = float(lightness(np.array(0.01)) - lightness(np.array(0.001)))
    assert apart.black_lstar == pytest.approx(wanted, abs=1e-3)
    assert apart.contrasts == pytest.approx((1000.0, 100.0), rel=1e-4)
    assert "1e+03:1 and 100:1" in apart.beyond[-1]


def test_other_primaries_are_beyond_and_a_rounded_white_is_not():
    assert "mean dE2000" in difference(record(), DisplayRecord.of(P3, STUDY)).beyond[0]
    near = difference(record(), record(white_xy=(0.3130, 0.3293)))
    assert near.beyond == ()


def test_limits_are_the_shares_of_the_grid_that_they_claim():
    """Steps of c of the paper's samples in L*, and CIECAM02's brightness of white."""
    colour = pytest.importorskip("colour")
    from relgloss_view.gloss.pose import pose_of
    from relgloss_view.picture.scene.sample import load_sample
    from relgloss_view.picture.scene.setup import Setup

    steps = []
    for name in ("art-coated", "matte-coated", "uncoated"):
        found = pose_of(Setup()).extremes(load_sample(name))
        steps.append(found.smallest_ratio * found.l_s_max / 6.0)
    assert min(steps) == pytest.approx(6.4, abs=0.05)
    assert max(MOST_MEAN_DE2000, MOST_BLACK_LSTAR) < min(steps) / 3.0
    white = np.array([95.047, 100.0, 108.883])
    dim, bright = (
        float(colour.XYZ_to_CIECAM02(white, white, 20.0 * factor, 20.0).Q)
        for factor in (1.0, MOST_LUMINANCE_RATIO)
    )
    share = np.log(bright / dim) / np.log(6.0 / 5.0)
    assert 0.2 < share < 0.3


# --- the study's own display ----------------------------------------------------------------------


def test_the_place_of_a_profile_does_not_count_but_its_content(profiles, tmp_path):
    digests = []
    for name in ("srgb", "again", "p3"):
        file = tmp_path / f"{name}.toml"
        relative = profiles[name].removeprefix(f"{tmp_path}/")
        file.write_text(f'[[samples]]\nname = "uncoated"\n[display]\nprofile = "{relative}"\n')
        digests.append(study_digest(study_to_dict(load_study(file))))
    assert digests[0] == digests[1] != digests[2]


def test_the_study_is_whole_without_its_profile(profiles, tmp_path):
    made = study(grid=SMALL).shown_on(Display(profile=profiles["p3"], seen_on=profiles["srgb"]))
    content = json.loads(json.dumps(study_to_dict(made)))
    (tmp_path / "p3.icc").unlink()
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    again = study_from_dict(content, scratch)
    assert again.setup.display.profile.startswith(str(scratch))
    assert study_digest(study_to_dict(again)) == study_digest(content)
    forged = {**content, "display": {**content["display"], "profile": "/etc/passwd"}}
    assert study_from_dict(forged, scratch).setup.display == again.setup.display
    forged.pop("display_files")
    with pytest.raises(InputError, match="not those that are kept"):
        study_from_dict(forged, scratch)


def test_a_study_without_profile_keeps_its_digest():
    """As the version before displays wrote it."""
    content = study_to_dict(study(grid=SMALL))
    assert "display_files" not in content
    assert not {"profile", "seen_on", "luminance_cd_m2", "reflected_cd_m2"} & set(
        content["display"]
    )


# --- which display is in front of the observer ----------------------------------------------------


def test_which_display_counts(profiles):
    made = study(grid=SMALL)

    def origin(made=made, given=None, system=None, before=(), last=None):
        return choose_sitting(made, given, system, before, last).record.origin

    assert origin() == ASSUMED
    assert origin(system=profiles["p3"]) == SYSTEM
    assert origin(given=profiles["srgb"], system=profiles["p3"]) == OPTION
    assert origin(last=profiles["srgb"], system=profiles["p3"]) == OPTION
    assert origin(made.shown_on(P3), system=profiles["srgb"]) == STUDY
    # A session of an earlier version continues with the pictures that it began with.
    assert origin(system=profiles["p3"], before=[None]) == ASSUMED


def test_a_changed_display_is_reported_before_continuing(profiles):
    made = study(grid=SMALL)
    before = Sitting.of_file(made, profiles["srgb"], OPTION)
    now = Sitting.of_file(made, profiles["p3"], OPTION)
    (line,) = remarks(now, [before.record], None)
    assert "the display has changed" in line
    assert "will refuse to pool" in line
    assert remarks(before, [before.record], None) == []
    (line,) = remarks(before, [], now.record)
    assert "the system has another profile" in line


# --- sessions -------------------------------------------------------------------------------------


def test_a_session_keeps_the_display_whole(profiles, tmp_path):
    made, file = study(grid=SMALL), tmp_path / "a.sqlite"
    sitting = Sitting.of_file(made, profiles["p3"], OPTION)
    sit(file, made, sitting)
    sit(file, made, sitting)
    (tmp_path / "p3.icc").unlink()
    kept = read_record(file, tmp_path)
    assert [run.display for run in kept.runs] == [sitting.record] * 2
    assert [run.screen for run in kept.runs] == [{"platform": "test"}] * 2
    assert [f.data for f in kept.display_files] == [matrix_profile(P3)]
    with Store(file, made) as store:
        given = store.last_given_display()
        assert given is not None
        again = choose_sitting(made, None, None, [], given)
        assert again.record == sitting.record


def two_files(tmp_path, first, second):
    made = study(grid=SMALL)
    for name, display in (("a", first), ("b", second)):
        if display is None:
            sit(tmp_path / f"{name}.sqlite", made, None)
        else:
            on = made.shown_on(display)
            sit(tmp_path / f"{name}.sqlite", on, Sitting.of_study(on))
    return [tmp_path / "a.sqlite", tmp_path / "b.sqlite"]


def test_displays_that_differ_too_much_are_refused_in_a_line(tmp_path):
    files = two_files(tmp_path, Display(luminance_cd_m2=100.0), Display(luminance_cd_m2=300.0))
    with pytest.raises(InputError) as fault:
        read_pool(files, tmp_path)
    line = str(fault.value)
    assert "\n" not in line
    assert all(words in line for words in ("a.sqlite", "b.sqlite", "ratio of white luminances 3",
                                           "limit 1.25", "--pool-displays"))  # fmt: skip
    pool = read_pool(files, tmp_path, pool_displays=True)
    assert len(pool.members) == 2
    assert "pooled all the same" in pool.displays.notes[0]


def test_displays_within_the_limits_are_pooled_and_named(tmp_path):
    files = two_files(tmp_path, Display(luminance_cd_m2=100.0), Display(luminance_cd_m2=110.0))
    pool = read_pool(files, tmp_path)
    assert [d.luminance_cd_m2 for d in pool.displays.displays] == [100.0, 110.0]
    assert pool.displays.beyond == ()


def test_files_without_a_record_pool_with_a_note(tmp_path):
    files = two_files(tmp_path, None, Display())
    pool = read_pool(files, tmp_path)
    assert pool.displays.displays[0] is None
    assert "a.sqlite: no record of the display" in pool.displays.notes[0]


def test_one_observer_on_two_displays(profiles, tmp_path):
    made, file = study(grid=SMALL), tmp_path / "a.sqlite"
    sit(file, made, Sitting.of_study(made), "O1")
    sit(file, made, Sitting.of_file(made, profiles["srgb"], OPTION), "O1")
    assert read_pool([file], tmp_path).displays.beyond == ()
    with Store(file, made) as store:  # a sitting without an answer is none
        store.begin_run(
            store.observer("O1"), "d", {},
            sitting=Sitting.of_file(made, profiles["p3"], OPTION),
        )  # fmt: skip
    assert len(read_pool([file], tmp_path).displays.displays) <= 2
    sit(file, made, Sitting.of_file(made, profiles["p3"], OPTION), "O1")
    with pytest.raises(InputError, match="O1 continued on a display that differs too much"):
        read_pool([file], tmp_path)


# --- what is made of it ---------------------------------------------------------------------------


def test_reports_name_each_display(tmp_path):
    files = two_files(tmp_path, Display(luminance_cd_m2=100.0), Display(luminance_cd_m2=300.0))
    pool = read_pool(files, tmp_path, pool_displays=True)
    lines = sentences.displays(pool)
    assert lines[0].startswith("display 1: sRGB (of the study), 100 cd/m2")
    assert lines[1].startswith("display 2: sRGB (of the study), 300 cd/m2")
    assert "pooled all the same" in lines[2]
    first, second = display_numbers(pool.displays)
    assert (first["answers"], second["answers"]) == (1, 1)
    assert second["from_the_first"]["luminance_ratio"] == pytest.approx(3.0)
    rows = [dict(zip(ANSWER_COLUMNS, row, strict=True)) for row in answer_rows(pool)]
    assert [(row["display"], row["display_name"]) for row in rows] == [(1, "sRGB"), (2, "sRGB")]
    page = displays_part(pool)
    assert "ratio of white luminances 3" in page
    assert "Perceived gloss belongs to a display" in page


def test_stimuli_are_drawn_again_for_each_display(tmp_path, renderer):
    """And each is compared with what was shown on that display alone."""
    made = study(grid=Grid((0.0,), (1.0,)), size_px=64)
    srgb = Sitting.of_study(made)
    half = Sitting.of_study(made.shown_on(Display(transfer="gain-offset-gamma", gamma=3.0)))
    for name, sitting in (("O1", srgb), ("O2", half)):
        on = made.shown_on(sitting.display)
        own = tmp_path / f"{name}.sqlite"
        sit(own, on, sitting, name)
        with Store(own) as store:
            frame = draw_reference(renderer, on)
            store.keep_picture(1, None, None, digest_of(frame), frame.device, {})
    files = [str(tmp_path / f"{name}.sqlite") for name in ("O1", "O2")]
    assert main(["experiment", "export", *files, "--stimuli", str(tmp_path / "out")]) == 0
    manifest = json.loads((tmp_path / "out" / "manifest.json").read_text())
    references = [s for s in manifest["stimuli"] if s["sample"] is None]
    assert [s["display"] for s in references] == [0, 1]
    assert [s["as_shown"] for s in references] == [True, True]
    assert references[0]["sha256"] != references[1]["sha256"]
    assert [d["name"] for d in manifest["displays"]] == ["sRGB", "declared, gamma 3"]
