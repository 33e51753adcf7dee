// What stands around the animation: its controls, its colours, the pointer, and the row of moments.

const seconds = 8;  // a play from end to end

/** Fills the section; `tell(time)` hears of each moment shown. */
function player(section, data, tell) {
  if (data.missing) {
    section.append(make("p", {class: "note"}, `No motion to show: ${data.missing}.`));
    if (!run.by_table)
      section.append(make("p", {class: "note"}, "Both programs need these keys of the scene, ricochet-kernel for the skins and ricochet-contact for the snapshots:"),
                     make("pre", {}, "[output]\nview = true\nsnapshot_every = 4"));
    return;
  }
  const canvas = make("canvas", {tabindex: 0, role: "img", "aria-label": "The bodies in motion. Arrow keys turn them, plus and minus change their size."});
  const motion = new Motion(data, canvas);
  if (!motion.gl) {
    section.append(make("p", {class: "warning"}, "This browser shows no WebGL 2, which the animation needs."));
    return;
  }
  const stage = make("div", {class: "stage"}, canvas), legend = make("div", {class: "key"});
  const single = moments === 1;
  let window = motion.windows.contact, time = peakTime(motion), playing = false, last = 0;

  const button = make("button", {type: "button", class: "play"}, "Play");
  const slider = make("input", {type: "range", min: 0, max: 1, step: 0.0005, "aria-label": "Time"}), clock = make("output");
  const loud = make("input", {type: "range", min: 0, max: Math.log10(Math.max(20, 20 * motion.natural)), step: 0.01, "aria-label": "Amplification"});
  const times = make("output");
  const spans = make("select", {"aria-label": "Part of the run"}, make("option", {value: "contact"}, "contact"), make("option", {value: "whole"}, "whole run"));
  const colours = make("select", {}, ...Object.entries(measures).map(([name, {label}]) => make("option", {value: name}, label)));
  const arrows = make("input", {type: "checkbox"}), mesh = make("input", {type: "checkbox"}), home = make("button", {type: "button"}, "Reset view");
  colours.value = motion.colour;
  arrows.checked = true;

  function show(at = time) {
    time = at;
    motion.draw(time);
    slider.value = (time - window[0]) / (window[1] - window[0]);
    clock.textContent = quantity(time, "s");
    times.textContent = `× ${digits(motion.amplify, 2)}`;
    canvas.dataset.time = time;
    tell(time);
  }
  function explain() {
    const measure = measures[motion.colour], names = motion.bodies.map(body => make("span", {}, make("i", {class: `swatch c${Math.max(0, body.number) % 6}`}), body.name));
    const red = make("span", {}, make("i", {class: "swatch cforce"}), motion.forceMost > 0 ? `contact force, at most ${quantity(motion.forceMost, "N")} at a point, in these moments` : "no contact force");
    legend.replaceChildren(...(measure.unit ? [make("span", {}, measure.label), rampKey(0, motion.top(), measure.unit)] : names), red);
  }
  function fitCanvas() {
    const ratio = Math.min(2, devicePixelRatio || 1), width = Math.round((stage.clientWidth || 640) * ratio);
    const height = Math.round(width * Math.max(motion.shape, stage.clientWidth < 480 ? 0.6 : 0));
    if (canvas.width === width && canvas.height === height) return;
    [canvas.width, canvas.height] = [width, height];
    show();
  }
  function frame(now) {
    if (!playing) return;
    const next = time + Math.min(0.1, Math.max(0, now - last) / 1000) / seconds * (window[1] - window[0]);
    last = now;
    show(next > window[1] ? window[0] : next);
    requestAnimationFrame(frame);
  }
  function play(on) {
    playing = on;
    button.textContent = on ? "Pause" : "Play";
    last = performance.now();
    if (on) requestAnimationFrame(frame);
  }

  button.addEventListener("click", () => play(!playing));
  slider.addEventListener("input", () => { play(false); show(window[0] + Number(slider.value) * (window[1] - window[0])); });
  loud.addEventListener("input", () => { motion.amplify = 10 ** Number(loud.value); show(); });
  spans.addEventListener("change", () => { window = motion.windows[spans.value]; show(Math.min(window[1], Math.max(window[0], time))); });
  colours.addEventListener("change", () => { motion.colour = colours.value; explain(); show(); });
  arrows.addEventListener("change", () => { motion.arrows = arrows.checked; show(); });
  mesh.addEventListener("change", () => { motion.mesh = mesh.checked; show(); });
  home.addEventListener("click", () => { motion.home(); motion.amplify = motion.natural; loud.value = Math.log10(motion.amplify); show(); });
  handle(canvas, motion, () => { if (!playing) show(); });
  loud.value = Math.log10(motion.amplify);

  const label = (text, ...controls) => make("label", {}, text, ...controls);
  section.append(stage, legend);
  if (!single)
    section.append(make("div", {class: "controls"}, button, make("label", {class: "grow"}, slider, clock), spans));
  section.append(make("div", {class: "controls"}, ...(single ? [] : [label("colour", colours), make("label", {class: "grow"}, "amplify", loud, times)]),
                      label("", arrows, "forces"), ...(motion.bodies.some(body => body.wire) ? [label("", mesh, "mesh")] : []), home));
  explain();
  fitCanvas();
  canvas.dataset.covered = motion.covered();
  canvas.dataset.moments = moments;
  new ResizeObserver(fitCanvas).observe(stage);
  section.append(make("p", {class: "note"}, remarks(motion, data)));
  if (!single) section.append(rowOfMoments(motion));
  show(time);
}

