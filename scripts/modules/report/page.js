// Fills the sections of the page from the run.

const section = name => document.getElementById(name);
const {summary} = run;
const row = (...cells) => make("tr", {}, ...cells.map((cell, k) => make(k ? "td" : "th", {scope: k ? undefined : "row"}, cell)));
const note = text => make("p", {class: "note"}, text);
const percent = value => `${digits(100 * value, 3)} %`;
/** Components; what is round-off beside the largest is 0. */
function vector(values) {
  const least = 1e-6 * Math.max(...values.map(Math.abs));
  return `(${values.map(x => digits(Math.abs(x) < least ? 0 : x)).join(", ")})`;
}

// Key of summary.json: what it is, its unit.
const glosses = {
  contact_start_s: ["first touch", "s"], contact_end_s: ["last touch; – while touching at the end", "s"], contact_steps: ["steps with a force"],
  peak_force_n: ["largest sum of contact forces in a step", "N"], impulse_ns: ["contact forces summed over time", "N s"],
  restitution: ["minus exit over approach velocity along the impulse"], energy_drift: ["what the energy ledger fails to account for, relative"],
  energy_lost_contact: ["taken by contact, over the energy when it started"], max_penetration_m: ["deepest penetration", "m"],
  limited_steps: ["steps that max_pivots cut short"], limited_residual: ["the worst of them"], modes_in_residual: ["modes faster than half the rate: quasi-static"],
  precision: ["of the products of steps"], candidates: ["paired contact points"], unpaired: ["candidates that face nothing"], max_active: ["most points that touched at once"],
  real_time_factor: ["simulated time over time of stepping"], wall_s: ["time of ricochet-contact", "s"], iterations: ["complementarity problems solved"],
  imbalance: ["what forces and loads do not cancel, relative"], force_n: ["force between the two", "N"], approach_m: ["approach of the centres of mass", "m"],
  contact_points: ["points that press"], contact_area_m2: ["area of their patches", "m²"], peak_pressure_pa: ["largest pressure", "Pa"],
  start_s: ["from", "s"], end_s: ["to", "s"],
};

function verdict() {
  if (run.static) {
    const pressing = summary.pairs.filter(pair => pair.contact_points > 0).length;
    return `At rest: ${pressing} of ${summary.pairs.length} pairs press on each other.`;
  }
  if (summary.contact_start_s === null) return "Nothing touched.";
  const times = summary.episodes.length, start = quantity(summary.contact_start_s, "s");
  const span = summary.contact_end_s === null ? `The bodies touch from ${start} on and still do at the end of the run`
    : `The bodies touch from ${start} to ${quantity(summary.contact_end_s, "s")}`;
  return `${span}${times > 1 ? `, in ${times} episodes` : ""}. The force peaks at ${quantity(summary.peak_force_n, "N")}; ${quantity(summary.impulse_ns, "N s")} pass between them.`;
}

function highlights() {
  const card = (title, key, value, unit, more) => make("div", {}, make("dt", {}, title), make("dd", {}, figure(key, value, unit), ...(more ? [make("small", {}, more)] : [])));
  const share = (title, key, more) => make("div", {}, make("dt", {}, title), make("dd", {}, make("span", {"data-key": key, "data-value": String(summary[key]), "data-unit": "%"}, percent(summary[key])), make("small", {}, more)));
  const cards = [], has = key => typeof summary[key] === "number";
  if (run.static)
    for (const [k, pair] of summary.pairs.entries()) {
      cards.push(card("Force", `pairs.${k}.force_n`, pair.force_n, "N", `${pair.contact_points} points press`),
                 card("Largest pressure", `pairs.${k}.peak_pressure_pa`, pair.peak_pressure_pa, "Pa"), card("Approach", `pairs.${k}.approach_m`, pair.approach_m, "m"));
    }
  if (has("peak_force_n")) cards.push(card("Peak force", "peak_force_n", summary.peak_force_n, "N"), card("Impulse", "impulse_ns", summary.impulse_ns, "N s"));
  if (has("contact_end_s")) cards.push(make("div", {}, make("dt", {}, "Contact"), make("dd", {}, quantity(summary.contact_end_s - summary.contact_start_s, "s"), make("small", {}, `${summary.episodes.length} episode${summary.episodes.length > 1 ? "s" : ""}, ${summary.contact_steps} steps`))));
  if (has("restitution")) cards.push(card("Restitution", "restitution", summary.restitution));
  if (has("energy_lost_contact")) cards.push(share("Energy to contact", "energy_lost_contact", "of that at first touch"));
  if (has("energy_drift")) cards.push(card("Energy drift", "energy_drift", summary.energy_drift, "", "round-off: 10⁻¹² or less"));
  if (summary.error_estimate) cards.push(make("div", {}, make("dt", {}, "Estimated error"), make("dd", {}, percent(summary.error_estimate.total), make("small", {}, "of impulse and rebound"))));
  cards.push(card("Contact points", "candidates", summary.candidates, "", summary.max_active === undefined ? "" : `at most ${summary.max_active} touch`));
  if (has("real_time_factor")) cards.push(card("Computed at", "real_time_factor", summary.real_time_factor, "", "× real time"));
  section("highlights").append(...cards);
}

