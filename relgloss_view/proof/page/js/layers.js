// The layers of a pack: paint and channels of each mip level, bit for bit as relgloss_view/pack/layers.py has
// them. What comes ready made is in relgloss_view/proof/layers_drawing.py.

import { bytesOf, unpacked } from "./arrays.js";
import { decodePng } from "./png.js";

const { fround } = Math;
const LARGEST_PAINT = fround(6e4);
const KEPT_COLOURS = 4096; // colours of an artwork whose paint is found again
const KEPT_SHIFT = 20; // from 32 bits to the number of a place among them
const halfNumber = new Float32Array(1);
const halfBits = new Uint32Array(halfNumber.buffer);

/** The numbers of an array of a drawing, whether it is packed or not. */
export async function valuesOf(array) {
  return array.values ?? (await unpacked(array)).values;
}

/** The bits of the half float nearest to a number that is finite and no larger than 65504, ties to even. */
export function halfOf(number) {
  halfNumber[0] = number;
  const bits = halfBits[0];
  const sign = (bits >>> 16) & 0x8000;
  const size = bits & 0x7fffffff;
  if (size < 0x38800000) {
    // Below 2^-14 a half float has steps of 2^-24.
    const steps = Math.abs(halfNumber[0]) * 16777216;
    const low = Math.floor(steps);
    const part = steps - low;
    return sign | (part > 0.5 || (part === 0.5 && low & 1) ? low + 1 : low);
  }
  return sign | ((size - 0x38000000 + 0xfff + ((size >>> 13) & 1)) >>> 13);
}

/** The half floats nearest to numbers that are finite and no larger than 65504: a Uint16Array. */
export function halvesOf(values) {
  const bits = new Uint32Array(values.buffer, values.byteOffset, values.length);
  const halves = new Uint16Array(values.length);
  for (let n = 0; n < halves.length; n++) {
    const size = bits[n] & 0x7fffffff;
    halves[n] = size < 0x38800000
      ? halfOf(values[n])
      : ((bits[n] >>> 16) & 0x8000) | ((size - 0x38000000 + 0xfff + ((size >>> 13) & 1)) >>> 13);
  }
  return halves;
}

let halfNumbers = null;

/** The number of each half float, by its bits. */
export function numbersOfHalves() {
  if (halfNumbers) return halfNumbers;
  halfNumbers = new Float32Array(65536);
  for (let bits = 0; bits < 65536; bits++) {
    const exponent = (bits >> 10) & 31;
    const part = bits & 1023;
    const size = exponent ? (1024 + part) * 2 ** (exponent - 25) : part * 2 ** -24;
    halfNumbers[bits] = bits & 0x8000 ? -size : size;
  }
  return halfNumbers;
}

/** The layers of a side's `surface.printed`; files: the content's own. {levels, count}.
 *
 * levels: {width, height, paint: Uint16Array of half floats, 4 a texel, channels: Uint8Array, `count` a texel}.
 */
export async function layersOf(printed, files) {
  const [width, height] = printed.size_px;
  const count = printed.channels.length;
  const channels = new Uint8Array(width * height * count);
  for (let k = 0; k < count; k++) {
    const { file, png, inverted } = printed.channels[k];
    const mask = await decodePng(bytesOf(png ?? files[file].base64));
    const values = grayValues(mask);
    const flip = inverted ? 255 : 0;
    for (let n = 0; n < values.length; n++) channels[n * count + k] = values[n] ^ flip;
  }
  const paint = await paintOf(printed.paint, files, width, height, channels, count);
  const levels = [{ width, height, paint, channels }];
  for (let level = started(levels[0], count); level.width > 1 || level.height > 1; ) {
    level = halvedLevel(level, count);
    levels.push(stored(level, count, printed.groups));
  }
  return { levels, count };
}

// A mask's values, 8 bits: 16 bits rounded as mask_file.py rounds them.
function grayValues({ channels, top, data }) {
  if (channels !== 1) throw new Error("a mask that is not gray");
  return top === 255 ? data : Uint8Array.from(data, (value) => roundedEven(fround(value / 257)));
}

function roundedEven(value) {
  const low = Math.floor(value);
  const part = value - low;
  return part > 0.5 || (part === 0.5 && low % 2 === 1) ? low + 1 : low;
}

async function paintOf(from, files, width, height, channels, count) {
  if (from === null) return new Uint16Array(4 * width * height);
  if (from.values) return valuesOf(from.values);
  const picture = await decodePng(bytesOf(files[from.file].base64));
  const paint = convertedPaint(picture, await valuesOf(from.curves), from);
  if (from.lobes) takeLobesOff(paint, from, channels, count);
  return paint;
}

