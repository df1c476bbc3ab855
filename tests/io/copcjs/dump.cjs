// SPDX-License-Identifier: GPL-3.0-or-later
// node dump.cjs FILE FOLDER: every dimension of all nodes of a COPC file as copc.js reads it, FOLDER/NAME.f8 (doubles in order of nodes).
const fs = require('fs');
const path = require('path');
const { Copc } = require('copc');

(async () => {
  const [file, folder] = process.argv.slice(2);
  fs.mkdirSync(folder, { recursive: true });
  const copc = await Copc.create(file);
  const nodes = {};
  const pages = [copc.info.rootHierarchyPage];
  while (pages.length) {
    const page = await Copc.loadHierarchyPage(file, pages.pop());
    Object.assign(nodes, page.nodes);
    pages.push(...Object.values(page.pages));
  }
  const columns = {};
  for (const [key, node] of Object.entries(nodes)) {
    if (!node.pointCount) continue;
    const view = await Copc.loadPointDataView(file, copc, node);
    if (view.pointCount !== node.pointCount) throw new Error(`${key}: ${view.pointCount} points, the hierarchy says ${node.pointCount}`);
    for (const name of Object.keys(view.dimensions)) {
      const get = view.getter(name);
      const values = new Float64Array(view.pointCount);
      for (let i = 0; i < values.length; ++i) values[i] = get(i);
      (columns[name] ??= []).push(Buffer.from(values.buffer));
    }
  }
  for (const [name, parts] of Object.entries(columns)) fs.writeFileSync(path.join(folder, `${name}.f8`), Buffer.concat(parts));
})().catch((fault) => {
  console.error(fault);
  process.exit(1);
});
