"""The panel "Catalogue" in a real window: search, faults, drags, keys, only what shows."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path

import driven
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
import made_catalogue

COUNT = 300
SIZE = (700, 560)
FEW, STOPS = 30, 12  #: textures that are kept; places that the panel is scrolled to


# --- scripts, run in the window's process ---------------------------------------------------------


@contextlib.contextmanager
def opened(folder, run):
    """The viewer with the one panel: others cost time."""
    from relgloss_view.viewer.shell.app import App
    from relgloss_view.viewer.state.state import State

    app = App(State.initial())
    for panel in app.layout.panels:
        panel.visible = panel.title == "Catalogue"
    yield app


def opened_of(folder, count):
    from relgloss_view.catalogue.query.search import Searcher
    from relgloss_view.viewer.state.catalogues import OpenCatalogue

    made = made_catalogue.MadeCatalogue(folder, count)
    return OpenCatalogue(str(folder), made, Searcher(made))


def show(hand, folder, count=COUNT):
    """Open a made catalogue in the panel and wait for its first result."""
    actions = hand.app.files.catalogue
    opened = opened_of(hand.folder / folder, count)
    hand.do(lambda: actions.take(opened))
    hand.until(lambda: actions.found is not None)
    hand.frames(6)
    return actions, opened


def tile(hand, k):
    """The engine's name of a tile that shows."""
    return hand.ctx.item_info(f"{tiles(hand)}/$${k}/tile").id_


def tiles(hand):
    """The engine's name of the window in the panel that holds the tiles."""
    name = hand.ctx.window_info("//Catalogue/##tiles").window.name
    return "//" + name.replace("/", "\\/")