// raster.Conversion: curves, then the matrix, in float32. A product is added before it is rounded, as the library
// does that multiplies matrices, but where all of some rows is of one colour.
function convertedPaint({ width, height, channels, alpha, top, data }, curves, { matrix, scale, rows }) {
  const paint = new Uint16Array(4 * width * height);
  const pairs = new Uint32Array(paint.buffer); // two half floats each, so that a texel is copied in two steps
  const colours = alpha ? channels - 1 : channels;
  const values = top + 1;
  const stride = curves.length / values > 1 ? values : 0;
  const one = halfOf(1);
  const xyz = new Float32Array(3);
  const light = new Float32Array(3);
  // Where a colour of three bytes was converted last: artwork repeats its colours.
  const cached = channels === 3 && top === 255;
  const keys = new Int32Array(KEPT_COLOURS);
  const places = new Int32Array(KEPT_COLOURS);
  for (let first = 0; first < height; first += rows) {
    const begin = first * width;
    const end = Math.min(first + rows, height) * width;
    const joined = !isEven(data, begin, end, channels, colours);
    keys.fill(-1);
    for (let n = begin; n < end; n++) {
      const at = n * channels;
      let slot = 0;
      if (cached) {
        const key = (data[at] << 16) | (data[at + 1] << 8) | data[at + 2];
        slot = Math.imul(key, 0x9e3779b1) >>> KEPT_SHIFT;
        if (keys[slot] === key) {
          pairs[2 * n] = pairs[2 * places[slot]];
          pairs[2 * n + 1] = pairs[2 * places[slot] + 1];
          continue;
        }
        keys[slot] = key;
        places[slot] = n;
      } else if (n > begin && isSame(data, at, at - channels, channels)) {
        pairs[2 * n] = pairs[2 * n - 2];
        pairs[2 * n + 1] = pairs[2 * n - 1];
        continue;
      }
      for (let c = 0; c < colours; c++) light[c] = curves[c * stride + data[at + c]];
      for (let k = 0; k < 3; k++) {
        let sum = fround(light[0] * matrix[k]);
        for (let c = 1; c < colours; c++) {
          const product = light[c] * matrix[3 * c + k];
          sum = fround((joined ? product : fround(product)) + sum);
        }
        xyz[k] = fround(sum * scale[k]);
      }
      const share = alpha ? fround(data[at + colours] / top) : 1;
      for (let k = 0; k < 3; k++) {
        const number = alpha ? fround(xyz[k] * share) : xyz[k];
        paint[4 * n + k] = halfOf(Math.min(number, LARGEST_PAINT));
      }
      paint[4 * n + 3] = alpha ? halfOf(share) : one;
    }
  }
  return paint;
}

function isSame(data, a, b, count) {
  for (let c = 0; c < count; c++) if (data[a + c] !== data[b + c]) return false;
  return true;
}

function isEven(data, begin, end, channels, colours) {
  for (let n = begin + 1; n < end; n++) if (!isSame(data, n * channels, begin * channels, colours)) return false;
  return true;
}

// layers._level_0: the finishes' lobes that are inside the artwork's colours, by their shares.
function takeLobesOff(paint, { lobes, specular_channel: places }, channels, count) {
  const numbers = numbersOfHalves();
  const finishes = places.length;
  const shares = new Float32Array(finishes);
  for (let n = 0; 4 * n < paint.length; n++) {
    let sum = 0;
    for (let f = 0; f < finishes; f++) {
      shares[f] = places[f] >= 0 ? fround(channels[n * count + places[f]] / 255) : 0;
      sum = fround(sum + shares[f]);
    }
    for (let f = 0; f < finishes; f++) if (places[f] === -1) shares[f] = Math.max(fround(1 - sum), 0);
    const alpha = numbers[paint[4 * n + 3]];
    for (let k = 0; k < 3; k++) {
      let lobe = fround(shares[0] * lobes[k]);
      for (let f = 1; f < finishes; f++) lobe = fround(shares[f] * lobes[3 * f + k] + lobe);
      const left = fround(numbers[paint[4 * n + k]] - fround(alpha * lobe));
      paint[4 * n + k] = halfOf(Math.max(left, 0));
    }
  }
}