function contactSection() {
  const at = section("contact");
  if (run.static) {
    const rows = summary.pairs.map((pair, k) => row(`pair ${k + 1}`, ...["force_n", "approach_m", "contact_points", "contact_area_m2", "peak_pressure_pa"].map(key => figure(`pairs.${k}.${key}`, pair[key], glosses[key][1]))));
    at.append(table(["", "force", "approach", "points", "area", "largest pressure"], rows));
  }
  at.append(...run.charts.contact.map(spec => new Chart(spec).element));
  if (run.map) at.append(forceMap(run.map));
  if (run.steps.every > 1) at.append(note(`One in ${run.steps.every} steps is in the result; the rest is not drawn, and a spectrum of so few may be aliased.`));
  if (!run.static && summary.episodes.length > 1) {
    const most = 40, rows = summary.episodes.slice(0, most).map((episode, k) => row(String(k + 1), ...["start_s", "end_s", "impulse_ns", "peak_force_n"].map(key => figure(`episodes.${k}.${key}`, episode[key], glosses[key][1]))));
    at.append(make("h3", {}, "Episodes"), table(["", "from", "to", "impulse", "peak force"], rows));
    if (summary.episodes.length > most) at.append(note(`The first ${most} of ${summary.episodes.length}; summary.json has all.`));
  }
  if (Object.keys(summary.exit_velocity ?? {}).length)
    at.append(make("h3", {}, "Velocities, mean of the mass"), table(["", "before", "when contact last ended"], Object.entries(summary.exit_velocity).map(([name, v]) =>
      row(name, run.bodies.find(body => body.name === name)?.velocity ? `${vector(run.bodies.find(body => body.name === name).velocity)} m/s` : "–",
          make("span", {"data-key": `exit_velocity.${name}`, "data-value": JSON.stringify(v)}, `${vector(v)} m/s`)))));
}

function soundSection() {
  const at = section("sound"), names = Object.keys(run.receivers);
  if (run.static || run.by_table) return at.remove();
  if (!names.length) return at.append(note("No receiver was asked for. This in the scene, given to both programs, records one and writes its sound:"),
                                      make("pre", {}, `[[output.receiver]]\nname = "mic"\nbody = "${run.bodies[0]?.name ?? "…"}"\nat = [0, 0, 0]   # m, on the body or in it`));
  for (const name of names) {
    const sound = run.sounds[name], told = summary.sounds?.[name];
    at.append(make("h3", {}, name));
    if (!sound || sound.missing) at.append(note(`No sound to play: ${sound?.missing ?? "the summary names no file of it"}.`));
    else {
      const audio = make("audio", {controls: "", src: `data:audio/wav;base64,${sound.wav}`, "aria-label": `Sound of ${name}`});
      const speed = make("select", {}, ...[[1, "as it is"], [0.5, "half"], [0.25, "a quarter"], [0.1, "a tenth"]].map(([value, text]) => make("option", {value}, text)));
      const loop = make("input", {type: "checkbox"});
      speed.addEventListener("change", () => { audio.preservesPitch = false; audio.playbackRate = Number(speed.value); });
      loop.addEventListener("change", () => { audio.loop = loop.checked; });
      const cut = sound.seconds < sound.of_seconds ? ` The first ${quantity(sound.seconds, "s")} of ${quantity(sound.of_seconds, "s")}.` : "";
      at.append(audio, make("div", {class: "controls"}, make("label", {}, "speed", speed), make("label", {}, loop, "again and again")),
                note(`Its ${sound.axis}-velocity, which moves most, ${digits(sound.rate_hz, 6)} Hz.${cut} Full scale of ${told.file}, which has x, y and z, is ${quantity(told.full_scale_m_per_s, "m/s")}.`));
    }
    at.append(...run.receivers[name].filter(spec => spec.lines.length).map(spec => new Chart(spec).element));
  }
}

