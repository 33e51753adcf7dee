// SPDX-License-Identifier: BSD-2-Clause
// Animates the impact in WebGL 2. Deformation is drawn A times as large, and rigid motion as it is: X + F_r c_r + A F_e c_e, then turned
// by its pose if the body has finite rotations. A mode of a body can take the place of the impact.

const stresses = {von_mises: "von Mises stress", principal: "largest principal stress", shear: "maximum shear stress"};
const measures = {
  speed: {label: "speed", unit: "m/s"}, displacement: {label: "displacement since the start", unit: "m"},
  deformation: {label: "deformation", unit: "m"}, body: {label: "body"},
  ...Object.fromEntries(Object.entries(stresses).flatMap(([stress, label]) => [
    [stress, {label, unit: "Pa", stress}], [`most_${stress}`, {label: `${label}, largest of the run`, unit: "Pa", stress, enveloped: true}]])),
};

class Motion {
  constructor(data, canvas) {
    this.data = data;
    this.canvas = canvas;
    this.time = unpack(data.time);
    this.bodies = data.bodies.map((body, k) => new MovingSurface(body, run.bodies.findIndex(other => other.name === body.name)));
    this.obstacles = data.obstacles.map(obstacle => new MovingSurface(obstacle));
    const {first, anchor, offset, normal, force, state} = data.points;
    this.points = {first, anchor, offset: unpack(offset), normal: unpack(normal), force: unpack(force), state: state && unpack(state)};
    this.forceMost = extent(this.points.force)[1];
    const touched = run.episodes.length > 0, whole = [this.time[0], this.time[this.time.length - 1]];
    const window = touched ? [run.episodes[0][0], run.episodes.at(-1)[1]] : whole;
    const margin = 0.35 * (window[1] - window[0]);
    this.windows = {whole, contact: [Math.max(whole[0], window[0] - margin), Math.min(whole[1], window[1] + margin)]};
    this.touch = window;
    for (const body of this.bodies) body.first = body.amplitudes(0, 0);
    this.turning = this.bodies.some(body => body.poses);
    this.most = {};
    this.stressed = this.bodies.some(body => body.stress);
    // The speed of a body that tumbles is that of its rigid motion nearly everywhere.
    this.colour = this.stressed ? "von_mises" : this.time.length === 1 ? "body" : this.turning ? "deformation" : "speed";
    this.mesh = false;
    this.arrows = true;
    this.natural = data.amplify?.natural ?? 1;
    this.amplify = this.natural;
    this.mode = null;
    this.measureScene(this.windows.contact);
    this.home();
    this.setup();
  }

  find(time) {
    let low = 0, high = this.time.length - 1;
    while (high - low > 1) { const middle = (low + high) >> 1; if (this.time[middle] <= time) low = middle; else high = middle; }
    if (this.time.length === 1) return [0, 0, 1];
    const dt = this.time[low + 1] - this.time[low];
    return [low, Math.max(0, Math.min(1, (time - this.time[low]) / dt)), dt];
  }

  sampled(count) {
    const step = Math.max(1, Math.floor(this.time.length / count));
    return Array.from({length: Math.ceil(this.time.length / step)}, (_, k) => k * step);
  }

  placeBodies(k, f, amplify) {
    this.placed = [k, f];
    for (const body of this.bodies) body.placeAt(body.place, k, f, amplify);
    for (const obstacle of this.obstacles.filter(obstacle => obstacle.poses)) obstacle.placeAt(obstacle.place, k, f);
  }

  /** Determines the box around the bodies in a part of the run: those that turn, at all its moments. */
  measureScene([from, to]) {
    const all = box(), within = k => this.time[k] >= from && this.time[k] <= to;
    for (const k of this.sampled(24).filter(within)) {
      this.placeBodies(k, 0, this.amplify);
      for (const body of this.bodies) all.add(body.place);
    }
    for (const body of this.bodies.filter(body => body.poses)) {
      const rest = box();
      rest.add(body.node);
      const corners = [0, 1, 2, 3, 4, 5, 6, 7].flatMap(c => rest.low.map((x, i) => c >> i & 1 ? rest.high[i] : x));
      for (const k of this.time.keys()) {
        if (!within(k)) continue;
        const moved = corners.slice();
        body.carry(moved, body.pose(k, 0));
        all.add(moved);
      }
    }
    if (all.low[0] > all.high[0]) for (const body of this.bodies) all.add(body.node);
    this.impact = all;
  }

