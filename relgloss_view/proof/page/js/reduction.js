// Numbers over all pixels of a picture, reduced on the device. The twin of picture/gpu/reduction.py.

import { NOTHING_SEEN } from "./pair.js";

const FIRST_BLOCK = 4; // small, so that a software driver's threads share the work
const FURTHER_BLOCK = 16;
const READ_SIDE = 16; // further steps would cost more than reading so few results

/** Sides of the blocks that the steps of a reduction join, the first one of pixels. */
export function blocksOf(size) {
  const blocks = [FIRST_BLOCK];
  for (let sides = shrunk(size, FIRST_BLOCK); Math.max(...sides) > READ_SIDE; ) {
    blocks.push(FURTHER_BLOCK);
    sides = shrunk(sides, FURTHER_BLOCK);
  }
  return blocks;
}

export class Reduction {
  constructor(device) {
    this.device = device;
    this._steps = [];
  }

  /** Make room for pictures of a size. */
  resize(size) {
    this.release();
    let sides = size;
    for (const block of blocksOf(size)) {
      sides = shrunk(sides, block);
      const textures = [0, 1].map(() => this.device.texture(sides[0], sides[1], "rgba32f"));
      // WebGL draws nothing where a stage leaves one of the target's textures out.
      const both = this.device.target(textures);
      this._steps.push({ 2: both, 1: this.device.target(textures.slice(0, 1)) });
    }
  }

  /** The extremes of L_d* and L_s* in a region of a split picture. */
  extremes(split, region) {
    const per_size = [1 / split.width, 1 / split.height];
    const first = ["measure.frag", { STRIDE: 1 }, { split_image: split, per_size }];
    const names = ["extremes_image", "brightest_image"];
    const results = this._run(first, "reduce.frag", names, region);
    if (results === null) return NOTHING_SEEN;
    const [extremes, brightest] = results;
    const found = { ...NOTHING_SEEN, smallestRatio: Infinity, lDMax: -Infinity, lSMax: -Infinity };
    let top = -Infinity;
    for (let k = 0; k < extremes.length; k += 4) {
      found.smallestRatio = Math.min(found.smallestRatio, extremes[k]);
      found.lDMax = Math.max(found.lDMax, extremes[k + 1]);
      found.lSMax = Math.max(found.lSMax, extremes[k + 2]);
      found.notFinite += brightest[k + 3];
      if (brightest[k] > top) {
        top = brightest[k];
        found.brightestLD = brightest[k + 1];
        found.brightestLS = brightest[k + 2];
      }
    }
    return top < -1e29 && !found.notFinite ? NOTHING_SEEN : found;
  }

  /** [the perfect diffuser's largest Y in a region, how many pixels show the object]. */
  white(defines, uniforms, region) {
    const first = ["white.frag", defines, uniforms];
    const results = this._run(first, "peak.frag", ["source_image"], region);
    if (results === null) return [0, 0];
    let [largest, count] = [-Infinity, 0];
    for (let k = 0; k < results[0].length; k += 4) {
      largest = Math.max(largest, results[0][k]);
      count += results[0][k + 1];
    }
    return [largest, count];
  }

  _run([stage, defines, uniforms], further, names, region) {
    let [left, bottom, right, top] = region;
    if (right <= left || top <= bottom) return null;
    let step = { stage, defines, uniforms };
    let block = FIRST_BLOCK;
    let size = [0, 0];
    for (const targets of this._steps) {
      const target = targets[names.length];
      [left, bottom, right, top] = region;
      size = shrunk([right - left, top - bottom], block);
      this.device.draw({
        stage: step.stage,
        defines: { BLOCK: block, ...step.defines },
        uniforms: { ...step.uniforms, region },
        target,
        scissor: [0, 0, ...size],
      });
      const images = Object.fromEntries(names.map((name, k) => [name, target.textures[k]]));
      step = { stage: further, defines: {}, uniforms: images };
      block = FURTHER_BLOCK;
      region = [0, 0, ...size];
    }
    const last = this._steps[this._steps.length - 1][names.length];
    return names.map((_, k) => this.device.read(last, k, [0, 0, ...size]));
  }

  release() {
    for (const targets of this._steps) {
      this.device.releaseTarget(targets[1], { textures: false });
      this.device.releaseTarget(targets[2]);
    }
    this._steps = [];
  }

  /** Forget what a lost context took. */
  forget() {
    this._steps = [];
  }
}

const shrunk = (size, block) => size.map((length) => Math.ceil(length / block));
