// The maker's screen: what it shows of black, white and grays, and what that changes.

import { make } from "../../../base/js/elements.js";
import { SIDES } from "./pair.js";
import {
  BRIGHT_STEPS, DARK_STEPS, STEP_LSTAR, blackBounds, clippedFrom, designersScreen, differences,
  highlightsOf, orderOfGloss, orderWords, patternGamma, possibleGammas, signalOf, unknownScreen,
} from "./screens.js";
import { say } from "../../../base/js/sentences.js";
import { figure } from "./words.js";

const PATCH_PX = 44; // of the page, before its scale
const CHANNEL_MASKS = { gray: [1, 1, 1], red: [1, 0, 0], green: [0, 1, 0], blue: [0, 0, 1] };

/** The section of the page. Returns {update}: call it when other settings are looked at. */
export function mountScreen(element, app) {
  const answers = { dark: null, bright: null, gamma: null, channels: null, white: null, surround: "" };
  const theirs = designersScreen(app.proof.content.display);
  const result = make("div", { class: "said-of-screen", role: "status" });
  const order = make("div", { class: "said-of-screen", role: "status" });

  /** What the answers mean, in words and for the reply. */
  const changed = () => {
    const screen = screenOf(answers);
    const known = Object.values(answers).some((value) => value !== null && value !== "");
    app.screen = known ? screen : null;
    result.replaceChildren(make("h3", { text: say("screen.result.title") }), ...(known
      ? differences(screen, theirs).map(sentence)
      : [make("p", { class: "quiet", text: say("screen.result.none") })]));
    update();
  };
  const update = () => {
    const sentences = ordered(app, screenOf(answers), theirs).map(sentence);
    const words = (list) => [...list].map((line) => line.textContent).join("\n");
    // What is put into it again would be read out again, whenever a slider rests.
    if (words(order.querySelectorAll("p")) === words(sentences) && order.hasChildNodes()) return;
    order.replaceChildren(make("h3", { text: say("screen.order.title") }), ...sentences);
  };
  const note = (name) => (value) => {
    answers[name] = value;
    changed();
  };
  const parts = [
    steps("dark", DARK_STEPS, 0, note("dark")), steps("bright", BRIGHT_STEPS, 255, note("bright"), true),
    grays(note("gamma"), note("channels")), light(note("white"), note("surround")),
  ];
  const forget = make("button", {
    type: "button", class: "button", text: say("screen.forget"),
    on: { click: () => parts.forEach((part) => part.forget()) },
  });
  element.append(
    make("h2", { text: say("screen.title") }), make("p", { text: say("screen.intro") }),
    ...parts.map((part) => part.element), result, order, make("p", {}, forget),
  );
  changed();
  return { update };
}

/** An estimate of the screen, as a message holds it. */
export function screenOf({ dark, bright, gamma, channels, white, surround }) {
  const [least, most] = dark === null ? [null, null] : blackBounds(dark, possibleGammas(gamma));
  return {
    ...unknownScreen(), white_cd_m2: white, black_least: least, black_most: most, gamma, channels,
    clipped: bright === null ? null : clippedFrom(bright), surround,
  };
}

function sentence([key, values]) {
  const filled = Object.entries(values).map(([name, value]) => {
    if (typeof value === "number") return [name, figure(value, decimalsOf(value))];
    return [name, value.startsWith("screen.") ? say(value) : say(`screen.channel.${value}`).toLowerCase()];
  });
  return make("p", { text: say(key, Object.fromEntries(filled)) });
}

/** Decimals of a number that has at most three significant digits. */
function decimalsOf(value) {
  return value === 0 ? 0 : Math.max(0, Math.min(6, String(value).replace(/^-?\d+\.?/, "").length));
}

/** What the order of gloss becomes on both screens, as [key, values]. */
function ordered(app, mine, theirs) {
  const pairs = {};
  try {
    const off = 0.5 * app.engine.drawing.numbers.OFF_OBJECT;
    for (const side of SIDES) {
      const split = app.engine.split(side);
      const l_d = [];
      const l_s = [];
      for (let k = 0; k < split.length; k += 4) {
        if (split[k] > off) {
          l_d.push(split[k]);
          l_s.push(split[k + 1]);
        }
      }
      pairs[side] = highlightsOf(l_d, l_s, app.engine.report[side].c);
    }
  } catch (fault) {
    console.warn(fault);
    return [];
  }
  if (SIDES.some((side) => pairs[side].length === 0)) return []; // one is out of the picture
  const mineOrder = orderOfGloss(pairs.reference, pairs.test, mine);
  if (mineOrder.kind === "alike") return [["screen.order.alike", {}]];
  const [first, second] = [pairs.reference[0], pairs.test[0]];
  const higher = first.peak - first.body - (second.peak - second.body) >= STEP_LSTAR ? "reference" : "test";
  return [
    [`screen.order.higher-${higher}`, {}], orderWords(mineOrder, "yours"),
    orderWords(orderOfGloss(pairs.reference, pairs.test, theirs), "designer"),
  ];
}

