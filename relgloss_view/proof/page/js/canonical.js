// What a proof is known by: canonical JSON (RFC 8785), SHA-256, the thread's digests, the seal of
// the page and the name of what was changed, signatures. Twin: page/parts.py, proof.py, keys.py.

export const FORMAT = "relgloss-proof";
export const VERSION = 1;
const MARK = '<meta name="relgloss-proof" content="';
const SEAL = '<meta name="relgloss-seal" content="';
const UNSEALED = "0".repeat(64);
const BLOCKS = ["proof", "signatures", "shaders", "words", "parts"];
const END = "<\/script>"; // written so that it doesn't end this one
const PARTS = ["head", "style", "static", ...BLOCKS, "script"];
const MARKERS = [
  "<style>",
  "</style></head><body>\n",
  ...BLOCKS.map((name, k) =>
    `${k ? END : ""}\n<script type="application/json" id="${name}">`),
  `${END}\n<script>`,
  `${END}</body></html>`,
];
const DIVIDED = ["files", "pictures"];
const DIGITS = 16;

/** JSON as RFC 8785 writes it. Throws TypeError for what JSON can't hold. */
export function canonical(value) {
  if (value === null || typeof value === "boolean") return String(value);
  if (typeof value === "number") {
    if (!Number.isFinite(value)) throw new TypeError("a number that isn't finite");
    return String(value === 0 ? 0 : value);
  }
  if (typeof value === "string") return canonicalText(value);
  if (Array.isArray(value)) return `[${value.map(canonical).join(",")}]`;
  if (typeof value !== "object") throw new TypeError(`a value of type ${typeof value}`);
  // Array.sort compares UTF-16 code units, as the RFC asks.
  const entries = Object.keys(value).sort().map((key) =>
    `${canonicalText(key)}:${canonical(value[key])}`);
  return `{${entries.join(",")}}`;
}

function canonicalText(text) {
  if (/[\ud800-\udbff](?![\udc00-\udfff])|(?<![\ud800-\udbff])[\udc00-\udfff]/.test(text)) {
    throw new TypeError("a text with half of a surrogate pair");
  }
  return JSON.stringify(text);
}

/** JSON that no HTML ends early. */
export function scriptJson(value) {
  return canonical(value).replaceAll("<", "\\u003c");
}

/** First `bits` of the fractional part of the n-th root of the first primes, exactly. */
function rootsOfPrimes(count, root) {
  const words = [];
  for (let n = 2; words.length < count; n++) {
    let prime = true;
    for (let k = 2; k * k <= n; k++) prime &&= n % k !== 0;
    if (!prime) continue;
    const power = BigInt(root), target = BigInt(n) << (32n * power);
    let low = 0n, high = 1n << 40n;
    while (high - low > 1n) {
      const middle = (low + high) >> 1n;
      if (middle ** power <= target) low = middle;
      else high = middle;
    }
    words.push(Number(low & 0xffffffffn));
  }
  return words;
}

const SHA_BEGIN = new Uint32Array(rootsOfPrimes(8, 2));
const SHA_ROUNDS = new Uint32Array(rootsOfPrimes(64, 3));

/**
 * SHA-256 (FIPS 180-4) that can be copied on its way. The browser's own is not there on http and
 * can't be copied.
 */
export class Sha256 {
  constructor() {
    this.state = SHA_BEGIN.slice();
    this.rest = new Uint8Array(64);
    this.length = 0;
    this.words = new Uint32Array(64);
  }

  copy() {
    const other = new Sha256();
    other.state.set(this.state);
    other.rest.set(this.rest);
    other.length = this.length;
    return other;
  }

  /** Adds a text, as UTF-8, or bytes. */
  update(data) {
    const bytes = typeof data === "string" ? new TextEncoder().encode(data) : data;
    let filled = this.length % 64, position = 0;
    this.length += bytes.length;
    if (filled) {
      position = Math.min(64 - filled, bytes.length);
      this.rest.set(bytes.subarray(0, position), filled);
      filled += position;
      if (filled < 64) return this;
      this.#block(this.rest, 0);
    }
    for (; position + 64 <= bytes.length; position += 64) this.#block(bytes, position);
    this.rest.set(bytes.subarray(position));
    return this;
  }

