"""The list of dependencies: licences judged, advisories found, no silence taken for an answer."""

from __future__ import annotations

import json
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))

import advisories  # noqa: E402
import dependencies  # noqa: E402
import licences  # noqa: E402
from advisories import Answers, affects, audited, from_files, from_index  # noqa: E402
from licences import COPYLEFT, PERMISSIVE, UNKNOWN, WEAK, judged, licence_of  # noqa: E402
from locked import Pin  # noqa: E402

PINS = [Pin("numpy", "2.4.6"), Pin("pillow", "13.0.0")]


def advisory(name="Pillow", version="13.0.0", **more):
    """An advisory in OSV's format, about one version and a range."""
    affected = {
        "package": {"ecosystem": "PyPI", "name": name},
        "versions": [version],
        "ranges": [{"type": "ECOSYSTEM", "events": [{"introduced": "1"}, {"fixed": "2"}]}],
    }
    return {"id": "PYSEC-1", "aliases": ["CVE-2099-1"], "summary": "planted",
            "affected": [affected], **more}  # fmt: skip


@pytest.mark.parametrize(
    ("expression", "verdict"),
    [
        ("MIT", PERMISSIVE),
        ("BSD-3-Clause AND 0BSD AND Zlib", PERMISSIVE),
        ("Apache-2.0 OR BSD-2-Clause", PERMISSIVE),
        ("GPL-3.0-or-later OR MIT", PERMISSIVE),
        ("MIT AND (GPL-3.0-or-later OR LGPL-2.1+)", WEAK),
        ("MIT AND GPL-3.0-only", COPYLEFT),
        ("AGPL-3.0-only", COPYLEFT),
        ("Apache-2.0 WITH LLVM-exception", PERMISSIVE),
        ("MPL-2.0", WEAK),
        ("", UNKNOWN),
        ("see the file", UNKNOWN),
        ("MIT AND", UNKNOWN),
        ("(MIT", UNKNOWN),
        ("MIT Proprietary", UNKNOWN),
    ],
)
def test_verdicts(expression, verdict):
    assert judged(expression).verdict == verdict


METADATA = {
    "License-Expression: MPL-2.0\nLicense: MIT": ("MPL-2.0", WEAK),
    "License: MIT": ("MIT", PERMISSIVE),
    "License: BSD 9-clause of our own": ("BSD 9-clause of our own", UNKNOWN),
    "License: UNKNOWN\nClassifier: License :: OSI Approved :: ISC License (ISCL)": (
        "ISC",
        PERMISSIVE,
    ),
    "Classifier: License :: OSI Approved :: GNU Affero General Public License v3": (
        "GNU Affero General Public License v3",
        UNKNOWN,
    ),
    "Classifier: License :: OSI Approved\nClassifier: Topic :: MIT": ("none declared", UNKNOWN),
}


@pytest.mark.parametrize("fields", METADATA)
def test_what_a_package_declares(tmp_path, monkeypatch, fields):
    folder = tmp_path / "made_up-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text(f"Metadata-Version: 2.4\nName: made-up\n{fields}\n")
    monkeypatch.syspath_prepend(tmp_path)
    found = licence_of(Pin("made-up", "1.0"))
    assert (found.expression, found.verdict) == METADATA[fields]


def test_a_text_names_the_licence_where_nothing_else_does(tmp_path, monkeypatch):
    folder = tmp_path / "made_up-1.0.dist-info"
    (folder / "licenses").mkdir(parents=True)
    (folder / "METADATA").write_text("Metadata-Version: 2.4\nName: made-up\n")
    (folder / "licenses" / "LICENSE").write_text("GNU GENERAL PUBLIC LICENSE, version 3")
    (folder / "RECORD").write_text("made_up-1.0.dist-info/licenses/LICENSE,,\n")
    monkeypatch.syspath_prepend(tmp_path)
    assert licence_of(Pin("made-up", "1.0")).verdict == COPYLEFT


