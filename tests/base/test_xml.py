"""XML from outside: what is read, and that hostile texts end in one line."""

from pathlib import Path

import pytest

from relgloss_view.base import xml
from relgloss_view.base.errors import InputError
from relgloss_view.base.xml import line_of, read_xml

MOST = 8_000_000


def read(path: Path, data: bytes | str, most_bytes: int = MOST):
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return read_xml(path, "a CxF file", most_bytes=most_bytes)


def test_local_names_lines_and_text(tmp_path):
    text = (
        '<?xml version="1.0"?>\n<!-- a = b -->\n'
        '<cc:CxF xmlns:cc="http://x" xmlns="http://y">\n<cc:Name xsi:type="t">A &amp; B</cc:Name>'
        "\n\n<V><![CDATA[1 < 2]]></V></cc:CxF>"
    )
    root = read(tmp_path / "a.xml", text)
    assert (root.tag, root.attrib) == ("CxF", {})
    assert [(e.tag, e.text, line_of(e)) for e in root] == [("Name", "A & B", 4), ("V", "1 < 2", 6)]
    assert root[0].attrib == {"type": "t"}


@pytest.mark.parametrize(
    ("declared", "codec"),
    [
        ("UTF-8", "utf-8"), ("UTF-8", "utf-8-sig"), ("UTF-16", "utf-16"), ("UTF-16", "utf-16-le"),
        ("ISO-8859-1", "latin-1"), ("windows-1252", "cp1252"), ("Shift_JIS", "shift_jis"),
        ("UTF-16", "utf-8"), ("UTF-8", "cp1252"),
    ],
)  # fmt: skip
def test_encodings(tmp_path, declared, codec):
    name = "光沢" if codec == "shift_jis" else "Weiß"
    text = f'<?xml version="1.0" encoding="{declared}"?><a><b>{name}</b></a>'
    assert read(tmp_path / "a.xml", text.encode(codec))[0].text == name


BOMB = '<!DOCTYPE a [<!ENTITY b "x"><!ENTITY c "&b;&b;&b;&b;">]><a>&c;</a>'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<a>\n<b>\n</a>", r"line 3: not well-formed XML \(mismatched tag\)"),
        ("", r"line 1: not well-formed XML \(no element found\)"),
        (BOMB, "line 1: the document type 'a' is not read"),
        ('\n<!DOCTYPE a SYSTEM "file:///etc/passwd">\n<a/>', "line 2: the document type 'a'"),
        ("<a>&b;</a>", "undefined entity"),
        ("<a>\n" * 100_000, "line 65: elements are nested more than 64 deep"),
        ("<a>" + "<b/>" * (xml.MOST_MARKUP + 1), "more than 600000 tags"),
        ("<a " + "".join(f"x{k}='' " for k in range(300_001)), "more than 300000 attributes"),
        ('<?xml version="1.0" encoding="punycode"?><a/>', "unknown encoding 'punycode'"),
        ('<?xml version="1.0" encoding="iso-8859-12"?><a/>', "unknown encoding"),
        (b'<?xml version="1.0" encoding="ascii"?>\n<a>\xff</a>', "line 2: not ascii text"),
        ("<a>\n<!--" + "x" * (MOST - 9), "line 2: a tag or comment of more than 1048576 bytes"),
        ("<a>" + " " * MOST + "</a>", "larger than 8000000 bytes"),
    ],
    ids=range(13),
)
def test_hostile_and_damaged(tmp_path, text, message):
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path / "a.xml", text)
    assert "\n" not in str(caught.value)
