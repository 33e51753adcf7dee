// SPDX-License-Identifier: BSD-2-Clause
// Drawn over the bodies: the axes, a scale bar, and the direction of gravity.

const arm = 26;  // length of an axis [CSS pixels]

class Overlay {
  constructor(motion) {
    this.motion = motion;
    this.element = draw("svg", {class: "overlay", role: "img"});
  }

  /** Draws for the present view, on a stage of the given size [CSS pixels]. */
  update(wide, high) {
    const {motion, element} = this, rows = motion.turn(), gravity = motion.mode ? null : motion.data.gravity;
    const bar = this.bar(wide, high);
    element.setAttribute("viewBox", `0 0 ${wide} ${high}`);
    element.replaceChildren(this.axes(rows, 44, high - 44), bar.drawn, ...(gravity ? [this.gravity(gravity, rows, wide - 48, 44)] : []));
    element.setAttribute("aria-label", `Axes x, y and z; a scale bar of ${bar.text}` + (gravity ? `; gravity, ${this.strength(gravity)}` : ""));
  }

  /** The three axes, the one that points away first. */
  axes(rows, x, y) {
    const order = [0, 1, 2].sort((a, b) => rows[2][a] - rows[2][b]);
    return draw("g", {class: "axes"}, ...order.flatMap(i => {
      const [right, up] = [arm * rows[0][i], -arm * rows[1][i]], away = Math.hypot(right, up), far = away ? 1 + 11 / Math.max(away, 6) : 1;
      const colour = {class: `axis${"xyz"[i]}`};
      return [draw("line", {x1: x, y1: y, x2: x + right, y2: y + up, ...colour, "data-axis": "xyz"[i]}),
              draw("text", {x: x + far * right, y: y + far * up + 4, "text-anchor": "middle", ...colour}, "xyz"[i])];
    }));
  }

  /** A bar of a round length, which holds in the plane through the middle of the bodies. */
  bar(wide, high) {
    const metre = this.motion.scale * wide / this.motion.canvas.width, most = Math.min(140, 0.3 * wide) / metre;
    const ten = 10 ** Math.floor(Math.log10(most)), length = ten * [5, 2, 1].find(factor => factor * ten <= most);
    const right = wide - 16, left = right - length * metre, y = high - 16, text = quantity(length, "m", 1);
    return {text, drawn: draw("g", {class: "scale", "data-metres": length},
      draw("path", {d: `M${left} ${y - 4}V${y}H${right}V${y - 4}`}),
      draw("text", {x: (left + right) / 2, y: y - 6, "text-anchor": "middle"}, text))};
  }

  strength(gravity) { return `${digits(Math.hypot(...gravity), 3)} m/s²`; }

  /** An arrow along gravity; along the line of sight, the sign of an arrow's tip or feathers. */
  gravity(gravity, rows, x, y) {
    const size = Math.hypot(...gravity), [right, up, toward] = rows.map(row => dot(row, gravity) / size);
    const long = Math.hypot(right, up), to = [x + 1.3 * arm * right, y - 1.3 * arm * up];
    const text = draw("text", {x: x + 32, y: y - 26, "text-anchor": "end"}, `gravity ${this.strength(gravity)}`);
    const head = [2.5, -2.5].map(turn => [to[0] + 8 * (right * Math.cos(turn) + up * Math.sin(turn)) / (long || 1),
                                          to[1] - 8 * (up * Math.cos(turn) - right * Math.sin(turn)) / (long || 1)].join(" "));
    const arrow = long > 0.2 ? draw("path", {d: `M${x} ${y}L${to.join(" ")}M${head[0]}L${to.join(" ")}L${head[1]}`})
      : draw("path", {d: `M${x - 6} ${y}a6 6 0 1 0 12 0a6 6 0 1 0 -12 0` + (toward > 0 ? `m5 0a1 1 0 1 0 2 0a1 1 0 1 0 -2 0` : `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`)});
    return draw("g", {class: "gravity", "data-down": -up}, arrow, text);
  }
}
