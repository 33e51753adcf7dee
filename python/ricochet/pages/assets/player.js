// SPDX-License-Identifier: BSD-2-Clause
// The surroundings of the animation: controls, colours, the pointer, and the row of moments.

const seconds = 8;  // duration of a play from end to end, at speed 1
const period = 2;  // duration of a period of a mode, likewise

const swatch = (colour, text) => make("span", {}, make("i", {class: `swatch ${colour}`}), text);
const range = (name, min, max, step) => make("input", {type: "range", min, max, step, "aria-label": name});
const choice = (name, options) =>
  make("select", {"aria-label": name}, ...Object.entries(options).map(([value, text]) => make("option", {value}, text)));
const labelled = (text, ...controls) => make("label", {}, text, ...controls);
const pressable = (text, act) => {
  const button = make("button", {type: "button"}, text);
  button.addEventListener("click", act);
  return button;
};
const silent = () => make("output", {"aria-live": "off"});  // otherwise every frame would be read aloud

/** Fills the section. Calls `tell(time)` for each moment shown. Returns the player, or nothing if there is no picture. */
function player(section, data, tell) {
  const say = text => section.append(make("p", {class: "note"}, text));
  const keys = () => {
    say("Both programs need these keys of the scene, ricochet-kernel for the visualisation surfaces and ricochet-contact for the snapshots:");
    section.append(make("pre", {}, `[output]\nview = true\nsnapshot_every = ${run.static ? 1 : 4}`));
  };
  if (data.missing) {
    say(`No ${run.static ? "picture of the bodies" : "motion"} to show: ${data.missing}.`);
    if (!run.by_table) keys();
    return undefined;
  }
  const label = "The bodies in motion. Arrow keys turn them, plus and minus change their size.";
  const canvas = make("canvas", {tabindex: 0, role: "img", "aria-label": label});
  const motion = new Motion(data, canvas);
  if (!motion.gl) return void say("This browser shows no WebGL 2, which the animation needs.");
  const shown = new Player(section, motion, canvas, tell);
  if (!data.snapshots) keys();
  if (motion.time.length > 1) section.append(rowOfMoments(motion));
  shown.show();  // draws again, because the row of moments has used the canvas
  canvas.dataset.moments = motion.time.length;
  canvas.dataset.covered = motion.covered();
  return shown;
}

class Player {
  constructor(section, motion, canvas, tell) {
    Object.assign(this, {motion, canvas, tell, playing: false, window: motion.windows.contact, time: peakTime(motion), phase: 0.25});
    this.overlay = new Overlay(motion);
    this.stage = make("div", {class: "stage"}, canvas, this.overlay.element);
    this.legend = make("div", {class: "key"});
    this.panel = this.controls();
    this.cockpit = make("div", {class: "cockpit", role: "group", "aria-label": "Motion and its controls"}, this.stage, this.legend, this.panel);
    this.remark = make("p", {class: "note"});
    section.append(this.cockpit, this.remark);
    handle(canvas, motion, () => { if (!this.playing) this.show(); });
    this.explain();
    this.fit();
    const watch = new ResizeObserver(() => this.fit());
    for (const part of [this.legend, this.panel]) watch.observe(part);  // not the stage, whose height follows from theirs
    addEventListener("resize", () => this.fit());
  }