/** Patches on a ground, of which the observer chooses the first that is seen. */
function steps(name, values, ground, choose, folded = false) {
  const patches = values.map((value, k) => {
    const radio = make("input", {
      type: "radio", name: `screen-${name}`, value: k,
      "aria-label": say("screen.patch", { number: k + 1, count: values.length }),
      on: { change: () => choose(k) },
    });
    return make("label", { class: "patch" }, patch(value, ground), radio);
  });
  const none = make("input", {
    type: "radio", name: `screen-${name}`, value: values.length, on: { change: () => choose(values.length) },
  });
  const field = [
    make("p", { text: say(`screen.${name}.how`) }),
    make("div", { class: "patches", "data-ground": name }, ...patches),
    make("label", { class: "choice" }, none, make("span", { text: say(`screen.${name}.none`) })),
  ];
  // A bright field takes eyes off the pictures, so it shows when it is asked for.
  const shown = folded
    ? [make("details", {}, make("summary", { text: say("screen.field.show") }), ...field)] : field;
  const element = make("fieldset", { class: "step" },
    make("legend", { text: say(`screen.${name}.title`) }), ...shown);
  const forget = () => {
    for (const radio of element.querySelectorAll("input")) radio.checked = false;
    choose(null);
  };
  return { element, forget };
}

/** A canvas, since browsers replace colours of the page where the reader wants high contrast. */
function patch(value, ground) {
  const canvas = make("canvas", { width: PATCH_PX, height: PATCH_PX, "aria-hidden": "true" });
  const context = canvas.getContext("2d");
  context.fillStyle = `rgb(${ground} ${ground} ${ground})`;
  context.fillRect(0, 0, PATCH_PX, PATCH_PX);
  context.fillStyle = `rgb(${value} ${value} ${value})`;
  context.fillRect(8, 8, PATCH_PX - 16, PATCH_PX - 16);
  return canvas;
}

/** Fine lines of black and white, and a plain field whose signal the observer sets. */
function grays(choose, chooseChannels) {
  const gray = pattern("gray");
  const channels = ["red", "green", "blue"].map(pattern);
  const scaled = make("p", { class: "quiet", hidden: true });
  const answer = make("p", { class: "quiet", role: "status" });
  const answers = make("p", { class: "quiet", role: "status" });
  const equal = make("button", {
    type: "button", class: "button", text: say("screen.gamma.equal"),
    on: { click: () => {
      const gamma = gray.gamma();
      answer.textContent = say("screen.gamma.set", { gamma: figure(gamma, 1) });
      choose(gamma);
    } },
  });
  const allEqual = make("button", {
    type: "button", class: "button", text: say("screen.channels.equal"),
    on: { click: () => {
      const gammas = channels.map((channel) => channel.gamma());
      const [red, green, blue] = gammas.map((gamma) => figure(gamma, 1));
      answers.textContent = say("screen.channels.set", { red, green, blue });
      chooseChannels(gammas);
    } },
  });
  const more = make("details", {}, make("summary", { text: say("screen.gamma.more") }),
    ...channels.map((channel) => channel.element), allEqual, answers);
  const element = make("fieldset", { class: "step" },
    make("legend", { text: say("screen.gamma.title") }), make("p", { text: say("screen.gamma.how") }),
    scaled, gray.element, equal, answer, more);
  const draw = () => {
    const scale = window.devicePixelRatio || 1;
    scaled.hidden = Number.isInteger(scale);
    scaled.textContent = say("screen.gamma.scaled", { scale: figure(scale, 2) });
    for (const one of [gray, ...channels]) one.draw(scale);
  };
  new ResizeObserver(draw).observe(element);
  more.addEventListener("toggle", draw);
  window.addEventListener("scrollend", draw);
  const forget = () => {
    answer.textContent = "";
    answers.textContent = "";
    for (const one of [gray, ...channels]) one.forget();
    choose(null);
    chooseChannels(null);
  };
  return { element, forget };
}

