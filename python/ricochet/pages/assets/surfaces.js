// SPDX-License-Identifier: BSD-2-Clause
// The page of a drawing: its surfaces in 3D with numbers, picked by pointer, keys or table, and the line that a scene needs for them.

const {faces, scale} = run;
const letter = 7, line = 12;  // width and height of a letter, at most [pixels of the page]
const reach = [0, 1, 2].map(i => [Math.min(...faces.map(face => face.low[i])), Math.max(...faces.map(face => face.high[i]))]);
const size = Math.max(...reach.map(([low, high]) => high - low));
const length = prefixed(size, "m");

const metres = x => digits(Math.abs(x) < 1e-6 * size ? 0 : x * length.factor);
const area = face => digits(face.area * length.factor ** 2);
const squared = `${length.unit}²`;
const triple = values => `(${values.map(metres).join(", ")}) ${length.unit}`;
const names = face => face.groups.join(", ");
const title = face => `surface ${face.number}${face.groups.length ? `, ${names(face)}` : ""}`;
const axis = normal => normal.map(x => digits(Math.abs(x) < 1e-6 ? 0 : x, 3)).join(", ");

/** The line of a scene that names surfaces: by group if a group means this surface alone. */
function contactOf(chosen) {
  const values = chosen.map(k => JSON.stringify(faces[k].names[0]));
  return `contact = ${values.length === 1 ? values[0] : `[${values.join(", ")}]`}`;
}

/** Copies text, also where the page may not use the clipboard by itself. Returns whether it could. */
async function copy(text, shown) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection().selectAllChildren(shown);
    return document.execCommand("copy");
  }
}

class Surfaces {
  constructor(section, aside, list) {
    const label = `The ${plural(faces.length, "surface")} of ${run.title}. Click one to choose it, with Shift to choose several. ` +
      "Arrow keys turn the drawing, plus and minus change its size, n and p choose the next and the previous surface, Escape none.";
    this.canvas = make("canvas", {tabindex: 0, role: "application", "aria-label": label});
    this.motion = new Motion(run.motion, this.canvas);
    Object.assign(this, {aside, chosen: [], over: -1});
    this.buttons = [];
    if (this.motion.gl) this.build(section);
    else section.append(note("This browser shows no WebGL 2, which the picture of the surfaces needs."));
    this.list(list);
    this.tell();
  }

