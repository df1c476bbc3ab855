// SPDX-License-Identifier: GPL-3.0-or-later
// Points on the screen: chunks of columns, one material that colours them, and the point under the pointer.
import { BufferAttribute, BufferGeometry, Group, Matrix4, Points, ShaderMaterial, Sphere, Vector3 } from 'three';
import { spread } from './spread.js';
import { NOISE, RAMPS, classColour, lineColour, rampColour } from './classes.js';

export const MODES = ['class', 'height', 'intensity', 'sigma', 'line'];
const NOTHING = 65535; // a sigma that is not known

// Colours are made on the processor when they change: drawn by software, a look into a texture for each point of each picture takes longer.
const VERTEX = `
attribute vec4 tint;
uniform float spacing, pixels, factor;
varying vec3 colour;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  gl_Position = tint.a < 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : projectionMatrix * seen;
  gl_PointSize = clamp(spacing * pixels / max(-seen.z, 1e-3), 1.0, 9.0) * factor;
  colour = tint.rgb;
}`;
const FRAGMENT = `
varying vec3 colour;
void main() { gl_FragColor = vec4(colour, 1.0); }`;

/** Shares p and 1 - p of a sample of the values that are known. */
export function percentiles(values, p, unknown = -1) {
  const some = [];
  const step = Math.max(1, Math.floor(values.length / 50000));
  for (let k = 0; k < values.length; k += step) if (values[k] !== unknown) some.push(values[k]);
  if (some.length === 0) return [0, 1];
  some.sort((a, b) => a - b);
  const low = some[Math.floor(p * (some.length - 1))];
  const high = some[Math.floor((1 - p) * (some.length - 1))];
  return high > low ? [low, high] : [low, low + 1];
}

function gathered(values, order) {
  const out = new values.constructor(values.length);
  for (let k = 0; k < out.length; ++k) out[k] = values[order[k]];
  return out;
}

