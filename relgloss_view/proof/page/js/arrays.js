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

/** The bytes that were compressed as zlib does it; Unsupported in browsers that can't inflate. */
export async function inflated(bytes) {
  if (typeof DecompressionStream === "undefined") throw new Unsupported("no inflation");
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** An array of proof/arrays.py `packed`: {shape, values}, values a typed array, row by row. */
export async function unpacked(content) {
  const Kind = ARRAY_KINDS[content.dtype];
  const shuffled = await inflated(bytesOf(content.data));
  const each = Kind.BYTES_PER_ELEMENT;
  const count = content.shape.reduce((product, side) => product * side, 1);
  if (shuffled.length !== count * each) throw new Error("an array has the wrong length");
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
