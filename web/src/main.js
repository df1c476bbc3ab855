// SPDX-License-Identifier: GPL-3.0-or-later
// The page of `swath view`: takes its scene from itself or from the server it came from, and draws it.
import { BufferAttribute, BufferGeometry, Line, LineBasicMaterial, Vector3 } from 'three';
import { Cloud } from './cloud.js';
import { Refused, column, scene as readScene } from './data.js';
import { Frame } from './frame.js';
import * as lines from './lines.js';
import { Octrees } from './octree.js';
import { $, count, fillModes, layer, legend, save, say, showValues, valuesOf } from './panel.js';
import { SectionPanel, cut } from './section.js';
import { Terrain } from './terrain.js';
import { View } from './view.js';

const CLICK = 5; // pixels that a click may move

async function columnsOf(about, served) {
  const names = Object.keys(about);
  const values = await Promise.all(names.map((n) => column(about[n], served)));
  return Object.fromEntries(names.map((n, k) => [n, values[k]]));
}

class Page {
  constructor(scene) {
    this.scene = scene;
    this.served = !!scene.served;
    this.units = { plane: scene.crs.unit, height: scene.crs.heightUnit };
    this.frame = new Frame(scene.points ?? scene.extent, scene.crs.toMetres);
    this.view = new View($('view'), this.frame);
    this.cloud = new Cloud(this.frame);
    this.view.world.add(this.cloud.group);
    this.view.points = this.cloud.group;
    this.view.onLimit = (from, to) => {
      this.cloud.material.uniforms.pixels.value = this.view.pixels;
      this.cloud.limit(from, to);
    };
    this.redraw = () => this.view.draw();
    this.sectionEnds = [];
  }

  async load() {
    const s = this.scene;
    if (s.points) {
      this.sample = this.cloud.add(await columnsOf(s.points.columns, this.served));
      this.spacing(s.points.shown);
    }
    if (s.copc) await this.stream();
    if (s.terrain) this.terrain = new Terrain(s.terrain, (await columnsOf(s.terrain.columns, this.served)).height, this.frame);
    if (this.terrain) this.view.world.add(this.terrain.mesh);
    if (s.contours) this.contours = lines.contours(s.contours, await columnsOf(s.contours.columns, this.served), this.frame);
    if (this.contours) this.view.world.add(this.contours);
    if (s.trajectory) this.trajectory = lines.trajectory(s.trajectory, await columnsOf(s.trajectory.columns, this.served), this.frame);
    if (this.trajectory) this.view.world.add(this.trajectory);
  }

  /** Takes points from COPC files as the view needs them, in place of the sample. */
  async stream() {
    this.octrees = new Octrees(this.scene.copc, this.cloud, this.view, { budget: this.scene.budget, measured: this.distance(this.scene.points.of) }, () => {
      if (this.sample && this.octrees.loaded.size > 0) {
        this.cloud.remove(this.sample);
        this.sample = null;
      }
      this.view.draw();
      this.counted();
      if (this.panel && this.octrees.idle) this.legend();
    });
    await this.octrees.opened;
    this.view.onRest = () => this.octrees.update();
  }

  counted() {
    const shown = this.cloud.chunks.reduce((n, c) => n + (c.points.visible ? c.count : 0), 0);
    $('shown').textContent = this.scene.points ? `${count(shown)} of ${count(this.scene.points.of)} points shown` : '';
    if (this.octrees?.fault) $('shown').textContent += `; some could not be read: ${this.octrees.fault}`;
  }

  /** Metres between as many points, spread evenly. */
  distance(n) {
    return 1.1 * Math.sqrt(Math.max(1, this.frame.size[0] * this.frame.size[1]) / Math.max(1, n));
  }

  /** Points on the screen are as large as their distance to the next, so that surfaces close. */
  spacing(n) {
    this.cloud.material.uniforms.spacing.value = this.distance(n);
  }

  legend() {
    legend(this.cloud, this.frame, this.units, this.redraw);
  }

  controls() {
    const s = this.scene;
    fillModes(this.cloud, s.points ? s.points.columns : {}, () => {
      this.legend();
      this.redraw();
      this.redrawSection();
    });
    layer('points', s.points && this.cloud.group, true, this.redraw);
    layer('terrain model', this.terrain?.mesh, true, this.redraw);
    layer('contours', this.contours, true, this.redraw);
    layer('trajectory', this.trajectory, false, this.redraw);
    this.legend();
    $('size').oninput = () => {
      this.cloud.material.uniforms.factor.value = Number($('size').value);
      this.redraw();
    };
    $('stretch').oninput = () => {
      const k = Number($('stretch').value);
      this.view.world.scale.z = k;
      $('stretch-value').textContent = `${k} ×`;
      this.redraw();
    };
    $('above').onclick = () => this.view.home(false);
    $('oblique').onclick = () => this.view.home(true);
    $('section').onclick = () => this.startSection();
    $('section-close').onclick = () => this.closeSection();
    $('section-save').onclick = () => save('section.csv', this.panel.csv(this.frame), 'text/csv');
    $('half-width').onchange = () => this.ends && this.showSection(...this.ends);
    this.panel = new SectionPanel($('section-canvas'), $('section-note'), this.units.height);
    this.pointer();
  }