  /** The digest, 32 bytes; the hash can go on afterwards. */
  digest() {
    const end = this.copy(), filled = this.length % 64;
    const padding = new Uint8Array((filled < 56 ? 64 : 128) - filled);
    padding[0] = 0x80;
    const view = new DataView(padding.buffer), bits = this.length * 8;
    view.setUint32(padding.length - 8, Math.floor(bits / 2 ** 32));
    view.setUint32(padding.length - 4, bits >>> 0);
    end.update(padding);
    const bytes = new Uint8Array(32), out = new DataView(bytes.buffer);
    end.state.forEach((word, k) => out.setUint32(4 * k, word));
    return bytes;
  }

  hex() {
    return hexOf(this.digest());
  }

  #block(bytes, at) {
    const w = this.words, s = this.state;
    for (let i = 0, j = at; i < 16; i++, j += 4) {
      w[i] = (bytes[j] << 24) | (bytes[j + 1] << 16) | (bytes[j + 2] << 8) | bytes[j + 3];
    }
    for (let i = 16; i < 64; i++) {
      const x = w[i - 15], y = w[i - 2];
      const first = ((x >>> 7) | (x << 25)) ^ ((x >>> 18) | (x << 14)) ^ (x >>> 3);
      const second = ((y >>> 17) | (y << 15)) ^ ((y >>> 19) | (y << 13)) ^ (y >>> 10);
      w[i] = w[i - 16] + first + w[i - 7] + second;
    }
    let a = s[0], b = s[1], c = s[2], d = s[3], e = s[4], f = s[5], g = s[6], h = s[7];
    for (let i = 0; i < 64; i++) {
      const up = ((e >>> 6) | (e << 26)) ^ ((e >>> 11) | (e << 21)) ^ ((e >>> 25) | (e << 7));
      const one = (h + up + ((e & f) ^ (~e & g)) + SHA_ROUNDS[i] + w[i]) | 0;
      const turn = ((a >>> 2) | (a << 30)) ^ ((a >>> 13) | (a << 19)) ^ ((a >>> 22) | (a << 10));
      const two = (turn + ((a & b) ^ (a & c) ^ (b & c))) | 0;
      h = g;
      g = f;
      f = e;
      e = (d + one) | 0;
      d = c;
      c = b;
      b = a;
      a = (one + two) | 0;
    }
    s[0] += a;
    s[1] += b;
    s[2] += c;
    s[3] += d;
    s[4] += e;
    s[5] += f;
    s[6] += g;
    s[7] += h;
  }
}

export function hexOf(bytes) {
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

export function bytesOfHex(hex) {
  return Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));
}

export function sha256(data) {
  return new Sha256().update(data).hex();
}

const shortHash = (text) => sha256(text).slice(0, DIGITS);

/** SHA-256 of the proofs of a thread, one a message; the last is the name of the proof. */
export function digestsOf(proof) {
  const begun = new Sha256().update(`{"content":${canonical(proof.content)},"format":`);
  begun.update(`${canonical(proof.format)},"messages":[`);
  return proof.messages.map((message, k) => {
    begun.update((k ? "," : "") + canonical(message));
    return begun.copy().update(`],"version":${canonical(proof.version)}}`).hex();
  });
}

/** The page as it was sent. Only right before anything of it is changed. */
export function pageText() {
  return `<!DOCTYPE html>\n${document.documentElement.outerHTML}`;
}

/** The texts of PARTS; throws an Error whose message is the part whose end is missing. */
export function splitPage(html) {
  const texts = {};
  let position = 0;
  PARTS.forEach((name, k) => {
    const end = html.indexOf(MARKERS[k], position);
    if (end < 0) throw new Error(name);
    texts[name] = html.slice(position, end);
    position = end + MARKERS[k].length;
  });
  if (position < html.length) throw new Error("script");
  for (const mark of [MARK, SEAL]) {
    const stated = statedAt(texts.head, mark);
    if (stated) texts.head = texts.head.replace(mark + stated, mark + UNSEALED);
  }
  return texts;
}

