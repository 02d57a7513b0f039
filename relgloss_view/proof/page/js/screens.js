// What is known of the screen that shows a proof, and what follows for the gloss seen on it.
// Twin: relgloss_view/proof/screens.py, with the same names in this language's writing; the reasons
// are there.

export const DARK_STEPS = [1, 2, 3, 4, 6, 8, 11, 15, 20, 27, 36, 48];
export const BRIGHT_STEPS = [254, 253, 252, 251, 249, 247, 244, 240, 235, 228, 219, 207];
const UNSEEN_LSTAR = 0.3;
const SEEN_LSTAR = 1.2;
export const STEP_LSTAR = 1.0;
const LINES_LIGHT = 0.5;
const REFERENCE_CD_M2 = 100.0;
const USUAL_WHITES_CD_M2 = [80.0, 1000.0];
const GAMMA_ERROR = 0.06;
const MOST_BLACK = 0.99;
const HIGHLIGHT_SHARES = [0.002, 0.012];
const RANK = { kept: 0, hidden: 1, reversed: 2 };
const SRGB_GAMMA_RANGE = [2.0, 2.4];

/** A screen of which nothing is known, as a message holds it. */
export function unknownScreen() {
  return {
    white_cd_m2: null, black_least: null, black_most: null, gamma: null, channels: null,
    clipped: null, surround: "",
  };
}

export function lstarOf(light) {
  return light > 216.0 / 24389.0 ? 116.0 * Math.cbrt(light) - 16.0 : (24389.0 / 27.0) * light;
}

export function lightOfLstar(lstar) {
  const f = (lstar + 16.0) / 116.0;
  return f > 6.0 / 29.0 ? f ** 3 : (116.0 * f - 16.0) / (24389.0 / 27.0);
}

export function signalOf(light) {
  const cut = Math.min(Math.max(light, 0.0), 1.0);
  return cut <= 0.0031308 ? 12.92 * cut : 1.055 * cut ** (1.0 / 2.4) - 0.055;
}

export function pixelLight(signal, gamma) {
  if (gamma > 0.0) return signal ** gamma;
  return signal <= 0.04045 ? signal / 12.92 : ((signal + 0.055) / 1.055) ** 2.4;
}

export function shownLight(signal, display) {
  const pixel = signal >= display.clipped ? 1.0 : pixelLight(signal, display.gamma);
  return display.black + (1.0 - display.black) * pixel;
}

export function patternGamma(signal) {
  return Math.log(LINES_LIGHT) / Math.log(signal);
}

export function darkStep(signal, black, gamma) {
  return lstarOf(black + (1.0 - black) * pixelLight(signal, gamma)) - lstarOf(black);
}

export function blackOfStep(signal, stepLstar, gamma) {
  if (darkStep(signal, 0.0, gamma) <= stepLstar) return 0.0;
  if (darkStep(signal, MOST_BLACK, gamma) >= stepLstar) return MOST_BLACK;
  let low = 0.0;
  let high = MOST_BLACK;
  for (let k = 0; k < 60; k += 1) {
    const middle = 0.5 * (low + high);
    if (darkStep(signal, middle, gamma) > stepLstar) low = middle;
    else high = middle;
  }
  return 0.5 * (low + high);
}

export function blackBounds(firstSeen, gammas) {
  let least = MOST_BLACK;
  let most = 0.0;
  for (const gamma of gammas) {
    let low = 0.0;
    let high = MOST_BLACK;
    if (firstSeen > 0) low = blackOfStep(DARK_STEPS[firstSeen - 1] / 255.0, SEEN_LSTAR, gamma);
    if (firstSeen < DARK_STEPS.length) {
      high = blackOfStep(DARK_STEPS[firstSeen] / 255.0, UNSEEN_LSTAR, gamma);
    }
    least = Math.min(least, low);
    most = Math.max(most, high);
  }
  return [Math.min(least, most), most];
}

export function clippedFrom(firstSeen) {
  if (firstSeen === 0) return 1.0;
  const unseen = BRIGHT_STEPS[firstSeen - 1] / 255.0;
  return 100.0 - lstarOf(pixelLight(unseen, 0.0)) < SEEN_LSTAR ? 1.0 : unseen;
}

export function possibleGammas(gamma) {
  if (gamma === null) return [0.0];
  const near = [gamma - GAMMA_ERROR, gamma + GAMMA_ERROR];
  const [low, high] = SRGB_GAMMA_RANGE;
  return low <= gamma && gamma <= high ? [...near, 0.0] : near;
}

