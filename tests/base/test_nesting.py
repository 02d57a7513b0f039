"""Work is counted before a text is decoded: what decoders take passes within the caps."""

import json
import tomllib

import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from relgloss_view.base.errors import InputError
from relgloss_view.base.nesting import MOST_DEPTH, MOST_PARTS, check_json, check_toml
from relgloss_view.base.toml import parse_toml

TEXTS = st.text(st.sampled_from("ab.[]{}=#,'\"\\ é\n\t"), max_size=12)
LEAVES = st.booleans() | st.integers(-9, 10**12) | st.floats(allow_nan=False) | TEXTS | st.dates()
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=4),
    max_leaves=12,
)
#: Pieces of TOML that put scanners out of step.
PIECES = st.lists(
    st.sampled_from(
        ["a", "b", '"', "'", '"""', "'''", "\\", '\\"', "#", "=", " = ", ".", ",", "[", "]", "{",
         "}", "\n", " ", "1", "1.5", "[a]\n", "x = ", "'a.b'", '"a\\"b"', "a.a.a.a.a.a.a.a.a.a",
         "[[a]]\n", '""', "\r\n", "1979-05-27"]
    ),
    max_size=25,
)  # fmt: skip


def parts_of(content: object) -> int:
    """The longest run of tables in tables that a decoded text has."""
    inner = content.values() if isinstance(content, dict) else content
    if not isinstance(content, dict | list) or not content:
        return 0
    return max(map(parts_of, inner)) + 1


@settings(max_examples=150)
@given(st.dictionaries(TEXTS, VALUES, max_size=5))
def test_whatever_is_written_passes(content):
    check_toml(tomli_w.dumps(content))
    check_json(json.dumps(content, default=str))


@settings(max_examples=400)
@given(PIECES)
def test_no_text_is_refused_that_the_decoder_takes(pieces):
    """Texts of pieces that decode pass; those with a longer key than is read never do."""
    text = "".join(pieces)
    try:
        content = tomllib.loads(text)
    except ValueError:
        return
    try:
        check_toml(text)
    except InputError as error:
        assert "a key of more than 8 parts" in str(error)
        assert parts_of(content) > MOST_PARTS
    else:
        assert parts_of(content) <= MOST_PARTS + MOST_DEPTH


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("", " = 1"), ("[look]\n", " = 1"), ("[", "]"), ("[[", "]]"), ("x = {", " = 1}"),
        ("x = [1, {y = 2, ", " = 1}]"), ("x = '\"'\n", " = 1"), ('x = """a\\""""""\n', " = 1"),
        ("x = '''\n'''''\n", " = 1"), ('# """\n', " = 1"), ("x = [\n# ]\n]\n", " = 1"),
        ('"a\\"".', " = 1"), ("x = 1 # '\n", " = 1"), ("\r\n", " = 1"), ("\t ", " = 1"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("part", ["a", "'a'", '"a"', '"\\""', "a ", " a\t", "''", "'.'", "-", "é"])
def test_a_long_key_is_found_in_any_spelling(before, after, part):
    def text(count):
        return before + ".".join([part] * count) + after

    count = MOST_PARTS - before.count('"a\\"".')
    check_toml(text(count))
    with pytest.raises(InputError, match="a key of more than 8 parts"):
        check_toml(text(count + 1))


@pytest.mark.parametrize(
    "text",
    [
        "x = " + "[" * 33, "x = " + "{a=" * 33, "".join(f"[t{k}]\n" for k in range(5001)),
        "x = [" + "1," * 100_001, "".join(f"a.b.c.d{k}=1\n" for k in range(15_001)),
        "x = " + "1" * 1001, "x = 0x" + "1" * 1001,
    ],
)  # fmt: skip
def test_what_takes_long_is_refused_undecoded(text, monkeypatch):
    monkeypatch.setattr("tomllib.loads", lambda _: pytest.fail("decoded"))
    with pytest.raises(InputError, match="line"):
        parse_toml(text)


def test_json():
    check_json('{"a": "' + "[" * 500 + '\\"' + "[" * 500 + '"}')
    check_json("[" * 32 + "]" * 32)
    for text in ("[" * 33, '{"a":' * 33, '["\\\\",' + "[" * 33):
        with pytest.raises(InputError, match="nested too deeply"):
            check_json(text)
    with pytest.raises(InputError, match="more than 10 values"):
        check_json("[" + "1," * 11 + "1]", 10)