  controls() {
    const {motion} = this, moving = motion.time.length > 1;
    const grow = (...controls) => make("label", {class: "grow"}, ...controls);
    const on = (control, act) => control.addEventListener(control.type === "range" ? "input" : "change", () => { act(); this.show(); });
    const look = (text, azimuth, elevation) => pressable(text, () => { motion.look(azimuth, elevation); this.show(); });
    this.button = pressable("Play", () => this.play(!this.playing));
    this.button.className = "play";
    this.slider = range("Time", 0, 1, 0.0005);
    this.clock = silent();
    this.speed = choice("Speed", {0.25: "¼", 0.5: "½", 1: "1", 2: "2", 4: "4"});
    this.slower = silent();
    this.loud = range("Amplification", 0, Math.log10(motion.data.amplify.most), 0.02);
    this.times = silent();
    this.part = choice("Part of the run", {contact: "contact", whole: "whole run"});
    const measurable = motion.measurable();
    this.colour = choice("Colour", Object.fromEntries(measurable.map(name => [name, measures[name].label])));
    const arrows = make("input", {type: "checkbox", checked: ""}), mesh = make("input", {type: "checkbox"});
    const home = pressable("reset", () => { motion.home(); motion.amplify = motion.natural; this.show(); });
    this.speed.value = "1";
    this.colour.value = motion.colour;
    on(this.slider, () => { this.play(false); this.move(Number(this.slider.value)); });
    on(this.speed, () => {});
    on(this.loud, () => { motion.amplify = Number((10 ** this.loud.value).toPrecision(2)); });
    on(this.part, () => {
      this.window = motion.windows[this.part.value];
      this.time = Math.min(this.window[1], Math.max(this.window[0], this.time));
      if (motion.turning) motion.frame(this.window);  // a body that tumbles leaves the place of its contact
    });
    on(this.colour, () => { motion.colour = this.colour.value; this.explain(); });
    on(arrows, () => { motion.arrows = arrows.checked; });
    on(mesh, () => { motion.mesh = mesh.checked; });
    this.timed = make("div", {class: "controls"}, this.button, grow(this.slider, this.clock), labelled("speed", this.speed, this.slower));
    this.ofImpact = make("div", {class: "controls"},
      ...(moving ? [labelled("show", this.part), grow("amplify", this.loud, this.times)] : []),
      ...(measurable.length > 1 ? [labelled("colour", this.colour)] : []),
      labelled(arrows, "forces"),
      make("span", {role: "group", "aria-label": "Bodies shown"},
        ...[...motion.bodies, ...motion.obstacles].map(body => labelled(this.shower(body), body.name))));
    this.ofMode = make("div", {class: "controls", hidden: ""});
    const views = make("div", {class: "controls", role: "group", "aria-label": "View"}, "view", look("front", 0, 0),
      look("side", -Math.PI / 2, 0), look("above", 0, Math.PI / 2), home,
      ...(motion.bodies.some(body => body.wire) ? [labelled(mesh, "mesh")] : []), ...(filmType ? [this.filming()] : []));
    this.timed.hidden = !moving;
    return make("div", {class: "panel"}, this.timed, this.ofImpact, this.ofMode, views);
  }

  /** A checkbox that shows and hides a body or an obstacle. */
  shower(body) {
    const box = make("input", {type: "checkbox", checked: ""});
    box.addEventListener("change", () => { body.visible = box.checked; this.show(); });
    return box;
  }

  /** A button that plays the part that is shown from its start to its end, and saves it as a film. */
  filming() {
    const button = pressable("film", () => this.film ? this.endFilm() : this.startFilm());
    button.title = "Plays once and saves it as a WebM film; press again to end it";
    return this.filmButton = button;
  }

  startFilm() {
    this.move(0);
    this.film = new Film(this.canvas, film => download(`${run.slug ?? "modes"}.webm`, film));
    this.filmButton.setAttribute("aria-pressed", "true");
    this.show();  // otherwise the film would begin with an empty frame
    this.play(true);
  }

  endFilm() {
    this.film.stop();
    this.film = null;
    this.filmButton.setAttribute("aria-pressed", "false");
    this.play(false);
  }

  /** Adds the frame that is shown to the film. */
  takeFrame() {
    const {motion} = this, {unit} = measures[motion.colour];
    const texts = motion.mode ? [this.title] : [run.title, `${this.clock.textContent}${this.slower.textContent && `, ${this.slower.textContent}`}`];
    this.film.take(texts, motion.mode ? [0, 1, ""] : unit ? [0, motion.top(), unit] : null);
  }

