// SPDX-License-Identifier: BSD-2-Clause
// Charts of lines and dots in SVG. They show values at the pointer, which arrow keys move too, and the time of the animation.
// A drag across a chart enlarges that part. Lines can be hidden, the axis of values can be logarithmic, and values saved as CSV.

const charts = [];

function extent(values, positive) {
  let low = Infinity, high = -Infinity;
  for (const value of values)
    if (!Number.isNaN(value) && (!positive || value > 0)) { low = Math.min(low, value); high = Math.max(high, value); }
  return low <= high ? [low, high] : [positive ? 1 : 0, positive ? 10 : 1];
}

function join(ranges) {
  return [Math.min(...ranges.map(range => range[0])), Math.max(...ranges.map(range => range[1]))];
}

/** Round values for ticks on [low, high]. */
function ticks(low, high, about) {
  const rough = (high - low) / about, ten = 10 ** Math.floor(Math.log10(rough));
  const step = ten * [1, 2, 5, 10].find(factor => factor * ten >= rough);
  const out = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) out.push(k * step);
  return out;
}

/** Powers of ten on [low, high]; if there are few, also twice and five times each. */
function decades(low, high, about) {
  const first = Math.ceil(Math.log10(low) - 1e-9), last = Math.floor(Math.log10(high) + 1e-9);
  const step = Math.max(1, Math.ceil((last - first) / about));
  const out = [];
  for (let power = first; power <= last; power += step) out.push(10 ** power);
  if (out.length > 2) return out;
  const parts = [-1, 0, 1].flatMap(power => [1, 2, 5].map(part => part * 10 ** (first + power)));
  return parts.filter(value => value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9));
}

/** The label of a power of ten, or of twice or five times a power. */
const power = value => value >= 0.01 && value <= 1e4 ? digits(value) : digits(value).replace(/^1 × /, "").replace(" × ", "·");

class Axis {
  /** `exact`: whether the ends are those of `range`. */
  constructor(spec, range, exact = false) {
    let [low, high] = range;
    if (spec.log && !exact) {
      if (spec.decades) low = Math.max(low, high * 10 ** -spec.decades);
      if (spec.whole) [low, high] = [10 ** Math.floor(Math.log10(low)), 10 ** Math.ceil(Math.log10(high))];
      if (high < low * 10 * (1 - 1e-9)) { low /= 3; high *= 3; }
    } else if (!exact) {
      if (spec.zero) { low = Math.min(low, 0); high = Math.max(high, 0); }
      if (!(high > low)) { low -= Math.abs(low) / 2 || 1; high += Math.abs(high) / 2 || 1; }
    }
    Object.assign(this, {low, high, log: spec.log});
    this.shown = spec.log ? {factor: 1, unit: spec.unit} : prefixed(Math.max(Math.abs(low), Math.abs(high)), spec.unit);
    this.label = spec.label + (this.shown.unit ? ` (${this.shown.unit})` : "");
  }
  pad(share) {
    const room = share * (this.high - this.low);
    if (!this.log) Object.assign(this, {low: this.low && this.low - room, high: this.high && this.high + room});
    return this;
  }
  /** The position of a value on the axis, from 0 to 1. */
  at(value) {
    return this.log ? Math.log(value / this.low) / Math.log(this.high / this.low) : (value - this.low) / (this.high - this.low);
  }
  back(share) {
    return this.log ? this.low * (this.high / this.low) ** share : this.low + share * (this.high - this.low);
  }
  ticks(about) {
    if (this.log && this.high >= 3 * this.low) return decades(this.low, this.high, about);
    const {factor} = this.shown, at = ticks(this.low * factor, this.high * factor, about);
    const most = Math.max(...at.map(Math.abs)), step = at.length > 1 ? at[1] - at[0] : most;
    this.count = Math.max(4, 1 + Math.ceil(Math.log10(most / step)));  // digits that tell neighbours apart
    return at.map(value => value / factor);
  }
  text(value) {
    if (this.log && this.high >= 3 * this.low) return power(value);
    return digits(Number((value * this.shown.factor).toPrecision(12)), this.count);
  }
}

