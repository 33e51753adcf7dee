// SPDX-License-Identifier: BSD-2-Clause
// Fills the sections of the page with the data of the run.

const {summary} = run;
const code = text => make("code", {}, text);
const percent = value => `${digits(100 * value, 3)} %`;

/** Text for a figure of the run, with its exact value as an attribute. */
const keyed = (key, value, text) => make("span", {"data-key": key, "data-value": JSON.stringify(value)}, text);

const figure = (key, value, unit) =>
  keyed(key, value, typeof value === "number" ? quantity(value, unit) : value === null ? "–" : String(value));

/** The components of a vector as text. Components that are round-off of the largest one are shown as 0. */
function vector(values, unit) {
  const least = 1e-6 * Math.max(...values.map(Math.abs));
  return `(${values.map(x => digits(Math.abs(x) < least ? 0 : x)).join(", ")}) ${unit}`;
}

// Names of columns; the descriptions below are their titles.
const short = {impulse_ns: "impulse", peak_force_n: "peak force", approach_m_per_s: "approach", restitution: "restitution"};

// Description and unit of each key of summary.json.
const glosses = {
  contact_start_s: ["first touch", "s"],
  contact_end_s: ["last touch; – while touching at the end", "s"],
  duration_s: ["simulated time", "s"],
  contact_steps: ["steps with a force"],
  peak_force_n: ["largest sum of contact forces in a step", "N"],
  impulse_ns: ["contact forces summed over time", "N s"],
  restitution: ["minus exit over approach velocity along the impulse"],
  energy_drift: ["what the energy ledger fails to account for, relative"],
  energy_lost_contact: ["taken by contact, over the energy put in"],
  energy_lost_friction: ["heat of friction, over the energy put in"],
  friction_impulse_ns: ["friction summed over time, as a vector for each pair", "N s"],
  max_slip_m: ["longest path that a pressed point slipped", "m"],
  ambiguous_steps: ["steps in which other forces would also obey friction"],
  max_penetration_m: ["deepest penetration", "m"],
  limited_steps: ["steps that max_pivots cut short"],
  limited_residual: ["the worst of them"],
  modes_in_residual: ["modes faster than half the rate: quasi-static"],
  precision: ["of the products of steps"],
  candidates: ["paired contact points"],
  unpaired: ["candidates that face nothing"],
  max_active: ["most points that touched at once"],
  real_time_factor: ["simulated time over time of stepping"],
  wall_s: ["time of ricochet-contact", "s"],
  iterations: ["complementarity problems solved"],
  imbalance: ["what forces and loads do not cancel, relative"],
  force_n: ["force", "N"],
  approach_m: ["approach", "m"],
  approach_m_per_s: ["approach velocity along the impulse", "m/s"],
  contact_points: ["points that press"],
  contact_area_m2: ["their area", "m²"],
  peak_pressure_pa: ["largest pressure", "Pa"],
  start_s: ["from", "s"],
  end_s: ["to", "s"],
};

const episodeNote = "An episode ends with the first step without a force. Approach is the speed of the bodies as a whole when it begins, and its " +
  "restitution is minus the speed at its end over this approach. Below 0, the bodies part already, and vibration brings their surfaces together " +
  "again: the episode belongs to the bounce before it and has no restitution of its own. The main figure is that of the run, from the " +
  "first touch to the last.";

/** A table with a row for each object in a list of the summary. */
function listed(list, path, keys, name) {
  const cells = (item, k) => keys.map(key => figure(`${path}.${k}.${key}`, item[key], glosses[key][1]));
  const head = [name, ...keys.map(key => short[key] ?? glosses[key][0])], rows = list.map((item, k) => row(String(k + 1), ...cells(item, k)));
  const tables = rows.length > 8 ? halves(head, rows) : [table(head, rows)];
  for (const made of tables) {
    made.className = "wide numbers";
    made.querySelectorAll("thead th").forEach((cell, k) => { cell.title = k ? glosses[keys[k - 1]][0] : ""; });
  }
  return tables;
}