  /** The first view, of all bodies or of the body whose mode is shown. */
  home() {
    this.base = this.data.view.base;
    this.box = this.mode ? this.mode.box : this.impact;
    this.look(this.data.view.azimuth, this.data.view.elevation);
    this.shape = Math.min(0.8, Math.max(0.3, 1.05 * this.spans[1] / this.spans[0]));
  }

  /** Brings a part of the run into view. */
  frame(window) {
    this.measureScene(window);
    this.box = this.impact;
    this.look(this.view.azimuth, this.view.elevation);
  }

  /** Looks at everything from a direction, given by angles from the front [rad]. */
  look(azimuth, elevation) {
    const {box} = this, extent = box.high.map((x, i) => x - box.low[i]);
    this.size = Math.hypot(...extent) || 1;
    this.view = {azimuth, elevation, zoom: 1};
    this.target = box.low.map((x, i) => (x + box.high[i]) / 2);
    this.spans = this.turn().map(row => Math.max(0.02 * this.size, row.reduce((sum, part, i) => sum + Math.abs(part) * extent[i], 0)));
  }

  /** Shows a mode of a body in place of the impact, or the impact again if no body is given. */
  showMode(body, number) {
    this.mode = null;
    if (body) {
      const field = body.mode(number), rest = box(), all = box(), share = 0.1;
      rest.add(body.node);
      const size = Math.hypot(...rest.high.map((x, i) => x - rest.low[i]));
      for (const way of [1, -1]) all.add(body.node.map((x, i) => x + way * share * size * field[i]));
      this.mode = {body, number, field, size, share, box: all};
      for (let v = 0; v < body.value.length; ++v) body.value[v] = Math.hypot(field[3 * v], field[3 * v + 1], field[3 * v + 2]);
    }
    this.home();
  }

  /** Rotation matrix of the view. Its rows are right, up and towards the eye. */
  turn() {
    const {azimuth, elevation} = this.view, [right, up, toward] = this.base;
    const c = Math.cos(azimuth), s = Math.sin(azimuth), ce = Math.cos(elevation), se = Math.sin(elevation);
    const mix = (a, u, b, v) => u.map((x, i) => a * x + b * v[i]);
    const across = mix(c, right, s, toward), deep = mix(-s, right, c, toward);
    return [across, mix(ce, up, -se, deep), mix(se, up, ce, deep)];
  }

  /** Moves the target of the view. The arguments are shares of the width of the canvas. */
  shift(right, down) {
    const rows = this.turn(), width = this.canvas.width / this.scale;
    this.target = this.target.map((x, i) => x - width * (right * rows[0][i] - down * rows[1][i]));
  }