function energySection() {
  const at = section("energy");
  if (!Object.keys(run.energy).length) return at.append(note("Table kernels keep no energy ledger."));
  at.append(...run.charts.energy.map(spec => new Chart(spec).element));
  const names = ["total", "damping", "contact", "kinetic", "strain", "residual", "loads"], labels = {...run.labels, total: "kinetic + strain + residual − loads", loads: "work of loads"};
  at.append(table(["", ...(run.static ? ["at rest"] : ["at the start", "at the end"])],
                  names.map(name => row(labels[name], ...run.energy[name].slice(0, run.static ? 1 : 2).map(value => quantity(value, "J", 6))))));
  if (!run.static) at.append(note("The first three rows together stay the same."));
}

function errorsSection() {
  const at = section("errors"), estimate = summary.error_estimate;
  if (!estimate)
    return at.append(note(run.by_table ? "Table kernels have no error estimate." : "Not estimated. With accuracy = 1e-2 in the scene, or --accuracy 1e-2 for both programs, the run says how far impulse and rebound may be off, by cause."));
  const causes = {total: "all together", mesh: "mesh", modes: "modes left out", step: "step of time", eigensolver: "eigensolver", precision: "precision", spacing: "spacing of contact points"};
  const largest = Math.max(...Object.values(estimate).filter(value => value !== null), 1e-300);
  at.append(table(["cause", "relative error", ""], Object.entries(causes).map(([key, label]) => {
    const bar = make("i", {class: "bar"});
    bar.style.width = `${12 * Math.max(0, estimate[key] ?? 0) / largest}rem`;
    return row(label, make("span", {"data-key": `error_estimate.${key}`, "data-value": String(estimate[key])}, estimate[key] === null ? "not known" : digits(estimate[key], 2)), bar);
  })), note(`Of impulse and rebound, estimated${run.asked.accuracy ? `; ${digits(run.asked.accuracy)} was asked for` : ""}.`));
}

