// SPDX-License-Identifier: BSD-2-Clause
// Which body is seen where: a picture of numbers in place of colours, for picking, and the places where labels have room.

class Picture {
  /** Each cell stands for `wide` × `high` pixels of the page, about the shape of a letter. */
  constructor(motion, wide = 3, high = 2) {
    const {gl} = motion;
    Object.assign(this, {motion, cell: [wide, high], size: [0, 0], frame: gl.createFramebuffer(),
                         colour: gl.createRenderbuffer(), depth: gl.createRenderbuffer()});
  }

  /** Takes the view at which `motion` has aimed, on a canvas of the given size [pixels of the page]. */
  take(width, height) {
    const {motion, motion: {gl}, cell} = this, size = [Math.max(1, Math.ceil(width / cell[0])), Math.max(1, Math.ceil(height / cell[1]))];
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.frame);
    if (size[0] !== this.size[0] || size[1] !== this.size[1]) this.resize(size);
    gl.viewport(0, 0, ...size);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    for (const [k, body] of motion.bodies.entries())
      if (body.visible) motion.send(body, [...[0, 8, 16].map(shift => ((k + 1) >> shift & 255) / 255), 1], {lit: false});
    const bytes = new Uint8Array(4 * size[0] * size[1]);
    gl.readPixels(0, 0, ...size, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    this.seen = Int32Array.from({length: size[0] * size[1]}, (_, p) => bytes[4 * p] + (bytes[4 * p + 1] << 8) + (bytes[4 * p + 2] << 16) - 1);
  }

  resize(size) {
    const {gl} = this.motion;
    this.size = size;
    for (const [buffer, format, part] of [[this.colour, gl.RGBA8, gl.COLOR_ATTACHMENT0], [this.depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, ...size);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, part, gl.RENDERBUFFER, buffer);
    }
  }

  /** The index of the body at a place of the page, from the upper left corner of the canvas, or -1. */
  at(x, y) {
    const [wide, high] = this.size, column = Math.floor(x / this.cell[0]), row = high - 1 - Math.floor(y / this.cell[1]);
    return column >= 0 && column < wide && row >= 0 && row < high ? this.seen[row * wide + column] : -1;
  }

  /** The number of cells that show a body. */
  share(k) { return this.seen.reduce((sum, other) => sum + (other === k), 0); }

  /** For each body, the place with the most room in what is seen of it: its middle {x, y} from the upper left corner of the canvas, half
   *  the side of the square of cells around it, and the room for text in its row [pixels of the page]; null if it is not seen. */
  rooms() {
    const {seen, size: [wide, high], cell, motion} = this, depth = this.depths();
    const most = motion.bodies.map(() => 0), middle = motion.bodies.map(() => [0, 0, 0]), best = motion.bodies.map(() => null);
    const each = act => { for (let p = 0; p < seen.length; ++p) if (seen[p] >= 0) act(seen[p], p); };
    const roomy = (k, p) => depth[p] > 0.8 * most[k];
    each((k, p) => { most[k] = Math.max(most[k], depth[p]); });
    each((k, p) => { if (roomy(k, p)) [p % wide, Math.floor(p / wide), 1].forEach((x, i) => { middle[k][i] += x; }); });
    each((k, p) => {  // of the roomy cells, the one nearest to their middle
      if (!roomy(k, p)) return;
      const [x, y, n] = middle[k], away = (p % wide - x / n) ** 2 + (Math.floor(p / wide) - y / n) ** 2;
      if (!(away >= best[k]?.away)) best[k] = {p, away};
    });
    return best.map((found, k) => found && this.room(found.p, depth[found.p], k));
  }

  room(p, half, k) {
    const {seen, size: [wide, high], cell} = this, column = p % wide, row = Math.floor(p / wide);
    const rows = [-2, 0, 2].map(up => p + up * wide);  // of the upper end, the middle and the lower end of letters
    const free = way => {
      let n = 0;
      while (column + way * (n + 1) >= 0 && column + way * (n + 1) < wide && rows.every(at => seen[at + way * (n + 1)] === k)) ++n;
      return n;
    };
    return {x: (column + 0.5) * cell[0], y: (high - row - 0.5) * cell[1], half, wide: 2 * Math.min(free(1), free(-1)) * cell[0]};
  }

  /** Of each cell, the number of steps to the nearest cell of another body, to any of eight neighbours. The edge of the canvas counts as one. */
  depths() {
    const {seen, size: [wide, high]} = this, steps = new Int32Array(wide * high);
    const pass = (rows, columns, ways) => {
      for (const row of rows)
        for (const column of columns) {
          const p = row * wide + column, inner = row > 0 && row < high - 1 && column > 0 && column < wide - 1;
          let least = inner ? steps[p] || wide + high : 1;
          if (inner) for (const way of ways) least = Math.min(least, seen[p + way] === seen[p] ? steps[p + way] + 1 : 1);
          steps[p] = least;
        }
    };
    const rows = [...Array(high).keys()], columns = [...Array(wide).keys()];
    pass(rows, columns, [-wide - 1, -wide, -wide + 1, -1]);
    pass(rows.reverse(), columns.reverse(), [wide + 1, wide, wide - 1, 1]);
    return steps;
  }
}
