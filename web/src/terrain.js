// SPDX-License-Identifier: GPL-3.0-or-later
// The terrain model: its heights, its hillshade as a texture on a mesh, and its height at a place.
import { BufferAttribute, BufferGeometry, DataTexture, LinearFilter, LinearMipmapLinearFilter, Mesh, MeshBasicMaterial, RGBAFormat, SRGBColorSpace } from 'three';
import { rampColour } from './classes.js';

const VOID = -2147483648;
const MESH_SIDE = 200; // vertices along the longer side: the texture has the rest of the detail

/** Rise per metre of one in so many cells with both neighbours: the slope that three quarters of them do not reach. */
function usualSlope(heights, nx, ny, cell, toMetres) {
  const slopes = [], step = Math.max(1, Math.floor((nx * ny) / 20000));
  for (let k = nx + 1; k + nx + 1 < nx * ny; k += step) {
    const east = ((heights[k + 1] - heights[k - 1]) * toMetres[2]) / (2 * cell * toMetres[0]);
    const north = ((heights[k + nx] - heights[k - nx]) * toMetres[2]) / (2 * cell * toMetres[1]);
    if (!Number.isNaN(east + north)) slopes.push(Math.hypot(east, north));
  }
  slopes.sort((a, b) => a - b);
  return slopes.length ? slopes[Math.floor(slopes.length * 0.75)] : 1;
}

/** Shade from four lights, weighted by aspect (Mark 1992), by the 3 x 3 operator of Horn (1981); 0 to 255, or -1 where there is no height. */
export function hillshade(heights, nx, ny, cell, toMetres, exaggeration = 1) {
  const out = new Float32Array(nx * ny).fill(-1);
  const altitude = (45 * Math.PI) / 180;
  const lights = [225, 270, 315, 360].map((d) => (d * Math.PI) / 180);
  for (let j = 0; j < ny; ++j)
    for (let i = 0; i < nx; ++i) {
      const own = heights[j * nx + i];
      if (Number.isNaN(own)) continue;
      const at = (di, dj) => {
        const ii = i + di, jj = j + dj;
        const v = ii < 0 || jj < 0 || ii >= nx || jj >= ny ? NaN : heights[jj * nx + ii];
        return Number.isNaN(v) ? own : v;
      };
      const scale = (exaggeration * toMetres[2]) / 8 / cell;
      const east = ((at(1, 1) + 2 * at(1, 0) + at(1, -1) - at(-1, 1) - 2 * at(-1, 0) - at(-1, -1)) * scale) / toMetres[0];
      const north = ((at(1, 1) + 2 * at(0, 1) + at(-1, 1) - at(1, -1) - 2 * at(0, -1) - at(-1, -1)) * scale) / toMetres[1];
      const slope = Math.hypot(east, north);
      const aspect = Math.atan2(-east, -north); // downhill, from north, clockwise
      let sum = 0, weights = 0;
      for (const azimuth of lights) {
        const weight = Math.sin(aspect - azimuth) ** 2;
        const lit = (Math.sin(altitude) + Math.cos(altitude) * slope * Math.cos(azimuth - aspect)) / Math.sqrt(1 + slope * slope);
        sum += weight * Math.max(lit, 0);
        weights += weight;
      }
      out[j * nx + i] = (255 * sum) / weights;
    }
  return out;
}

export class Terrain {
  /** `about`: lattice and step of the heights; `stored`: whole steps, row by row from the south-west. */
  constructor(about, stored, frame) {
    Object.assign(this, { nx: about.nx, ny: about.ny, cell: about.cell, west: about.west, south: about.south, frame });
    this.heights = Float64Array.from(stored, (v) => (v === VOID ? NaN : v * about.step + about.base));
    this.mesh = this.made();
  }

