"""Options: what a command line says of a picture, in one table.

An option of the command line, its entry in a scene file, its control in the window and its words
in a copied command all come from the declaration of one field, as `option="--seed"` in look.py.
Entries without an option of their own are set by `--set TABLE.ENTRY=VALUE`.
"""

from __future__ import annotations

import ast
import dataclasses
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from relgloss_view.base import shell
from relgloss_view.base.errors import InputError
from relgloss_view.base.parameters import Range
from relgloss_view.base.reading import printable
from relgloss_view.base.toml import AUTO, plain
from relgloss_view.base.words import sentence_case
from relgloss_view.display.display import Display
from relgloss_view.material.recolour import DEFAULT_ILLUMINANT, Colour
from relgloss_view.material.spectra import is_lamp_name
from relgloss_view.pack.shape import Shape
from relgloss_view.picture.scene.look import Look
from relgloss_view.picture.scene.pack_settings import pack_words
from relgloss_view.picture.scene.sample import Sample
from relgloss_view.picture.scene.scene_file import TABLES, build
from relgloss_view.picture.scene.scene_writer import check_sample
from relgloss_view.picture.scene.setting import Setting
from relgloss_view.picture.scene.setup import FurtherLamp, Setup

SET = "--set"
NEW_DISPLAY = Display().for_the_eye()  #: of pictures that no scene file describes
#: Whether a command turns the lamp to the highlight before it draws.
LAMP = "--lamp"
AUTO_LAMP, GIVEN_LAMP = LAMP_CHOICES = ("auto", "given")
#: A further lamp on the command line, and its word for none of a scene file's.
FURTHER, NO_LAMP = "--further-lamp", "none"
FURTHER_METAVAR = "AZIMUTH,ELEVATION[,DISTANCE[,RADIUS[,SHARE]]]"
#: Entries whose value asks for a place of the lamp or the eye.
_PLACES = re.compile(r"(lamp\.(azimuth_deg|elevation_deg|distance_m)|eye\.\w+)=")


@dataclass(frozen=True)
class Option:
    """An option of the command line that sets one entry of a scene file."""

    flag: str  #: such as --sigma-n
    table: str  #: of the scene file
    entry: str
    field: dataclasses.Field[Any]

    @property
    def name(self) -> str:
        """The attribute of parsed arguments that holds the option's value."""
        return self.flag.removeprefix("--").replace("-", "_")

    @property
    def choices(self) -> tuple[str, ...] | None:
        """The names that the option takes; None for a number."""
        names: tuple[str, ...] | None = self.field.metadata.get("options")
        return names

    @property
    def is_file(self) -> bool:
        """Whether the option names a file; "" is none."""
        return bool(self.field.metadata.get("file"))

    @property
    def takes_auto(self) -> bool:
        """Whether "auto" leaves the choice to the program, where the entry is None.

        An entry whose default is None is left out instead.
        """
        return bool(self.field.metadata.get("optional")) and self.field.default is not None

    @property
    def help(self) -> str:
        """A sentence about the entry with its range and default."""
        return self.help_with(self.field.default)

    def help_with(self, default: Any) -> str:
        """The help of a command that begins with another value than the entry's own default."""
        metadata = self.field.metadata
        if self.is_file:
            return sentence_case(metadata["meaning"])
        if self.choices is not None:
            plain = str(default)
            new = getattr(NEW_DISPLAY, self.entry) if self.table == "display" else plain
            usual = plain if new == plain else f"{new}; {plain} with --scene and for a grid"
            return f"{sentence_case(metadata['meaning'])} (default {usual})"
        limits: Range = metadata["range"]
        unit = f" {limits.unit}" if limits.unit else ""
        text = f"{sentence_case(limits.meaning)}, {limits.low:.10g} to {limits.high:.10g}{unit}"
        if self.takes_auto:
            text += f", or {AUTO}: as many as the highlight needs"
        return text if default is None else f"{text} (default {default:g})"

    def read(self, text: str) -> float | int | str | None:
        """The option's value from its word; ValueError where the word is no number."""
        if self.choices is not None or self.is_file:
            return text
        if self.takes_auto and text == AUTO:
            return None
        return int(text) if self.field.metadata.get("whole") else float(text)

    def words(self, value: object) -> list[str]:
        """The option as words of a command line that set the entry to this value."""
        return [self.flag, AUTO if value is None else str(plain(value))]


