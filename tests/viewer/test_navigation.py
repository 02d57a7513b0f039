"""The whole window by keyboard: each control is reached, is seen to have the focus, and moves."""

from __future__ import annotations

import driven
import numpy as np
import pytest

from relgloss_view.viewer.state.matching import with_share

SIZE = (1280, 1400)  # high enough for each panel without scrolling: what is clipped shows no focus
#: The panels, and how many of their items are no controls: plots, headings, frames of parts.
PANELS = {
    "Look": 0,
    "Scene": 0,
    "Sample": 0,
    "Lightness": 2,
    "Reflection": 2,
    "Fit": 2,
    "Gloss": 3,
    "Pixel": 3,
}
MOVED = ("Look", "Scene")
QUICK = ("Look", "Pixel")  #: the panels of `make test`; each of the others takes seconds
FOLD = "In numbers (c, c_max)"
MOST = 60
WHITE = 250  #: the ring around the focus; nothing else of the interface is as bright over a length


def focus():
    """The id of the item that has the keyboard, its window's name and whether that shows."""
    from imgui_bundle import imgui

    context = imgui.get_current_context()
    window = context.nav_window
    name = "" if window is None else window.root_window.name
    return int(context.nav_id), name, bool(context.nav_cursor_visible)


def ring(hand, item):
    """Share of an item's height over which its left and right edge are white on the screen."""
    info = hand.ctx.item_info(item)
    low, high = info.rect_full.min, info.rect_full.max
    screen = hand.app._window.size_now()

    def read():
        left, top = max(int(low.x) - 5, 0), max(int(low.y) - 5, 0)
        right, bottom = min(int(high.x) + 5, screen[0]), min(int(high.y) + 5, screen[1])
        return hand.app._window.pixels(left, top, right - left, bottom - top)

    pixels = hand.do(read).min(axis=-1)
    columns = np.sum(pixels >= WHITE, axis=0) / pixels.shape[0]
    half = columns.size // 2
    return min(float(columns[:half].max()), float(columns[half:].max()))


def shown_alone(hand, title):
    for panel in hand.app.layout.panels:
        panel.visible = panel.title == title
    hand.app.layout.hidden = False
    hand.frames(4)
    hand.app.layout.enter(title)
    hand.frames(4)


def items(hand, title):
    """The ids of a panel's items, those that the keyboard can have and others."""
    from imgui_bundle import imgui

    listed = imgui.test_engine.TestItemList()
    hand.ctx.gather_items(listed, f"//{title}", -1)
    infos = [listed.get_by_index(k) for k in range(listed.get_size())]
    infos = [info for info in infos if int(info.item_flags) != 0]  # parts of others, as axes are
    others = {int(i.id_) for i in infos if int(i.item_flags) & int(imgui.ItemFlags_.no_nav)}
    return {int(info.id_) for info in infos} - others, others


def tabs_through(title):
    def script(hand, found):
        from imgui_bundle import imgui
        from test_gloss_panel import worked_out

        shown_alone(hand, title)
        hand.ctx.mouse_teleport_to_pos((5.0, 700.0))
        if title == "Pixel":
            hand.model.pinned = None
        if title == "Gloss":
            worked_out(hand)  # before that there is no slider
        wanted, others = items(hand, title)
        first = focus()[0]
        seen = {}
        for _ in range(MOST):
            item, window, visible = focus()
            if item in seen:
                break
            seen[item] = [visible and window == title, ring(hand, item)]
            hand.key(imgui.Key.tab)
        unseen = ring(hand, next((i for i in wanted if i != focus()[0]), first))
        hand.ctx.key_press(int(imgui.Key.mod_shift) | int(imgui.Key.tab))
        hand.frames(2)
        found.update(
            missing=sorted(wanted - seen.keys()),
            strange=sorted(seen.keys() - wanted),
            count=len(seen),
            others=len(others),
            seen=list(seen.values()),
            control=unseen if len(wanted) > 1 else 0.0,
            around=focus()[0] == list(seen)[-1],
        )

    script.__name__ = f"tabs_through_{title}"
    return script


