// The static body of a reply: twin of proof/page/static.py for what a message adds.

import { splitPage } from "./canonical.js";
import { SIDES } from "./pair.js";
import { say } from "../../../base/js/sentences.js";

/** A number with three significant digits at most. */
export function shortNumber(value) {
  return Math.abs(value) < 1e-4 ? "0" : String(Number(value.toPrecision(3)));
}

/** Text as Python's `escaped` leaves it, before its signs are escaped. */
function plainText(text) {
  return text.replace(/\r\n?/g, "\n")
    .replace(/[\x00-\x09\x0b-\x1f\x7f-\x9f\ufdd0-\ufdef\ufffe\uffff]/g, "\ufffd");
}

/** Settings in words: [what, value] of each. */
export function settingsRows(settings) {
  const { eye, lamp } = settings;
  return [
    ...SIDES.map((side) => [say(`side.${side}`), say("settings.of-side", {
      grain: shortNumber(settings[side].sigma_n_deg), contrast: shortNumber(settings[side].c),
    })]),
    [say("settings.lamp"), say("settings.lamp-place", {
      spectrum: lamp.illuminant, azimuth: shortNumber(lamp.azimuth_deg),
      elevation: shortNumber(lamp.elevation_deg),
    })],
    [say("settings.eye"), say("settings.eye-place", {
      azimuth: shortNumber(eye.azimuth_deg), elevation: shortNumber(eye.elevation_deg),
    })],
  ];
}

/** The page's text with a message in its static body; the seal and the data are withMessage's. */
export function withStatic(html, message) {
  const { static: before, proof } = splitPage(html);
  const part = new DOMParser().parseFromString(`<body>${before}`, "text/html");
  bringUpToDate(part, [...JSON.parse(proof).messages, message]);
  const after = part.body.innerHTML;
  return html.replace(before, () => after);
}

/** Add the messages that a static body lacks; the newest is the one in the panel. */
export function bringUpToDate(part, messages) {
  const list = part.querySelector("#thread ol"), shown = list.querySelectorAll("li").length;
  if (shown === messages.length) return;
  messages.slice(shown).forEach((message, k) => {
    const number = shown + k + 1, before = messages[number - 2]?.settings ?? null;
    list.append(messageItem(part, message, number, before), "\n");
  });
  putInPanel(part, messages.at(-1), messages.length);
}

/** The byline and the note of a message beside the pictures; number: of the message, from 1. */
export function putInPanel(part, message, number) {
  const panel = part.getElementById("panel");
  panel.querySelector(".byline").replaceWith(messageByline(part, message, number));
  const note = panel.querySelector("blockquote");
  if (note !== null) {
    note.nextSibling.remove();
    note.remove();
  }
  if (message.note) {
    part.getElementById("controls").before(madeIn(part, "blockquote", "note", message.note), "\n");
  }
}

function madeIn(part, tag, name, text) {
  const made = part.createElement(tag);
  if (name) made.className = name;
  if (text !== undefined) made.textContent = plainText(text);
  return made;
}

function messageByline(part, message, number) {
  const line = madeIn(part, "p", "byline", message.author
    ? say("message.from", { number, name: message.author }) : say("message.unnamed", { number }));
  line.append(" ");
  if (/^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$/.test(message.made)) {
    const time = madeIn(part, "time", "", message.made.replace(/^(.{10})T(.{5}).*$/, "$1 $2 UTC"));
    time.setAttribute("datetime", message.made);
    line.append(time);
  }
  return line;
}

// Of the settings, what differs from those of the message before.
function messageItem(part, message, number, before) {
  const item = madeIn(part, "li", "message"), rows = madeIn(part, "dl", "settings");
  const known = new Set(before === null ? [] : settingsRows(before).map(String));
  const other = settingsRows(message.settings).filter((row) => !known.has(String(row)));
  rows.append(...other.map(([name, value]) => {
    const row = part.createElement("div");
    row.append(madeIn(part, "dt", "", name), madeIn(part, "dd", "", value));
    return row;
  }));
  item.append(messageByline(part, message, number), "\n");
  if (message.note) item.append(madeIn(part, "p", "said", message.note), "\n");
  item.append(other.length > 0 ? rows : madeIn(part, "p", "quiet", say("settings.same")), "\n");
  return item;
}
