// SPDX-License-Identifier: GPL-3.0-or-later
// Which nodes of COPC files are on the screen: the nearest and largest first, as many points as the browser is to hold.
import { Box3, Frustum, Matrix4, Vector3 } from 'three';

const FINE = 1.3;   // pixels between points below which a node is not divided further
const FLYING = 3;   // nodes asked for at a time

export class Octrees {
  /** `onPoints`: called when something new is to be drawn; `budget`: points; `measured`: metres between those of the whole cloud. */
  constructor(addresses, cloud, view, { budget, measured }, onPoints) {
    Object.assign(this, { cloud, view, budget, measured, onPoints, files: [], loaded: new Map(), flying: new Set(), failed: new Set(), fault: '' });
    this.worker = new Worker('stream.js');
    this.worker.onmessage = ({ data }) => this.answer(data);
    this.opened = new Promise((resolve, reject) => Object.assign(this, { resolve, reject }));
    const f = cloud.frame;
    this.worker.postMessage({ open: addresses.map((a) => new URL(a, location.href).href), frame: { scale: f.scale, offset: f.offset } });
  }

  answer(data) {
    if (data.opened) {
      this.files = data.opened;
      return this.resolve();
    }
    const id = `${data.file}:${data.key}`;
    this.flying.delete(id);
    if (data.failed) {
      this.fault = data.failed;
      if (data.key === undefined) return this.reject(new Error(data.failed));
      this.failed.add(id);
    } else {
      const chunk = this.cloud.add({ ...data.columns, shuffled: true }, id);
      this.loaded.set(id, { chunk, used: performance.now() });
    }
    this.update();
    this.onPoints();
  }

  box(file, [level, x, y, z]) {
    const { centre, half } = this.files[file];
    const side = (2 * half) / 2 ** level, f = this.cloud.frame;
    const low = [x, y, z].map((k, a) => centre[a] - half + k * side);
    return new Box3(new Vector3(...f.sceneOf(...low)), new Vector3(...f.sceneOf(...low.map((v) => v + side))));
  }

  /** Chooses the nodes for the camera as it is, shows those that are there and asks for those that are not. */
  update() {
    const { camera, world, pixels } = this.view;
    camera.updateMatrixWorld(true);
    world.updateMatrixWorld(true);
    const frustum = new Frustum().setFromProjectionMatrix(new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const queue = this.files.map((_, file) => ({ file, key: [0, 0, 0, 0], size: Infinity }));
    const wanted = new Map();
    let points = 0;
    while (queue.length > 0) {
      queue.sort((a, b) => a.size - b.size);
      const { file, key } = queue.pop();
      const name = key.join('-'), n = this.files[file].nodes[name];
      if (n === undefined || points + n > this.budget) continue;
      points += n;
      wanted.set(`${file}:${name}`, { file, key: name, n, spacing: this.spacing(file, key[0]) });
      for (let o = 0; o < 8; ++o) {
        const child = [key[0] + 1, 2 * key[1] + (o & 1), 2 * key[2] + ((o >> 1) & 1), 2 * key[3] + (o >> 2)];
        if (this.files[file].nodes[child.join('-')] === undefined) continue;
        const box = this.box(file, child).applyMatrix4(world.matrixWorld);
        if (!frustum.intersectsBox(box)) continue;
        const distance = Math.max(box.distanceToPoint(camera.position), 1e-3);
        if ((this.spacing(file, key[0]) * pixels) / distance < FINE) continue;
        queue.push({ file, key: child, size: box.getSize(new Vector3()).length() / distance });
      }
    }
    this.apply(wanted);
  }

  spacing(file, level) { return (this.files[file].spacing * this.cloud.frame.toMetres[0]) / 2 ** level; }

  apply(wanted) {
    const now = performance.now();
    for (const [id, entry] of this.loaded) {
      entry.chunk.points.visible = wanted.has(id);
      if (wanted.has(id)) entry.used = now;
    }
    let held = this.cloud.size;
    for (const [id, entry] of [...this.loaded].sort((a, b) => a[1].used - b[1].used)) {
      if (held <= 2 * this.budget) break;
      if (wanted.has(id)) continue;
      held -= entry.chunk.count;
      this.cloud.remove(entry.chunk);
      this.loaded.delete(id);
    }
    let finest = Infinity;
    for (const [id, { file, key, n, spacing }] of wanted) {
      if (n > 0 && this.loaded.has(id)) finest = Math.min(finest, spacing);
      if (n === 0 || this.loaded.has(id) || this.flying.has(id) || this.failed.has(id) || this.flying.size >= FLYING) continue;
      this.flying.add(id);
      this.worker.postMessage({ file, key });
    }
    this.idle = this.flying.size === 0;
    // Where a node has all points of its place, they lie as far apart as they were measured, not as its level allows.
    if (finest < Infinity) this.cloud.material.uniforms.spacing.value = Math.max(1.3 * finest, this.measured);
  }
}
