// PNG files as samples, exactly: no canvas and no colour management comes between. ISO/IEC 15948.
// Without interlace, transparent colours and orientation, as relgloss_view/proof/layers_drawing.py has them.

import { inflated } from "./arrays.js";

const PNG_CHANNELS = { 0: 1, 2: 3, 3: 1, 4: 2, 6: 4 };

/** The samples of a PNG: {width, height, channels, alpha, top, data}; data of 8 or 16 bits, of which `top` is 1. */
export async function decodePng(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const parts = [];
  let head = null;
  let palette = null;
  let clear = null;
  for (let at = 8; at + 12 <= bytes.length; ) {
    const size = view.getUint32(at);
    const kind = String.fromCharCode(...bytes.subarray(at + 4, at + 8));
    const data = bytes.subarray(at + 8, at + 8 + size);
    if (kind === "IHDR") head = new DataView(data.slice().buffer);
    if (kind === "PLTE") palette = data;
    if (kind === "tRNS") clear = data;
    if (kind === "IDAT") parts.push(data);
    at += 12 + size;
  }
  const [width, height] = [head.getUint32(0), head.getUint32(4)];
  const [depth, colour, interlaced] = [head.getUint8(8), head.getUint8(9), head.getUint8(12)];
  if (interlaced || (clear && colour !== 3)) throw new Error("a PNG that the page does not read");
  const perPixel = PNG_CHANNELS[colour];
  const line = Math.ceil((width * perPixel * depth) / 8);
  const lines = await inflated(joinedBytes(parts), height * (line + 1));
  const rows = unfiltered(lines, height, line, Math.max(1, (perPixel * depth) >> 3));
  const flat = depth === 16 ? wideSamples(rows) : depth === 8 ? rows : spreadSamples(rows, height, line, width, depth);
  if (colour === 3) return ofPalette(flat, width, height, palette, clear);
  const few = 2 ** depth - 1;
  const data = depth < 8 ? flat.map((value) => Math.round((value * 255) / few)) : flat;
  return { width, height, channels: perPixel, alpha: colour >= 4, top: depth === 16 ? 65535 : 255, data };
}

function joinedBytes(parts) {
  const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

// The five filters, undone; `step` is the distance in bytes to the pixel on the left.
function unfiltered(data, height, line, step) {
  const rows = new Uint8Array(height * line);
  let before = new Uint8Array(line);
  for (let y = 0; y < height; y++) {
    const filter = data[y * (line + 1)];
    const coded = data.subarray(y * (line + 1) + 1, (y + 1) * (line + 1));
    const row = rows.subarray(y * line, (y + 1) * line);
    if (filter > 4) throw new Error("a damaged PNG");
    if (filter === 0) row.set(coded);
    else if (filter === 2) for (let k = 0; k < line; k++) row[k] = coded[k] + before[k];
    else for (let first = 0; first < step; first++) unfilteredBytes(row, coded, before, filter, first, step);
    before = row;
  }
  return rows;
}

// One byte of each pixel of a row, by the filters that look to the left.
function unfilteredBytes(row, coded, before, filter, first, step) {
  let a = 0; // on the left
  let c = 0; // above it
  if (filter === 1) {
    for (let k = first; k < row.length; k += step) row[k] = a = (coded[k] + a) & 255;
  } else if (filter === 3) {
    for (let k = first; k < row.length; k += step) row[k] = a = (coded[k] + ((a + before[k]) >> 1)) & 255;
  } else {
    for (let k = first; k < row.length; k += step) {
      const b = before[k];
      const pa = Math.abs(b - c);
      const pb = Math.abs(a - c);
      const pc = Math.abs(a + b - 2 * c);
      row[k] = a = (coded[k] + (pa <= pb && pa <= pc ? a : pb <= pc ? b : c)) & 255;
      c = b;
    }
  }
}

function wideSamples(rows) {
  const wide = new Uint16Array(rows.length / 2);
  for (let k = 0; k < wide.length; k++) wide[k] = (rows[2 * k] << 8) | rows[2 * k + 1];
  return wide;
}

function spreadSamples(rows, height, line, width, depth) {
  const samples = new Uint8Array(height * width);
  const mask = 2 ** depth - 1;
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const bit = x * depth;
      samples[y * width + x] = (rows[y * line + (bit >> 3)] >> (8 - depth - (bit & 7))) & mask;
    }
  }
  return samples;
}

function ofPalette(flat, width, height, palette, clear) {
  const channels = clear ? 4 : 3;
  const data = new Uint8Array(width * height * channels);
  for (let k = 0; k < flat.length; k++) {
    const entry = flat[k];
    for (let c = 0; c < 3; c++) data[channels * k + c] = palette[3 * entry + c];
    if (clear) data[channels * k + 3] = entry < clear.length ? clear[entry] : 255;
  }
  return { width, height, channels, alpha: Boolean(clear), top: 255, data };
}