def moves_all(title):
    """Each control of a panel in turn: an arrow, or Enter and a choice, changes something.

    Of two buttons of which one is on, that one changes nothing: so the round is made twice, from
    two states.
    """

    def script(hand, found):
        from imgui_bundle import imgui

        model, key = hand.model, imgui.Key
        start = model.state.with_part("eye", azimuth_deg=5.0).with_look("test", seed=5)
        start = with_share(start, "test", 0.5)  # so that "Match again" has something to do
        exact = start.with_look("reference", quality="exact")
        seen, moved = {}, set()

        def now():
            return model.state, model.active_side

        def focus_on(item):
            for _ in range(MOST):
                if focus()[0] == item:
                    return
                hand.key(key.tab)

        for before, side in ((start, "test"), (exact, "reference")):

            def begin(before=before, side=side):
                model.change(before)
                model.active_side = side
                hand.frames(2)

            begin()
            shown_alone(hand, title)
            round_, ways = [], ((key.right_arrow,), (key.left_arrow,), (key.enter,))
            ways += ((key.enter, key.down_arrow, key.enter), (key.enter, key.up_arrow, key.enter))
            while focus()[0] not in round_ and len(round_) < MOST:
                item = focus()[0]
                round_.append(item)
                seen[item] = str(hand.ctx.item_info(item).rect_full.min)
                for way in ways:
                    for press in way:
                        hand.key(press)
                    dialogs = hand.app.files.dialogs
                    if dialogs.open:  # a button that asks for a file has asked
                        dialogs.close()
                        hand.frames(2)
                        moved.add(item)
                        break
                    if now() != (before, side):
                        moved.add(item)
                        break
                    if imgui.get_current_context().open_popup_stack.size():
                        hand.key(key.escape)
                    focus_on(item)
                begin()
                focus_on(item)
                hand.key(key.tab)
        unmoved = [place for item, place in seen.items() if item not in moved]
        found.update(unmoved=unmoved, count=len(seen))

    script.__name__ = f"moves_all_{title}"
    return script


def has_labels(hand, found):
    """The controls that the fields declare, by their labels, are among those that Tab reaches."""
    from test_labels import SCENE, label_of

    from relgloss_view.picture.scene.look import Look

    looks = ("sigma_n_deg", "c_fraction", "c", "grain", "grain_arcmin", "noise_law",
             "noisy_lobes", "seed", "diffuse_model", "samples")  # fmt: skip
    for title, owners in (("Look", {Look: looks}), ("Scene", SCENE)):
        shown_alone(hand, title)
        wanted, _ = items(hand, title)
        labels = [label_of(owner, name) for owner, names in owners.items() for name in names]
        fold = f"//{title}/{FOLD}"
        if hand.there(fold) and not hand.there(f"{fold}/##{label_of(Look, 'c')}"):
            hand.click(fold)
            wanted, _ = items(hand, title)
        paths = {label: f"//{title}/##{label}".replace(" / ", " \\/ ") for label in labels}
        for label in (label_of(Look, "c"), label_of(Look, "c_fraction")):
            if label in paths:
                paths[label] = paths[label].replace(f"//{title}/", f"{fold}/")
        there = {label: path for label, path in paths.items() if hand.there(path)}
        found[title] = [
            [
                label
                for label, path in there.items()
                if int(hand.ctx.item_info(path).id_) not in wanted
            ],
            len(there),
        ]


def edits_a_slider(hand, found):
    from imgui_bundle import imgui

    model, key = hand.model, imgui.Key
    shown_alone(hand, "Look")
    model.active_side = "test"
    model.set_look("test", sigma_n_deg=1.0)
    hand.key(key.tab)
    hand.key(key.tab)  # past the two sides
    value = lambda: model.state.test.look.sigma_n_deg  # noqa: E731
    steps = len(model.history._past)
    hand.key(key.right_arrow)
    found["a step"] = value()
    hand.ctx.key_press(int(key.mod_shift) | int(key.right_arrow))
    hand.frames(2)
    found["fast"] = value()
    hand.ctx.key_press(int(key.mod_ctrl) | int(key.left_arrow))
    hand.frames(2)
    found["fine"] = value()
    found["one gesture"] = len(model.history._past) - steps
    here = focus()[0]
    hand.key(key.delete)
    found["reset"] = value()
    hand.key(key.enter)
    hand.ctx.key_chars("1.25")
    hand.frames(2)
    before = model.state.presentation, model.active_side
    hand.ctx.key_chars("sob")  # letters of actions
    hand.key(key.s)
    hand.key(key.o)
    found["no action while typing"] = (model.state.presentation, model.active_side) == before
    hand.key(key.escape)
    hand.key(key.enter)
    hand.ctx.key_chars_replace("2.25")
    hand.key(key.tab)
    found["typed"] = value()
    found["went on"] = focus()[0] != here
    # A slider that is moved by ImGui's own way: Space, arrows, Space.
    hand.ctx.key_press(int(key.mod_shift) | int(key.tab))
    hand.frames(2)
    found["came back"] = focus()[0] == here
    hand.key(key.space)
    found["tweaked"] = bool(imgui.is_any_item_active())
    side = model.active_side
    hand.key(key.s)
    found["no action while edited"] = model.active_side == side
    hand.key(key.space)
    hand.key(key.s)
    found["action with the focus alone"] = model.active_side != side
    model.active_side = "test"