function askedSection() {
  const text = make("code"), at = section("asked");
  for (const line of run.scene.split("\n")) {
    const named = /^([^=[]+?)( = )(.*)$/.exec(line);
    if (line.startsWith("[")) text.append(make("span", {class: "section"}, line));
    else if (named) text.append(make("span", {class: "name"}, named[1]), named[2], named[3]);
    else text.append(line);
    text.append("\n");
  }
  const button = make("button", {type: "button"}, `Save as ${run.slug}.toml`);
  button.addEventListener("click", () => download(`${run.slug}.toml`, run.scene));
  at.append(note("The scene as it was run: overrides applied, every default written."), make("pre", {class: "toml", id: "scene"}, text), button);
}

function kernelsSection() {
  const at = section("kernels");
  if (!run.bodies.some(body => body.file)) return at.append(note(`The kernels come from a table${run.asked.contact?.table ? `, ${run.asked.contact.table}` : ""}.`));
  const matter = body => Object.entries(body.materials).map(([group, m]) => `${group ? group + ": " : ""}${digits(m.density ?? 0)} kg/m³, E ${quantity(m.young ?? 0, "Pa")}, ν ${digits(m.poisson ?? 0)}${m.area ? `, ${digits(m.area)} m²` : ""}`).join("; ");
  const certified = kernel => kernel.basis === "modes"
    ? `${kernel.count_found} modes up to ${quantity(kernel.upto_hz, "Hz")}, none missing by inertia${kernel.left_out ? `; ${kernel.left_out} left to the static part` : ""}`
    : `vectors fitted to contact up to ${quantity(kernel.upto_hz, "Hz")}, flexibility within ${digits(kernel.flexibility_error, 2)}`;
  for (const body of run.bodies) {
    const {kernel} = body, count = summary.modes?.[body.name];
    const rows = [row("mass", `${digits(body.mass)} kg${kernel?.supported ? ", supported" : ""}`), row("material", matter(body)), row("mesh", body.mesh ?? "–")];
    if (kernel) rows.push(row("elements", `${kernel.elements} of order ${kernel.order}, ${kernel.dofs} unknowns`), row("basis", certified(kernel)));
    if (count !== undefined) rows.push(row("coordinates", figure(`modes.${body.name}`, count)));
    rows.push(row("kernel", make("code", {}, body.file)));
    if (kernel) rows.push(row("its hash", make("code", {}, kernel.hash)), row("hash of the mesh", make("code", {}, kernel.mesh_sha256)), row("made by", kernel.created_by));
    else rows.push(row("", "not found beside the result: only its name is known"));
    at.append(make("h3", {}, make("i", {class: `swatch c${run.bodies.indexOf(body) % 6}`}), body.name), table(null, rows));
  }
}

function figuresSection() {
  const rows = Object.entries(summary).filter(([, value]) => value === null || typeof value !== "object").map(([key, value]) =>
    row(make("code", {}, key), figure(key, value, glosses[key]?.[1]), glosses[key]?.[0] ?? ""));
  section("figures").append(note("summary.json; – where a figure does not exist."), table(["key", "value", "meaning"], rows));
}

function timingSection() {
  const at = section("timing"), rows = [row("ricochet-contact, all of it", quantity(summary.wall_s, "s"))];
  if (summary.real_time_factor > 0 && run.steps.duration_s) {
    const stepping = run.steps.duration_s / summary.real_time_factor, steps = Math.round(run.steps.duration_s * run.steps.rate_hz);
    rows.push(row("its steps", `${quantity(stepping, "s")} for ${steps} steps of ${quantity(1 / run.steps.rate_hz, "s")}`), row("a step", quantity(stepping / steps, "s")),
              row("simulated time over that", `${digits(summary.real_time_factor, 3)} × real time`));
  }
  at.append(table(null, rows), note("On the machine of the run, one core. Kernels do not record their own time, so that equal ones are equal files."));
}

function repeatSection() {
  const at = section("repeat"), list = make("ol");
  list.append(make("li", {}, `Save the scene above as ${run.slug}.toml where the paths in it lead to its meshes and histories.`));
  for (const [command, what] of run.commands) list.append(make("li", {}, what, ...(command ? [make("pre", {class: "command"}, command)] : [])));
  at.append(list, table(null, [row("made by", run.file.created_by ?? "–"), row("result", make("code", {}, run.file.name)), row("bytes", String(run.file.bytes)), row("SHA-256", make("code", {}, run.file.sha256))]));
}

if (run.static) {
  section("kind").textContent = "Bodies at rest, by Ricochet";
  section("motion").querySelector("h2").textContent = "The bodies and the forces";
}
section("verdict").append(verdict());
section("warnings").append(...(summary.warnings ?? []).map(text => make("li", {}, `Outside the model: ${text}`)));
highlights();
contactSection();
soundSection();
energySection();
errorsSection();
askedSection();
kernelsSection();
figuresSection();
timingSection();
repeatSection();
section("contents").append(...[...document.querySelectorAll("section")].map(part => make("a", {href: `#${part.id}`}, part.querySelector("h2").textContent)));
section("footer").append(`${run.title} · ${run.file.created_by ?? "Ricochet"} · this page is one file and loads nothing.`);
charts.forEach(chart => chart.redraw());
player(section("motion"), run.motion, time => charts.forEach(chart => chart.mark(time)));
document.documentElement.dataset.ready = "yes";
