// SPDX-License-Identifier: GPL-3.0-or-later
/** Stored whole numbers, coordinates of the map, and metres about the middle of the data, in which the scene is drawn. */
export class Frame {
  /** map = stored * scale + offset; `toMetres`: of the CRS's units, east, north and up; `low`, `high`: corners of the data on the map. */
  constructor({ scale, offset, low, high }, toMetres) {
    Object.assign(this, { scale, offset, toMetres });
    this.step = scale.map((s, k) => s * toMetres[k]);
    this.centre = [0, 1, 2].map((k) => ((low[k] + high[k]) / 2 - offset[k]) * toMetres[k]);
    this.size = [0, 1, 2].map((k) => (high[k] - low[k]) * toMetres[k]);
    this.decimals = scale.map((s) => Math.min(9, Math.max(0, Math.ceil(-Math.log10(s) - 1e-6))));
  }
  sceneOf(x, y, z) {
    return [x, y, z].map((v, k) => (v - this.offset[k]) * this.toMetres[k] - this.centre[k]);
  }
  mapOfScene(p) {
    return [p.x, p.y, p.z].map((v, k) => (v + this.centre[k]) / this.toMetres[k] + this.offset[k]);
  }
  mapOf(columns, row) {
    return [columns.x, columns.y, columns.z].map((v, k) => v[row] * this.scale[k] + this.offset[k]);
  }
}
