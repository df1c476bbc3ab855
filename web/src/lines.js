// SPDX-License-Identifier: GPL-3.0-or-later
// Contours and the trajectory: lines of the map, drawn as segments.
import { BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments } from 'three';

/** A line material that lies before what is at its place, by a small share of the distance: points and mesh do not swallow it. */
function above(colour) {
  const material = new LineBasicMaterial({ color: colour });
  material.onBeforeCompile = (shader) => {
    shader.vertexShader = shader.vertexShader.replace('#include <project_vertex>', '#include <project_vertex>\n  gl_Position.z -= 4e-4 * gl_Position.w;');
  };
  return material;
}

/** Segments of lines given by their vertices one after the other, and how many each has. */
function segments(vertices, counts, material) {
  let pairs = 0;
  for (const n of counts) pairs += Math.max(0, n - 1);
  const position = new Float32Array(6 * pairs);
  let from = 0, at = 0;
  for (const n of counts) {
    for (let k = 0; k + 1 < n; ++k, at += 6) {
      position.set(vertices.subarray(3 * (from + k), 3 * (from + k + 2)), at);
    }
    from += n;
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  return new LineSegments(geometry, material);
}

function placed(columns, about, frame, z) {
  const n = columns.x.length;
  const out = new Float32Array(3 * n);
  for (let k = 0; k < n; ++k)
    out.set(frame.sceneOf(columns.x[k] * about.step + about.base[0], columns.y[k] * about.step + about.base[1], z(k)), 3 * k);
  return out;
}

/** `columns`: x, y of all vertices; vertices, height (steps) and index (0, 1) of each line. */
export function contours(about, columns, frame) {
  const group = new Group();
  const heightOf = new Float64Array(columns.x.length);
  for (let line = 0, at = 0; line < columns.vertices.length; ++line)
    for (let k = 0; k < columns.vertices[line]; ++k) heightOf[at++] = columns.height[line] * about.height_step + about.base[2];
  const all = placed(columns, about, frame, (k) => heightOf[k]);
  for (const index of [0, 1]) {
    const parts = [], counts = [];
    for (let line = 0, at = 0; line < columns.vertices.length; at += columns.vertices[line++])
      if (columns.index[line] === index) {
        parts.push([3 * at, 3 * (at + columns.vertices[line])]);
        counts.push(columns.vertices[line]);
      }
    const vertices = new Float32Array(parts.reduce((n, [a, b]) => n + b - a, 0));
    let at = 0;
    for (const [a, b] of parts) {
      vertices.set(all.subarray(a, b), at);
      at += b - a;
    }
    group.add(segments(vertices, counts, above(index ? 0x2b1200 : 0x5c2a08)));
  }
  return group;
}

export function trajectory(about, columns, frame) {
  const vertices = placed(columns, about, frame, (k) => columns.z[k] * about.height_step + about.base[2]);
  return segments(vertices, columns.vertices, above(0x35e0ff));
}