/** When the force of the drawn points is largest. */
function peakTime(motion) {
  const {force} = motion.points, count = motion.points.anchor.length;
  let best = 0, most = 0;
  for (let k = 0; k < moments && count; ++k) {
    const sum = force.subarray(k * count, (k + 1) * count).reduce((a, b) => a + b, 0);
    if (sum > most) { most = sum; best = k; }
  }
  return motion.time[best];
}

function remarks(motion, data) {
  const parts = ["Drag to turn, scroll or pinch to come nearer, drag with Shift to shift."];
  parts.push(run.static ? "A body at rest: its displacement lies in the static part of contact, which the skin does not show."
    : `${moments} moment${moments > 1 ? "s" : ": a smaller output.snapshot_every gives more"}, straight lines between them${data.thinned > 1 ? ` (one in ${data.thinned} snapshots)` : ""}; ${data.coordinates} modal coordinates drawn by ${data.shapes} shapes, which miss at most ${digits(100 * data.missed, 2)} % of the largest deformation. The static part of contact is not in the picture.`);
  if (motion.amplify > 1) parts.push(`Motion since the first touch is drawn ${digits(motion.amplify, 2)} times too large; amplified surfaces may cross.`);
  if (motion.forceMost > 0) parts.push("Red spikes: contact force at each point, on both bodies.");
  if (data.points.left_out > 0) parts.push(`${data.points.left_out} points of least impulse have no spike.`);
  return parts.join(" ");
}

/** Nine moments of the contact, from first to last touch. */
function rowOfMoments(motion) {
  const [from, to] = motion.touch, width = 560, height = Math.round(width * Math.min(0.9, Math.max(0.2, 1.05 * motion.spans[1] / motion.spans[0])));
  const cells = Array.from({length: 9}, (_, k) => {
    const time = from + k / 8 * (to - from);
    return make("figure", {}, make("img", {src: motion.picture(time, width, height), alt: `The bodies at ${quantity(time, "s")}`}), make("figcaption", {}, quantity(time, "s")));
  });
  return make("div", {}, make("h3", {}, run.episodes.length ? "Nine moments from first to last touch" : "Nine moments"), make("div", {class: "moments"}, ...cells));
}

/** Turning, shifting and zooming by pointer, wheel, fingers and keys. */
function handle(canvas, motion, changed) {
  const down = new Map();
  const zoom = factor => { motion.view.zoom = Math.min(200, Math.max(0.2, motion.view.zoom * factor)); };
  const turn = (right, up) => {
    motion.view.azimuth += right;
    motion.view.elevation = Math.min(1.57, Math.max(-1.57, motion.view.elevation + up));
  };
  canvas.addEventListener("pointerdown", event => { down.set(event.pointerId, event); canvas.setPointerCapture(event.pointerId); });
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
      const rows = motion.turn(), pixel = Math.max(motion.spans[0], motion.spans[1] * canvas.clientWidth / canvas.clientHeight) / (canvas.clientWidth * motion.view.zoom);
      motion.target = motion.target.map((x, i) => x - pixel * (dx * rows[0][i] - dy * rows[1][i]));
    } else {
      turn(0.008 * dx, 0.008 * dy);
    }
    down.set(event.pointerId, event);
    changed();
  });
  canvas.addEventListener("wheel", event => { zoom(Math.exp(-0.0015 * event.deltaY)); event.preventDefault(); changed(); }, {passive: false});
  canvas.addEventListener("keydown", event => {
    const act = {ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1), ArrowDown: () => turn(0, 0.1),
                 "+": () => zoom(1.2), "-": () => zoom(1 / 1.2)}[event.key];
    if (!act) return;
    act();
    event.preventDefault();
    changed();
  });
}