def place(hand, k):
    box = hand.ctx.item_info(tile(hand, k)).rect_full
    return (box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2


def names(hand):
    state = hand.model.state
    return [state.side(side).sample.file or state.side(side).sample.name for side in
            ("reference", "test")]  # fmt: skip


def settled(hand, before):
    """Wait until a file that was opened is shown."""
    hand.until(lambda: names(hand) != before)
    hand.frames(2)
    return names(hand)


def searches(hand, found):
    actions, _ = show(hand, "searches")
    found["all"] = actions.found.total
    hand.type("//Catalogue/##Search", "gloss 60 between 60 and 70 and quality good")
    hand.until(lambda: not actions.searching)
    found["rows"] = sorted(hit.path for hit in actions.found.hits)
    hand.type("//Catalogue/##Search", "glos 60 between 60 and 70")
    hand.frames(4)
    fault = actions.fault
    found["fault"] = [fault.at, fault.end, str(fault)]
    found["stays"] = actions.found.total
    hand.type("//Catalogue/##Search", 'nearest to "no such sheet"')
    hand.until(lambda: actions.fault is not None)
    found["unknown"] = [actions.fault.at, actions.fault.end]
    hand.type("//Catalogue/##Search", "")
    hand.choose("//Catalogue/##Order", "gloss 60, lowest first")
    hand.until(lambda: not actions.searching)
    found["lowest"] = [hit.path for hit in actions.found.hits[:3]]


def becomes_a_sample(hand, found):
    actions, opened = show(hand, "becomes_a_sample")
    before = names(hand)
    found["file"] = str(opened.material_file(opened.catalogue.rows[0]["path"]))
    hand.double_click(tile(hand, 0))
    found["double click"] = settled(hand, before)
    hand.do(hand.model.history.undo)
    hand.frames(2)
    found["undone"] = names(hand) == before
    found["again"] = hand.do(hand.model.history.undo)

    def middle(side):
        x, y, w, h = hand.app.drawn_pane.arrangement.rects[side]
        left, top = hand.app.stage_origin
        return left + x + w / 2, top + y + h / 2

    def drag_to(k, goal):
        start = place(hand, k)
        hand.drag(start, (goal[0] - start[0], goal[1] - start[1]), steps=8)

    for side in ("reference", "test"):
        before = names(hand)
        drag_to(1, middle(side))
        found[side] = settled(hand, before)
        hand.do(hand.model.history.undo)
        hand.frames(2)
    # The control: let go over the panel itself, and over a failed item's tile.
    before = names(hand)
    start = place(hand, 1)
    drag_to(1, (start[0] + 150, start[1] + 10))
    hand.frames(20)
    found["nowhere"] = names(hand) == before
    gone = opened.catalogue.rows[5]
    hand.do(lambda: actions.set("test", next(h for h in actions.found.hits
                                             if h.path == gone["path"])))  # fmt: skip
    found["gone"] = hand.model.notes[-1].text
    failed = next(h for h in actions.found.hits if h.row["status"] == "failed")
    hand.do(lambda: actions.set("test", failed))
    found["failed"] = [hand.model.notes[-1].text, names(hand) == before]


def moves_by_keys(hand, found):
    from imgui_bundle import imgui

    actions, opened = show(hand, "moves_by_keys")
    key = imgui.Key
    hand.click(tile(hand, 0))
    hand.key(key.right_arrow)
    hand.key(key.right_arrow)
    found["right"] = [hit.path for hit in actions.found.hits].index(actions.selected)
    before = names(hand)
    hand.key(key.left_arrow)
    hand.key(key.enter)
    found["enter"] = settled(hand, before)
    before = names(hand)
    hand.key(int(key.mod_shift) | int(key.enter))
    found["shift"] = settled(hand, before)
    for _ in range(12):
        hand.key(key.down_arrow)
    found["down"] = [hit.path for hit in actions.found.hits].index(actions.selected)
    hand.ctx.mouse_move(hand.ctx.item_info("//Catalogue/##Search").id_)
    found["file"] = [str(opened.material_file(opened.catalogue.rows[1]["path"]))]


def has_a_menu(hand, found):
    actions, opened = show(hand, "has_a_menu")
    hand.ctx.item_click(tile(hand, 1), 1)
    hand.frames(2)
    hand.ctx.item_click("//$FOCUSED/Nearest to this")
    hand.until(lambda: not actions.searching)
    found["text"] = actions.asked.text
    found["first"] = actions.found.hits[0].path
    found["path"] = opened.catalogue.rows[1]["path"]


def draws_what_shows(hand, found):
    actions, opened = show(hand, "many", 10_000)
    thumbnails = actions.thumbnails
    thumbnails.most = FEW
    hand.until(lambda: not thumbnails.waiting and not actions._decode.busy)
    found["at first"] = thumbnails.count
    asked = sum(len(one) for one in opened.catalogue.asked)
    found["asked"] = asked
    window = hand.ctx.window_info("//Catalogue/##tiles").window
    found["most"] = 0
    for k in range(STOPS):
        hand.ctx.scroll_to_y(tiles(hand), window.scroll_max.y * k / (STOPS - 1))
        hand.frames(3)
        found["most"] = max(found["most"], thumbnails.count)
    found["sum"] = sum(len(one) for one in opened.catalogue.asked)
    hand.until(lambda: not thumbnails.waiting and not actions._decode.busy)
    found["last"] = bool(thumbnails.texture(actions.found.hits[-1].path))


def is_built_again(hand, found):
    from relgloss_view.catalogue.columns import TABLE_FILE

    actions, opened = show(hand, "again", 20)
    folder = Path(opened.folder)
    hand.frames(2)
    table = folder / TABLE_FILE
    table.write_bytes(b"another")
    found["noticed"] = hand.until(lambda: actions.changed, 4000)
    hand.frames(2)
    asked = []
    actions._open_path = asked.append
    hand.click("//Catalogue/Reload")
    actions._open_path = hand.app.files.open_path
    found["asked"] = asked == [str(folder)]


def opens_files(hand, found):
    import shutil

    actions, files = hand.app.files.catalogue, hand.app.files
    stock = hand.folder / "stock"
    made_catalogue.write(stock, 30)
    before = names(hand)
    for path in (stock, stock / "catalogue.parquet"):
        actions.opened = None
        hand.do(lambda path=path: hand.app.dropped([str(path)]))
        hand.until(lambda: actions.found is not None and actions.opened is not None)
        found[f"dropped {path.name}"] = [actions.found.total, names(hand) == before]
    hand.frames(10)
    found["drawn"] = hand.until(lambda: actions.thumbnails.count > 3)
    hand.type("//Catalogue/##Search", "not failed")
    hand.until(lambda: not actions.searching)
    made_catalogue.write(stock, 35)
    hand.until(lambda: actions.changed, 4000)
    hand.frames(2)
    hand.click("//Catalogue/Reload")
    hand.until(lambda: actions.found is not None and actions.found.searched == 35)
    found["reloaded"] = [actions.asked.text, actions.found.searched, actions.changed]
    # The last session's: opened when the panel shows, and one line where it is gone.
    actions.opened = actions.found = None
    hand.do(lambda: hand.app.layout.focus("Look"))
    panel = next(p for p in hand.app.layout.panels if p.title == "Catalogue")
    panel.visible = False
    hand.do(lambda: actions.remember(str(stock)))
    hand.frames(10)
    found["waits"] = actions.opened is None and actions.folder == str(stock)
    hand.do(lambda: hand.app.layout.focus("Catalogue"))
    found["remembered"] = hand.until(lambda: actions.opened is not None)
    shutil.move(stock, hand.folder / "elsewhere")
    actions.opened = actions.found = None
    count = len(hand.model.notes)
    hand.do(lambda: actions.remember(str(stock)))
    hand.until(lambda: len(hand.model.notes) > count)
    hand.frames(20)
    found["gone"] = [[note.text, note.fault] for note in hand.model.notes[count:]]
    found["empty"] = hand.there("//Catalogue/Open catalogue...")
    hand.click("//Catalogue/Open catalogue...")
    found["asks"] = files.dialogs.open
    hand.do(files.dialogs.close)


SCRIPTS = [
    searches,
    becomes_a_sample,
    moves_by_keys,
    has_a_menu,
    draws_what_shows,
    is_built_again,
    opens_files,
]


# --- tests ----------------------------------------------------------------------------------------


def driven_by(tmp_path_factory, *scripts):
    folder = tmp_path_factory.mktemp("catalogue")
    names = [script.__name__ for script in scripts]
    return driven.drive("test_catalogue_panel", folder, size=SIZE, scripts=names)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return driven_by(tmp_path_factory, *SCRIPTS[:2])


@pytest.fixture(scope="module")
def more_found(tmp_path_factory):
    return driven_by(tmp_path_factory, *SCRIPTS[2:])


def test_a_query_shows_what_meets_it(found):
    got = found["searches"]
    rows = [made_catalogue.row_of(k) for k in range(COUNT)]
    wanted = sorted(
        row["path"] for row in rows
        if row["quality"] == "good" and row["gloss_60"] and 60 <= row["gloss_60"] <= 70
    )  # fmt: skip
    assert 0 < len(wanted) < COUNT
    assert got["all"] == COUNT
    assert got["rows"] == wanted


def test_a_fault_names_its_place_and_the_last_result_stays(found):
    got = found["searches"]
    assert got["fault"][:2] == [0, 4]
    assert "gloss" in got["fault"][2]
    assert got["stays"] == len(got["rows"])
    assert got["unknown"] == [11, 26]


def test_the_order_is_that_of_the_list(found):
    rows = (made_catalogue.row_of(k) for k in range(COUNT))
    by_gloss = sorted((row for row in rows if row["gloss_60"]), key=lambda row: row["gloss_60"])
    assert found["searches"]["lowest"] == [row["path"] for row in by_gloss[:3]]


def test_a_double_click_makes_the_test_sample_and_undo_takes_it_back(found):
    got = found["becomes_a_sample"]
    assert got["double click"] == ["cast-coated", got["file"]]
    assert got["undone"]
    assert not got["again"]  # one step


def test_a_drag_gives_a_sample_to_the_picture_under_it(found):
    got = found["becomes_a_sample"]
    assert got["reference"][0].endswith(".json")
    assert got["reference"][1] == "matte-coated"
    assert got["test"][0] == "cast-coated"
    assert got["test"][1].endswith(".json")
    assert got["nowhere"]


def test_what_has_no_material_is_reported_in_one_line(found):
    got = found["becomes_a_sample"]
    assert "the material file is gone; build the catalogue again" in got["gone"]
    assert got["failed"][0].endswith("line 3: not a number")
    assert got["failed"][1]


@pytest.mark.slow
def test_keys_choose_and_set(more_found):
    got = more_found["moves_by_keys"]
    assert got["right"] == 2
    assert got["enter"][1] == got["file"][0]
    assert got["shift"] == [got["file"][0]] * 2
    assert got["down"] > 20


@pytest.mark.slow
def test_the_menu_searches_for_what_looks_like_an_item(more_found):
    got = more_found["has_a_menu"]
    assert got["path"] in got["text"]
    assert got["first"] == got["path"]


@pytest.mark.slow
def test_only_what_shows_is_decoded_and_little_is_kept(more_found):
    got = more_found["draws_what_shows"]
    assert 5 <= got["at first"] <= 60
    assert got["asked"] <= 60
    assert got["sum"] > 3 * FEW  # more were seen than are kept
    # Twice what a frame asks for: at first without the row above, and three rows and more show.
    assert got["most"] <= max(FEW, 2 * 4 / 3 * got["asked"])
    assert got["last"]


@pytest.mark.slow
def test_a_catalogue_that_is_built_again_offers_to_be_read(more_found):
    assert more_found["is_built_again"] == {"noticed": True, "asked": True}


@pytest.mark.slow
def test_a_catalogue_opens_by_a_drop_and_again_in_the_next_session(more_found):
    got = more_found["opens_files"]
    assert got["dropped stock"] == [30, True]
    assert got["dropped catalogue.parquet"] == [30, True]
    assert got["drawn"]
    assert got["reloaded"] == ["not failed", 35, False]
    assert got["waits"]
    assert got["remembered"]


@pytest.mark.slow
def test_one_line_says_that_the_last_one_is_gone(more_found):
    got = more_found["opens_files"]
    ((text, fault),) = got["gone"]
    assert fault
    assert "stock" in text
    assert got["empty"]
    assert got["asks"]