export class Cloud {
  /** `frame`: from stored numbers to the scene and to map coordinates (see main.js). */
  constructor(frame) {
    this.frame = frame;
    this.group = new Group();
    this.chunks = [];
    this.stretch = null;
    this.visible = new Uint8Array(256).fill(1);
    for (const c of NOISE) this.visible[c] = 0;
    this.material = new ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { spacing: { value: 1 }, pixels: { value: 1 }, factor: { value: 1 } },
    });
    this.range = [0, 1]; // heights of the ramp, in the scene
    this.shownAs = 'class';
    this.lines = [];
    this.counts = new Map();
  }

  get mode() { return this.shownAs; }
  set mode(name) {
    this.shownAs = name;
    this.paint();
  }
  get size() { return this.chunks.reduce((n, c) => n + c.count, 0); }

  /** Colours of the points as they are shown now. */
  paint(chunks = this.chunks) {
    const classes = Array.from({ length: 256 }, (_, k) => classColour(k));
    const lines = Array.from({ length: 256 }, (_, k) => lineColour(k));
    const ramp = this.mode in RAMPS ? Array.from({ length: 256 }, (_, k) => rampColour(this.mode, k / 255)) : null;
    const grey = [90, 90, 90];
    for (const { count, look, position, points } of chunks) {
      const attribute = points.geometry.getAttribute('tint'), tint = attribute.array;
      const [low, high] = this.range;
      for (let k = 0; k < count; ++k) {
        const code = look[4 * k];
        if (!this.visible[code]) {
          tint[4 * k + 3] = 0;
          continue;
        }
        let rgb = classes[code], light = 0.68 + (0.32 / 255) * look[4 * k + 3];
        if (this.mode === 'height') rgb = ramp[Math.min(255, Math.max(0, Math.round(((position[3 * k + 2] - low) / (high - low)) * 255)))];
        else if (this.mode === 'intensity') (rgb = ramp[look[4 * k + 3]]), (light = 1);
        else if (this.mode === 'sigma') (rgb = look[4 * k + 2] === 255 ? grey : ramp[look[4 * k + 2]]), (light = 1);
        else if (this.mode === 'line') rgb = lines[look[4 * k + 1]];
        tint[4 * k] = rgb[0] * light;
        tint[4 * k + 1] = rgb[1] * light;
        tint[4 * k + 2] = rgb[2] * light;
        tint[4 * k + 3] = 255;
      }
      attribute.needsUpdate = true;
    }
  }

  show(code, on) {
    this.visible[code] = on ? 1 : 0;
    this.paint();
  }

  /** The index of a flight line's colour. */
  lineIndex(id) {
    let k = this.lines.indexOf(id);
    if (k < 0) k = this.lines.push(id) - 1;
    return k & 255;
  }

  /** Takes columns {x, y, z: Int32Array, class, intensity, line, returns, sigma_v ...}; all but the coordinates may be absent. */
  add(columns, key = '') {
    const n = columns.x.length;
    if (!this.stretch && n > 0) this.learn(columns);
    const order = columns.shuffled ? null : spread(n);
    const position = new Float32Array(3 * n);
    const look = new Uint8Array(4 * n);
    const own = {};
    for (const [name, values] of Object.entries(columns)) {
      if (!ArrayBuffer.isView(values)) continue;
      own[name] = order ? gathered(values, order) : values;
    }
    const f = this.frame;
    const s = this.stretch;
    let lastId = -1, lastIndex = 0;
    const counts = new Uint32Array(256);
    const level = (v, r) => Math.min(Math.max(((v - r[0]) / (r[1] - r[0])) * 255, 0), 255);
    for (let k = 0; k < n; ++k) {
      position[3 * k] = own.x[k] * f.step[0] - f.centre[0];
      position[3 * k + 1] = own.y[k] * f.step[1] - f.centre[1];
      position[3 * k + 2] = own.z[k] * f.step[2] - f.centre[2];
      const c = own.class ? own.class[k] : 0;
      if (own.line && own.line[k] !== lastId) lastIndex = this.lineIndex((lastId = own.line[k]));
      look[4 * k] = c;
      look[4 * k + 1] = lastIndex;
      look[4 * k + 2] = !own.sigma_v || own.sigma_v[k] === NOTHING ? 255 : Math.min(level(own.sigma_v[k], s.sigma), 254);
      look[4 * k + 3] = own.intensity ? level(own.intensity[k], s.intensity) : 200;
      ++counts[c];
    }
    counts.forEach((m, c) => m > 0 && this.counts.set(c, (this.counts.get(c) ?? 0) + m));
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(position, 3));
    geometry.setAttribute('tint', new BufferAttribute(new Uint8Array(4 * n), 4, true));
    geometry.computeBoundingSphere();
    const points = new Points(geometry, this.material);
    this.group.add(points);
    const chunk = { key, count: n, columns: own, position, look, points };
    this.chunks.push(chunk);
    this.paint([chunk]);
    return chunk;
  }

  remove(chunk) {
    this.group.remove(chunk.points);
    chunk.points.geometry.dispose();
    this.chunks.splice(this.chunks.indexOf(chunk), 1);
    for (let k = 0; k < chunk.count; ++k) {
      const c = chunk.look[4 * k];
      this.counts.set(c, this.counts.get(c) - 1);
    }
  }

  /** Ranges of the colours, from the first points that come. */
  learn(columns) {
    this.stretch = {
      intensity: columns.intensity ? percentiles(columns.intensity, 0.02) : [0, 1],
      sigma: columns.sigma_v ? percentiles(columns.sigma_v, 0.02, NOTHING) : null,
    };
    if (this.stretch.sigma) this.stretch.sigma[0] = Math.min(this.stretch.sigma[0], this.stretch.sigma[1] * 0.5);
    const z = columns.class ? columns.z.filter((_, k) => !NOISE.includes(columns.class[k])) : columns.z;
    const [low, high] = percentiles(z.length ? z : columns.z, 0.01).map((v) => v * this.frame.step[2] - this.frame.centre[2]);
    this.range = high > low ? [low, high] : [low, low + 1];
  }

  /** Draws the points of each chunk between two shares of it. */
  limit(from, to) {
    for (const c of this.chunks) {
      const first = Math.floor(c.count * from);
      c.points.geometry.setDrawRange(first, Math.ceil(c.count * to) - first);
    }
  }

  /** The point drawn nearest to a place on the screen (pixels): {chunk, row}, or null. */
  pick(camera, width, height, px, py, radius) {
    const clip = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).multiply(this.group.matrixWorld);
    const m = clip.elements;
    const sphere = new Sphere(), centre = new Vector3();
    let best = null, bestScore = Infinity;
    for (const chunk of this.chunks) {
      if (!chunk.points.visible) continue;
      sphere.copy(chunk.points.geometry.boundingSphere).applyMatrix4(this.group.matrixWorld);
      if (camera.position.distanceTo(sphere.center) > sphere.radius) {
        centre.copy(sphere.center).project(camera);
        const reach = (sphere.radius / camera.position.distanceTo(sphere.center)) * height * 2 + radius;
        if (Math.hypot((centre.x + 1) * 0.5 * width - px, (1 - centre.y) * 0.5 * height - py) > reach + width * 0.2) continue;
      }
      const p = chunk.position, codes = chunk.columns.class;
      for (let k = 0, n = chunk.count; k < n; ++k) {
        const x = p[3 * k], y = p[3 * k + 1], z = p[3 * k + 2];
        const w = m[3] * x + m[7] * y + m[11] * z + m[15];
        if (w <= 0) continue;
        const sx = ((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) * 0.5 * width - px;
        if (sx > radius || sx < -radius) continue;
        const sy = (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) * 0.5 * height - py;
        const off = sx * sx + sy * sy;
        if (off > radius * radius || (codes && !this.visible[codes[k]])) continue;
        // Of points that lie as near to the pointer, the one in front; a point behind by more than its neighbours is hidden by them.
        const score = w * (1 + 0.02 * Math.sqrt(off) / radius);
        if (score < bestScore) {
          bestScore = score;
          best = { chunk, row: k };
        }
      }
    }
    return best;
  }
}

export { NOTHING };