  build(section) {
    const {canvas, motion} = this;
    for (const [k, body] of motion.bodies.entries()) body.number = faces[k].colour;
    this.picture = new Picture(motion);
    this.overlay = new Overlay(motion);
    this.labels = draw("svg", {class: "overlay labels", "aria-hidden": "true"});
    this.tip = make("div", {class: "tip"});
    this.stage = make("div", {class: "stage"}, canvas, this.labels, this.overlay.element, this.tip);
    section.append(this.stage, this.controls(), note("A surface has its number where that is seen and has room: come nearer for small ones. " + handling));
    this.listen();
    handle(canvas, motion, () => this.show());
    new ResizeObserver(() => requestAnimationFrame(() => this.fit())).observe(this.stage);
    addEventListener("resize", () => this.fit());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.show());
    this.fit();
  }

  controls() {
    const {motion} = this, look = (text, ...angles) => pressable(text, () => { motion.look(...angles); this.show(); });
    this.hider = pressable("Hide", () => this.hide());
    this.shower = pressable("Show all", () => this.reveal());
    const views = make("div", {class: "controls", role: "group", "aria-label": "View"}, "view", look("front", 0, 0), look("back", Math.PI, 0),
      look("side", -Math.PI / 2, 0), look("above", 0, Math.PI / 2), look("below", 0, -Math.PI / 2), pressable("reset", () => { motion.home(); this.show(); }));
    const surfaces = make("div", {class: "controls", role: "group", "aria-label": "Surfaces"}, "surface", pressable("Previous", () => this.step(-1)),
      pressable("Next", () => this.step(1)), this.hider, this.shower);
    return make("div", {class: "panel"}, views, surfaces);
  }

  /** A click chooses; a drag turns the view. */
  listen() {
    const {canvas} = this;
    let down = null;
    canvas.addEventListener("pointerdown", event => { down = down ? "several" : event; });
    canvas.addEventListener("pointerup", event => {
      const still = down?.clientX !== undefined && Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) < 5;
      down = null;
      if (still) this.choose(this.under(event), event.shiftKey || event.ctrlKey || event.metaKey);
    });
    canvas.addEventListener("pointercancel", () => { down = null; });
    canvas.addEventListener("pointermove", event => { if (!event.buttons && event.pointerType !== "touch") this.hover(this.under(event), event); });
    canvas.addEventListener("pointerleave", () => this.hover(-1));
    const keys = {n: () => this.step(1), p: () => this.step(-1), Escape: () => this.choose(-1)};
    canvas.addEventListener("keydown", event => {
      if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      keys[event.key]();
      event.preventDefault();
    });
  }

  /** The index of the surface below the pointer, or -1. */
  under({clientX, clientY}) {
    const box = this.canvas.getBoundingClientRect();
    return this.picture.at(clientX - box.left, clientY - box.top);
  }

  hover(k, event) {
    const {tip, stage} = this;
    tip.style.visibility = k < 0 ? "hidden" : "visible";
    if (k >= 0) {
      const box = stage.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
      tip.textContent = `${title(faces[k])}: ${faces[k].kind}, ${area(faces[k])} ${squared}`;
      tip.style.left = `${Math.max(4, Math.min(x + 14, stage.clientWidth - tip.offsetWidth - 6))}px`;
      tip.style.top = `${y + 20 + tip.offsetHeight > stage.clientHeight ? y - 8 - tip.offsetHeight : y + 20}px`;
    }
    if (k === this.over) return;
    this.over = k;
    this.paint();
  }

  /** Chooses a surface, or none if k is -1. With `more`, it joins those that are chosen, or leaves them. */
  choose(k, more = false) {
    const {chosen} = this;
    if (k < 0) this.chosen = more ? chosen : [];
    else if (more) this.chosen = chosen.includes(k) ? chosen.filter(other => other !== k) : [...chosen, k];
    else this.chosen = [k];
    this.tell();
    if (this.picture) this.show();
  }

  step(way) {
    const last = this.chosen.at(-1) ?? (way > 0 ? -1 : 0), k = (last + way + faces.length) % faces.length;
    this.choose(k);
    this.face(k);
  }

  /** Turns to the side from which most of a surface is seen, unless enough of it is seen already. */
  face(k) {
    const {motion, picture, canvas} = this, size = [canvas.clientWidth / 2, canvas.clientHeight / 2], enough = 30;
    if (!picture || picture.share(k) >= enough) return;
    motion.bodies[k].visible = true;
    let best = null;
    for (const elevation of [0.5, -0.5, 0, 1.2, -1.2])
      for (let eighth = 0; eighth < 8; ++eighth) {
        const azimuth = 0.6 + eighth * Math.PI / 4;
        motion.look(azimuth, elevation);
        motion.aim();
        picture.take(...size);
        const share = picture.share(k);
        if (!(share <= best?.share)) best = {azimuth, elevation, share};
      }
    motion.look(best.azimuth, best.elevation);
    this.show();
  }

  /** Hides the chosen surfaces, so that those behind them are seen. */
  hide() {
    for (const k of this.chosen) this.motion.bodies[k].visible = false;
    this.choose(-1);
  }

  reveal() {
    for (const body of this.motion.bodies) body.visible = true;
    this.choose(-1);
  }

  // ---- Drawing ----

  /** Draws the surfaces in pale colours, and those that are chosen or below the pointer in a strong one. */
  paint() {
    const {motion, chosen, over} = this, paper = cssColour("--stage"), strong = cssColour("--slip");
    const mix = (colour, share) => colour.map((part, i) => share * part + (1 - share) * paper[i]);
    for (const [k, body] of motion.bodies.entries()) {
      const own = cssColour(`--body${body.number % 6}`);
      body.ink = chosen.includes(k) ? strong : mix(own, k === over ? 0.85 : body.number < 6 ? 0.5 : 0.3);
    }
    motion.draw(0);
  }

  show() {
    const {canvas, motion, chosen} = this, wide = canvas.clientWidth || 640, high = canvas.clientHeight || 400;
    this.paint();
    this.picture.take(wide, high);
    this.overlay.update(wide, high);
    this.labels.setAttribute("viewBox", `0 0 ${wide} ${high}`);
    this.labels.replaceChildren(...this.picture.rooms().flatMap((room, k) => this.label(room, k)));
    const hidden = motion.bodies.filter(body => !body.visible).length;
    this.hider.disabled = !chosen.length;
    this.shower.disabled = !hidden;
    this.shower.textContent = hidden ? `Show all (${hidden} hidden)` : "Show all";
  }

  /** The label of a surface, if what is seen of it has room: its number, and its groups if they fit beside it. */
  label(room, k) {
    const number = String(faces[k].number), full = `${number} ${names(faces[k])}`, {cell} = this.picture;
    const fits = room && (2 * room.half - 1) * cell[0] >= letter * number.length && (2 * room.half - 1) * cell[1] >= line - 2;
    if (!fits && !(room && this.chosen.includes(k))) return [];
    const text = faces[k].groups.length && letter * full.length <= room.wide ? full : number;
    return [draw("text", {x: room.x, y: room.y + 4, "text-anchor": "middle", "data-surface": number}, text)];
  }

  /** Sizes the canvas so that it and its controls fit into the window. */
  fit() {
    const {canvas, stage, motion} = this, ratio = Math.min(2, devicePixelRatio || 1), wide = stage.clientWidth || 640;
    const top = stage.getBoundingClientRect().top + scrollY, room = Math.max(260, innerHeight - top - 110);
    const high = Math.min(room, wide * (wide < 480 ? 1 : Math.max(motion.shape, 0.7)));
    const [width, height] = [wide * ratio, high * ratio].map(Math.round);
    if (canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    canvas.style.height = `${height / ratio}px`;
    this.show();
  }

  // ---- Text ----

  /** Describes the surfaces that are chosen. */
  tell() {
    const {aside, chosen} = this;
    for (const [k, button] of this.buttons.entries()) button.setAttribute("aria-pressed", String(chosen.includes(k)));
    if (!chosen.length) return aside.replaceChildren(note("Choose a surface in the picture or in the table: its measures are then here, with the line that " +
      "names it in a scene. Shift with a click chooses several."));
    const shown = make("pre", {}, contactOf(chosen)), button = pressable("Copy", async () => {
      button.textContent = await copy(shown.textContent, shown) ? "Copied" : "Select and copy";
    });
    aside.replaceChildren(make("h2", {}, chosen.length === 1 ? title(faces[chosen[0]]) : plural(chosen.length, "surface")), shown, button,
                          ...(chosen.length === 1 ? [this.measures(faces[chosen[0]])] : [this.sum()]));
  }

  measures(face) {
    const all = face.names.slice(1).map(name => `"${name}"`).join(", ");
    const rows = [["kind", face.kind], ["area", `${area(face)} ${squared}`], ["from", triple(face.low)], ["to", triple(face.high)],
                  ["centre of area", triple(face.centre)]];
    if (face.normal) rows.push(["outward normal", `(${axis(face.normal)})`]);
    if (all) rows.push(["also", all]);
    return table(null, rows.map(cells => row(...cells)));
  }

  sum() {
    const total = this.chosen.reduce((sum, k) => sum + faces[k].area, 0);
    return table(null, [row("numbers", this.chosen.map(k => faces[k].number).join(", ")), row("area", `${digits(total * length.factor ** 2)} ${squared}`)]);
  }

  /** The table of all surfaces. */
  list(section) {
    const grouped = faces.some(face => face.groups.length);
    const span = ({low, high}, i) => metres(low[i]) === metres(high[i]) ? metres(low[i]) : `${metres(low[i])} to ${metres(high[i])}`;
    const rows = faces.map((face, k) => {
      const button = make("button", {type: "button", "aria-pressed": "false", "aria-label": `Choose ${title(face)}`}, String(face.number));
      button.addEventListener("click", event => {
        this.choose(k, event.shiftKey || event.ctrlKey || event.metaKey);
        if (this.chosen.includes(k)) this.face(k);
      });
      this.buttons.push(button);
      return row(button, ...(grouped ? [names(face)] : []), face.kind, area(face), ...[0, 1, 2].map(i => span(face, i)));
    });
    const head = ["surface", ...(grouped ? ["group"] : []), "kind", `area (${squared})`, ..."xyz".split("").map(name => `${name} (${length.unit})`)];
    section.append(fill(table(head, rows), {class: "wide numbers across"}, []));
  }
}

const spans = reach.map(([low, high]) => metres(high - low)).join(" × ");
section("verdict").textContent = `${plural(faces.length, "surface")}, ${spans} ${length.unit}. ` +
  (scale === 1 ? "Lengths hold for scale = 1, a drawing in metres: for another unit, give --scale to ricochet surfaces." : `A unit of the drawing is ${quantity(scale, "m")}: give the body scale = ${scale}.`);
const surfaces = new Surfaces(section("motion"), section("picked"), section("surfaces"));
document.documentElement.dataset.ready = "yes";
