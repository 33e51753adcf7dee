// SPDX-License-Identifier: BSD-2-Clause
// Surfaces of bodies X + F c(t), with a few shapes F in place of the modes of each body, and what draws them: colours, shaders, vectors.

const stops = [[0.19, 0.15, 0.36], [0.17, 0.36, 0.56], [0.13, 0.57, 0.55], [0.37, 0.74, 0.40], [0.80, 0.84, 0.22], [0.99, 0.92, 0.60]];

/** The colour for a value from 0 to 1. */
function ramp(share) {
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1), k = Math.min(stops.length - 2, Math.floor(at));
  return stops[k].map((part, c) => part + (at - k) * (stops[k + 1][c] - part));
}

function rampKey(low, high, unit) {
  const bar = make("i");
  const colours = stops.map(stop => `rgb(${stop.map(part => Math.round(255 * part)).join(" ")})`);
  bar.style.background = `linear-gradient(90deg, ${colours.join(", ")})`;
  return make("div", {class: "ramp"}, quantity(low, unit), bar, quantity(high, unit, 3));
}

const vertexShader = `#version 300 es
in vec3 place; in float value;
uniform mat3 turn; uniform vec3 target; uniform vec2 lens; uniform float distance, radius;
out vec3 eye; out float share;
void main() {
  eye = turn * (place - target);
  float away = distance - eye.z, near = max(distance - radius, 0.02 * distance), far = distance + radius;
  gl_Position = vec4(eye.xy * lens, ((far + near) * away - 2.0 * far * near) / (far - near), away);
  share = value;
}`;
const fragmentShader = `#version 300 es
precision highp float;
in vec3 eye; in float share;
uniform vec4 ink; uniform bool lit, ramped; uniform vec3 stops[${stops.length}];
out vec4 colour;
void main() {
  float at = clamp(share, 0.0, 1.0) * ${stops.length - 1}.0;
  int k = min(int(at), ${stops.length - 2});
  vec3 base = ramped ? mix(stops[k], stops[k + 1], at - float(k)) : ink.rgb;
  vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
  float light = lit ? 0.62 + 0.38 * abs(dot(normal, normalize(vec3(0.35, 0.5, 0.8)))) : 1.0;
  colour = vec4(base * light * ink.a, ink.a);
}`;

const unit = k => [0, 1, 2].map(i => Number(i === k));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** An empty box, which grows with the places that are added. */
function box() {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const add = values => values.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  return {low, high, add};
}

class MovingSurface {
  constructor(data, number) {
    this.name = data.name;
    this.number = number;
    this.node = unpack(data.node);
    this.element = unpack(data.element);
    this.still = data.rigid === undefined;
    this.normal = data.normal;  // of a plane
    this.visible = true;
    this.lines = data.lines;
    this.fields = this.still ? [] : [...MovingSurface.rows(data.rigid), ...data.bent.map(unpack)];
    this.rigid = this.still ? 0 : data.rigid.shape[0];
    this.amounts = this.still ? [] : [unpack(data.moved), unpack(data.amount)];
    this.place = Float32Array.from(this.node);
    this.value = new Float32Array(this.node.length / 3);
    this.modes = data.modes ?? {};
  }
  /** The shape of a mode, with a largest displacement of 1. */
  mode(number) {
    const field = unpack(this.modes[number]);
    let most = 0;
    for (let i = 0; i < field.length; i += 3) most = Math.max(most, Math.hypot(field[i], field[i + 1], field[i + 2]));
    return field.map(x => x / (most || 1));
  }
  static rows(packed) {
    const values = unpack(packed), [rows, length] = packed.shape;
    return Array.from({length: rows}, (_, k) => values.subarray(k * length, (k + 1) * length));
  }
  /** Amplitudes of the fields at snapshot k + f. If dt is given, their rates; dt is the time from snapshot k to k + 1. */
  amplitudes(k, f, dt) {
    return this.amounts.flatMap((values, part) => {
      const count = part === 0 ? this.rigid : this.fields.length - this.rigid, next = Math.min(k + 1, values.length / count - 1);
      return Array.from({length: count}, (_, r) => {
        const a = values[k * count + r], b = values[next * count + r];
        return dt === undefined ? a + f * (b - a) : (b - a) / dt;
      });
    });
  }
  /** out = base + Σ weights · fields, for the fields from number `from` on. */
  combine(out, base, weights, from = 0) {
    if (base) out.set(base); else out.fill(0);
    for (let r = from; r < this.fields.length; ++r) {
      const field = this.fields[r], weight = weights[r];
      if (weight !== 0) for (let i = 0; i < out.length; ++i) out[i] += weight * field[i];
    }
  }
  edges() {
    const seen = new Map();
    for (let t = 0; t < this.element.length; t += 3)
      for (let s = 0; s < 3; ++s) {
        const a = this.element[t + s], b = this.element[t + (s + 1) % 3];
        seen.set(Math.min(a, b) * 2 ** 26 + Math.max(a, b), [a, b]);
      }
    return Uint32Array.from([...seen.values()].flat());
  }
}

/** A colour of the style sheet, with components from 0 to 1. */
function cssColour(name) {
  const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim().slice(1);
  return [0, 2, 4].map(i => parseInt(hex.slice(i, i + 2), 16) / 255);
}
