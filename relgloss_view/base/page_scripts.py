"""Pages as one file: ES modules joined to one script, data as JSON in HTML, hashes for a policy.

A page's js/ folder holds ES modules; base/js holds those that several pages share. Here their
import lines and the word `export` are taken away, so that all of them are one script in one scope,
in the order in which they need each other; no two of them give the same name to different things
(tests hold it).
"""

from __future__ import annotations

import base64
import hashlib
import json
import re
from pathlib import Path
from typing import Any

from relgloss_view.base.visible import visible

_IMPORT = re.compile(r'^import\b[^;]*?from\s+"(\.{1,2}/[\w./-]+\.js)";\n', re.M)
_EXPORT = re.compile(r"^export (?=(?:async |const |let |function |class ))", re.M)
_ENDS = re.compile("</script|<!--|\r|\0", re.I)


def one_script(folder: Path, *entries: str) -> str:
    """Modules of a folder, with all that they need, as one script that shares no name outside."""
    code = f'"use strict";\n(() => {{\n{bundle(folder, *entries)}\n}})();\n'
    assert not _ENDS.search(code), "browsers would end it early"
    return code


def bundle(folder: Path, *entries: str) -> str:
    """The modules that some of them need, with them, each after those that it needs."""
    ordered: dict[Path, str] = {}

    def add(path: Path, trail: tuple[str, ...]) -> None:
        name = path.name
        assert name not in trail, f"{name} imports itself by way of {' > '.join(trail)}"
        if path in ordered:
            return
        text = path.read_text(encoding="utf-8")
        for other in _IMPORT.findall(text):
            add((path.parent / other).resolve(), (*trail, name))
        ordered[path] = f"// {name}\n" + condensed(_EXPORT.sub("", _IMPORT.sub("", text)))

    for entry in entries:
        add((folder / entry).resolve(), ())
    return "\n".join(ordered.values())


def condensed(text: str) -> str:
    """A module without indentation, empty lines and lines of comment alone: a third less to send.

    No text in backquotes goes over several lines, so a line's beginning is never part of one.

    >>> condensed("/** Twice x. */\\nfunction f(x) {\\n  // Really.\\n  return 2 * x;\\n}\\n")
    'function f(x) {\\nreturn 2 * x;\\n}'
    """
    kept, in_comment = [], False
    for line in map(str.strip, text.split("\n")):
        in_comment = in_comment or line.startswith("/*")
        if line and not in_comment and not line.startswith("//"):
            assert line.count("`") % 2 == 0, f"a text in backquotes over several lines: {line}"
            kept.append(line)
        in_comment = in_comment and not line.endswith("*/")
    return "\n".join(kept)


def html_text(text: str) -> str:
    """Plain text as HTML, as browsers write it, on one line.

    >>> html_text("R&D\\u00a0<1>")
    'R&amp;D&nbsp;&lt;1&gt;'
    """
    line = visible("".join(" " if c in "\n\r\t\f" else c for c in text), "\u00a0")
    for character, entity in (("&", "amp"), ("<", "lt"), (">", "gt"), ("\u00a0", "nbsp")):
        line = line.replace(character, f"&{entity};")
    return line


def html_value(text: str) -> str:
    """Plain text as the value of an attribute in double quotes.

    >>> html_value('"><b>')
    '&quot;&gt;&lt;b&gt;'
    """
    return html_text(text).replace('"', "&quot;")


def data_json(value: Any) -> str:
    """JSON for a block of data in HTML, which nothing in it can end: `<` is written as an escape.

    >>> data_json(["</script>"])
    '["\\\\u003c/script>"]'
    """
    text = json.dumps(value, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def policy_source(text: str) -> str:
    """The hash of a script or a style, as a Content-Security-Policy names it."""
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
