// SPDX-License-Identifier: BSD-2-Clause
// An instrument to play: the body in 3D, struck where it is clicked, its controls, the contact force and the spectrum.

const cssText = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const bytesOf = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0));

/** Fills the section with the instrument. */
function instrument(section, data) {
  const text = `${data.body}, to strike. Click or tap a place. Arrow keys choose a place, Space or Enter strikes it, plus and ` +
    "minus change the size, Shift with arrow keys turns the view.";
  const canvas = make("canvas", {tabindex: 0, role: "application", "aria-label": text});
  const picture = new Motion(data.picture, canvas);
  if (!picture.gl) return section.append(make("p", {class: "note"}, "This browser shows no WebGL 2, which the picture of the body needs."));
  if (typeof AudioWorkletNode === "undefined" || typeof WebAssembly === "undefined")
    section.append(make("p", {class: "warning"}, "This browser cannot compute sound here (no AudioWorklet or no WebAssembly). " +
      "Open the page from a file or over https, in a browser of 2023 or later."));
  return new Instrument(section, data, picture, canvas);
}

/** The audio thread, which starts with the first blow: browsers allow no sound before. */
class Voice {
  constructor(data, blow) {
    Object.assign(this, {data, blow, volume: 1, damping: 1});
  }

  start() { return this.started ??= this.begin(); }

  async begin() {
    const context = this.context = new AudioContext({latencyHint: "interactive"});
    const wasm = bytesOf(this.data.wasm), block = bytesOf(this.data.block);
    const engine = new Engine(wasm, block, context.sampleRate);
    engine.strike({speed: 1});
    this.loud = 0.25 / Math.max(1e-12, ...[0, 1].flatMap(() => Array.from(engine.process(4096)[0], Math.abs)));
    // Not a blob:, which browsers do not load for a page that is a file.
    const script = `${Engine}\n${document.getElementById("worklet").textContent}`;
    await context.audioWorklet.addModule(`data:text/javascript,${encodeURIComponent(script)}`);
    this.node = new AudioWorkletNode(context, "ricochet", {numberOfInputs: 0, outputChannelCount: [2], processorOptions: {wasm, block}});
    this.node.port.onmessage = ({data}) => this.blow(data);
    this.gain = new GainNode(context, {gain: this.loud * this.volume});
    this.analyser = new AnalyserNode(context, {fftSize: 16384, smoothingTimeConstant: 0.5, minDecibels: -120, maxDecibels: 0});
    const limiter = new DynamicsCompressorNode(context, {threshold: -6, knee: 6, ratio: 20, attack: 0.001, release: 0.1});
    this.node.connect(this.analyser);
    this.node.connect(this.gain).connect(limiter).connect(context.destination);
    this.node.port.postMessage({damping: this.damping});
    await context.resume();
  }

  async strike(strike) {
    await this.start();
    this.node.port.postMessage({strike});
  }
  setDamping(factor) {
    this.damping = factor;
    this.node?.port.postMessage({damping: factor});
  }
  setVolume(volume) {
    this.volume = volume;
    if (this.gain) this.gain.gain.value = this.loud * volume;
  }
  /** Levels [dB] of frequencies from 0 to half the rate. */
  spectrum() {
    this.levels ??= new Float32Array(this.analyser.frequencyBinCount);
    this.analyser.getFloatFrequencyData(this.levels);
    return this.levels;
  }
}

class Instrument {
  constructor(section, data, picture, canvas) {
    Object.assign(this, {data, picture, canvas, section, blows: 0, place: 0});
    this.points = unpack(data.points);
    this.normals = unpack(data.normals);
    this.frequency = unpack(data.frequency);
    this.decay = unpack(data.decay);
    this.nodes = picture.bodies[0].node;
    this.voice = new Voice(data, blow => this.heard(blow));
    this.stage = make("div", {class: "stage"}, canvas);
    this.status = make("p", {class: "status", role: "status", "aria-live": "polite"}, "Not struck yet.");
    this.forcePlot = make("canvas", {class: "plot", role: "img", "aria-label": "Contact force: no blow yet."});
    this.spectrumPlot = make("canvas", {class: "plot", role: "img", "aria-label": "Spectrum: no sound yet."});
    section.append(this.stage, this.status, this.form(),
      make("figure", {}, make("figcaption", {}, "Contact force"), this.forcePlot),
      make("figure", {}, make("figcaption", {}, "Spectrum"), this.spectrumPlot),
      make("p", {class: "note"}, data.note));
    this.listen();
    this.choose(0);
    new ResizeObserver(() => this.fit()).observe(this.stage);
    this.fit();
  }

