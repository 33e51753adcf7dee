// SPDX-License-Identifier: BSD-2-Clause
// The surroundings of the animation: controls, colours, the pointer, and the row of moments.

const seconds = 8;  // duration of a play from end to end

const swatch = (colour, text) => make("span", {}, make("i", {class: `swatch ${colour}`}), text);
const range = (name, max, step) => make("input", {type: "range", min: 0, max, step, "aria-label": name});
const choice = (name, options) =>
  make("select", {"aria-label": name}, ...Object.entries(options).map(([value, text]) => make("option", {value}, text)));
const labelled = (text, ...controls) => make("label", {}, text, ...controls);
const pressable = text => make("button", {type: "button"}, text);

/** Fills the section. Calls `tell(time)` for each moment shown. */
function player(section, data, tell) {
  const say = text => section.append(make("p", {class: "note"}, text));
  if (data.missing) {
    say(`No ${run.static ? "picture of the bodies" : "motion"} to show: ${data.missing}.`);
    if (run.by_table) return;
    say("Both programs need these keys of the scene, ricochet-kernel for the skins and ricochet-contact for the snapshots:");
    section.append(make("pre", {}, `[output]\nview = true\nsnapshot_every = ${run.static ? 1 : 4}`));
    return;
  }
  const label = "The bodies in motion. Arrow keys turn them, plus and minus change their size.";
  const canvas = make("canvas", {tabindex: 0, role: "img", "aria-label": label});
  const motion = new Motion(data, canvas);
  if (!motion.gl) return say("This browser shows no WebGL 2, which the animation needs.");
  const shown = new Player(section, motion, canvas, tell);
  say(remarks(motion, data));
  if (motion.time.length > 1) section.append(rowOfMoments(motion));
  shown.show();  // draws again, because the row of moments has used the canvas
  canvas.dataset.moments = motion.time.length;
  canvas.dataset.covered = motion.covered();
}

class Player {
  constructor(section, motion, canvas, tell) {
    Object.assign(this, {motion, canvas, tell, playing: false, window: motion.windows.contact, time: peakTime(motion)});
    this.stage = make("div", {class: "stage"}, canvas);
    this.legend = make("div", {class: "key"});
    this.button = make("button", {type: "button", class: "play"}, "Play");
    this.slider = range("Time", 1, 0.0005);
    this.clock = make("output");
    this.loud = range("Amplification", Math.log10(Math.max(20, 20 * motion.natural)), 0.01);
    this.times = make("output");
    const part = choice("Part of the run", {contact: "contact", whole: "whole run"}), home = pressable("Reset view");
    const colour = choice("Colour", Object.fromEntries(Object.entries(measures).map(([name, {label}]) => [name, label])));
    const arrows = make("input", {type: "checkbox"}), mesh = make("input", {type: "checkbox"});
    const wired = motion.bodies.some(body => body.wire), moving = motion.time.length > 1;
    const grow = (...controls) => make("label", {class: "grow"}, ...controls);
    section.append(this.stage, this.legend,
      make("div", {class: "controls"}, ...(moving ? [this.button, grow(this.slider, this.clock), part] : [])),
      make("div", {class: "controls"}, ...(moving ? [labelled("colour", colour), grow("amplify", this.loud, this.times)] : []),
           labelled(arrows, "forces"), ...(wired ? [labelled(mesh, "mesh")] : []), home),
      make("div", {class: "controls", role: "group", "aria-label": "Bodies shown"}, "show",
           ...[...motion.bodies, ...motion.obstacles].map(body => labelled(this.shower(body), body.name))));
    colour.value = motion.colour;
    arrows.checked = true;
    const on = (control, type, act) => control.addEventListener(type, () => { act(); this.show(); });
    this.button.addEventListener("click", () => this.play(!this.playing));
    on(this.slider, "input", () => { this.play(false); this.time = this.within(Number(this.slider.value)); });
    on(this.loud, "input", () => { motion.amplify = 10 ** Number(this.loud.value); });
    on(part, "change", () => {
      this.window = motion.windows[part.value];
      this.time = Math.min(this.window[1], Math.max(this.window[0], this.time));
    });
    on(colour, "change", () => { motion.colour = colour.value; this.explain(); });
    on(arrows, "change", () => { motion.arrows = arrows.checked; });
    on(mesh, "change", () => { motion.mesh = mesh.checked; });
    on(home, "click", () => { motion.home(); motion.amplify = motion.natural; });
    handle(canvas, motion, () => { if (!this.playing) this.show(); });
    this.explain();
    this.fit();
    new ResizeObserver(() => this.fit()).observe(this.stage);
  }

  /** A checkbox that shows and hides a body or an obstacle. */
  shower(body) {
    const box = make("input", {type: "checkbox", checked: ""});
    box.addEventListener("change", () => { body.visible = box.checked; this.show(); });
    return box;
  }

  /** The time at a position in the part of the run that is shown, from 0 to 1. */
  within(share) { return this.window[0] + share * (this.window[1] - this.window[0]); }

  show() {
    const {motion, time, window} = this;
    motion.draw(time);
    this.slider.value = (time - window[0]) / (window[1] - window[0]);
    this.loud.value = Math.log10(motion.amplify);
    this.clock.textContent = quantity(time, "s");
    this.times.textContent = `× ${digits(motion.amplify, 2)}`;
    this.canvas.dataset.time = time;
    this.tell(time);
  }

