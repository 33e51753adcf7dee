// SPDX-License-Identifier: BSD-2-Clause
"use strict";
// Shared by the other scripts: the data of the run, page elements and numbers as text.

const run = JSON.parse(document.getElementById("run").textContent);

addEventListener("error", event => { document.documentElement.dataset.error = event.message; });

const soft = matchMedia("(prefers-reduced-motion: reduce)");
const svgNames = document.getElementById("svg").namespaceURI;

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) if (value !== undefined) element.setAttribute(name, value);
  element.append(...children.filter(child => child !== undefined));
  return element;
}

/** Creates an element. Strings among the children are inserted as text, never as markup. */
const make = (tag, attributes = {}, ...children) => fill(document.createElement(tag), attributes, children);
const draw = (tag, attributes = {}, ...children) => fill(document.createElementNS(svgNames, tag), attributes, children);

const section = name => document.getElementById(name);
const note = text => make("p", {class: "note"}, text);
const plural = (count, name) => `${count} ${name}${count === 1 ? "" : "s"}`;

const arrays = {f4: Float32Array, i2: Int16Array, u1: Uint8Array, u2: Uint16Array, u4: Uint32Array};

/** Decodes numbers from base64. */
function unpack({type, scale, data}) {
  const bytes = Uint8Array.from(atob(data), letter => letter.charCodeAt(0));
  const values = new arrays[type](bytes.buffer);
  return scale === undefined ? values : Float32Array.from(values, value => value * scale);
}

/** A number with `count` digits. Very small and very large numbers are written with a power of ten. */
function digits(value, count = 4) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(count))).replace("-", "−");
  const [mantissa, power] = value.toExponential(count - 1).split("e");
  const raised = String(Number(power)).replace(/./g, sign => "⁰¹²³⁴⁵⁶⁷⁸⁹"[sign] ?? "⁻");
  return `${String(Number(mantissa)).replace("-", "−")} × 10${raised}`;
}

const linear = ["s", "m", "N", "J", "N s", "m/s", "Pa", "Hz", "W"];

/** A factor and the unit with an SI prefix. The factor times `largest` is from 1 to 1000, or at least 0.1 without a prefix. */
function prefixed(largest, unit) {
  if (!linear.includes(unit) || largest === 0) return {factor: 1, unit};
  for (const [power, prefix] of [[9, "G"], [6, "M"], [3, "k"], [0, ""], [-3, "m"], [-6, "µ"], [-9, "n"]])
    if (largest * 10 ** -power >= (power === 0 ? 0.1 : 1)) return {factor: 10 ** -power, unit: prefix + unit};
  return {factor: 1, unit};
}

function quantity(value, unit = "", count = 4) {
  const shown = prefixed(Math.abs(value), unit);
  return digits(value * shown.factor, count) + (shown.unit ? " " + shown.unit : "");
}

/** A row of a table. The first cell is its header. */
const row = (...cells) => make("tr", {}, ...cells.map((cell, k) => make(k ? "td" : "th", {scope: k ? undefined : "row"}, cell)));

/** A table. One that is wider than its place becomes a list: each cell stands below the name of its column. */
function table(head, rows) {
  const made = make("table", {}, head ? make("thead", {}, make("tr", {}, ...head.map(name => make("th", {scope: "col"}, name)))) : undefined,
                    make("tbody", {}, ...rows));
  const place = make("div", {class: "wide"}, made);
  if (!head) return place;
  for (const line of rows) for (const [k, cell] of [...line.children].entries()) cell.dataset.column = made.tHead.rows[0].cells[k].textContent;
  let needed = 0;
  const fit = () => {
    if (!place.classList.contains("list")) needed = made.scrollWidth;
    place.classList.toggle("list", needed > place.clientWidth);
  };
  new ResizeObserver(() => requestAnimationFrame(fit)).observe(place);  // a change of its height in the observer would be an error
  return place;
}

/** Numbers of a column with their decimal points below each other: the largest has `count` digits. */
function aligned(values, count) {
  const whole = Math.floor(Math.log10(Math.max(...values.map(Math.abs)) || 1)), decimals = Math.max(0, count - 1 - whole);
  return values.map(value => decimals < 12 && whole < 9 ? value.toFixed(decimals).replace("-", "−") : digits(value, count));
}

function download(name, content) {
  const blob = content instanceof Blob ? content : new Blob([content], {type: "text/plain"});
  const link = make("a", {download: name, href: URL.createObjectURL(blob)});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
