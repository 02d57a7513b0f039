"""Figures leave nothing behind, also where matplotlib can't write to folders of its own."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from relgloss_view.base.child import PACKAGE_FOLDER

CODE = """
import os
from relgloss_view.base import temporaries
from relgloss_view.base.figures import drawing
with drawing():
    pass
place = os.environ["TMPDIR"]
print(*(temporaries.is_temporary(name) for name in os.listdir(place)))
temporaries.remove_all()
print(os.listdir(place), flush=True)
os._exit(0)
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="matplotlib's folders on Linux")
@pytest.mark.parametrize("home", ["/dev/null", ""])
def test_matplotlib_gets_a_folder_that_is_removed(tmp_path, home):
    variables = {
        name: value
        for name, value in os.environ.items()
        if name not in ("MPLCONFIGDIR", "XDG_CONFIG_HOME", "XDG_CACHE_HOME")
    }
    variables["HOME"] = home or str(tmp_path / "home")
    (tmp_path / "tmp").mkdir()
    done = subprocess.run(
        [sys.executable, "-c", CODE], cwd=PACKAGE_FOLDER, capture_output=True, text=True,
        env={**variables, "TMPDIR": str(tmp_path / "tmp")},
    )  # fmt: skip
    first, second = done.stdout.splitlines()
    assert (first, second) == ("" if not home else "True", "[]"), done.stderr
    if home:
        assert done.stderr == ""