export function cases(screen) {
  if (screen.black_least === null || screen.black_most === null) return [];
  const whites = screen.white_cd_m2 === null ? USUAL_WHITES_CD_M2 : [screen.white_cd_m2];
  const clipped = screen.clipped === null ? 1.0 : screen.clipped;
  const possible = [];
  for (const white_cd_m2 of whites) {
    for (const black of [screen.black_least, screen.black_most]) {
      for (const gamma of possibleGammas(screen.gamma)) {
        possible.push({ white_cd_m2, black, gamma, clipped });
      }
    }
  }
  return possible;
}

export function highlightsOf(l_d, l_s, c) {
  const count = l_s.length;
  if (count === 0) return [];
  const seen = Float64Array.from(l_s, (value, k) => Math.min(l_d[k] + c * value, 100.0));
  const byGloss = Float64Array.from(l_s).sort(); // fast, because it sorts numbers alone
  const byLightness = Float64Array.from(seen).sort();
  const usual = byLightness[Math.floor(count / 2)];
  const found = [];
  const whole = [];
  for (const share of HIGHLIGHT_SHARES) {
    const number = Math.max(1, halfToEven(share * count));
    const strongest = largestOf(l_s, byGloss, number);
    found.push({ body: meanOf(l_d, strongest), peak: meanOf(seen, strongest) });
    whole.push({ body: usual, peak: meanOf(seen, largestOf(seen, byLightness, number)) });
  }
  return [...found, ...whole];
}

/** Places of the largest values; of equal ones the last, as Python's stable order has them. */
function largestOf(values, sorted, number) {
  const least = sorted[sorted.length - number];
  const above = [];
  const equal = [];
  for (let k = values.length - 1; k >= 0; k -= 1) {
    if (values[k] > least) above.push(k);
    else if (values[k] === least) equal.push(k);
  }
  return [...above, ...equal.slice(0, number - above.length)];
}

function meanOf(values, places) {
  return places.reduce((sum, k) => sum + values[k], 0.0) / places.length;
}

/** Python's round. */
function halfToEven(value) {
  const low = Math.floor(value);
  if (value - low !== 0.5) return Math.round(value);
  return low % 2 === 0 ? low : low + 1;
}

export function glossShown(highlight, display) {
  const seen = (lstar) => lstarOf(shownLight(signalOf(lightOfLstar(lstar)), display));
  const bright = (display.white_cd_m2 / REFERENCE_CD_M2) ** (1.0 / 3.0);
  return (seen(highlight.peak) - seen(highlight.body)) * bright;
}

export function orderOfGloss(reference, test, screen) {
  const added = (highlight) => highlight.peak - highlight.body;
  const designed = reference.map((highlight, k) => added(highlight) - added(test[k]));
  const verdict = (kind, side = "", cause = "", black = 0.0) => ({ kind, side, cause, black });
  if (designed.length === 0
    || (Math.min(...designed) < STEP_LSTAR && Math.max(...designed) > -STEP_LSTAR)) {
    return verdict("alike");
  }
  const possible = cases(screen);
  if (possible.length === 0) return verdict("unknown");
  let worst = verdict("kept");
  for (const display of possible) {
    designed.forEach((wanted, k) => {
      const kind = orderOn(wanted, reference[k], test[k], display);
      if (RANK[kind] <= RANK[worst.kind]) return;
      const less = shareShown(reference[k], display) < shareShown(test[k], display);
      const cause = causeOf(wanted, reference[k], test[k], display);
      worst = verdict(kind, less ? "reference" : "test", cause, display.black);
    });
  }
  return worst;
}

function orderOn(designed, reference, test, display) {
  const shown = glossShown(reference, display) - glossShown(test, display);
  if (Math.abs(shown) < STEP_LSTAR) return "hidden";
  return (shown > 0.0) === (designed > 0.0) ? "kept" : "reversed";
}

function shareShown(highlight, display) {
  const added = highlight.peak - highlight.body;
  return added > 0.0 ? glossShown(highlight, display) / added : Infinity;
}

