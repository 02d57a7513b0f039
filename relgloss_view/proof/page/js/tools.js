// The tools below the pictures, the handle of the wipe and the button that flips.

import { byId, make } from "../../../base/js/elements.js";
import { segments } from "./dom.js";
import { SIDES } from "./pair.js";
import { say } from "../../../base/js/sentences.js";

const KEY_SHARE = 0.02; // of an arrow on the wipe's handle

/** Tools of an app; openLife() opens the life-size dialog. Returns show(), which follows the app. */
export function tools(app, openLife) {
  const modes = segments(say("tools.compare"), {
    both: say("tools.both"), wipe: say("tools.wipe"), flip: say("tools.flip"),
  }, "both", (mode) => app.show({ mode }));
  const hands = segments(say("tools.hand"), {
    turn: say("tools.turn"), lamp: say("tools.lamp"), read: say("tools.read"),
  }, "turn", (hand) => app.show({ hand }));
  const button = (id, text, click) => make("button", {
    type: "button", id, class: "button", text, on: { click },
  });
  byId("look").append(make("div", { id: "tools", class: "tools" }, modes.element, hands.element,
    make("div", { class: "row" }, button("frame", say("tools.frame"), () => app.frameAgain()),
      button("life-size", say("tools.life"), openLife))));
  const handle = wipeHandle(app), flip = button("flip", say("tools.flip"), () => app.flip());
  const names = SIDES.map((side) => make("span", { class: "name", "data-side": side }));
  byId("stage").append(...names, handle, flip);
  return () => {
    const { mode, hand, share } = app.shown, stage = byId("stage");
    modes.show(mode);
    hands.show(hand);
    stage.dataset.mode = mode;
    stage.dataset.hand = hand;
    handle.hidden = mode !== "wipe";
    flip.hidden = mode !== "flip";
    const [first] = app.boxes ? [app.paneAt()] : [null];
    if (first === null) return;
    handle.style.setProperty("left", `${first.box[0] + share * first.box[2]}px`);
    handle.setAttribute("aria-valuenow", String(Math.round(100 * share)));
    handle.setAttribute("aria-valuetext", say("tools.share", { share: Math.round(100 * share) }));
    for (const name of names) {
      const shownHere = app.panes.find((pane) => pane.side === name.dataset.side);
      name.hidden = shownHere === undefined;
      name.textContent = say(`side.${name.dataset.side}`);
      if (name.hidden) continue;
      const [x, y, width] = shownHere.box, far = mode === "wipe" && name.dataset.side === "test";
      name.style.setProperty("left", far ? "auto" : `${x}px`);
      name.style.setProperty("right", far ? `${stage.clientWidth - x - width}px` : "auto");
      name.style.setProperty("top", `${y}px`);
    }
  };
}

function wipeHandle(app) {
  const move = (share) => app.show({ share: Math.min(Math.max(share, 0), 1) });
  let held = false;
  return make("div", {
    id: "wipe", class: "wipe", role: "slider", tabindex: 0, "aria-label": say("tools.handle"),
    "aria-valuemin": 0, "aria-valuemax": 100,
    on: {
      keydown: (event) => {
        const way = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
        const end = { Home: 0, End: 1 }[event.key];
        if (way === undefined && end === undefined) return;
        event.preventDefault();
        move(end ?? app.shown.share + way * KEY_SHARE * (event.shiftKey ? 5 : 1));
      },
      pointerdown: (event) => {
        held = true;
        event.currentTarget.setPointerCapture(event.pointerId);
      },
      pointermove: (event) => {
        if (!held) return;
        const left = byId("canvas").getBoundingClientRect().left, [x, , width] = app.paneAt().box;
        move((event.clientX - left - x) / width);
      },
      lostpointercapture: () => { held = false; },
    },
  });
}