class Chart {
  constructor(spec) {
    this.spec = spec;
    this.lines = spec.lines.map(line => ({...line, x: unpack(line.x), y: unpack(line.y), visible: true}));
    this.log = Boolean(spec.y.log);
    this.plot = make("div", {class: "plot"});
    this.tip = make("div", {class: "tip", role: "status"});
    const caption = make("figcaption", {}, spec.title, spec.note ? make("small", {}, spec.note) : undefined);
    this.element = make("figure", {id: `chart-${spec.key}`, class: "chart"}, caption, this.plot, this.key());
    this.place = -1;
    this.zoom(null);
    charts.push(this);
    new ResizeObserver(() => { if (this.plot.clientWidth !== this.width) this.redraw(); }).observe(this.plot);
  }
  timed() { return this.spec.x.unit === "s" && run.episodes.length > 0; }

  /** The legend, whose entries hide and show lines, and the buttons of the chart. */
  key() {
    const button = (text, title, act) => {
      const made = make("button", {type: "button", title}, text);
      made.addEventListener("click", act);
      return made;
    };
    const keys = this.lines.map(line => {
      const entry = button("", `Hide or show: ${line.name}`, () => this.show(line, entry));
      entry.append(make("i", {class: `c${line.colour} ${line.style}`}), line.name);
      return fill(entry, {class: "entry", "aria-pressed": "true"}, []);
    });
    if (this.timed()) keys.push(make("span", {}, make("i", {class: "contact"}), "in contact"));
    this.whole = button("whole", "Show everything again", () => this.zoom(null));
    this.logarithmic = button("log", "Logarithmic axis of values", () => this.scale(!this.log));
    this.logarithmic.hidden = !this.lines.some(line => line.y.some(y => y > 0)) || this.lines.some(line => line.y.some(y => y < 0));
    const csv = button("CSV", "The values drawn here", () => download(`${run.slug}-${this.spec.key}.csv`, this.csv()));
    return make("div", {class: "key"}, ...keys, make("span", {class: "tools"}, this.whole, this.logarithmic, csv));
  }

  show(line, entry) {
    line.visible = !line.visible;
    entry.setAttribute("aria-pressed", String(line.visible));
    this.zoom(this.part);
  }

  scale(log) {
    this.log = log;
    this.zoom(this.part);
  }

  /** Fits the axes to the visible lines in a part [from, to] of the axis of x; null: all of it. */
  zoom(part) {
    const {spec} = this, lines = this.lines.some(line => line.visible) ? this.lines.filter(line => line.visible) : this.lines;
    this.part = part;
    this.x = new Axis(part ? {...spec.x, decades: 0} : spec.x, part ?? spec.window ?? join(this.lines.map(line => extent(line.x, spec.x.log))), Boolean(part));
    if (!part && (spec.x.padded || spec.lines.some(line => line.style === "dots"))) this.x.pad(0.03);
    const seen = line => part ? line.y.filter((_, k) => line.x[k] >= part[0] && line.x[k] <= part[1]) : line.y;
    const ranges = lines.map(seen).filter(y => y.some(value => !Number.isNaN(value) && (!this.log || value > 0)));
    const axis = this.log ? {...spec.y, log: true, decades: spec.y.decades ?? 6} : {...spec.y, log: false};
    this.y = new Axis(axis, join((ranges.length ? ranges : lines.map(line => line.y)).map(y => extent(y, this.log)))).pad(0.06);
    this.whole.hidden = !part;
    this.logarithmic.setAttribute("aria-pressed", String(this.log));
    if (this.svg) this.redraw();
  }