  setup() {
    const gl = this.gl = this.canvas.getContext("webgl2", {antialias: true, alpha: true, preserveDrawingBuffer: true});
    if (!gl) return;
    const program = gl.createProgram();
    for (const [type, text] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    this.at = name => gl.getUniformLocation(program, name);
    this.inputs = ["place", "value"].map(name => gl.getAttribLocation(program, name));
    gl.uniform3fv(this.at("stops"), stops.flat());
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.polygonOffset(1, 1);
    this.spikes = {place: new Float32Array(0), value: new Float32Array(0), element: new Uint32Array(0)};
    for (const thing of [...this.bodies, ...this.obstacles, this.spikes])
      thing.buffers = {place: gl.createBuffer(), value: gl.createBuffer(), element: gl.createBuffer()};
    for (const thing of [...this.bodies, ...this.obstacles]) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, thing.buffers.element);
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, thing.element, gl.STATIC_DRAW);
      if (thing.lines) thing.wire = this.linesOf(thing.edges());
      if (thing.outline) thing.rim = this.linesOf(thing.outline);
    }
  }

  /** Lines between pairs of nodes, for `send`. */
  linesOf(pairs) {
    const gl = this.gl, buffer = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, pairs, gl.STATIC_DRAW);
    return {buffer, count: pairs.length};
  }

  /** The names of the measures that colours can show. */
  measurable() {
    const moving = this.time.length > 1;
    return Object.keys(measures).filter(name => {
      const {stress, enveloped} = measures[name];
      return stress ? this.stressed && (moving || !enveloped) : moving || name === "body";
    });
  }

  /** The largest value of the chosen measure in all steps of the run; no value: it is not known. */
  largest() {
    const {stress} = measures[this.colour];
    return stress && Math.max(...this.bodies.filter(body => body.envelope).map(body => body.envelope[stress].largest));
  }

  /** Writes the values of the chosen measure at snapshot k + f to `body.value`. */
  measure(body, k, f, dt) {
    const {stress, enveloped} = measures[this.colour];
    if (stress) return body.stressAt(stress, k, f, enveloped);
    const moved = this.scratch?.length === body.place.length ? this.scratch : this.scratch = new Float32Array(body.place.length);
    if (this.colour === "speed") body.velocities(moved, k, f, dt);
    else if (this.colour === "displacement" && body.poses) {
      body.placeAt(moved, k, f);
      for (let i = 0; i < moved.length; ++i) moved[i] -= body.node[i];
    } else if (this.colour === "displacement") body.combine(moved, null, body.amplitudes(k, f).map((c, r) => c - body.first[r]));
    else body.combine(moved, null, body.amplitudes(k, f), body.rigid);
    for (let v = 0; v < body.value.length; ++v) body.value[v] = Math.hypot(moved[3 * v], moved[3 * v + 1], moved[3 * v + 2]);
  }

  /** The upper end of the colour scale: more than 1 % of the nodes of a body exceed it at none of the moments, by default at none of
   *  those that are sampled and those of the row of moments, as a short contact lies between samples. */
  top() {
    if (this.colour === "body") return 1;
    return this.most[this.colour] ??= this.topAt([...this.sampled(60), ...this.data.pictures ?? []].map(k => this.time[k]));
  }
  topAt(times) {
    const inMost = (body, time) => {
      this.measure(body, ...this.find(time));
      return body.value.slice().sort()[Math.floor(0.99 * body.value.length)];
    };
    return Math.max(...times.flatMap(time => this.bodies.map(body => inMost(body, time)))) || 1;
  }

  /** The points of snapshot k as [from, to, shift]: the force of point p is number p + shift. With finite rotations each snapshot has
   *  points of its own, between two numbers in `first`; otherwise all have the same. */
  pointsAt(k) {
    const {first, anchor} = this.points;
    return first ? [first[k], first[k + 1], 0] : [0, anchor.length, k * anchor.length];
  }

  /** Makes spikes into both bodies at each point, or at each point in a state if one is given. Their lengths are proportional
   *  to the force. A halo is a little larger. */
  makeSpikes(k, wanted, halo = false) {
    const {anchor, offset, normal, force, state} = this.points, [from, to, shift] = this.pointsAt(k), place = [], element = [];
    const longest = 0.16 * Math.max(...this.spans.slice(0, 2));
    const rows = this.bodies.map(body => body.poses && body.pose(...this.placed).rows);
    for (let p = from; p < to; ++p) {
      const length = longest * force[p + shift] / this.forceMost;
      if (!(length > 0) || (wanted !== undefined && state[p + shift] !== wanted)) continue;
      const [b, v] = anchor[p], n = normal.subarray(3 * p, 3 * p + 3);
      const away = offset.subarray(3 * p, 3 * p + 3), turned = rows[b] ? product(rows[b], away) : away;
      const base = this.bodies[b].place.slice(3 * v, 3 * v + 3).map((x, i) => x + turned[i]);
      const seed = unit([0, 1, 2].reduce((a, i) => Math.abs(n[i]) < Math.abs(n[a]) ? i : a, 0));
      const one = seed.map((x, i) => x - dot(seed, n) * n[i]), two = cross(n, one);
      const width = Math.min(0.07 * length, 0.006 * this.size) + (halo ? 0.0022 * this.size : 0);
      for (const way of [1, -1]) {
        const first = place.length / 3;
        const corner = (s, t, r) => place.push(...base.map((x, i) => x + width * (s * one[i] + t * two[i]) + r * n[i]));
        for (const [s, t] of [[1, 0], [0, 1], [-1, 0], [0, -1]]) corner(s, t, 0);
        corner(0, 0, way * (halo ? 1.06 : 1) * length);
        for (let s = 0; s < 4; ++s) element.push(first + s, first + (s + 1) % 4, first + 4);
      }
    }
    this.spikes.place = Float32Array.from(place);
    this.spikes.value = new Float32Array(place.length / 3);
    this.spikes.element = Uint32Array.from(element);
  }

  /** Draws the triangles of a thing, or `lines` of it after its triangles. */
  send(thing, ink, {lit = true, ramped = false, lines} = {}) {
    const gl = this.gl;
    for (const [k, [name, width]] of [["place", 3], ["value", 1]].entries()) {
      gl.bindBuffer(gl.ARRAY_BUFFER, thing.buffers[name]);
      if (!lines) gl.bufferData(gl.ARRAY_BUFFER, thing[name], gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(this.inputs[k]);
      gl.vertexAttribPointer(this.inputs[k], width, gl.FLOAT, false, 0, 0);
    }
    gl.uniform4fv(this.at("ink"), ink);
    gl.uniform1i(this.at("lit"), lit);
    gl.uniform1i(this.at("ramped"), ramped);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, lines ? lines.buffer : thing.buffers.element);
    if (thing === this.spikes) gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, thing.element, gl.DYNAMIC_DRAW);
    if (lines) gl.drawElements(gl.LINES, lines.count, gl.UNSIGNED_INT, 0);
    else gl.drawElements(gl.TRIANGLES, thing.element.length, gl.UNSIGNED_INT, 0);
  }

  /** Draws the moment `time` [s] at the present size of the canvas; of a mode, the share `time` of its period. */
  draw(time) {
    const gl = this.gl, {canvas} = this;
    this.shown = time;
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.aim();
    if (this.mode) this.drawMode(time); else this.drawImpact(...this.find(time));
  }

  /** Sets the view of all that is drawn next. */
  aim() {
    const gl = this.gl, {canvas, view} = this;
    const distance = 4 * this.size, wide = canvas.width / canvas.height;
    const fit = 0.92 * view.zoom * 2 * distance * Math.min(1 / this.spans[0], 1 / (this.spans[1] * wide));
    this.scale = canvas.width * fit / (2 * distance);  // pixels per metre
    gl.uniformMatrix3fv(this.at("turn"), true, this.turn().flat());
    gl.uniform3fv(this.at("target"), this.target);
    gl.uniform2f(this.at("lens"), fit, fit * wide);
    gl.uniform1f(this.at("distance"), distance);
    gl.uniform1f(this.at("radius"), 3.9 * this.size);
  }

  drawImpact(k, f, dt) {
    this.placeBodies(k, f, this.amplify);
    const top = this.top(), ramped = this.colour !== "body";
    this.drawPlanes(true);
    for (const body of this.bodies.filter(body => body.visible)) {
      if (ramped) { this.measure(body, k, f, dt); for (let v = 0; v < body.value.length; ++v) body.value[v] /= top; }
      this.drawBody(body, ramped);
    }
    this.drawPlanes(false);
    if (this.arrows && this.forceMost > 0) this.drawForces(Math.min(this.time.length - 1, Math.round(k + f)));
  }

  drawMode(phase) {
    const {body, field, size, share} = this.mode, most = share * size * Math.sin(2 * Math.PI * phase);
    for (let i = 0; i < body.place.length; ++i) body.place[i] = body.node[i] + most * field[i];
    this.drawBody(body, true);
  }

  drawBody(body, ramped) {
    const gl = this.gl;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    this.send(body, [...(body.ink ?? cssColour(`--body${Math.max(0, body.number) % 6}`)), 1], {ramped});
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (this.mesh && body.wire) this.send(body, [0, 0, 0, 0.25], {lit: false, lines: body.wire});
    if (body.rim) this.send(body, [...cssColour("--ink"), 1], {lit: false, lines: body.rim});
  }

  /** Draws the planes seen from their front, behind the bodies, or those seen from their back and shapes, as glass before the bodies. Of a
   *  shape, the side that bodies touch is seen: the outside, or the far wall of one that bodies are in. */
  drawPlanes(front) {
    const gl = this.gl, eye = this.target.map((x, i) => x + 4 * this.size * this.turn()[2][i]);
    for (const plane of this.obstacles.filter(plane => plane.visible)) {
      if ((plane.normal ? dot(plane.normal, eye.map((x, i) => x - plane.place[i])) > 0 : false) !== front) continue;
      if (front) gl.disable(gl.DEPTH_TEST);
      if (!plane.normal) gl.enable(gl.CULL_FACE);
      gl.depthMask(front);
      this.send(plane, front ? [...cssColour("--floor"), 1] : [0.5, 0.5, 0.5, 0.28], {lit: !plane.normal});
      gl.enable(gl.DEPTH_TEST);
      gl.disable(gl.CULL_FACE);
    }
    gl.depthMask(true);
  }

  /** Draws the forces of snapshot k, over everything else. */
  drawForces(k) {
    const gl = this.gl, red = [0.85, 0.12, 0.2, 0.85], white = [1, 1, 1, 0.9], tinted = name => [...cssColour(name), 1];
    gl.disable(gl.DEPTH_TEST);
    const states = [[0, red], [1, tinted("--stick")], [2, tinted("--slip")]];  // the halo makes them visible on any colour
    for (const [state, ink, halo] of this.points.state ? [[undefined, white, true], ...states] : [[undefined, red]]) {
      this.makeSpikes(k, state, halo);
      if (this.spikes.element.length) this.send(this.spikes, ink, {lit: false});
    }
    gl.enable(gl.DEPTH_TEST);
  }

  /** The boxes around the bodies at some moments, all of the same size. */
  boxesAt(times) {
    const boxes = times.map(time => {
      const around = box();
      this.placeBodies(...this.find(time).slice(0, 2), this.amplify);
      for (const body of this.bodies) around.add(body.place);
      return around;
    });
    const half = [0, 1, 2].map(i => Math.max(...boxes.map(({low, high}) => (high[i] - low[i]) / 2)));
    return boxes.map(({low, high}) => {
      const middle = low.map((x, i) => (x + high[i]) / 2);
      return {low: middle.map((x, i) => x - half[i]), high: middle.map((x, i) => x + half[i])};
    });
  }

  /** Draws moments as pictures of the given width, from near if the bodies turn, with one scale of colours. Each change of the size of a
   *  canvas takes as long as a drawing. Returns the pictures and the upper end of the scale. */
  pictures(times, width) {
    const {canvas, view} = this, before = [canvas.width, canvas.height], boxes = this.turning ? this.boxesAt(times) : null;
    const whole = this.box, kept = this.most[this.colour], top = this.most[this.colour] = this.topAt(times);
    const look = around => {
      this.box = around;
      this.look(view.azimuth, view.elevation);
    };
    if (boxes) look(boxes[0]);
    const [across, up] = this.spans;
    [canvas.width, canvas.height] = [width, Math.round(width * Math.min(0.9, Math.max(0.2, 1.05 * up / across)))];
    const urls = times.map((time, k) => {
      if (boxes) look(boxes[k]);
      this.draw(time);
      return canvas.toDataURL("image/png");
    });
    if (boxes) look(whole);
    this.most[this.colour] = kept;
    [canvas.width, canvas.height] = before;
    return {urls, top};
  }

  /** The share of the canvas that is not empty. */
  covered() {
    const {gl, canvas} = this, pixels = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let drawn = 0;
    for (let i = 3; i < pixels.length; i += 4) drawn += pixels[i] > 0;
    return drawn / (canvas.width * canvas.height);
  }
}
