"""What the documents say is so: the functions and places they name exist, their commands run."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from relgloss_view import cli

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
METHOD = (ROOT / "docs" / "method.md").read_text(encoding="utf-8")
ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
FIRST_PAIR = (ROOT / "docs" / "first-pair.md").read_text(encoding="utf-8")
PAGES = sorted((ROOT / "docs").glob("*.md"))
DOCUMENTS = [ROOT / "README.md", ROOT / "CHANGELOG.md", ROOT / "shaders" / "README.md", *PAGES]


def blocks(text, *languages):
    """The fenced blocks of a text in these languages; "" is a block without one."""
    fenced = re.findall(r"^ *```(\w*)\n(.*?)^ *```$", text, re.S | re.M)
    return [code for language, code in fenced if language in languages]


def places_named_in(text):
    """(path, names in it) for each file that a text names, and the functions behind it."""
    named = re.findall(r"`((?:relgloss_view|shaders)/[\w/.]*)`((?:(?:,| and)?\s+`\w+`)*)", text)
    return [(place, re.findall(r"`(\w+)`", names)) for place, names in named]


def missing_in(places):
    """What is named but is not there: files, folders, and definitions in a file."""
    missing = []
    for place, names in places:
        path = ROOT / place
        if not path.exists():
            missing.append(place)
            continue
        text = "" if path.is_dir() else path.read_text(encoding="utf-8")
        for name in names:
            defined = rf"\b(def|class|vec\d|float|bool|Hit) {name}\b|^{name}\b[^=\n]*= "
            if not re.search(defined, text, re.M):
                missing.append(f"{place} {name}")
    return missing


def test_method_names_code_that_exists():
    places = places_named_in(METHOD)
    assert len(places) > 30
    assert sum(len(names) for _, names in places) > 40
    assert missing_in(places) == []


def test_missing_places_are_found():
    text = "`shaders/tone.glsl` `largest_c`, `smallest_c`; `shaders/no.glsl`"
    assert missing_in(places_named_in(text)) == ["shaders/tone.glsl smallest_c", "shaders/no.glsl"]


#: What a newcomer looks for, as the first cell of a row names it.
LOOKED_FOR = (
    "eq. 1",
    "eq. 4",
    "the noise law",
    "where an answer is committed",
    "a new shape",
    "a new format of measurement",
    "a new option",
    "a new operator",
)


def test_architecture_leads_to_each_place():
    """Each row of "Where is" names a file and what is in it, and all of them exist."""
    part = ARCHITECTURE.split("## Where is")[1].split("\n## ")[0]
    rows = [row for row in part.splitlines() if row.startswith("| ")]
    for subject in LOOKED_FOR:
        (row,) = [row for row in rows if row.startswith(f"| {subject}")]
        assert any(names for _, names in places_named_in(row)), row
    assert len(places_named_in(part)) > 25
    assert missing_in(places_named_in(ARCHITECTURE)) == []


def test_the_shaders_page_has_each_file_and_its_twin():
    """One row a file; a library has a twin that exists, or the reason why it has none."""
    folder = ROOT / "shaders"
    rows = [
        [cell.strip() for cell in row.strip("|").split("|")]
        for row in (folder / "README.md").read_text(encoding="utf-8").splitlines()
        if re.match(r"\| \w+\.(glsl|frag|vert)", row)
    ]
    named = [name for cells in rows for name in cells[0].split(", ")]
    assert sorted(named) == sorted(path.name for path in folder.iterdir() if path.suffix != ".md")
    twins = {cells[0]: cells[2] for cells in rows if cells[0].endswith(".glsl")}
    assert len(twins) > 8
    for library, twin in twins.items():
        places = places_named_in(twin)
        assert twin.startswith("none: ") or places, library
        assert missing_in(places) == [], library


def test_catalogue_shows_every_column():
    from relgloss_view.catalogue.columns import COLUMNS

    text = (ROOT / "docs" / "catalogue.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| ([\w ]+) \| ([\w ]*?) ?\| (.+) \|$", text, re.M)
    assert rows == [(one.name, one.kind, one.unit, one.meaning) for one in COLUMNS]


def test_exchange_shows_every_ending():
    from relgloss_view.exchange.formats import FORMATS

    text = (ROOT / "docs" / "exchange.md").read_text(encoding="utf-8")
    assert set(FORMATS) <= set(re.findall(r"^\| `(\.\w+)` \|", text, re.M))


def test_links_lead_somewhere():
    targets = [
        (document.parent / target, f"{document.name}: {target}")
        for document in DOCUMENTS
        for target in re.findall(
            r"\]\(([^)#]+)(?:#[\w-]*)?\)", document.read_text(encoding="utf-8")
        )
    ]
    assert len(targets) > 20
    assert [text for path, text in targets if not path.exists()] == []


def rooms_of(text):
    """{folder: names of its modules} as the trees in a text show them.

    A tree is a block between fences with one folder or module a line; what is indented further
    belongs to the folder above.
    """
    rooms = {}
    for tree in blocks(text, ""):
        above = []  # (indent, folder)
        for line in tree.splitlines():
            indent = len(line) - len(line.lstrip())
            while above and above[-1][0] >= indent:
                above.pop()
            if folder := re.match(r"\s*(\w+)/(\s|$)", line):
                above.append((indent, folder[1]))
                rooms["/".join(name for _, name in above)] = set()
            if above:
                place = "/".join(name for _, name in above)
                rooms[place].update(re.findall(r"(?<![\w/.])\w+\.py\b", line))
    return rooms


def test_a_tree_is_read_by_its_indents():
    tree = """```
house/
  cellar.py      stores
  hall/          coats, hat.py
    stairs/      up.py, down.py:
                 both ways.py
    door.py      opens (see other/knob.py)
  attic/         empty
```"""
    assert rooms_of(tree) == {
        "house": {"cellar.py"},
        "house/hall": {"hat.py", "door.py"},
        "house/hall/stairs": {"up.py", "down.py", "ways.py"},
        "house/attic": set(),
    }


def test_architecture_names_every_module():
    """Folder by folder and name by name."""
    rooms = rooms_of(ARCHITECTURE)
    folders = [path.parent for path in (ROOT / "relgloss_view").rglob("__init__.py")]
    assert len(folders) > 20
    for folder in folders:
        place = folder.relative_to(ROOT).as_posix()
        assert place in rooms, f"docs/architecture.md does not show {place}/"
        names = rooms[place]
        there = {path.name for path in folder.glob("*.py")}
        assert names | {"__init__.py"} == there, f"docs/architecture.md, {place}/"
    shown = {place for place in rooms if place.startswith("relgloss_view")}
    assert shown == {folder.relative_to(ROOT).as_posix() for folder in folders}


def study_entries_in(text):
    """The (table, entry) pairs that the rows of docs/experiment.md describe."""
    pairs, table = set(), ""
    for row in re.findall(r"^\|(.*)\|$", text, re.M):
        cells = [cell.strip() for cell in row.split("|")]
        table = cells[0] or table
        entries = re.split(r", | or ", cells[1])
        pairs |= {(name.strip("[] "), entry) for name in table.split(", ") for entry in entries}
    return pairs


def test_the_page_of_the_experiment_has_every_entry_of_a_study():
    import dataclasses

    from relgloss_view.experiment.design.grid import Grid
    from relgloss_view.experiment.design.study_file import PARTS, WORDS

    text = (ROOT / "docs" / "experiment.md").read_text(encoding="utf-8")
    kinds = {**PARTS, "grid": Grid}
    expected = {("study", word) for word in WORDS} | {("samples", "label")}
    expected |= {(name, f.name) for name, kind in kinds.items() for f in dataclasses.fields(kind)}
    assert not expected - study_entries_in(text)
    # Control: without the row of an entry that entry is missing.
    rows = [row for row in text.splitlines(keepends=True) if row.startswith("| ")]
    for table, entry in expected:
        without = text
        for row in rows:
            if re.search(rf"(\| |, ){entry}( \||, )", row):
                without = without.replace(row, "")
        assert (table, entry) not in study_entries_in(without), entry


def test_readme_python_runs(tmp_path):
    (code,) = blocks(README, "python")
    assert len(code.strip().splitlines()) <= 11
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=900
    )
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "matte.png").is_file()


#: Commands that take most of the time; the tests of each command run them on less.
LONG = (
    "proof make carton", "catalogue", "compare", "bench",
    "experiment simulate", "experiment analyse",
)  # fmt: skip
#: Of the others, those whose files they read.
NEEDED = ("fit art-coated uncoated", "experiment new")


def readme_commands():
    """The words of each command in the README."""
    lines = [line for text in blocks(README, "sh") for line in text.splitlines()]
    return [shlex.split(line)[1:] for line in lines if line.startswith("relgloss ")]


def test_readme_commands_run(tmp_path, monkeypatch, capsys):
    """All but LONG, whose options are read alone."""
    monkeypatch.chdir(tmp_path)  # a fresh folder: what pip installed is enough
    commands = readme_commands()
    assert {words[0] for words in commands} == set(cli.COMMANDS)
    for words in commands:
        if " ".join(words).startswith(LONG):
            cli._parser(words).parse_args(words)
        else:
            assert cli.main(words) == 0, words
    assert "written" in capsys.readouterr().out
    assert len(list((tmp_path / "stimuli").glob("*.png"))) == 43
    with pytest.raises(SystemExit):  # control
        cli._parser(["bench", "--quickly"]).parse_args(["bench", "--quickly"])


@pytest.mark.slow
def test_readme_commands_that_take_long_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for words in readme_commands():
        if " ".join(words).startswith((*LONG, *NEEDED)):
            assert cli.main(words) == 0, words


@pytest.fixture
def fresh_tree(tmp_path):
    """A fresh folder beside an environment with relgloss, and that of a newcomer's shell."""
    tree = tmp_path / "relgloss"
    programs = tree / ".venv" / "bin"
    programs.mkdir(parents=True)
    command = programs / "relgloss"
    command.write_text(
        f"#!/bin/sh\nexec {shlex.quote(sys.executable)} -c "
        f"'import sys; from relgloss_view.cli import main; sys.exit(main())' \"$@\"\n"
    )
    command.chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "RELGLOSS_HOME": str(tmp_path / "home"),
    }
    return tree, environment


