"""The display of a sitting: which one stands before the observer, and what is drawn for it.

It belongs to the session and not to the study. c, c_max and L* are relative to its white, so
settings stay comparable, while digital values are the display's own.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from relgloss_view.display.display import Display
from relgloss_view.display.kept_file import KeptFile, keep_file
from relgloss_view.display.record import ASSUMED, OPTION, ORIGINS, STUDY, SYSTEM, DisplayRecord
from relgloss_view.experiment.design.study import Study
from relgloss_view.experiment.session.display_difference import difference

#: What of [display] describes a screen; the rest is how pictures are drawn and seen.
OF_THE_SCREEN = (
    "transfer", "gain", "offset", "gamma", "flare", "primaries_xy", "white_xy", "profile",
    "luminance_cd_m2", "black_cd_m2",
)  # fmt: skip


@dataclass(frozen=True)
class Sitting:
    """A display as pictures are drawn for it, its record, and its file if it has one."""

    display: Display
    record: DisplayRecord
    file: KeptFile | None = None

    @classmethod
    def of_file(cls, study: Study, path: str, origin: str) -> Sitting:
        """That of a file: the study's display, but for all that describes the screen itself.

        Light that the screen reflects is the room's; the study's stays. Raises InputError.
        """
        file = keep_file(path)
        plain = {name: getattr(Display(), name) for name in OF_THE_SCREEN}
        display = dataclasses.replace(study.setup.display, **{**plain, "profile": path})
        return cls(display, DisplayRecord.of(display, origin, file.digest), file)

    @classmethod
    def of_study(cls, study: Study) -> Sitting:
        """That which the study declares; assumed to be sRGB where it declares none."""
        display = study.setup.display
        origin = STUDY if declares_screen(display) else ASSUMED
        if not display.profile:
            return cls(display, DisplayRecord.of(display, origin))
        file = keep_file(display.profile)
        return cls(display, DisplayRecord.of(display, origin, file.digest), file)


def display_of_record(
    study: Study, record: DisplayRecord, files: Sequence[KeptFile], folder: Path
) -> Display | None:
    """The display that pictures were drawn for, to draw them again; None where its file is gone.

    files: that the session keeps; they are put into `folder`.
    """
    if record.origin in (STUDY, ASSUMED):
        return study.setup.display
    for file in files:
        if file.digest == record.digest:
            return Sitting.of_file(study, file.put_into(folder), record.origin).display
    return None


def declares_screen(display: Display) -> bool:
    """Whether a study describes the screen that it is for."""
    plain = Display()
    return any(getattr(display, name) != getattr(plain, name) for name in OF_THE_SCREEN)


def choose_sitting(
    study: Study,
    given: str | None,
    of_system: str | None,
    before: Sequence[DisplayRecord | None],
    last_given: str | None = None,
) -> Sitting:
    """The display of a sitting. Raises InputError where a file is none of a display.

    given: the file of --display. of_system: the file of the system's profile. before: the records
    of the observer's earlier sittings, None where a sitting has none. last_given: the file of the
    session's last --display. Without --display, that one is taken again; then the study's, the
    system's, sRGB. Where an earlier sitting has no record, its pictures were the study's.
    """
    if given is not None:
        return Sitting.of_file(study, given, OPTION)
    if before and before[-1] is None:
        return Sitting.of_study(study)
    if last_given is not None:
        return Sitting.of_file(study, last_given, OPTION)
    if of_system is not None and not declares_screen(study.setup.display):
        return Sitting.of_file(study, of_system, SYSTEM)
    return Sitting.of_study(study)


def remarks(
    sitting: Sitting, before: Sequence[DisplayRecord | None], system: DisplayRecord | None
) -> list[str]:
    """What the experimenter has to know of the display before the observer continues.

    before: as in choose_sitting. system: the record of the system's own profile, where known.
    """
    record, lines = sitting.record, []
    if before:
        last = before[-1]
        if last is None:
            if record.origin == OPTION:
                lines.append(
                    "the display of the earlier answers is unknown; pictures are drawn for "
                    f"{record.words} from now on"
                )
        elif not (apart := difference(last, record)).same:
            beyond = apart.beyond
            outcome = (
                f"beyond the limits ({'; '.join(beyond)}): the analysis will refuse to pool these "
                "answers with the earlier ones; begin a new observer with --new, or use the "
                "former display"
                if beyond
                else "within the limits: the answers are pooled"
            )
            lines.append(
                f"the display has changed since the last sitting, from {last.words} to "
                f"{record.words}: {apart.words}; {outcome}"
            )
    if system is not None and record.origin in (OPTION, STUDY):
        beyond = difference(system, record).beyond
        if beyond:
            lines.append(
                f"the system has another profile for this display, {system.name} ("
                f"{'; '.join(beyond)}); pictures are drawn for {record.name}, "
                f"{ORIGINS[record.origin]}"
            )
    return lines
