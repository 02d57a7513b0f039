// Shader files to the text of a stage. The twin of picture/gpu/shader.py, with the header of WebGL 2.

import { activeLines } from "./preprocessor.js";

const HANDED_ON = "all_"; // before the name of a number that the vertex stage hands on
const FILL_VERTEX = "fill.vert";
const OWN_VERTEX = {
  "coverage.frag": "tiles.vert",
  "edge.frag": "edge.vert",
  "mesh.frag": "mesh.vert",
  "mesh_places.frag": "mesh_places.vert",
};
// Instead of "#version 330 core": the desktop's shaders are as precise by themselves.
const HEADER = [
  "#version 300 es",
  "precision highp float;",
  "precision highp int;",
  "precision highp sampler2D;",
  "precision highp sampler3D;",
  "precision highp usampler2D;",
];
// A number of the whole picture; longer arrays than two stay with the fragments.
const UNIFORM = /^uniform\s+((?:float|int|uint|[iu]?vec[234]|mat3))\s+(\w+)(\[[12]\])?\s*;/;
const INCLUDE = /^\s*#include\s+"([^"]+)"\s*$/;
const PLACE = /\b(\d+)(?::|\()(\d+)\)?/;

function wordsReadTwice(lines) {
  const once = new Set();
  const twice = new Set();
  for (const line of lines) {
    for (const word of line.replace(/\/\/.*/, "").match(/[A-Za-z_]\w*/g) ?? []) {
      (once.has(word) ? twice : once).add(word);
    }
  }
  return twice;
}

/** The name of a uniform without the mark of those that are handed on. */
export function ownName(name) {
  const plain = name.replace(/\[0\]$/, "");
  return plain.startsWith(HANDED_ON) ? plain.slice(HANDED_ON.length) : plain;
}

/** A stage that can't be composed or compiled; the message names file and line. */
export class ShaderError extends Error {}

/**
 * One stage with its includes resolved. `text` goes to the compiler, `vertex` is the stage that
 * goes with it, and `explain` turns the compiler's log into file names and lines.
 *
 * texts: shader files by name. definitions: lines that define every constant. most: vectors that
 * the vertex stage may hand on; uniforms beyond them stay with the fragments. source: the stage's
 * own text, where it is no file.
 */
export class ShaderSource {
  constructor({ texts, definitions, name, defines = {}, most = 0, source = null }) {
    this.name = name;
    this.files = [];
    this._texts = texts;
    this._shared = { texts, definitions, defines };
    const body = this._resolve(name, [], source);
    const end = body.indexOf("\n");
    if (!body.startsWith("#version")) throw new ShaderError(`${name}: line 1: no #version`);
    const keys = Object.keys(defines).sort();
    const constants = keys.map((key) => `#define ${key} ${defines[key]}`);
    const head = [...HEADER, ...definitions, ...constants, "#line 2 0"];
    const lines = activeLines([...head, ...body.slice(end + 1).split("\n")]);
    this._handedOn = []; // [type, name, array]
    let left = name.endsWith(".frag") ? most : 0;
    const read = wordsReadTwice(lines); // what is only declared would stay a uniform of the vertices
    const handed = lines.map((line) => {
      const match = UNIFORM.exec(line);
      if (match === null || !name.endsWith(".frag")) return line;
      const [whole, kind, uniform, array = ""] = match;
      const vectors = (kind === "mat3" ? 3 : 1) * (array ? Number(array[1]) : 1);
      if (vectors > left || !read.has(uniform)) return line;
      left -= vectors;
      this._handedOn.push([kind, uniform, array]);
      return `flat in ${kind} ${uniform}${array};${line.slice(whole.length)}`;
    });
    this.text = handed.join("\n") + "\n";
  }

  /** The vertex stage that goes with this fragment stage. */
  get vertex() {
    const declared = this._handedOn.map(
      ([kind, name, array]) =>
        `uniform ${kind} ${HANDED_ON}${name}${array}; flat out ${kind} ${name}${array};`,
    );
    const assigned = this._handedOn.map(([, name]) => `${name} = ${HANDED_ON}${name};`);
    const own = OWN_VERTEX[this.name] ?? FILL_VERTEX;
    const stage = new ShaderSource({ ...this._shared, name: own });
    return stage.text
      .replace("//@declare", () => declared.join("\n"))
      .replace("//@hand-on", () => assigned.join("\n"));
  }

  /** The compiler's log with file names in the place of source numbers. */
  explain(log) {
    const lines = String(log ?? "").split("\n").map((line) => line.trim());
    const named = lines
      .filter((line) => /error|warning/i.test(line))
      .map((line) =>
        line.replace(PLACE, (_, file, number) => `${this.files[file] ?? this.name}:${number}`),
      );
    return named.join("; ") || lines.join("; ");
  }

  _resolve(name, trail, source = null) {
    if (trail.includes(name)) {
      throw new ShaderError(`${name}: includes itself by way of ${trail.join(" > ")}`);
    }
    const text = source ?? this._texts[name];
    if (text === undefined) {
      const wanted = trail.length ? ` (included by ${trail[trail.length - 1]})` : "";
      throw new ShaderError(`${name}${wanted}: no such shader file`);
    }
    const index = this.files.length;
    this.files.push(name);
    const lines = text.replace(/\n$/, "").split("\n");
    return lines
      .map((line, k) => {
        const match = INCLUDE.exec(line);
        if (match === null) return line;
        if (this.files.includes(match[1]) && !trail.includes(match[1])) return "";
        const begin = `#line 1 ${this.files.length}`;
        const body = this._resolve(match[1], [...trail, name]);
        return `${begin}\n${body}\n#line ${k + 2} ${index}`;
      })
      .join("\n");
  }
}
