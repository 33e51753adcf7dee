// SPDX-License-Identifier: BSD-2-Clause
// Surfaces of bodies X + F c(t), with a few shapes F in place of the modes of each body, and what draws them: colours, shaders, vectors.
// A body with finite rotations is then turned about its centre of mass, by unit quaternions (w, x, y, z).

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

/** The quaternion of the turn `b` after the inverse of the turn `a`, in the axes before both. */
function turnBetween(a, b) {
  const [u, v] = [a.slice(1), b.slice(1)], across = cross(u, v);
  return [a[0] * b[0] + dot(u, v), ...[0, 1, 2].map(i => a[0] * v[i] - b[0] * u[i] - across[i])];
}

/** The axis times the angle [rad] of a turn, the shorter way round. */
function angles(turn) {
  const [w, ...v] = turn, sine = Math.hypot(...v), angle = 2 * Math.atan2(sine, Math.abs(w));
  return v.map(x => sine ? Math.sign(w || 1) * angle * x / sine : 0);
}

/** The turn at share f of the way from a to b, at constant speed, the shorter way round. */
function turnAt(a, b, f) {
  const cosine = a.reduce((sum, x, i) => sum + x * b[i], 0), angle = Math.acos(Math.min(1, Math.abs(cosine)));
  const [s, t] = angle < 1e-4 ? [1 - f, f] : [1 - f, f].map(share => Math.sin(share * angle) / Math.sin(angle));
  return a.map((x, i) => s * x + (cosine < 0 ? -t : t) * b[i]);
}

/** The rows of the rotation matrix of a turn. */
function matrix([w, ...v]) {
  const size = w * w + dot(v, v);
  return [0, 1, 2].map(i => {
    const e = unit(i), across = cross(v, e);
    return e.map((x, j) => x + 2 * (v[i] * v[j] - dot(v, v) * x - w * across[j]) / size);
  });
}

const columns = rows => rows.map((_, i) => rows.map(row => row[i]));
const product = (rows, x) => rows.map(row => dot(row, x));

/** An empty box, which grows with the places that are added. */
function box() {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const add = values => values.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  return {low, high, add};
}

/** The von Mises stress of xx, yy, zz, yz, xz, xy. */
function vonMises(x, y, z, yz, xz, xy) {
  return Math.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 3 * (yz ** 2 + xz ** 2 + xy ** 2));
}

/** The principal stresses, the largest first: the mean, and what the angle of Lode adds to it. */
function principalStresses(x, y, z, yz, xz, xy) {
  const mean = (x + y + z) / 3, equivalent = vonMises(x, y, z, yz, xz, xy);
  if (equivalent === 0) return [mean, mean, mean];
  const [a, b, c] = [x - mean, y - mean, z - mean];
  const third = a * b * c + 2 * yz * xz * xy - a * yz ** 2 - b * xz ** 2 - c * xy ** 2;
  const angle = Math.acos(Math.max(-1, Math.min(1, 13.5 * third / equivalent ** 3))) / 3;
  return [0, 1, 2].map(k => mean + 2 / 3 * equivalent * Math.cos(angle - 2 * Math.PI * k / 3));
}

/** What stresses amount to, by the names of the envelopes. */
const stressMeasures = {
  von_mises: vonMises,
  principal: (...stress) => principalStresses(...stress)[0],
  shear: (...stress) => { const [first, , last] = principalStresses(...stress); return (first - last) / 2; },
};

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
    this.outline = data.outline && unpack(data.outline);  // pairs of nodes
    this.fields = this.still ? [] : [...MovingSurface.rows(data.rigid), ...data.bent.map(unpack)];
    this.rigid = this.still ? 0 : data.rigid.shape[0];
    this.amounts = this.still ? [] : [unpack(data.moved), unpack(data.amount)];
    this.poses = data.poses && {centre: data.poses.centre, position: unpack(data.poses.position), turn: unpack(data.poses.turn)};
    this.place = Float32Array.from(this.node);
    this.value = new Float32Array(this.node.length / 3);
    this.modes = data.modes ?? {};
    this.stress = data.stress && {fields: data.stress.fields.map(unpack), amount: unpack(data.stress.amount)};
    this.envelope = data.stress && Object.fromEntries(Object.entries(data.stress.envelope).map(
      ([measure, values]) => [measure, {value: unpack(values), largest: values.largest}]));
  }
  /** Writes a measure of the stress at snapshot k + f to `value`, or its largest value of the run. */
  stressAt(measure, k, f, enveloped) {
    if (!this.stress) return void this.value.fill(0);
    if (enveloped) return void this.value.set(this.envelope[measure].value);
    const {fields, amount} = this.stress, next = Math.min(k + 1, amount.length / fields.length - 1), stress = new Float32Array(6 * this.value.length);
    for (const [r, field] of fields.entries()) {
      const a = amount[k * fields.length + r], weight = a + f * (amount[next * fields.length + r] - a);
      if (weight !== 0) for (let i = 0; i < stress.length; ++i) stress[i] += weight * field[i];
    }
    const of = stressMeasures[measure];
    for (let v = 0, i = 0; v < this.value.length; ++v, i += 6)
      this.value[v] = of(stress[i], stress[i + 1], stress[i + 2], stress[i + 3], stress[i + 4], stress[i + 5]);
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
  /** The poses of the snapshots k and k + 1, as a position of the centre of mass and a turn since the first snapshot. */
  around(k) {
    const {position, turn} = this.poses, last = turn.length / 4 - 1;
    return [k, Math.min(k + 1, last)].map(at => ({position: [...position.subarray(3 * at, 3 * at + 3)], turn: [...turn.subarray(4 * at, 4 * at + 4)]}));
  }
  /** The pose at snapshot k + f: the position of the centre of mass and the rows of the rotation since the first snapshot. */
  pose(k, f) {
    const [a, b] = this.around(k);
    return {position: a.position.map((x, i) => x + f * (b.position[i] - x)), rows: matrix(turnAt(a.turn, b.turn, f))};
  }
  /** Moves points from where they are at the first snapshot by a pose. */
  carry(points, {position, rows}) {
    const {centre} = this.poses;
    for (let i = 0; i < points.length; i += 3) {
      const [x, y, z] = centre.map((c, j) => points[i + j] - c);
      for (let j = 0; j < 3; ++j) points[i + j] = position[j] + rows[j][0] * x + rows[j][1] * y + rows[j][2] * z;
    }
  }
  /** out = places at snapshot k + f, with the deformation `amplify` times as large. */
  placeAt(out, k, f, amplify = 1) {
    this.combine(out, this.node, this.amplitudes(k, f).map((c, r) => r < this.rigid ? c : amplify * c));
    if (this.poses) this.carry(out, this.pose(k, f));
  }
  /** out = velocities at snapshot k + f; with poses, in the axes of the body at the first snapshot, and the spin of the body without
   *  deformation. dt is the time from snapshot k to k + 1. */
  velocities(out, k, f, dt) {
    this.combine(out, null, this.amplitudes(k, f, dt));
    if (!this.poses) return;
    const [a, b] = this.around(k), {centre} = this.poses, spin = angles(turnBetween(a.turn, b.turn)).map(angle => angle / dt);
    const along = product(columns(this.pose(k, f).rows), b.position.map((x, i) => (x - a.position[i]) / dt));
    for (let i = 0; i < out.length; i += 3) {
      const about = cross(spin, centre.map((c, j) => this.node[i + j] - c));
      for (let j = 0; j < 3; ++j) out[i + j] += along[j] + about[j];
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