/** The texts that are there, of a page whose markup was changed: by an extension, for instance. */
function splitLoosely(html) {
  const texts = {};
  const begins = Object.fromEntries(BLOCKS.map((name) =>
    [name, `<script type="application/json" id="${name}">`]));
  for (const [name, begin] of
    Object.entries({ ...begins, style: "<style>", script: "\n<script>" })) {
    const start = html.indexOf(begin);
    const end = html.indexOf(name === "style" ? "</style>" : END, start + begin.length);
    if (start >= 0 && end >= 0) texts[name] = html.slice(start + begin.length, end);
  }
  return texts;
}

function statedAt(html, mark) {
  const at = html.indexOf(mark);
  const stated = at < 0 ? "" : html.slice(at + mark.length, at + mark.length + 65);
  return /^[0-9a-f]{64}"$/.test(stated) ? stated.slice(0, 64) : "";
}

function joinPage(texts, digest) {
  const whole = { ...texts, parts: scriptJson(manifestOf(texts)) };
  const html = PARTS.map((name, k) => whole[name] + MARKERS[k]).join("")
    .replace(MARK + UNSEALED, MARK + digest);
  return html.replace(SEAL + UNSEALED, SEAL + sha256(html));
}

function manifestOf(texts) {
  const [names] = partHashes(texts);
  return { ...names, parts: shortHash(canonical(names)) };
}

/** [16 digits a part, the blocks that aren't written as a proof's are]. */
function partHashes(texts) {
  const names = {}, wrong = [];
  for (const name of PARTS) {
    if (name in texts && !["proof", "shaders", "parts"].includes(name)) names[name] = shortHash(texts[name]);
  }
  for (const [block, divide] of [["shaders", entriesOfShaders], ["proof", entriesOfProof]]) {
    let whole = false;
    try {
      const values = JSON.parse(texts[block]);
      for (const [name, value] of divide(values)) names[name] = shortHash(canonical(value));
      whole = scriptJson(values) === texts[block];
    } catch {
      // Not JSON, or not of a proof.
    }
    if (!whole) wrong.push(block);
  }
  return [names, wrong];
}

function entriesOfShaders(files) {
  return Object.entries(files).map(([name, text]) => [`shaders/${name}`, text]);
}

function entriesOfProof(proof) {
  const found = [];
  for (const [name, value] of Object.entries(proof.content)) {
    const divided = DIVIDED.includes(name) && value !== null && typeof value === "object"
      && !Array.isArray(value);
    if (!divided) found.push([`content/${name}`, value]);
    else {
      for (const [key, entry] of Object.entries(value)) {
        found.push([`content/${name}/${key}`, entry]);
      }
    }
  }
  proof.messages.forEach((message, k) => {
    for (const [name, value] of Object.entries(message)) {
      found.push([`messages/${k + 1}/${name}`, value]);
    }
  });
  return found;
}

/**
 * What a page's text holds, and what of it was changed:
 * {changes: [part, ...], readable: whether the sealed JSON is whole, newer, proof, signatures,
 * shaders, words, digests, digest}. Nothing is drawn where changes is not empty, before a click; and
 * never where readable is false.
 */
export function checkPage(html) {
  const seal = statedAt(html, SEAL), name = statedAt(html, MARK);
  const sealed = seal !== "" && sha256(html.replace(SEAL + seal, SEAL + UNSEALED)) === seal;
  const result = {
    changes: [], readable: false, newer: false, proof: null, signatures: [], shaders: {},
    words: {}, digests: [], digest: name,
  };
  let texts;
  try {
    texts = splitPage(html);
  } catch {
    texts = splitLoosely(html);
  }
  try {
    result.proof = JSON.parse(texts.proof);
    result.newer = result.proof.format === FORMAT && result.proof.version > VERSION;
    result.digests = digestsOf(result.proof);
    result.readable = name !== "" && result.digests.at(-1) === name
      && scriptJson(result.proof) === texts.proof && followsThread(result.proof, result.digests);
  } catch {
    result.readable = false;
  }
  for (const block of ["signatures", "shaders", "words"]) {
    try {
      result[block] = JSON.parse(texts[block]);
    } catch {
      // The manifest names it.
    }
  }
  if (!sealed || !result.readable) result.changes = changedParts(texts, result.readable, sealed);
  return result;
}

