// A slider with a number beside it, and the way back to the sent value.

import { byId, make } from "./dom.js";
import { say } from "./words.js";

const STEPS = 100; // from one end of a slider to the other
const FAST = 10; // with Shift

/** A labelled slider with a number field.
 *
 * id, label, hint; high: the slider's end; most: what can be typed; decimals; change(value, live);
 * sent(): the value that a double click, Backspace or Delete brings back. Returns {element, show}.
 */
export function slider({ id, label, hint, high, most, decimals, change, sent, unit }) {
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
    "aria-describedby": `${id}-hint`,
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
  let present = 0;
  /** Show a value, or null where there is none to choose. */
  function show(value) {
    present = value;
    const none = value === null;
    range.disabled = typed.disabled = none;
    notch.hidden = none;
    if (none) {
      typed.value = "";
      return;
    }
    if (Number(range.value) !== value) range.value = value;
    range.setAttribute("aria-valuetext", `${value.toFixed(decimals)} ${unit}`.trim());
    if (document.activeElement !== typed) typed.value = value.toFixed(decimals);
    const back = sent();
    notch.hidden = back > high;
    notch.style.setProperty("--at", String(Math.min(back / high, 1)));
    range.style.setProperty("--at", String(Math.min(value / high, 1)));
  }
  const element = make("div", { class: "slider" },
    make("label", { for: id, text: label }),
    make("span", { class: "typed" }, typed, make("span", { class: "unit", text: unit })),
    make("span", { class: "track" }, range, notch),
    make("span", { id: `${id}-hint`, class: "quiet hint", text: hint }));
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
      high: 3, most: 10, decimals: 2, unit: "\u00b0",
      change: (value, live) => put({ sigma_n_deg: value }, live),
      sent: () => app.sent()[side].sigma_n_deg,
    });
    const contrast = slider({
      id: `${side}-contrast`, label: say("slider.contrast"), hint: say("slider.contrast-hint"),
      high: 1, most: 100, decimals: 2, unit: "",
      // Back at the sent value c is the sent one to the last digit, whatever c_max is.
      change: (value, live) => put({
        c: value === app.sent()[side].c / most() ? app.sent()[side].c : value * most(),
      }, live),
      sent: () => app.sent()[side].c / most(),
    });
    shown.push(() => {
      grain.show(app.settings()[side].sigma_n_deg);
      contrast.show(most() ? app.settings()[side].c / most() : null);
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
  const dimmed = make("p", { class: "quiet", id: "dimmed", hidden: true, text: say("pair.dimmed") });
  shown.push(() => { dimmed.hidden = !(app.report()?.factor < 0.995); });
  const light = make("div", { class: "row" },
    make("label", { for: "spectrum", text: say("lamp.spectrum") }), spectrum);
  byId("controls").append(...groups, dimmed, light);
  return () => shown.forEach((show) => show());
}
