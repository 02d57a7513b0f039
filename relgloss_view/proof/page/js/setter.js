// How a uniform of each type is set.

import { ShaderError } from "./shader.js";

/** Set a uniform of a program that is used: numbers, matrices column by column. */
export function setUniform(gl, { type, size, location, name }, value) {
  const values = typeof value === "number" ? [value] : value;
  const floats = {
    [gl.FLOAT]: [1, "uniform1fv"],
    [gl.FLOAT_VEC2]: [2, "uniform2fv"],
    [gl.FLOAT_VEC3]: [3, "uniform3fv"],
    [gl.FLOAT_VEC4]: [4, "uniform4fv"],
    [gl.INT]: [1, "uniform1iv"],
    [gl.BOOL]: [1, "uniform1iv"],
    [gl.INT_VEC2]: [2, "uniform2iv"],
    [gl.INT_VEC3]: [3, "uniform3iv"],
    [gl.INT_VEC4]: [4, "uniform4iv"],
    [gl.UNSIGNED_INT]: [1, "uniform1uiv"],
    [gl.UNSIGNED_INT_VEC2]: [2, "uniform2uiv"],
    [gl.UNSIGNED_INT_VEC3]: [3, "uniform3uiv"],
    [gl.UNSIGNED_INT_VEC4]: [4, "uniform4uiv"],
  };
  const square = { [gl.FLOAT_MAT2]: [4, "uniformMatrix2fv"], [gl.FLOAT_MAT3]: [9, "uniformMatrix3fv"] };
  const [each, setter] = floats[type] ?? square[type] ?? [0, ""];
  // Drivers cut an array to the elements that the variant reads.
  const cut = Array.from(values).slice(0, each * size);
  if (each === 0 || cut.length < each * size) {
    throw new ShaderError(`uniform '${name}' has ${values.length} numbers`);
  }
  if (type in square) gl[setter](location, false, cut);
  else gl[setter](location, cut);
}