/** A table in two parts, which stand side by side if there is room. */
function halves(head, rows) {
  const half = Math.ceil(rows.length / 2);
  return [table(head, rows.slice(0, half)), table(head, rows.slice(half))];
}

function verdict() {
  if (run.static) {
    const names = (run.asked.contact?.pair ?? []).map(pair => pair.between.join(" and "));
    const one = summary.pairs.length === 1, sentence = (pair, k) => (one ? "The bodies" : names[k] ?? `Pair ${k + 1}`) +
      (pair.contact_points > 0 ? ` press on each other with ${quantity(pair.force_n, "N", 3)}` : " do not press on each other");
    return `${summary.pairs.map(sentence).join("; ")}.`;
  }
  if (summary.contact_start_s === null) return "Nothing touched.";
  const start = quantity(summary.contact_start_s, "s"), end = summary.contact_end_s;
  const span = end === null ? `${start} on and still do at the end of the run` : `${start} to ${quantity(end, "s")}`;
  const parts = summary.episodes.length > 1 ? `, in ${summary.episodes.length} episodes` : "";
  const force = quantity(summary.peak_force_n, "N"), impulse = quantity(summary.impulse_ns, "N s");
  return `The bodies touch from ${span}${parts}. The force peaks at ${force}; ${impulse} pass between them.`;
}

/** The figures that were asked for. */
function highlights() {
  const s = summary, has = key => typeof s[key] === "number";
  const card = (title, content, more) => section("highlights").append(
    make("div", {}, make("dt", {}, title), make("dd", {}, content, ...(more ? [make("small", {}, more)] : []))));
  const plain = (title, key, unit, more) => { if (has(key)) card(title, figure(key, s[key], unit), more); };
  for (const [k, pair] of (run.static ? s.pairs : []).entries()) {
    card("Force", figure(`pairs.${k}.force_n`, pair.force_n, "N"), `${plural(pair.contact_points, "point")} press`);
    card("Largest pressure", figure(`pairs.${k}.peak_pressure_pa`, pair.peak_pressure_pa, "Pa"));
    card("Approach", figure(`pairs.${k}.approach_m`, pair.approach_m, "m"));
  }
  plain("Restitution", "restitution", undefined, s.episodes?.length > 1 ? "from the first touch to the last" : undefined);
  plain("Peak force", "peak_force_n", "N", run.peak ? `in one step, sum over ${plural(run.peak.points, "point")}` +
    (run.peak.few ? ": the pressure depends on contact.spacing" : "") : undefined);
  plain("Impulse", "impulse_ns", "N s");
  if (has("contact_end_s"))
    card("Duration of contact", quantity(s.contact_end_s - s.contact_start_s, "s"), plural(s.episodes.length, "episode"));
  for (const [name, v] of Object.entries(s.exit_velocity ?? {}))
    card(`Exit velocity of ${name}`, keyed(`exit_velocity.${name}`, v, quantity(Math.hypot(...v), "m/s")), vector(v, "m/s"));
  for (const [name, peaks] of Object.entries(s.acceleration ?? {})) {
    const filtered = Object.entries(peaks.cfc_peak_m_per_s2).filter(([, peak]) => peak !== null).reverse();
    card(`Peak acceleration of ${name}`, figure(`acceleration.${name}.peak_m_per_s2`, peaks.peak_m_per_s2, "m/s²"),
         filtered.map(([of, peak]) => `CFC ${of}: ${quantity(peak, "m/s²", 3)}`).join(", "));
  }
  if (s.error_estimate) card("Estimated error", percent(s.error_estimate.total), `of the ${spaced(s.error_estimate.quantity)}`);
  if (has("energy_lost_friction"))
    card("Heat of friction", keyed("energy_lost_friction", s.energy_lost_friction, percent(s.energy_lost_friction)),
         "of the energy at first touch");
  if (has("max_slip_m") && has("friction_impulse_ns"))
    card("Longest slip", figure("max_slip_m", s.max_slip_m, "m"), `friction passes ${quantity(s.friction_impulse_ns, "N s", 3)}`);
}