  /** Goes to a share of the part of the run that is shown, or of the period of the mode. */
  move(share) {
    if (this.motion.mode) this.phase = share;
    else this.time = this.window[0] + share * (this.window[1] - this.window[0]);
  }

  /** Plays a mode of a body, or shows the impact again if no body is given. */
  turnTo(body, number, title) {
    const {motion, canvas} = this;
    motion.showMode(body, number);
    this.title = title;
    this.ofMode.hidden = !body;
    this.ofImpact.hidden = Boolean(body);
    this.timed.hidden = !body && motion.time.length === 1;
    canvas.dataset.mode = body ? number : "";
    this.phase = 0.25;
    this.explain();
    this.fit();
    this.show();
    this.play(Boolean(body) && !soft.matches);
  }

  show() {
    const {motion, time, window} = this, {mode} = motion;
    motion.draw(mode ? this.phase : time);
    this.overlay.update(this.stage.clientWidth || 640, this.canvas.clientHeight || 400);
    this.slider.value = mode ? this.phase : (time - window[0]) / (window[1] - window[0]);
    this.loud.value = Math.log10(motion.amplify);
    this.clock.textContent = mode ? `${this.phase.toFixed(2)} period` : quantity(time, "s");
    this.times.textContent = `× ${digits(motion.amplify, 2)}`;
    const slower = seconds / this.speed.value / (window[1] - window[0]);
    this.slower.textContent = mode || motion.time.length === 1 ? "" : `${slower < 1 ? `${digits(1 / slower, 2)} times faster` : `${digits(slower, 2)} times slower`} than real`;
    this.slider.setAttribute("aria-valuetext", this.clock.textContent);
    this.loud.setAttribute("aria-valuetext", this.times.textContent);
    this.canvas.dataset[mode ? "phase" : "time"] = mode ? this.phase : time;
    const text = mode ? remarkOnMode(motion) : remarks(motion, motion.data);
    if (this.remark.textContent !== text) this.remark.textContent = text;
    if (!mode) this.tell(time);
    if (this.film) this.takeFrame();
  }

  explain() {
    const {motion} = this, {label, unit} = measures[motion.colour];
    if (motion.mode) return this.legend.replaceChildren(make("b", {}, this.title), make("span", {}, "displacement, relative"), rampKey(0, 1, ""));
    const most = motion.forceMost, force = most > 0 ? `contact force, at most ${quantity(most, "N")} at a point${motion.time.length > 1 ? ", in these moments" : ""}` : "no contact force";
    const names = motion.bodies.map(body => swatch(`c${Math.max(0, body.number) % 6}`, body.name));
    this.legend.replaceChildren(...(unit ? scaleOf(motion, label, unit) : names), ...(motion.points.state && most > 0
      ? [make("span", {}, `${force}:`), swatch("cstick", "sticks"), swatch("cslip", "slips")] : [swatch("cforce", force)]));
  }

