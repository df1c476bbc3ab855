// SPDX-License-Identifier: GPL-3.0-or-later
// Camera, light and time: what is drawn when. Nothing is drawn while nothing changes.
import { Color, Group, MOUSE, PerspectiveCamera, Plane, Raycaster, Scene, Vector2, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Refused } from './data.js';

const SLOW = 60, FAST = 30; // ms between pictures, beyond which fewer or more points are drawn in each
const START = 0.1;          // share of the points in the first picture

export class View {
  constructor(canvas, frame) {
    this.canvas = canvas;
    this.frame = frame;
    try {
      this.renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: 'high-performance', preserveDrawingBuffer: true });
    } catch {
      throw new Refused('This browser cannot draw in three dimensions (WebGL 2 is switched off or not there). The report beside it can be read all the same.');
    }
    this.renderer.setClearColor(new Color(0x10141a));
    this.scene = new Scene();
    this.world = new Group();
    this.overlay = new Group(); // marks that lie before everything
    this.world.add(this.overlay);
    this.scene.add(this.world);
    this.camera = new PerspectiveCamera(35, 1, 1, 1e6);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.mouseButtons = { LEFT: MOUSE.ROTATE, MIDDLE: MOUSE.PAN, RIGHT: MOUSE.PAN };
    this.controls.zoomToCursor = true;
    this.controls.enableDamping = false;
    this.controls.maxPolarAngle = Math.PI * 0.495;
    this.share = START;
    this.done = 0;
    this.onLimit = () => {};  // (from, to): shares of the points to be drawn
    this.points = null;       // what is drawn piece by piece
    this.onRest = () => {};
    this.controls.addEventListener('change', () => this.moved());
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.resize();
    this.home(true);
  }

  get radius() { return Math.max(1, Math.hypot(...this.frame.size) / 2); }

  resize() {
    const box = this.canvas.parentElement.getBoundingClientRect();
    this.width = Math.max(50, Math.round(box.width));
    this.height = Math.max(50, Math.round(box.height));
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(this.width, this.height, false);
    this.camera.aspect = this.width / this.height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** The whole of the data, as large as it fits: obliquely from the south, or from above. */
  home(oblique) {
    const tilt = oblique ? (40 * Math.PI) / 180 : 1e-4;
    const from = new Vector3(0, -Math.sin(tilt), Math.cos(tilt));
    const [w, d, h] = this.frame.size.map((v, k) => (v / 2) * (k === 2 ? this.world.scale.z : 1));
    const target = new Vector3();
    let distance = 4 * this.radius * Math.max(1, this.world.scale.z);
    for (let turn = 0; turn < 12; ++turn) {
      this.camera.position.copy(from).multiplyScalar(distance).add(target);
      this.camera.lookAt(target);
      this.camera.near = distance / 1000;
      this.camera.far = distance * 10;
      this.camera.updateProjectionMatrix();
      this.camera.updateMatrixWorld(true);
      const low = new Vector2(Infinity, Infinity), high = new Vector2(-Infinity, -Infinity);
      for (let k = 0; k < 8; ++k) {
        const p = new Vector3(k & 1 ? w : -w, k & 2 ? d : -d, k & 4 ? h : -h).project(this.camera);
        low.min(p);
        high.max(p);
      }
      const half = Math.tan((this.camera.fov * Math.PI) / 360) * distance;
      target.x += ((low.x + high.x) / 2) * half * this.camera.aspect;
      target.y += (((low.y + high.y) / 2) * half) / Math.max(0.3, Math.cos(tilt));
      distance *= Math.max(0.3, Math.max(high.x - low.x, high.y - low.y) / 1.92);
    }
    this.controls.target.copy(target);
    this.camera.position.copy(from).multiplyScalar(Math.max(distance, 2)).add(target);
    this.controls.update();
    this.draw();
  }

  /** Pixels on the screen per metre, one metre before the camera. */
  get pixels() { return (this.height * this.renderer.getPixelRatio()) / 2 / Math.tan((this.camera.fov * Math.PI) / 360); }

  moved() {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = setTimeout(() => {
      this.moving = false;
      this.refine();
      this.onRest();
    }, 150);
    this.draw();
  }

  /** More or fewer points in one picture, by the time since the last one. */
  adapt() {
    const now = performance.now(), gap = now - this.last;
    this.last = now;
    if (!(gap < 2000)) return;
    if (gap > SLOW) this.share = Math.max(0.005, this.share * Math.max(0.3, SLOW / gap));
    else if (gap < FAST) this.share = Math.min(1, this.share * 1.3);
  }

  /** Draws before the next picture of the screen: as many points as it has time for, the others in the pictures after it. */
  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      this.adapt();
      this.drawNow(this.share);
      if (!this.moving) this.refine();
    });
  }

  refine() {
    if (this.refining || this.done >= 1) return;
    this.refining = true;
    requestAnimationFrame(() => {
      this.refining = false;
      if (this.pending || this.moving) return;
      this.adapt();
      const to = Math.min(1, this.done + this.share);
      this.onLimit(this.done, to);
      this.done = to;
      this.renderer.autoClear = false;
      if (this.points?.visible) this.renderer.render(this.points, this.camera);
      this.renderer.render(this.overlay, this.camera);
      this.renderer.autoClear = true;
      this.refine();
    });
  }

  drawNow(share) {
    const distance = this.camera.position.distanceTo(this.controls.target);
    this.camera.near = Math.max(0.05, distance / 200);
    this.camera.far = distance + 4 * this.radius * Math.max(1, this.world.scale.z) + 1000;
    this.camera.updateProjectionMatrix();
    this.onLimit(0, share);
    this.done = share;
    this.renderer.render(this.scene, this.camera);
  }

  /** The place on the plane through the middle of the data under a place on the screen; null above the horizon. */
  planeUnder(px, py) {
    const caster = new Raycaster();
    caster.setFromCamera(new Vector2((px / this.width) * 2 - 1, 1 - (py / this.height) * 2), this.camera);
    return caster.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), 0), new Vector3());
  }
}