  texture() {
    const { nx, ny } = this;
    // Gentle country is shaded as if it were steeper, or it would be one grey.
    const stretch = Math.min(8, Math.max(1, 0.45 / usualSlope(this.heights, nx, ny, this.cell, this.frame.toMetres)));
    const shade = hillshade(this.heights, nx, ny, this.cell, this.frame.toMetres, stretch);
    const known = this.heights.filter((v) => !Number.isNaN(v)).sort();
    const low = known[Math.floor(known.length * 0.01)], high = known[Math.floor(known.length * 0.99)];
    const rgba = new Uint8Array(4 * nx * ny);
    for (let k = 0; k < nx * ny; ++k) {
      if (shade[k] < 0) {
        rgba.set([150, 150, 140, 0], 4 * k);
        continue;
      }
      const tone = rampColour('height', (this.heights[k] - low) / (high - low || 1));
      // Grey with a breath of the height's colour: points on it stay readable.
      for (let c = 0; c < 3; ++c) rgba[4 * k + c] = Math.min(255, (shade[k] / 255) * (0.82 * 255 + 0.18 * tone[c]) * 1.05);
      rgba[4 * k + 3] = 255;
    }
    const texture = new DataTexture(rgba, nx, ny, RGBAFormat);
    texture.colorSpace = SRGBColorSpace;
    texture.magFilter = LinearFilter;
    texture.minFilter = LinearMipmapLinearFilter;
    texture.generateMipmaps = true;
    texture.needsUpdate = true;
    return texture;
  }

  /** Mean of the heights up to so many cells away; NaN where there are none. */
  near(i, j, cells) {
    let sum = 0, n = 0;
    for (let b = Math.max(0, j - cells); b <= Math.min(this.ny - 1, j + cells); ++b)
      for (let a = Math.max(0, i - cells); a <= Math.min(this.nx - 1, i + cells); ++a) {
        const h = this.heights[b * this.nx + a];
        if (Number.isNaN(h)) continue;
        sum += h;
        ++n;
      }
    return n ? sum / n : NaN;
  }

  made() {
    const { nx, ny } = this;
    const step = Math.max(1, Math.ceil(Math.max(nx, ny) / MESH_SIDE));
    const places = (n) => {
      const out = [];
      for (let k = 0; k < n; k += step) out.push(k);
      if (out.at(-1) !== n - 1) out.push(n - 1);
      return out;
    };
    const is = places(nx), js = places(ny);
    const position = new Float32Array(3 * is.length * js.length);
    const uv = new Float32Array(2 * is.length * js.length);
    const known = new Uint8Array(is.length * js.length);
    let at = 0;
    for (const j of js)
      for (const i of is) {
        const h = this.heights[j * nx + i];
        // Vertices beside the model continue its rim: the texture cuts it off where it ends.
        const height = Number.isNaN(h) ? this.near(i, j, step) : h;
        known[at] = Number.isNaN(height) ? 0 : 1;
        position.set(this.frame.sceneOf(this.west + (i + 0.5) * this.cell, this.south + (j + 0.5) * this.cell, known[at] ? height : 0), 3 * at);
        uv.set([(i + 0.5) / nx, (j + 0.5) / ny], 2 * at);
        ++at;
      }
    const faces = [];
    for (let b = 0; b + 1 < js.length; ++b)
      for (let a = 0; a + 1 < is.length; ++a) {
        const sw = b * is.length + a, se = sw + 1, nw = sw + is.length, ne = nw + 1;
        if (known[sw] && known[se] && known[ne]) faces.push(sw, se, ne);
        if (known[sw] && known[ne] && known[nw]) faces.push(sw, ne, nw);
      }
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(position, 3));
    geometry.setAttribute('uv', new BufferAttribute(uv, 2));
    geometry.setIndex(faces);
    const material = new MeshBasicMaterial({ map: this.texture(), alphaTest: 0.5, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 4 });
    return new Mesh(geometry, material);
  }

  /** Height at a place of the map, between the four cells around it; NaN where one of them has none. */
  at(x, y) {
    const u = (x - this.west) / this.cell - 0.5, v = (y - this.south) / this.cell - 0.5;
    const i = Math.floor(u), j = Math.floor(v);
    if (i < 0 || j < 0 || i + 1 >= this.nx || j + 1 >= this.ny) return NaN;
    const a = u - i, b = v - j, k = j * this.nx + i, h = this.heights;
    return (1 - b) * ((1 - a) * h[k] + a * h[k + 1]) + b * ((1 - a) * h[k + this.nx] + a * h[k + this.nx + 1]);
  }
}