/** One pattern with its slider: of gray, or of one channel. */
function pattern(name) {
  const usual = Math.round(255 * signalOf(0.5));
  const canvas = make("canvas", { class: "lines", "aria-hidden": "true" });
  const label = name === "gray" ? say("screen.gamma.slider") : say(`screen.channel.${name}`);
  const slider = make("input", {
    type: "range", min: 96, max: 240, step: 1, value: usual, "aria-label": label,
    on: { input: () => draw(window.devicePixelRatio || 1) },
  });
  const draw = (scale) => {
    slider.style.setProperty("--at", (slider.value - 96) / (240 - 96));
    slider.setAttribute("aria-valuetext", say("screen.gamma.value", { value: slider.value }));
    const place = canvas.parentElement.getBoundingClientRect();
    const width = Math.floor(place.width * scale);
    const height = Math.round(96 * scale);
    if (width < 8) return; // not laid out
    // As many pixels as the screen has there, from a whole pixel on: else the lines are blurred.
    canvas.width = width;
    canvas.height = height;
    canvas.style.width = `${width / scale}px`;
    canvas.style.height = `${height / scale}px`;
    canvas.style.transform = `translate(${offWhole(place.left, scale)}px, ${offWhole(place.top, scale)}px)`;
    paint(canvas, name, Number(slider.value), Math.round(scale));
  };
  const element = make("div", { class: "pattern" },
    make("div", { class: "lines-place" }, canvas), make("label", { class: "stacked" },
      make("span", { class: "quiet", text: label }), slider));
  return {
    element, draw, gamma: () => patternGamma(Number(slider.value) / 255),
    forget: () => {
      slider.value = usual;
      draw(window.devicePixelRatio || 1);
    },
  };
}

function offWhole(position, scale) {
  return (Math.ceil(position * scale - 1e-3) - position * scale) / scale;
}

/** Rows of black and white, each a device pixel high, around the plain field. */
function paint(canvas, name, value, scale) {
  const { width, height } = canvas;
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  const [left, right] = [Math.round(width / 3), Math.round((2 * width) / 3)];
  const edge = 2 * Math.round(8 * scale);
  const mask = CHANNEL_MASKS[name];
  for (let y = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1) {
      const inside = x >= left && x < right && y >= edge && y < height - edge;
      const signal = inside ? value : 255 * (y % 2);
      image.data.set([...mask.map((on) => on * signal), 255], 4 * (y * width + x));
    }
  }
  context.putImageData(image, 0, 0);
}

/** White in cd/m2, where an instrument is at hand, and the light around. */
function light(chooseWhite, chooseSurround) {
  const wrong = make("p", { class: "warning", id: "screen-white-wrong", role: "alert", hidden: true,
    text: say("screen.white.wrong") });
  const typed = make("input", {
    type: "number", min: 1, max: 10000, step: "any", inputmode: "decimal", class: "field",
    "aria-describedby": "screen-white-how screen-white-wrong",
    on: { change: () => {
      const value = typed.value === "" && !typed.validity.badInput ? null : typed.valueAsNumber;
      const good = value === null || (value >= 1 && value <= 10000);
      wrong.hidden = good;
      typed.setAttribute("aria-invalid", String(!good));
      chooseWhite(good ? value : null);
    } },
  });
  const surround = make("select", { class: "field", on: { change: () => chooseSurround(surround.value) } },
    make("option", { value: "", text: say("screen.surround.choose") }),
    ...["dark", "office", "bright"].map((value) => make("option", { value, text: say(`screen.surround.choose-${value}`) })));
  const element = make("fieldset", { class: "step" }, make("legend", { text: say("screen.light.title") }),
    make("label", { class: "stacked" }, make("span", { text: say("screen.white.label") }), typed), wrong,
    make("p", { class: "quiet", id: "screen-white-how", text: say("screen.white.how") }),
    make("label", { class: "stacked" }, make("span", { text: say("screen.surround.label") }), surround));
  const forget = () => {
    typed.value = "";
    surround.value = "";
    wrong.hidden = true;
    typed.setAttribute("aria-invalid", "false");
    chooseWhite(null);
    chooseSurround("");
  };
  return { element, forget };
}