function changedParts(texts, readable, sealed) {
  let noted;
  try {
    const { parts, ...names } = JSON.parse(texts.parts);
    if (shortHash(canonical(names)) !== parts || scriptJson({ ...names, parts }) !== texts.parts) {
      return ["parts"];
    }
    noted = names;
  } catch {
    return ["parts"];
  }
  const broken = !("head" in texts);
  if (broken) for (const name of ["head", "static"]) delete noted[name];
  const [now, wrong] = partHashes(texts);
  let named = Object.keys(noted).filter((name) => noted[name] !== now[name]);
  if (!named.length) named = Object.keys(now).filter((name) => !(name in noted));
  for (const [block, begins] of [["shaders", /^shaders\//], ["proof", /^(content|messages)\//]]) {
    if (wrong.includes(block) && !Object.keys(now).some((name) => begins.test(name))) {
      named = named.filter((name) => !begins.test(name));
    }
  }
  if (named.length || wrong.length || broken) {
    return [...named, ...wrong, ...(broken ? ["page"] : [])];
  }
  return [readable && !sealed ? "seal" : "name"];
}

/** Whether each message names the proof that ends with the one before it. */
export function followsThread(proof, digests) {
  return proof.messages.length > 0 && proof.messages.every((message, k) =>
    k === 0 || message.parent === digests[k - 1]);
}

/** A changed part as [key of the words, their values]. */
export function wordsOfPart(part) {
  const [kind, first = "", ...rest] = part.split("/");
  if (kind === "messages" && rest.length) {
    return ["part.message", { number: first, entry: rest.join("/") }];
  }
  if (kind === "shaders" && first) return ["part.shader", { name: [first, ...rest].join("/") }];
  if (kind === "content" && rest.length) {
    return [first === "pictures" ? "part.picture" : "part.file", { name: rest.join("/") }];
  }
  if (kind === "content") return ["part.entry", { name: first }];
  return [PARTS.includes(part) || part === "seal" || part === "page" ? `part.${part}` : "part.name", {}];
}

/**
 * The page of the reply with a message, byte for byte as Python writes it. message: its JSON, whose
 * parent is set here. html: pageText() of a page without changes.
 */
export function withMessage(html, message) {
  const texts = splitPage(html), proof = JSON.parse(texts.proof);
  const parent = digestsOf(proof).at(-1);
  const answer = { ...proof, messages: [...proof.messages, { ...message, parent }] };
  return joinPage({ ...texts, proof: scriptJson(answer) }, digestsOf(answer).at(-1));
}

/** A key's fingerprint, in groups that people can compare by telephone. */
export function fingerprint(key) {
  if (!/^[0-9a-f]{64}$/.test(key)) return "";
  return sha256(bytesOfHex(key)).slice(0, 32).toUpperCase().match(/..../g).join(" ");
}

/**
 * Who signed which message: [{message, key, fingerprint, state}], state "right", "wrong", or
 * "unchecked" where this browser can't check signatures. A right one shows that the key's owner has
 * signed, and not who that is.
 */
export async function checkSignatures(digests, signatures) {
  const checked = [];
  for (const { message, key, signature } of signatures) {
    let state = "unchecked";
    if (!/^[0-9a-f]{64}$/.test(key) || !/^[0-9a-f]{128}$/.test(signature) || !digests[message]) {
      state = "wrong";
    } else if (globalThis.crypto?.subtle) {
      try {
        const known = await crypto.subtle.importKey(
          "raw", bytesOfHex(key), { name: "Ed25519" }, false, ["verify"]);
        const right = await crypto.subtle.verify(
          { name: "Ed25519" }, known, bytesOfHex(signature), bytesOfHex(digests[message]));
        state = right ? "right" : "wrong";
      } catch (error) {
        // A browser that knows Ed25519 refuses keys that are no points of the curve.
        state = error.name === "DataError" ? "wrong" : "unchecked";
      }
    }
    checked.push({ message, key, fingerprint: fingerprint(key), state });
  }
  return checked;
}
