"""The profile of a monitor from an X server.

The root window has it as _ICC_PROFILE, and as _ICC_PROFILE_1 and so on for further monitors in
Xinerama's order. Some programs also set _ICC_PROFILE of RandR's output; that is taken where the
root window has none. A change comes as an event: nothing is read before it.

Source: ICC Profiles in X Specification 0.4 (Behrmann 2010); X Resize, Rotate and Reflect Extension
1.5 (Packard 2015); Argyll's dispwin, which sets both.
"""

from __future__ import annotations

import struct

from relgloss_view.base.icc.header import parse_profile
from relgloss_view.display.system.answer import MOST_BYTES, Answer, Place, SystemProfile
from relgloss_view.display.system.colord import Colord
from relgloss_view.display.system.x_connection import PROPERTY_NOTIFY, Connection, value_of

ATOM = "_ICC_PROFILE"
SETTLING_S = 0.05  #: a profile is often set on the root window and the output, one after the other
QUERY_SCREENS = 5  #: of Xinerama
#: Of RandR.
QUERY_VERSION, SELECT_INPUT, OUTPUT_INFO, OUTPUT_PROPERTY, CRTC_INFO, RESOURCES = (
    0,
    4,
    9,
    15,
    20,
    25,
)
SCREENS_AND_PROPERTIES = 1 | 2 | 4 | 8
MOST_MONITORS = 64
MOST_WATCHED = 16  #: monitors whose properties are watched
COLORD_S = 1.0  #: between looks at colord's tables


class XScreens:
    """The monitors of the X server that DISPLAY names. Raises OSError where there is none."""

    def __init__(self, colord: Colord | None = None) -> None:
        """colord: is asked where the server has no profile."""
        self._x = Connection()
        self._colord = colord
        self._xinerama, _ = self._x.extension("XINERAMA")
        self._randr, self._randr_event = self._x.extension("RANDR")
        self._watched = {self._x.atom(name): name for name in map(_name, range(MOST_WATCHED))}
        self._deleted: set[str] = set()  #: of the root window, since this has looked
        self._x.watch_root()
        if self._randr:
            self._x.reply(self._randr, QUERY_VERSION, struct.pack("=II", 1, 3))
            body = struct.pack("=IHH", self._x.root, SCREENS_AND_PROPERTIES, 0)
            self._x.send(self._randr, SELECT_INPUT, body)

    def answer(self, place: Place | None) -> Answer:
        """The profile of the monitor at a place."""
        name = _name(self._number_at(place))
        found = self._x.property_of_root(self._x.atom(name), MOST_BYTES)
        if found is not None:
            return _answer(found, f"the X property {name}")
        found = None if name in self._deleted else self._of_output(place)
        if found is not None:
            return _answer(found, f"the X property {ATOM} of the output")
        return Answer() if self._colord is None else self._colord.answer(self.output_name(place))

    def wait(self, longest_s: float) -> bool:
        """Sleep until a property, the monitors or colord's tables have changed."""
        changed = self._changed()  # events may have been read with a reply: no wait sees those
        if not changed:
            if self._colord is not None and self._colord.there:
                longest_s = min(longest_s, COLORD_S)
            self._x.wait(longest_s)
            changed = self._changed()
        if changed:
            self._x.wait(SETTLING_S)
            self._changed()
        return changed or (self._colord is not None and self._colord.changed())

    @property
    def gone(self) -> bool:
        """Whether the server has gone away."""
        return self._x.gone

    def rouse(self) -> None:
        """End a wait now."""
        self._x.rouse()

    def close(self) -> None:
        """Leave the server."""
        self._x.close()

    def output_name(self, place: Place | None) -> str:
        """RandR's name of the monitor at a place, such as DP-1; empty where there is none."""
        return self._output_at(place)[1]

    def _changed(self) -> bool:
        """Whether an event has come that another profile may follow from."""
        changed = False
        for event in self._x.events():
            kind = event[0] & 0x7F
            if kind == PROPERTY_NOTIFY:
                name = self._watched.get(struct.unpack_from("=I", event, 8)[0])
                if name is not None:
                    changed = True
                    # What is taken away is not found again at the output, where both were set.
                    (self._deleted.add if event[16] else self._deleted.discard)(name)
            elif self._randr and kind in (self._randr_event, self._randr_event + 1):
                changed = True
                self._deleted.clear()
        return changed

    def _number_at(self, place: Place | None) -> int:
        """Xinerama's number of the monitor at a place."""
        places = self._places()
        if place is None or not places:
            return 0
        return max(range(len(places)), key=lambda k: (place.shared(places[k]), -k))

    def _places(self) -> list[Place]:
        found = self._x.reply(self._xinerama, QUERY_SCREENS) if self._xinerama else None
        if found is None:
            return []
        count = min(struct.unpack_from("=I", found, 8)[0], (len(found) - 32) // 8, MOST_MONITORS)
        return [Place(*struct.unpack_from("=hhHH", found, 32 + 8 * k)) for k in range(count)]

    def _of_output(self, place: Place | None) -> tuple[bytes, int, int] | None:
        output = self._output_at(place)[0]
        if not output:
            return None
        atom = self._x.atom(ATOM)
        body = struct.pack("=5IBBH", output, atom, 0, 0, MOST_BYTES // 4, 0, 0, 0)
        return value_of(self._x.reply(self._randr, OUTPUT_PROPERTY, body))

    def _output_at(self, place: Place | None) -> tuple[int, str]:
        """RandR's number and name of the output that shows a place; zero where there is none."""
        best, found = -1, (0, "")
        for output, name, where in self._outputs():
            shared = 0 if place is None else place.shared(where)
            if shared > best:
                best, found = shared, (output, name)
        return found

    def _outputs(self) -> list[tuple[int, str, Place]]:
        """Outputs that show something: number, name, place."""
        if not self._randr:
            return []
        resources = self._x.reply(self._randr, RESOURCES, struct.pack("=I", self._x.root))
        if resources is None:
            return []
        stamp, crtcs, count = struct.unpack_from("=IHH", resources, 12)
        outputs = []
        for k in range(min(count, MOST_MONITORS)):
            (output,) = struct.unpack_from("=I", resources, 32 + 4 * (crtcs + k))
            info = self._x.reply(self._randr, OUTPUT_INFO, struct.pack("=II", output, stamp))
            (crtc,) = (0,) if info is None else struct.unpack_from("=I", info, 12)
            if info is None or not crtc:
                continue
            shown = self._x.reply(self._randr, CRTC_INFO, struct.pack("=II", crtc, stamp))
            if shown is None:
                continue
            counts = struct.unpack_from("=4H", info, 26)  # crtcs, modes, preferred ones, clones
            (length,) = struct.unpack_from("=H", info, 34)
            start = 36 + 4 * (counts[0] + counts[1] + counts[3])
            name = info[start : start + length].decode("latin-1")
            outputs.append((output, name, Place(*struct.unpack_from("=hhHH", shown, 12))))
        return outputs


def _name(number: int) -> str:
    """The property of a monitor by Xinerama's number."""
    return ATOM if number == 0 else f"{ATOM}_{number}"


def _answer(found: tuple[bytes, int, int], source: str) -> Answer:
    """The answer of a property's value."""
    data, bits, left_out = found
    if bits != 8 or not data:
        return Answer(None, f"{source} holds no bytes of a profile", fault=True)
    if left_out:
        return Answer(None, f"{source} is larger than {MOST_BYTES} bytes", fault=True)
    try:
        name = parse_profile(data).description
    except ValueError as error:
        return Answer(None, f"{source}: {error}", fault=True)
    return Answer(SystemProfile(data, name, source))
