// A slider with a number beside it, and the way back to the sent value.

import { byId, make } from "../../../base/js/elements.js";
import { shortNumber } from "./static.js";
import { say } from "../../../base/js/sentences.js";
import { figure } from "./words.js";

const STEPS = 100; // from one end of a slider to the other
const FAST = 10; // with Shift
const END_STEPS = 2; // of a slider's end, in one
const END_SLACK = 0.005; // beyond an end that rounding brings

/** A labelled slider with a number field.
 *
 * id, label, hint; usualHigh: the slider's end, unless the sent value or the present one lies beyond;
 * most: what can be typed; decimals; change(value, live); sent(): the value that a double click,
 * Backspace or Delete brings back. Returns {element, show}.
 */
export function slider({ id, label, hint, usualHigh, most, decimals, change, sent, unit }) {
  let high = usualHigh;
  const reset = () => change(sent(), false);
  const keys = (event) => {
    if (event.key === "Backspace" || event.key === "Delete") {
      event.preventDefault();
      reset();
    } else if (event.shiftKey && /^Arrow/.test(event.key)) {
      event.preventDefault();
      const way = event.key === "ArrowRight" || event.key === "ArrowUp" ? 1 : -1;
      const next = Number(range.value) + way * FAST * high / STEPS;
      change(Math.min(Math.max(next, 0), high), true);
    }
  };
  const range = make("input", {
    type: "range", id, min: 0, max: high, step: high / STEPS / FAST,
    "aria-describedby": `${id}-hint ${id}-shown`,
    on: {
      input: () => change(Number(range.value), true), change: () => change(Number(range.value), false),
      dblclick: reset, keydown: keys,
    },
  });
  const typed = make("input", {
    type: "number", id: `${id}-number`, min: 0, max: most, step: "any", inputmode: "decimal",
    "aria-label": say("slider.number", { label }),
    on: {
      change: () => {
        const value = typed.valueAsNumber;
        if (Number.isFinite(value)) change(Math.min(Math.max(value, 0), most), false);
        else show(present);
      },
    },
  });
  const notch = make("span", { class: "notch", "aria-hidden": "true" });
  const more = make("span", { class: "hint shown", id: `${id}-shown`, hidden: true });
  let present = 0;
  /** Show a value, or null where there is none to choose; `text` stands below it. */
  function show(value, text = "") {
    present = value;
    more.hidden = text === "";
    more.textContent = text;
    const none = value === null;
    range.disabled = typed.disabled = none;
    notch.hidden = none;
    if (none) {
      typed.value = "";
      return;
    }
    const back = sent();
    const end = Math.ceil(END_STEPS * (Math.max(value, back) - END_SLACK)) / END_STEPS;
    high = Math.min(Math.max(usualHigh, end), most);
    range.max = high;
    range.step = high / STEPS / FAST;
    if (Number(range.value) !== value) range.value = value;
    range.setAttribute("aria-valuetext", `${value.toFixed(decimals)} ${unit}`.trim());
    if (document.activeElement !== typed) typed.value = value.toFixed(decimals);
    notch.style.setProperty("--at", String(Math.min(back / high, 1)));
    range.style.setProperty("--at", String(Math.min(value / high, 1)));
  }
  const element = make("div", { class: "slider" },
    make("label", { for: id, text: label }),
    make("span", { class: "typed" }, typed, make("span", { class: "unit", text: unit })),
    make("span", { class: "track" }, range, notch),
    make("span", { id: `${id}-hint`, class: "quiet hint", text: hint }), more);
  return { element, show };
}

/** The controls of graininess and contrast gloss of both pictures, and the lamp's spectrum.
 *
 * app: settings(), set(settings, live), sent() the settings to go back to, report() of the engine.
 */
export function controls(app, lamps) {
  const shown = [];
  const groups = ["test", "reference"].map((side) => {
    const put = (change, live) => {
      const now = app.settings();
      app.set({ ...now, [side]: { ...now[side], ...change } }, live);
    };
    const most = () => app.report()?.[side]?.c_max ?? null;
    const grain = slider({
      id: `${side}-grain`, label: say("slider.grain"), hint: say("slider.grain-hint"),
      usualHigh: 3, most: 10, decimals: 2, unit: "\u00b0",
      change: (value, live) => put({ sigma_n_deg: value }, live),
      sent: () => app.sent()[side].sigma_n_deg,
    });
    const contrast = slider({
      id: `${side}-contrast`, label: say("slider.contrast"), hint: say("slider.contrast-hint"),
      usualHigh: 1, most: 100, decimals: 2, unit: "",
      // Back at the sent value c is the sent one to the last digit, whatever c_max is.
      change: (value, live) => put({
        c: value === app.sent()[side].c / most() ? app.sent()[side].c : value * most(),
      }, live),
      sent: () => app.sent()[side].c / most(),
    });
    shown.push(() => {
      grain.show(app.settings()[side].sigma_n_deg);
      const wanted = most() ? app.settings()[side].c / most() : null;
      const c = shortNumber(app.settings()[side].c);
      contrast.show(wanted, wanted !== null && isDimmed(app)
        ? say("slider.shown", { c, value: figure(app.report()[side].c / most(), 2) })
        : say("slider.c", { c }));
    });
    return make("fieldset", { class: "group" }, make("legend", { text: say(`side.${side}`) }),
      grain.element, contrast.element);
  });
  const spectrum = make("select", {
    id: "spectrum", class: "field",
    on: {
      change: () => {
        const now = app.settings();
        app.set({ ...now, lamp: { ...now.lamp, illuminant: spectrum.value } }, false);
      },
    },
  }, ...lamps.map((name) => make("option", { value: name, text: name })));
  shown.push(() => { spectrum.value = app.settings().lamp.illuminant; });
  const dimmed = make("p", { class: "dimmed", id: "dimmed", hidden: true });
  shown.push(() => {
    dimmed.hidden = !isDimmed(app);
    if (!dimmed.hidden) dimmed.textContent = dimmedWords(app.report());
  });
  const light = make("div", { class: "row" },
    make("label", { for: "spectrum", text: say("lamp.spectrum") }), spectrum);
  byId("controls").append(dimmed, ...groups, light);
  return () => shown.forEach((show) => show());
}

/** Whether the common factor changes what is seen. */
function isDimmed(app) {
  return app.report()?.factor < app.engine.drawing.numbers.UNSEEN;
}

/** What the common factor does to a pair, and for which picture. */
function dimmedWords(report) {
  const share = (side) => (report[side].c_max ? report[side].c / report[side].c_max : 0);
  const side = share("test") >= share("reference") ? "test" : "reference";
  return say("pair.dimmed", { side: say(`pair.${side}`), share: figure(100 * report.factor, 0) });
}
