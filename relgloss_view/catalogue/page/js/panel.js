// The filters: text, ranges with histograms, a colour, choices.

import { COLUMN, COUNT, valuesOf } from "./data.js";
import { CHOICES, RANGES, namesIn } from "./filters.js";
import { byId, make } from "../../../base/js/elements.js";
import { say } from "../../../base/js/sentences.js";

const BINS = 32, STEPS = 200, FIRST_OPEN = 3, MOST_BENT = 6;

/** Histograms are drawn when they come in view, and when they change in view. */
const drawers = new Map(), inView = new Set();
const watch = new IntersectionObserver((entries) => {
  for (const { target, isIntersecting } of entries) {
    if (isIntersecting) inView.add(target);
    else inView.delete(target);
    if (isIntersecting) drawers.get(target)();
  }
});

/** A range with its histogram; null where no row has a value. change([low, high] or null). */
function rangeControl(name, change) {
  const values = valuesOf(name).filter((v) => !Number.isNaN(v)).sort();
  if (!values.length || values[0] === values[values.length - 1]) return null;
  const { label, unit, decimals } = COLUMN.get(name);
  // Rounded outwards, so that both ends as written hold all rows.
  const unitStep = 10 ** -decimals;
  const least = Number((Math.floor(values[0] / unitStep) * unitStep).toFixed(decimals));
  const most = Number((Math.ceil(values[values.length - 1] / unitStep) * unitStep).toFixed(decimals));
  // Readings crowd at one end as a rule, and one mirror would leave a slider no step for the papers:
  // places are a root of values, so that the middle one lies near the middle.
  const shareOf = (v) => (v - least) / (most - least);
  let bend = 1;
  while (bend < MOST_BENT && shareOf(values[values.length >> 1]) < 0.5 ** (bend + 1)) bend++;
  const placeOf = (v) => Math.min(1, Math.max(0, shareOf(v))) ** (1 / bend);
  const valueAt = (place) => least + place ** bend * (most - least);
  const counts = new Array(BINS).fill(0);
  for (const v of values) counts[Math.min(BINS - 1, Math.floor(placeOf(v) * BINS))]++;
  const highest = Math.max(...counts), range = [least, most];
  const bars = make("canvas", { class: "bars", width: BINS * 6, height: 36, "aria-hidden": "true" });
  const written = (at) => Number(valueAt(at / STEPS).toFixed(decimals));
  const sliders = [0, 1].map((end) => make("input", {
    type: "range", min: 0, max: STEPS, step: 1,
    "aria-label": say(end ? "range.most" : "range.least", { name: label }),
    on: { input: (event) => take(end, Number(event.target.value) === end * STEPS ? (end ? most : least)
      : written(event.target.value)) },
  }));
  const fields = [0, 1].map((end) => make("input", {
    type: "number", step: "any", inputmode: "decimal",
    "aria-label": say(end ? "range.most" : "range.least", { name: label }),
    on: { change: (event) => take(end, event.target.value === "" ? [least, most][end] : Number(event.target.value)) },
  }));
  function take(end, value) {
    if (!Number.isFinite(value)) return;
    range[end] = value;
    if (range[0] > range[1]) range[1 - end] = value;
    shown = null;
    show(range);
    change(range[0] <= least && range[1] >= most ? null : [...range]);
  }
  let shown = null;
  function show(asked) {
    [range[0], range[1]] = asked ?? [least, most];
    if (shown === range.join()) return;
    shown = range.join();
    for (const end of [0, 1]) {
      sliders[end].value = Math.round(placeOf(range[end]) * STEPS);
      fields[end].value = range[end];
      sliders[end].setAttribute("aria-valuetext", `${range[end]} ${unit}`);
    }
    if (inView.has(bars)) drawers.get(bars)();
  }
  drawers.set(bars, () => {
    const context = bars.getContext("2d");
    context.clearRect(0, 0, bars.width, bars.height);
    counts.forEach((count, bin) => {
      const middle = valueAt((bin + 0.5) / BINS);
      context.fillStyle = middle >= range[0] && middle <= range[1] ? "#d8d8d8" : "#6b6b6b";
      const high = count ? Math.max(2, (count / highest) * bars.height) : 0;
      context.fillRect(bin * 6, bars.height - high, 5, high);
    });
  });
  watch.observe(bars);
  show(null);
  const element = make("fieldset", { class: "range", "data-range": name },
    make("legend", { text: unit ? `${label} (${unit})` : label }), bars,
    make("div", { class: "ends" }, ...sliders),
    make("div", { class: "typed" }, fields[0], make("span", { text: "\u2013" }), fields[1]));
  return { element, show };
}

