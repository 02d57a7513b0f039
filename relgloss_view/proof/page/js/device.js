// The browser's graphics: programs, textures, targets and drawing, on one WebGL 2 context.

import { setUniform } from "./setter.js";
import { ShaderError, ShaderSource, ownName } from "./shader.js";

/** A browser that can't draw; reason is "no webgl2", "no float targets" or "no inflation". */
export class Unsupported extends Error {
  constructor(reason) {
    super(reason);
    this.reason = reason;
  }
}

/** A picture that the device can't draw; reason is "too large", "no memory" or "lost". */
export class DeviceError extends Error {
  constructor(reason, detail = "") {
    super(detail ? `${reason}: ${detail}` : reason);
    this.reason = reason;
  }
}

// Names of a texture's numbers: internal format, format, type, typed array.
const TEXTURE_KINDS = {
  rgba32f: ["RGBA32F", "RGBA", "FLOAT", Float32Array],
  rgba16f: ["RGBA16F", "RGBA", "HALF_FLOAT", Uint16Array],
  rg32f: ["RG32F", "RG", "FLOAT", Float32Array],
  r32f: ["R32F", "RED", "FLOAT", Float32Array],
  rgba32ui: ["RGBA32UI", "RGBA_INTEGER", "UNSIGNED_INT", Uint32Array],
  rgba8: ["RGBA8", "RGBA", "UNSIGNED_BYTE", Uint8Array],
  rg8: ["RG8", "RG", "UNSIGNED_BYTE", Uint8Array],
  r8: ["R8", "RED", "UNSIGNED_BYTE", Uint8Array],
};
const MOST_PROGRAMS = 48;
const SMALL_TEXELS = 65536; // fewer never lack memory, and asking makes the page wait
const DEPTH_TESTS = { "<": "LESS", ">": "GREATER", "<=": "LEQUAL", "1": "ALWAYS" };

export class Device {
  /** texts: shader files by name. definitions: lines that define the shaders' constants. */
  constructor(canvas, texts, definitions) {
    this.canvas = canvas;
    this.texts = texts;
    this.definitions = definitions;
    this.lost = false;
    this.generation = 0; // grows when a lost context comes back: all handles are new then
    this.onLost = null;
    this.onRestored = null;
    this.compiled = 0;
    this.draws = 0;
    this._errors = [];
    const wanted = { alpha: false, antialias: false, depth: false, stencil: false };
    this.gl = canvas.getContext("webgl2", { ...wanted, powerPreference: "high-performance" });
    if (!this.gl) throw new Unsupported("no webgl2");
    this._begin();
    this._listeners = {
      webglcontextlost: (event) => {
        event.preventDefault(); // or it never comes back
        this.lost = true;
        this._programs.clear();
        this.onLost?.();
      },
      webglcontextrestored: () => {
        this.lost = false;
        this.generation += 1;
        this._begin();
        this.onRestored?.();
      },
    };
    for (const [name, heard] of Object.entries(this._listeners)) {
      canvas.addEventListener(name, heard);
    }
  }

  _begin() {
    const gl = this.gl;
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Unsupported("no float targets");
    this.parallel = gl.getExtension("KHR_parallel_shader_compile");
    this._programs = new Map(); // the one that was used last at the end
    this._vao = gl.createVertexArray();
    this.maxSize = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    this._mostVectors = gl.getParameter(gl.MAX_VARYING_VECTORS);
    if (!this._drawsFloats()) throw new Unsupported("no float targets");
  }

  /** Whether a float target really can be drawn to. */
  _drawsFloats() {
    const target = this.target([this.texture(1, 1, "rgba32f")]);
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    gl.clearBufferfv(gl.COLOR, 0, [-1234.5, 0, 0, 0]);
    const drawn = this.read(target)[0] === -1234.5;
    this.releaseTarget(target);
    return drawn;
  }