#: Every option that sets an entry of a scene file, in the order of the tables.
OPTIONS = tuple(
    Option(f.metadata["option"], table, f.name, f)
    for table, kind in TABLES.items()
    for f in dataclasses.fields(kind)
    if f.metadata.get("option")
)
#: The entries that a setting holds, which a grid varies by itself.
SETTING_ENTRIES = tuple(f.name for f in dataclasses.fields(Setting))


def with_settings(setup: Setup, look: Look, settings: Sequence[str]) -> tuple[Setup, Look]:
    """Setup and look after words such as lamp.azimuth_deg=80; InputError names a wrong one.

    All entries of a table are set together: on the way from one display to another, gain and offset
    may contradict each other.
    """
    parts: dict[str, Any] = {**setup.parts(), "look": look}
    changed: dict[str, dict[str, Any]] = {}
    for setting in settings:
        match = re.fullmatch(r"(\w+)\.(\w+)=(.*)", setting, re.DOTALL)
        if match is None or match[1] not in TABLES:
            raise InputError(
                f"--set {setting}: expected TABLE.ENTRY=VALUE with a table of {', '.join(TABLES)}"
            )
        table, entry, text = match.groups()
        changed.setdefault(table, _present(parts[table]))[entry] = read_value(text)
    parts |= {table: build(table, values) for table, values in changed.items()}
    look = parts.pop("look")
    return dataclasses.replace(setup, **parts), look


def _present(part: Any) -> dict[str, Any]:
    """Entries of a part of the scene; without the sizes that follow the form."""
    left_out = part.at_usual() if isinstance(part, Shape) else ()
    names = [f.name for f in dataclasses.fields(part) if f.name not in left_out]
    return {name: getattr(part, name) for name in names}


def with_options(setup: Setup, look: Look, values: Mapping[str, Any]) -> tuple[Setup, Look]:
    """Setup and look after options, by flag; InputError where a value is out of its range."""
    changed: dict[str, dict[str, Any]] = {}
    for option in OPTIONS:
        if option.flag in values:
            changed.setdefault(option.table, {})[option.entry] = values[option.flag]
    look = look.with_entries(**changed.pop("look", {}))
    for table, entries in changed.items():
        setup = setup.with_entries(table, **entries)
    return setup, look


def wants_auto_lamp(setup: Setup, settings: Sequence[str], chosen: str | None) -> bool:
    """Whether the lamp of a new picture is turned to the highlight.

    chosen: one of LAMP_CHOICES, or None for the default: "auto" for forms other than the paper's,
    where no word of `settings` places lamp or eye.
    """
    if chosen is not None:
        return chosen == AUTO_LAMP
    placed = any(_PLACES.match(setting) for setting in settings)
    return setup.shape.kind != Shape().kind and not placed


def scene_words(setup: Setup, look: Look) -> list[str]:
    """Words of a command line that make this setup and look, exactly.

    Entries with an option are stated, but for one of the display that every picture begins with; of
    the others, those that are not the default. A lamp's or a mesh's file is named in full. Raises
    InputError where its name is not UTF-8.
    """
    parts = {**setup.parts(), "look": look}
    words: list[str] = []
    for option in OPTIONS:
        value = getattr(parts[option.table], option.entry)
        if option.is_file:
            words += shell.option(option.flag, _full_name(str(value))) if value else []
        elif (value is not None or option.takes_auto) and not _goes_without_saying(option, value):
            words += option.words(value)
    stated = {(option.table, option.entry) for option in OPTIONS}
    for table, part in parts.items():
        for f in dataclasses.fields(part):
            value = getattr(part, f.name)
            usual = isinstance(part, Shape) and f.name in part.at_usual()
            if value != f.default and not usual and (table, f.name) not in stated:
                words += [SET, f"{table}.{f.name}={written_value(value, f.name)}"]
    for lamp in setup.further_lamps:
        words += shell.option(FURTHER, further_lamp_text(lamp))
    if wants_auto_lamp(setup, [], None):
        words += [LAMP, GIVEN_LAMP]
    return words