/** The checks of the numbers. One that is out of its bound is also a warning. */
function checks() {
  const at = section("checks"), outside = run.checks.filter(({ok}) => ok === false);
  if (run.static) return at.remove();
  for (const {label, value, unit, most, meaning} of outside.filter(({warned}) => !warned))
    section("warnings").append(make("li", {}, `Warning: ${label} ${quantity(value, unit)} is above ${quantity(most, unit, 2)}: ${meaning}`));
  const rows = run.checks.map(({key, label, value, unit, most, ok}) => row(label, figure(key, value, unit),
    ok === null ? "" : `${ok ? "✓" : "✗"} at most ${quantity(most, unit, 2)}`));
  rows.push(row("contact points", figure("candidates", summary.candidates), `at most ${summary.max_active} touch at a time`),
            row("steps with a force", figure("contact_steps", summary.contact_steps), `in ${plural(summary.episodes.length, "episode")}`));
  if (summary.real_time_factor > 0 && run.steps.duration_s) {
    const {duration_s: duration} = run.steps, faster = summary.real_time_factor >= 1;
    const times = digits(faster ? summary.real_time_factor : 1 / summary.real_time_factor, 2);
    rows.push(row("time of stepping", quantity(duration / summary.real_time_factor, "s", 2), `${times} times ${faster ? "faster" : "slower"} than real`));
  }
  const bounded = run.checks.filter(({ok}) => ok !== null).length;
  at.append(make("summary", {}, outside.length ? `Checks: ${outside.length} of ${bounded} out of bounds` : `Checks: ${bounded} within bounds`), table(null, rows));
  at.open = outside.length > 0;
}

/** What the peak force is. */
function peakNote({points, few}) {
  const sum = `The peak force is the largest sum of the forces of all points in one step; ${plural(points, "point")} carried it.`;
  return few ? `${sum} With so few, the pressure is that of a patch and grows as contact.spacing falls. The total force depends on it ` +
    "less: halve the spacing until it stays the same." : sum;
}

function contactSection() {
  const at = section("contact");
  if (run.static)
    at.append(...listed(summary.pairs, "pairs", ["force_n", "approach_m", "contact_points", "contact_area_m2", "peak_pressure_pa"], "pair"));
  at.append(...run.charts.contact.map(spec => new Chart(spec).element));
  if (run.map) at.append(forceMap(run.map));
  if (run.states) at.append(stateMap(run.states));
  if (run.peak) at.append(note(peakNote(run.peak)));
  if (run.steps.every > 1)
    at.append(note(`One in ${run.steps.every} steps is in the result; the rest is not drawn, and a spectrum of so few may be aliased.`));
  if (run.static) return;
  const {episodes, exit_velocity: exit} = summary, most = 40;
  if (episodes.length > 1) {
    const keys = ["start_s", "end_s", "impulse_ns", "peak_force_n", "approach_m_per_s", "restitution"]
      .filter(key => key in episodes[0]);  // older summaries have fewer
    at.append(make("h3", {}, "Episodes"), ...listed(episodes.slice(0, most), "episodes", keys, "episode"));
    if ("approach_m_per_s" in episodes[0]) at.append(note(episodeNote));
    if (episodes.length > most) at.append(note(`The first ${most} of ${episodes.length}; summary.json has all.`));
  }
  const rows = Object.entries(exit ?? {}).map(([name, v]) => {
    const before = run.bodies.find(body => body.name === name)?.velocity;
    return row(name, before ? vector(before, "m/s") : "–", keyed(`exit_velocity.${name}`, v, vector(v, "m/s")));
  });
  if (rows.length)
    at.append(make("h3", {}, "Velocities, mean of the mass"), table(["", "before", "when contact last ended"], rows));
}

const gravity = 9.80665;  // [m/s²]

