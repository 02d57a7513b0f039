"""Known advisories of packages, from files, from pip-audit, from the package index.

Each source answers for the packages that it was able to look up; for the others it has no answer,
and nobody may read one into it. Advisories are in OSV's format (Open Source Vulnerabilities), which
PyPA's database has too: a JSON object, or YAML, a file.
"""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
import urllib.request
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from locked import DEVELOPMENT, Pin, normalised
from packaging.version import InvalidVersion, Version

ECOSYSTEM = "PyPI"
LONGEST_WAIT_S = 20.0
SUMMARY_LENGTH = 160


@dataclass(frozen=True)
class Advisory:
    """One advisory: its name, as in "CVE-2024-1234", and what it is about."""

    name: str
    summary: str = ""


@dataclass
class Answers:
    """What one source answered."""

    source: str
    checked: set[str] = field(default_factory=set)  #: packages that it has an answer for
    found: dict[str, list[Advisory]] = field(default_factory=dict)
    fault: str = ""  #: why it could not answer for all

    def words(self, count: int) -> str:
        """How far its answers reach, of so many packages."""
        number = sum(map(len, self.found.values()))
        text = f"{number} advisories; {len(self.checked)} of {count} packages checked"
        return f"{text}, the others not ({self.fault})" if self.fault else text


def from_files(path: Path, pins: Sequence[Pin]) -> Answers:
    """Advisories of a file, of a folder with files at any depth, or of a zip of them."""
    answers = Answers(f"files in {path.name}")
    read, broken = 0, 0
    records: dict[str, list[Mapping[str, Any]]] = {}
    try:
        for record in _records(path):
            if record is None:
                broken += 1
                continue
            read += 1
            for name in _names(record):
                records.setdefault(name, []).append(record)
    except (OSError, zipfile.BadZipFile) as error:
        answers.fault = f"can't be read: {error}"
        return answers
    if read == 0:
        answers.fault = "no advisory in it could be read"
        return answers
    if broken:
        answers.fault = f"{broken} of its files could not be read"
        # One of those may be about any package, so only what was found is an answer.
    for pin in pins:
        hit = [a for r in records.get(pin.name, ()) if (a := _advisory(r, pin)) is not None]
        if hit:
            answers.found[pin.name] = hit
        if hit or not broken:
            answers.checked.add(pin.name)
    return answers


def _records(path: Path) -> Iterator[Mapping[str, Any] | None]:
    """Every advisory; None for a file that can't be read."""
    endings = (".json", ".yaml", ".yml")
    if path.suffix == ".zip":
        with zipfile.ZipFile(path) as archive:
            for name in archive.namelist():
                if name.endswith(endings):
                    yield _parsed(archive.read(name), name)
        return
    files = [path] if path.is_file() else sorted(p for p in path.rglob("*") if p.is_file())
    if not path.exists():
        raise FileNotFoundError("there is no such file or folder")
    for file in files:
        if file.name.endswith(endings):
            yield _parsed(file.read_bytes(), file.name)


def _parsed(data: bytes, name: str) -> Mapping[str, Any] | None:
    try:
        if name.endswith(".json"):
            content = json.loads(data)
        else:
            # Where it is installed: nothing else of the project needs it.
            content = importlib.import_module("yaml").safe_load(data)
    except Exception:  # whatever a broken file leads to: it is counted
        return None
    return content if isinstance(content, dict) and "affected" in content else None


