"""Renew requirements/: every package in one version, with the hashes of all its files.

    python scripts/lock.py                          # follows pyproject.toml, keeps other versions
    python scripts/lock.py --upgrade                # the newest versions that pyproject.toml allows
    python scripts/lock.py --upgrade-package numpy

`runtime.txt` is enough to draw, and to build the project; `development.txt` adds what the tests and
lint need. uv resolves them for every platform and every Python from the oldest that pyproject.toml
allows, so one file serves all. The files name no index: pip compares what its own index serves with
the hashes.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "requirements"
HEADER = (
    "# Made by `make lock` from pyproject.toml; `make` installs it, and pip checks the hashes.\n"
)
OPTIONS = (
    "--quiet",
    "--no-config",
    "--universal",
    "--generate-hashes",
    "--no-strip-extras",  # pip asks for a hash of `coverage[toml]`, not of `coverage`
    "--no-header",
    "--no-emit-index-url",
    "--no-emit-find-links",
)


def wanted() -> dict[str, list[str]]:
    """The requirements of pyproject.toml by set: those that build the project are in both."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    runtime = [*project["project"]["dependencies"], *project["build-system"]["requires"]]
    development = [*runtime, *project["project"]["optional-dependencies"]["dev"]]
    return {"development": development, "runtime": runtime}


def main() -> int:
    """Resolve both sets, and put them in place when both are there."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    oldest = project["project"]["requires-python"].removeprefix(">=")
    command = ["uv", "pip", "compile", *OPTIONS, "--python-version", oldest, *sys.argv[1:]]
    with tempfile.TemporaryDirectory() as name:
        here = Path(name)
        for kind, requirements in wanted().items():
            source, made = here / f"{kind}.in", here / f"{kind}.txt"
            source.write_text("\n".join(requirements) + "\n", encoding="utf-8")
            if (FOLDER / made.name).exists():
                shutil.copy(FOLDER / made.name, made)  # uv keeps the versions that it finds there
            # The runtime set is a part of the development set, in the same versions.
            same = ["--constraint", "development.txt"] if kind == "runtime" else []
            subprocess.run([*command, *same, source.name, "-o", made.name], cwd=here, check=True)
        FOLDER.mkdir(exist_ok=True)
        for kind in wanted():
            text = (here / f"{kind}.txt").read_text(encoding="utf-8")
            (FOLDER / f"{kind}.txt").write_text(HEADER + text, encoding="utf-8")
            count = sum(line[:1].isalnum() for line in text.splitlines())
            print(f"requirements/{kind}.txt: {count} packages")
    return 0


if __name__ == "__main__":
    sys.exit(main())
