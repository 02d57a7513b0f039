// The colour of the pixel under the pointer or the keys.

import { byId, make } from "../../../base/js/elements.js";
import { byTouch } from "./dom.js";
import { say } from "../../../base/js/sentences.js";
import { figure } from "./words.js";

const KEY_STEP = 1, KEY_LEAP = 16; // CSS pixels of an arrow, and with Shift

/** The readout below the canvas. app: pictureAt(x, y), colour(side, x, y). Returns its functions. */
export function readout(app) {
  const how = say(byTouch() ? "read.how-touch" : "read.how");
  const text = make("output", { id: "readout", class: "readout", text: how });
  const mark = make("span", { id: "mark", class: "mark", hidden: true, "aria-hidden": "true" });
  byId("stage").append(mark);
  byId("view").after(text);
  let at = null;
  function show() {
    const pixel = at === null ? null : app.pictureAt(...at);
    mark.hidden = at === null || app.mode() !== "read"; // elsewhere a pointer's own sign is enough
    if (at === null) {
      text.textContent = how;
      return;
    }
    mark.style.setProperty("left", `${at[0]}px`);
    mark.style.setProperty("top", `${at[1]}px`);
    const colour = pixel === null ? null : app.colour(pixel.side, pixel.x, pixel.y);
    text.textContent = colour === null ? say("read.nothing") : say("read.colour", {
      side: say(`side.${pixel.side}`), l: figure(colour.lab[0], 1), a: figure(colour.lab[1], 1),
      b: figure(colour.lab[2], 1), d: figure(colour.l_d, 1), s: figure(colour.l_s, 1),
    });
  }
  return {
    show,
    point(x, y) {
      at = x === null ? null : [x, y];
      show();
    },
    movePoint([right, down], far) {
      const stage = byId("canvas"), step = far ? KEY_LEAP : KEY_STEP;
      const size = [stage.clientWidth, stage.clientHeight];
      at = at === null ? [0.25 * size[0], 0.5 * size[1]]
        : [right, down].map((way, k) => Math.min(Math.max(at[k] + way * step, 0), size[k] - 1));
      show();
    },
  };
}