/** The peaks of each receiver, unfiltered and by class, and their charts. */
function accelerationSection() {
  const at = section("acceleration"), all = Object.entries(summary.acceleration ?? {});
  if (!all.length) return at.remove();
  const peak = (label, key, value, when) => row(label, figure(key, value, "m/s²"), value === null ? "" : `${digits(value / gravity)} g`, when);
  for (const [name, peaks] of all) {
    const path = `acceleration.${name}`, filtered = Object.entries(peaks.cfc_peak_m_per_s2).reverse();
    at.append(make("h3", {}, name), fill(table(["peak", "", "", ""], [
      peak("unfiltered", `${path}.peak_m_per_s2`, peaks.peak_m_per_s2, `at ${quantity(peaks.time_s, "s")}`),
      ...filtered.map(([of, value]) => peak(`CFC ${of}`, `${path}.cfc_peak_m_per_s2.${of}`, value, ""))]), {class: "wide across"}, []));
    at.append(...(run.accelerations[name] ?? []).filter(spec => spec.lines.length).map(spec => new Chart(spec).element));
  }
  at.append(note("Peaks are magnitudes of vectors: unfiltered of each step, and behind the low-pass filters of SAE J211-1. " +
                 "An accelerometer measures the acceleration minus gravity."));
}

const audible = 0.1;  // [s]

/** The sound of a receiver, with its controls and a description. */
function sounding(name, sound) {
  if (sound.of_seconds < audible) return [note(`${quantity(sound.of_seconds, "s", 2)} of sound: lengthen time.duration to hear it.`)];
  const audio = make("audio", {controls: "", src: `data:audio/wav;base64,${sound.wav}`, "aria-label": `Sound of ${name}`});
  const speeds = [[1, "as it is"], [0.5, "half"], [0.25, "a quarter"], [0.1, "a tenth"]];
  const speed = make("select", {}, ...speeds.map(([value, text]) => make("option", {value}, text)));
  const loop = make("input", {type: "checkbox"});
  speed.addEventListener("change", () => {
    audio.preservesPitch = false;
    audio.playbackRate = Number(speed.value);
  });
  loop.addEventListener("change", () => { audio.loop = loop.checked; });
  const {seconds, of_seconds: all} = sound, {file, full_scale_m_per_s: scale} = summary.sounds[name];
  const cut = seconds < all ? ` The first ${quantity(seconds, "s")} of ${quantity(all, "s")}.` : "";
  return [audio, make("div", {class: "controls"}, make("label", {}, "speed", speed), make("label", {}, loop, "again and again")),
          note(`Its ${sound.axis}-velocity, which moves most, at ${digits(sound.rate_hz, 6)} Hz.${cut} ` +
               `The file ${file} has x, y and z; its full scale is ${quantity(scale, "m/s")}.`)];
}

function soundSection() {
  const at = section("sound"), names = Object.keys(run.receivers), some = run.bodies[0]?.name ?? "…";
  if (run.static || run.by_table) return at.remove();
  if (!names.length)
    at.append(note("No receiver was asked for. This in the scene, given to both programs, records one and writes its sound:"),
              make("pre", {}, `[[output.receiver]]\nname = "mic"\nbody = "${some}"\nat = [0, 0, 0]   # m, on the body or in it`));
  for (const name of names) {
    const sound = run.sounds[name] ?? {missing: "the summary names no file of it"};
    at.append(make("h3", {}, name), ...(sound.missing ? [note(`No sound to play: ${sound.missing}.`)] : sounding(name, sound)));
    at.append(...run.receivers[name].filter(spec => spec.lines.length).map(spec => new Chart(spec).element));
  }
}

function energySection() {
  const at = section("energy");
  if (run.by_table) return at.append(note("Runs with sampled responses keep no energy ledger."));
  at.append(...run.charts.energy.map(spec => new Chart(spec).element));
  const {strain, residual, kinetic, damping, contact, friction} = run.labels, stored = `strain + ${residual} − work of loads`;
  const labels = run.static ? {total: stored, strain, residual, loads: "work of loads"}
    : {total: `kinetic + ${stored}`, damping, contact, ...(run.friction ? {friction} : {}), kinetic, strain, residual, loads: "work of loads"};
  const columns = run.static ? ["at rest"] : ["at the start", "at the end"];
  const rows = Object.entries(labels).map(([name, label]) =>
    row(label, ...columns.map((_, k) => quantity(run.energy[name][k], "J", 6))));
  at.append(table(["", ...columns], rows));
  if (!run.static) at.append(note(`The first ${run.friction ? "four" : "three"} rows together stay the same.`));
}

