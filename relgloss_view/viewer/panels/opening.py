"""The small window over a file that is being opened: how far it is, and ways to stop."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import ImVec2, imgui

from relgloss_view.base.reading import printable
from relgloss_view.pack.forms.mesh_files import MESH_SUFFIXES
from relgloss_view.viewer.files.open_job import OpenJob
from relgloss_view.viewer.files.pack_files import ARTWORK_SUFFIXES
from relgloss_view.viewer.panels import floating
from relgloss_view.viewer.shell import widgets

TITLE = "Opening"
READ_SUFFIXES = (*ARTWORK_SUFFIXES, *MESH_SUFFIXES, ".toml")  #: of files that are never fitted


def show(job: OpenJob, name: str, waiting: int) -> bool:
    """Show the progress of a job; cancels it where asked. Returns whether to drop those that wait.

    waiting: how many files come after it.
    """
    fraction, text = job.progress
    flags = imgui.WindowFlags_.no_resize | imgui.WindowFlags_.no_focus_on_appearing
    _, stays = floating.begin(TITLE, 26.0, flags=flags, top_em=4.0)
    read = fraction == 0.0 or job.path.lower().endswith(READ_SUFFIXES)
    doing = "Reading" if read else "Fitting"
    imgui.text_unformatted(f"{doing} {printable(name or Path(job.path).name, 40)}")
    imgui.progress_bar(fraction, ImVec2(-1.0, 0.0), f"{100.0 * fraction:.0f} %")
    queue = f"; {waiting} more to come" if waiting else ""
    imgui.text_disabled(printable(text, 60) + queue)
    if widgets.button("Cancel", "stops; nothing changes and no file is left") or not stays:
        job.cancel()
    all_of_them = False
    if waiting:
        imgui.same_line()
        if widgets.button("Cancel all", "stops this file and those that wait"):
            all_of_them = True
            job.cancel()
    imgui.end()
    return all_of_them