def test_a_package_that_is_missing_is_unknown_unless_it_is_not_needed():
    assert licence_of(Pin("not-there", "1")).verdict == UNKNOWN
    elsewhere = Pin("not-there", "1", marker="sys_platform == 'nowhere'")
    assert licence_of(elsewhere).verdict == licences.ABSENT


class TestFiles:
    def test_a_planted_advisory_is_shown(self, tmp_path):
        (tmp_path / "deep").mkdir()
        (tmp_path / "deep" / "one.json").write_text(json.dumps(advisory()))
        (tmp_path / "other.json").write_text(json.dumps(advisory("requests")))
        answers = from_files(tmp_path, PINS)
        assert [a.name for a in answers.found["pillow"]] == ["CVE-2099-1"]
        assert answers.checked == {"numpy", "pillow"}
        assert dependencies.advisory_words(PINS[1], [answers]) == "CVE-2099-1"
        assert dependencies.advisory_words(PINS[0], [answers]).startswith("none known (files in")

    @pytest.mark.parametrize(
        "record",
        [
            advisory(version="12.0.0"),
            advisory(withdrawn="2099-01-01T00:00:00Z"),
            advisory("pillow-simd"),
            {**advisory(), "affected": [{"package": {"ecosystem": "npm", "name": "pillow"},
                                         "versions": ["13.0.0"]}]},
        ],
        ids=["version", "withdrawn", "name", "ecosystem"],
    )  # fmt: skip
    def test_one_about_something_else_is_not(self, tmp_path, record):
        (tmp_path / "one.json").write_text(json.dumps(record))
        answers = from_files(tmp_path / "one.json", PINS)
        assert not answers.found
        assert answers.checked == {"numpy", "pillow"}

    def test_a_zip(self, tmp_path):
        with zipfile.ZipFile(tmp_path / "all.zip", "w") as archive:
            archive.writestr("PYSEC-1.json", json.dumps(advisory()))
        assert from_files(tmp_path / "all.zip", PINS).found["pillow"]

    @pytest.mark.parametrize("content", ["", "{", "[]", '{"id": "x"}'])
    def test_files_that_can_not_be_read_leave_everything_unchecked(self, tmp_path, content):
        """Any of them may be about any package; what the others hold is still shown."""
        (tmp_path / "broken.json").write_text(content)
        assert from_files(tmp_path, PINS).checked == set()
        (tmp_path / "one.json").write_text(json.dumps(advisory()))
        answers = from_files(tmp_path, PINS)
        assert answers.checked == {"pillow"} == set(answers.found)
        assert "1 of its files could not be read" in answers.words(2)
        assert dependencies.advisory_words(PINS[0], [answers]) == "not checked"

    @pytest.mark.parametrize("name", ["gone", "empty", "no.zip"])
    def test_nothing_to_read_is_no_answer(self, tmp_path, name):
        (tmp_path / "empty").mkdir()
        (tmp_path / "no.zip").write_text("x")
        answers = from_files(tmp_path / name, PINS)
        assert answers.fault
        assert answers.checked == set()

    @pytest.mark.parametrize(
        ("events", "inside"),
        [
            ([{"introduced": "0"}], True),
            ([{"introduced": "0"}, {"fixed": "2.0"}], False),
            ([{"introduced": "0"}, {"last_affected": "2.0"}], True),
            ([{"introduced": "0"}, {"last_affected": "1.9"}], False),
            ([{"introduced": "2.0.1"}], False),
            ([{"introduced": "1"}, {"fixed": "1.5"}, {"introduced": "1.9"}], True),
            ([{"introduced": "what"}], True),  # can't be compared: rather one too many
        ],
        ids=str,
    )
    def test_ranges(self, events, inside):
        assert affects({"ranges": [{"type": "ECOSYSTEM", "events": events}]}, "2.0") == inside
        assert not affects({"ranges": [{"type": "GIT", "events": events}]}, "2.0")


