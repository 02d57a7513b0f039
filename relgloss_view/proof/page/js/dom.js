// What is made of elements, and what a finger touches.

import { make } from "../../../base/js/elements.js";

/** Whether the reader's first pointer is a finger. */
export function byTouch() {
  return window.matchMedia("(pointer: coarse)").matches;
}

/** Buttons of which one is pressed; `choices` are {key: text}. Returns {element, show(key)}. */
export function segments(label, choices, chosen, choose) {
  const buttons = Object.entries(choices).map(([key, text]) => make("button", {
    type: "button", class: "segment", text, "data-key": key, "aria-pressed": key === chosen,
    on: { click: () => choose(key) },
  }));
  const element = make("div", { class: "segments", role: "group", "aria-label": label }, ...buttons);
  const show = (key) => {
    for (const button of buttons) {
      button.setAttribute("aria-pressed", String(button.dataset.key === key));
    }
  };
  show(chosen);
  return { element, show };
}
