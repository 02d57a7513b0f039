// Arrays of a proof: the way back from proof/arrays.py.

import { Unsupported } from "./device.js";

const ARRAY_KINDS = {
  Uint8: Uint8Array,
  Uint16: Uint16Array,
  Uint32: Uint32Array,
  Int32: Int32Array,
  Float32: Float32Array,
  Float64: Float64Array,
};

/** The bytes of a text in base64. */
export function bytesOf(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k++) bytes[k] = text.charCodeAt(k);
  return bytes;
}

const MOST_INFLATED = 2 ** 28; // bytes of an array or a picture, beyond any that a proof holds

/**
 * The `length` bytes that were compressed as zlib does it. Throws where there are fewer or more: a
 * few kB can claim to be all of a machine's memory. Unsupported where the browser can't inflate.
 */
export async function inflated(bytes, length) {
  if (typeof DecompressionStream === "undefined") throw new Unsupported("no inflation");
  if (!(Number.isSafeInteger(length) && length >= 0 && length <= MOST_INFLATED)) {
    throw new Error("an array beyond all bounds");
  }
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate")).getReader();
  const whole = new Uint8Array(length);
  let at = 0;
  for (let { done, value } = await reader.read(); !done; { done, value } = await reader.read()) {
    if (at + value.length > length) {
      reader.cancel().catch(() => {});
      throw new Error("an array has the wrong length");
    }
    whole.set(value, at);
    at += value.length;
  }
  if (at !== length) throw new Error("an array has the wrong length");
  return whole;
}

/** An array of proof/arrays.py `packed`: {shape, values}, values a typed array, row by row. */
export async function unpacked(content) {
  const Kind = ARRAY_KINDS[content.dtype];
  const each = Kind.BYTES_PER_ELEMENT;
  const count = content.shape.reduce((product, side) => product * side, 1);
  const shuffled = await inflated(bytesOf(content.data), count * each);
  // Numbers are little-endian on every machine that has a browser of today.
  const bytes = new Uint8Array(count * each);
  for (let byte = 0; byte < each; byte++) {
    const from = byte * count;
    for (let k = 0; k < count; k++) bytes[k * each + byte] = shuffled[from + k];
  }
  return { shape: content.shape, values: new Kind(bytes.buffer) };
}

/** A copy of JSON with every packed array in it unpacked. */
export async function unpackedAll(value) {
  if (Array.isArray(value)) return Promise.all(value.map(unpackedAll));
  if (value === null || typeof value !== "object") return value;
  if (typeof value.data === "string" && value.dtype in ARRAY_KINDS && value.shape) {
    return unpacked(value);
  }
  const names = Object.keys(value);
  const parts = await Promise.all(names.map((name) => unpackedAll(value[name])));
  return Object.fromEntries(names.map((name, k) => [name, parts[k]]));
}
