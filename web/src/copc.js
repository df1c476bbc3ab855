// SPDX-License-Identifier: GPL-3.0-or-later
// COPC 1.0 by byte ranges: header, extra bytes and hierarchy of a file, and the records of a node as columns. All numbers are little-endian, also
// scale and offset of extra bytes, which copc.js 0.0.8 reads as big-endian.

const ENTRY = 32, INFO = 160, HEADER = 375;
const BASE = { 6: 30, 7: 36, 8: 38 };
const TYPES = [null, ['Uint8', 1], ['Int8', 1], ['Uint16', 2], ['Int16', 2], ['Uint32', 4], ['Int32', 4], ['BigUint64', 8], ['BigInt64', 8], ['Float32', 4], ['Float64', 8]];
const NOTHING = 65535; // a sigma that is not known, as cloud.js has it

async function range(url, begin, end) {
  const answer = await fetch(url, { headers: { Range: `bytes=${begin}-${end - 1}` } });
  if (answer.status !== 206) throw new Error(`the server does not give byte ranges of ${url} (${answer.status})`);
  return answer.arrayBuffer();
}

const text = (view, at, n) => {
  const bytes = new Uint8Array(view.buffer, view.byteOffset + at, n);
  const end = bytes.indexOf(0);
  return new TextDecoder().decode(bytes.subarray(0, end < 0 ? n : end));
};

/** The fields that the extra bytes record describes, with their place behind the standard fields. */
export function extraFields(view) {
  const fields = [];
  for (let at = 0, place = 0; at + 192 <= view.byteLength; at += 192) {
    const code = view.getUint8(at + 2), options = view.getUint8(at + 3);
    const single = code === 0 ? 0 : ((code - 1) % 10) + 1;
    const size = code === 0 ? options : TYPES[single][1] * (1 + Math.floor((code - 1) / 10));
    const field = { name: text(view, at + 4, 32), place, reader: code >= 1 && code <= 10 ? `get${TYPES[code][0]}` : null, scale: 1, offset: 0, nodata: null };
    if (code > 0 && options & 1) {
      const nodata = single >= 9 ? view.getFloat64(at + 40, true) : single % 2 ? view.getBigUint64(at + 40, true) : view.getBigInt64(at + 40, true);
      field.nodata = Number(nodata);
    }
    if (code > 0 && options & 8) field.scale = view.getFloat64(at + 112, true);
    if (code > 0 && options & 16) field.offset = view.getFloat64(at + 136, true);
    fields.push(field);
    place += size;
  }
  return fields;
}

async function pages(url, at, size, nodes) {
  const view = new DataView(await range(url, at, at + size));
  const more = [];
  for (let k = 0; k + ENTRY <= view.byteLength; k += ENTRY) {
    const key = [0, 4, 8, 12].map((o) => view.getInt32(k + o, true));
    const offset = Number(view.getBigUint64(k + 16, true)), bytes = view.getInt32(k + 24, true), points = view.getInt32(k + 28, true);
    if (points === -1) more.push(pages(url, offset, bytes, nodes));
    else nodes[key.join('-')] = { key, offset, bytes, points };
  }
  await Promise.all(more);
}

export async function open(url) {
  const head = new DataView(await range(url, 0, HEADER + 54 + INFO));
  if (text(head, 0, 4) !== 'LASF' || text(head, HEADER + 2, 16) !== 'copc') throw new Error(`${url} is not a COPC file`);
  const triple = (at) => [0, 8, 16].map((o) => head.getFloat64(at + o, true));
  const info = HEADER + 54;
  const file = {
    url, format: head.getUint8(104) & 63, length: head.getUint16(105, true), scale: triple(131), offset: triple(155), centre: triple(info),
    half: head.getFloat64(info + 24, true), spacing: head.getFloat64(info + 32, true), extras: [], nodes: {},
  };
  if (!BASE[file.format]) throw new Error(`${url} has point format ${file.format}`);
  const begin = head.getUint16(94, true), count = head.getUint32(100, true), points = head.getUint32(96, true);
  const records = new DataView(await range(url, begin, points));
  for (let at = 0, n = 0; n < count; ++n) {
    const size = records.getUint16(at + 20, true);
    if (text(records, at + 2, 16) === 'LASF_Spec' && records.getUint16(at + 18, true) === 4) file.extras = extraFields(new DataView(records.buffer, at + 54, size));
    at += 54 + size;
  }
  await pages(url, Number(head.getBigUint64(info + 40, true)), Number(head.getBigUint64(info + 48, true)), file.nodes);
  return file;
}

export function decompressed(lazPerf, file, node, compressed) {
  const out = new Uint8Array(node.points * file.length);
  const from = lazPerf._malloc(compressed.byteLength), to = lazPerf._malloc(file.length);
  const decoder = new lazPerf.ChunkDecoder();
  try {
    lazPerf.HEAPU8.set(new Uint8Array(compressed), from);
    decoder.open(file.format, file.length, from);
    for (let k = 0; k < node.points; ++k) {
      decoder.getPoint(to);
      out.set(lazPerf.HEAPU8.subarray(to, to + file.length), k * file.length);
    }
  } finally {
    lazPerf._free(from);
    lazPerf._free(to);
    decoder.delete();
  }
  return out;
}

/** Columns of records in the order given, coordinates as whole steps of the scene. */
export function columnsOf(file, records, order, frame) {
  const n = order.length, view = new DataView(records.buffer, records.byteOffset, records.byteLength);
  const c = {
    x: new Int32Array(n), y: new Int32Array(n), z: new Int32Array(n), class: new Uint8Array(n), intensity: new Uint16Array(n), returns: new Uint8Array(n),
    line: new Uint16Array(n), gps_time: new Float64Array(n),
  };
  const sigmas = file.extras.filter((f) => f.reader && ['sigma_h', 'sigma_v'].includes(f.name));
  for (const f of sigmas) c[f.name] = new Uint16Array(n);
  const places = [c.x, c.y, c.z];
  for (let k = 0; k < n; ++k) {
    const at = order[k] * file.length;
    for (let a = 0; a < 3; ++a)
      places[a][k] = Math.round((view.getInt32(at + 4 * a, true) * file.scale[a] + file.offset[a] - frame.offset[a]) / frame.scale[a]);
    c.intensity[k] = view.getUint16(at + 12, true);
    c.returns[k] = view.getUint8(at + 14);
    c.class[k] = view.getUint8(at + 16);
    c.line[k] = view.getUint16(at + 20, true);
    c.gps_time[k] = view.getFloat64(at + 22, true);
    for (const f of sigmas) {
      const raw = Number(view[f.reader](at + BASE[file.format] + f.place, true));
      const mm = raw === f.nodata || Number.isNaN(raw) ? NOTHING : Math.round((raw * f.scale + f.offset) * 1000);
      c[f.name][k] = mm >= 0 && mm < NOTHING ? mm : NOTHING;
    }
  }
  return c;
}

export const chunk = (file, node) => range(file.url, node.offset, node.offset + node.bytes);