def _goes_without_saying(option: Option, value: object) -> bool:
    """Whether every display, new or of a file, has this value where nothing else is given."""
    new = getattr(NEW_DISPLAY, option.entry) if option.table == "display" else None
    return value == option.field.default == new


def further_lamp_of(text: str) -> FurtherLamp:
    """The lamp of words such as -50,20 or -50,20,1.5,0.1,0.3; InputError where they are none."""
    names = [f.name for f in dataclasses.fields(FurtherLamp)]
    words = text.split(",")
    if not 2 <= len(words) <= len(names):
        raise InputError(f"{FURTHER} {printable(text, 60)}: expected {FURTHER_METAVAR}")
    values = {}
    for name, word in zip(names, words, strict=False):
        try:
            values[name] = float(word)
        except ValueError:
            raise InputError(
                f"{FURTHER} {printable(text, 60)}: expected numbers, as {FURTHER_METAVAR}"
            ) from None
    return FurtherLamp(**values)


def further_lamp_text(lamp: FurtherLamp) -> str:
    """A lamp as `further_lamp_of` reads it back, without its last values that are the default.

    >>> further_lamp_text(FurtherLamp(-30.0, 10.0, radius_m=0.05))
    '-30.0,10.0,1.0,0.05'
    """
    fields = dataclasses.fields(FurtherLamp)
    values = [float(getattr(lamp, f.name)) for f in fields]
    while len(values) > 2 and values[-1] == fields[len(values) - 1].default:
        values.pop()
    return ",".join(repr(value) for value in values)


def with_further_lamps(setup: Setup, texts: Sequence[str]) -> Setup:
    """The setup with the lamps of FURTHER's words in place of its own; NO_LAMP removes them."""
    if not texts:
        return setup
    if NO_LAMP in texts:
        if len(texts) > 1:
            raise InputError(f"{FURTHER} {NO_LAMP}: expected no other {FURTHER} beside it")
        return dataclasses.replace(setup, further_lamps=())
    lamps = tuple(further_lamp_of(text) for text in texts)
    return dataclasses.replace(setup, further_lamps=lamps)


def sample_words(sample: Sample) -> list[str]:
    """Words that name the sample; InputError where no file holds it or the file is gone."""
    check_sample(sample)
    if sample.pack is not None:
        return pack_words(sample.pack)
    if sample.name is not None:
        return ["--sample", sample.name, *colour_words(sample.colour)]
    file = pasted_name(str(Path(str(sample.file)).absolute()))
    return [*shell.option("--material", file), *colour_words(sample.colour)]


def colour_words(colour: Colour | None) -> list[str]:
    """The options that give a sample a colour; none where it has its own."""
    if colour is None:
        return []
    flags = colour_flags()
    words = [flags["lab"], ",".join(repr(value) for value in colour.lab)]
    lamp = colour.lab_illuminant
    if lamp != DEFAULT_ILLUMINANT:
        words += [flags["lab_illuminant"], written_value(lamp, "illuminant")]
    return words


def colour_flags() -> dict[str, str]:
    """The options of a Colour, by field."""
    return {f.name: f.metadata["option"] for f in dataclasses.fields(Colour)}


def read_value(text: str) -> object:
    """The value of `--set`: a number, a list or a bare word."""
    try:
        return ast.literal_eval(text)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return text


def written_value(value: object, entry: str = "") -> str:
    """A value as `read_value` reads it back; a lamp's or a mesh's file is named in full."""
    if not isinstance(value, str):
        return AUTO if value is None else repr(plain(value))
    if entry == "file" or (entry == "illuminant" and not is_lamp_name(value)):
        value = _full_name(value)
    return value if read_value(value) is value else repr(value)


def _full_name(name: str) -> str:
    return pasted_name(str(Path(name).absolute()))


def pasted_name(name: str) -> str:
    """A file's name that a line of text can hold; InputError where it is not UTF-8."""
    try:
        name.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError(
            f"{printable(name)}: not UTF-8, so no command can name it; rename the file"
        ) from None
    return name