  form() {
    const {data} = this, slider = (min, max, step, value) => make("input", {type: "range", min, max, step, value});
    this.button = make("button", {type: "submit", class: "strike"}, "Strike");
    this.chooser = slider(1, this.points.length / 3, 1, 1);
    this.mallet = make("select", {}, ...data.mallets.map((name, value) => make("option", {value}, name)));
    this.speed = slider(-2, 1, 0.01, Math.log10(Math.min(10, Math.max(0.01, data.speed))));
    this.damping = slider(-1, 2, 0.01, 0);
    this.volume = slider(0, 2, 0.01, 1);
    this.outputs = new Map([this.chooser, this.speed, this.damping, this.volume].map(input => [input, make("output", {"aria-hidden": "true"})]));
    const field = (text, input) => make("label", {}, text, input, ...(this.outputs.has(input) ? [this.outputs.get(input)] : []));
    const form = make("form", {class: "controls instrument"}, this.button, field(data.keys.length ? "Key" : "Place", this.chooser), field("Mallet", this.mallet),
      field("Speed", this.speed), field("Damping", this.damping), field("Volume", this.volume));
    form.addEventListener("submit", event => { event.preventDefault(); this.strike(); });
    this.chooser.addEventListener("input", () => this.choose(Number(this.chooser.value) - 1));
    this.speed.addEventListener("input", () => this.show());
    this.damping.addEventListener("input", () => { this.voice.setDamping(10 ** this.damping.value); this.show(); });
    this.volume.addEventListener("input", () => { this.voice.setVolume(Number(this.volume.value)); this.show(); });
    return form;
  }

