// What is printed, as textures: mip levels side by side. The twin of picture/gpu/printed.py.

/** The first mip level whose texture, with all that follow, is at most so many texels a side. */
export function firstLevel(levels, limit, mostLevels) {
  const fits = (k) => Math.max(...placedLevels(levels.slice(k)).size) <= limit && levels.length - k <= mostLevels;
  return levels.findIndex((_, k) => fits(k));
}

/** Where each level lies in one texture, [left, top, width, height], and its size: printed._placed. */
export function placedLevels(levels) {
  const [{ width, height }, ...rest] = levels;
  const boxes = [[0, 0, width, height]];
  let top = 0;
  for (const level of rest) {
    boxes.push([width, top, level.width, level.height]);
    top += level.height;
  }
  return { boxes, size: [width + (rest.length ? rest[0].width : 0), Math.max(height, top)] };
}

/** The textures of layers, and the uniforms that read them. {uniforms, textures, first} */
export function printedTextures(device, { levels, count }, { most_levels: most }) {
  const first = firstLevel(levels, device.maxSize, most);
  const shown = levels.slice(first);
  const { boxes, size } = placedLevels(shown);
  const { gl } = device;
  const paint = device.texture(size[0], size[1], "rgba16f");
  upload(gl, paint, gl.HALF_FLOAT, boxes, (k) => shown[k].paint);
  const targets = Math.ceil(count / 4);
  const channels = Array.from({ length: targets }, (_, group) => {
    const texture = device.texture(size[0], size[1], "rgba8");
    upload(gl, texture, gl.UNSIGNED_BYTE, boxes, (k) => grouped(shown[k], count, group));
    return texture;
  });
  const listed = new Float32Array(4 * most);
  boxes.forEach((box, k) => listed.set(box, 4 * k));
  const table = device.texture(most, 1, "rgba32f", listed);
  return {
    first,
    textures: [paint, ...channels, table],
    uniforms: {
      paint_image: paint,
      ...Object.fromEntries(channels.map((texture, k) => [`channels_${k}`, texture])),
      per_atlas: [1 / size[0], 1 / size[1]],
      level_table: table,
      artwork_texels: boxes[0].slice(2),
      last_level: boxes.length - 1,
    },
  };
}

function upload(gl, texture, type, boxes, dataAt) {
  gl.bindTexture(gl.TEXTURE_2D, texture.handle);
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  boxes.forEach(([left, top, width, height], k) => {
    gl.texSubImage2D(gl.TEXTURE_2D, 0, left, top, width, height, gl.RGBA, type, dataAt(k));
  });
}

// Four of a level's channels, zeros where there are fewer.
function grouped({ width, height, channels }, count, group) {
  if (count === 4 && group === 0) return channels;
  const padded = new Uint8Array(4 * width * height);
  const own = Math.min(4, count - 4 * group);
  for (let c = 0; c < own; c++) {
    for (let to = c, from = 4 * group + c; to < padded.length; to += 4, from += count) padded[to] = channels[from];
  }
  return padded;
}