class TestServices:
    def test_what_pip_audit_skipped_is_not_checked(self):
        """Its last line is then "No known vulnerabilities found", and its status 0."""
        skipped = {"name": "numpy", "skip_reason": "could not be audited"}
        hit = {"name": "Pillow", "version": "13", "vulns": [{"id": "CVE-1", "description": "d"}]}
        out = json.dumps({"dependencies": [skipped, hit]})
        answers = audited(Answers("pip-audit"), out, "No known vulnerabilities found", PINS)
        assert answers.checked == {"pillow"}
        assert [a.name for a in answers.found["pillow"]] == ["CVE-1"]
        assert "the others not" in answers.words(2)
        assert dependencies.advisory_words(PINS[0], [answers]) == "not checked"

    @pytest.mark.parametrize("out", ["", "no JSON", "[]", "{}"])
    def test_no_answer_is_none(self, out):
        answers = audited(Answers("pip-audit"), out, "a\nNo module named pip_audit\n", PINS)
        assert answers.checked == set()
        assert answers.fault == "No module named pip_audit"

    def test_an_index_that_does_not_answer_is_asked_once(self, monkeypatch):
        asked = []

        def nothing(address, timeout):
            asked.append(address)
            raise OSError("no network")

        monkeypatch.setattr(advisories.urllib.request, "urlopen", nothing)
        answers = from_index(PINS)
        assert len(asked) == 1
        assert answers.checked == set()
        assert answers.words(2) == "0 advisories; 0 of 2 packages checked, the others not " \
            "(OSError: no network)"  # fmt: skip


class TestList:
    @pytest.fixture
    def folder(self, tmp_path):
        digest = f" \\\n    --hash=sha256:{64 * 'a'}\n"
        (tmp_path / "runtime.txt").write_text(f"numpy==2.4.6{digest}")
        (tmp_path / "development.txt").write_text(f"numpy==2.4.6{digest}Pillow==13.0.0{digest}")
        return tmp_path

    def run(self, folder, capsys, *words):
        status = dependencies.main(["--requirements", str(folder), *map(str, words)])
        return status, capsys.readouterr().out

    def test_without_a_source_nothing_is_claimed(self, folder, capsys):
        status, out = self.run(folder, capsys)
        assert status == 0
        assert "advisories: not checked" in out
        assert "none known" not in out
        assert "2 packages: 2 permissive" in out
        assert "font Roboto, brought by imgui-bundle: Licensed under the Apache License" in out

    def test_an_advisory_ends_with_status_1(self, folder, capsys):
        (folder / "osv").mkdir()
        (folder / "osv" / "a.json").write_text(json.dumps(advisory("requests")))
        assert self.run(folder, capsys, "--advisories", folder / "osv")[0] == 0
        (folder / "osv" / "b.json").write_text(json.dumps(advisory()))
        status, out = self.run(folder, capsys, "--advisories", folder / "osv", "--markdown")
        assert status == 1
        assert "| pillow | 13.0.0 | tests | MIT-CMU | permissive | CVE-2099-1 |" in out
        assert "- ADVISORY CVE-2099-1 for pillow 13.0.0: planted" in out

    def test_a_licence_without_a_decision_ends_with_status_1(self, folder, capsys, monkeypatch):
        monkeypatch.setattr(dependencies, "licence_of", lambda pin: judged("GPL-3.0-only"))
        status, out = self.run(folder, capsys)
        assert status == 1
        assert "LICENCE TO DECIDE ON: numpy, GPL-3.0-only" in out
        monkeypatch.setitem(dependencies.DECIDED, "numpy", "ours to decide")
        monkeypatch.setitem(dependencies.DECIDED, "pillow", "ours to decide")
        assert self.run(folder, capsys)[0] == 0


def test_the_page_lists_what_is_locked():
    page = (ROOT / "docs" / "dependencies.md").read_text(encoding="utf-8")
    for pin in dependencies.locked_sets(ROOT / "requirements"):
        assert f"| {pin.name} | {pin.version} |" in page, f"{pin.name}: run make dependencies"