  /** Sizes the canvas so that it and all controls fit into the window, from the top of the page if the section is near it. */
  fit() {
    const {canvas, stage, cockpit, motion} = this, ratio = Math.min(2, devicePixelRatio || 1), wide = stage.clientWidth || 640;
    const top = cockpit.getBoundingClientRect().top + scrollY, near = top < 0.45 * innerHeight;
    const room = innerHeight - (cockpit.offsetHeight - stage.offsetHeight) - (near ? top : 8) - 12;
    const wanted = wide * Math.max(motion.shape, wide < 480 ? 0.75 : 0.45);
    const [width, height] = [wide * ratio, Math.min(wanted, Math.max(room, 180)) * ratio].map(Math.round);
    if (canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    canvas.style.height = `${height / ratio}px`;
    this.show();
  }

  play(on) {
    if (on === this.playing) return;
    this.playing = on;
    this.button.textContent = on ? "Pause" : "Play";
    let last = performance.now();
    const frame = now => {
      if (!this.playing) return;
      const {motion, window} = this, past = Math.min(0.1, Math.max(0, now - last) / 1000) * this.speed.value;
      last = now;
      if (motion.mode) this.phase += past / period;
      else this.time += past / seconds * (window[1] - window[0]);
      if (this.film && (motion.mode ? this.phase >= 1 : this.time > window[1])) return this.endFilm();
      this.phase %= 1;
      if (this.time > window[1]) this.time = window[0];
      this.show();
      requestAnimationFrame(frame);
    };
    if (on) requestAnimationFrame(frame);
  }
}

/** The scale of the colours, and the largest value of all steps where it is known. */
function scaleOf(motion, label, unit) {
  const largest = motion.largest();
  return [make("span", {}, label), rampKey(0, motion.top(), unit),
          ...(largest === undefined ? [] : [make("span", {}, `at most ${quantity(largest, unit, 3)} in the run`)])];
}

/** The time at which the force of the drawn points is largest. */
function peakTime(motion) {
  let best = 0, most = 0;
  for (let k = 0; k < motion.time.length && motion.points.anchor.length; ++k) {
    const [from, to, shift] = motion.pointsAt(k), sum = motion.points.force.subarray(from + shift, to + shift).reduce((a, b) => a + b, 0);
    if (sum > most) { most = sum; best = k; }
  }
  return motion.time[best];
}

const handling = "Drag to turn, scroll or pinch to come nearer, drag with Shift to shift.";

function remarks(motion, data) {
  const parts = [handling];
  if (motion.amplify > 1) {
    parts.unshift(`Deformation is drawn ${digits(motion.amplify, 2)} times too large, and rigid motion as it is, so surfaces that touch ` +
      "seem to cross or to stand apart. Only × 1 is true to scale.");
  }
  if (!data.snapshots) {
    parts.push("The result has no snapshots, so only the bodies before the motion and their modes are shown.");
  } else if (run.static) {
    parts.push("A body at rest.");
  } else {
    parts.push(motion.time.length > 1 ? `${motion.time.length} moments, straight lines ${motion.turning ? "and even turns " : ""}between them${data.thinned > 1 ? ` (one in ${data.thinned} snapshots)` : ""};`
      : "One moment, as output.snapshot_every is large;");
    parts.push(`${data.coordinates} modal coordinates drawn by ${data.shapes} shapes, which miss at most`,
               `${digits(100 * data.missed, 2)} % of the largest deformation.`);
    if (motion.stressed) parts.push(`Stresses are drawn by fewer fields, too, which miss at most ${digits(100 * data.stress_missed, 2)} % of the largest component.`);
  }
  if (data.snapshots && !data.static) parts.push("The result is of an earlier version: the static part of contact is not in the picture.");
  if (motion.forceMost > 0) parts.push(motion.points.state ? "Spikes: normal force at each point, on both bodies, in the colour of stick or slip; red without friction."
    : "Red spikes: contact force at each point, on both bodies.");
  if (data.points.left_out > 0) parts.push(`${data.points.left_out} points of least impulse have no spike.`);
  return parts.join(" ");
}

const remarkOnMode = motion => `The largest displacement is drawn as ${100 * motion.mode.share} % of the size of the body; ` +
  `the amplitude of a mode alone has no meaning. ${handling}`;

/** A row of moments of the contact that differ from each other. */
function rowOfMoments(motion) {
  const times = motion.data.pictures.map(k => motion.time[k]), {urls, top} = motion.pictures(times, 560);
  const cells = times.map((time, k) => {
    const text = quantity(time, "s"), picture = make("img", {src: urls[k], alt: `The bodies at ${text}`});
    return make("figure", {}, picture, make("figcaption", {}, text));
  });
  const scale = motion.natural > 1 ? `deformation × ${digits(motion.natural, 2)}` : "true to scale", {label, unit} = measures[motion.colour];
  return make("div", {}, make("h3", {}, `${plural(cells.length, "moment")} ${run.episodes.length ? "of the contact" : "of the run"}, ${scale}`),
              make("div", {class: "key"}, make("span", {}, label), rampKey(0, top, unit)), make("div", {class: "moments"}, ...cells));
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