  /** What the browser says of the graphics card, as far as it says anything. */
  get name() {
    const gl = this.gl;
    const more = gl.getExtension("WEBGL_debug_renderer_info");
    return String(gl.getParameter(more ? more.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  }

  /** DeviceError where a picture of a size can't be drawn. */
  checkSize(width, height) {
    if (Math.max(width, height) > this.maxSize) {
      throw new DeviceError("too large", `${width}x${height}, at most ${this.maxSize}`);
    }
  }

  /** A texture without filtering, of TEXTURE_KINDS; data: a typed array, row by row. */
  texture(width, height, kind, data = null) {
    const gl = this.gl;
    this.checkSize(width, height);
    const [internal, format, type] = TEXTURE_KINDS[kind];
    const handle = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, handle);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl[internal], width, height);
    for (const [name, value] of [
      ["TEXTURE_MIN_FILTER", gl.NEAREST],
      ["TEXTURE_MAG_FILTER", gl.NEAREST],
      ["TEXTURE_WRAP_S", gl.CLAMP_TO_EDGE],
      ["TEXTURE_WRAP_T", gl.CLAMP_TO_EDGE],
    ]) {
      gl.texParameteri(gl.TEXTURE_2D, gl[name], value);
    }
    if (data) {
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl[format], gl[type], data);
    }
    if (width * height > SMALL_TEXELS && this._noted() === gl.OUT_OF_MEMORY) {
      gl.deleteTexture(handle);
      throw new DeviceError("no memory", `${width}x${height}`);
    }
    return { handle, width, height, kind, sampler: "TEXTURE_2D" };
  }

  releaseTexture(texture) {
    this.gl.deleteTexture(texture.handle);
  }

  /** A framebuffer over textures of one size. depth: a renderbuffer of depthBuffer(), or null. */
  target(textures, depth = null) {
    const gl = this.gl;
    const framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    const places = textures.map((_, k) => gl.COLOR_ATTACHMENT0 + k);
    textures.forEach((texture, k) => {
      gl.framebufferTexture2D(gl.FRAMEBUFFER, places[k], gl.TEXTURE_2D, texture.handle, 0);
    });
    if (depth) {
      gl.framebufferRenderbuffer(
        gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth.handle,
      );
    }
    gl.drawBuffers(places);
    const status = gl.checkFramebufferStatus(gl.FRAMEBUFFER);
    if (status !== gl.FRAMEBUFFER_COMPLETE) {
      gl.deleteFramebuffer(framebuffer);
      if (gl.isContextLost()) throw new DeviceError("lost");
      throw new DeviceError("no memory", `framebuffer ${status}`);
    }
    const { width, height } = textures[0];
    return { framebuffer, textures, width, height };
  }

  depthBuffer(width, height) {
    const gl = this.gl;
    this.checkSize(width, height);
    const handle = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, handle);
    gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
    return { handle, width, height };
  }

  /** Free a target, and its textures unless they are kept. */
  releaseTarget(target, { textures = true } = {}) {
    this.gl.deleteFramebuffer(target.framebuffer);
    if (textures) for (const texture of target.textures) this.releaseTexture(texture);
  }

  /** Fill the first texture of a target, all of it. */
  clear(target, values) {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearBufferfv(gl.COLOR, 0, values);
  }

  /**
   * Numbers of a texture of a target, four a pixel, rows from the bottom: a Float32Array of float
   * targets, a Uint32Array of whole numbers, a Uint8Array of the others.
   */
  read(target, attachment = 0, box = [0, 0, target.width, target.height]) {
    const gl = this.gl;
    const [left, bottom, right, top] = box;
    const count = 4 * (right - left) * (top - bottom);
    const [, , type] = TEXTURE_KINDS[target.textures[attachment].kind];
    const whole = target.textures[attachment].kind.endsWith("ui");
    const kinds = { FLOAT: Float32Array, UNSIGNED_INT: Uint32Array, UNSIGNED_BYTE: Uint8Array };
    const data = new kinds[type](count);
    if (count === 0) return data;
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    gl.readBuffer(gl.COLOR_ATTACHMENT0 + attachment);
    gl.pixelStorei(gl.PACK_ALIGNMENT, 1);
    const format = whole ? gl.RGBA_INTEGER : gl.RGBA;
    gl.readPixels(left, bottom, right - left, top - bottom, format, gl[type], data);
    gl.readBuffer(gl.COLOR_ATTACHMENT0);
    if (gl.isContextLost()) throw new DeviceError("lost");
    return data;
  }

  /** Begin to compile a program, without waiting for it. */
  begin(stage, defines, source = null) {
    const key = programKey(stage, defines, source);
    const held = this._programs.get(key);
    if (held) {
      this._programs.delete(key);
      this._programs.set(key, held);
      return held;
    }
    if (this._programs.size >= MOST_PROGRAMS) {
      const [oldest, freed] = this._programs.entries().next().value;
      this._programs.delete(oldest);
      this.gl.deleteProgram(freed.handle);
    }
    const made = this._compile(stage, defines, source, this._mostVectors);
    made.retry = () => Object.assign(made, this._compile(stage, defines, source, 0));
    this._programs.set(key, made);
    this.compiled += 1;
    return made;
  }

  /** Whether a program that was begun would not make anyone wait. */
  isReady(program) {
    if (program.uniforms || !this.parallel) return true;
    return this.gl.getProgramParameter(program.handle, this.parallel.COMPLETION_STATUS_KHR);
  }

  _compile(stage, defines, source, most) {
    const gl = this.gl;
    const { texts, definitions } = this;
    const composed = new ShaderSource({ texts, definitions, name: stage, defines, most, source });
    const handle = gl.createProgram();
    const shaders = [
      [gl.VERTEX_SHADER, composed.vertex],
      [gl.FRAGMENT_SHADER, composed.text],
    ].map(([kind, text]) => {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(handle, shader);
      return shader;
    });
    gl.linkProgram(handle);
    return { handle, shaders, composed, most, uniforms: null };
  }

  /** A program that is ready to draw; ShaderError names file and line. */
  program(stage, defines, source = null) {
    const gl = this.gl;
    const made = this.begin(stage, defines, source);
    if (made.uniforms) return made;
    if (!gl.getProgramParameter(made.handle, gl.LINK_STATUS)) {
      if (gl.isContextLost()) throw new DeviceError("lost");
      const log = made.shaders.map((shader) => gl.getShaderInfoLog(shader)).filter(Boolean);
      const compiled = made.shaders.every((s) => gl.getShaderParameter(s, gl.COMPILE_STATUS));
      const text = log.join("\n") || gl.getProgramInfoLog(made.handle);
      gl.deleteProgram(made.handle);
      // A device may count its varyings otherwise: then fragments read all uniforms themselves.
      if (compiled && made.most > 0) {
        made.retry();
        return this.program(stage, defines, source);
      }
      this._programs.delete(programKey(stage, defines, source));
      throw new ShaderError(`${stage}: ${made.composed.explain(text)}`);
    }
    for (const shader of made.shaders) gl.deleteShader(shader);
    made.shaders = [];
    made.uniforms = [];
    const count = gl.getProgramParameter(made.handle, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; k++) {
      const { name, type, size } = gl.getActiveUniform(made.handle, k);
      const location = gl.getUniformLocation(made.handle, name);
      made.uniforms.push({ name: ownName(name), type, size, location });
    }
    return made;
  }

  /**
   * Draw a stage into a target: one triangle that fills it, unless it has its own vertices.
   *
   * uniforms: numbers, arrays of numbers (matrices column by column), or textures for samplers; one
   * of the stage that is not given is an error. scissor: [left, bottom, right, top] in pixels.
   * geometry: array(device, program) -> {vao, count} binds what to draw. depth: '<', '>' or '1'
   * (always), '' leaves depths alone. adds: to what is there. culls: triangles seen from behind.
   */
  draw({
    stage, defines = {}, uniforms = {}, target, scissor = null, mode = "TRIANGLES", vertices = 3,
    geometry = null, depth = "", adds = false, culls = false, instances = 1, source = null,
  }) {
    const gl = this.gl;
    if (this.lost || gl.isContextLost()) throw new DeviceError("lost");
    const program = this.program(stage, defines, source);
    gl.useProgram(program.handle);
    let unit = 0;
    for (const uniform of program.uniforms) {
      const value = uniforms[uniform.name];
      if (value === undefined) {
        throw new ShaderError(`${stage}: uniform '${uniform.name}' has no value`);
      }
      if (value !== null && value.handle) {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl[value.sampler], value.handle);
        gl.uniform1i(uniform.location, unit);
        unit += 1;
      } else {
        setUniform(gl, uniform, value);
      }
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    gl.viewport(0, 0, target.width, target.height);
    if (scissor) {
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(scissor[0], scissor[1], scissor[2] - scissor[0], scissor[3] - scissor[1]);
    } else {
      gl.disable(gl.SCISSOR_TEST);
    }
    for (const state of [gl.BLEND, gl.DEPTH_TEST, gl.CULL_FACE, gl.DITHER]) gl.disable(state);
    if (depth) {
      gl.enable(gl.DEPTH_TEST);
      gl.depthFunc(gl[DEPTH_TESTS[depth]]);
    }
    if (adds) {
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE);
    }
    if (culls) gl.enable(gl.CULL_FACE);
    if (geometry) {
      const { vao, count } = geometry.array(this, program);
      gl.bindVertexArray(vao);
      gl.drawArraysInstanced(gl[mode], 0, count, instances);
    } else {
      gl.bindVertexArray(this._vao);
      gl.drawArraysInstanced(gl[mode], 0, vertices, instances);
    }
    gl.bindVertexArray(null);
    this.draws += 1;
  }

  /** Errors of OpenGL since the last look; there are none in a sound program. */
  errors() {
    while (this._errors.length < 8 && this._noted());
    return this._errors.splice(0);
  }

  _noted() {
    const code = this.gl.getError();
    if (code) this._errors.push(code);
    return code;
  }

  /** Free everything, and the context itself. */
  release() {
    for (const [name, heard] of Object.entries(this._listeners)) {
      this.canvas.removeEventListener(name, heard);
    }
    for (const program of this._programs.values()) this.gl.deleteProgram(program.handle);
    this._programs.clear();
    this.gl.deleteVertexArray(this._vao);
    this.gl.getExtension("WEBGL_lose_context")?.loseContext();
    this.lost = true;
  }
}

function programKey(stage, defines, source) {
  const constants = Object.keys(defines).sort().map((key) => `${key}=${defines[key]}`);
  return [stage, ...constants, source ?? ""].join("\n");
}
