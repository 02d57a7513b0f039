"""A proof in the window's state: whose settings are displayed, and what was changed since."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base.errors import RelglossError
from relgloss_view.base.reading import printable
from relgloss_view.display.display import Display
from relgloss_view.display.model import DisplayModel
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.proof.proof import Message, Proof
from relgloss_view.proof.screen_words import screen_line
from relgloss_view.proof.screens import LONGEST_NAME as LONGEST_SCREEN
from relgloss_view.proof.screens import MOST_BLACK, Screen
from relgloss_view.proof.settings import LampPlace, PictureSetting, Settings
from relgloss_view.viewer.state.screens import Screen as Monitored
from relgloss_view.viewer.state.state import SIDES, THIS_MONITOR, State

NOBODY = "someone without a name"
LONGEST_NAME = 60  #: characters of an author
DIGEST_SHOWN = 8  #: first characters of a digest
_PLACE = tuple(f.name for f in dataclasses.fields(LampPlace))


@dataclass(frozen=True)
class OpenProof:
    """A proof that the window has opened.

    path: of its file. folder: where its scene was unpacked. base: the scene as it is there.
    signed: who signed each message, in words, one a message.
    """

    path: str
    folder: str
    proof: Proof
    base: State
    signed: tuple[str, ...]

    @property
    def newest(self) -> State:
        """The scene with the settings of the newest message."""
        return self.at(len(self.proof.messages) - 1)

    def at(self, index: int) -> State:
        """The scene with the settings of a message."""
        return with_settings(self.base, self.proof.messages[index].settings, self.folder)


def settings_of(state: State, folder: str = "") -> Settings:
    """The part of a state that a proof's message holds.

    folder: of an unpacked proof, whose lamp files are named without it. Both c must be numbers.
    """
    sides = {}
    for name in SIDES:
        look = state.side(name).look
        assert look.c is not None, "the window keeps c as a number"
        sides[name] = PictureSetting(look.sigma_n_deg, look.c)
    lamp = LampPlace.of(state.setup.lamp)
    if not is_lamp_name(lamp.illuminant) and folder:
        file = Path(lamp.illuminant)
        if file.is_relative_to(folder):
            name = file.relative_to(folder).as_posix()
            lamp = dataclasses.replace(lamp, illuminant=name)
    return Settings(sides["reference"], sides["test"], state.setup.eye, lamp)


def with_settings(state: State, settings: Settings, folder: str = "") -> State:
    """The state with the settings of a proof's message; all else stays."""
    lamp = settings.lamp
    if not is_lamp_name(lamp.illuminant) and folder:
        lamp = dataclasses.replace(lamp, illuminant=str(Path(folder) / lamp.illuminant))
    settings = dataclasses.replace(settings, lamp=lamp)
    for name in SIDES:
        own = settings.side(name)
        state = state.with_setting(name, Setting(own.sigma_n_deg, c=own.c))
    return dataclasses.replace(state, setup=settings.in_setup(state.setup))


def shown_message(state: State, opened: OpenProof, preferred: int = -1) -> int | None:
    """The index of the message whose picture the state shows exactly; None where it shows another.

    preferred: the one to name where several messages have the same settings; else the newest.
    """
    if not _has_c(state) or changed_parts(state, opened.base):
        return None
    present = settings_of(state, opened.folder)
    messages = opened.proof.messages
    order = [preferred % len(messages), *reversed(range(len(messages)))]
    return next((k for k in order if messages[k].settings == present), None)


def changed_parts(state: State, base: State) -> tuple[str, ...]:
    """What a state has other than a proof's scene and a message can't hold, in words.

    How the pictures are laid out, how they are drawn, and the match don't count: they change
    neither the samples nor the light.
    """
    parts = []
    for name in SIDES:
        side, own = state.side(name), base.side(name)
        if side.sample != own.sample:
            is_pack = side.sample.pack is not None and own.sample.pack is not None
            parts.append(f"the {name}'s {'pack' if is_pack else 'sample'}")
        if _bare(side.look) != _bare(own.look):
            parts.append(f"the {name}'s grain")
    setup, first = state.setup, base.setup
    if setup.shape != first.shape:
        parts.append("the form")
    lamp = dataclasses.replace(setup.lamp, **{n: getattr(first.lamp, n) for n in _PLACE})
    if lamp != first.lamp or setup.further_lamps != first.further_lamps:
        parts.append("size, strength or number of the lamps")
    if setup.display != first.display:
        parts.append("the display")
    return tuple(parts)