def goes_from_panel_to_panel(hand, found):
    from imgui_bundle import imgui

    for panel in hand.app.layout.panels:
        panel.visible = True
    hand.app.layout.hidden = False
    hand.frames(4)
    hand.app.layout.enter("Pictures")
    hand.frames(4)
    found["windows"] = []
    for _ in range(len(hand.app.layout.panels) + 1):
        found["windows"].append(focus()[1:])
        hand.key(imgui.Key.f6)
        hand.frames(4)
    found["around"] = focus()[1]
    hand.ctx.key_press(int(imgui.Key.mod_shift) | int(imgui.Key.f6))
    hand.frames(4)
    found["back"] = focus()[1]
    found["titles"] = [panel.title for panel in hand.app.layout.panels]
    hand.key(imgui.Key.f9)
    hand.frames(3)
    found["hidden"] = hand.app.layout.hidden
    hand.key(imgui.Key.f6)
    hand.frames(4)
    found["only the stage"] = focus()[1]
    hand.key(imgui.Key.f9)
    hand.frames(3)
    found["shown"] = not hand.app.layout.hidden


def opens_the_menu(hand, found):
    from imgui_bundle import imgui

    key = imgui.Key
    presentation = lambda: hand.model.state.presentation  # noqa: E731
    hand.model.set_part("presentation", compare="side by side")
    shown_alone(hand, "Look")
    for name, opening in (("alt", key.left_alt), ("f10", key.f10)):
        hand.model.set_part("presentation", compare="side by side")
        hand.key(opening)
        hand.frames(3)
        found[f"{name} reached"] = focus()[1:]
        hand.key(key.right_arrow)
        hand.key(key.right_arrow)  # View
        hand.key(key.down_arrow)  # opens it
        hand.key(key.down_arrow)
        hand.key(key.enter)
        hand.frames(3)
        found[f"{name} chose"] = presentation().compare
    hand.model.set_part("presentation", compare="side by side")
    # With another key Alt is a modifier.
    hand.ctx.key_press(int(key.mod_alt) | int(key.x))
    hand.frames(3)
    found["alone"] = not imgui.get_current_context().open_popup_stack.size()


def moves_the_pictures(hand, found):
    from imgui_bundle import imgui

    model, key = hand.model, imgui.Key
    hand.app.layout.hidden = True
    hand.frames(3)
    hand.app.layout.enter("Pictures")
    hand.frames(4)
    began = model.state.setup
    found["stage"] = focus()[1:]
    found["ring"] = ring(hand, focus()[0])
    for name, press in (
        ("turned", key.right_arrow),
        ("tilted", key.up_arrow),
        ("lamp", int(key.mod_ctrl) | int(key.right_arrow)),
        ("moved", int(key.mod_shift) | int(key.up_arrow)),
        ("nearer", key.equal),
    ):
        hand.ctx.key_press(press)
        hand.frames(2)
        eye, lamp = model.state.setup.eye, model.state.setup.lamp
        found[name] = [
            eye.azimuth_deg - began.eye.azimuth_deg,
            eye.elevation_deg - began.eye.elevation_deg,
            lamp.azimuth_deg - began.lamp.azimuth_deg,
            eye.shift_up,
            eye.field_of_view_deg,
        ]
    model.change(model.state.placed(eye=began.eye, lamp=began.lamp))
    model.set_part("presentation", compare="wipe", wipe=0.5)
    hand.frames(2)
    hand.key(key.tab)
    hand.key(key.right_arrow)
    hand.key(key.right_arrow)
    found["wipe"] = model.state.presentation.wipe
    model.set_part("presentation", compare="side by side", haploscopic=True)
    hand.frames(4)
    found["nothing over the pictures"] = focus()[2]
    model.set_part("presentation", haploscopic=False)
    hand.frames(2)


