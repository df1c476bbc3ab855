// SPDX-License-Identifier: GPL-3.0-or-later
// The controls beside the picture. Texts from files are set as text, never as HTML.
import { MODES, NOTHING } from './cloud.js';
import { classColour, className, css, lineColour, rampCss } from './classes.js';

const $ = (id) => document.getElementById(id);
const made = (tag, attributes = {}, ...children) => {
  const e = document.createElement(tag);
  for (const [k, v] of Object.entries(attributes)) k in e ? (e[k] = v) : e.setAttribute(k, v);
  e.append(...children);
  return e;
};
export const count = (n) => n.toLocaleString('en').replaceAll(',', '\u202f');

const swatch = (rgb) => {
  const e = made('span', { className: 'swatch' });
  e.style.background = css(rgb);
  return e;
};

/** Which ways of colouring the points have the columns for. */
export function fillModes(cloud, columns, onChange) {
  const has = { class: true, height: true, intensity: 'intensity' in columns, sigma: 'sigma_v' in columns, line: 'line' in columns };
  const names = { class: 'class', height: 'height', intensity: 'intensity', sigma: 'sigma (vertical)', line: 'flight line' };
  const select = $('mode');
  for (const m of MODES) if (has[m]) select.append(made('option', { value: m }, names[m]));
  select.onchange = () => {
    cloud.mode = select.value;
    onChange();
  };
}

export function legend(cloud, frame, units, onChange) {
  const box = $('legend');
  box.replaceChildren();
  const ramp = (name, low, high, unit) => {
    const bar = made('div', { className: 'ramp' });
    bar.style.background = rampCss(name);
    box.append(bar, made('div', { className: 'ends' }, made('span', {}, low), made('span', {}, unit), made('span', {}, high)));
  };
  if (cloud.mode === 'height') {
    const r = cloud.range;
    const z = (v) => frame.mapOfScene({ x: 0, y: 0, z: v })[2].toFixed(1);
    ramp('height', z(r[0]), z(r[1]), units.height);
  } else if (cloud.mode === 'intensity') {
    ramp('intensity', String(Math.round(cloud.stretch.intensity[0])), String(Math.round(cloud.stretch.intensity[1])), 'as recorded');
  } else if (cloud.mode === 'sigma') {
    const s = cloud.stretch.sigma.map((v) => (v / 10).toFixed(1));
    ramp('sigma', s[0], s[1], 'cm');
  } else if (cloud.mode === 'line') {
    const shown = cloud.lines.map((id, k) => [id, k]).sort((a, b) => a[0] - b[0]).slice(0, 40);
    for (const [id, k] of shown) box.append(made('div', { className: 'entry' }, swatch(lineColour(k)), `line ${id}`));
    if (cloud.lines.length > shown.length) box.append(made('div', { className: 'entry' }, `and ${cloud.lines.length - shown.length} more`));
  }
  const classes = $('classes');
  classes.replaceChildren();
  for (const [code, n] of [...cloud.counts].filter(([, m]) => m > 0).sort((a, b) => a[0] - b[0])) {
    const check = made('input', { type: 'checkbox', checked: !!cloud.visible[code] });
    check.onchange = () => {
      cloud.show(code, check.checked);
      onChange();
    };
    const label = made('label', { className: 'entry' }, check);
    if (cloud.mode === 'class') label.append(swatch(classColour(code)));
    label.append(`${code} ${className(code)}`, made('span', { className: 'count' }, count(n)));
    classes.append(label);
  }
}

export function layer(name, object, on, onChange) {
  if (!object) return;
  const check = made('input', { type: 'checkbox', checked: on, id: `layer-${name.replaceAll(' ', '-')}` });
  object.visible = on;
  check.onchange = () => {
    object.visible = check.checked;
    onChange();
  };
  $('layers').append(made('label', { className: 'entry' }, check, name));
}

/** What is known of a point, as pairs of name and value. */
export function valuesOf(chunk, row, cloud, terrain, units) {
  const f = cloud.frame, c = chunk.columns;
  const at = f.mapOf(c, row);
  const out = [['easting', `${at[0].toFixed(f.decimals[0])} ${units.plane}`], ['northing', `${at[1].toFixed(f.decimals[1])} ${units.plane}`],
    ['height', `${at[2].toFixed(f.decimals[2])} ${units.height}`]];
  if (terrain) {
    const ground = terrain.at(at[0], at[1]);
    if (!Number.isNaN(ground)) out.push(['above the terrain model', `${(at[2] - ground).toFixed(2)} ${units.height}`]);
  }
  if (c.class) out.push(['class', `${c.class[row]} ${className(c.class[row])}`]);
  if (c.returns) out.push(['return', `${c.returns[row] & 15} of ${c.returns[row] >> 4}`]);
  if (c.intensity) out.push(['intensity', String(c.intensity[row])]);
  if (c.line) out.push(['flight line', String(c.line[row])]);
  const sigma = (v) => (v === NOTHING ? 'not known' : `${(v / 1000).toFixed(3)} m`);
  if (c.sigma_h) out.push(['sigma, horizontal', sigma(c.sigma_h[row])]);
  if (c.sigma_v) out.push(['sigma, vertical', sigma(c.sigma_v[row])]);
  if (c.gps_time) out.push(['GPS time', `${c.gps_time[row].toFixed(6)} s`]);
  return out;
}

export function showValues(pairs) {
  const table = $('values');
  table.replaceChildren(...pairs.map(([k, v]) => made('tr', {}, made('th', { scope: 'row' }, k), made('td', {}, v))));
  $('picked').hidden = pairs.length === 0;
}

export function save(name, text, type) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  made('a', { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

export function say(text, state) {
  document.documentElement.dataset.state = state;
  $('message').textContent = text;
  $('message').hidden = text === '';
}
export { $, made };
