"""JavaScript lives in the two rooms of pages, and holds no science beside its one twin."""

from __future__ import annotations

import re
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "relgloss_view"
ROOMS = {"proof/page/js", "catalogue/page/js"}
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


def test_modules_are_small_and_share_no_name():
    names = []
    for path in FOLDER.glob("*.js"):
        text = path.read_text()
        assert len(text.splitlines()) < 400
        assert re.match(r"// [A-Z].{20,}", text)
        assert not re.search("innerHTML|outerHTML|insertAdjacent|document.write|eval|fetch", text)
        kinds = r"^(?:export )?(?:async )?(?:function|class|const|let) (\w+)"
        names += re.findall(kinds, text, re.M)
    assert sorted(set(names)) == sorted(names)
