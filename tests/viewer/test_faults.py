"""A mistake of the program in the window is a line in it, and a failure of a test."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.resources import asset
from relgloss_view.material.files import load_material
from relgloss_view.material.material import FitRecord
from relgloss_view.viewer.files import open_job
from relgloss_view.viewer.files.fit_process import FitProcess
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.panels.fit import facts
from relgloss_view.viewer.state.model import Model
from relgloss_view.viewer.state.state import State

UNCOATED = load_material(asset("materials", "uncoated.json"))


def fails(*_):
    raise ZeroDivisionError("in\nthe middle")


@pytest.mark.usefixtures("forgiving")
def test_an_action_that_fails_is_reported():
    model = Model(State.initial())
    assert not model.attempt(fails)
    note = model.notes[-1]
    assert note.fault
    assert note.text.startswith("ZeroDivisionError: in the middle; a fault of relgloss")
    assert model.attempt(lambda: None)


def test_a_test_sees_the_fault_itself():
    with pytest.raises(ZeroDivisionError):
        Model(State.initial()).attempt(fails)


@pytest.mark.usefixtures("forgiving")
def test_a_fit_is_shown_where_it_can_not_be_kept(monkeypatch):
    monkeypatch.setattr(open_job, "keep_material", fails)
    monkeypatch.setattr(FitProcess, "__init__", lambda self, path: None)
    monkeypatch.setattr(FitProcess, "run", lambda self, progress: (UNCOATED, None))
    job = OpenJob(asset("papers", "uncoated.csv"), lambda: None)
    assert job.wait(60.0)
    assert job.fault is None
    assert job.result is not None
    assert job.result.sample.material == UNCOATED
    assert "not kept: ZeroDivisionError" in job.result.warning
    assert "\n" not in job.result.warning


#: What a file may hold in the parts of a fit whose content no reader checks.
ANYTHING = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner),
    max_leaves=6,
)
NAMES = (
    "left_out", "near_mirror", "far", "samples", "median_relative_error", "s_deg", "strength",
    "method", "albedo_relative", "sigma_deg", "main_lobe", "s_deg_lower", "no_lobe", "held",
    "largest_strength_upper", "refractive_index", "correlation_with_strength", "gloss_60",
)  # fmt: skip
PARTS = st.dictionaries(st.sampled_from(NAMES), ANYTHING, max_size=6)


@settings(max_examples=60)
@given(residuals=PARTS, errors=PARTS, bounds=PARTS, chosen=st.text(max_size=20))
def test_the_fit_panel_has_words_for_any_evidence(residuals, errors, bounds, chosen):
    fit = FitRecord(residuals=residuals, standard_errors=errors, bounds=bounds, chosen=chosen)
    listed = facts(UNCOATED, fit)
    assert [fact.title for fact in listed][:2] == ["Quality", "Source"]
    assert all("\n" not in fact.text for fact in listed)