def _affected(record: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    for part in record["affected"]:
        package = part.get("package", {})
        if package.get("ecosystem") == ECOSYSTEM:
            yield part


def _names(record: Mapping[str, Any]) -> set[str]:
    if record.get("withdrawn"):
        return set()
    return {normalised(part["package"]["name"]) for part in _affected(record)}


def _advisory(record: Mapping[str, Any], pin: Pin) -> Advisory | None:
    """The advisory, if it is about this version."""
    for part in _affected(record):
        if normalised(part["package"]["name"]) == pin.name and affects(part, pin.version):
            names = [record.get("id", ""), *record.get("aliases", ())]
            name = next((n for n in names if n.startswith("CVE-")), names[0])
            text = record.get("summary") or record.get("details") or ""
            return Advisory(name, " ".join(text.split())[:SUMMARY_LENGTH])
    return None


def affects(part: Mapping[str, Any], version: str) -> bool:
    """Whether a version is one of an `affected` entry: listed, or inside one of its ranges.

    A version that can't be compared counts as affected.

    >>> part = {"ranges": [{"type": "ECOSYSTEM", "events": [{"introduced": "2"}, {"fixed": "3"}]}]}
    >>> affects(part, "2.9"), affects(part, "3.0"), affects(part, "1.0")
    (True, False, False)
    """
    if version in part.get("versions", ()):
        return True
    ranges = [r for r in part.get("ranges", ()) if r.get("type") != "GIT"]
    try:
        return any(_inside(r["events"], Version(version)) for r in ranges)
    except (InvalidVersion, KeyError):
        return True


def _inside(events: Sequence[Mapping[str, str]], version: Version) -> bool:
    inside = False
    for event in events:
        kind, text = next(iter(event.items()))
        at = Version("0.dev0" if text == "0" else text)
        if kind == "introduced" and version >= at:
            inside = True
        elif (kind == "fixed" and version >= at) or (kind == "last_affected" and version > at):
            inside = False
    return inside


def from_audit(requirements: Path, pins: Sequence[Pin]) -> Answers:
    """What pip-audit answers. It exits well where its service did not answer; that is no answer."""
    answers = Answers("pip-audit")
    file = str(requirements / DEVELOPMENT)
    words = ["--require-hashes", "--disable-pip", "--progress-spinner", "off", "-f", "json"]
    try:
        done = subprocess.run(
            [sys.executable, "-m", "pip_audit", *words, "-r", file], capture_output=True, text=True
        )
    except OSError as error:
        answers.fault = str(error)
        return answers
    return audited(answers, done.stdout, done.stderr, pins)


def audited(answers: Answers, out: str, err: str, pins: Sequence[Pin]) -> Answers:
    """The answers in pip-audit's JSON; a package that it skipped is not checked."""
    try:
        listed = json.loads(out)["dependencies"]
    except (ValueError, LookupError, TypeError):
        last = err.strip().splitlines()[-1:] or ["no answer"]
        answers.fault = last[0][:SUMMARY_LENGTH]
        return answers
    wanted = {pin.name for pin in pins}
    for entry in listed:
        name = normalised(entry["name"])
        if "skip_reason" in entry or name not in wanted:
            continue
        answers.checked.add(name)
        hits = [Advisory(v["id"], str(v.get("description", ""))) for v in entry.get("vulns", ())]
        if hits:
            answers.found[name] = [Advisory(h.name, h.summary[:SUMMARY_LENGTH]) for h in hits]
    if len(answers.checked) < len(wanted):
        answers.fault = "it skipped them"
    return answers


def from_index(pins: Sequence[Pin]) -> Answers:
    """What the index itself lists under "vulnerabilities" of each version, at pip's own address."""
    answers = Answers("package index")
    try:
        from pip._internal.models.index import PyPI

        base = str(PyPI.pypi_url)
    except (ImportError, AttributeError):
        answers.fault = "pip does not name its index"
        return answers
    for pin in pins:
        try:
            with urllib.request.urlopen(
                f"{base}/{pin.name}/{pin.version}/json", timeout=LONGEST_WAIT_S
            ) as answer:
                listed = json.load(answer)["vulnerabilities"]
            hits = [Advisory(v["id"], str(v.get("summary") or "")) for v in listed]
        except Exception as error:  # no network, no such page, no JSON: there is no answer
            answers.fault = f"{type(error).__name__}: {error}"[:SUMMARY_LENGTH]
            if not answers.checked:
                return answers  # it does not answer at all
            continue
        answers.checked.add(pin.name)
        if hits:
            answers.found[pin.name] = hits
    return answers
