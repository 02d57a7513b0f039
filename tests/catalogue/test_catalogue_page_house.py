"""JavaScript lives in the rooms of pages and in what they share; its one twin alone is science."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "relgloss_view"
SHARED = PACKAGE / "base" / "js"
ROOMS = {"base/js", "proof/page/js", "catalogue/page/js"}
FOLDER = PACKAGE / "catalogue" / "page" / "js"
PLAIN = {"floor", "ceil", "round", "min", "max"}


def test_javascript_is_in_the_rooms_of_pages_alone():
    found = {path.parent.relative_to(PACKAGE).as_posix() for path in PACKAGE.rglob("*.js")}
    assert found == ROOMS


def test_only_the_twin_holds_formulas():
    """difference.js is compared with Python and Sharma et al. in test_catalogue_page.py."""
    needs = {p.name: set(re.findall(r"\bMath\.(\w+)", p.read_text())) for p in FOLDER.glob("*.js")}
    assert needs.pop("difference.js") > {"hypot", "atan2"}
    assert len(needs) > 5
    assert set().union(*needs.values()) <= PLAIN


@pytest.mark.parametrize("room", sorted(ROOMS))
def test_modules_of_a_page_share_no_name_with_what_pages_share(room):
    """All are one script in one scope, where a second function of a name would win silently."""
    modules = {*SHARED.glob("*.js"), *(PACKAGE / room).glob("*.js")}
    names = [name for path in modules for name in names_of(path.read_text())]
    assert sorted(set(names)) == sorted(names)


def names_of(text):
    """What a module defines at its top: functions, classes and values."""
    kinds = r"^(?:export )?(?:async )?(?:function|class|const|let) (\w+)"
    return re.findall(kinds, text, re.M)


@pytest.mark.parametrize("folder", [SHARED, FOLDER], ids=["base", "catalogue"])
def test_modules_are_small_and_open_no_door(folder):
    assert list(folder.glob("*.js"))
    for path in folder.glob("*.js"):
        text = path.read_text()
        assert len(text.splitlines()) < 400
        assert re.match(r"// [A-Z].{20,}", text)
        assert not re.search("innerHTML|outerHTML|insertAdjacent|document.write|eval|fetch", text)
