// SPDX-License-Identifier: BSD-2-Clause
// The modes of each body as tables. A mode that is pressed is shown in motion, in place of the impact.

const inPercent = value => value === null ? "–" : (100 * value).toFixed(2);

class Modes {
  /** `shown`: the player, if there is one. `alone`: there is no impact to go back to. */
  constructor(section, tables, shown, alone = false) {
    this.shown = shown;
    this.buttons = [];  // those of modes with shapes, with body and mode
    if (shown) section.append(note("Press the number of a mode to see its shape in motion, above."));
    for (const table of tables) section.append(this.tableOf(table));
    shown?.ofMode.append(pressable("Previous mode", () => this.step(-1)), pressable("Next mode", () => this.step(1)),
                         ...(alone ? [] : [pressable("Back to the impact", () => this.choose(null))]));
    if (alone && this.buttons.length) this.choose(this.buttons[0]);
    this.alone = alone;
  }

  tableOf({body, basis, rigid, elastic, rows}) {
    const surface = this.shown?.motion.bodies.find(surface => surface.name === body), vectors = basis === "contact";
    const shapes = Object.values(run.motion.bodies?.find(other => other.name === body)?.modes ?? {});
    const number = mode => {
      if (!surface?.modes[mode.number]) return String(mode.number);
      const title = `${body}, mode ${mode.number}: ${quantity(mode.frequency_hz, "Hz")}`;
      const button = make("button", {type: "button", "aria-pressed": "false", "aria-label": `Show ${title}`}, String(mode.number));
      const entry = {button, surface, mode, title};
      button.addEventListener("click", () => this.choose(this.chosen === entry && !this.alone ? null : entry));
      this.buttons.push(entry);
      return button;
    };
    // Elastic modes of a free body move no mass as a whole.
    const axes = rows.some(({mass}) => mass.some(share => Number(inPercent(share)) > 0)) ? [0, 1, 2] : [];
    const frequencies = aligned(rows.map(mode => mode.frequency_hz), 6);
    const cells = (mode, k) => row(number(mode), frequencies[k], inPercent(mode.damping), ...axes.map(i => inPercent(mode.mass[i])), inPercent(mode.contact));
    const head = ["mode", "frequency (Hz)", "damping (%)", ...axes.map(i => `mass ${"xyz"[i]} (%)`), "contact (%)"];
    const notes = [`${rigid} rigid modes and ${elastic} ${vectors ? "vectors of a contact-adapted basis, which are not modes of the body" : "elastic modes"}`];
    if (!axes.length && rows.length) notes.push("none of these moves the centre of mass");
    if (elastic > rows.length) notes.push(`the first ${rows.length} are listed; ricochet modes lists all`);
    if (shapes.length) notes.push(`the shape of each takes ${Math.round(shapes[0].data.length / 1000)} kB of this page`);
    else notes.push("no shapes: the kernel has no visualisation surface (output.view = true)");
    if (shapes.length && shapes.length < rows.length) notes.push(`so only ${shapes.length} are in it`);
    const made = fill(table(head, rows.map(cells)), {class: "wide numbers"}, []);
    return make("div", {}, make("h3", {}, body), made, note(`${notes.join("; ")}.`));
  }

  choose(entry) {
    const {shown} = this, before = this.chosen;
    this.chosen = entry;
    for (const {button} of this.buttons) button.setAttribute("aria-pressed", String(button === entry?.button));
    if (!entry) {
      shown.turnTo();
      before?.button.focus({preventScroll: true});
      return;
    }
    shown.turnTo(entry.surface, entry.mode.number, entry.title);
    const box = shown.cockpit.getBoundingClientRect();
    if (box.top < 0 || box.bottom > innerHeight) shown.cockpit.scrollIntoView({block: "start"});
  }

  /** The mode before or after the one that is shown. */
  step(way) {
    const {buttons} = this, at = buttons.indexOf(this.chosen);
    this.choose(buttons[(at + way + buttons.length) % buttons.length]);
  }
}
