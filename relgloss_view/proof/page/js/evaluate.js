// Calls the functions of a shader library over arrays. The twin of picture/gpu/evaluate.py.

const EVALUATED_WIDE = 1024;

/**
 * Run `body`, which sets `result`, for each row of the inputs; returns four numbers a row.
 *
 * includes: libraries. inputs: by name, {columns, values}: a typed array of N * columns numbers, a
 * vec4 in the shader, or a uvec4 of a Uint32Array. integers: `result` is a uvec4.
 */
export function evaluate(device, includes, body, inputs, { integers = false, defines = {} } = {}) {
  const names = Object.keys(inputs);
  const count = inputs[names[0]].values.length / inputs[names[0]].columns;
  const high = Math.max(1, Math.ceil(count / EVALUATED_WIDE));
  const kinds = names.map((name) => (inputs[name].values instanceof Uint32Array ? "u" : ""));
  const declared = names.map((name, k) => `uniform ${kinds[k]}sampler2D ${name}_values;`);
  const read = names.map(
    (name, k) => `${kinds[k]}vec4 ${name} = texelFetch(${name}_values, at, 0);`,
  );
  const source = device.texts["evaluate.frag"]
    .replace("//@include", includes.map((name) => `#include "${name}"`).join("\n"))
    .replace("//@declare", declared.join("\n"))
    .replace("//@read", read.join("\n"))
    .replace("//@body", body);
  const uniforms = {};
  names.forEach((name, k) => {
    const { columns, values } = inputs[name];
    const padded = new (kinds[k] ? Uint32Array : Float32Array)(4 * EVALUATED_WIDE * high);
    for (let row = 0; row < count; row++) {
      for (let c = 0; c < columns; c++) padded[4 * row + c] = values[columns * row + c];
    }
    const kind = kinds[k] ? "rgba32ui" : "rgba32f";
    uniforms[`${name}_values`] = device.texture(EVALUATED_WIDE, high, kind, padded);
  });
  const target = device.target([
    device.texture(EVALUATED_WIDE, high, integers ? "rgba32ui" : "rgba32f"),
  ]);
  const constants = { WIDTH: EVALUATED_WIDE, ...defines, ...(integers ? { INTEGERS: 1 } : {}) };
  try {
    device.draw({ stage: "evaluate.frag", defines: constants, uniforms, target, source });
    return device.read(target).slice(0, 4 * count);
  } finally {
    device.releaseTarget(target);
    for (const texture of Object.values(uniforms)) device.releaseTexture(texture);
  }
}
