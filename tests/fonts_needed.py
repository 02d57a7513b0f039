"""What tests of names in other scripts need of the machine, and the line that brings it."""

from __future__ import annotations

import pytest

from relgloss_view.base import fonts


def need_east_asian() -> None:
    """Fail with the mending line where no font for Chinese, Japanese and Korean is there."""
    lost = fonts.missing_scripts()
    if lost:
        pytest.fail(
            f"no font has the letters of {', '.join(lost)}: "
            "sudo apt-get install -y --no-install-recommends fonts-noto-cjk"
        )
