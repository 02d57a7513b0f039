"""In the real window every text can be read: none is cut, none is written over another, in every
size of window and text and in five languages of names. By the texts' own extents as they are drawn.
"""

from __future__ import annotations

import pytest
from extents_window import NAMES, STUDIES, read_all
from fonts_needed import need_east_asian

SIZES = ((1280, 800), (1920, 1080), (3840, 2160))
SMALL = ((800, 500), (640, 400))
FONTS = (1.0, 2.0)


def case(size, font, language, screens=("panels", "compared", "export", "new")):
    name = f"{size[0]} x {size[1]}, text {font:g}, {language}"
    return {"name": name, "size": size, "font": font, "language": language, "screens": screens}


CASES = [case(size, font, language) for size in SIZES for font in FONTS for language in NAMES]
CASES += [case(size, font, "Japanese") for size in SMALL for font in FONTS]
FIRST = [
    case(SIZES[0], 1.0, "Japanese"),
    case(SIZES[0], 2.0, "German", ("panels",)),
    case(SMALL[0], 2.0, "Chinese", ("panels",)),
]


def check(case, entry):
    """Nothing is cut, and what has to be there was drawn, the name in its own letters."""
    assert entry["faults"] == []
    letters = ["".join(text.split()) for seen in entry["seen"] for text in seen["letters"]]
    beginning = "".join(NAMES[case["language"]].split())[:3]
    assert any(f"Test:{beginning}" in t or f"):{beginning}" in t for t in letters)
    numbers = [t for seen in entry["seen"] for t in seen["letters"] if "sigma_N" in t]
    assert any("c " in text or "(c) " in text for text in numbers)
    assert any("°" in text for text in numbers)


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    need_east_asian()
    control = case((1280, 800), 1.0, "German", ("controls",)) | {"name": "control"}
    return read_all([*FIRST, control], tmp_path_factory.mktemp("first"))


@pytest.mark.parametrize("case", FIRST, ids=lambda case: case["name"])
def test_nothing_is_cut(first, case):
    check(case, first[case["name"]])


def test_every_panel_was_looked_at(first):
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.state.state import State

    titles = {panel.title for panel in App(State.initial()).layout.panels}
    entry = first[FIRST[0]["name"]]
    assert set(entry["panels"]) == titles
    texts = {text for seen in entry["seen"] for text in seen["letters"]}
    assert len(texts) > 100
    assert {"Graininess (sigma_N)", "File", "Fit"} <= texts


def test_what_is_cut_or_written_over_is_found(first):
    """The control: beside them is a text that is whole, which is not found."""
    faults = first["control"]["faults"]
    assert len(faults) == 3
    assert "'A text that" in faults[0]
    assert "is cut (x)" in faults[0]
    assert "'one text' in Control is written over 'another'" in faults[1]
    assert "Control is narrower than its content" in faults[2]


def test_small_windows_hide_panels(first):
    """Where panels and pictures don't both fit, the pictures stay, and their numbers."""
    letters = [t for seen in first[FIRST[-1]["name"]]["seen"] for t in seen["letters"]]
    assert not any(text.startswith(("Graininess", "Look", "Lightness")) for text in letters)
    assert "Too small for panels" in letters
    letters = [t for seen in first[FIRST[0]["name"]]["seen"] for t in seen["letters"]]
    assert "Lightness" in letters


@pytest.mark.slow
def test_nothing_is_cut_in_any_size_and_language(tmp_path):
    need_east_asian()
    found = read_all(CASES, tmp_path)
    assert {name: entry["faults"] for name, entry in found.items() if entry["faults"]} == {}
    for each in CASES:
        check(each, found[each["name"]])


# --- the window in which people judge -------------------------------------------------------------

PAGES = [
    {"name": f"{study} {size[0]}", "study": study, "size": size}
    for study in STUDIES
    for size in (SIZES[0], SMALL[1])
]
LARGE = [{"name": f"{study} large", "study": study, "size": SIZES[1]} for study in STUDIES]


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    need_east_asian()
    return read_all(PAGES, tmp_path_factory.mktemp("pages"))


@pytest.mark.parametrize(
    "case", [c for c in PAGES if c["study"] != "Thai"], ids=lambda c: c["name"]
)
def test_an_observer_can_read_every_page(pages, case):
    check_pages(case, pages[case["name"]])


def check_pages(case, entry):
    title, consent, *_, categories, label = STUDIES[case["study"]]
    assert entry["faults"] == []
    assert entry["pages"] == ["consent", "instructions", "object", "trial"]
    consent_page, _, object_page, trial = (
        "".join("".join(s["letters"]).split()) for s in entry["seen"]
    )
    assert "".join(title.split()) in consent_page
    assert "".join(consent.split())[:20] in consent_page
    assert "".join(label.split()) in object_page
    assert all("".join(name.split()) in trial for name in categories)


@pytest.mark.parametrize("size", [c["size"] for c in PAGES if c["study"] == "Thai"])
def test_letters_without_a_font_are_reported_before_anything_is_asked(pages, size):
    entry = pages[f"Thai {size[0]}"]
    assert entry["pages"][:2] == ["warning", "consent"]
    warning = " ".join(entry["seen"][0]["letters"])
    assert "experimenter" in warning
    assert "U+0E01" in warning
    assert "the consent text" in warning
    assert "I agree" not in warning


@pytest.mark.slow
def test_pages_in_a_large_window(tmp_path):
    need_east_asian()
    found = read_all(LARGE, tmp_path)
    for each in LARGE:
        if each["study"] == "Thai":
            test_letters_without_a_font_are_reported_before_anything_is_asked(
                {f"Thai {SIZES[1][0]}": found[each["name"]]}, SIZES[1]
            )
        else:
            check_pages(each, found[each["name"]])
