// The thread of messages: whose settings one looks at is always said, and each is a click away.

import { byId, make } from "../../../base/js/elements.js";
import { putInPanel } from "./static.js";
import { say } from "../../../base/js/sentences.js";
import { moment } from "./words.js";

/** Times of the static page in the reader's own zone. */
export function localTimes() {
  for (const time of document.querySelectorAll("time")) {
    time.textContent = moment(time.getAttribute("datetime"));
  }
}

/** The author of a message, or what stands in the place of a name. */
export function authorOf(message) {
  return message.author || say("message.nobody");
}

/** What is known of each signature, in its message of the thread. */
export function signatures(checked) {
  for (const line of document.querySelectorAll("#thread .signed")) line.remove();
  const items = document.querySelectorAll("#thread .message");
  for (const { message, fingerprint, state } of checked) {
    items[message]?.append(make("p", { class: "quiet signed", text: say(`signed.${state}`, { key: fingerprint }) }));
  }
  if (checked.length === 0) return;
  // Beside a signed message, one of somebody else's would look signed.
  const signed = new Set(checked.map(({ message }) => message));
  items.forEach((item, k) => {
    if (!signed.has(k)) item.append(make("p", { class: "quiet signed", text: say("signed.none") }));
  });
}

/** Buttons in the thread that show a message's settings. Returns show(), which marks the present. */
export function thread(app) {
  const items = [...document.querySelectorAll("#thread .message")];
  const buttons = items.map((item, k) => {
    const button = make("button", {
      type: "button", class: "button", text: say("thread.look"), on: {
        click: () => {
          app.lookAt(k);
          byId("view").scrollIntoView({ block: "nearest" });
        },
      },
    });
    item.append(button);
    return button;
  });
  return () => buttons.forEach((button, k) => {
    const present = k === app.at() && !app.changed();
    button.setAttribute("aria-pressed", String(present));
    button.textContent = say(present ? "thread.looking" : "thread.look");
  });
}

/** The line that says whose setting is on the canvas, with the way back. Returns show(). */
export function banner(app, messages) {
  const what = make("strong", {}), who = make("span", { class: "quiet" });
  const words = make("p", { id: "whose", class: "whose" }, what, " ", who);
  const back = make("button", {
    type: "button", id: "as-sent", class: "button", text: say("banner.back"),
    on: { click: () => app.lookAt(app.at()) },
  });
  const element = make("div", { id: "banner", class: "banner" }, words, back);
  byId("view").prepend(element);
  let inPanel = messages.length - 1;
  return () => {
    const changed = app.changed(), k = app.at(), last = messages.length - 1;
    if (k !== inPanel) {
      putInPanel(document, messages[k], k + 1);
      localTimes();
      inPanel = k;
    }
    const values = { name: authorOf(messages[k]), number: k + 1, count: messages.length };
    const key = changed ? "banner.changed" : k === last ? "banner.sent" : "banner.earlier";
    what.textContent = say(key);
    const newest = k === last && last > 0 ? "banner.newest" : "banner.which";
    who.textContent = say(changed ? "banner.changed-which" : newest, values);
    element.dataset.changed = String(changed);
    back.setAttribute("aria-pressed", String(!changed));
  };
}