TABS = {title: tabs_through(title) for title in PANELS}
MOVES = {title: moves_all(title) for title in MOVED}
OTHERS = (has_labels, edits_a_slider, goes_from_panel_to_panel, opens_the_menu, moves_the_pictures)
SCRIPTS = (*TABS.values(), *MOVES.values(), *OTHERS)


def run(folder, scripts):
    names = [script.__name__ for script in scripts]
    return driven.drive("test_navigation", folder, size=SIZE, panels=True, scripts=names)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    quick = [TABS[title] for title in QUICK]
    return run(tmp_path_factory.mktemp("navigation"), [*quick, *OTHERS])


@pytest.fixture(scope="module")
def found_in_the_rest(tmp_path_factory):
    rest = [*(TABS[title] for title in PANELS if title not in QUICK), *MOVES.values()]
    return run(tmp_path_factory.mktemp("further-panels"), rest)


@pytest.mark.parametrize("title", QUICK)
def test_tab_reaches_each_control_and_the_focus_is_seen(found, title):
    check_tabs(found, title)


@pytest.mark.slow
@pytest.mark.parametrize("title", [title for title in PANELS if title not in QUICK])
def test_tab_reaches_each_control_of_the_other_panels(found_in_the_rest, title):
    check_tabs(found_in_the_rest, title)


def check_tabs(found, title):
    got = found[f"tabs_through_{title}"]
    assert got["missing"] == got["strange"] == []
    assert got["others"] == PANELS[title]
    assert got["count"] >= (1 if title == "Pixel" else 3)
    assert all(here for here, _ in got["seen"])
    assert min(white for _, white in got["seen"]) > 0.5
    assert got["control"] < 0.5  # an item without the focus has no ring
    assert got["around"]


@pytest.mark.slow
@pytest.mark.parametrize("title", MOVED)
def test_each_control_is_moved(found_in_the_rest, title):
    got = found_in_the_rest[f"moves_all_{title}"]
    assert got["unmoved"] == []
    assert got["count"] > 14


def test_declared_controls_are_among_them(found):
    for missing, count in found["has_labels"].values():
        assert missing == []
        assert count > 9


def test_a_slider_by_arrows_and_by_typing(found):
    got = found["edits_a_slider"]
    assert got["a step"] == pytest.approx(1.02)
    assert got["fast"] == pytest.approx(1.22)
    assert got["fine"] == pytest.approx(1.218)
    assert got["one gesture"] == 1
    assert got["reset"] == 0.0
    assert got["typed"] == pytest.approx(2.25)
    assert got["went on"]
    assert got["came back"]


def test_letters_belong_to_what_is_edited(found):
    got = found["edits_a_slider"]
    assert got["no action while typing"]
    assert got["tweaked"]
    assert got["no action while edited"]
    assert got["action with the focus alone"]  # the control: it works at all


def test_panels_one_after_the_other(found):
    got = found["goes_from_panel_to_panel"]
    assert got["windows"] == [[title, True] for title in ("Pictures", *got["titles"])]
    assert got["around"] == "Pictures"
    assert got["back"] == got["titles"][-1]
    assert got["hidden"]
    assert got["only the stage"] == "Pictures"
    assert got["shown"]


@pytest.mark.parametrize("name", ["alt", "f10"])
def test_the_menu(found, name):
    got = found["opens_the_menu"]
    assert got[f"{name} reached"] == ["##MainMenuBar", True]
    assert got[f"{name} chose"] == "wipe"
    assert got["alone"]


def test_pictures_are_turned_moved_and_zoomed(found):
    got = found["moves_the_pictures"]
    assert got["stage"] == ["Pictures", True]
    assert got["ring"] > 0.5
    assert got["turned"][0] == pytest.approx(-2.0)
    assert got["tilted"][1] == pytest.approx(-2.0)
    assert got["lamp"][2] == pytest.approx(2.0)
    assert got["lamp"][:2] == got["tilted"][:2]
    assert got["moved"][3] != 0.0
    assert got["moved"][4] is None
    assert got["nearer"][4] is not None
    assert got["wipe"] == pytest.approx(0.52)
    assert not got["nothing over the pictures"]