function choiceControl(name, change) {
  const counts = new Map(), values = valuesOf(name);
  for (let row = 0; row < COUNT; row++) {
    for (const one of namesIn(name, values[row])) counts.set(one, (counts.get(one) ?? 0) + 1);
  }
  if (counts.size < 2) return null;
  const boxes = [...counts.keys()].sort().map((one) => {
    const box = make("input", { type: "checkbox", value: one, on: { change: () => take() } });
    return [box, make("label", { class: "choice" }, box,
      make("bdi", { text: one || say("choice.none") }), make("span", { class: "quiet", text: counts.get(one) }))];
  });
  function take() {
    const chosen = boxes.filter(([box]) => box.checked).map(([box]) => box.value);
    change(chosen.length ? chosen : null);
  }
  const show = (chosen) => boxes.forEach(([box]) => { box.checked = (chosen ?? []).includes(box.value); });
  const element = make("fieldset", { class: "choices", "data-choice": name },
    make("legend", { text: COLUMN.get(name).label }), ...boxes.map(([, label]) => label));
  return { element, show };
}

function colourControl(change) {
  const field = (label) => make("input", {
    type: "number", step: "any", inputmode: "decimal", "aria-label": label, placeholder: label,
    on: { input: () => take() },
  });
  const parts = ["L*", "a*", "b*"].map(field), within = field(say("within"));
  within.min = 0;
  const typed = () => parts.map(({ value }) => (value === "" ? NaN : Number(value)));
  const blank = () => parts.forEach((part) => { part.value = ""; });
  function take() {
    const lab = typed();
    const most = within.value === "" ? NaN : Number(within.value);
    change(lab.every(Number.isFinite) ? lab : null, most >= 0 ? most : 3);
  }
  const clear = make("button", { type: "button", class: "button", text: say("colour.clear"), on: { click: () => {
    blank();
    take();
  } } });
  const element = make("fieldset", { class: "colour" }, make("legend", { text: say("colour") }),
    make("div", { class: "typed" }, ...parts),
    make("label", { class: "typed" }, make("span", { text: say("within") }), within), clear);
  byId("clear").addEventListener("click", blank);
  const show = (lab, most) => {
    // A colour of which one or two numbers are typed is none yet; they wait for the third.
    if (lab || typed().every(Number.isFinite)) {
      parts.forEach((part, k) => { if (document.activeElement !== part) part.value = lab ? lab[k] : ""; });
    }
    if (document.activeElement !== within) within.value = most;
  };
  return { element, show };
}

/** The panel. change(part of what is asked) after each move. Returns show(asked). */
export function mountPanel(asked, change) {
  const text = make("input", {
    type: "search", class: "field", id: "text", placeholder: say("text.hint"), "aria-label": say("text"),
    on: { input: () => change({ text: text.value.slice(0, 200) }) },
  });
  const within = (kind, name) => (value) => {
    const rest = { ...asked()[kind] };
    if (value) rest[name] = value;
    else delete rest[name];
    change({ [kind]: rest });
  };
  const ranges = new Map(), choices = new Map();
  for (const name of RANGES) {
    const control = rangeControl(name, within("ranges", name));
    if (control) ranges.set(name, control);
  }
  for (const name of CHOICES) {
    const control = choiceControl(name, within("choices", name));
    if (control) choices.set(name, control);
  }
  const colour = colourControl((lab, most) => change({ lab, within: most }));
  const controls = [...ranges.values()].map(({ element }) => element);
  const further = make("details", { class: "further" }, make("summary", { text: say("further") }),
    ...controls.slice(FIRST_OPEN));
  byId("panel").replaceChildren(text, ...controls.slice(0, FIRST_OPEN), colour.element,
    ...(controls.length > FIRST_OPEN ? [further] : []), ...[...choices.values()].map(({ element }) => element));
  return (now) => {
    if (document.activeElement !== text) text.value = now.text;
    for (const [name, { show }] of ranges) show(now.ranges[name] ?? null);
    for (const [name, { show }] of choices) show(now.choices[name] ?? null);
    colour.show(now.lab, now.within);
    if (RANGES.some((name) => now.ranges[name] && further.contains(ranges.get(name)?.element))) further.open = true;
  };
}