def _bare(look: Look) -> Look:
    """A look without what a message holds, and without how precisely it is drawn."""
    return look.with_entries(sigma_n_deg=0.0, c=1.0, quality="exact", samples=None)


def _has_c(state: State) -> bool:
    return all(state.side(name).look.c is not None for name in SIDES)


# --- words ----------------------------------------------------------------------------------------


def author_of(message: Message) -> str:
    """Who wrote a message, fit to print."""
    return printable(message.author, LONGEST_NAME) or NOBODY


def time_of(message: Message) -> str:
    """When a message was made, fit to print: day and minute in UTC.

    >>> time_of(Message(None, made="2026-11-27T08:30:00Z"))
    '2026-11-27 08:30 UTC'
    """
    text = printable(message.made, 20)
    day, _, clock = text.partition("T")
    return f"{day} {clock[:5]} UTC" if clock else text


def standing_words(state: State, opened: OpenProof, preferred: int = -1) -> str:
    """Whose picture is displayed: a message's, or a change of the user's own."""
    index = shown_message(state, opened, preferred)
    if index is not None:
        return f"As sent by {author_of(opened.proof.messages[index])}"
    parts = changed_parts(state, opened.base)
    return f"Changed by you: {', '.join(parts)}" if parts else "Changed by you"


def setting_words(setting: PictureSetting) -> str:
    """A picture's setting in words.

    >>> setting_words(PictureSetting(2.0, 0.3127))
    'graininess 2°, contrast gloss (c) 0.313'
    """
    return f"graininess {setting.sigma_n_deg:.3g}°, contrast gloss (c) {setting.c:.3g}"


def message_words(proof: Proof, index: int) -> tuple[str, ...]:
    """A message in lines: its settings, of eye and lamp what differs from the one before; screen.

    The screen is that of its author, where they have checked it.
    """
    message = proof.messages[index]
    present = message.settings
    lines = [f"{name.capitalize()}: {setting_words(present.side(name))}" for name in SIDES]
    if screen := screen_line(message.screen):
        lines.append(f"Author's screen: {screen}")
    if index == 0:
        return tuple(lines)
    before = proof.messages[index - 1].settings
    if present.eye != before.eye:
        lines.append("Object turned or moved")
    if present.lamp.illuminant != before.lamp.illuminant:
        lines.append(f"Lamp's light: {printable(present.lamp.illuminant, LONGEST_NAME)}")
    if dataclasses.replace(present.lamp, illuminant=before.lamp.illuminant) != before.lamp:
        lines.append("Lamp moved")
    return tuple(lines)


def monitor_as_sent(state: State, screen: Monitored, *, is_reply: bool) -> dict[str, Any] | None:
    """What the window knows of the monitor it lies on, as a message holds it; None: nothing.

    What the scene declares of white, black and the room is this monitor's where pictures are drawn
    for this monitor. A reply's scene declares the designer's, which is left out. A black without
    the light of the room is only the least that an observer sees.
    """
    display = Display(profile=screen.file)
    if state.presentation.screen == THIS_MONITOR and not is_reply:
        own = state.setup.display
        display = dataclasses.replace(
            display,
            luminance_cd_m2=own.luminance_cd_m2,
            black_cd_m2=own.black_cd_m2,
            reflected_cd_m2=own.reflected_cd_m2,
        )
    try:
        model = DisplayModel.of(display)
        share = model.black_cd_m2 / model.luminance_cd_m2
        black = share if model.black_known and 0.0 <= share <= MOST_BLACK else None
        found = Screen(
            model.luminance_cd_m2 if model.luminance_known else None,
            black_least=black,
            black_most=black if model.reflected_cd_m2 > 0.0 else None,
            name=printable(screen.name, LONGEST_SCREEN)[:LONGEST_SCREEN] if screen.file else "",
        )
    except RelglossError:
        return None
    return None if found == Screen() else found.as_json()