  redraw() {
    const width = this.width = this.plot.clientWidth || 700, height = this.height = width < 480 ? 210 : 250;
    const box = this.box = {left: 62, top: 8, width: width - 74, height: height - 48};
    const X = value => box.left + box.width * this.x.at(value), Y = value => box.top + box.height * (1 - this.y.at(value));
    const svg = this.svg = draw("svg", {viewBox: `0 0 ${width} ${height}`, height, role: "img", tabindex: 0, "aria-label": this.summary()});
    const clip = `clip-${this.spec.key}`;
    svg.append(draw("clipPath", {id: clip}, draw("rect", {x: box.left, y: box.top, width: box.width, height: box.height})));
    const inside = draw("g", {"clip-path": `url(#${clip})`});
    if (this.timed()) for (const [from, to] of run.episodes)
      inside.append(draw("rect", {class: "band", x: X(from), y: box.top, width: Math.max(0.5, X(to) - X(from)), height: box.height}));
    for (const value of this.x.ticks(width < 480 ? 4 : 7)) {
      inside.append(draw("line", {class: "grid", x1: X(value), x2: X(value), y1: box.top, y2: box.top + box.height}));
      svg.append(draw("text", {x: X(value), y: box.top + box.height + 16, "text-anchor": "middle"}, this.x.text(value)));
    }
    for (const value of this.y.ticks(5)) {
      inside.append(draw("line", {class: "grid", y1: Y(value), y2: Y(value), x1: box.left, x2: box.left + box.width}));
      svg.append(draw("text", {x: box.left - 6, y: Y(value) + 4, "text-anchor": "end"}, this.y.text(value)));
    }
    svg.append(draw("text", {x: box.left + box.width, y: height - 6, "text-anchor": "end"}, this.x.label));
    const middle = box.top + box.height / 2;
    svg.append(draw("text", {x: 12, y: middle, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})`}, this.y.label));
    for (const line of this.lines.filter(line => line.visible)) inside.append(...this.marks(line, X, Y));
    this.now = draw("line", {class: "now", y1: box.top, y2: box.top + box.height});
    this.probe = draw("line", {class: "probe", y1: box.top, y2: box.top + box.height});
    this.chosen = draw("rect", {class: "chosen", y: box.top, height: box.height});
    inside.append(this.now, this.probe, this.chosen);
    svg.append(inside);
    this.listen(svg);
    this.plot.replaceChildren(svg, this.tip);
  }

  /** Shows values under the pointer and for arrow keys, and enlarges the part across which the pointer is dragged; plus and minus
   *  change the part, too, and a double click or Escape ends this. */
  listen(svg) {
    const share = event => {
      const at = (event.clientX - svg.getBoundingClientRect().left) * (this.width / svg.clientWidth || 1);
      return (at - this.box.left) / this.box.width;
    };
    const least = 8 / this.box.width;  // shorter drags are clicks
    let from = null;
    svg.addEventListener("pointerdown", event => {
      from = share(event);
      svg.setPointerCapture(event.pointerId);
    });
    svg.addEventListener("pointermove", event => {
      const to = share(event);
      if (from === null) return this.point(to);
      this.point(-1);
      this.chosen.setAttribute("x", this.box.left + this.box.width * Math.max(0, Math.min(from, to)));
      this.chosen.setAttribute("width", this.box.width * Math.abs(to - from));
    });
    svg.addEventListener("pointerup", event => {
      const to = share(event), ends = [from, to].sort((a, b) => a - b);
      this.chosen.setAttribute("width", 0);
      if (from !== null && ends[1] - ends[0] > least) this.enlarge(Math.max(0, ends[0]), Math.min(1, ends[1]));
      from = null;
    });
    svg.addEventListener("pointercancel", () => { from = null; this.chosen.setAttribute("width", 0); });
    svg.addEventListener("dblclick", () => this.zoom(null));
    svg.addEventListener("pointerleave", () => this.point(-1));
    svg.addEventListener("blur", () => this.point(-1));
    svg.addEventListener("keydown", event => {
      const at = this.place < 0 ? 0.5 : this.place, step = way => this.point(Math.min(1, Math.max(0, at + 0.01 * way)));
      const keys = {ArrowLeft: () => step(-1), ArrowRight: () => step(1), Escape: () => this.zoom(null),
                    "+": () => this.enlarge(at - 0.25, at + 0.25), "-": () => this.enlarge(-0.5, 1.5)};
      if (!keys[event.key]) return;
      keys[event.key]();
      event.preventDefault();
      if (!svg.isConnected) this.svg.focus({preventScroll: true});
    });
  }

  /** Shows a part, given by shares of the axis as it is. A part that is not smaller than everything ends it. */
  enlarge(from, to) {
    const part = [this.x.back(from), this.x.back(to)];
    this.zoom(null);
    const {low, high} = this.x;
    if (part[0] > low || part[1] < high) this.zoom([Math.max(low, part[0]), Math.min(high, part[1])]);
  }

  marks(line, X, Y) {
    const of = `c${line.colour}`, dots = {dots: 3, specks: 1}[line.style], is = word => line.style.split(" ").includes(word);
    const put = k => `${X(line.x[k]).toFixed(1)} ${Math.max(-1e5, Math.min(1e5, Y(line.y[k]))).toFixed(1)}`;
    const seen = k => !Number.isNaN(line.y[k]) && !Number.isNaN(line.x[k]) && (!this.y.log || line.y[k] > 0);
    if (dots)
      return [...line.x.keys()].filter(seen).map(k =>
        draw("circle", {class: `dot ${of}`, cx: X(line.x[k]).toFixed(1), cy: Y(line.y[k]).toFixed(1), r: dots}));
    let path = "", area = "", pen = false, start = 0;
    const close = k => {
      if (!pen) return;
      if (k === start) path += "h0";  // a single step is drawn as a dot
      const base = Y(this.y.log ? this.y.low : 0);
      area += `L${X(line.x[k])} ${base}L${X(line.x[start])} ${base}Z`;
    };
    for (let k = 0; k < line.x.length; ++k) {
      if (!seen(k)) { close(k - 1); pen = false; continue; }
      if (!pen) start = k;
      const to = pen && is("steps") ? `V${put(k).split(" ")[1]}L${put(k)}` : (pen ? "L" : "M") + put(k);
      path += to;
      area += to;
      pen = true;
    }
    close(line.x.length - 1);
    const stroke = draw("path", {class: `line ${of} ${is("dashed") ? "dashed" : ""}`, d: path});
    return is("filled") ? [draw("path", {class: `area ${of}`, d: area}), stroke] : [stroke];
  }

  /** Shows the values at a position, as a share of the width; -1 hides them. */
  point(share) {
    this.place = share;
    const visible = share >= 0 && share <= 1 ? "visible" : "hidden";
    this.probe.style.visibility = this.tip.style.visibility = visible;
    if (visible === "hidden") return;
    const wanted = this.x.back(share), tolerance = 0.02 * (this.x.log ? 1 : this.x.high - this.x.low);
    const near = this.lines.map(line => {
      let best = -1, least = Infinity;
      if (!line.visible) return best;
      if (line.style.includes("steps")) {  // constant since the previous time
        const k = line.x.findIndex(x => x >= wanted);
        return Number.isNaN(line.x[k - 1] ?? NaN) ? -1 : k;
      }
      line.x.forEach((x, k) => {
        const away = Math.abs(this.x.log ? Math.log(x / wanted) : x - wanted);
        if (away < least && !Number.isNaN(line.y[k])) { least = away; best = k; }
      });
      return least <= tolerance || this.x.log ? best : -1;
    });
    const at = this.lines.findIndex((line, k) => near[k] >= 0);
    const value = at < 0 ? wanted : this.lines[at].x[near[at]];
    const pixel = this.box.left + this.box.width * this.x.at(value);
    this.probe.setAttribute("x1", pixel);
    this.probe.setAttribute("x2", pixel);
    const rows = this.lines.flatMap((line, k) => near[k] < 0 ? [] :
      [make("div", {class: `c${line.colour}`}, `${line.name}: ${quantity(line.y[near[k]], this.spec.y.unit)}`)]);
    this.tip.replaceChildren(make("div", {}, quantity(value, this.spec.x.unit, 5)), ...rows);
    const left = pixel + 12, room = this.width - this.tip.offsetWidth;
    this.tip.style.left = `${left > room ? Math.max(0, pixel - 12 - this.tip.offsetWidth) : left}px`;
  }

  /** Marks the time that the animation shows [s]. */
  mark(time) {
    if (!this.now || !this.spec.cursor) return;
    const inside = time >= this.x.low && time <= this.x.high;
    this.now.style.visibility = inside ? "visible" : "hidden";
    const pixel = this.box.left + this.box.width * this.x.at(time);
    this.now.setAttribute("x1", pixel);
    this.now.setAttribute("x2", pixel);
  }

  summary() {
    const parts = this.lines.map(line => {
      const [low, high] = extent(line.y).map(value => quantity(value, this.spec.y.unit));
      return `${line.name} from ${low} to ${high}`;
    });
    return `${this.spec.title}: ${this.y.label} against ${this.x.label}; ${parts.join("; ")}`;
  }
  csv() {
    const quoted = text => `"${text.replaceAll('"', '""')}"`, {x, y} = this.spec;
    const rows = this.lines.flatMap(line => [...line.x.keys()].filter(k => !Number.isNaN(line.y[k]))
      .map(k => `${quoted(line.name)},${line.x[k]},${line.y[k]}`));
    return [`line,${quoted(`${x.label} (${x.unit})`)},${quoted(`${y.label} (${y.unit})`)}`, ...rows, ""].join("\n");
  }
}

/** Draws the force by point and time. */
function forceMap(map) {
  const force = unpack(map.force), largest = extent(force)[1] || 1;
  const left = map.left_out ? ` The ${map.points.length} points of most impulse; ${map.left_out} that touch less are left out.` : "";
  return mapOf(map, map.force.shape, {
    title: "Force by point and time", note: `the points that touch, by ${map.what}`, rest: `Blank: no force.${left}`,
    label: `Force by time and ${map.what}; the largest is ${quantity(largest, "N")}`,
    colour: k => force[k] > 0 ? ramp(force[k] / largest) : null, text: k => quantity(force[k], "N"), key: rampKey(0, largest, "N"),
  });
}

/** Draws by point and time whether points stick or slip. */
function stateMap(map) {
  const state = unpack(map.state), names = ["open", "sticks", "slips"], colours = ["open", "stick", "slip"].map(name => cssColour(`--${name}`));
  const left = map.left_out ? ` ${map.points.length} points; ${map.left_out} between them are left out.` : "";
  const share = name => digits(100 * state.filter(value => value === names.indexOf(name)).length / state.length, 2);
  const key = make("div", {class: "key"}, swatch("cstick", "sticks"), swatch("cslip", "slips"), swatch("copen", "open"));
  return mapOf(map, map.state.shape, {
    title: "Stick and slip", note: map.points.length > 1 ? `the points with friction, by ${map.what}` : "the point that touches",
    rest: `A cell of several steps slips if one of them does.${left}`,
    label: `Stick and slip by time and ${map.what}: ${share("sticks")} % of the cells stick, ${share("slips")} % slip`,
    colour: k => colours[state[k]], text: k => names[state[k]], key, name: "states",
  });
}

/** Draws a quantity by point and time as a picture, and shows values at the pointer. `colour(k)` and `text(k)` are those of
 *  cell k = column · rows + row; without a colour a cell is blank. */
function mapOf(map, [columns, rows], {title, note, rest, label, colour, text, key, name}) {
  const where = unpack(map.where);
  const canvas = make("canvas", {width: columns, height: rows, role: "img", "aria-label": label});
  const pixels = canvas.getContext("2d"), image = pixels.createImageData(columns, rows);
  for (let c = 0; c < columns; ++c)
    for (let r = 0; r < rows; ++r) {
      const drawn = colour(c * rows + r), at = 4 * ((rows - 1 - r) * columns + c);
      if (drawn) image.data.set([...drawn.map(part => 255 * part), 255], at);
    }
  pixels.putImageData(image, 0, 0);
  const tip = make("div", {class: "tip"}), plot = make("div", {class: `plot map ${rows < 4 ? "low" : ""}`}, canvas, tip);
  canvas.addEventListener("pointerleave", () => { tip.style.visibility = "hidden"; });
  canvas.addEventListener("pointermove", event => {
    const box = canvas.getBoundingClientRect(), across = (event.clientX - box.left) / box.width;
    const c = Math.min(columns - 1, Math.max(0, Math.floor(across * columns)));
    const r = rows - 1 - Math.min(rows - 1, Math.max(0, Math.floor((event.clientY - box.top) / box.height * rows)));
    const time = quantity(map.from + (c + 0.5) / columns * (map.to - map.from), "s");
    tip.replaceChildren(`${time}, point ${map.points[r]} at ${quantity(where[r], "m")}: ${text(c * rows + r)}`);
    tip.style.visibility = "visible";
    tip.style.left = `${Math.max(0, Math.min(across * box.width + 12, box.width - tip.offsetWidth))}px`;
  });
  const [low, high] = [where[0], where[rows - 1]].map(value => quantity(value, "m"));
  const explanation = `Upwards ${note}${rows > 1 ? `: ${low} to ${high}` : ""}. ${rest}`;
  const [from, to] = [map.from, map.to].map(time => make("span", {}, quantity(time, "s")));
  const ends = make("div", {class: "ends"}, from, key, to);
  return make("figure", {class: "chart", id: name && `map-${name}`}, make("figcaption", {}, title, make("small", {}, explanation)), plot, ends);
}