@pytest.mark.slow
def test_the_first_pair_is_drawn_as_its_page_says(fresh_tree):
    """Every block is pasted into one shell; what the page shows of the output is printed."""
    tree, environment = fresh_tree
    scripts = blocks(FIRST_PAIR, "sh")
    shown = re.findall(r"^```(\w*)\n(.*?)^```$", FIRST_PAIR, re.S | re.M)
    assert {language for language, _ in shown} == {"sh", "text"}
    end = "-- end of a block --"
    done = subprocess.run(
        ["bash", "-eu"],
        input="".join(f"{code}\necho '{end}'\n" for code in scripts),
        cwd=tree,
        env=environment,
        capture_output=True,
        text=True,
        timeout=900,
    )
    assert done.returncode == 0, done.stderr
    printed = iter(done.stdout.split(end))
    output, compared = "", 0
    for language, text in shown:
        if language == "sh":
            output = next(printed)
            continue
        for line in text.splitlines():
            assert line in output.splitlines(), line
            compared += 1
    assert compared >= 4
    made = {path.name for path in (tree / "first-pair").iterdir()}
    named = set(re.findall(r"[\w-]+\.(?:png|toml)\b", "".join(scripts)))
    assert len(named) >= 6
    assert named <= made


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_begins_with_its_task_and_a_command(page):
    """A paragraph of words, and something to paste before the first heading below the title."""
    text = page.read_text(encoding="utf-8")
    assert text.startswith("# ")
    opening = text.split("\n## ")[0]
    assert re.match(r"# .+\n\n[A-Z`]", opening), "no words below the title"
    assert blocks(opening, "sh"), "no command before the first heading"


def commands_of_pages():
    """(place, words) of every relgloss line that stands in a fenced block of a page."""
    for page in DOCUMENTS:
        for text in blocks(page.read_text(encoding="utf-8"), "sh", ""):
            for line in text.splitlines():
                if line.startswith("relgloss "):
                    yield page.name, shlex.split(line, comments=True)[1:]


def test_options_of_commands_exist(capsys):
    """The commands of the pages parse, without being run."""
    checked = 0
    for place, words in commands_of_pages():
        try:
            cli._parser(words).parse_args(words)
        except SystemExit:
            pytest.fail(f"{place}: relgloss {shlex.join(words)}: {capsys.readouterr().err}")
        checked += 1
    assert checked > 30
    with pytest.raises(SystemExit):
        cli._parser(["fit"]).parse_args(["fit", "--no-such-option"])


def test_readme_names_the_make_targets():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.findall(r"(?:^|`)make ([\w-]+)", "\n".join(blocks(README, "sh")), re.M))
    assert {"demo", "test"} <= named
    for target in named:
        assert re.search(rf"^{target}:", makefile, re.M), target
    assert "make test" in (ROOT / ".ci" / "run").read_text(encoding="utf-8")
