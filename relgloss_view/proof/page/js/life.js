// Life size: a bank card held to the screen says how large a pixel is.

import { make } from "../../../base/js/elements.js";
import { byTouch } from "./dom.js";
import { say } from "../../../base/js/sentences.js";

const CARD_MM = [85.6, 53.98]; // ISO/IEC 7810 ID-1
const USUAL_MM = 25.4 / 96, PHONE_MM = 25.4 / 160; // of a CSS pixel, until it is measured
const CORNER_MM = 3.18; // radius
const KEPT = "relgloss-device-pixel-mm"; // which the browser's zoom does not change

/** A dialog that sets the size of a CSS pixel by a card. app: lifeSize(mm of a CSS pixel). */
export function lifeSize(app) {
  const how = make("p", {});
  const card = make("div", { class: "card", "aria-hidden": "true" });
  const size = make("input", {
    type: "range", id: "card-size", min: 150, max: 900, step: 0.5, "aria-label": say("life.slider"),
    on: { input: () => show() },
  });
  const show = () => {
    const width = Number(size.value);
    const sides = [width, width * CARD_MM[1] / CARD_MM[0]];
    // A card is wider than a phone.
    const upright = window.innerWidth < window.innerHeight;
    if (upright) sides.reverse();
    how.textContent = say(upright ? "life.how-upright" : "life.how");
    card.style.setProperty("width", `${sides[0]}px`);
    card.style.setProperty("height", `${sides[1]}px`);
    card.style.setProperty("border-radius", `${width * CORNER_MM / CARD_MM[0]}px`);
    size.style.setProperty("--at", String((width - 150) / 750));
    size.setAttribute("aria-valuetext", say("life.value", { width: Math.round(width) }));
  };
  const done = () => {
    const pixel = CARD_MM[0] / Number(size.value);
    keep(pixel);
    dialog.close();
    app.lifeSize(pixel);
  };
  const dialog = make("dialog", { id: "life", class: "dialog", "aria-label": say("life.title") },
    make("h2", { text: say("life.title") }), how, card, size,
    make("div", { class: "row" },
      make("button", {
        type: "button", class: "button first", text: say("life.done"), on: { click: done },
      }),
      make("button", {
        type: "button", class: "button", text: say("life.cancel"),
        on: { click: () => dialog.close() },
      })));
  document.body.append(dialog);
  return {
    open() {
      size.value = CARD_MM[0] / (kept() ?? (byTouch() ? PHONE_MM : USUAL_MM));
      show();
      dialog.showModal();
    },
  };
}

/** A browser that keeps nothing for files on the disk asks again. */
function keep(pixel) {
  try {
    localStorage.setItem(KEPT, String(pixel / window.devicePixelRatio));
  } catch { /* see above */ }
}

function kept() {
  try {
    const pixel = Number(localStorage.getItem(KEPT)) * window.devicePixelRatio;
    return pixel > 0.02 && pixel < 2 ? pixel : null;
  } catch {
    return null;
  }
}