// Level 0 as what the next levels are means of: half floats by their bits; shares count 255 there, and 1 further down.
function started({ width, height, paint, channels }) {
  return { width, height, paint, table: numbersOfHalves(), shares: channels, scale: fround(1 / 255) };
}

function halvedLevel({ width, height, paint, table, shares, scale }, count) {
  const means = count ? halved(shares, width, height, count) : new Float32Array(0);
  if (scale !== 1) for (let n = 0; n < means.length; n++) means[n] *= scale;
  const [across, down] = [Math.ceil(width / 2), Math.ceil(height / 2)];
  const light = halved(paint, width, height, 4, table);
  return { width: across, height: down, paint: light, table: null, shares: means, scale: 1 };
}

function stored({ width, height, paint, shares }, count, groups) {
  return { width, height, paint: halvesOf(paint), channels: quantised(shares, width * height, count, groups) };
}

/** Texels, `count` numbers each, at half the size: layers.halved. table: of numbers that texels stand for. */
export function halved(texels, width, height, count, table = null) {
  const [across, down] = [halvedSide(width), halvedSide(height)];
  const line = width * count;
  const out = new Float32Array(across.length * down.length * count);
  const row = new Float32Array(line);
  const kept = [0, 1, 2].map(() => new Float32Array(line));
  const even = width % 2 === 0;
  down.forEach(({ from, weights }, y) => {
    const lines = from.map((place, k) => lineOf(texels, place * line, kept[k], table));
    mixedRows(row, lines, weights);
    const part = out.subarray(y * across.length * count, (y + 1) * across.length * count);
    if (even) halvedEvenly(part, row, count);
    else halvedRow(part, row, count, across);
  });
  return out;
}

// A row of texels as float32.
function lineOf(texels, first, kept, table) {
  if (texels instanceof Float32Array) return texels.subarray(first, first + kept.length);
  if (table) for (let n = 0; n < kept.length; n++) kept[n] = table[texels[first + n]];
  else kept.set(texels.subarray(first, first + kept.length));
  return kept;
}

function halvedEvenly(out, row, count) {
  for (let n = 0, from = 0; n < out.length; from += count) {
    for (let c = 0; c < count; c++, n++, from++) out[n] = fround(fround(0.5 * row[from]) + fround(0.5 * row[from + count]));
  }
}

function halvedRow(out, row, count, across) {
  for (let x = 0; x < across.length; x++) {
    const { from, weights } = across[x];
    for (let c = 0; c < count; c++) {
      let sum = fround(weights[0] * row[from[0] * count + c]);
      for (let k = 1; k < weights.length; k++) sum = fround(sum + fround(weights[k] * row[from[k] * count + c]));
      out[x * count + c] = sum;
    }
  }
}

function mixedRows(row, [first, second, third], [a, b, c]) {
  if (third) {
    for (let n = 0; n < row.length; n++) {
      row[n] = fround(fround(fround(a * first[n]) + fround(b * second[n])) + fround(c * third[n]));
    }
  } else if (second) {
    for (let n = 0; n < row.length; n++) row[n] = fround(fround(a * first[n]) + fround(b * second[n]));
  } else {
    for (let n = 0; n < row.length; n++) row[n] = fround(a * first[n]);
  }
}

// Of each new texel of a side: the old ones that it covers, and their weights.
function halvedSide(side) {
  if (side === 1) return [{ from: [0], weights: [1] }];
  const count = Math.ceil(side / 2);
  const size = side / count;
  return Array.from({ length: count }, (_, n) => {
    if (side % 2 === 0) return { from: [2 * n, 2 * n + 1], weights: [0.5, 0.5] };
    const first = n * size;
    const places = [0, 1, 2].map((k) => Math.floor(first) + k);
    const weights = places.map((at) => {
      const covered = Math.min(at + 1, first + size) - Math.max(at, first);
      return fround(Math.min(Math.max(covered, 0), 1) / size);
    });
    return { from: places.map((at) => Math.min(at, side - 1)), weights };
  });
}

/** Shares in steps of 1/255, each group of channels adding up to at most 1: layers._quantised. */
export function quantised(shares, texels, count, groups) {
  const steps = new Uint8Array(texels * count);
  for (const group of groups) {
    for (let n = 0; n < texels; n++) {
      let total = 0;
      let before = 0;
      for (const channel of group) {
        total = fround(total + shares[n * count + channel]);
        const now = roundedEven(fround(Math.min(total, 1) * 255));
        steps[n * count + channel] = now - before;
        before = now;
      }
    }
  }
  return steps;
}