  explain() {
    const {motion} = this, {label, unit} = measures[motion.colour];
    const most = motion.forceMost, force = most > 0 ? `contact force, at most ${quantity(most, "N")} at a point${motion.time.length > 1 ? ", in these moments" : ""}` : "no contact force";
    const names = motion.bodies.map(body => swatch(`c${Math.max(0, body.number) % 6}`, body.name));
    this.legend.replaceChildren(...(unit ? [make("span", {}, label), rampKey(0, motion.top(), unit)] : names), ...(motion.points.state && most > 0
      ? [make("span", {}, `${force}:`), swatch("cstick", "sticks"), swatch("cslip", "slips")] : [swatch("cforce", force)]));
  }

  fit() {
    const {canvas, stage} = this, ratio = Math.min(2, devicePixelRatio || 1), wide = stage.clientWidth || 640;
    const width = Math.round(wide * ratio), height = Math.round(width * Math.max(this.motion.shape, wide < 480 ? 0.6 : 0));
    if (canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    this.show();
  }

  play(on) {
    this.playing = on;
    this.button.textContent = on ? "Pause" : "Play";
    let last = performance.now();
    const frame = now => {
      if (!this.playing) return;
      const next = this.time + Math.min(0.1, Math.max(0, now - last) / 1000) / seconds * (this.window[1] - this.window[0]);
      last = now;
      this.time = next > this.window[1] ? this.window[0] : next;
      this.show();
      requestAnimationFrame(frame);
    };
    if (on) requestAnimationFrame(frame);
  }
}

/** The time at which the force of the drawn points is largest. */
function peakTime(motion) {
  const {force, anchor} = motion.points, count = anchor.length;
  let best = 0, most = 0;
  for (let k = 0; k < motion.time.length && count; ++k) {
    const sum = force.subarray(k * count, (k + 1) * count).reduce((a, b) => a + b, 0);
    if (sum > most) { most = sum; best = k; }
  }
  return motion.time[best];
}

function remarks(motion, data) {
  const parts = ["Drag to turn, scroll or pinch to come nearer, drag with Shift to shift."];
  if (run.static) {
    parts.push("A body at rest.");
  } else {
    parts.push(motion.time.length > 1 ? `${motion.time.length} moments, straight lines between them${data.thinned > 1 ? ` (one in ${data.thinned} snapshots)` : ""};`
      : "One moment, as output.snapshot_every is large;");
    parts.push(`${data.coordinates} modal coordinates drawn by ${data.shapes} shapes, which miss at most`,
               `${digits(100 * data.missed, 2)} % of the largest deformation.`);
  }
  if (!data.static) parts.push("The result is of an earlier version: the static part of contact is not in the picture.");
  if (motion.amplify > 1)
    parts.push(`Motion since the first touch is drawn ${digits(motion.amplify, 2)} times too large; amplified surfaces may cross.`);
  if (motion.forceMost > 0) parts.push(motion.points.state ? "Spikes: normal force at each point, on both bodies, in the colour of stick or slip; red without friction."
    : "Red spikes: contact force at each point, on both bodies.");
  if (data.points.left_out > 0) parts.push(`${data.points.left_out} points of least impulse have no spike.`);
  return parts.join(" ");
}

/** A row of nine moments of the contact, from the first touch to the last. */
function rowOfMoments(motion) {
  const [from, to] = motion.touch, [across, up] = motion.spans, width = 560;
  const height = Math.round(width * Math.min(0.9, Math.max(0.2, 1.05 * up / across)));
  const cells = Array.from({length: 9}, (_, k) => {
    const time = from + k / 8 * (to - from), text = quantity(time, "s");
    const picture = make("img", {src: motion.picture(time, width, height), alt: `The bodies at ${text}`});
    return make("figure", {}, picture, make("figcaption", {}, text));
  });
  const title = run.episodes.length ? "Nine moments from first to last touch" : "Nine moments";
  return make("div", {}, make("h3", {}, title), make("div", {class: "moments"}, ...cells));
}

/** Turns, shifts and zooms the view on events of pointer, wheel, fingers and keys. */
function handle(canvas, motion, changed) {
  const down = new Map();
  const zoom = factor => { motion.view.zoom = Math.min(200, Math.max(0.2, motion.view.zoom * factor)); };
  const turn = (right, down) => {
    motion.view.azimuth += right;
    motion.view.elevation = Math.min(1.57, Math.max(-1.57, motion.view.elevation + down));
  };
  canvas.addEventListener("pointerdown", event => {
    down.set(event.pointerId, event);
    canvas.setPointerCapture(event.pointerId);
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, event => down.delete(event.pointerId));
  canvas.addEventListener("pointermove", event => {
    const before = down.get(event.pointerId);
    if (!before) return;
    const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
    if (down.size === 2) {
      const other = [...down.values()].find(pointer => pointer.pointerId !== event.pointerId);
      const apart = pointer => Math.hypot(pointer.clientX - other.clientX, pointer.clientY - other.clientY);
      zoom(apart(event) / Math.max(1, apart(before)));
    } else if (event.shiftKey) {
      motion.shift(dx / canvas.clientWidth, dy / canvas.clientWidth);
    } else {
      turn(0.008 * dx, 0.008 * dy);
    }
    down.set(event.pointerId, event);
    changed();
  });
  canvas.addEventListener("wheel", event => {
    zoom(Math.exp(-0.0015 * event.deltaY));
    event.preventDefault();
    changed();
  }, {passive: false});
  const keys = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1),
                ArrowDown: () => turn(0, 0.1), "+": () => zoom(1.2), "-": () => zoom(1 / 1.2)};
  canvas.addEventListener("keydown", event => {
    if (!keys[event.key]) return;
    keys[event.key]();
    event.preventDefault();
    changed();
  });
}
