// SPDX-License-Identifier: GPL-3.0-or-later
// A section: the points within a strip along a line of the map, and the terrain under the line, drawn as distance and height.
import { NOTHING } from './cloud.js';
import { classColour, className, css, lineColour, rampColour } from './classes.js';

const MOST = 400000; // points of a section that are kept: every n-th beyond

/** Points up to `halfWidth` metres from the line a, b (map coordinates), of the classes that are shown. */
export function cut(cloud, terrain, a, b, halfWidth) {
  const f = cloud.frame;
  const dx = (b[0] - a[0]) * f.toMetres[0], dy = (b[1] - a[1]) * f.toMetres[1];
  const length = Math.hypot(dx, dy);
  const found = [];
  for (const chunk of cloud.chunks) {
    if (!chunk.points.visible) continue;
    const { x, y, z } = chunk.columns, codes = chunk.columns.class;
    for (let k = 0; k < chunk.count; ++k) {
      const ex = (x[k] * f.scale[0] + f.offset[0] - a[0]) * f.toMetres[0], ey = (y[k] * f.scale[1] + f.offset[1] - a[1]) * f.toMetres[1];
      const along = (ex * dx + ey * dy) / length;
      if (along < 0 || along > length) continue;
      const aside = (ex * dy - ey * dx) / length;
      if (Math.abs(aside) > halfWidth || (codes && !cloud.visible[codes[k]])) continue;
      found.push({ along, aside, z: z[k] * f.scale[2] + f.offset[2], chunk, row: k });
    }
  }
  const step = Math.ceil(found.length / MOST);
  const ground = [];
  if (terrain) {
    const n = Math.min(4000, Math.max(2, Math.ceil(length / (terrain.cell * f.toMetres[0]) * 2)));
    for (let k = 0; k <= n; ++k) {
      const t = k / n;
      ground.push({ along: t * length, z: terrain.at(a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])) });
    }
  }
  return { a, b, length, halfWidth, points: step > 1 ? found.filter((_, k) => k % step === 0) : found, found: found.length, ground };
}

