// SPDX-License-Identifier: GPL-3.0-or-later
// The scene that `swath view` writes: a table in JSON, and columns of numbers as deflated planes of bytes, within the page or beside it.

export class Refused extends Error {}

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; ++k) bytes[k] = raw.charCodeAt(k);
  return bytes;
}

async function inflated(bytes) {
  if (!globalThis.DecompressionStream)
    throw new Refused('This browser cannot unpack the points (DecompressionStream). Open the page with Firefox 113, Chrome 80, Safari 16.4 or newer.');
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The bytes of a column: from the page itself, or from the server that the page came from. */
async function packed(name, served) {
  if (!served) {
    const element = document.getElementById(`blob-${name}`);
    if (!element) throw new Refused(`The page is damaged: it does not hold "${name}".`);
    const bytes = bytesOfBase64(element.textContent);
    element.remove();
    return bytes;
  }
  const answer = await fetch(`scene/${name}`);
  if (!answer.ok) throw new Refused(`The server does not answer for "${name}": ${answer.status}.`);
  return new Uint8Array(await answer.arrayBuffer());
}

const TYPES = { u8: [Uint8Array, 1], u16: [Uint16Array, 2], i32: [Int32Array, 4] };

/** One column: planes of bytes, lowest first; `delta`: zigzag differences from the value before. */
export async function column(about, served) {
  const bytes = await inflated(await packed(about.blob, served));
  const [Type, size] = TYPES[about.type];
  const n = about.count;
  if (bytes.length !== n * size) throw new Refused(`The page is damaged: "${about.blob}" has ${bytes.length} bytes, not ${n * size}.`);
  if (size === 1 && !about.delta) return bytes;
  const out = new Type(n);
  let before = 0;
  for (let k = 0; k < n; ++k) {
    let raw = bytes[k];
    for (let p = 1; p < size; ++p) raw |= bytes[p * n + k] << (8 * p);
    if (about.delta) {
      before = (before + ((raw >>> 1) ^ -(raw & 1))) | 0;
      raw = before;
    }
    out[k] = raw;
  }
  return out;
}

export function scene() {
  const element = document.getElementById('scene');
  try {
    return JSON.parse(element.textContent);
  } catch {
    throw new Refused('The page is damaged: its table cannot be read.');
  }
}
