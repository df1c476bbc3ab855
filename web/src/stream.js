// SPDX-License-Identifier: GPL-3.0-or-later
// A worker that reads COPC files: {open: [addresses], frame} answers with their octrees, {file, key} with the points of a node.
import createLazPerf from 'laz-perf/lib/worker/laz-perf.js';
import wasmBinary from 'laz-perf/lib/laz-perf.wasm';
import { chunk, columnsOf, decompressed, open } from './copc.js';
import { spread } from './spread.js';

let files = [], frame = null;
const lazPerf = createLazPerf({ wasmBinary });

async function points({ file, key }) {
  const f = files[file], node = f.nodes[key];
  const compressed = await chunk(f, node);
  const records = decompressed(await lazPerf, f, node, compressed);
  const columns = columnsOf(f, records, spread(node.points), frame);
  postMessage({ file, key, columns }, Object.values(columns).map((c) => c.buffer));
}

onmessage = async ({ data }) => {
  try {
    if (data.open) {
      frame = data.frame;
      files = await Promise.all(data.open.map(open));
      postMessage({ opened: files.map(({ centre, half, spacing, nodes }) => ({ centre, half, spacing, nodes: Object.fromEntries(Object.entries(nodes).map(([k, n]) => [k, n.points])) })) });
    } else {
      await points(data);
    }
  } catch (e) {
    postMessage({ failed: e.message, file: data.file, key: data.key });
  }
};