  /** Clicks strike; drags, wheels and keys turn the view and choose places. */
  listen() {
    const {canvas} = this;
    let down = null;
    canvas.addEventListener("pointerdown", event => { down = {x: event.clientX, y: event.clientY, fingers: (down?.fingers ?? 0) + 1}; });
    canvas.addEventListener("pointerup", event => {
      const still = down && down.fingers === 1 && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 8;
      down = null;
      if (!still) return;
      const box = canvas.getBoundingClientRect(), ratio = canvas.width / box.width;
      this.choose(this.nearest((event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio));
      this.strike();
    });
    // Letters in the order of piano keys, from the first C on, or from the first key. Words typed into a control are its own.
    const letters = "awsedftgyhujkolp;'", first = Math.max(0, this.data.keys.findIndex(name => name.startsWith("C") && name[1] !== "#"));
    if (this.data.keys.length) document.addEventListener("keydown", event => {
      const key = first + letters.indexOf(event.key), other = event.ctrlKey || event.altKey || event.metaKey || event.repeat;
      if (other || key < first || key >= this.data.keys.length || event.target instanceof HTMLSelectElement) return;
      this.choose(key);
      this.strike();
    });
    canvas.addEventListener("pointercancel", () => { down = null; });
    const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};
    canvas.addEventListener("keydown", event => {
      const blow = event.key === " " || event.key === "Enter", step = event.shiftKey ? undefined : steps[event.key];
      if (!blow && !step) return;
      if (blow && !event.repeat) this.strike();
      if (step) this.choose(this.neighbour(...step));
      event.preventDefault();
      event.stopImmediatePropagation();  // arrow keys with Shift turn the view
    });
    handle(canvas, this.picture, () => this.draw());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.draw(); this.drawForce(); });
  }

  // ---- Places ----

  /** The position of a place on the canvas [pixels], and its distance in front of the middle of the body [m]. */
  project(place) {
    const {picture, canvas} = this, rows = picture.turn(), distance = 4 * picture.size;
    const from = [0, 1, 2].map(i => this.points[3 * place + i] - picture.target[i]);
    const [x, y, z] = rows.map(row => dot(row, from)), pixels = picture.scale * distance / (distance - z);
    return [canvas.width / 2 + pixels * x, canvas.height / 2 - pixels * y, z];
  }

  /** The place nearest to a point of the canvas. If several are about as near, the one in front. */
  nearest(x, y) {
    const all = Array.from({length: this.points.length / 3}, (_, k) => {
      const [px, py, z] = this.project(k);
      return {k, z, away: Math.hypot(px - x, py - y)};
    });
    const most = Math.min(...all.map(one => one.away)) + 0.03 * this.canvas.width;
    return all.filter(one => one.away <= most).reduce((a, b) => b.z > a.z ? b : a).k;
  }

  /** The next place in a direction on the canvas, at the same side of the body if possible. */
  neighbour(right, down) {
    const [x, y, z] = this.project(this.place);
    let best = this.place, least = Infinity;
    for (let k = 0; k < this.points.length / 3; ++k) {
      const [px, py, pz] = this.project(k), along = (px - x) * right + (py - y) * down;
      if (k === this.place || along < 2) continue;
      const across = Math.abs((px - x) * down - (py - y) * right), behind = this.picture.scale * Math.abs(pz - z);
      const cost = along + 2.5 * across + 0.5 * behind;
      if (cost < least) { least = cost; best = k; }
    }
    return best;
  }

  choose(place) {
    this.place = place;
    const {nodes, picture} = this, point = this.points.subarray(3 * place, 3 * place + 3);
    let node = 0, least = Infinity;
    for (let v = 0; v < nodes.length; v += 3) {
      const away = Math.hypot(nodes[v] - point[0], nodes[v + 1] - point[1], nodes[v + 2] - point[2]);
      if (away < least) { least = away; node = v / 3; }
    }
    Object.assign(picture.points, {anchor: [[0, node]], offset: Float32Array.from(point, (x, i) => x - nodes[3 * node + i]),
      normal: this.normals.subarray(3 * place, 3 * place + 3), force: [0.5]});
    picture.forceMost = 1;
    this.chooser.value = place + 1;
    this.show();
    this.draw();
  }

  // ---- Blows ----

  async strike() {
    const strike = {place: this.place, mallet: Number(this.mallet.value), speed: 10 ** this.speed.value};
    this.struck = strike;
    try {
      await this.voice.strike(strike);
    } catch (error) {
      this.status.textContent = `No sound: ${error.message}`;
      throw error;
    }
    this.bounce();
    this.listenOn();
  }

  /** The report of the audio thread on a blow. */
  heard({forces, rate, amplitudes}) {
    this.pulse = {forces, rate};
    const peak = Math.max(...forces), first = forces.findIndex(force => force > 0);
    const duration = quantity((forces.length - 1 - first) / rate, "s", 3), loud = this.partials(amplitudes);
    const tones = loud.length ? `Strongest partials after 0.5 s: ${loud.map(f => `${digits(f, 4)} Hz`).join(", ")}.` : "";
    const force = `at most ${quantity(peak, "N", 3)}, over ${duration}`;
    const where = this.data.keys.length ? `Struck: ${this.data.keys[this.struck.place]}` : `Struck at place ${this.struck.place + 1}`;
    this.status.textContent = `${where} with ${this.data.mallets[this.struck.mallet]} at ` +
      `${quantity(this.struck.speed, "m/s", 3)}: ${force}. ${tones}`;
    this.forcePlot.setAttribute("aria-label", `Contact force: ${force}.`);
    this.spectrumPlot.setAttribute("aria-label", `Spectrum. ${tones}`);
    Object.assign(this.section.dataset, {peak, partials: loud.join(" "), blows: ++this.blows});
    this.drawForce();
  }

  /** Frequencies [Hz] of the partials that are strongest half a second after a blow. Modes less than 1 % apart count as one. */
  partials(start) {
    const damping = 10 ** this.damping.value, amplitudes = start.map((a, n) => a * Math.exp(-0.5 * damping * this.decay[n]));
    const order = Array.from(amplitudes.keys()).sort((a, b) => amplitudes[b] - amplitudes[a]), out = [];
    for (const n of order) {
      if (out.length === 3 || !(amplitudes[n] > 0)) break;
      if (out.every(f => Math.abs(f - this.frequency[n]) > 0.01 * f)) out.push(this.frequency[n]);
    }
    return out;
  }

  // ---- Drawing ----

  fit() {
    const {canvas, stage, picture} = this, ratio = Math.min(2, devicePixelRatio || 1), wide = stage.clientWidth || 640;
    [canvas.width, canvas.height] = [wide * ratio, wide * Math.min(0.75, Math.max(picture.shape, 0.5)) * ratio].map(Math.round);
    for (const plot of [this.forcePlot, this.spectrumPlot])
      [plot.width, plot.height] = [plot.clientWidth * ratio, plot.clientHeight * ratio].map(Math.round);
    this.draw();
    this.drawForce();
    if (this.voice.analyser) this.drawSpectrum();
  }

  draw() {
    this.picture.draw(0);
    if (this.canvas.dataset.covered === undefined) this.canvas.dataset.covered = this.picture.covered();
  }

  show() {
    const set = (input, text) => { this.outputs.get(input).textContent = text; input.setAttribute("aria-valuetext", text); };
    set(this.chooser, this.data.keys[this.place] ?? `${this.place + 1} of ${this.points.length / 3}`);
    set(this.speed, quantity(10 ** this.speed.value, "m/s", 2));
    set(this.damping, `× ${digits(10 ** this.damping.value, 2)}`);
    set(this.volume, `${Math.round(100 * this.volume.value)} %`);
  }

  /** The mark of the place grows and shrinks with a blow. */
  bounce() {
    if (soft.matches) return;
    const start = performance.now();
    const frame = now => {
      const t = Math.max(0, now - start) / 250;
      this.picture.points.force = [t < 1 ? 0.5 + 0.5 * (1 - t) : 0.5];
      this.draw();
      if (t < 1) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  /** Draws the spectrum until the sound has faded; with reduced motion, once for each blow. */
  listenOn() {
    this.quiet = 0;
    this.top = -160;  // [dB]
    if (soft.matches) return void setTimeout(() => this.drawSpectrum(), 500);
    if (this.running) return;
    this.running = true;
    const frame = () => {
      this.quiet = this.drawSpectrum() < -80 ? this.quiet + 1 : 0;
      this.running = this.quiet < 120;
      if (this.running) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  /** An empty plot with the label of its horizontal axis. Returns its context and the size of its area [pixels]. */
  paper(plot, ends) {
    const paper = plot.getContext("2d"), em = plot.height / 11, area = {wide: plot.width, high: plot.height - 1.5 * em};
    paper.clearRect(0, 0, plot.width, plot.height);
    paper.font = `${em}px ${cssText("--sans")}`;
    paper.fillStyle = cssText("--soft");
    ends.forEach((text, k) => { paper.textAlign = ["left", "center", "right"][k]; paper.fillText(text, k * plot.width / 2, plot.height - 0.2 * em); });
    paper.strokeStyle = cssText("--rule");
    paper.strokeRect(0, area.high, area.wide, 0);
    paper.lineWidth = Math.max(1, plot.height / 90);
    paper.lineJoin = "round";
    return {paper, em, ...area};
  }

  line(paper, points, colour) {
    paper.strokeStyle = cssText(colour);
    paper.beginPath();
    points.forEach(([x, y]) => paper.lineTo(x, y));
    paper.stroke();
  }

  drawForce() {
    const {forces, rate} = this.pulse ?? {forces: [0], rate: 1}, peak = Math.max(...forces);
    const ends = this.pulse ? ["0", `peak ${quantity(peak, "N", 3)}`, quantity(forces.length / rate, "s", 3)] : ["", "no blow yet", ""];
    const {paper, wide, high} = this.paper(this.forcePlot, ends);
    const points = Array.from(forces, (force, k) => [wide * (k + 1) / forces.length, high * (1 - 0.92 * force / (peak || 1))]);
    this.line(paper, [[0, high], ...points], "--accent");
  }

  /** Draws levels down to 80 dB below the highest since the blow. Returns the highest one now, relative to that [dB]. */
  drawSpectrum() {
    const levels = this.voice.spectrum(), half = this.voice.context.sampleRate / 2;
    const top = Math.min(half, 1.1 * this.frequency[this.frequency.length - 1]);
    const {paper, em, wide, high} = this.paper(this.spectrumPlot, ["0", quantity(top / 2, "Hz", 2), quantity(top, "Hz", 2)]);
    const count = Math.floor(levels.length * top / half), highest = Math.max(...levels.subarray(0, count));
    this.top = Math.max(this.top, highest);
    const y = level => high * Math.min(1, 0.08 + Math.max(0, this.top - level) / 80);
    this.line(paper, Array.from({length: count}, (_, k) => [wide * k / count, y(levels[k])]), "--body0");
    paper.textAlign = "left";
    paper.fillStyle = cssText("--ink");
    const named = [];
    for (const f of (this.section.dataset.partials ?? "").split(" ").filter(Boolean).map(Number)) {
      const x = Math.min(wide - 3 * em, wide * f / top + 0.3 * em), at = 0.9 * em + y(levels[Math.round(f / half * levels.length)] + 3);
      if (f > top || at > high || named.some(other => Math.abs(other - x) < 3 * em)) continue;
      named.push(x);
      paper.fillText(`${Math.round(f)}`, x, at);
    }
    return highest - this.top;
  }
}