  pointer() {
    const canvas = $('view');
    let down = null;
    canvas.addEventListener('pointerdown', (e) => (down = [e.offsetX, e.offsetY]));
    canvas.addEventListener('pointerup', (e) => {
      if (!down || e.button !== 0 || Math.hypot(e.offsetX - down[0], e.offsetY - down[1]) > CLICK) return;
      this.sectionEnds ? this.click(e.offsetX, e.offsetY) : 0;
    });
    $('section-canvas').addEventListener('click', (e) => {
      const p = this.panel.nearest(e.offsetX, e.offsetY);
      if (p) this.showPicked(p.chunk, p.row);
    });
    window.addEventListener('keydown', (e) => {
      if (e.key === 'Escape') this.cutting ? this.stopCutting() : showValues([]);
    });
    new ResizeObserver(() => this.redrawSection()).observe($('section-canvas'));
  }

  click(px, py) {
    if (this.cutting) return this.sectionClick(px, py);
    const found = this.pick(px, py);
    found ? this.showPicked(found.chunk, found.row) : showValues([]);
  }

  pick(px, py, radius = 7) {
    this.view.world.updateMatrixWorld(true);
    this.view.camera.updateMatrixWorld(true);
    return this.cloud.pick(this.view.camera, this.view.width, this.view.height, px, py, radius);
  }

  showPicked(chunk, row) {
    const pairs = valuesOf(chunk, row, this.cloud, this.terrain, this.units);
    showValues(pairs);
    this.mark([...chunk.position.subarray(3 * row, 3 * row + 3)]);
    return pairs;
  }

  /** A cross at a point of the scene. */
  mark(at) {
    this.cross?.removeFromParent();
    const r = Math.max(0.5, this.view.camera.position.distanceTo(this.view.controls.target) * 0.012);
    const p = [-r, 0, 0, r, 0, 0, 0, 0, 0, 0, -r, 0, 0, r, 0, 0, 0, 0, 0, 0, -r, 0, 0, r];
    const g = new BufferGeometry();
    g.setAttribute('position', new BufferAttribute(new Float32Array(p), 3));
    this.cross = new Line(g, new LineBasicMaterial({ color: 0xffffff, depthTest: false }));
    this.cross.position.set(...at);
    this.cross.renderOrder = 9;
    this.view.overlay.add(this.cross);
    this.redraw();
  }

  startSection() {
    this.cutting = true;
    this.sectionEnds = [];
    document.body.classList.add('cutting');
    $('hint').textContent = 'Click where the section begins.';
  }

  stopCutting() {
    this.cutting = false;
    document.body.classList.remove('cutting');
    $('hint').textContent = HINT;
  }

  sectionClick(px, py) {
    const near = this.pick(px, py, 16);
    const p = near ? new Vector3(...near.chunk.position.subarray(3 * near.row, 3 * near.row + 3)) : this.view.planeUnder(px, py);
    if (!p) return;
    this.sectionEnds.push(this.frame.mapOfScene(p).slice(0, 2));
    this.mark([p.x, p.y, p.z]);
    if (this.sectionEnds.length < 2) return void ($('hint').textContent = 'Click where it ends.');
    this.stopCutting();
    const [a, b] = this.sectionEnds;
    this.sectionEnds = [];
    if (Math.hypot(a[0] - b[0], a[1] - b[1]) > 0) this.showSection(a, b);
  }

  showSection(a, b) {
    this.ends = [a, b];
    document.body.classList.add('sectioned');
    this.cross?.removeFromParent();
    this.trace?.removeFromParent();
    const half = Math.max(0.05, Number($('half-width').value) || 1);
    const s = cut(this.cloud, this.terrain, a, b, half);
    const n = 200, vertices = [];
    for (let k = 0; k <= n; ++k) {
      const x = a[0] + (k / n) * (b[0] - a[0]), y = a[1] + (k / n) * (b[1] - a[1]);
      const ground = this.terrain ? this.terrain.at(x, y) : NaN;
      const at = this.frame.sceneOf(x, y, Number.isNaN(ground) ? 0 : ground);
      vertices.push(at[0], at[1], Number.isNaN(ground) ? 0 : at[2]);
    }
    const g = new BufferGeometry();
    g.setAttribute('position', new BufferAttribute(new Float32Array(vertices), 3));
    this.trace = new Line(g, new LineBasicMaterial({ color: 0xffe14d, depthTest: false }));
    this.trace.renderOrder = 8;
    this.view.overlay.add(this.trace);
    this.panel.draw(s, this.cloud);
    this.redraw();
    return s;
  }

  redrawSection() {
    if (this.ends && this.panel.section) this.panel.draw(this.panel.section, this.cloud);
  }

  closeSection() {
    document.body.classList.remove('sectioned');
    this.trace?.removeFromParent();
    this.ends = null;
    this.redraw();
  }
}

const HINT = 'Drag: turn. Right button: move. Wheel: zoom. Click a point: its values.';

async function start() {
  $('report-open').onclick = () => document.body.classList.toggle('report');
  $('report-close').onclick = () => document.body.classList.remove('report');
  say('Unpacking …', 'loading');
  try {
    const page = new Page(readScene());
    await page.load();
    page.controls();
    $('hint').textContent = HINT;
    page.view.home(true);
    // The picture before the second one is on the screen.
    await new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)));
    page.firstPicture = performance.now();
    page.counted();
    page.octrees?.update();
    globalThis.swathView = page;
    say('', 'ready');
  } catch (e) {
    say(e instanceof Refused ? e.message : `The page failed: ${e.message}`, 'failed');
    if (!(e instanceof Refused)) throw e;
  }
}

start();