/** The name of a quantity as words. */
function spaced(name) {
  return name.replaceAll("_", " ");
}

function errorsSection() {
  const at = section("errors"), estimate = summary.error_estimate;
  if (run.by_table) return at.append(note("Runs with sampled responses have no error estimate."));
  if (!estimate && run.static) return at.remove();
  if (!estimate)
    return at.append(note("Not estimated. With accuracy = 1e-2 in the scene, or --accuracy 1e-2 for both programs, the run says " +
                          "how far its main results may be off, by cause."));
  const causes = {total: "all together", mesh: "mesh", modes: "modes above the band", basis: "vectors in the band",
                  step: "step of time", eigensolver: "eigensolver", precision: "precision",
                  spacing: "spacing of contact points", zone: "points beyond the reach",
                  rotation: "finite rotation, beyond the turn"};
  const largest = Math.max(estimate.total, 1e-300), quantities = Object.entries(estimate.quantities);
  const shown = (share) => share === null || share === undefined ? "not known" : digits(share, 2);
  const rows = Object.entries(causes).filter(([key]) => key in estimate).map(([key, label]) => {
    const bar = make("i", {class: "bar"}), share = estimate[key];
    bar.style.width = `${12 * (share ?? 0) / largest}rem`;
    return row(label, keyed(`error_estimate.${key}`, share, shown(share)), bar,
               ...quantities.map(([, errors]) => shown(errors[key])));
  });
  const asked = run.asked.accuracy ? `; ${digits(run.asked.accuracy)} was asked for` : "";
  at.append(fill(table(["cause", `relative error of ${spaced(estimate.quantity)}`, "", ...quantities.map(([name]) => spaced(name))], rows), {class: "wide across"}, []),
            note(`Estimated${asked}. The first column is the requested quantity with the largest error.`));
  if (estimate.until_s)
    at.append(note(`Estimates hold up to the end of the first touch, at ${quantity(estimate.until_s, "s", 6)}.`));
}

