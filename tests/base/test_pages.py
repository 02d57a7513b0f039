"""A page is whole HTML, and no text of a table can become markup."""

from __future__ import annotations

from html.parser import HTMLParser

from relgloss_view.base import pages

VOID = {"meta", "img"}


class Reader(HTMLParser):
    """Collects texts by element and checks that every element is closed in order."""

    def __init__(self):
        super().__init__()
        self.open, self.texts = [], []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        if self.open and data.strip():
            self.texts.append((*self.open[-1], data))


def read(html):
    reader = Reader()
    reader.feed(html)
    reader.close()
    assert not reader.open
    return reader.texts


def test_texts_of_a_page_are_never_markup():
    hostile = '<script>alert("1")</script> & "co"'
    html = pages.page(hostile, [pages.table(["sample", hostile], [[hostile, "1"]])], "p {}\n")
    texts = read(html)
    assert not [tag for tag, _, _ in texts if tag == "script"]
    assert [data for tag, _, data in texts if tag == "title"] == [hostile]
    assert [data for tag, _, data in texts if tag == "td"] == [hostile, "1"]
    assert [data for tag, _, data in texts if tag == "th"] == ["sample", hostile]
    assert [data for tag, _, data in texts if tag == "style"] == [pages.STYLE + "p {}\n"]


def test_columns_of_words_are_marked():
    texts = read(pages.table(["sample", "gloss", "source"], [["a", "1", "me"]], texts=(2,)))
    assert [(data, "class" in attributes) for _, attributes, data in texts] == [
        ("sample", False),
        ("gloss", False),
        ("source", True),
        ("a", False),
        ("1", False),
        ("me", True),
    ]