function causeOf(designed, reference, test, display) {
  const mended = [
    ["black", display.black, { black: 0.0 }],
    ["clipped", display.clipped, { clipped: 1.0 }],
    ["gamma", display.gamma, { gamma: 0.0 }],
    ["white", display.white_cd_m2, { white_cd_m2: USUAL_WHITES_CD_M2[1] }],
  ];
  for (const [cause, present, change] of mended) {
    if (present !== Object.values(change)[0]
      && orderOn(designed, reference, test, { ...display, ...change }) === "kept") return cause;
  }
  return display.black > 0.0 ? "black" : "white";
}

export function designersScreen(display) {
  const luminance = display.luminance_cd_m2;
  const black = display.black_known
    ? Math.min(Math.max(display.black_cd_m2 / luminance, 0.0), MOST_BLACK) : null;
  return {
    ...unknownScreen(), white_cd_m2: display.luminance_known ? luminance : null,
    black_least: black, black_most: black,
  };
}

// What follows, in words: [key, values]. Twin: relgloss_view/proof/screen_words.py.

const SAME_WHITE = 1.1;
const SAME_BLACK = 0.003;
const WIDE_BLACK = 0.02;
const SAME_GAMMA = 0.12;
const SAME_CHANNELS = 0.2;
const CHANNEL_NAMES = ["red", "green", "blue"];

export function significant(value, digits = 2) {
  if (value === 0.0) return 0.0;
  const scale = 10.0 ** (digits - 1 - Math.floor(Math.log10(Math.abs(value))));
  return Math.floor(value * scale + 0.5) / scale;
}

export function differences(mine, theirs) {
  return [
    whiteWords(mine, theirs), ...blackWords(mine, theirs), ...curveWords(mine),
    ...(mine.surround === "" ? [] : [[`screen.surround.${mine.surround}`, {}]]),
  ];
}

function whiteWords(mine, theirs) {
  if (mine.white_cd_m2 === null) return ["screen.white.unknown", {}];
  if (theirs.white_cd_m2 === null) return ["screen.white.designer-unknown", {}];
  const times = mine.white_cd_m2 / theirs.white_cd_m2;
  if (times * SAME_WHITE < 1.0) return ["screen.white.dimmer", { share: significant(100.0 * times) }];
  if (times > SAME_WHITE) return ["screen.white.brighter", { times: significant(times) }];
  return ["screen.white.same", {}];
}

function blackWords(mine, theirs) {
  if (mine.black_least === null || mine.black_most === null) return [["screen.black.unknown", {}]];
  const [least, most] = [mine.black_least, mine.black_most].map((b) => significant(100.0 * b));
  const yours = ["screen.black.yours", { least, most }];
  if (theirs.black_most === null) return [yours, ["screen.black.designer-unknown", {}]];
  let kind = mine.black_most - mine.black_least > WIDE_BLACK ? "unsure" : "same";
  if (mine.black_least > theirs.black_most + SAME_BLACK) kind = "lighter";
  if (mine.black_most < theirs.black_most - SAME_BLACK) kind = "darker";
  return [yours, [`screen.black.${kind}`, { designer: significant(100.0 * theirs.black_most) }]];
}

function curveWords(mine) {
  const said = [];
  if (mine.gamma === null) {
    said.push(["screen.gamma.unknown", {}]);
  } else {
    const usual = patternGamma(signalOf(0.5));
    const off = mine.gamma - usual;
    const kind = Math.abs(off) <= SAME_GAMMA ? "same" : off > 0.0 ? "higher" : "lower";
    const values = { gamma: significant(mine.gamma), usual: significant(usual) };
    said.push([`screen.gamma.${kind}`, values]);
  }
  if (mine.channels !== null) {
    const [low, high] = [Math.min(...mine.channels), Math.max(...mine.channels)];
    said.push(high - low > SAME_CHANNELS
      ? ["screen.channels.differ", { channel: CHANNEL_NAMES[mine.channels.indexOf(high)] }]
      : ["screen.channels.same", {}]);
  }
  if (mine.clipped !== null && mine.clipped < 1.0) {
    said.push(["screen.clipped", { lstar: significant(lstarOf(pixelLight(mine.clipped, 0.0))) }]);
  }
  return said;
}

/** screen: "yours" or "designer", whose it is. */
export function orderWords(order, screen) {
  if (order.cause === "") return [`screen.order.${order.kind}`, { screen: `screen.${screen}` }];
  return [`screen.order.${order.kind}-${order.cause}`, {
    screen: `screen.${screen}`, side: `screen.side.${order.side}`, black: significant(100.0 * order.black),
  }];
}