function askedSection() {
  const text = make("code"), name = `${run.slug}.toml`;
  for (const line of run.scene.split("\n")) {
    const named = /^([^=[]+?)( = .*)$/.exec(line);
    if (line.startsWith("[")) text.append(make("span", {class: "section"}, line));
    else if (named) text.append(make("span", {class: "name"}, named[1]), named[2]);
    else text.append(line);
    text.append("\n");
  }
  const button = make("button", {type: "button"}, `Save as ${name}`);
  button.addEventListener("click", () => download(name, run.scene));
  section("asked").append(note("The scene as it was run: overrides applied, every default written."),
                          make("pre", {class: "toml", id: "scene"}, text), button);
}

function matter([group, m]) {
  const each = (numbers, show) => [numbers ?? 0].flat().map(show).join(" / ");
  const parts = [`${digits(m.density ?? 0)} kg/m³`];
  if (m.stiffness) parts.push("21 elastic constants");
  else parts.push(`E ${each(m.young, (e) => quantity(e, "Pa"))}`, `ν ${each(m.poisson, (n) => digits(n))}`);
  if (m.area) parts.push(`${digits(m.area)} m²`);
  return (group ? `${group}: ` : "") + parts.join(", ");
}

function certified(kernel) {
  const band = `up to ${quantity(kernel.upto_hz, "Hz")}`, left = kernel.left_out ? `; ${kernel.left_out} left to the static part` : "";
  if (kernel.basis === "contact") return `vectors fitted to contact ${band}, flexibility within ${digits(kernel.flexibility_error, 2)}`;
  const proved = kernel.basis === "imported" ? "imported, not proved to be all" : "none missing by inertia";
  return `${kernel.count_found} modes ${band}, ${proved}${left}`;
}

function kernelsSection() {
  const at = section("kernels"), source = run.asked.contact?.table;
  if (source) return at.append(note(`The kernels come from a table, ${source}.`));
  for (const [k, body] of run.bodies.entries()) {
    const {kernel} = body, count = summary.modes?.[body.name];
    const rows = [row("mass", `${digits(body.mass)} kg${kernel?.supported ? ", supported" : ""}`),
                  row("material", Object.entries(body.materials).map(matter).join("; ")), row("mesh", body.mesh ?? "–")];
    if (kernel)
      rows.push(row("elements", `${kernel.elements} of order ${kernel.order}, ${kernel.dofs} unknowns`), row("basis", certified(kernel)));
    if (count !== undefined) rows.push(row("coordinates", figure(`modes.${body.name}`, count)));
    rows.push(row("kernel", body.file ? code(body.file) : "–"));
    rows.push(...(kernel ? [row("its hash", code(kernel.hash)), row("hash of the mesh", code(kernel.mesh_sha256)), row("made by", kernel.created_by)]
      : [row("", "not found beside the result: only its name is known")]));
    at.append(make("div", {}, make("h3", {}, make("i", {class: `swatch c${k % 6}`}), body.name), table(null, rows)));
  }
}

function figuresSection() {
  const scalars = Object.entries(summary).filter(([, value]) => value === null || typeof value !== "object");
  const rows = scalars.map(([key, value]) => row(code(key), figure(key, value, glosses[key]?.[1]), glosses[key]?.[0] ?? ""));
  section("figures").append(note("summary.json; – where a figure does not exist."), ...halves(["key", "value", "meaning"], rows));
}

function timingSection() {
  const rows = [row("ricochet-contact, all of it", quantity(summary.wall_s, "s"))], {duration_s: duration, rate_hz: rate} = run.steps;
  if (summary.real_time_factor > 0 && duration) {
    const stepping = duration / summary.real_time_factor, steps = Math.round(duration * rate);
    rows.push(row("its steps", `${quantity(stepping, "s")} for ${steps} steps of ${quantity(1 / rate, "s")}`),
              row("a step", quantity(stepping / steps, "s")),
              row("simulated time over that", `${digits(summary.real_time_factor, 3)} × real time`));
  }
  section("timing").append(table(null, rows), note("On the machine of the run, one core. Kernels do not hold the time that they " +
                                                   "took, so that equal ones are equal files."));
}

function repeatSection() {
  const list = make("ol"), {file} = run;
  list.append(make("li", {}, `Save the scene above as ${run.slug}.toml where the paths in it lead to its meshes and histories.`));
  for (const [command, what] of run.commands)
    list.append(make("li", {}, what, ...(command ? [make("pre", {class: "command"}, command)] : [])));
  section("repeat").append(list, table(null, [row("made by", file.created_by ?? "–"), row("result", code(file.name)),
                                              row("its size", `${file.bytes} bytes`), row("its SHA-256", code(file.sha256))]));
}

if (run.static) {
  section("kind").textContent = "Bodies at rest, by Ricochet";
  section("motion").querySelector("h2").textContent = "The bodies and the forces";
}
section("verdict").append(verdict());
section("warnings").append(...summary.warnings.map(text => make("li", {}, `Warning: ${text}`)));
highlights();
checks();
const warned = section("warnings").childElementCount;
if (warned) section("warned").append(make("a", {href: "#warnings"}, `${plural(warned, "warning")}, below`));
contactSection();
accelerationSection();
soundSection();
energySection();
errorsSection();
askedSection();
kernelsSection();
figuresSection();
timingSection();
repeatSection();
if (!run.modes.length) section("modes").remove();
if (run.instrument.missing) section("play").remove();
for (const part of document.querySelectorAll("section"))
  section("contents").append(make("a", {href: `#${part.id}`}, part.querySelector("h2").textContent));
section("footer").append(`${run.title} · ${run.file.created_by ?? "Ricochet"} · this page is one file and loads nothing.`);
charts.forEach(chart => chart.redraw());
const shown = player(section("motion"), run.motion, time => charts.forEach(chart => chart.mark(time)));
if (run.modes.length) new Modes(section("modes"), run.modes, shown);
if (!run.instrument.missing) instrument(section("play"), run.instrument);
document.documentElement.dataset.ready = "yes";
