// SPDX-License-Identifier: GPL-3.0-or-later
// Classes of ASPRS LAS 1.4 R15 with their colours, colour ramps, and palettes as textures.

const CLASSES = {
  0: ['never classified', [150, 150, 150]],
  1: ['unassigned', [186, 190, 196]],
  2: ['ground', [176, 124, 74]],
  3: ['low vegetation', [170, 208, 106]],
  4: ['medium vegetation', [104, 176, 72]],
  5: ['high vegetation', [44, 132, 60]],
  6: ['building', [224, 92, 74]],
  7: ['low noise', [255, 0, 200]],
  8: ['model key point', [250, 200, 60]],
  9: ['water', [62, 128, 226]],
  10: ['rail', [140, 104, 168]],
  11: ['road surface', [112, 118, 130]],
  12: ['overlap', [206, 206, 206]],
  13: ['wire, guard', [250, 220, 120]],
  14: ['wire, conductor', [252, 208, 40]],
  15: ['transmission tower', [216, 150, 250]],
  16: ['wire connector', [250, 236, 160]],
  17: ['bridge deck', [232, 146, 60]],
  18: ['high noise', [255, 80, 220]],
};
const OTHER = [[230, 160, 180], [140, 210, 220], [200, 190, 110], [160, 150, 230], [120, 220, 170], [230, 190, 150]];

export const NOISE = [7, 18];
export const className = (c) => (CLASSES[c] ? CLASSES[c][0] : `class ${c}`);
export const classColour = (c) => (CLASSES[c] ? CLASSES[c][1] : OTHER[c % OTHER.length]);

/** Stops from low to high. */
export const RAMPS = {
  height: [[48, 62, 148], [58, 134, 214], [58, 190, 180], [118, 214, 96], [228, 222, 72], [242, 150, 50], [206, 58, 38]],
  sigma: [[34, 96, 168], [66, 182, 196], [190, 226, 140], [250, 200, 80], [236, 96, 60], [140, 16, 60]],
  intensity: [[16, 18, 22], [250, 250, 250]],
};

export function rampColour(name, share) {
  const stops = RAMPS[name];
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(at), stops.length - 2);
  return stops[k].map((v, i) => Math.round(v + (stops[k + 1][i] - v) * (at - k)));
}

export const rampCss = (name) =>
  `linear-gradient(to right, ${Array.from({ length: 9 }, (_, k) => css(rampColour(name, k / 8))).join(', ')})`;

/** Colours of flight lines: hues a golden angle apart, so that neighbours differ. */
export function lineColour(index) {
  const hue = (index * 137.508) % 360;
  const c = (1 - Math.abs(2 * 0.62 - 1)) * 0.75;
  const x = c * (1 - Math.abs(((hue / 60) % 2) - 1));
  const rgb = [[c, x, 0], [x, c, 0], [0, c, x], [0, x, c], [x, 0, c], [c, 0, x]][Math.floor(hue / 60)];
  return rgb.map((v) => Math.round((v + 0.62 - c / 2) * 255));
}

export const css = (rgb) => `rgb(${rgb[0]}, ${rgb[1]}, ${rgb[2]})`;