/** Whole steps of 1, 2 or 5 for an axis. */
export function ticks(low, high, most) {
  const raw = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((s) => s * power >= raw);
  const out = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; ++k) out.push(k * step);
  return { values: out, decimals: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function colourOf(cloud, p) {
  const c = p.chunk.columns, s = cloud.stretch;
  const share = (v, r) => (v - r[0]) / (r[1] - r[0]);
  if (cloud.mode === 'height') {
    const r = cloud.range;
    return rampColour('height', (p.chunk.position[3 * p.row + 2] - r[0]) / (r[1] - r[0]));
  }
  if (cloud.mode === 'intensity' && c.intensity) return rampColour('intensity', 0.15 + 0.85 * share(c.intensity[p.row], s.intensity));
  if (cloud.mode === 'sigma' && c.sigma_v)
    return c.sigma_v[p.row] === NOTHING ? [90, 90, 90] : rampColour('sigma', share(c.sigma_v[p.row], s.sigma));
  if (cloud.mode === 'line' && c.line) return lineColour(cloud.lineIndex(c.line[p.row]));
  return classColour(c.class ? c.class[p.row] : 0);
}

export class SectionPanel {
  constructor(canvas, note, heightUnit) {
    Object.assign(this, { canvas, note, heightUnit, section: null });
  }

  /** Draws the section; heights stretched as far as the panel allows, which is stated. */
  draw(section, cloud) {
    this.section = section;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const box = this.canvas.getBoundingClientRect();
    const w = Math.max(200, box.width), h = Math.max(120, box.height);
    this.canvas.width = w * ratio;
    this.canvas.height = h * ratio;
    const g = this.canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.fillStyle = '#10141a';
    g.fillRect(0, 0, w, h);
    const heights = [...section.points.map((p) => p.z), ...section.ground.map((p) => p.z)].filter((z) => !Number.isNaN(z));
    if (heights.length === 0) {
      this.note.textContent = `No point lies within ${section.halfWidth} m of the line, and no terrain. Points shown are a part of the cloud: try a wider strip.`;
      return;
    }
    let low = Infinity, high = -Infinity;
    for (const z of heights) {
      if (z < low) low = z;
      if (z > high) high = z;
    }
    const pad = Math.max(0.5, 0.06 * (high - low));
    low -= pad;
    high += pad;
    const left = 62, right = w - 14, top = 10, bottom = h - 36;
    this.x = (s) => left + (s / section.length) * (right - left);
    this.y = (z) => bottom - ((z - low) / (high - low)) * (bottom - top);
    this.axes(g, { low, high, left, right, top, bottom, length: section.length, w, h });
    for (const p of section.points) {
      g.fillStyle = css(colourOf(cloud, p));
      g.fillRect(this.x(p.along) - 1, this.y(p.z) - 1, 2, 2);
    }
    g.strokeStyle = '#ffffff';
    g.lineWidth = 1.2;
    g.beginPath();
    let down = false;
    for (const p of section.ground) {
      if (Number.isNaN(p.z)) {
        down = false;
        continue;
      }
      down ? g.lineTo(this.x(p.along), this.y(p.z)) : g.moveTo(this.x(p.along), this.y(p.z));
      down = true;
    }
    g.stroke();
    const stretch = ((bottom - top) / (high - low) / cloud.frame.toMetres[2]) / ((right - left) / section.length);
    const z = (v) => v.toFixed(1);
    this.note.textContent = `${section.length.toFixed(1)} m long, strip of ${(2 * section.halfWidth).toFixed(1)} m, ${section.found.toLocaleString('en').replaceAll(',', '\u202f')} points of those shown, ` +
      `${z(low + pad)} to ${z(high - pad)} ${this.heightUnit}, heights ${stretch.toPrecision(2)} times` + (section.ground.some((p) => !Number.isNaN(p.z)) ? '; white: terrain model' : '');
  }

  axes(g, f) {
    g.font = '12px system-ui, sans-serif';
    g.strokeStyle = '#2a323d';
    g.fillStyle = '#aab4c0';
    g.lineWidth = 1;
    const along = ticks(0, f.length, Math.max(2, (f.right - f.left) / 110));
    g.textAlign = 'center';
    for (const s of along.values) {
      const x = Math.round(this.x(s)) + 0.5;
      g.beginPath();
      g.moveTo(x, f.top);
      g.lineTo(x, f.bottom);
      g.stroke();
      g.fillText(s.toFixed(along.decimals), x, f.bottom + 15);
    }
    const up = ticks(f.low, f.high, Math.max(2, (f.bottom - f.top) / 34));
    g.textAlign = 'right';
    for (const z of up.values) {
      const y = Math.round(this.y(z)) + 0.5;
      g.beginPath();
      g.moveTo(f.left, y);
      g.lineTo(f.right, y);
      g.stroke();
      g.fillText(z.toFixed(up.decimals), f.left - 6, y + 4);
    }
    g.textAlign = 'center';
    g.fillText('distance along the section (m)', (f.left + f.right) / 2, f.h - 6);
    g.save();
    g.translate(12, (f.top + f.bottom) / 2);
    g.rotate(-Math.PI / 2);
    g.fillText(`height (${this.heightUnit})`, 0, 0);
    g.restore();
  }

  /** The point of the section nearest to a place on its canvas, within 8 pixels. */
  nearest(px, py) {
    let best = null, bestOff = 64;
    for (const p of this.section?.points ?? []) {
      const off = (this.x(p.along) - px) ** 2 + (this.y(p.z) - py) ** 2;
      if (off < bestOff) {
        bestOff = off;
        best = p;
      }
    }
    return best;
  }

  /** The section as CSV. */
  csv(frame) {
    const rows = ['kind,along_m,aside_m,x,y,z,class'];
    const d = frame.decimals;
    for (const p of this.section.points) {
      const c = p.chunk.columns;
      const at = frame.mapOf(c, p.row);
      rows.push(`point,${p.along.toFixed(3)},${p.aside.toFixed(3)},${at[0].toFixed(d[0])},${at[1].toFixed(d[1])},${at[2].toFixed(d[2])},${c.class ? className(c.class[p.row]) : ''}`);
    }
    for (const p of this.section.ground) if (!Number.isNaN(p.z)) rows.push(`terrain,${p.along.toFixed(3)},0,,,${p.z.toFixed(3)},`);
    return rows.join('\n') + '\n';
  }
}
