// SPDX-License-Identifier: GPL-3.0-or-later
/** Order in which every beginning of the list is an even picture of the whole: steps of a golden share of it, which visit each once. */
export function spread(n) {
  const common = (a, b) => (b ? common(b, a % b) : a);
  let step = Math.max(1, Math.round(n * 0.6180339887));
  while (common(step, n) > 1) ++step;
  const order = new Uint32Array(n);
  for (let k = 0, at = 0; k < n; ++k, at = (at + step) % n) order[k] = at;
  return order;
}
