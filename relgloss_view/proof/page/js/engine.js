// A stand-in of the engine: the stored pictures on a 2D canvas.

export class Engine {
  static async open(canvas, proof, _shaders) {
    const engine = new Engine();
    engine.canvas = canvas;
    engine.images = {};
    for (const side of ["reference", "test"]) {
      const image = new Image(), picture = proof.content.pictures[side];
      image.src = `data:image/webp;base64,${picture.base64 ?? picture}`;
      await image.decode();
      engine.images[side] = image;
    }
    return engine;
  }

  draw(settings, size) {
    this.drawn = {};
    for (const side of ["reference", "test"]) {
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = size;
      const context = canvas.getContext("2d"), short = Math.min(...size);
      context.fillStyle = "#777777";
      context.fillRect(0, 0, ...size);
      context.filter = `brightness(${0.7 + settings[side].c}) blur(${settings[side].sigma_n_deg}px)`;
      context.translate(size[0] / 2, size[1] / 2);
      context.rotate(settings.eye.azimuth_deg * Math.PI / 180);
      const zoom = settings.eye.field_of_view_deg === null ? 1 : 20 / settings.eye.field_of_view_deg;
      context.drawImage(this.images[side], -short * zoom / 2, -short * zoom / 2, short * zoom, short * zoom);
      this.drawn[side] = canvas;
    }
    return {
      factor: 1, view: { pixel_step: Math.tan(Math.PI / 18) / (size[1] / 2) },
      reference: { c: settings.reference.c, c_max: 0.8 }, test: { c: settings.test.c, c_max: 0.8 },
    };
  }

  show(boxes) {
    const context = this.canvas.getContext("2d");
    context.fillStyle = "#777777";
    context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    for (const { side, from, to } of boxes) context.drawImage(this.drawn[side], ...from, ...to);
  }

  pixels(side) {
    const { width, height } = this.drawn[side];
    const { data } = this.drawn[side].getContext("2d").getImageData(0, 0, width, height);
    return { width, height, data };
  }

  split(side) { return Float32Array.from(this.pixels(side).data, (value) => value / 2.55); }

  lab_at(side, x, y) {
    const data = this.drawn[side].getContext("2d").getImageData(x, y, 1, 1).data;
    return [data[0] / 2.55, data[1] / 2.55, data[2] / 2.55];
  }

  release() {}
}
