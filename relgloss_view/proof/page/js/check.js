// "Same picture?": this browser draws the check grid and compares it with what the designer saw.

import { make } from "../../../base/js/elements.js";
import { evaluate } from "./evaluate.js";
import { say } from "../../../base/js/sentences.js";
import { figure } from "./words.js";

// dE2000. Drivers round differently: SwiftShader differs from the desktop's grid by 0.0002, llvmpipe
// by 0.0001, which is the rounding of the grid itself. A 1 % of c changes 0.009 at the least.
const CHECK_TOLERANCE = 0.005;
const CHECK_LEAST = 1e-4; // what the grid's four digits can show

const MOST_CHECKED = 2048 * 2048; // pixels, and columns or rows: proof/entries.py
const MOST_POINTS = 64;

/** Pixels of the grid. Twin: proof/grid.py `places`. */
function gridPlaces(count, pixels) {
  return Array.from({ length: count }, (_, k) => Math.floor(((2 * k + 1) * pixels) / (2 * count)));
}

/**
 * Draw the grid aside, and compare: {same, largest, side, place: [x, y], points, missed}. largest:
 * dE2000, which the graphics device computes by difference.glsl. missed: points that show the
 * object in one of both pictures alone, and not at its silhouette.
 */
export function checkGrid(engine, proof) {
  const { grid, size_px: size } = proof.content;
  if (!(size[0] * size[1] <= MOST_CHECKED && grid.columns <= MOST_POINTS && grid.rows <= MOST_POINTS)) {
    throw new Error("a check grid beyond all bounds");
  }
  const columns = gridPlaces(grid.columns, size[0]);
  const rows = gridPlaces(grid.rows, size[1]);
  const found = { largest: 0, side: "reference", place: [0, 0], points: 0, missed: 0 };
  engine.drawAside(proof.messages[0].settings, size, (passes, report) => {
    for (const side of Object.keys(grid.sides)) {
      const split = engine.device.read(passes[side].target(["split"])); // row 0 is the lowest
      const { c } = report[side];
      compareSide(engine, found, side, grid.sides[side], { split, size, columns, rows, c });
    }
  });
  found.same = found.points > 0 && found.missed === 0 && found.largest <= CHECK_TOLERANCE;
  return found;
}

function compareSide(engine, found, side, kept, { split, size, columns, rows, c }) {
  const [width, height] = size;
  const off = 0.5 * engine.drawing.numbers.OFF_OBJECT;
  const at = (x, y) => 4 * ((height - 1 - y) * width + x);
  const onObject = (x, y) => x >= 0 && y >= 0 && x < width && y < height && split[at(x, y)] > off;
  const first = [];
  const second = [];
  const places = [];
  rows.forEach((y, row) => columns.forEach((x, column) => {
    const lab = kept.lab[row * columns.length + column];
    const k = at(x, y);
    if ((lab !== null) !== onObject(x, y)) {
      if (!atSilhouette(onObject, x, y)) {
        found.missed += 1;
        Object.assign(found, { side, place: [x, y] });
      }
    } else if (lab !== null) {
      first.push(...lab);
      second.push(split[k] + c * split[k + 1], split[k + 2], split[k + 3]);
      places.push([x, y]);
    }
  }));
  if (places.length === 0) return;
  found.points += places.length;
  const differences = evaluate(
    engine.device, ["difference.glsl"], "result = vec4(delta_e_2000(kept.xyz, drawn.xyz));",
    {
      kept: { columns: 3, values: new Float32Array(first) },
      drawn: { columns: 3, values: new Float32Array(second) },
    },
  );
  places.forEach((place, k) => {
    const difference = differences[4 * k];
    if (difference <= found.largest) return; // no number is no small difference
    found.largest = Number.isNaN(difference) ? Infinity : difference;
    if (found.missed === 0) Object.assign(found, { side, place });
  });
}

/** Whether a pixel's neighbours differ: a ray there may meet the object or miss it. */
function atSilhouette(onObject, x, y) {
  const here = onObject(x, y);
  for (const dx of [-1, 0, 1]) {
    for (const dy of [-1, 0, 1]) if (onObject(x + dx, y + dy) !== here) return true;
  }
  return false;
}

/** A check in words: [key, values]. */
export function checkWords(found, size) {
  if (found.same) {
    return ["check.same", { largest: figure(Math.max(found.largest, CHECK_LEAST), 4) }];
  }
  if (found.points === 0) return ["check.nothing", {}];
  const [x, y] = found.place.map((value, k) => (value + 0.5) / size[k]);
  const third = (value, names) => names[Math.min(2, Math.floor(3 * value))];
  const place = say(`check.place.${third(y, ["top", "middle", "bottom"])}-${third(x, ["left", "centre", "right"])}`);
  const side = say(`check.side.${found.side}`);
  if (found.missed > 0) return ["check.outline", { missed: found.missed, side, place }];
  return ["check.differs", {
    largest: Number.isFinite(found.largest)
      ? figure(found.largest, found.largest < 0.1 ? 3 : 1) : say("check.no-number"),
    side, place,
  }];
}

/** The section of the page; checks once when the browser has nothing else to do. */
export function mountCheck(element, app) {
  const answer = make("p", { id: "check-answer", text: say("check.running") });
  const advice = make("p", { id: "check-advice", hidden: true, text: say("check.advice") });
  const again = make("button", {
    type: "button", class: "button", text: say("check.again"), on: { click: () => run(true) },
  });
  const run = (asked) => {
    let words;
    try {
      const found = checkGrid(app.engine, app.proof);
      element.dataset.same = String(found.same);
      words = checkWords(found, app.proof.content.size_px);
      app.check = found;
    } catch (fault) {
      element.dataset.same = "unknown";
      words = ["check.failed", {}];
      console.warn(fault);
    }
    answer.textContent = say(...words);
    answer.classList.toggle("warning", element.dataset.same === "false");
    advice.hidden = element.dataset.same !== "false";
    if (asked || element.dataset.same === "false") app.announce?.(answer.textContent);
  };
  element.append(
    make("h2", { text: say("check.title") }), answer, advice,
    make("p", { class: "quiet", text: say("check.how") }), make("p", { class: "step" }, again),
  );
  return new Promise((resolve) => {
    const begin = () => {
      run(false);
      resolve(app.check);
    };
    if (window.requestIdleCallback) window.requestIdleCallback(begin, { timeout: 3000 });
    else setTimeout(begin, 200);
  });
}
