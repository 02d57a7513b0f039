// Buttons, and what the page reads out or copies.

import { byId, make } from "../../../base/js/elements.js";
import { say } from "../../../base/js/sentences.js";

export function button(text, act, properties = {}) {
  return make("button", { type: "button", class: "button", text, on: { click: act }, ...properties });
}

/** Reads a sentence out to those who listen to the page. */
export function announce(text) {
  byId("live").textContent = text;
}

const SAID_MS = 1600, said = new WeakMap();

/** A button that says for a moment that its text is copied. */
export function copyButton(text, textToCopy, properties = {}) {
  const one = button(text, async () => {
    if (!await copy(textToCopy())) return;
    one.textContent = say("copied");
    clearTimeout(said.get(one));
    said.set(one, setTimeout(() => { one.textContent = text; }, SAID_MS));
  }, properties);
  return one;
}

/** Copies a text; where the browser refuses, selects it for the reader to copy. */
export async function copy(text) {
  try {
    await navigator.clipboard.writeText(text);
    announce(say("copied"));
    return true;
  } catch {
    const area = make("textarea", { class: "copied", "aria-label": say("copy.by-hand"), readonly: true });
    area.value = text;
    const box = make("dialog", { class: "dialog" }, make("p", { text: say("copy.by-hand") }), area);
    box.append(button(say("close"), () => box.close()));
    box.addEventListener("close", () => box.remove());
    document.body.append(box);
    box.showModal();
    area.select();
    return false;
  }
}
